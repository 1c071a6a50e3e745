//! docs/scenarios.md tells the truth: its orders are known, its examples work.

use super::failures;
use crate::documents::fenced;
use crate::expect::{read, root};
use drivemu::bench::{BuiltinLibrary, parse};
use drivemu::problem::render::render;
use drivemu::scenario::{self, Order, Verdict};
use drivemu::testkit::Rig;
use std::time::Duration;

#[test]
fn the_orders_of_the_page_are_known() {
    let page = read(&root("docs/scenarios.md"));
    let part = page.split("\n## ").find(|it| it.starts_with("Orders")).expect("a heading");
    let rows: Vec<_> = part.lines().filter_map(|line| line.strip_prefix("| `")).collect();
    assert!(rows.len() > 10, "{rows:?}");
    for row in rows {
        let (order, _) = row.split_once('`').expect("an order");
        assert!(Order::check(order).is_ok(), "{order}");
    }
}

/// The bench of the page, the PLC of the page, and the steps that pass and fail as it says.
#[test]
fn the_example_goes_as_the_page_says() {
    let page = read(&root("docs/scenarios.md"));
    let [bench, scenario] = &fenced(&page, "yaml")[..2] else { panic!("two files") };
    let lines = parse(bench, &BuiltinLibrary).unwrap_or_else(|it| panic!("{}", it[0])).lines;
    let problems = scenario::parse(scenario, &lines).err().unwrap_or_default();
    assert!(problems.is_empty(), "{}", render(&problems, "scenarios.md", scenario));
    let rig = Rig::bench(bench, &BuiltinLibrary).expect("a good bench").with_seed(7);
    let mut rig = rig.with_scenario(scenario).expect("a good scenario");
    // A PLC that starts the run and polls, and knows nothing about alarms.
    rig.ask("01 06 0027 0002");
    for _ in 0..100 {
        rig.advance(Duration::from_millis(100));
        rig.send(&drivemu::wire::rtu::encode(1, &[3, 0, 6, 0, 1]));
    }
    let junit = scenario::junit("outage", &[("cell-1".into(), rig.finish().to_vec())]);
    let log = rig.log();
    let failed = rig.verdicts().iter().filter(|it| it.failure.is_some());
    for Verdict { step, at, failure, .. } in failed {
        let told =
            format!("cell-1: step {step} failed at {at} s: {}", failure.as_deref().unwrap_or(""));
        assert!(page.contains(&told), "{told}");
    }
    assert_eq!(junit, fenced(&page, "xml")[0], "{log}");
    for line in fenced(&page, "text")[0].lines() {
        assert!(log.lines().any(|it| it == line), "{line}\n{log}");
    }
    assert_eq!(failures(rig.verdicts()).len(), 3);
}

/// The scenario of the README is a good one for the drive that it is run with.
#[test]
fn the_readme_has_a_good_scenario() {
    let readme = read(&root("README.md"));
    let texts = fenced(&readme, "yaml");
    let text = texts.iter().find(|it| it.starts_with("steps:")).expect("a scenario");
    super::play_on("hcfa-x", text);
}
