//! The JSON Schema of the file formats, held against what the program says about keys.

use crate::expect::{read, root};
use drivemu::{bench, model, scenario};
use serde_json::Value;
use serde_yaml::Value as Yaml;
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

/// The pages name each key of a format, as code.
#[test]
fn the_pages_name_each_key() {
    for (schema, pages) in [
        (model::raw::schema(), &["docs/models.md"][..]),
        (bench::raw::schema(), &["README.md", "docs/faults.md"]),
        (scenario::raw::schema(), &["docs/scenarios.md"]),
    ] {
        let pages: Vec<_> = pages.iter().map(|page| read(&root(page))).collect();
        // Fences are three marks: what stands behind an odd number of them is code, inline or not.
        let code = pages.iter().flat_map(|page| page.split('`').skip(1).step_by(2));
        let words = code.flat_map(|it| it.split(|c: char| !c.is_alphanumeric() && c != '_'));
        let words: BTreeSet<&str> = words.collect();
        let known = keys(&schema).into_keys();
        let unnamed: Vec<_> = known.filter(|key| !words.contains(key.as_str())).collect();
        assert!(unnamed.is_empty(), "{unnamed:?}");
    }
}

/// The places of all keys below `value`, as ways there.
fn places(value: &Yaml, way: &mut Vec<Yaml>, found: &mut Vec<Vec<Yaml>>) {
    let mut below = |key: Yaml, value: &Yaml, is_key: bool| {
        way.push(key);
        if is_key {
            found.push(way.clone());
        }
        places(value, way, found);
        way.pop();
    };
    match value {
        Yaml::Mapping(map) => map.iter().for_each(|(key, value)| below(key.clone(), value, true)),
        Yaml::Sequence(items) => {
            items.iter().enumerate().for_each(|(i, value)| below(i.into(), value, false));
        }
        _ => {}
    }
}

fn without(whole: &Yaml, way: &[Yaml]) -> Yaml {
    let mut changed = whole.clone();
    let (key, above) = way.split_last().expect("a key");
    let above = above.iter().fold(&mut changed, |it, key| match it {
        Yaml::Mapping(map) => map.get_mut(key).expect("a value"),
        Yaml::Sequence(items) => &mut items[key.as_u64().expect("an index") as usize],
        _ => panic!("nothing below {key:?}"),
    });
    above.as_mapping_mut().expect("a map").remove(key);
    changed
}

/// No key does nothing: the made-up drive is another one without it, or none.
#[test]
fn each_key_of_a_model_has_an_effect() {
    let mut acme = read(&root("tests/models/acme-s1.yaml"));
    // What goes with none of its other keys, or against them.
    for (key, more) in [
        ("\nline:", "\n  unlisted_reads: zero\n  length_check: count_only"),
        ("\nservo: {", "enabled_at_power_on: true, "),
        ("\nsettings_taken: ", "at_start #"),
    ] {
        let (head, tail) = acme.split_once(key).expect(key);
        acme = format!("{head}{key}{more}{tail}");
    }
    acme.push_str("\nstations: [{name: left, init: {C001: 5}}, {name: right, init: {C001: 6}}]\n");
    let acme: Yaml = serde_yaml::from_str(&acme).expect("YAML");
    let shape = |file: &Yaml| {
        let text = serde_yaml::to_string(file).expect("YAML");
        model::load(&text, &model::Choices::new()).ok().map(|model| format!("{model:?}"))
    };
    let whole = shape(&acme);
    assert!(whole.is_some());
    let mut all = Vec::new();
    places(&acme, &mut Vec::new(), &mut all);
    let mut idle: BTreeSet<String> = keys(&model::raw::schema()).into_keys().collect();
    for way in all {
        let key = way.last().and_then(Yaml::as_str).unwrap_or_default();
        if idle.contains(key) && shape(&without(&acme, &way)) != whole {
            idle.remove(key);
        }
    }
    assert!(idle.is_empty(), "{idle:?}");
}
