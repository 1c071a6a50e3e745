//! `drivemu models`: what is built in.

use super::output::print;
use super::{CliError, FAILED};
use crate::model::Choices;
use crate::model::builtin::Builtin;

pub fn models() -> Result<(), CliError> {
    for builtin in Builtin::all() {
        let model = builtin.load(&Choices::new()).map_err(|problems| {
            let text = format!("{} is broken: {}", builtin.file, problems[0]);
            CliError { code: FAILED, text }
        })?;
        let default = if model.name == Builtin::default_name() { " (default)" } else { "" };
        print(&format!("{}{default}\n    {}\n", model.name, model.about))?;
        print(&format!("    manual: {}\n", model.manual))?;
        if !model.products.is_empty() {
            print(&format!("    products: {}\n", model.products.join(", ")))?;
        }
        for option in &model.options {
            let choices = option.choices.iter().map(|choice| match *choice == option.default {
                true => format!("[{choice}]"),
                false => choice.clone(),
            });
            let choices = choices.collect::<Vec<_>>().join(" | ");
            print(&format!("    --set {}={choices}\n        {}\n", option.name, option.about))?;
        }
    }
    print("[A choice in brackets] is the default of its option.\n")
}
