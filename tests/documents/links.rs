//! Links between documents lead somewhere, and the glossary is in order.

use crate::expect::{files, read, root};
use std::path::Path;

/// Every document that a reader of the repository opens.
fn pages() -> Vec<std::path::PathBuf> {
    let mut pages = files("docs", "md");
    pages.extend([root("README.md"), root("CHANGELOG.md")]);
    pages
}

/// The name by which a link reaches a heading: in lower case, without punctuation, with hyphens for blanks.
fn anchor(heading: &str) -> String {
    let plain = heading.trim_start_matches('#').trim().to_lowercase();
    let kept = plain.chars().filter(|c| c.is_alphanumeric() || matches!(c, ' ' | '-' | '_'));
    kept.map(|c| if c == ' ' { '-' } else { c }).collect()
}

fn anchors(page: &str) -> Vec<String> {
    page.lines().filter(|line| line.starts_with('#')).map(anchor).collect()
}

#[test]
fn each_link_leads_somewhere() {
    let (mut bad, mut seen) = (Vec::new(), 0);
    for page in pages() {
        let text = read(&page);
        let targets = text.split("](").skip(1).filter_map(|rest| rest.split_once(')'));
        for (target, _) in targets.filter(|(target, _)| !target.contains("://")) {
            seen += 1;
            let (path, heading) = target.split_once('#').unwrap_or((target, ""));
            let folder = page.parent().unwrap_or(Path::new(""));
            let file = if path.is_empty() { page.clone() } else { folder.join(path) };
            let is_there = file.exists()
                && (heading.is_empty() || anchors(&read(&file)).iter().any(|it| it == heading));
            if !is_there {
                bad.push(format!("{}: {target}", page.display()));
            }
        }
    }
    assert!(bad.is_empty(), "{}", bad.join("\n"));
    assert!(seen > 100, "{seen}");
}

/// The glossary is sorted, lists a term once, and names folders and files of `src` that exist.
#[test]
fn the_glossary_is_in_order() {
    let page = read(&root("docs/glossary.md"));
    let rows: Vec<_> = page.lines().filter(|line| line.starts_with("| ")).skip(2).collect();
    let term = |row: &&str| row.split('|').nth(1).unwrap_or_default().trim().to_lowercase();
    let terms: Vec<_> = rows.iter().map(term).collect();
    assert!(terms.len() > 80, "{}", terms.len());
    for pair in terms.windows(2) {
        assert!(pair[0] < pair[1], "`{}` comes before `{}`", pair[1], pair[0]);
    }
    for path in page.split('`').skip(1).step_by(2).filter(|it| it.starts_with("src/")) {
        let file = root(&format!("{path}.rs"));
        assert!(root(path).exists() || file.exists(), "no {path}");
    }
}
