//! Files that hold what a test expects: compared, or rewritten when asked to.

use std::fs;
use std::path::{Path, PathBuf};

/// A path inside the repository.
pub fn root(path: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join(path)
}

/// The text of a file inside the repository.
pub fn read(path: &Path) -> String {
    fs::read_to_string(path).unwrap_or_else(|error| panic!("{}: {error}", path.display()))
}

/// The files below `folder` whose name ends with `.ending`, in order, folders in it included.
pub fn files(folder: &str, ending: &str) -> Vec<PathBuf> {
    let mut found = Vec::new();
    let mut folders = vec![root(folder)];
    while let Some(folder) = folders.pop() {
        let entries = fs::read_dir(&folder).unwrap_or_else(|e| panic!("{}: {e}", folder.display()));
        for entry in entries {
            let entry = entry.expect("an entry of a folder");
            // Links are not followed: they may lead round in circles.
            let kind = entry.file_type().expect("the kind of an entry");
            if kind.is_dir() {
                folders.push(entry.path());
            } else if kind.is_file() && entry.path().extension().is_some_and(|it| it == ending) {
                found.push(entry.path());
            }
        }
    }
    found.sort();
    found
}

/// Compares `got` with the file at `path`, or writes it there if the variable `update` is set.
///
/// # Errors
/// The first line that differs, and what to do.
pub fn same(path: &Path, got: &str, update: &str) -> Result<(), String> {
    let want = fs::read_to_string(path).unwrap_or_default();
    if want == got {
        return Ok(());
    }
    if std::env::var_os(update).is_some() {
        return fs::write(path, got).map_err(|error| format!("{}: {error}", path.display()));
    }
    let (mut wants, mut gots, mut line) = (want.lines(), got.lines(), 1);
    loop {
        let (want, got) = (wants.next(), gots.next());
        if want != got || want.is_none() {
            let show = |text: Option<&str>| text.map_or("(the end)".into(), |it| format!("`{it}`"));
            let (want, got) = (show(want), show(got));
            let advice = format!("{update}=1 cargo test writes it anew");
            return Err(format!(
                "{}:{line}\n  want {want}\n  got  {got}\n  {advice}",
                path.display()
            ));
        }
        line += 1;
    }
}
