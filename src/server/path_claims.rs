//! Which paths a run reads and writes: none is written that is read, and none is written twice.
//!
//! Paths are compared by what they lead to: by way of links, by another spelling, or as another name of the same
//! file. Nothing is touched here.

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
