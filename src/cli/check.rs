//! `drivemu check` and `drivemu schema`: every problem of every file, and the schema of the file formats.

use super::args::{CheckArgs, SchemaArgs, SchemaFormat};
use super::{CliError, FAILED, INVALID, complain, print};
use crate::bench::{kind_of, parse};
use crate::model::check as check_model;
use crate::problem::Problem;
use crate::problem::render::render;
use crate::scenario::check as check_scenario;
use crate::server::{FileLibrary, plain, read_text};
use std::path::Path;

pub fn check(args: &CheckArgs) -> Result<(), CliError> {
    let mut bad = 0;
    for file in &args.files {
        let name = file.display().to_string();
        let text = match read_text(file) {
            Ok(text) => text,
            Err(error) => {
                complain(&format!("{name}: {}", plain(&error)));
                bad += 1;
                continue;
            }
        };
        let (kind, problems) = problems(file, &text);
        match problems.as_slice() {
            [] => print(&format!("{name}: a valid {kind}\n"))?,
            problems => {
                print(&render(problems, &name, &text))?;
                bad += 1;
            }
        }
    }
    match bad {
        0 => Ok(()),
        _ => {
            let text = format!("{bad} of {} file(s) invalid", args.files.len());
            Err(CliError { code: INVALID, text })
        }
    }
}

fn problems(file: &Path, text: &str) -> (&'static str, Vec<Problem>) {
    let kind = kind_of(text);
    if kind == "bench" {
        let base = file.parent().unwrap_or(Path::new(""));
        return (kind, parse(text, &FileLibrary::new(base)).err().unwrap_or_default());
    }
    let problems = if kind == "scenario" { check_scenario(text) } else { check_model(text) };
    (kind, problems)
}

pub fn schema(args: &SchemaArgs) -> Result<(), CliError> {
    let schema = match args.format {
        SchemaFormat::Model => crate::model::raw::schema(),
        SchemaFormat::Scenario => crate::scenario::raw::schema(),
        SchemaFormat::Bench => crate::bench::raw::schema(),
        SchemaFormat::Log => crate::log::schema(),
    };
    let text = serde_json::to_string_pretty(&schema);
    let text = text.map_err(|error| CliError { code: FAILED, text: error.to_string() })?;
    print(&format!("{text}\n"))
}
