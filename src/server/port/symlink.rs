//! A symlink that stands for a pseudo-terminal as long as that lives.
//!
//! `/dev/pts/7` is another number on every run, so scripts open the link. It replaces the leftover of a run that
//! was killed and nothing else: not the link of a run that is alive, nor one to anything that is still there.

use std::ffi::OsString;
use std::fs::Metadata;
use std::io::{self, ErrorKind};
use std::os::unix::fs::{FileTypeExt, MetadataExt, symlink};
use std::path::{Path, PathBuf};

use super::said;
use super::serial::is_pseudo_terminal;
use crate::server::paths::PathLock;

/// A symlink of ours; gone when this is dropped.
#[derive(Debug)]
pub(super) struct PortSymlink {
    at: PathBuf,
    target: PathBuf,
    /// Device and number of the symlink itself.
    identity: Option<(u64, u64)>,
    _mark: PathLock,
}

impl PortSymlink {
    /// Makes `at` a symlink to `target`.
    ///
    /// # Errors
    /// `ResourceBusy` when a living run has it, or it leads to something that is there; `AlreadyExists` when something
    /// other than a symlink is there, `NotFound` or `NotADirectory` when its directory is not.
    pub(super) fn create(at: &Path, target: &Path) -> io::Result<Self> {
        // Absolute, so that dropping it finds it from any working directory.
        let absolute = std::path::absolute(at)?;
        let made = PathLock::take(at).and_then(|mark| {
            // The plain call can't replace anything, whatever happens between a look and an act.
            match symlink(target, at) {
                Err(e) if e.kind() == ErrorKind::AlreadyExists => replace(at, target)?,
                other => other?,
            }
            Ok(mark)
        });
        let mark = made.map_err(|e| {
            said(e.kind(), format!("cannot create the link {}: {}", at.display(), why(at, &e)))
        })?;
        let identity = identity(at);
        Ok(Self { at: absolute, target: target.to_owned(), identity, _mark: mark })
    }

    /// Where the link is, as an absolute path.
    pub(super) fn at(&self) -> &Path {
        &self.at
    }
}

impl Drop for PortSymlink {
    fn drop(&mut self) {
        // Another process may have replaced it.
        let is_ours = std::fs::read_link(&self.at).is_ok_and(|target| target == self.target)
            && identity(&self.at) == self.identity;
        if is_ours {
            // The run is over, and a leftover link is replaced by the next one.
            let _ = std::fs::remove_file(&self.at);
        }
    }
}

fn identity(at: &Path) -> Option<(u64, u64)> {
    at.symlink_metadata().ok().map(|link| (link.dev(), link.ino()))
}

/// Replaces a leftover symlink in one step: at no time is there none, and who opens it gets the old or the new.
fn replace(at: &Path, target: &Path) -> io::Result<()> {
    let link = at.symlink_metadata()?;
    if !link.is_symlink() {
        let what = "exists and is not a symlink: not replaced";
        return Err(said(ErrorKind::AlreadyExists, what));
    }
    match std::fs::metadata(at) {
        Err(error) if error.kind() == ErrorKind::NotFound => {}
        Ok(found) if is_leftover(at, &link, &found, target) => {}
        Ok(_) => {
            let target = std::fs::canonicalize(at)?;
            let use_of =
                if is_pseudo_terminal(&target.to_string_lossy()) { "is in use" } else { "exists" };
            let what = format!("points to {}, which {use_of}: not replaced", target.display());
            return Err(said(ErrorKind::ResourceBusy, what));
        }
        Err(error) => return Err(error),
    }
    let beside = symlink_beside(at, target)?;
    std::fs::rename(&beside, at).inspect_err(|_| {
        let _ = std::fs::remove_file(&beside);
    })
}

/// Was `link` left by a killed run, though there is something at its end? Terminals are numbered anew: it may lead to
/// our own, or to one that was opened after the link was made.
fn is_leftover(at: &Path, link: &Metadata, found: &Metadata, target: &Path) -> bool {
    let ours = std::fs::metadata(target);
    if ours.is_ok_and(|ours| (ours.dev(), ours.ino()) == (found.dev(), found.ino())) {
        return true;
    }
    found.file_type().is_char_device()
        && is_pseudo_terminal(&at.to_string_lossy())
        && (found.ctime(), found.ctime_nsec()) > (link.mtime(), link.mtime_nsec())
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

    /// A terminal that is not there.
    const GONE: &str = "/dev/pts/gone";

    fn target(link: &Path) -> PathBuf {
        std::fs::read_link(link).unwrap()
    }

    #[test]
    fn lives_as_long_as_its_value_and_leaves_nothing_behind() {
        let dir = tempfile::tempdir().unwrap();
        let at = dir.path().join("cell.tty");
        symlink("/dev/pts/leftover", &at).unwrap();

        let link = PortSymlink::create(&at, Path::new(GONE)).unwrap();
        assert_eq!(target(&at), Path::new(GONE));
        assert_eq!(link.at(), at);
        assert_eq!(std::fs::read_dir(dir.path()).unwrap().count(), 1, "the temporary link is gone");

        drop(link);
        assert!(!at.is_symlink());
    }

    /// The number of a terminal of a killed run was given to another program, or to us.
    #[tokio::test]
    async fn a_leftover_link_to_a_number_that_was_given_anew_is_replaced() {
        use rustix::fs::{AtFlags, CWD, Timespec, Timestamps, utimensat};
        let dir = tempfile::tempdir().unwrap();
        let at = dir.path().join("cell.tty");
        let pty = super::super::pty::Pty::open(None).unwrap();
        let terminal = pty.path().to_owned();
        symlink(&terminal, &at).unwrap();
        drop(PortSymlink::create(&at, &terminal).unwrap());
        symlink(&terminal, &at).unwrap();
        PortSymlink::create(&at, Path::new(GONE)).unwrap_err();
        let then = Timespec { tv_sec: 1_000_000_000, tv_nsec: 0 };
        let times = Timestamps { last_access: then, last_modification: then };
        utimensat(CWD, &at, &times, AtFlags::SYMLINK_NOFOLLOW).unwrap();
        let _link = PortSymlink::create(&at, Path::new(GONE)).unwrap();
        assert_eq!(target(&at), Path::new(GONE));
    }

    #[tokio::test]
    async fn refuses_to_replace_a_link_to_something_that_is_there() {
        let dir = tempfile::tempdir().unwrap();
        let (inside, at) = (dir.path().join("inside"), dir.path().join("cell.tty"));
        std::fs::create_dir(&inside).unwrap();
        let file = dir.path().join("notes.txt");
        std::fs::write(&file, "precious").unwrap();
        let pty = super::super::pty::Pty::open(None).unwrap();
        let terminal = pty.path().to_owned();
        for (there, says) in [
            (&*inside, "exists"),
            (&*file, "exists"),
            (Path::new("/dev/null"), "exists"),
            (&*terminal, "is in use"),
        ] {
            symlink(there, &at).unwrap();
            let refused = PortSymlink::create(&at, Path::new(GONE)).unwrap_err();
            assert_eq!(refused.kind(), ErrorKind::ResourceBusy, "{refused}");
            assert!(refused.to_string().ends_with(&format!("{says}: not replaced")), "{refused}");
            assert_eq!(target(&at), there);
            std::fs::remove_file(&at).unwrap();
        }
        assert_eq!(std::fs::read_dir(&inside).unwrap().count(), 0);
    }

    #[cfg(target_os = "linux")]
    #[test]
    fn refuses_the_link_of_a_living_run_in_whatever_spelling() {
        let dir = tempfile::tempdir().unwrap();
        let at = dir.path().join("cell.tty");
        let _link = PortSymlink::create(&at, Path::new(GONE)).unwrap();
        for again in [&at, &dir.path().join("./cell.tty"), &dir.path().join("../").join(&at)] {
            let refused = PortSymlink::create(again, Path::new("/dev/pts/gone-2")).unwrap_err();
            assert_eq!(refused.kind(), ErrorKind::ResourceBusy);
            assert!(refused.to_string().ends_with("used by a running drivemu"), "{refused}");
        }
        assert_eq!(target(&at), Path::new(GONE));
    }

    #[test]
    fn leaves_alone_what_somebody_else_has_put_there() {
        let dir = tempfile::tempdir().unwrap();
        let (at, aside) = (dir.path().join("cell.tty"), dir.path().join("aside"));
        for other in ["/dev/pts/gone-2", GONE] {
            let link = PortSymlink::create(&at, Path::new(GONE)).unwrap();
            // Kept, or its number could be given to the next.
            std::fs::rename(&at, &aside).unwrap();
            symlink(other, &at).unwrap();
            drop(link);
            assert_eq!(target(&at), Path::new(other));
            std::fs::remove_file(&at).unwrap();
        }
    }

    #[test]
    fn a_leftover_temporary_name_is_in_nobodys_way() {
        let dir = tempfile::tempdir().unwrap();
        let at = dir.path().join("cell.tty");
        symlink(GONE, &at).unwrap();
        // What a run with our process number, killed before its rename, leaves behind.
        let leftover = symlink_beside(&at, Path::new(GONE)).unwrap();
        let _link = PortSymlink::create(&at, Path::new("/dev/pts/gone-2")).unwrap();
        assert_eq!(target(&at), Path::new("/dev/pts/gone-2"));
        assert_eq!(target(&leftover), Path::new(GONE));
    }

    #[test]
    fn refuses_to_replace_anything_but_a_symlink() {
        let dir = tempfile::tempdir().unwrap();
        let (file, sub) = (dir.path().join("notes.txt"), dir.path().join("sub"));
        std::fs::write(&file, "precious").unwrap();
        std::fs::create_dir(&sub).unwrap();
        for at in [&file, &sub] {
            let refused = PortSymlink::create(at, Path::new(GONE)).unwrap_err();
            assert_eq!(refused.kind(), ErrorKind::AlreadyExists);
            assert_eq!(
                refused.to_string(),
                format!(
                    "cannot create the link {}: exists and is not a symlink: not replaced",
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
        let refused = PortSymlink::create(&missing.join("a.tty"), Path::new(GONE)).unwrap_err();
        assert_eq!(refused.kind(), ErrorKind::NotFound);
        assert!(refused.to_string().ends_with(&format!("no directory {}", missing.display())));

        std::fs::write(&missing, "").unwrap();
        let refused = PortSymlink::create(&missing.join("a.tty"), Path::new(GONE)).unwrap_err();
        assert!(refused.to_string().ends_with("is not a directory"), "{refused}");
    }
}
