//! Files without an end, without a bottom, or with too much of everything: each is refused in words, and in no time.

use crate::kit::text_of;
use drivemu::bench::{self, BuiltinLibrary, kind_of};
use drivemu::model::{self, builtin::Builtin};
use drivemu::problem::bounds;
use drivemu::problem::parse as tree;
use drivemu::problem::render::render;
use drivemu::scenario;
use std::fmt::Write as _;

/// `count` times what `part` makes of each number.
fn many(count: usize, part: impl Fn(usize) -> String) -> String {
    (0..count).map(part).collect()
}

/// The first problem of a text, whatever kind of file it is taken for.
fn refused(text: &str) -> String {
    assert_eq!(kind_of(text), "model", "nothing is known of it");
    let problems = tree(text).expect_err("refused");
    assert!(problems.len() <= bounds::PROBLEMS);
    for told in [model::check(text), scenario::check(text)] {
        assert_eq!(told, problems, "each reader has the same bounds");
    }
    problems.last().expect("a problem").to_string()
}

#[test]
fn without_a_bottom() {
    let stairs = many(200, |depth| format!("{:depth$}a:\n", ""));
    for text in [
        "[".repeat(1_000_000),
        "{".repeat(1_000_000),
        "- ".repeat(1_000_000),
        "? ".repeat(1_000_000),
        "{a: ".repeat(200_000),
        "[{a: ".repeat(200_000),
        stairs,
    ] {
        let what = refused(&text);
        assert!(what.ends_with("nested deeper than 64 levels"), "{}: {what}", &text[..9]);
    }
}

#[test]
fn without_an_end() {
    for text in ["#".repeat(bounds::SIZE + 1), " ".repeat(bounds::SIZE + 1)] {
        assert_eq!(refused(&text), "a file may have at most 16777216 bytes");
    }
    let values = format!("[{}]", "1,".repeat(bounds::VALUES));
    assert_eq!(refused(&values), "a file may have at most 1000000 values");
    let key = format!("{}: 1", "k".repeat(bounds::KEY + 1));
    assert_eq!(refused(&key), "a key may have at most 256 characters");
    let text = format!("a: {}", "t".repeat(bounds::TEXT + 1));
    assert_eq!(refused(&text), "a string may have at most 4096 characters");
    // Characters are counted, not bytes.
    assert!(tree(&format!("{}: {}", "名".repeat(bounds::KEY), "名".repeat(bounds::TEXT))).is_ok());
}

/// Each alias names ten of the one before: followed, they are more than any memory holds.
#[test]
fn aliases_are_not_followed() {
    let mut text = String::from("a0: &a0 [x, x]\n");
    for n in 1..30 {
        let names = vec![format!("*a{}", n - 1); 10].join(", ");
        writeln!(text, "a{n}: &a{n} [{names}]").expect("a string");
    }
    for problems in [model::check(&text), scenario::check(&text)] {
        let says = "anchors and aliases are not supported";
        assert!(problems.iter().any(|it| it.what == says), "{problems:?}");
    }
}

/// Nobody reads a thousand problems, and to find the places of a million takes for ever.
#[test]
fn of_many_problems_some_are_told() {
    let twice = many(100_000, |_| "a: 1\n".into());
    let unknown = many(50_000, |n| format!("key{n}: 1\n"));
    for (text, least) in [(twice, 900), (unknown, 40_000)] {
        let problems = model::check(&text);
        assert!(problems.len() > least, "{}", problems.len());
        let told = render(&problems, "f", &text);
        assert_eq!(told.matches("error: ").count(), bounds::TOLD);
        let more = problems.len() - bounds::TOLD;
        assert!(told.ends_with(&format!("f: and {more} more problems\n")), "{told}");
    }
}

/// The only problem of a bench.
fn of_bench(text: &str) -> String {
    let problems = bench::parse(text, &BuiltinLibrary).expect_err("too many");
    assert_eq!(problems.len(), 1, "{}", problems[0]);
    problems[0].to_string()
}

#[test]
fn too_much_of_a_bench() {
    let lines =
        many(257, |n| format!("  - {{name: l{n}, pty: auto, drives: [{{model: hcfa-x}}]}}\n"));
    let what = of_bench(&format!("lines:\n{lines}"));
    assert_eq!(what, "lines: at most 256 lines are allowed here, not 257");
    let drives = many(248, |_| "{model: hcfa-x}, ".into());
    let what = of_bench(&format!("lines: [{{pty: auto, drives: [{drives}]}}]"));
    assert_eq!(what, "lines[0].drives: at most 247 drives are allowed here, not 248");
    let faults = many(257, |_| "{do: late}, ".into());
    let line = format!("lines: [{{pty: auto, drives: [{{model: hcfa-x}}], faults: [{faults}]}}]");
    assert_eq!(of_bench(&line), "lines[0].faults: at most 256 faults are allowed here, not 257");
}

/// The only problem of a scenario.
fn of_scenario(text: &str) -> String {
    let bench = bench::parse("lines: [{pty: auto, drives: [{model: hcfa-x}]}]", &BuiltinLibrary);
    let problems = scenario::parse(text, &bench.expect("a bench").lines).expect_err("too much");
    problems[0].to_string()
}

#[test]
fn too_much_of_a_scenario() {
    let steps = many(10_001, |_| "  - {name: a, do: [power_cycle]}\n".into());
    let what = of_scenario(&format!("steps:\n{steps}"));
    assert_eq!(what, "steps: at most 10000 steps are allowed here, not 10001");
    let orders = many(101, |_| "power_cycle, ".into());
    let what = of_scenario(&format!("steps: [{{name: a, do: [{orders}]}}]"));
    assert_eq!(what, "steps[0].do: at most 100 orders are allowed here, not 101");
    let expect = many(101, |_| "{signal: alarm, is: off}, ".into());
    let what = of_scenario(&format!("steps: [{{name: a, expect: [{expect}]}}]"));
    assert_eq!(what, "steps[0].expect: at most 100 conditions are allowed here, not 101");
    let orders = many(90, |_| "fault late, ".into());
    let steps = many(3, |_| format!("  - {{name: a, do: [{orders}]}}\n"));
    let what = of_scenario(&format!("steps:\n{steps}"));
    assert_eq!(what, "steps[2].do[76]: at most 256 rules are allowed here, not 257");
}

#[test]
fn too_much_of_a_model() {
    let small = include_str!("models/small-range.yaml");
    let problems = |more: &str| model::check(&format!("{small}\n{more}"));
    let choices = many(101, |n| format!("      c{n}: {{}}\n"));
    let option = format!(
        "options:\n  o:\n    about: a\n    why: w\n    default: c0\n    choices:\n{choices}"
    );
    let told = problems(&option);
    let says = |it: &drivemu::problem::Problem| it.what.contains("at most 100 choices");
    assert!(told.iter().any(says), "{told:?}");
    let note = "n".repeat(4000);
    let row = format!("{{at: 0x2000, name: r, see: \"1\", sim: none, note: {note}}}");
    for more in [
        format!("repeats:\n  r: {{n: [0, 20000], stride: 1, registers: {{\"r{{n}}\": {row}}}}}\n"),
        format!(
            "fill:\n  f: {{span: [0x2000, 0x7FFF], id: \"f{{n}}\", name: f, see: \"1\", assumed: {note}}}\n"
        ),
    ] {
        let told = problems(&more);
        let says = "the total text of all copies may have at most 67108864 bytes";
        assert!(told.iter().any(|it| it.what == says), "{told:?}");
    }
}

/// What people write comes nowhere near.
#[test]
fn the_models_are_well_below() {
    for builtin in Builtin::all() {
        assert!(text_of(builtin.stem()).len() < bounds::SIZE / 100);
    }
}
