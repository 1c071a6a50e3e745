//! Model files from the disk, beside the embedded ones.

use super::input::read_text;
use crate::bench::{BuiltinLibrary, Library, no_model};

use std::cell::RefCell;
use std::path::{Path, PathBuf};

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
pub fn plain(error: &std::io::Error) -> String {
    match error.kind() {
        std::io::ErrorKind::NotFound => "no such file or directory".into(),
        std::io::ErrorKind::PermissionDenied => "permission denied".into(),
        std::io::ErrorKind::IsADirectory => "this is a directory".into(),
        std::io::ErrorKind::StorageFull => "no space left on the device".into(),
        std::io::ErrorKind::InvalidData => "this is not UTF-8 text".into(),
        _ => error.to_string(),
    }
}
