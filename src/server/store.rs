//! The state file on the disk: taken at the start, and written whole each time a drive has stored something.
//!
//! Beside the file first, then moved over it, and synced to disk before the run continues: whatever ends the
//! process, the file is the old one or the new one. A disk that fails does not stop the drives.

use super::destination::{FileId, folder, places};
use super::input;
use super::input::plain;
use crate::bench::StateFile;
use crate::bus::Bus;
use crate::event::DriveId;
use rustix::fs::{FlockOperation, flock};
use std::ffi::OsString;
use std::fs::{self, File};
use std::io::{self, ErrorKind, Write};
use std::path::{Path, PathBuf};
use tracing::{error, info};

/// The state file of a run.
#[derive(Debug)]
pub struct Store {
    /// As the user calls it.
    path: PathBuf,
    /// Where that leads: a link stays one.
    target: PathBuf,
    /// The file as it lies there, locked: one run at a time.
    held: Option<File>,
    state: StateFile,
    /// The disk lacks something.
    behind: bool,
}

impl Store {
    /// Takes the file at `path` for this run, and gives back what stands in it, if there is one.
    ///
    /// # Errors
    /// If it can't be read, or another run has it.
    pub fn open(path: &Path) -> io::Result<(Self, Option<String>)> {
        let target = places(path).ok().and_then(|mut it| it.pop());
        let target = target.unwrap_or_else(|| path.to_owned());
        // To open a FIFO would wait for its writer.
        let held = match fs::metadata(&target) {
            Ok(it) if it.is_file() => Some(File::open(&target)?),
            Ok(it) if it.is_dir() => return Err(ErrorKind::IsADirectory.into()),
            Ok(_) => return Err(io::Error::other("not a regular file")),
            Err(error) if error.kind() == ErrorKind::NotFound => None,
            Err(error) => return Err(error),
        };
        held.as_ref().map(lock).transpose()?;
        let text = held.as_ref().map(input::read).transpose()?;
        let (path, state) = (path.to_owned(), StateFile::default());
        Ok((Self { path, target, held, state, behind: false }, text))
    }

    /// Where the next state is written before it is moved over the file at `path`.
    pub fn beside(path: &Path) -> PathBuf {
        beside(&places(path).ok().and_then(|mut it| it.pop()).unwrap_or_else(|| path.to_owned()))
    }

    /// As the user calls it.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Takes what all drives of `line` keep. Nothing is written yet.
    pub fn take(&mut self, line: &str, bus: &Bus) {
        self.state.keep_all(line, bus);
    }

    /// Keeps what a drive of `line` has stored. If the disk fails, that is told once; the next time it is tried
    /// again, with everything.
    pub fn keep(&mut self, line: &str, bus: &Bus, drive: DriveId) {
        self.state.keep(line, bus, drive);
        let was_behind = self.behind;
        let saved = self.save();
        let path = self.path.display();
        match saved {
            Ok(()) if was_behind => info!("{path} is written again and complete"),
            Err(why) if !was_behind => {
                error!(
                    "cannot write {path}: {}; it lacks what the drives have stored since",
                    plain(&why)
                );
            }
            Ok(()) | Err(_) => {}
        }
    }

    /// Writes everything.
    ///
    /// # Errors
    /// What the file system says.
    pub fn save(&mut self) -> io::Result<()> {
        self.behind = true;
        let beside = beside(&self.target);
        // Not emptied before it is ours: another run may be about to put it in place.
        let mut file = File::options().write(true).create(true).truncate(false).open(&beside)?;
        if let Ok(old) = fs::metadata(&self.target) {
            file.set_permissions(old.permissions())?;
        }
        lock(&file)?;
        self.still_ours(&file, &beside)?;
        file.set_len(0)?;
        file.write_all(self.state.text().as_bytes())?;
        file.sync_all()?;
        fs::rename(&beside, &self.target)?;
        self.held = Some(file);
        // The new name is on the disk once its folder is.
        File::open(folder(&self.target))?.sync_all()?;
        self.behind = false;
        Ok(())
    }

    /// Makes sure, with `new` at `beside` locked, that no other run has taken the file: one that was started after
    /// it was removed found nothing that was locked. To put a file in place, a run has to lock `beside` first.
    fn still_ours(&self, new: &File, beside: &Path) -> io::Result<()> {
        if FileId::of(beside) != Some(FileId::from(&new.metadata()?)) {
            return Err(io::Error::other("replaced by another run"));
        }
        let Ok(there) = File::open(&self.target) else { return Ok(()) };
        let id = |file: &File| file.metadata().map(|it| FileId::from(&it));
        match &self.held {
            Some(held) if id(held)? == id(&there)? => Ok(()),
            // A file that was edited or copied there is not locked, and is overwritten.
            _ => lock(&there),
        }
    }

    /// Tries for the last time, if the disk lacks something.
    ///
    /// # Errors
    /// What the file system says.
    pub fn finish(&mut self) -> io::Result<()> {
        if self.behind { self.save() } else { Ok(()) }
    }
}

/// Locks `file` until it is closed, be it by `kill -9`.
fn lock(file: &File) -> io::Result<()> {
    match flock(file, FlockOperation::NonBlockingLockExclusive) {
        Err(rustix::io::Errno::WOULDBLOCK) => Err(io::Error::other("in use by another run")),
        // Some network file systems know no locks.
        _ => Ok(()),
    }
}

/// Always the same name: a run that was killed leaves at most one such file, and the next one takes it.
fn beside(path: &Path) -> PathBuf {
    let mut name = OsString::from(".");
    name.push(path.file_name().unwrap_or_default());
    name.push(".new");
    path.with_file_name(name)
}
