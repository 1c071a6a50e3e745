//! The keys of maps: one name for all spellings of a number.
//!
//! Deliberately without rules of its own for what a number is: it asks the reader of the same file,
//! so that `0x11` and `17` are one key, `6.10` and `6.1` too, and `021` is a text.

use serde_yaml::Number;

/// A map key, under the name a path has for it and as it is written.
#[derive(Debug)]
pub(super) enum YamlKey {
    Scalar {
        name: String,
        written: String,
    },
    /// A map or a list: no path leads there.
    Collection,
}

impl YamlKey {
    /// The key written so; only a `plain` one (no quotes, no tag) can be a number.
    pub(super) fn new(written: String, plain: bool) -> Self {
        let number: Option<Number> = if plain { written.parse().ok() } else { None };
        Self::Scalar { name: number.map_or_else(|| written.clone(), |n| n.to_string()), written }
    }

    /// A number that is read into a text comes back as written (`0x11`), so both spellings count.
    pub(super) fn is(&self, key: &str) -> bool {
        matches!(self, Self::Scalar { name, written } if name == key || written == key)
    }
}

#[cfg(test)]
mod tests {
    use super::super::{At, Path, Places};

    #[test]
    fn integer_keys_compare_by_value() {
        for (written, name) in [
            ("17", "17"),
            ("0x11", "17"),
            ("0o21", "17"),
            ("0b10001", "17"),
            ("+17", "17"),
            ("-0x11", "-17"),
            ("0", "0"),
            ("021", "021"),
            ("0x", "0x"),
            ("0x+1", "0x+1"),
            ("6.10", "6.1"),
            ("99999999999999999999", "99999999999999999999"),
            ("--1", "--1"),
            ("1_000", "1_000"),
            ("C06.04", "C06.04"),
            ("中", "中"),
        ] {
            let (places, problems) = Places::parse(&format!("{written}: x"));
            assert_eq!(problems, []);
            assert!(places.find(&Path::root().key(name), At::Key).is_some(), "{written}");
        }
        let (places, _) = Places::parse("'0x11': x\n021: y\n!!str 0o21: z");
        assert_eq!(places.find(&Path::root().key("17"), At::Key), None);
    }
}
