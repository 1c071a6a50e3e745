//! `drivemu schema`: JSON Schema of the file formats.

use super::args::{SchemaArgs, SchemaFormat};
use super::output::print;
use super::{CliError, FAILED};

pub fn schema(args: &SchemaArgs) -> Result<(), CliError> {
    let schema = match args.format {
        SchemaFormat::Model => crate::model::raw::schema(),
        SchemaFormat::Scenario => crate::scenario::raw::schema(),
        SchemaFormat::Bench => crate::bench::raw::schema(),
    };
    let text = serde_json::to_string_pretty(&schema);
    let text = text.map_err(|error| CliError { code: FAILED, text: error.to_string() })?;
    print(&format!("{text}\n"))
}
