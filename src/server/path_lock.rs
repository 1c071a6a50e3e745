//! Marks a path as taken by a living run: two that put something at one path would take it from each other.
//!
//! The mark is a socket in the abstract namespace of Linux. It goes with its process, however that ends, so unlike
//! a lock file it can't be left behind. Other systems have no such thing, and there nothing is marked.

use std::io;
use std::path::Path;

/// The mark on a path that is ours until this is dropped.
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
            // Where no mark can be made at all, nobody else has made one.
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
