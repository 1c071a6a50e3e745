//! As much of JSON Schema as the log's own uses. A keyword that it does not know fails the test.

use serde_json::{Map, Value};
use std::collections::{BTreeMap, BTreeSet};

/// Keywords that say nothing about validity.
const NOTES: [&str; 4] = ["$schema", "title", "description", "format"];

/// Is `value` what `schema` says?
pub fn validate(schema: &Value, value: &Value) -> Result<(), String> {
    let known = evaluate(schema, value)?;
    match (schema.get("unevaluatedProperties"), value) {
        (Some(Value::Bool(false)), Value::Object(fields)) => {
            let unknown: Vec<_> = fields.keys().filter(|key| !known.contains(*key)).collect();
            if unknown.is_empty() { Ok(()) } else { Err(format!("unknown keys {unknown:?}")) }
        }
        _ => Ok(()),
    }
}

/// The keys that `schema` accounts for, if `value` is what it says.
fn evaluate(schema: &Value, value: &Value) -> Result<BTreeSet<String>, String> {
    let mut known = BTreeSet::new();
    for (keyword, says) in schema.as_object().expect("a schema is an object") {
        let holds = match keyword.as_str() {
            "type" => each(says).any(|it| is_a(value, it.as_str().expect("a type"))),
            "const" => value == says,
            "enum" => each(says).any(|it| it == value),
            "minimum" => value.as_f64().is_none_or(|it| it >= says.as_f64().expect("a number")),
            "maximum" => value.as_f64().is_none_or(|it| it <= says.as_f64().expect("a number")),
            "pattern" => value.as_str().is_none_or(|it| matches(says.as_str().expect("one"), it)),
            "required" => each(says).all(|it| value.get(it.as_str().expect("a key")).is_some()),
            "items" => {
                let mut items = value.as_array().into_iter().flatten();
                items.try_for_each(|it| validate(says, it))?;
                true
            }
            "properties" => {
                for (key, schema) in says.as_object().expect("properties") {
                    if let Some(field) = value.get(key) {
                        validate(schema, field).map_err(|why| format!("{key}: {why}"))?;
                        known.insert(key.clone());
                    }
                }
                true
            }
            "anyOf" | "oneOf" => {
                let found: Vec<_> = each(says)
                    .map(|it| {
                        validate(it, value)?;
                        evaluate(it, value)
                    })
                    .collect();
                let good = found.iter().filter(|it| it.is_ok()).count();
                if good == 0 {
                    let whys: Vec<_> = found.iter().filter_map(|it| it.as_ref().err()).collect();
                    return Err(format!("none of {}: {whys:?}", whys.len()));
                }
                found.into_iter().flatten().for_each(|keys| known.extend(keys));
                keyword == "anyOf" || good == 1
            }
            "unevaluatedProperties" => true,
            keyword => {
                assert!(NOTES.contains(&keyword), "what is `{keyword}`?");
                true
            }
        };
        if !holds {
            return Err(format!("{value} is not {keyword} {says}"));
        }
    }
    Ok(known)
}

fn each(value: &Value) -> impl Iterator<Item = &Value> {
    let one = if value.is_array() { None } else { Some(value) };
    value.as_array().into_iter().flatten().chain(one)
}

fn is_a(value: &Value, kind: &str) -> bool {
    match kind {
        "integer" => value.is_i64() || value.is_u64(),
        "number" => value.is_number(),
        "string" => value.is_string(),
        "boolean" => value.is_boolean(),
        "array" => value.is_array(),
        "object" => value.is_object(),
        "null" => value.is_null(),
        kind => panic!("what is a {kind}?"),
    }
}

/// The three patterns of the log.
fn matches(pattern: &str, text: &str) -> bool {
    match pattern {
        "^([0-9A-F]{2}( [0-9A-F]{2})*)?$" => {
            let byte = |it: &str| it.len() == 2 && u8::from_str_radix(it, 16).is_ok();
            text.is_empty() || text.split(' ').all(byte)
        }
        "^[0-9]+-[78][NEO][12]$" => text.parse::<drivemu::serial::Settings>().is_ok(),
        "^[0-9]+-[78][NEO][12] (RTU|ASCII)$" => text.split_once(' ').is_some_and(|(it, mode)| {
            it.parse::<drivemu::serial::Settings>().is_ok() && ["RTU", "ASCII"].contains(&mode)
        }),
        pattern => panic!("what is `{pattern}`?"),
    }
}

/// One way for an object to be valid: all keys that it can have.
#[derive(Debug, Clone, Default)]
pub struct Alternative {
    /// What the schema says about it, where it says most.
    pub about: String,
    pub keys: BTreeMap<String, Key>,
    /// The names of the keys, in order.
    pub order: Vec<String>,
}

/// A key.
#[derive(Debug, Clone)]
pub struct Key {
    pub schema: Value,
    pub is_required: bool,
}

impl Key {
    /// What the schema says about it.
    pub fn about(&self) -> &str {
        self.schema.get("description").and_then(Value::as_str).unwrap_or_default()
    }

    /// The same with a constant as a list of one.
    pub fn listed(&self) -> Self {
        let mut key = self.clone();
        if let Some(only) = self.schema.get("const") {
            key.schema["enum"] = Value::Array(vec![only.clone()]);
        }
        key
    }

    /// Takes the constant that another shape has for it.
    pub fn also(&mut self, other: &Self) {
        let (known, more) = (self.schema.get_mut("enum"), other.schema.get("const"));
        if let (Some(Value::Array(known)), Some(more)) = (known, more)
            && !known.contains(more)
        {
            known.push(more.clone());
        }
    }
}

/// The alternatives of a schema, one for each event and each shape that it has.
pub fn alternatives(schema: &Value) -> Vec<Alternative> {
    expand(schema.as_object().expect("a schema"), &Alternative::default())
}

fn expand(schema: &Map<String, Value>, above: &Alternative) -> Vec<Alternative> {
    let mut here = above.clone();
    let named = here.keys.contains_key("event");
    if let (Some(Value::String(about)), false) = (schema.get("description"), named) {
        here.about.clone_from(about);
    }
    let required: Vec<_> = schema.get("required").into_iter().flat_map(each).collect();
    for (name, schema) in schema.get("properties").and_then(Value::as_object).into_iter().flatten()
    {
        let is_required = required.iter().any(|it| *it == name);
        here.keys.insert(name.clone(), Key { schema: schema.clone(), is_required });
        here.order.push(name.clone());
    }
    let below = ["anyOf", "oneOf"].iter().find_map(|keyword| schema.get(*keyword));
    match below {
        None => vec![here],
        Some(below) => {
            each(below).flat_map(|it| expand(it.as_object().expect("a schema"), &here)).collect()
        }
    }
}
