//! A symlink that stands for a pseudo-terminal as long as that lives.
//!
//! `/dev/pts/7` is another number on every run, so scripts open the link. It replaces a symlink (the
//! leftover of a run that was killed) and nothing else: a typed path must not cost anybody a file.

use std::ffi::OsString;
use std::io::{self, ErrorKind};
use std::os::unix::fs::symlink;
use std::path::{Path, PathBuf};

use super::said;

/// A symlink of ours; gone when this is dropped.
#[derive(Debug)]
pub(super) struct Link {
    at: PathBuf,
    target: PathBuf,
}

impl Link {
    /// Makes `at` a symlink to `target`.
    ///
    /// # Errors
    /// `AlreadyExists` when something other than a symlink is there, `NotFound` or `NotADirectory`
    /// when its directory is not.
    pub(super) fn create(at: &Path, target: &Path) -> io::Result<Self> {
        // Absolute, so that dropping it finds it from any working directory.
        let absolute = std::path::absolute(at)?;
        // The plain call can't replace anything, whatever happens between a look and an act.
        match symlink(target, at) {
            Err(e) if e.kind() == ErrorKind::AlreadyExists => replace(at, target),
            other => other,
        }
        .map_err(|e| {
            said(e.kind(), format!("cannot create the link {}: {}", at.display(), why(at, &e)))
        })?;
        Ok(Self { at: absolute, target: target.to_owned() })
    }

    /// Where the link is, as an absolute path.
    pub(super) fn at(&self) -> &Path {
        &self.at
    }
}

impl Drop for Link {
    fn drop(&mut self) {
        // Another run may have replaced it by its own.
        if std::fs::read_link(&self.at).is_ok_and(|target| target == self.target) {
            // Nobody is left to tell, and a leftover link is replaced by the next run.
            let _ = std::fs::remove_file(&self.at);
        }
    }
}

/// Replaces a symlink in one step: at no time is there none, and who opens it gets the old or the new.
fn replace(at: &Path, target: &Path) -> io::Result<()> {
    if !at.symlink_metadata()?.is_symlink() {
        return Err(said(
            ErrorKind::AlreadyExists,
            "exists and is not a symlink: will not replace it",
        ));
    }
    let beside = symlink_beside(at, target)?;
    std::fs::rename(&beside, at).inspect_err(|_| {
        let _ = std::fs::remove_file(&beside);
    })
}

/// Makes the symlink under a free name in the same directory, since a rename can't leave a file system.
fn symlink_beside(at: &Path, target: &Path) -> io::Result<PathBuf> {
    let mut tries = 0;
    loop {
        let mut name = OsString::from(".");
        name.push(at.file_name().unwrap_or_default());
        name.push(format!(".{}-{tries}", std::process::id()));
        let beside = at.with_file_name(name);
        match symlink(target, &beside) {
            Ok(()) => return Ok(beside),
            Err(e) if e.kind() == ErrorKind::AlreadyExists && tries < 100 => tries += 1,
            Err(e) => return Err(e),
        }
    }
}

fn why(at: &Path, error: &io::Error) -> String {
    let directory = match at.parent() {
        Some(parent) if parent != Path::new("") => parent,
        _ => Path::new("."),
    };
    let directory = directory.display();
    match error.kind() {
        ErrorKind::NotFound => format!("there is no directory {directory}"),
        ErrorKind::NotADirectory => format!("{directory} is not a directory"),
        ErrorKind::PermissionDenied => format!("no permission to write in {directory}"),
        _ => error.to_string(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn target(link: &Path) -> PathBuf {
        std::fs::read_link(link).unwrap()
    }

    #[test]
    fn lives_as_long_as_its_value_and_leaves_nothing_behind() {
        let dir = tempfile::tempdir().unwrap();
        let at = dir.path().join("cell.tty");
        symlink("/dev/pts/leftover", &at).unwrap();

        let link = Link::create(&at, Path::new("/dev/pts/4")).unwrap();
        assert_eq!(target(&at), Path::new("/dev/pts/4"));
        assert_eq!(link.at(), at);
        assert_eq!(std::fs::read_dir(dir.path()).unwrap().count(), 1, "the temporary link is gone");

        drop(link);
        assert!(!at.is_symlink());
    }

    #[test]
    fn replaces_a_link_to_a_directory_and_not_what_is_in_it() {
        let dir = tempfile::tempdir().unwrap();
        let (inside, at) = (dir.path().join("inside"), dir.path().join("cell.tty"));
        std::fs::create_dir(&inside).unwrap();
        symlink(&inside, &at).unwrap();
        let _link = Link::create(&at, Path::new("/dev/pts/4")).unwrap();
        assert_eq!(target(&at), Path::new("/dev/pts/4"));
        assert_eq!(std::fs::read_dir(&inside).unwrap().count(), 0);
    }

    #[test]
    fn leaves_the_link_of_a_later_run_alone() {
        let dir = tempfile::tempdir().unwrap();
        let at = dir.path().join("cell.tty");
        let first = Link::create(&at, Path::new("/dev/pts/4")).unwrap();
        let second = Link::create(&at, Path::new("/dev/pts/5")).unwrap();
        drop(first);
        assert_eq!(target(&at), Path::new("/dev/pts/5"));
        drop(second);
        assert!(!at.is_symlink());
    }

    #[test]
    fn a_leftover_temporary_name_is_in_nobodys_way() {
        let dir = tempfile::tempdir().unwrap();
        let at = dir.path().join("cell.tty");
        symlink("/dev/pts/1", &at).unwrap();
        // What a run with our process number, killed before its rename, leaves behind.
        let leftover = symlink_beside(&at, Path::new("/dev/pts/1")).unwrap();
        let _link = Link::create(&at, Path::new("/dev/pts/4")).unwrap();
        assert_eq!(target(&at), Path::new("/dev/pts/4"));
        assert_eq!(target(&leftover), Path::new("/dev/pts/1"));
    }

    #[test]
    fn refuses_to_replace_anything_but_a_symlink() {
        let dir = tempfile::tempdir().unwrap();
        let (file, sub) = (dir.path().join("notes.txt"), dir.path().join("sub"));
        std::fs::write(&file, "precious").unwrap();
        std::fs::create_dir(&sub).unwrap();
        for at in [&file, &sub] {
            let refused = Link::create(at, Path::new("/dev/pts/4")).unwrap_err();
            assert_eq!(refused.kind(), ErrorKind::AlreadyExists);
            assert_eq!(
                refused.to_string(),
                format!(
                    "cannot create the link {}: exists and is not a symlink: will not replace it",
                    at.display()
                )
            );
        }
        assert_eq!(std::fs::read_to_string(&file).unwrap(), "precious");
    }

    #[test]
    fn a_missing_directory_is_named() {
        let dir = tempfile::tempdir().unwrap();
        let missing = dir.path().join("missing");
        let refused = Link::create(&missing.join("a.tty"), Path::new("/dev/pts/4")).unwrap_err();
        assert_eq!(refused.kind(), ErrorKind::NotFound);
        assert!(refused.to_string().ends_with(&format!("no directory {}", missing.display())));

        std::fs::write(&missing, "").unwrap();
        let refused = Link::create(&missing.join("a.tty"), Path::new("/dev/pts/4")).unwrap_err();
        assert!(refused.to_string().ends_with("is not a directory"), "{refused}");
    }
}
