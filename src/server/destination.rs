//! Where a run writes a file, and how: beside it and moved over it, or into what is no file.
//!
//! Deliberately no text and no decision on when: the log, the ready file and the report have those. A path that leads
//! to a device, to a FIFO or to our own stdout is written to as it is: nothing there is replaced or removed.

use super::sink::{Open, Sink, Writable};
use std::fs::{self, File};
use std::io::{self, ErrorKind, Write};
use std::os::fd::AsFd;
use std::os::unix::fs::{FileTypeExt, MetadataExt, PermissionsExt};
use std::path::{Path, PathBuf};

/// Links that are followed before they count as a circle, as on Linux.
const MOST_LINKS: usize = 40;

/// Where a file goes.
#[derive(Debug, Clone)]
pub struct Destination {
    /// As the user calls it.
    path: PathBuf,
    /// Where that leads: a link stays one.
    target: PathBuf,
    kind: FileKind,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum FileKind {
    /// A file, or nothing yet.
    File,
    /// A device or a FIFO. To open it may wait for a reader.
    Special,
    Stdout,
    Stderr,
}

/// What a file is, whatever it is called: device and number of its inode.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct FileId(u64, u64);

impl FileId {
    /// Of the file that `path` leads to, if it is one.
    pub fn of(path: &Path) -> Option<Self> {
        fs::metadata(path).ok().filter(fs::Metadata::is_file).map(|it| Self::from(&it))
    }
}

impl From<&fs::Metadata> for FileId {
    fn from(metadata: &fs::Metadata) -> Self {
        Self(metadata.dev(), metadata.ino())
    }
}

impl Destination {
    /// Finds out where `path` leads. Nothing is touched.
    ///
    /// # Errors
    /// Its folder is not there, or it is a folder itself, or a socket.
    pub fn find(path: &Path) -> io::Result<Self> {
        let places = places(path)?;
        let stream = places.iter().find_map(|place| own_stream(place));
        let target = places.into_iter().next_back().unwrap_or_default();
        let kind = match (stream, fs::metadata(path)) {
            (Some(stream), _) => stream,
            (None, Err(error)) if error.kind() == ErrorKind::NotFound => FileKind::File,
            (None, Err(error)) => return Err(error),
            (None, Ok(it)) if it.is_file() => FileKind::File,
            (None, Ok(it)) if it.file_type().is_char_device() || it.file_type().is_fifo() => {
                FileKind::Special
            }
            (None, Ok(it)) if it.is_dir() => return Err(ErrorKind::IsADirectory.into()),
            (None, Ok(_)) => return Err(io::Error::other("neither a file nor a device")),
        };
        Ok(Self { path: path.to_owned(), target, kind })
    }

    /// As the user calls it.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Is it our own stdout or stderr?
    pub fn is_own_stream(&self) -> bool {
        matches!(self.kind, FileKind::Stdout | FileKind::Stderr)
    }

    /// Starts to write lines to it, from an empty file on; `room` lines may wait.
    ///
    /// # Errors
    /// If a file can't be created. What is wrong with anything else shows later.
    pub fn stream<T: Writable>(&self, room: usize) -> io::Result<Sink<T>> {
        let open: Open = match self.kind {
            FileKind::File => {
                let file = File::create(&self.target)?;
                Box::new(move || Ok(Box::new(file)))
            }
            FileKind::Special => {
                let path = self.path.clone();
                Box::new(move || Ok(Box::new(File::options().write(true).open(path)?)))
            }
            FileKind::Stdout => own(io::stdout().as_fd().try_clone_to_owned()?.into()),
            FileKind::Stderr => own(io::stderr().as_fd().try_clone_to_owned()?.into()),
        };
        Sink::start("output", room, open)
    }

    /// Writes `text`, there whole or not at all: beside it first, then moved over it. What is no file gets it as it
    /// is, from a thread whose end is still to be waited for.
    ///
    /// # Errors
    /// What the file system says.
    pub fn write(&self, text: &str) -> io::Result<Written> {
        if self.kind != FileKind::File {
            let mut sink = self.stream::<String>(1)?;
            sink.put(text.into());
            sink.close();
            return Ok(Written::UnderWay(sink));
        }
        let folder = folder(&self.target);
        // As readable as any other file that a program makes.
        let mode = fs::Permissions::from_mode(0o644);
        let mut file = tempfile::Builder::new().permissions(mode).tempfile_in(folder)?;
        file.write_all(text.as_bytes())?;
        let file = file.persist(&self.target).map_err(|failed| failed.error)?;
        Ok(Written::File(FileId::from(&file.metadata()?)))
    }

    /// Removes the file, if there is one: it speaks of an earlier run.
    ///
    /// # Errors
    /// What the file system says.
    pub fn forget(&self) -> io::Result<()> {
        if self.kind != FileKind::File {
            return Ok(());
        }
        match fs::remove_file(&self.target) {
            Err(error) if error.kind() != ErrorKind::NotFound => Err(error),
            _ => Ok(()),
        }
    }

    /// Removes the file that was `written`, unless another has taken its place since.
    ///
    /// # Errors
    /// What the file system says.
    pub fn take_back(&self, written: FileId) -> io::Result<()> {
        if FileId::of(&self.target) == Some(written) { self.forget() } else { Ok(()) }
    }
}

/// What became of a text.
#[derive(Debug)]
pub enum Written {
    /// A regular file, by its identity on the file system.
    File(FileId),
    /// It is on its way to something that is no file.
    UnderWay(Sink<String>),
}

fn own(file: File) -> Open {
    Box::new(move || Ok(Box::new(file)))
}

/// `/dev/stdout` and the like: opening them again would write at another offset of the same file.
fn own_stream(place: &Path) -> Option<FileKind> {
    let folder = place.parent()?;
    let ours = Path::new("/proc").join(std::process::id().to_string()).join("fd");
    if folder != ours && folder != Path::new("/dev/fd") {
        return None;
    }
    match place.file_name()?.to_str()? {
        "1" => Some(FileKind::Stdout),
        "2" => Some(FileKind::Stderr),
        _ => None,
    }
}

/// The names that `path` goes by, from link to link, each with its folder as it is: the last is no link.
///
/// # Errors
/// A folder on the way is not there, or the links are a circle.
pub fn places(path: &Path) -> io::Result<Vec<PathBuf>> {
    let mut places = Vec::new();
    let mut next = path.to_owned();
    while places.len() < MOST_LINKS {
        let place = match next.file_name() {
            Some(name) => folder(&next).canonicalize()?.join(name),
            // `.`, `..` and `/` have no name in a folder.
            None => next.canonicalize()?,
        };
        let leads = fs::read_link(&place);
        places.push(place.clone());
        match leads {
            Ok(leads) => next = folder(&place).join(leads),
            Err(_) => return Ok(places),
        }
    }
    Err(io::Error::other("too many levels of symbolic links"))
}

/// The folder that `path` lies in.
pub fn folder(path: &Path) -> &Path {
    path.parent().filter(|it| !it.as_os_str().is_empty()).unwrap_or(Path::new("."))
}
