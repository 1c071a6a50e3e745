//! Reads files that people give, model files among them: whole, as text, and not without end.
//!
//! Deliberately one bound for all of them: a file beyond it is no model, bench, scenario or state file, whatever it
//! says. A path that is not a regular file, such as a FIFO, is read too, if it has a writer.

use crate::bench::{BuiltinLibrary, Library, no_model};
use crate::problem::bounds;
use crate::time::Duration;
use rustix::event::{PollFd, PollFlags, Timespec, poll};
use rustix::fs::{Mode, OFlags};
use rustix::io::Errno;
use std::cell::RefCell;
use std::fs::File;
use std::io::{self, ErrorKind, Read};
use std::path::{Path, PathBuf};

/// How long a FIFO, a terminal or a pipe may say nothing.
const PATIENCE: Duration = Duration::from_secs(10);

/// Reads the file at `path` as text.
///
/// # Errors
/// What the file system says; `FileTooLarge` beyond [`bounds::SIZE`] bytes, `TimedOut` if a FIFO has no writer,
/// `IsADirectory`, `InvalidData` for what is not UTF-8.
pub fn read_text(path: &Path) -> io::Result<String> {
    // To open a FIFO waits for its writer, unless told not to.
    let flags = OFlags::RDONLY | OFlags::NONBLOCK | OFlags::NOCTTY | OFlags::CLOEXEC;
    let file = File::from(rustix::fs::open(path, flags, Mode::empty())?);
    read(&file)
}

/// The same for a file that is open.
///
/// # Errors
/// As [`read_text`].
pub fn read(file: &File) -> io::Result<String> {
    let metadata = file.metadata()?;
    if metadata.is_dir() {
        return Err(ErrorKind::IsADirectory.into());
    }
    let most = bounds::SIZE as u64 + 1;
    let mut bytes = Vec::new();
    let mut rest = file.take(most);
    loop {
        if !metadata.is_file() {
            wait_for_bytes(file)?;
        }
        match rest.read_to_end(&mut bytes) {
            Ok(_) => break,
            Err(error) if error.kind() == ErrorKind::WouldBlock => {}
            Err(error) => return Err(error),
        }
    }
    if bytes.len() > bounds::SIZE {
        let text = bounds::length("a file", bounds::SIZE, "bytes");
        return Err(io::Error::new(ErrorKind::FileTooLarge, text));
    }
    String::from_utf8(bytes).map_err(|_| ErrorKind::InvalidData.into())
}

/// Waits until there are bytes or an end.
fn wait_for_bytes(file: &File) -> io::Result<()> {
    let patience = Timespec { tv_sec: PATIENCE.as_secs() as i64, tv_nsec: 0 };
    match poll(&mut [PollFd::new(file, PollFlags::IN)], Some(&patience)) {
        Ok(0) => {
            let text = format!("nothing was written to it for {} s", PATIENCE.as_secs());
            Err(io::Error::new(ErrorKind::TimedOut, text))
        }
        Ok(_) | Err(Errno::INTR) => Ok(()),
        Err(error) => Err(error.into()),
    }
}

/// Finds embedded models by name and others by path.
#[derive(Debug, Clone)]
pub struct FileLibrary {
    base: PathBuf,
    /// The files that were read.
    read: RefCell<Vec<PathBuf>>,
}

impl FileLibrary {
    /// Paths are relative to `base`.
    pub fn new(base: impl Into<PathBuf>) -> Self {
        Self { base: base.into(), read: RefCell::default() }
    }

    /// The files that were read so far.
    pub fn files(&self) -> Vec<PathBuf> {
        self.read.borrow().clone()
    }
}

impl Library for FileLibrary {
    fn fetch(&self, name: &str) -> Result<(String, String), String> {
        if let Ok(found) = BuiltinLibrary.fetch(name) {
            return Ok(found);
        }
        if !is_path(name) {
            return Err(no_model(name));
        }
        let path = self.base.join(name);
        self.read.borrow_mut().push(path.clone());
        let text = read_text(&path)
            .map_err(|error| format!("cannot read {}: {}", path.display(), plain(&error)))?;
        Ok((path.display().to_string(), text))
    }
}

/// Does `name` mean a file rather than a built-in?
pub fn is_path(name: &str) -> bool {
    let ending = Path::new(name).extension();
    name.contains('/') || ending.is_some_and(|ending| ending == "yaml" || ending == "yml")
}

/// An I/O error without its number.
pub fn plain(error: &io::Error) -> String {
    match error.kind() {
        ErrorKind::NotFound => "no such file or directory".into(),
        ErrorKind::PermissionDenied => "permission denied".into(),
        ErrorKind::IsADirectory => "this is a directory".into(),
        ErrorKind::StorageFull => "no space left on the device".into(),
        ErrorKind::InvalidData => "this is not UTF-8 text".into(),
        _ => error.to_string(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::io::Write;

    #[test]
    fn a_fifo_is_read_if_somebody_writes_it() {
        let folder = tempfile::tempdir().unwrap();
        let fifo = folder.path().join("fifo");
        rustix::fs::mkfifoat(rustix::fs::CWD, &fifo, Mode::RUSR | Mode::WUSR).unwrap();
        let path = fifo.clone();
        let writer = std::thread::spawn(move || {
            let mut fifo = File::options().write(true).open(path).unwrap();
            for part in ["a: ", "b\n", "c: d\n"] {
                fifo.write_all(part.as_bytes()).unwrap();
                std::thread::yield_now();
            }
        });
        assert_eq!(read_text(&fifo).unwrap(), "a: b\nc: d\n");
        writer.join().unwrap();
    }

    #[test]
    fn what_has_no_end_is_refused() {
        let endless = read_text(Path::new("/dev/zero")).unwrap_err();
        assert_eq!(endless.kind(), ErrorKind::FileTooLarge);
        assert_eq!(endless.to_string(), "a file may have at most 16777216 bytes");
        assert_eq!(read_text(Path::new("/")).unwrap_err().kind(), ErrorKind::IsADirectory);
        assert_eq!(read_text(Path::new("/dev/null")).unwrap(), "");
    }
}
