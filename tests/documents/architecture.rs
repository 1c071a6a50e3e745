//! docs/ARCHITECTURE.md names files that are there.

use crate::expect::{read, root};

/// Each file or folder of a row of a table: `src/a/{b,c}.rs` stands for two, and a name alone for a file beside the one before.
#[test]
fn the_files_of_its_tables_are_there() {
    let page = read(&root("docs/ARCHITECTURE.md"));
    let mut seen = 0;
    for row in page.lines().filter(|line| line.starts_with('|')) {
        let mut folder = String::new();
        for name in row.split('`').skip(1).step_by(2).filter(|it| it.contains(['/', '.'])) {
            let path =
                if name.contains('/') { name.to_owned() } else { format!("{folder}/{name}") };
            if let Some((above, _)) = path.rsplit_once('/').filter(|_| path.ends_with(".rs")) {
                folder = above.to_owned();
            } else {
                folder.clone_from(&path);
            }
            for path in unfolded(&path) {
                seen += 1;
                assert!(root(&path).exists(), "{path} in {row}");
            }
        }
    }
    assert!(seen > 50, "{seen}");
}

fn unfolded(path: &str) -> Vec<String> {
    match path.split_once('{').and_then(|(head, rest)| Some((head, rest.split_once('}')?))) {
        Some((head, (names, tail))) => {
            names.split(',').map(|name| format!("{head}{name}{tail}")).collect()
        }
        None => vec![path.to_owned()],
    }
}
