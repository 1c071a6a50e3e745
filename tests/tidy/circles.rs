//! No two modules of one folder import each other, directly or by way of others.
//!
//! Between the folders of `src` the floors see to that. Within a folder, siblings are compared: a file, or a folder as a
//! whole. A name that the parent re-exports counts as the sibling that declares it; parents and children may name each other.

use crate::source::Source;
use std::collections::{BTreeMap, BTreeSet};

/// `drive::home` as `["drive", "home"]`, without `crate`.
type Path = Vec<String>;
type Graph = BTreeMap<String, BTreeSet<String>>;

#[test]
fn no_import_goes_round_in_a_circle() {
    let sources = Source::all("src");
    let modules = sources.iter().map(|source| (module(&source.path), program(source))).collect();
    let found = circles(&modules);
    assert!(found.is_empty(), "{found:?}");
}

/// The code of a file without its own tests.
fn program(source: &Source) -> String {
    source.code.split("#[cfg(test)]").next().unwrap_or_default().to_owned()
}

fn module(file: &str) -> Path {
    let path = file.trim_start_matches("src/").trim_end_matches(".rs").trim_end_matches("/mod");
    match path {
        "lib" | "main" => Vec::new(),
        _ => path.split('/').map(str::to_owned).collect(),
    }
}

/// Folder and members of each set of siblings that reach each other.
fn circles(modules: &BTreeMap<Path, String>) -> Vec<(String, Vec<String>)> {
    let (uses, reexports) = uses(modules);
    let mut graphs: BTreeMap<Path, Graph> = BTreeMap::new();
    for (module, path) in &uses {
        let used = declared(path, &reexports, modules);
        let shared = module.iter().zip(&used).take_while(|(a, b)| a == b).count();
        if let (Some(own), Some(other)) = (module.get(shared), used.get(shared)) {
            let graph = graphs.entry(module[..shared].to_vec()).or_default();
            graph.entry(own.clone()).or_default().insert(other.clone());
        }
    }
    let mut found = Vec::new();
    for (folder, graph) in &graphs {
        let reached: BTreeMap<_, _> = graph.keys().map(|node| (node, reach(graph, node))).collect();
        let in_circle = |a: &String, b: &String| {
            reached[a].contains(b) && reached.get(b).is_some_and(|back| back.contains(a))
        };
        let mut done = BTreeSet::new();
        for node in graph.keys().filter(|node| in_circle(node, node)) {
            if done.insert(node) {
                let members: Vec<_> = graph.keys().filter(|it| in_circle(node, it)).collect();
                done.extend(&members);
                found.push((folder.join("::"), members.into_iter().cloned().collect()));
            }
        }
    }
    found
}

/// Everything that can be reached from `node` in one step or more.
fn reach(graph: &Graph, node: &str) -> BTreeSet<String> {
    let mut found = BTreeSet::new();
    let mut open = vec![node.to_owned()];
    while let Some(next) = open.pop() {
        for other in graph.get(&next).into_iter().flatten() {
            if found.insert(other.clone()) {
                open.push(other.clone());
            }
        }
    }
    found
}

type Reexports = BTreeMap<Path, Path>;

/// Each path that a module names, from the root of the crate, and what `pub use` gives a second place.
fn uses(modules: &BTreeMap<Path, String>) -> (Vec<(Path, Path)>, Reexports) {
    let (mut uses, mut reexports) = (Vec::new(), Reexports::new());
    for (module, code) in modules {
        let (mut rest, mut lines) = (String::new(), code.lines());
        while let Some(line) = lines.next() {
            let Some((visibility, tree)) = line.trim_start().split_once("use ") else {
                rest.push_str(line);
                rest.push('\n');
                continue;
            };
            let public = visibility.starts_with("pub");
            if !(public || visibility.is_empty()) {
                continue;
            }
            let mut tree = tree.to_owned();
            while !tree.contains(';') {
                let Some(line) = lines.next() else { break };
                tree.push_str(line);
            }
            for path in leaves(tree.trim_end().trim_end_matches(';')) {
                let Some(path) = absolute(module, &path, modules) else { continue };
                if public && let Some(name) = path.last() {
                    let here = module.iter().chain([name]).cloned().collect();
                    reexports.insert(here, path.clone());
                }
                uses.push((module.clone(), path));
            }
        }
        let is_path = |c: char| c.is_alphanumeric() || c == '_' || c == ':';
        for word in rest.split(|c| !is_path(c)).filter(|word| word.contains("::")) {
            let path: Path = word.split("::").map(str::to_owned).collect();
            uses.extend(absolute(module, &path, modules).map(|path| (module.clone(), path)));
        }
    }
    (uses, reexports)
}

/// The paths of a `use` tree: `a::{b, c::D}` gives two.
fn leaves(tree: &str) -> Vec<Path> {
    let tree = tree.trim();
    let Some((head, list)) = tree.split_once('{') else {
        let plain = tree.split(" as ").next().unwrap_or_default();
        return vec![plain.split("::").map(|part| part.trim().to_owned()).collect()];
    };
    let head: Path =
        head.split("::").map(str::trim).filter(|it| !it.is_empty()).map(str::to_owned).collect();
    let list = list.trim_end().strip_suffix('}').unwrap_or(list);
    let (mut level, mut start, mut paths) = (0, 0, Vec::new());
    for (i, c) in list.char_indices().chain([(list.len(), ',')]) {
        match c {
            '{' => level += 1,
            '}' => level -= 1,
            ',' if level == 0 => {
                if !list[start..i].trim().is_empty() {
                    paths.extend(
                        leaves(&list[start..i])
                            .into_iter()
                            .map(|leaf| [head.clone(), leaf].concat()),
                    );
                }
                start = i + 1;
            }
            _ => {}
        }
    }
    paths
}

/// `path` as `module` writes it, from the root of the crate; `None` for other crates.
fn absolute(module: &Path, path: &[String], modules: &BTreeMap<Path, String>) -> Option<Path> {
    let ups = path.iter().take_while(|part| *part == "super").count();
    match path.first()?.as_str() {
        "crate" => Some(path[1..].to_vec()),
        "self" => Some([module, &path[1..]].concat()),
        "super" => {
            let above = module.len().checked_sub(ups)?;
            Some([&module[..above], &path[ups..]].concat())
        }
        _ => {
            let own: Path = [module, &path[..1]].concat();
            modules.contains_key(&own).then(|| [module, path].concat())
        }
    }
}

/// The module that declares what `path` names.
fn declared(path: &Path, reexports: &Reexports, modules: &BTreeMap<Path, String>) -> Path {
    let mut path = path.clone();
    for _ in 0..10 {
        let known =
            (1..=path.len()).rev().find_map(|len| Some((len, reexports.get(&path[..len])?)));
        let Some((len, target)) = known else { break };
        path = [target, &path[len..]].concat();
    }
    let len = (0..=path.len()).rev().find(|len| modules.contains_key(&path[..*len]));
    path[..len.unwrap_or(0)].to_vec()
}

#[test]
fn circles_are_found() {
    let of = |texts: &[(&str, &str)]| {
        let modules = texts.iter().map(|(file, code)| (module(file), (*code).to_owned())).collect();
        circles(&modules)
    };
    let top = ("src/a/mod.rs", "mod x;\nmod y;\npub use x::X;\npub(crate) use y::{\n    Y, Z,\n};");
    let circle = vec![("a".to_owned(), vec!["x".to_owned(), "y".to_owned()])];
    let x = ("src/a/x.rs", "use std::fmt;\nuse super::{Y as Why};\npub struct X;");
    let one_way = ("src/a/y.rs", "pub struct Y; fn f(y: Y) {}");
    let back = ("src/a/y.rs", "pub struct Y; fn f() -> crate::a::x::X { x() }");
    let by_a_folder = ("src/a/y/deep.rs", "use super::super::x::X;");
    assert_eq!(of(&[top, x, one_way]), []);
    assert_eq!(of(&[top, x, back]), circle);
    assert_eq!(of(&[top, x, one_way, by_a_folder]), circle);
}
