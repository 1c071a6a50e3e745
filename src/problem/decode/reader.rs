//! Reads a value of a tree, and what is in it: its kind is checked before a visitor sees it, so that what is wrong is
//! said in our own words.
//!
//! An enum is one of several words, or one of several shapes of a value. An enum of shapes names each variant after
//! what it is read from: `#[serde(rename = "a number")]`. The first that fits is read, so what is wrong with it is
//! not told of the others. A name begins with `a number`, `a string`, `a list of lists`, `a list of numbers`,
//! `a list`, `a map with KEY` (`or KEY`) or `a map`; `anything else` fits always.

use super::blank::{Blank, Nothing};
use super::variant::Variant;
use super::{Holder, Misfit, MisfitCause, Pass, Trail};
use crate::problem::tree::{Content, MapEntry, Node};
use crate::problem::{At, Problem, bounds, suggest};
use serde::de::value::BorrowedStrDeserializer;
use serde::de::{DeserializeSeed, Deserializer, MapAccess, SeqAccess, Visitor};

/// Reads one value.
pub(super) struct Reader<'p, 's, 'de> {
    pub(super) pass: &'p mut Pass<'s>,
    pub(super) node: &'de Node,
    pub(super) trail: Trail<'p>,
}

impl<'p, 's, 'de> Reader<'p, 's, 'de> {
    fn misfit(&self, what: String, advice: Option<&str>) -> Misfit {
        let advice = advice.map(str::to_owned);
        Misfit::new(MisfitCause::Kind { what, advice }).located(self.node, &self.trail)
    }

    /// The value is not what was `wanted`.
    fn unexpected(&self, wanted: &str) -> Misfit {
        let is_number = |text: &str| text.parse::<serde_yaml::Number>().is_ok();
        let advice = match &self.node.content {
            Content::Number(_) | Content::Bool(_) if wanted.starts_with("a string") => {
                Some("put it in quotes")
            }
            Content::Text(text) if !wanted.contains("string") && is_number(text) => {
                Some("remove the quotes")
            }
            _ => None,
        };
        self.misfit(format!("expected {wanted}, found {}", found(&self.node.content)), advice)
    }

    fn integer<V: Visitor<'de>>(self, low: i64, high: u64, visitor: V) -> Result<V::Value, Misfit> {
        if let Content::Number(number) = &self.node.content {
            if let Some(number) = number.as_u64().filter(|it| *it <= high) {
                return visitor.visit_u64(number);
            }
            if let Some(number) = number.as_i64().filter(|it| (low..0).contains(it)) {
                return visitor.visit_i64(number);
            }
        }
        Err(self.unexpected(&match (low, high) {
            (0, u64::MAX) => "a non-negative integer".to_owned(),
            (i64::MIN, _) => "an integer".to_owned(),
            _ => format!("an integer from {low} to {high}"),
        }))
    }

    fn text<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, Misfit> {
        match &self.node.content {
            Content::Text(text) => visitor.visit_borrowed_str(text),
            _ => Err(self.unexpected("a string")),
        }
    }

    /// Reads a list, whose items can be left out one by one; those of a tuple can't.
    fn list<V: Visitor<'de>>(
        self,
        items: &'de [Node],
        is_tuple: bool,
        visitor: V,
    ) -> Result<V::Value, Misfit> {
        let Self { pass, node, trail } = self;
        let items = items.iter().enumerate();
        let read = visitor.visit_seq(Items { pass, node, trail, items, is_tuple });
        read.map_err(|misfit| misfit.located(node, &trail))
    }

    /// Reads a map; one with `fields` has no other keys than these.
    fn map<V: Visitor<'de>>(
        self,
        fields: Option<&'static [&'static str]>,
        visitor: V,
    ) -> Result<V::Value, Misfit> {
        let Self { pass, node, trail } = self;
        let entries = match &node.content {
            Content::Map(entries) => entries.as_slice(),
            Content::Null if fields.is_none() => &[],
            _ => return Err(Reader { pass, node, trail }.unexpected("a map")),
        };
        let missing: Vec<_> = pass.missing_keys(node).collect();
        let (entries, missing) = (entries.iter(), missing.into_iter());
        let read =
            visitor.visit_map(Entries { pass, node, trail, fields, entries, missing, next: None });
        read.map_err(|misfit| misfit.located(node, &trail))
    }
}

/// What stands there, in the words of a sentence.
pub(super) fn found(content: &Content) -> String {
    match content {
        Content::Null => "nothing".into(),
        Content::Bool(truth) => truth.to_string(),
        Content::Number(number) => number.to_string(),
        Content::Text(text) if text.chars().count() > 40 => {
            format!("\"{}...\"", text.chars().take(40).collect::<String>())
        }
        Content::Text(text) => format!("\"{text}\""),
        Content::List(_) => "a list".into(),
        Content::Map(_) => "a map".into(),
    }
}

/// The integers: a method each, with its limits.
macro_rules! integers {
    ($($method:ident $type:ident)*) => {
        $(fn $method<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, Misfit> {
            self.integer($type::MIN as i64, $type::MAX as u64, visitor)
        })*
    };
}

impl<'de> Deserializer<'de> for Reader<'_, '_, 'de> {
    type Error = Misfit;

    integers! {
        deserialize_u8 u8 deserialize_u16 u16 deserialize_u32 u32 deserialize_u64 u64
        deserialize_i8 i8 deserialize_i16 i16 deserialize_i32 i32 deserialize_i64 i64
    }

    fn deserialize_any<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, Misfit> {
        match &self.node.content {
            Content::Null => visitor.visit_unit(),
            Content::Bool(truth) => visitor.visit_bool(*truth),
            Content::Number(number) => match (number.as_u64(), number.as_i64()) {
                (Some(number), _) => visitor.visit_u64(number),
                (_, Some(number)) => visitor.visit_i64(number),
                _ => visitor.visit_f64(number.as_f64().unwrap_or_default()),
            },
            Content::Text(text) => visitor.visit_borrowed_str(text),
            Content::List(items) => self.list(items, false, visitor),
            Content::Map(_) => self.map(None, visitor),
        }
    }

    fn deserialize_bool<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, Misfit> {
        match self.node.content {
            Content::Bool(truth) => visitor.visit_bool(truth),
            _ => Err(self.unexpected("true or false")),
        }
    }

    fn deserialize_f64<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, Misfit> {
        match &self.node.content {
            Content::Number(number) => visitor.visit_f64(number.as_f64().unwrap_or_default()),
            _ => Err(self.unexpected("a number")),
        }
    }

    fn deserialize_f32<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, Misfit> {
        self.deserialize_f64(visitor)
    }

    fn deserialize_str<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, Misfit> {
        self.text(visitor)
    }

    fn deserialize_string<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, Misfit> {
        self.text(visitor)
    }

    fn deserialize_option<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, Misfit> {
        match self.node.content {
            Content::Null => visitor.visit_none(),
            _ => visitor.visit_some(self),
        }
    }

    fn deserialize_newtype_struct<V: Visitor<'de>>(
        self,
        _: &'static str,
        visitor: V,
    ) -> Result<V::Value, Misfit> {
        visitor.visit_newtype_struct(self)
    }

    fn deserialize_seq<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, Misfit> {
        match &self.node.content {
            Content::List(items) => self.list(items, false, visitor),
            Content::Null => visitor.visit_seq(Nothing),
            _ => Err(self.unexpected("a list")),
        }
    }

    fn deserialize_tuple<V: Visitor<'de>>(
        self,
        len: usize,
        visitor: V,
    ) -> Result<V::Value, Misfit> {
        match &self.node.content {
            Content::List(items) if items.len() == len => self.list(items, true, visitor),
            Content::List(items) => {
                let what = format!("expected a list of {len} values, found {}", items.len());
                Err(self.misfit(what, None))
            }
            _ => Err(self.unexpected(&format!("a list of {len} values"))),
        }
    }

    fn deserialize_map<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, Misfit> {
        self.map(None, visitor)
    }

    fn deserialize_struct<V: Visitor<'de>>(
        self,
        _: &'static str,
        fields: &'static [&'static str],
        visitor: V,
    ) -> Result<V::Value, Misfit> {
        self.map(Some(fields), visitor)
    }

    fn deserialize_enum<V: Visitor<'de>>(
        self,
        _: &'static str,
        variants: &'static [&'static str],
        visitor: V,
    ) -> Result<V::Value, Misfit> {
        let (node, trail) = (self.node, self.trail);
        let read = visitor.visit_enum(variant(self, variants)?);
        read.map_err(|misfit| misfit.located(node, &trail))
    }

    fn deserialize_ignored_any<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, Misfit> {
        visitor.visit_unit()
    }

    serde::forward_to_deserialize_any! {
        i128 u128 char bytes byte_buf unit unit_struct tuple_struct identifier
    }
}

/// The items of a list, each at its place.
struct Items<'p, 's, 'de> {
    pass: &'p mut Pass<'s>,
    node: &'de Node,
    trail: Trail<'p>,
    items: std::iter::Enumerate<std::slice::Iter<'de, Node>>,
    is_tuple: bool,
}

impl<'de> SeqAccess<'de> for Items<'_, '_, 'de> {
    type Error = Misfit;

    fn next_element_seed<T: DeserializeSeed<'de>>(
        &mut self,
        seed: T,
    ) -> Result<Option<T::Value>, Misfit> {
        let Some((index, node)) = self.items.next() else { return Ok(None) };
        self.pass.work += 1;
        if self.pass.gaps.contains_key(&std::ptr::from_ref(node)) {
            let blank = seed.deserialize(Blank).map(Some);
            return blank
                .map_err(|_| Misfit::new(MisfitCause::NoBlank).located(self.node, &self.trail));
        }
        let trail = Trail::Index(&self.trail, index);
        let read = seed.deserialize(Reader { pass: self.pass, node, trail });
        read.map(Some).map_err(|misfit| match self.is_tuple {
            true => Misfit { node: self.node, ..misfit },
            false => misfit.held_by(Holder::List),
        })
    }

    fn size_hint(&self) -> Option<usize> {
        Some(self.items.len())
    }
}

/// The entries of a map, and the blanks for those that must be there.
struct Entries<'p, 's, 'de> {
    pass: &'p mut Pass<'s>,
    node: &'de Node,
    trail: Trail<'p>,
    fields: Option<&'static [&'static str]>,
    entries: std::slice::Iter<'de, MapEntry>,
    missing: std::vec::IntoIter<&'static str>,
    /// The entry whose key was read; without one it is a blank.
    next: Option<&'de MapEntry>,
}

impl<'de> Entries<'_, '_, 'de> {
    /// The next entry that is to be read.
    fn entry(&mut self) -> Option<&'de MapEntry> {
        loop {
            let entry = self.entries.next()?;
            self.pass.work += 1;
            let key = entry.written.as_str();
            let is_later =
                std::ptr::eq(self.node, self.pass.root) && self.pass.later.contains(&key);
            if is_later || self.pass.gaps.contains_key(&std::ptr::from_ref(&entry.value)) {
                continue;
            }
            match self.fields {
                Some(fields) if !fields.contains(&key) => self.refuse(entry, fields),
                _ => return Some(entry),
            }
        }
    }

    fn refuse(&mut self, entry: &MapEntry, fields: &[&str]) {
        let name = entry.name();
        let path = Trail::Key(&self.trail, &name).path();
        // Nobody reads the advice on all of thousands.
        let few = self.pass.unknown.len() < bounds::TOLD;
        let advice = few.then(|| suggest::did_you_mean(&name, fields.iter().copied())).flatten();
        let problem = Problem::key(path, "unknown key").advise_if(advice);
        self.pass.unknown.push(problem.marked(entry.key.mark));
    }
}

impl<'de> MapAccess<'de> for Entries<'_, '_, 'de> {
    type Error = Misfit;

    fn next_key_seed<K: DeserializeSeed<'de>>(
        &mut self,
        seed: K,
    ) -> Result<Option<K::Value>, Misfit> {
        self.next = self.entry();
        let Some(entry) = self.next else {
            let Some(key) = self.missing.next() else { return Ok(None) };
            return seed.deserialize(BorrowedStrDeserializer::new(key)).map(Some);
        };
        if self.fields.is_some() {
            return seed.deserialize(BorrowedStrDeserializer::new(&entry.written)).map(Some);
        }
        let name = entry.name();
        let trail = Trail::Key(&self.trail, &name);
        let read = seed.deserialize(Reader { pass: self.pass, node: &entry.key, trail });
        let of_key = |misfit: Misfit| Misfit { node: &entry.value, at: At::Key, ..misfit };
        read.map(Some).map_err(|misfit| of_key(misfit.held_by(Holder::Map)))
    }

    fn next_value_seed<V: DeserializeSeed<'de>>(&mut self, seed: V) -> Result<V::Value, Misfit> {
        let Some(entry) = self.next.take() else {
            let no_blank = |_| Misfit::new(MisfitCause::NoBlank).located(self.node, &self.trail);
            return seed.deserialize(Blank).map_err(no_blank);
        };
        let name = entry.name();
        let trail = Trail::Key(&self.trail, &name);
        let read = seed.deserialize(Reader { pass: self.pass, node: &entry.value, trail });
        read.map_err(|misfit| misfit.held_by(Holder::Map))
    }
}

/// Which of `variants` the value of `reader` is.
fn variant<'p, 's, 'de>(
    reader: Reader<'p, 's, 'de>,
    variants: &[&'static str],
) -> Result<Variant<Reader<'p, 's, 'de>>, Misfit> {
    let mut names = variants.iter().copied();
    let is_shapes = variants.iter().any(|name| name.contains(' '));
    let name = if is_shapes {
        let name = names.find(|name| fits(name, reader.node));
        name.ok_or_else(|| reader.unexpected(&variants.join(" or ")))
    } else {
        let text = reader.node.as_text();
        names.find(|name| text == Some(*name)).ok_or_else(|| unknown(&reader, variants))
    };
    Ok(Variant { name: name?, value: reader })
}

fn unknown(reader: &Reader<'_, '_, '_>, variants: &[&str]) -> Misfit {
    let wanted = match variants {
        [one] => format!("`{one}`"),
        [one, other] => format!("`{one}` or `{other}`"),
        _ => format!("one of {}", variants.join(", ")),
    };
    let advice = reader
        .node
        .as_text()
        .and_then(|text| suggest::did_you_mean(text, variants.iter().copied()));
    let what = format!("expected {wanted}, found {}", found(&reader.node.content));
    reader.misfit(what, advice.as_deref())
}

fn fits(shape: &str, node: &Node) -> bool {
    let is = |kind: &str| shape.starts_with(kind);
    match &node.content {
        _ if is("anything else") => true,
        Content::Number(_) => is("a number"),
        Content::Text(_) => is("a string"),
        Content::List(items) if is("a list of lists") => items.iter().any(Node::is_list),
        Content::List(items) if is("a list of numbers") => !items.iter().any(Node::is_list),
        Content::List(_) => is("a list"),
        Content::Map(_) => match shape.strip_prefix("a map with ") {
            Some(keys) => keys.split(" or ").any(|key| node.get(key).is_some()),
            None => is("a map"),
        },
        Content::Null | Content::Bool(_) => false,
    }
}
