//! What drives keep over power-off: taken out of one run, put into the next, and counted.

use crate::kit::{Files, MODELS, bench_line, drain, rig, rig_of};
use drivemu::bench::{self, DeviceSpec, Saved};
use drivemu::bus::{Command, DriveOrder, Output};
use drivemu::event::{DriveEvent, DriveId, EventKind};
use drivemu::testkit::{Rig, hex};
use drivemu::time::{Duration, Instant};
use drivemu::vocabulary::AlarmCause;
use drivemu::wire::rtu;

const ACME: &str = include_str!("models/acme-s1.yaml");

/// Jog speed 250, for good.
const STORE: &str = "01 06 E3 04 00 FA";

fn servo(spec: &DeviceSpec) -> Rig {
    rig("hcfa-x", &[], spec)
}

fn with_set(row: &str, value: i64) -> DeviceSpec {
    DeviceSpec { set: [(row.to_owned(), value)].into(), ..DeviceSpec::default() }
}

/// The same drive in the next run.
fn next_run(rig: &Rig, spec: &DeviceSpec) -> Rig {
    servo(spec).with_state(&rig.state()).expect("a state of the same drive")
}

fn read(rig: &mut Rig, at: &str) -> String {
    let answer = rig.ask(&format!("01 03 {at} 00 01"));
    answer.strip_prefix("01 03 02 ").expect("an answer").to_owned()
}

#[test]
fn what_was_stored_is_there_in_the_next_run_and_the_rest_is_not() {
    let mut first = servo(&DeviceSpec::default());
    first.ask(STORE);
    first.ask("01 06 08 0B 00 10");
    assert_eq!(read(&mut first, "08 0B"), "00 10");
    let mut second = next_run(&first, &DeviceSpec::default());
    assert_eq!(read(&mut second, "03 04"), "00 FA");
    assert_ne!(read(&mut second, "08 0B"), "00 10");
    assert_eq!(second.state(), first.state());
}

#[test]
fn the_text_of_a_state() {
    let mut rig = servo(&with_set("P09.11", 7));
    rig.ask(STORE);
    rig.ask(STORE);
    // Back to what left the factory: stored all the same.
    rig.ask("01 06 E8 0B 00 00");
    let want = "\
# Non-volatile memory of the drives. Do not edit during a run.
format: 1
drives:
  line/1:
    model: hcfa-x
    saves: 0
    rows:
      P03.04: {value: 250, writes: 2}  # Jog speed
      P08.11: {value: 0, writes: 1}  # Parameter of the address example
      P09.11: {value: 7, writes: 0}  # Hold time of words written by the master
";
    assert_eq!(rig.state(), want);
    assert!(include_str!("../docs/state.md").contains(want), "the example there is another");
}

#[test]
fn a_start_value_wins_and_is_kept_too() {
    let mut first = servo(&DeviceSpec::default());
    first.ask(STORE);
    let mut second = next_run(&first, &with_set("P03.04", 300));
    assert_eq!(read(&mut second, "03 04"), "01 2C");
    let mut third = next_run(&second, &DeviceSpec::default());
    assert_eq!(read(&mut third, "03 04"), "01 2C");
    assert!(third.state().contains("P03.04: {value: 300, writes: 1}"), "{}", third.state());
}

#[test]
fn power_off_loses_no_count() {
    let mut rig = servo(&DeviceSpec::default());
    rig.ask(STORE);
    let before = rig.state();
    power_cycle(&mut rig);
    assert_eq!(rig.state(), before);
}

#[test]
fn an_address_and_a_speed_that_were_stored_hold_from_the_start() {
    let mut first = servo(&DeviceSpec::default());
    first.ask("01 06 E9 00 00 07");
    first.ask("07 06 E9 01 00 03");
    let second = next_run(&first, &DeviceSpec::default());
    assert_eq!(second.drive().unit(), 7);
    assert_eq!(second.wire().mode.settings.baud, 19200);
    let third = next_run(&second, &DeviceSpec { unit: Some(2), ..DeviceSpec::default() });
    assert_eq!(third.drive().unit(), 2);
}

/// Speeds that drives have kept: the line goes with the first, and each keeps its own, unless the bench says how
/// the line talks.
#[test]
fn a_bench_that_says_its_speed_sets_all_drives_to_it() {
    let bench = |settings: &str| {
        format!(
            "lines: [{{name: cell, pty: auto, {settings} drives: [{{model: hcfa-x}}, {{model: k-series, unit: 2}}]}}]"
        )
    };
    let state = "{format: 1, drives: {cell/1: {model: hcfa-x, rows: {P09.01: {value: 3}}}}}";
    let modes = |text: &str, state: &str| -> Vec<String> {
        let mut saved = Saved::read(state).expect("a state");
        let bench = bench::parse_saved(text, &Files, &mut saved).expect("a bench");
        saved.finish().expect("a state of these drives");
        let bus = bench.lines[0].bus(0);
        let drives = bus.drives().map(|(_, drive)| drive.mode());
        drives.map(|mode| mode.expect("a mode").to_string()).collect()
    };
    let told = bench("settings: 9600-8N2,");
    assert_eq!(modes(&told, state), ["9600-8N2 RTU"; 3]);
    assert_eq!(modes(&bench(""), state), ["19200-8N2 RTU"; 3]);
    let both = "{format: 1, drives: {cell/2/A: {model: k-series, rows: {P600: {value: 0x0062, writes: 1}}}}}";
    let mixed = ["9600-8N2 RTU", "19200-8N2 RTU", "9600-8N2 RTU"];
    assert_eq!(modes(&bench(""), both), mixed);
}

#[test]
fn all_rows_at_once_count_once() {
    let mut rig = rig("yako-closed-loop", &[], &DeviceSpec::default());
    rig.ask("01 06 00 23 00 C8");
    assert!(rig.state().contains("rows: {}"), "{}", rig.state());
    rig.ask("01 06 00 2D 00 42");
    let state = rig.state();
    assert!(state.contains("saves: 1") && state.contains("{value: 200, writes: 0}"), "{state}");
}

#[test]
fn the_factory_values_return_and_the_wear_stays() {
    let mut rig = rig_of(ACME, &[], &DeviceSpec::default());
    rig.ask("05 06 60 01 00 14");
    rig.ask("05 06 20 10 00 06");
    let state = rig.state();
    assert!(
        state.contains("saves: 1") && state.contains("P001: {value: 50, writes: 1}"),
        "{state}"
    );
}

/// Alarms of the past are written by the drive, and no row that a master writes; they are kept all the same.
#[test]
fn alarms_of_the_past_are_read_back() {
    let mut first = rig("k-series", &[], &DeviceSpec::default());
    let (drive, cause) = (DriveId(0), AlarmCause::Overload);
    first.command(Command::Drive(drive, DriveOrder::Raise(cause))).expect("an alarm of the model");
    let next = rig("k-series", &[], &DeviceSpec::default());
    let mut second = next.with_state(&first.state()).expect("its own state");
    assert_eq!(read(&mut second, "04 00"), read(&mut first, "04 00"));
    assert_ne!(read(&mut second, "04 00"), "00 00");
}

#[test]
fn a_row_that_clears_itself_keeps_nothing() {
    let mut rig = rig("k-series", &[], &DeviceSpec::default());
    rig.ask("01 06 05 21 00 01");
    assert!(!rig.state().contains("clear_alarm"), "{}", rig.state());
}

/// Each station has a memory of its own, and each drive of a line its place.
#[test]
fn drives_and_stations_are_told_apart() {
    let cell = bench_line(
        "lines: [{name: cell 1, tcp: '127.0.0.1:0', drives: [{model: k-series}, {model: k-series, unit: 3}]}]",
    );
    let mut rig = Rig::line(cell.clone()).with_framing(drivemu::line::Framing::Mbap);
    for (unit, value) in [(1, 11), (2, 22), (4, 44)] {
        rig.send(&drivemu::wire::mbap::encode(0, unit, &[6, 0x01, 0x30, 0, value]));
    }
    let state = rig.state();
    let places: Vec<_> = state.lines().filter(|line| line.contains("cell 1")).collect();
    assert_eq!(places.len(), 4);
    assert!(state.contains("  \"cell 1/2/b\":"), "{state}");
    let again = Rig::line(cell).with_state(&state).expect("the same drives");
    let row = again.drive().model().map.find("0x0130").expect("a row");
    let values: Vec<_> = (1..=4).map(|unit| again.unit(unit).expect("there").show(row)).collect();
    assert_eq!(values[..2], [11, 22]);
    assert_eq!(values[3], 44);
    assert_eq!(again.state(), state);
}

#[test]
fn the_state_of_another_model_is_refused() {
    let other = rig("k-series", &[], &DeviceSpec::default()).state();
    let problems = servo(&DeviceSpec::default()).with_state(&other).expect_err("another model");
    assert!(
        problems[0].to_string().contains("no drive line/1/A (k-series) (it has line/1 (hcfa-x))"),
        "{}",
        problems[0]
    );
    let other = rig_of(ACME, &[], &DeviceSpec::default()).state();
    let problems = servo(&DeviceSpec::default()).with_state(&other).expect_err("another model");
    assert!(problems[0].what.contains("acme-s1 in this file and hcfa-x"), "{}", problems[0]);
}

/// What is confirmed is kept: the order to keep comes before the answer, and none comes where nothing is stored.
#[test]
fn kept_before_confirmed() {
    let outputs = |model: &str, request: &str| -> Vec<&'static str> {
        let rig = rig(model, &[], &DeviceSpec::default());
        let mut bus = rig.fresh_bus();
        let link = bus.open(rig.wire().framing(1.0));
        bus.advance_to(Instant::from_millis(2000));
        drain(&mut bus);
        let request = hex(request).expect("hex");
        bus.receive(bus.now(), link, &rtu::encode(request[0], &request[1..]));
        bus.advance_to(Instant::from_millis(3000));
        std::iter::from_fn(|| bus.poll_output()).map(kind).collect()
    };
    let stored = ["keep", "answer", "event"];
    assert_eq!(outputs("hcfa-x", STORE), stored);
    assert_eq!(outputs("hcfa-x", "01 06 03 04 00 FA"), stored[1..]);
    assert_eq!(outputs("hcfa-x", "01 03 E3 04 00 01"), stored[1..]);
    assert_eq!(outputs("hcfa-x", "01 06 E9 0B 00 63"), stored[1..]);
    assert_eq!(outputs("k-series", "01 06 01 30 00 05"), stored);
    // A row that nothing is wired to is told of.
    assert_eq!(outputs("k-series", "01 06 04 52 00 05"), ["answer", "event", "event"]);
    assert_eq!(
        outputs("yako-closed-loop", "01 06 00 2D 00 42"),
        ["keep", "answer", "event", "event"]
    );
    // A broadcast has no answer, and is kept all the same.
    assert!(outputs("hcfa-x", "00 06 E3 04 00 FA").contains(&"keep"));
}

fn kind(output: Output) -> &'static str {
    match output {
        Output::Keep(_) => "keep",
        Output::Transmit { .. } => "answer",
        Output::Event(_) => "event",
        Output::Moved(_) | Output::Close(_) => "other",
    }
}

#[test]
fn a_worn_row_is_told_at_ten_and_at_a_hundred_thousand() {
    let worn = |writes: u32| {
        let state = servo(&DeviceSpec::default())
            .state()
            .replace("rows: {}", &format!("rows: {{P03.04: {{value: 1, writes: {writes}}}}}"));
        let mut rig = servo(&DeviceSpec::default()).with_state(&state).expect("a state");
        rig.ask(STORE);
        assert!(rig.state().contains(&format!("writes: {}", writes.saturating_add(1))));
        told(&rig)
    };
    let says = |count: u32| {
        vec![format!("unit 1 excessive EEPROM writes: P03.04 jog speed stored {count} times")]
    };
    assert_eq!(worn(9_998), [""; 0]);
    assert_eq!(worn(9_999), says(10_000));
    assert_eq!(worn(10_000), [""; 0]);
    assert_eq!(worn(99_999), says(100_000));
    assert_eq!(worn(u32::MAX), [""; 0]);
}

#[test]
fn cyclic_eeprom_writes_are_reported_once() {
    let mut rig = servo(&DeviceSpec::default());
    let cycle = |rig: &mut Rig, every: Duration| {
        for _ in 0..300 {
            rig.ask(STORE);
            rig.advance(every);
        }
    };
    cycle(&mut rig, Duration::from_secs(1));
    assert_eq!(told(&rig), [""; 0]);
    cycle(&mut rig, Duration::from_millis(500));
    let says = "unit 1 excessive EEPROM writes: P03.04 jog speed stored 100 times within 60 s";
    assert_eq!(told(&rig), [says]);
    power_cycle(&mut rig);
    cycle(&mut rig, Duration::from_millis(500));
    assert_eq!(told(&rig), [says; 2]);
    // For now only: that wears nothing.
    for _ in 0..300 {
        rig.ask("01 06 08 0B 00 10");
    }
    assert_eq!(told(&rig).len(), 2);
}

#[test]
fn storing_all_in_a_cycle_is_told_too() {
    let mut rig = rig("yako-closed-loop", &[], &DeviceSpec::default());
    (0..100).for_each(|_| assert!(!rig.ask("01 06 00 2D 00 42").is_empty()));
    assert_eq!(
        told(&rig),
        ["unit 1 excessive EEPROM writes: all parameters stored 100 times within 60 s"]
    );
    let last = rig.events().last().expect("an event").kind.clone();
    let within = Some(Duration::from_secs(60));
    let wear = DriveEvent::ExcessiveWrites { row: None, writes: 100, within };
    assert!(matches!(last, EventKind::Drive { event: change, .. } if change == wear));
}

#[cfg(feature = "cli")]
#[test]
fn wear_for_programs() {
    let mut rig = servo(&DeviceSpec::default());
    (0..100).for_each(|_| assert!(!rig.ask(STORE).is_empty()));
    let object = crate::kit::object(rig.events().last().expect("one"));
    assert_eq!(object["event"], "excessive_writes");
    assert_eq!((&object["row"], &object["writes"]), (&"P03.04".into(), &100.into()));
    assert_eq!(object["within_s"], 60);
}

/// Whatever masters have stored, the next run can read it.
#[test]
fn each_row_that_is_stored_is_read_back() {
    for name in MODELS {
        let mut first = rig(name, &[], &DeviceSpec::default());
        let model = first.drive().model().clone();
        let unit = first.drive().unit();
        for (id, row) in model.map.rows() {
            // What would take the drive off the line stays as it is.
            if row.kind.words() == 1 && id != model.line.unit.row {
                let value = row.spans.last().map_or(0, |(_, high)| row.kind.raw(*high) as u16);
                let [[a, b], [c, d]] = [row.at, value].map(u16::to_be_bytes);
                first.send(&rtu::encode(unit, &[6, a, b, c, d]));
            }
        }
        let state = first.state();
        let second = rig(name, &[], &DeviceSpec::default()).with_state(&state);
        let second = second.unwrap_or_else(|problems| panic!("{name}: {}\n{state}", problems[0]));
        assert_eq!(second.drive().kept(), first.drive().kept(), "{name}");
    }
}

fn power_cycle(rig: &mut Rig) {
    let drive = drivemu::event::DriveId(0);
    rig.command(Command::Drive(drive, DriveOrder::PowerCycle)).expect("there");
}

/// Lines of the log about wear, without their times.
fn told(rig: &Rig) -> Vec<String> {
    let log = rig.log();
    let wear = log.lines().filter(|line| line.contains("excessive EEPROM"));
    wear.filter_map(|line| Some(line.split_once(' ')?.1.to_owned())).collect()
}
