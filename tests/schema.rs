//! The JSON Schema of the file formats, held against what the program says about keys.

use drivemu::{bench, model, scenario};
use serde_json::Value;
use std::collections::{BTreeMap, BTreeSet};

/// Every key that a format knows, with what the schema says about it.
fn keys(schema: &Value) -> BTreeMap<String, Vec<String>> {
    let mut found: BTreeMap<String, Vec<String>> = BTreeMap::new();
    let mut rest = vec![schema];
    while let Some(value) = rest.pop() {
        if let Some(Value::Object(properties)) = value.get("properties") {
            for (key, property) in properties {
                let about = property.get("description").and_then(Value::as_str).unwrap_or_default();
                found.entry(key.clone()).or_default().push(about.to_owned());
            }
        }
        match value {
            Value::Object(map) => rest.extend(map.values()),
            Value::Array(items) => rest.extend(items),
            _ => {}
        }
    }
    found
}

/// Advice on unknown keys comes out of `KEYS`, so it must hold every key and nothing else.
#[test]
fn the_lists_of_keys_are_complete() {
    for (schema, listed) in [
        (model::raw::schema(), model::raw::KEYS),
        (bench::raw::schema(), bench::raw::KEYS),
        (scenario::raw::schema(), scenario::raw::KEYS),
    ] {
        let known: BTreeSet<String> = keys(&schema).into_keys().collect();
        let listed: Vec<String> = listed.iter().map(|key| (*key).to_owned()).collect();
        assert_eq!(listed, known.into_iter().collect::<Vec<_>>());
    }
}

/// Editors show what the schema says about a key: nothing may be silent.
#[test]
fn each_key_is_explained() {
    for schema in [model::raw::schema(), bench::raw::schema(), scenario::raw::schema()] {
        let silent: Vec<_> = keys(&schema)
            .into_iter()
            .filter(|(_, about)| about.iter().any(String::is_empty))
            .collect();
        assert!(silent.is_empty(), "{silent:?}");
    }
}

/// The page about models names each key of the format.
#[test]
fn the_page_about_models_names_each_key() {
    let page = crate::expect::read(&crate::expect::root("docs/models.md"));
    let words: BTreeSet<&str> = page.split(|c: char| !c.is_alphanumeric() && c != '_').collect();
    let unnamed: Vec<_> = model::raw::KEYS.iter().filter(|key| !words.contains(*key)).collect();
    assert!(unnamed.is_empty(), "{unnamed:?}");
}
