//! What stands in for a value that is missing or does not fit: nothing, in whatever form is asked for.

use super::Misfit;
use super::variant::Variant;
use serde::de::value::BorrowedStrDeserializer;
use serde::de::{DeserializeSeed, Deserializer, Error, MapAccess, SeqAccess, Visitor};

/// 0, false, no text, no items, no option; of the words of an enum the first; a struct of blanks.
pub(super) struct Blank;

/// The methods of one answer.
macro_rules! answer {
    ($($method:ident)* => |$visitor:ident| $answer:expr) => {
        $(fn $method<V: Visitor<'de>>(self, $visitor: V) -> Result<V::Value, Misfit> { $answer })*
    };
}

impl<'de> Deserializer<'de> for Blank {
    type Error = Misfit;

    answer! {
        deserialize_i8 deserialize_i16 deserialize_i32 deserialize_i64
        deserialize_u8 deserialize_u16 deserialize_u32 deserialize_u64 => |visitor| visitor.visit_u64(0)
    }
    answer! { deserialize_f32 deserialize_f64 => |visitor| visitor.visit_f64(0.0) }
    answer! { deserialize_bool => |visitor| visitor.visit_bool(false) }
    answer! { deserialize_str deserialize_string => |visitor| visitor.visit_str("") }
    answer! { deserialize_option => |visitor| visitor.visit_none() }
    answer! { deserialize_seq => |visitor| visitor.visit_seq(Nothing) }
    answer! { deserialize_map => |visitor| visitor.visit_map(Nothing) }
    answer! {
        deserialize_any deserialize_unit deserialize_ignored_any => |visitor| visitor.visit_unit()
    }

    fn deserialize_newtype_struct<V: Visitor<'de>>(
        self,
        _: &'static str,
        visitor: V,
    ) -> Result<V::Value, Misfit> {
        visitor.visit_newtype_struct(self)
    }

    fn deserialize_tuple<V: Visitor<'de>>(
        self,
        len: usize,
        visitor: V,
    ) -> Result<V::Value, Misfit> {
        visitor.visit_seq(Blanks(len))
    }

    fn deserialize_struct<V: Visitor<'de>>(
        self,
        _: &'static str,
        fields: &'static [&'static str],
        visitor: V,
    ) -> Result<V::Value, Misfit> {
        visitor.visit_map(BlankFields(fields))
    }

    fn deserialize_enum<V: Visitor<'de>>(
        self,
        _: &'static str,
        variants: &'static [&'static str],
        visitor: V,
    ) -> Result<V::Value, Misfit> {
        let first = variants.first().ok_or_else(|| Misfit::custom("no variant"))?;
        visitor.visit_enum(Variant { name: first, value: self })
    }

    serde::forward_to_deserialize_any! {
        i128 u128 char bytes byte_buf unit_struct tuple_struct identifier
    }
}

/// A list or a map without anything in it.
pub(super) struct Nothing;

impl<'de> SeqAccess<'de> for Nothing {
    type Error = Misfit;

    fn next_element_seed<T: DeserializeSeed<'de>>(
        &mut self,
        _: T,
    ) -> Result<Option<T::Value>, Misfit> {
        Ok(None)
    }
}

impl<'de> MapAccess<'de> for Nothing {
    type Error = Misfit;

    fn next_key_seed<K: DeserializeSeed<'de>>(&mut self, _: K) -> Result<Option<K::Value>, Misfit> {
        Ok(None)
    }

    fn next_value_seed<V: DeserializeSeed<'de>>(&mut self, seed: V) -> Result<V::Value, Misfit> {
        seed.deserialize(Blank)
    }
}

/// So many blanks.
struct Blanks(usize);

impl<'de> SeqAccess<'de> for Blanks {
    type Error = Misfit;

    fn next_element_seed<T: DeserializeSeed<'de>>(
        &mut self,
        seed: T,
    ) -> Result<Option<T::Value>, Misfit> {
        let Some(left) = self.0.checked_sub(1) else { return Ok(None) };
        self.0 = left;
        seed.deserialize(Blank).map(Some)
    }
}

/// A blank for each field that is left.
struct BlankFields(&'static [&'static str]);

impl<'de> MapAccess<'de> for BlankFields {
    type Error = Misfit;

    fn next_key_seed<K: DeserializeSeed<'de>>(
        &mut self,
        seed: K,
    ) -> Result<Option<K::Value>, Misfit> {
        let Some((first, rest)) = self.0.split_first() else { return Ok(None) };
        self.0 = rest;
        seed.deserialize(BorrowedStrDeserializer::new(first)).map(Some)
    }

    fn next_value_seed<V: DeserializeSeed<'de>>(&mut self, seed: V) -> Result<V::Value, Misfit> {
        seed.deserialize(Blank)
    }
}
