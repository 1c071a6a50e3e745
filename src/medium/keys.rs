//! Keys that a kind of fault has of its own: what each accepts, and how it is read.

use crate::problem::decode::decode;
use crate::problem::tree::Node;
use crate::problem::{Path, Problem};
use std::ops::RangeInclusive;

/// A key of a kind of fault.
#[derive(Debug, Clone)]
pub struct FaultKey {
    /// Its name in files.
    pub name: &'static str,
    /// What it says, for the schema.
    pub about: &'static str,
    /// What it accepts.
    pub form: KeyForm,
    /// Must it be given?
    pub is_required: bool,
}

/// What a key accepts.
#[derive(Debug, Clone)]
pub enum KeyForm {
    /// A whole number from one to the other.
    Number(u64, u64),
    /// Milliseconds, or a range of them such as `50-200`; above 0.
    Milliseconds,
}

impl FaultKey {
    pub(super) const fn number(
        name: &'static str,
        about: &'static str,
        least: u64,
        most: u64,
    ) -> Self {
        Self { name, about, form: KeyForm::Number(least, most), is_required: false }
    }

    pub(super) const fn milliseconds(name: &'static str, about: &'static str) -> Self {
        Self { name, about, form: KeyForm::Milliseconds, is_required: false }
    }

    pub(super) const fn required(self) -> Self {
        Self { is_required: true, ..self }
    }

    /// Reads `node` at `path`: one number, as a range of one, or a range.
    fn read(&self, node: &Node, path: &Path, problems: &mut Vec<Problem>) -> Option<[u64; 2]> {
        match self.form {
            KeyForm::Number(least, most) => {
                let number = decode(node, path, &[], problems)?;
                within(self.name, number, least..=most, path, problems).map(|it| [it, it])
            }
            KeyForm::Milliseconds => {
                let range = milliseconds(node);
                let what = match (range, node.as_u64().is_some() || node.as_text().is_some()) {
                    (Some([least, most]), _) if least <= most && most > 0 => return range,
                    (_, true) => "`ms` must be above 0, or a range such as 50-200",
                    (_, false) => "expected milliseconds, or a range such as 50-200",
                };
                problems.push(Problem::value(path.clone(), what));
                None
            }
        }
    }
}

fn milliseconds(node: &Node) -> Option<[u64; 2]> {
    let number = |text: &str| text.trim().parse::<u32>().ok().map(u64::from);
    if let Some(fixed) = node.as_u64() {
        return (fixed <= u32::MAX.into()).then_some([fixed, fixed]);
    }
    let (least, most) = node.as_text()?.split_once('-')?;
    Some([number(least)?, number(most)?])
}

#[cfg(feature = "cli")]
impl KeyForm {
    /// The JSON Schema of what it accepts.
    pub(super) fn schema(&self) -> serde_json::Value {
        match self {
            Self::Number(least, most) => {
                serde_json::json!({"type": "integer", "minimum": least, "maximum": most})
            }
            Self::Milliseconds => serde_json::json!({"type": ["integer", "string"]}),
        }
    }
}

/// The value of `key` at `path`, if it is one of `range`.
pub(super) fn within<T: Copy + PartialOrd + std::fmt::Display>(
    key: &str,
    value: T,
    range: RangeInclusive<T>,
    path: &Path,
    problems: &mut Vec<Problem>,
) -> Option<T> {
    if range.contains(&value) {
        return Some(value);
    }
    let what = match value < *range.start() {
        true => format!("`{key}` must be at least {}", range.start()),
        false => format!("`{key}` must be at most {}", range.end()),
    };
    problems.push(Problem::value(path.clone(), what));
    None
}

/// Why the keys of a rule make no fault, each of them being possible.
#[derive(Debug)]
pub(super) struct KeyRefusal {
    /// The key.
    pub key: &'static str,
    /// Why.
    pub what: String,
}

/// The keys of its own that a rule gives to its kind.
#[derive(Debug, Default)]
pub(super) struct FaultKeys {
    unit: Option<u8>,
    ranges: Vec<(&'static str, [u64; 2])>,
}

impl FaultKeys {
    /// Of a rule for `unit`.
    pub fn of(unit: Option<u8>) -> Self {
        Self { unit, ranges: Vec::new() }
    }

    /// Reads `node` at `path` as `key`.
    pub fn put(
        &mut self,
        key: &'static FaultKey,
        node: &Node,
        path: &Path,
        problems: &mut Vec<Problem>,
    ) {
        let range = key.read(node, path, problems);
        self.ranges.extend(range.map(|range| (key.name, range)));
    }

    /// The unit that the rule is for, if it names one.
    pub fn unit(&self) -> Option<u8> {
        self.unit
    }

    /// The number that `key` gives, if it is there. Its range fits the type.
    pub fn number<T: TryFrom<u64>>(&self, key: &str) -> Option<T> {
        self.range(key).and_then(|[least, _]| T::try_from(least).ok())
    }

    /// The range that `key` gives, if it is there.
    pub fn range(&self, key: &str) -> Option<[u64; 2]> {
        self.ranges.iter().find(|(name, _)| *name == key).map(|(_, range)| *range)
    }
}
