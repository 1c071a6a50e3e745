//! Lists the files in `models/` so that they can be embedded: a new model needs no Rust.

use std::fmt::Write as _;
use std::path::{Path, PathBuf};
use std::{env, fs, io};

fn main() -> io::Result<()> {
    let root = PathBuf::from(env::var("CARGO_MANIFEST_DIR").map_err(io::Error::other)?);
    let models = root.join("models");
    println!("cargo:rerun-if-changed={}", models.display());
    let mut files: Vec<PathBuf> = fs::read_dir(&models)?
        .map(|entry| entry.map(|entry| entry.path()))
        .collect::<io::Result<_>>()?;
    files.retain(|file| file.extension().is_some_and(|ending| ending == "yaml"));
    files.sort();

    let mut list = String::from(
        "/// File name and text of each model.\npub const FILES: &[(&str, &str)] = &[\n",
    );
    for file in &files {
        let name = file.file_name().unwrap_or_default().to_string_lossy();
        writeln!(list, "    (\"models/{name}\", include_str!({:?})),", file.display())
            .map_err(io::Error::other)?;
    }
    list.push_str("];\n");
    let default = fs::read_to_string(models.join("DEFAULT"))?;
    writeln!(
        list,
        "/// The model that runs when none is named.\npub const DEFAULT: &str = {:?};",
        default.trim()
    )
    .map_err(io::Error::other)?;

    let out = env::var("OUT_DIR").map_err(io::Error::other)?;
    fs::write(Path::new(&out).join("models.rs"), list)
}
