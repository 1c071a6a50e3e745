//! The models embedded in the binary, found by name or by product.

use super::Model;
use super::load::{Choices, load};
use crate::problem::Problem;

mod files {
    include!(concat!(env!("OUT_DIR"), "/models.rs"));
}

/// A model file embedded in the binary.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Builtin {
    /// File name, for messages.
    pub file: &'static str,
    /// YAML.
    pub text: &'static str,
}

impl Builtin {
    /// All of them, by file name.
    pub fn all() -> impl Iterator<Item = Self> {
        files::FILES.iter().map(|(file, text)| Self { file, text })
    }

    /// The model that runs when none is named.
    pub fn default_name() -> &'static str {
        files::DEFAULT
    }

    /// The embedded model called `name`, or the one that stands for the product `name`.
    pub fn find(name: &str) -> Option<Self> {
        let is_named = |it: &Self| {
            let Ok(model) = it.load(&Choices::default()) else { return false };
            let product = model.products.iter().any(|product| product.eq_ignore_ascii_case(name));
            model.name == name || product
        };
        Self::all().find(|it| it.stem() == name).or_else(|| Self::all().find(is_named))
    }

    /// The file's name without folder and ending, which is the model's name.
    pub fn stem(&self) -> &'static str {
        let name = self.file.rsplit('/').next().unwrap_or(self.file);
        name.strip_suffix(".yaml").unwrap_or(name)
    }

    /// Compiles it with `choices`.
    pub fn load(&self, choices: &Choices) -> Result<Model, Vec<Problem>> {
        load(self.text, choices)
    }
}
