//! docs/faults.md tells the truth: kinds, keys, log lines, presets and examples.

use super::{READ, ask, drive};
use crate::documents::fenced;
use crate::expect::{read, root};
use crate::kit::{Files, bench_line, line_of, text_of};
use drivemu::bench::{BuiltinLibrary, DeviceSpec, parse};
use drivemu::medium::{FaultKind, Preset};
use drivemu::problem::render::render;
use drivemu::testkit::transcript;

/// The cells of each row of the tables under the heading `title`, without their marks for code.
fn table(title: &str) -> Vec<Vec<String>> {
    let page = read(&root("docs/faults.md"));
    let part = page.split("\n## ").find(|it| it.starts_with(title)).expect("a heading");
    let rows = part.lines().filter_map(|line| line.strip_prefix("| ")).skip(2);
    let cell = |it: &str| it.trim().replace('`', "");
    rows.map(|row| row.trim_end_matches('|').split('|').map(cell).collect()).collect()
}

#[test]
fn each_kind_does_what_the_page_says() {
    let rows = table("Kinds");
    let kinds = FaultKind::ALL.iter();
    for (kind, row) in kinds.clone().zip(&rows) {
        let [name, _, keys, example, log] = row.as_slice() else { panic!("{row:?}") };
        let own: Vec<_> = kind.keys.iter().map(|key| key.name).collect();
        assert_eq!((name.as_str(), keys), (kind.name, &own.join(" ")));
        let mut rig = drive(&[example]);
        ask(&mut rig, READ);
        let said = rig.log();
        let said = said.lines().find(|line| line.contains(" fault ")).unwrap_or_default();
        assert_eq!(said.split_once(' ').map(|(_, said)| said), Some(log.as_str()));
    }
    assert_eq!(rows.len(), kinds.count());
}

#[test]
fn each_key_has_an_example() {
    let line = line_of(text_of("hcfa-x"), &[], &DeviceSpec::default());
    let rows = table("Keys");
    let mut keys: Vec<&str> = rows.iter().map(|row| row[0].as_str()).collect();
    for row in &rows {
        let example = &row[2];
        assert!(row[0] == "do" || example.contains(&format!("{}=", row[0])), "{example}");
        let problems = line.fault(example, &[]).err().unwrap_or_default();
        assert!(problems.is_empty(), "{}", render(&problems, "faults.md", example));
    }
    keys.sort_unstable();
    #[cfg(feature = "cli")]
    assert_eq!(keys, known().iter().map(String::as_str).collect::<Vec<_>>());
}

/// The keys of a rule, in order.
#[cfg(feature = "cli")]
fn known() -> std::collections::BTreeSet<String> {
    let schema = drivemu::bench::raw::schema();
    let known = schema["$defs"]["RawFault"]["properties"].as_object().expect("properties");
    known.keys().cloned().collect()
}

#[test]
fn presets_have_the_numbers_of_the_page() {
    let page = read(&root("docs/faults.md"));
    for preset in Preset::ALL {
        let intro = format!("\n`{}`, ", preset.name);
        let (_, rest) = page.split_once(&intro).expect("a preset of the page");
        let items = rest.lines().skip(2).map_while(|line| line.strip_prefix("- "));
        let items = items.map(|it| it.replace('`', ""));
        let (line_behaviour, rules): (Vec<_>, Vec<_>) = items.partition(|it| it.contains(": "));
        assert_eq!(rules, preset.rules);
        let line = format!("pty: auto, drives: [{{model: hcfa-x}}], {}", line_behaviour.join(", "));
        assert_eq!(
            bench_line(&format!("lines: [{{{line}}}]")).line_behaviour,
            preset.line_behaviour()
        );
    }
}

#[test]
fn examples_work() {
    let page = read(&root("docs/faults.md"));
    for text in fenced(&page, "text") {
        transcript::run(&text, &Files).unwrap_or_else(|failure| panic!("{failure}\n{text}"));
    }
    let bench = &fenced(&page, "yaml")[0];
    let bench = parse(bench, &BuiltinLibrary);
    let bench = bench.unwrap_or_else(|problems| panic!("{}", problems[0]));
    assert_eq!(
        bench.lines[0].faults.len(),
        3 + Preset::find("noisy_cable").map_or(0, |it| it.rules.len())
    );
    let consoles = fenced(&page, "console");
    let line = line_of(text_of("hcfa-x"), &[], &DeviceSpec::default());
    let readme = fenced(&read(&root("README.md")), "console");
    let commands = consoles[..1].iter().chain(&readme);
    let specs = commands.flat_map(|text| text.split("--fault ").skip(1));
    let specs: Vec<_> = specs
        .filter_map(|it| it.split_whitespace().next())
        .map(|it| it.trim_matches('\''))
        .collect();
    assert!(specs.len() >= 5, "{specs:?}");
    for spec in specs {
        assert_eq!(line.fault(spec, &[]).err(), None, "{spec}");
    }
    let (command, said) = consoles[1].split_once('\n').expect("two lines");
    let spec = command.rsplit(' ').next().expect("a spec");
    let problems = line.fault(spec, &[]).expect_err("a mistake");
    assert_eq!(render(&problems, "--fault", spec), said);
}
