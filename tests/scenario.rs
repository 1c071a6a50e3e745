//! Scenarios under the virtual clock: what steps wait for, what they do, what they expect.

#[cfg(feature = "cli")]
mod keys;
mod page;

use crate::kit::rig;
use drivemu::bench::{BuiltinLibrary, DeviceSpec};
use drivemu::problem::render::render;
use drivemu::scenario::Verdict;
use drivemu::testkit::Rig;
use drivemu::vocabulary::{Output, Quantity};
use std::time::Duration;

/// A run at 120 rpm, 2000 counts/s.
const RUN: &str = "01 06 0027 0002";
/// Reads the alarm.
const READ: &str = "01 03 0006 0001";

/// A drive at unit 1 with the steps in `text`.
fn play(text: &str) -> Rig {
    play_on("yako-closed-loop", text)
}

fn play_on(model: &str, text: &str) -> Rig {
    let rig = rig(model, &[], &DeviceSpec::default()).with_scenario(text);
    rig.unwrap_or_else(|problems| panic!("{}", render(&problems, "scenario", text)))
}

/// When the step called `name` began, in milliseconds, as the log tells it.
fn began(rig: &Rig, name: &str) -> Vec<String> {
    let log = rig.log();
    let told = format!(" step {name}");
    let at = |line: &str| line.strip_suffix(&told).map(str::to_owned);
    log.lines().filter_map(at).collect()
}

fn failures(verdicts: &[Verdict]) -> Vec<(&str, Option<&str>)> {
    verdicts.iter().map(|it| (it.step.as_str(), it.failure.as_deref())).collect()
}

#[test]
fn steps_come_one_after_the_other() {
    let mut rig = play(
        "steps:
        - {name: first, do: [raise over_voltage]}
        - {name: later, at: 2s, do: [power_cycle]}
        - {name: past, at: 1s, do: [block on]}
        - {name: waits, wait: 1500ms, do: [block off]}
        - {name: thrice, repeat: {every: 100ms, times: 3}, do: [power_cycle]}
        - {name: last, do: [freeze on]}",
    );
    rig.advance(Duration::from_secs(10));
    let times = ["first", "later", "past", "waits", "thrice", "last"].map(|it| began(&rig, it));
    let want: [&[&str]; 6] =
        [&["0.000"], &["2.000"], &["2.000"], &["3.500"], &["3.500", "3.600", "3.700"], &["3.700"]];
    assert_eq!(times, want, "{}", rig.log());
    assert!(rig.log().contains("device fault on: position feedback frozen"));
}

#[test]
fn transactions_are_counted_since_the_step_above() {
    let mut rig = play(
        "steps:
        - {name: writes, after: {n: 2, kind: write}, do: [raise over_voltage]}
        - {name: reads, after: {n: 1, kind: read}, do: [power_cycle]}
        - {name: any, after: {n: 2, unit: 1}, do: [raise under_voltage]}",
    );
    let mut seen = Vec::new();
    for request in [READ, RUN, READ, RUN, READ, "01 06 FFFF 0000", "01 2B 0000"] {
        rig.ask(request);
        // Nobody answers to these.
        rig.ask("09 03 0006 0001");
        rig.ask("00 06 0027 0200");
        seen.push(
            ["writes", "reads", "any"].iter().filter(|it| !began(&rig, it).is_empty()).count(),
        );
    }
    // The refused write and the unknown function are two.
    assert_eq!(seen, [0, 0, 0, 1, 2, 2, 3], "{}", rig.log());
}

/// A block shows where the axis was at the instant.
#[test]
fn a_position_is_met_to_the_count() {
    for (when, want) in [
        ("quantity: position.actual, above: 1499", 1500),
        ("quantity: position.actual, is: 777", 777),
        ("register: position, above: 12, below: 99", 13),
        ("quantity: speed.actual, above: 29", -1),
        ("quantity: error.following, is: 10", -1),
        ("signal: moving, is: on", 0),
    ] {
        let text = format!("steps: [{{name: here, when: {{{when}}}, do: [block on]}}]");
        for request in ["01 06 0027 0001", RUN] {
            let mut rig = play(&text);
            rig.advance(Duration::from_secs(1));
            rig.ask("01 10 0020 0006 0C 0000 0064 0064 003C 0000 2710");
            rig.ask(request);
            rig.advance(Duration::from_secs(3));
            let position = rig.drive().quantity(Quantity::PositionActual);
            let moves = when.contains("error");
            match want {
                -1 => assert!(position > 0 && position < 2000 || moves, "{when}: {position}"),
                _ => assert_eq!(position, want, "{when} {request}\n{}", rig.log()),
            }
        }
    }
}

#[test]
fn a_position_is_met_downwards_too() {
    let mut rig = play(
        "steps: [{name: here, when: {quantity: position.actual, below: -499}, do: [block on]}]",
    );
    rig.ask("01 10 0020 0006 0C 0000 0064 0064 003C FFFF D8F0");
    rig.ask("01 06 0027 0001");
    rig.advance(Duration::from_secs(3));
    assert_eq!(rig.drive().quantity(Quantity::PositionActual), -500, "{}", rig.log());
}

/// However often anybody looks, the same happens at the same instants.
#[test]
fn slices_of_time_change_nothing() {
    let text = "steps:
        - {name: noise, do: ['fault noisy_cable']}
        - {name: run, when: {quantity: speed.actual, above: 60}, do: [freeze on]}
        - {name: on, when: {signal: moving, is: on}, do: [freeze off, bounce X0 3 7ms]}
        - {name: there, when: {quantity: position.actual, above: 3000}, expect: [{signal: moving, is: off}], within: 1s}
        - {name: off, do: [power off]}
        - {name: back, wait: 333ms, do: [power on]}";
    let play = |slices: u32| {
        let mut rig = play(text);
        rig.send(&drivemu::wire::rtu::encode(1, &[6, 0, 0x27, 0, 2]));
        for _ in 0..slices {
            rig.advance(Duration::from_secs(4) / slices);
        }
        (rig.log(), rig.verdicts().to_vec())
    };
    let whole = play(1);
    assert_eq!(whole, play(400));
    assert!(whole.0.contains("step back"), "{}", whole.0);
}

#[test]
fn expectations_hold_or_fail() {
    let mut rig = play(
        "steps:
        - {name: at once, expect: [{signal: alarm, is: off}, {quantity: alarm.code, is: 0}]}
        - {name: wrong, do: [raise over_voltage], expect: [{signal: alarm, is: off}]}
        - {name: register, expect: [{register: error_code, above: 1, below: 3}]}
        - {name: in time, do: [power_cycle], expect: [{signal: moving, is: on}], within: 2s}
        - {name: late, expect: [{quantity: position.actual, above: 100000}], within: 500ms}
        - {name: impossible, do: [power off, raise over_voltage]}",
    );
    rig.advance(Duration::from_secs(1));
    rig.ask(RUN);
    rig.advance(Duration::from_secs(1));
    let want = [
        ("at once", None),
        ("wrong", Some("alarm of unit 1 is on, not off")),
        ("register", None),
        ("in time", None),
        ("late", Some("position.actual of unit 1 is 900, not above 100000")),
        ("impossible", Some("the drive has no power")),
    ];
    assert_eq!(failures(rig.verdicts()), want, "{}", rig.log());
    assert_eq!(rig.verdicts()[3].took, Duration::from_secs(1));
    let log = rig.log();
    assert!(log.contains("0.000 step wrong failed: alarm of unit 1 is on, not off\n"), "{log}");
    assert!(log.contains("1.000 step in time passed\n"), "{log}");
}

#[test]
fn what_does_not_come_has_failed() {
    let steps = "steps:
        - {name: never, when: {signal: moving, is: on}, do: [freeze on]}
        - {name: silent, do: [freeze off]}
        - {name: after, expect: [{signal: alarm, is: off}]}";
    let mut rig = play(steps);
    rig.advance(Duration::from_secs(9));
    assert_eq!(failures(rig.verdicts()), []);
    let why = Some("the run has ended before this step");
    assert_eq!(failures(rig.finish()), [("never", why), ("silent", why), ("after", why)]);
    let mut rig = play(&format!("limit: 3s\n{steps}"));
    rig.advance(Duration::from_secs(9));
    assert!(rig.log().contains("3.000 step never failed: the run has ended before this step\n"));
    assert_eq!(failures(rig.verdicts()).len(), 3);
    let mut rig =
        play("limit: 3s\nsteps: [{name: waits, expect: [{signal: moving, is: on}], within: 1min}]");
    rig.advance(Duration::from_secs(9));
    assert_eq!(failures(rig.verdicts()), [("waits", Some("the run has ended during this step"))]);
}

/// Everything that a step can do, and what shows it.
#[test]
fn each_order_does_something() {
    for (order, says) in [
        ("terminal X0 on", "terminal X0 on"),
        ("stick X0 on", "device fault on: terminal X0 stuck"),
        ("bounce X0 1 5ms", "terminal X0 off"),
        ("raise over_voltage", "alarm 2"),
        ("hold over_voltage on", "device fault on"),
        ("block on", "axis blocked"),
        ("encoder off", "alarm 4"),
        ("freeze on", "frozen"),
        ("power off", "power off"),
        ("power_cycle", "power on"),
        ("fault lose_reply:count=1", "fault lose_reply: "),
    ] {
        let mut rig = play(&format!("steps: [{{name: s, wait: 1s, do: ['{order}']}}]"));
        rig.advance(Duration::from_secs(1));
        rig.send(&drivemu::wire::rtu::encode(1, &[3, 0, 6, 0, 1]));
        rig.advance(Duration::from_secs(1));
        let log = rig.log();
        let (_, after) = log.split_once("1.000 step s\n").expect("the step is told");
        assert!(after.contains(says), "{order}: {log}");
    }
    let mut rig = play(
        "steps: [{name: s, do: ['fault noisy_cable', fault late]}, {name: e, do: [no_fault noisy_cable, no_fault late]}]",
    );
    rig.advance(Duration::from_secs(1));
    assert_eq!(rig.bus().faults().names().count(), 0);
}

#[test]
fn a_step_names_its_drive() {
    let bench = "lines: [{tcp: '127.0.0.1:0', drives: [{model: hcfa-x, unit: 3}, {model: yako-closed-loop, unit: 7}]}]";
    let rig = Rig::bench(bench, &BuiltinLibrary).expect("a good bench");
    let text = "steps:
        - {name: first, do: [power off], expect: [{unit: 7, signal: powered, is: on}]}
        - {name: second, unit: 7, do: [raise over_voltage], expect: [{signal: alarm, is: on}, {unit: 3, signal: powered, is: off}]}";
    let rig = rig.with_scenario(text).expect("a good scenario");
    assert_eq!(failures(rig.verdicts()), [("first", None), ("second", None)], "{}", rig.log());
    assert!(!rig.unit(7).expect("it has power").output(Output::Ready));
}

#[cfg(feature = "cli")]
#[test]
fn steps_as_json() {
    use crate::kit::object;
    use serde_json::json;
    let rig = play("steps: [{name: a step, expect: [{signal: alarm, is: on}]}]");
    let told = rig.events().iter().map(object);
    let told: Vec<_> = told.filter(|it| it["event"] == "step").collect();
    assert_eq!((&told[0]["step"], &told[0]["outcome"]), (&json!("a step"), &json!("started")));
    assert_eq!(told[1]["outcome"], "failed");
    assert_eq!(told[1]["why"], "alarm of unit 1 is off, not on");
}
