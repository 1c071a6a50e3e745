//! docs/ARCHITECTURE.md names files that are there, and its ways through the code are short.

use crate::expect::{read, root};

/// Every path below `src`, `tests` and `docs` that the page names; `src/a/{b,c}.rs` stands for two.
#[test]
fn its_files_are_there() {
    let page = read(&root("docs/ARCHITECTURE.md"));
    let names = page.split('`').skip(1).step_by(2);
    let paths: Vec<String> = names
        .filter(|name| ["src/", "tests/", "docs/"].iter().any(|folder| name.starts_with(folder)))
        .flat_map(unfolded)
        .collect();
    let missing: Vec<_> = paths.iter().filter(|path| !root(path).exists()).collect();
    assert!(missing.is_empty(), "{missing:?}");
    assert!(paths.len() > 50, "{}", paths.len());
}

/// Each way is a numbered list of files below a heading that says how many there are at most.
#[test]
fn its_ways_are_short() {
    let page = read(&root("docs/ARCHITECTURE.md"));
    let mut ways = Vec::new();
    for section in page.split("\n### ").skip(1) {
        let (heading, body) = section.split_once('\n').expect("a heading of its own line");
        let most = heading.split("at most ").nth(1).and_then(|rest| rest.split(' ').next());
        let Some(most) = most.and_then(|most| most.parse::<usize>().ok()) else { continue };
        let steps = body.lines().filter(|line| line.starts_with(|c: char| c.is_ascii_digit()));
        let files: Vec<_> = steps.filter_map(|step| step.split('`').nth(1)).collect();
        assert!((3..=most).contains(&files.len()), "{heading}: {}", files.len());
        assert!(files.iter().all(|file| file.starts_with("src/")), "{heading}: {files:?}");
        ways.push(most);
    }
    assert_eq!(ways, [15, 10, 10, 6, 8]);
}

/// `a` and `b` of `{a,b}`.
fn unfolded(path: &str) -> Vec<String> {
    match path.split_once('{').and_then(|(head, rest)| Some((head, rest.split_once('}')?))) {
        Some((head, (names, tail))) => {
            names.split(',').map(|name| format!("{head}{name}{tail}")).collect()
        }
        None => vec![path.to_owned()],
    }
}
