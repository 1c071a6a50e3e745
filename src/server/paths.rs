//! The paths of a run: none is written that it reads, none twice, and none that another run has taken.
//!
//! Within a run paths are compared by what they lead to: by way of links, by another spelling, or as another name of
//! the same file. Between runs a path is locked by a socket in the abstract namespace of Linux. That goes with its
//! process, however it ends, so unlike a lock file it can't be left behind. Other systems have no such thing, and there
//! nothing is locked.

use super::destination::{Destination, FileId, places};
use std::fs;
use std::io;
use std::os::fd::AsFd;
use std::path::{Path, PathBuf};

/// The paths of one run.
#[derive(Debug)]
pub struct PathClaims(Vec<PathClaim>);

#[derive(Debug)]
struct PathClaim {
    /// What people call it: `--log-file run.log`.
    name: String,
    access: PathUse,
    /// Every path that it goes by.
    places: Vec<PathBuf>,
    file: Option<FileId>,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum PathUse {
    Read,
    Write,
    /// Both, or in a way that goes with nothing else.
    Own,
}

impl PathClaims {
    /// Those of a run whose stdout and stderr may be files.
    pub fn new() -> Self {
        let stream = |name: &str, fd: io::Result<std::os::fd::OwnedFd>| {
            let metadata =
                fs::File::from(fd.ok()?).metadata().ok().filter(fs::Metadata::is_file)?;
            let (name, file) = (name.to_owned(), Some(FileId::from(&metadata)));
            Some(PathClaim { name, access: PathUse::Write, places: Vec::new(), file })
        };
        let stdout = stream("stdout", io::stdout().as_fd().try_clone_to_owned());
        let stderr = stream("stderr", io::stderr().as_fd().try_clone_to_owned());
        // `>log 2>&1` is usual.
        Self(stdout.into_iter().chain(stderr).collect())
    }

    /// `name` reads `path`.
    ///
    /// # Errors
    /// If another writes it, in words.
    pub fn reads(&mut self, name: impl Into<String>, path: &Path) -> Result<(), String> {
        self.add(name.into(), PathUse::Read, known_places(path), FileId::of(path))
    }

    /// `name` writes `path`.
    ///
    /// # Errors
    /// If another reads or writes it, in words.
    pub fn writes(&mut self, name: impl Into<String>, path: &Path) -> Result<(), String> {
        if Destination::find(path).is_ok_and(|it| it.is_own_stream()) {
            return Ok(());
        }
        self.add(name.into(), PathUse::Write, known_places(path), FileId::of(path))
    }

    /// `name` has `path`, and the path `beside` it, for itself.
    ///
    /// # Errors
    /// If another reads or writes one of them, in words.
    pub fn owns(
        &mut self,
        name: impl Into<String>,
        path: &Path,
        beside: Option<&Path>,
    ) -> Result<(), String> {
        let mut places = known_places(path);
        places.extend(beside.into_iter().flat_map(known_places));
        self.add(name.into(), PathUse::Own, places, FileId::of(path))
    }

    /// `name` puts a link at `path`, whatever link is there now.
    ///
    /// # Errors
    /// If another reads or writes it, in words.
    pub fn links(&mut self, name: impl Into<String>, path: &Path) -> Result<(), String> {
        let place = known_places(path).into_iter().next();
        let metadata = fs::symlink_metadata(path).ok().filter(fs::Metadata::is_file);
        let file = metadata.as_ref().map(FileId::from);
        self.add(name.into(), PathUse::Own, place.into_iter().collect(), file)
    }

    fn add(
        &mut self,
        name: String,
        access: PathUse,
        places: Vec<PathBuf>,
        file: Option<FileId>,
    ) -> Result<(), String> {
        let new = PathClaim { name, access, places, file };
        if let Some(other) = self.0.iter().find(|other| other.excludes(&new)) {
            return Err(format!(
                "{} and {} are the same file; nothing was changed",
                new.name, other.name
            ));
        }
        self.0.push(new);
        Ok(())
    }
}

impl Default for PathClaims {
    fn default() -> Self {
        Self::new()
    }
}

impl PathClaim {
    fn excludes(&self, other: &Self) -> bool {
        let shared = self.places.iter().find(|place| other.places.contains(place));
        let is_same = shared.is_some() || self.file.is_some() && self.file == other.file;
        let may_share = match (self.access, other.access) {
            (PathUse::Read, PathUse::Read) => true,
            // Many may write to a device such as /dev/null.
            (PathUse::Write, PathUse::Write) => shared.is_some_and(|place| is_device(place)),
            _ => false,
        };
        is_same && !may_share
    }
}

fn is_device(path: &Path) -> bool {
    use std::os::unix::fs::FileTypeExt;
    fs::metadata(path).is_ok_and(|it| it.file_type().is_char_device())
}

/// As [`places`], or the path as it is where that leads nowhere.
fn known_places(path: &Path) -> Vec<PathBuf> {
    places(path).unwrap_or_else(|_| std::path::absolute(path).into_iter().collect())
}

/// A path that is ours until this is dropped.
#[derive(Debug)]
pub struct PathLock {
    #[cfg(target_os = "linux")]
    _socket: Option<std::os::unix::net::UnixListener>,
}

impl PathLock {
    /// Marks `path` in whatever spelling, whether something is there or not.
    ///
    /// # Errors
    /// `ResourceBusy` if a living run has marked it, `NotFound` or `NotADirectory` if its directory is missing.
    #[cfg(target_os = "linux")]
    pub fn take(path: &Path) -> io::Result<Self> {
        use std::os::linux::net::SocketAddrExt;
        use std::os::unix::fs::MetadataExt;
        use std::os::unix::net::{SocketAddr, UnixListener};

        let directory = path.parent().filter(|parent| *parent != Path::new(""));
        let directory = std::fs::metadata(directory.unwrap_or(Path::new(".")))?;
        if !directory.is_dir() {
            return Err(io::ErrorKind::NotADirectory.into());
        }
        let name = path.file_name().unwrap_or_default().to_string_lossy();
        let (dev, ino, name) = (directory.dev(), directory.ino(), crate::rng::fnv1a(&name));
        let name = SocketAddr::from_abstract_name(format!("drivemu/{dev:x}/{ino:x}/{name:x}"))?;
        match UnixListener::bind_addr(&name) {
            Err(error) if error.kind() == io::ErrorKind::AddrInUse => {
                Err(io::Error::new(io::ErrorKind::ResourceBusy, "used by a running drivemu"))
            }
            // Where no lock can be made at all, no other run has made one.
            socket => Ok(Self { _socket: socket.ok() }),
        }
    }

    /// Marks a file that this run writes. Pipes and devices are for everybody.
    ///
    /// # Errors
    /// As for [`PathLock::take`].
    pub fn file(path: &Path) -> io::Result<Option<Self>> {
        match std::fs::metadata(path).is_ok_and(|found| !found.is_file()) {
            true => Ok(None),
            false => Self::take(path).map(Some),
        }
    }

    /// Marks nothing on this system.
    ///
    /// # Errors
    /// None.
    #[cfg(not(target_os = "linux"))]
    pub fn take(_: &Path) -> io::Result<Self> {
        Ok(Self {})
    }
}

#[cfg(all(test, target_os = "linux"))]
mod tests {
    use super::*;
    use std::io::ErrorKind;

    #[test]
    fn a_path_is_claimed_once_in_whatever_spelling() {
        let dir = tempfile::tempdir().unwrap();
        let plain = dir.path().join("a.tty");
        std::fs::create_dir(dir.path().join("sub")).unwrap();
        std::os::unix::fs::symlink(dir.path(), dir.path().join("here")).unwrap();
        let claim = PathLock::take(&plain).unwrap();
        for spelling in ["a.tty", "./a.tty", "sub/../a.tty", "here/a.tty", "here/./a.tty"] {
            let refused = PathLock::take(&dir.path().join(spelling)).unwrap_err();
            assert_eq!(refused.kind(), ErrorKind::ResourceBusy, "{spelling}");
        }
        PathLock::take(&dir.path().join("b.tty")).unwrap();
        PathLock::take(&dir.path().join("sub/a.tty")).unwrap();
        drop(claim);
        PathLock::take(&plain).unwrap();
    }

    #[test]
    fn a_missing_directory_is_told() {
        let dir = tempfile::tempdir().unwrap();
        let refused = PathLock::take(&dir.path().join("no/a.tty")).unwrap_err();
        assert_eq!(refused.kind(), ErrorKind::NotFound);
    }
}
