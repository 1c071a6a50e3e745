//! A path through a YAML tree: `axis.quantities[jog.speed]`, `line.refuse[2]`.

use std::fmt;

/// One step of a [`Path`].
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord)]
pub enum Seg {
    /// Into a map, by key. Integer keys stand here in decimal, whatever base the file uses.
    Key(String),
    /// Into a list, by position from 0.
    Index(usize),
}

/// A path from the root of a file to one of its nodes.
#[derive(Debug, Clone, Default, PartialEq, Eq, PartialOrd, Ord)]
pub struct Path(Vec<Seg>);

impl Path {
    /// The root.
    pub fn root() -> Self {
        Self::default()
    }

    /// Is this the root?
    pub fn is_root(&self) -> bool {
        self.0.is_empty()
    }

    /// The steps, outermost first.
    pub fn segs(&self) -> &[Seg] {
        &self.0
    }

    /// The path of the entry `key` below this one.
    #[must_use]
    pub fn key(&self, key: impl fmt::Display) -> Self {
        let mut segs = self.0.clone();
        segs.push(Seg::Key(key.to_string()));
        Self(segs)
    }

    /// The path of item `index` below this one.
    #[must_use]
    pub fn index(&self, index: usize) -> Self {
        let mut segs = self.0.clone();
        segs.push(Seg::Index(index));
        Self(segs)
    }

    /// This path with `tail` behind it.
    #[must_use]
    pub fn join(&self, tail: &Path) -> Self {
        Self(self.0.iter().chain(&tail.0).cloned().collect())
    }

    /// The path of the node above, or `None` at the root.
    pub fn parent(&self) -> Option<Self> {
        let (_, above) = self.0.split_last()?;
        Some(Self(above.to_vec()))
    }
}

impl fmt::Display for Path {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for (i, seg) in self.0.iter().enumerate() {
            match seg {
                Seg::Key(key) if is_plain(key) && i == 0 => write!(f, "{key}")?,
                Seg::Key(key) if is_plain(key) => write!(f, ".{key}")?,
                Seg::Key(key) => write!(f, "[{key}]")?,
                Seg::Index(index) => write!(f, "[{index}]")?,
            }
        }
        Ok(())
    }
}

fn is_plain(key: &str) -> bool {
    key.starts_with(|c: char| c.is_ascii_alphabetic() || c == '_')
        && key.chars().all(|c| c.is_ascii_alphanumeric() || matches!(c, '_' | '-'))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn reads_like_the_file() {
        let path = Path::root().key("axis").key("quantities").key("jog.speed");
        assert_eq!(path.to_string(), "axis.quantities[jog.speed]");
        assert_eq!(Path::root().key("line").key("refuse").index(2).to_string(), "line.refuse[2]");
    }
}
