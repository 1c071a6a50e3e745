//! Every word of the catalogue, driven through a made-up drive that wires them all: tests/models/acme-s1.yaml.
//!
//! The `match`es have no `_` arm on purpose: a new word does not compile until it is tested here.

mod functions;
mod homing;
mod motion;
mod quantities;
mod segment;
mod thresholds;

use crate::kit::rig_of;
use drivemu::bench::DeviceSpec;
use drivemu::bus::{Command, DriveOrder};
use drivemu::event::{DriveEvent, DriveId, EventKind, MilliRpm};
use drivemu::model::{RowId, Shows, Wiring};
use drivemu::motion::Machine;
use drivemu::testkit::{Rig, to_hex};
use drivemu::vocabulary::{
    Action, AlarmCause, HomingStep, Input, Modifier, Named, Output, Pace, Quantity, SignalEdge,
    Then, Until,
};
use std::time::Duration;

const ACME: &str = include_str!("models/acme-s1.yaml");
const FIRST: DriveId = DriveId(0);

/// Where an input signal can come from.
const SOURCES: [fn(&mut Rig, Input, bool); 3] = [by_terminal, by_word, by_bit];

#[test]
fn each_input_acts_from_each_source() {
    for &input in Input::ALL {
        for (i, source) in SOURCES.iter().enumerate() {
            let mut rig = acme(&DeviceSpec::default());
            let place = format!("`{}` from source {i}\n", input.name());
            match input {
                Input::ServoOn => {
                    source(&mut rig, input, true);
                    assert!(rig.drive().output(Output::Enabled), "{place}{}", rig.log());
                    source(&mut rig, input, false);
                    assert!(!rig.drive().output(Output::Enabled), "{place}{}", rig.log());
                }
                Input::AlarmReset => {
                    raise(&mut rig, AlarmCause::Overload);
                    source(&mut rig, input, true);
                    assert!(!rig.drive().output(Output::Alarm), "{place}{}", rig.log());
                    raise(&mut rig, AlarmCause::Overload);
                    source(&mut rig, input, false);
                    assert!(rig.drive().output(Output::Alarm), "an edge, no level: {place}");
                }
                Input::Release => {
                    give(&mut rig, Action::Enable);
                    source(&mut rig, input, true);
                    assert!(!rig.drive().output(Output::Enabled), "{place}{}", rig.log());
                    source(&mut rig, input, false);
                    assert!(rig.drive().output(Output::Enabled), "{place}{}", rig.log());
                }
                Input::EnableInhibit
                | Input::InterruptStart
                | Input::InterruptInhibit
                | Input::InterruptUnlock
                | Input::ReversePosition
                | Input::Pause
                | Input::ClearDeviation
                | Input::CommandInhibit
                | Input::ReverseSpeed
                | Input::ZeroSpeedClamp => functions::acts(&mut rig, input, *source, &place),
                Input::Stop | Input::QuickStop => {
                    running(&mut rig);
                    source(&mut rig, input, true);
                    let at_once = !rig.drive().output(Output::Moving);
                    assert_eq!(at_once, input == Input::QuickStop, "{place}{}", rig.log());
                    rig.advance(Duration::from_millis(100));
                    assert!(!rig.drive().output(Output::Moving), "{place}{}", rig.log());
                    give(&mut rig, Action::RunStart);
                    assert!(!rig.drive().output(Output::Moving), "it is a level: {place}");
                    source(&mut rig, input, false);
                    give(&mut rig, Action::RunStart);
                    assert!(rig.drive().output(Output::Moving), "{place}{}", rig.log());
                }
                Input::JogPos | Input::JogNeg => {
                    give(&mut rig, Action::Enable);
                    source(&mut rig, input, true);
                    rig.advance(Duration::from_millis(500));
                    let want = if input == Input::JogPos { 60 } else { -60 };
                    assert_eq!(rig.drive().quantity(Quantity::SpeedActual), want, "{place}");
                    source(&mut rig, input, false);
                    rig.advance(Duration::from_millis(100));
                    assert!(!rig.drive().output(Output::Moving), "{place}{}", rig.log());
                }
                Input::HomeSwitch => {
                    give(&mut rig, Action::Enable);
                    give(&mut rig, Action::HomeStart);
                    rig.advance(Duration::from_millis(200));
                    source(&mut rig, input, true);
                    assert!(rig.log().contains("home_switch on at"), "{place}{}", rig.log());
                }
                Input::LimitPos | Input::LimitNeg => {
                    let away = if input == Input::LimitPos { -600i16 } else { 600 };
                    write_row(&mut rig, "P002", (-away) as u16);
                    running(&mut rig);
                    source(&mut rig, input, true);
                    assert!(!rig.drive().output(Output::Moving), "{place}{}", rig.log());
                    give(&mut rig, Action::RunStart);
                    assert!(!rig.drive().output(Output::Moving), "into it: {place}");
                    write_row(&mut rig, "P002", away as u16);
                    give(&mut rig, Action::RunStart);
                    assert!(rig.drive().output(Output::Moving), "{place}{}", rig.log());
                }
                Input::HomeStart => {
                    write_row(&mut rig, "P040", 0x1000);
                    give(&mut rig, Action::Enable);
                    source(&mut rig, input, true);
                    assert!(rig.drive().output(Output::Moving), "{place}{}", rig.log());
                }
                Input::InchPos | Input::InchNeg | Input::Run => {
                    give(&mut rig, Action::Enable);
                    source(&mut rig, input, true);
                    rig.advance(Duration::from_millis(500));
                    let want = match input {
                        Input::InchPos => 30,
                        Input::InchNeg => -30,
                        _ => 60,
                    };
                    assert_eq!(rig.drive().quantity(Quantity::SpeedActual), want, "{place}");
                    source(&mut rig, input, false);
                    rig.advance(Duration::from_millis(100));
                    assert!(!rig.drive().output(Output::Moving), "{place}{}", rig.log());
                }
                Input::MoveStart | Input::SegmentStart => {
                    give(&mut rig, Action::Enable);
                    source(&mut rig, input, true);
                    source(&mut rig, input, false);
                    rig.advance(Duration::from_secs(5));
                    let want = if input == Input::MoveStart { 200_000 } else { 40_000 };
                    assert_eq!(rig.drive().quantity(Quantity::PositionActual), want, "{place}");
                }
                Input::SegmentStep => {
                    segment::chain(&mut rig, 0x0002, 0);
                    assert_eq!(rig.drive().quantity(Quantity::PositionActual), 40_000, "{place}");
                    source(&mut rig, input, true);
                    rig.advance(Duration::from_secs(5));
                    assert_eq!(rig.drive().quantity(Quantity::PositionActual), -5000, "{place}");
                }
                Input::SegmentRun | Input::SegmentReverse => {
                    give(&mut rig, Action::Enable);
                    if input == Input::SegmentReverse {
                        by_bit(&mut rig, Input::SegmentRun, true);
                    }
                    source(&mut rig, input, true);
                    rig.advance(Duration::from_millis(500));
                    let want = if input == Input::SegmentRun { 60 } else { -60 };
                    assert_eq!(rig.drive().quantity(Quantity::SpeedActual), want, "{place}");
                    source(&mut rig, input, false);
                    rig.advance(Duration::from_millis(500));
                    let want = if input == Input::SegmentRun { 0 } else { 60 };
                    assert_eq!(rig.drive().quantity(Quantity::SpeedActual), want, "{place}");
                }
                Input::Select0 | Input::Select1 | Input::Select2 | Input::Select3 => {
                    source(&mut rig, input, true);
                    let want = 16 + (1 << (input as u8 - Input::Select0 as u8));
                    assert_eq!(rig.drive().quantity(Quantity::SegmentNext), want, "{place}");
                    source(&mut rig, input, false);
                    assert_eq!(rig.drive().quantity(Quantity::SegmentNext), 16, "{place}");
                }
                Input::AlarmForce => {
                    source(&mut rig, input, true);
                    assert_eq!(rig.drive().quantity(Quantity::AlarmCode), 0x99, "{place}");
                }
            }
        }
    }
}

#[test]
fn each_output_shows_both_ways() {
    for &output in Output::ALL {
        let mut rig = acme(&DeviceSpec::default());
        let mut seen = vec![shown(&rig, output)];
        match output {
            // What has no supply does not answer, so nobody can see it off.
            Output::Powered => {
                assert!(seen[0]);
                continue;
            }
            Output::Ready | Output::Alarm => raise(&mut rig, AlarmCause::Overload),
            Output::Enabled | Output::BrakeOpen => give(&mut rig, Action::Enable),
            Output::Moving
            | Output::ZeroSpeed
            | Output::SpeedAgrees
            | Output::Turning
            | Output::CommandPresent => running(&mut rig),
            Output::Coincides | Output::Near => {
                give(&mut rig, Action::Enable);
                seen[0] = shown(&rig, output);
                underway(&mut rig);
            }
            Output::TorqueLimited => {
                let machine = Machine { hard_stop: Some([-10, 10]), ..Machine::default() };
                rig = acme(&DeviceSpec { machine, ..DeviceSpec::default() });
                give(&mut rig, Action::Enable);
                give(&mut rig, Action::RunStart);
                rig.advance(Duration::from_millis(50));
            }
            Output::EncoderA | Output::EncoderB | Output::EncoderZ => {
                rig = acme(&DeviceSpec { start: 2, ..DeviceSpec::default() });
            }
            Output::Selected0 => by_bit(&mut rig, Input::Select0, true),
            Output::Selected1 => by_bit(&mut rig, Input::Select1, true),
            Output::Selected2 => by_bit(&mut rig, Input::Select2, true),
            Output::Selected3 => by_bit(&mut rig, Input::Select3, true),
            Output::SpeedReached => {
                give(&mut rig, Action::Enable);
                give(&mut rig, Action::RunStart);
                rig.advance(Duration::from_millis(75));
            }
            Output::User0 | Output::User1 | Output::User2 => {
                let row = wiring(&rig).user_outputs.expect("it has such a row");
                set_bit(&mut rig, row, output as u16 - Output::User0 as u16, true);
            }
            Output::Settled => {
                give(&mut rig, Action::Enable);
                rig.advance(Duration::from_secs(1));
            }
            Output::InPosition | Output::Arrived => {
                give(&mut rig, Action::Enable);
                give(&mut rig, Action::MoveStart);
                rig.advance(Duration::from_secs(2));
            }
            Output::InterruptActive | Output::InterruptDone => {
                write_row(&mut rig, "P025", 1);
                give(&mut rig, Action::Enable);
                by_bit(&mut rig, Input::InterruptStart, true);
                let done = output == Output::InterruptDone;
                rig.advance(Duration::from_millis(if done { 300 } else { 100 }));
            }
            Output::HomeDone => {
                let machine =
                    Machine { hard_stop: Some([-100_000, 100_000]), ..Machine::default() };
                rig = acme(&DeviceSpec { machine, ..DeviceSpec::default() });
                write_row(&mut rig, "P030", 1);
                give(&mut rig, Action::Enable);
                give(&mut rig, Action::HomeStart);
                rig.advance(Duration::from_secs(5));
            }
            Output::AtLimitPos => by_bit(&mut rig, Input::LimitPos, true),
            Output::AtLimitNeg => by_bit(&mut rig, Input::LimitNeg, true),
            Output::BeyondPos | Output::BeyondNeg => {
                let position = if output == Output::BeyondPos { 500_001 } else { -500_001 };
                rig = acme(&DeviceSpec { position, ..DeviceSpec::default() });
                write_row(&mut rig, "P042", 0x20);
            }
            Output::Segment0 => segment::start(&mut rig, &[Input::Select0]),
            Output::Segment1 => segment::start(&mut rig, &[Input::Select1]),
            Output::Segment2 => segment::start(&mut rig, &[Input::Select2]),
            Output::Segment3 => segment::start(&mut rig, &[Input::Select3]),
            Output::Segment4 => segment::start(&mut rig, &[]),
        }
        seen.push(shown(&rig, output));
        assert!(seen[0] != seen[1], "`{}` is always {}", output.name(), seen[0]);
    }
}

#[test]
fn each_action_acts() {
    for &action in Action::ALL {
        let mut rig = acme(&DeviceSpec { position: 5, ..DeviceSpec::default() });
        match action {
            Action::Release => give(&mut rig, Action::Enable),
            Action::AlarmReset => raise(&mut rig, AlarmCause::Overload),
            Action::EncoderReset => raise(&mut rig, AlarmCause::Encoder),
            Action::Stop | Action::QuickStop => running(&mut rig),
            Action::HomeStart | Action::MoveStart | Action::RunStart => {
                give(&mut rig, Action::Enable);
            }
            Action::Enable
            | Action::ClearAlarmHistory
            | Action::ClearPosition
            | Action::ClearTurns
            | Action::StoreAll
            | Action::RestoreFactory
            | Action::PowerCycle => {}
        }
        give(&mut rig, action);
        let want = match action {
            Action::QuickStop => {
                DriveEvent::Stopped { at: rig.drive().quantity(Quantity::PositionActual) }
            }
            Action::Stop => DriveEvent::Stopping,
            Action::HomeStart => {
                let edge = SignalEdge { signal: Input::HomeSwitch, on: true };
                let (forward, pace, until) = (true, Pace::Fast, Until::Edge(edge));
                let step = HomingStep { forward, pace, until, then: Then::Ramp };
                DriveEvent::HomingMoving { method: 0, step, rpm: MilliRpm(120_000) }
            }
            Action::MoveStart => DriveEvent::Moving { to: 200_005 },
            Action::RunStart => DriveEvent::Running { rpm: MilliRpm(60_000) },
            Action::Enable => DriveEvent::Servo { on: true },
            Action::Release => DriveEvent::Servo { on: false },
            Action::AlarmReset | Action::EncoderReset => DriveEvent::AlarmCleared,
            Action::ClearAlarmHistory => DriveEvent::AlarmHistoryCleared,
            Action::ClearPosition => DriveEvent::PositionCleared,
            Action::ClearTurns => DriveEvent::TurnsCleared,
            Action::StoreAll => DriveEvent::Stored,
            Action::RestoreFactory => DriveEvent::FactoryRestored,
            Action::PowerCycle => DriveEvent::PowerOn,
        };
        let last = rig.events().last().map(|event| event.kind.clone());
        let told = matches!(last, Some(EventKind::Drive { event: change, .. }) if change == want);
        assert!(told, "`{}`\n{}", action.name(), rig.log());
    }
}

#[test]
fn each_alarm_has_its_number() {
    let mut numbers = Vec::new();
    for &cause in AlarmCause::ALL {
        let mut rig = acme(&DeviceSpec::default());
        raise(&mut rig, cause);
        assert!(rig.drive().output(Output::Alarm) && !rig.drive().output(Output::Ready));
        numbers.push(rig.drive().quantity(Quantity::AlarmCode));
    }
    assert_eq!(numbers, [0x31, 0x32, 0x33, 0x41, 0x51, 0x61, 0x71, 0x72, 0x73, 0x81, 0x99]);
}

/// A drive with a run of 60 rpm, a move of 200000 counts and segments of 40000 and -45000 to make, unless
/// `spec` says otherwise.
fn acme(spec: &DeviceSpec) -> Rig {
    let mut spec = spec.clone();
    for (row, value) in [("P002", 600), ("P003", 200_000), ("S161", 40_000), ("S171", -45_000)] {
        spec.set.entry(row.to_owned()).or_insert(value);
    }
    rig_of(ACME, &[], &spec)
}

/// Lets it run at 60 rpm.
fn running(rig: &mut Rig) {
    give(rig, Action::Enable);
    give(rig, Action::RunStart);
    rig.advance(Duration::from_millis(200));
}

/// Lets it move for 200 ms.
fn underway(rig: &mut Rig) {
    give(rig, Action::Enable);
    give(rig, Action::MoveStart);
    rig.advance(Duration::from_millis(200));
}

fn wiring(rig: &Rig) -> &Wiring {
    &rig.drive().model().wiring
}

fn raise(rig: &mut Rig, cause: AlarmCause) {
    rig.command(Command::Drive(FIRST, DriveOrder::Raise(cause))).expect("an alarm of the model");
}

/// Writes one word, and lets the drive start anew if that is what it does.
fn write(rig: &mut Rig, row: RowId, value: u16) {
    let at = rig.drive().model().map.row(row).at.to_be_bytes();
    let request = [&[rig.drive().unit(), 0x06][..], &at, &value.to_be_bytes()].concat();
    let answer = rig.ask(&to_hex(&request));
    assert_eq!(answer, to_hex(&request), "{}", rig.log());
}

/// Writes the row called `id`.
fn write_row(rig: &mut Rig, id: &str, value: u16) {
    let row = rig.drive().model().map.find(id).expect("a row of the model");
    write(rig, row, value);
}

fn set_bit(rig: &mut Rig, row: RowId, bit: u16, on: bool) {
    let present = rig.drive().bank().raw(row) as u16;
    write(rig, row, present & !(1 << bit) | u16::from(on) << bit);
}

/// Gives the command that stands for `action`.
fn give(rig: &mut Rig, action: Action) {
    give_with(rig, action, &[]);
}

/// Gives the command that stands for `action`, with the bits of `modifiers`.
fn give_with(rig: &mut Rig, action: Action, modifiers: &[Modifier]) {
    let word = |value: i64| u16::try_from(value).expect("one word");
    let of_row = |it: &drivemu::model::CommandRows| {
        let value = it.actions.iter().find(|(_, it)| *it == action)?.0;
        Some((it.row, word(value)))
    };
    let of_bits = |it: &drivemu::model::Triggers| {
        let bit = it.actions.iter().find(|(_, it)| *it == action)?.0;
        let with = it.modifiers.iter().filter(|(_, it)| modifiers.contains(it));
        Some((it.row, with.fold(1 << bit, |value, (bit, _)| value | 1 << bit)))
    };
    let command = wiring(rig).commands.iter().find_map(of_row);
    let command = command.or_else(|| wiring(rig).triggers.iter().find_map(of_bits));
    let (row, value) = command.expect("every action is wired");
    write(rig, row, value);
}

fn by_terminal(rig: &mut Rig, input: Input, on: bool) {
    let terminals = wiring(rig).input_terminals.as_ref().expect("it has terminals");
    let code =
        terminals.codes.iter().find(|(_, it)| *it == input).expect("every input has a number").0;
    let row = terminals.functions[2];
    write(rig, row, code);
    rig.command(Command::Drive(FIRST, DriveOrder::Terminal { index: 2, signal: on }))
        .expect("a terminal");
}

fn by_word(rig: &mut Rig, input: Input, on: bool) {
    let words = wiring(rig).input_words.as_ref().expect("it has words");
    let position = words.positions.iter().find(|(_, it)| *it == input).expect("a position").0;
    let (word, bit) = (usize::from(position / 16), position % 16);
    let (row, enable) = (words.rows[word], words.enabled_by[word]);
    set_bit(rig, enable, bit, true);
    set_bit(rig, row, bit, on);
}

fn by_bit(rig: &mut Rig, input: Input, on: bool) {
    let of_row = |(row, bits): &(RowId, Vec<(u8, Input)>)| {
        bits.iter().find(|(_, it)| *it == input).map(|(bit, _)| (*row, u16::from(*bit)))
    };
    let (row, bit) = wiring(rig).input_bits.iter().find_map(of_row).expect("every input has a bit");
    set_bit(rig, row, bit, on);
}

/// What `output` is, after all places that show it said the same: bits, words and a terminal.
fn shown(rig: &Rig, output: Output) -> bool {
    let mut places = vec![rig.drive().output(output)];
    let model = rig.drive().model();
    for (row, _) in model.map.rows() {
        if let Some(Shows::Bits(bits)) = wiring(rig).shows(row) {
            let of_output = bits.iter().filter(|(_, it)| it.signal == output);
            let shown = rig.drive().show(row);
            places.extend(of_output.map(|(bit, it)| (shown >> bit & 1 != 0) != it.inverted));
        }
    }
    let words = wiring(rig).output_words.iter();
    let bits = words.flat_map(|word| word.bits.iter().map(move |(bit, it)| (word, bit, it)));
    for (word, bit, it) in bits.filter(|(.., it)| it.signal == output) {
        let enable = word.enabled_by.expect("an enable word");
        let enabled = rig.drive().bank().raw(enable) >> bit & 1 != 0;
        let bit = rig.drive().show(word.row) >> bit & 1 != 0;
        places.push(if enabled { bit != it.inverted } else { places[0] });
        assert!(enabled || !bit, "a bit shows that is not enabled");
    }
    assert!(places.len() >= 3, "`{}` shows in too few places", output.name());
    assert!(places.iter().all(|it| *it == places[0]), "`{}`: {places:?}", output.name());
    places[0]
}

fn row_showing(rig: &Rig, want: &Shows) -> RowId {
    let model = rig.drive().model();
    let row = model.map.rows().find(|(row, _)| model.wiring.shows(*row) == Some(want));
    row.expect("every word is wired").0
}

/// Factory values put the input words back, so no hold of theirs is left to end.
#[test]
fn factory_values_end_the_holds() {
    let mut rig = acme(&DeviceSpec::default());
    by_word(&mut rig, Input::ServoOn, true);
    give(&mut rig, Action::RestoreFactory);
    assert!(!rig.drive().output(Output::Enabled), "{}", rig.log());
    rig.advance(Duration::from_secs(60));
    assert!(!rig.log().contains("not refreshed"), "{}", rig.log());
}

/// The drive starts within the time that it says, and no sooner.
#[test]
fn it_is_ready_when_it_says() {
    let mut rig = acme(&DeviceSpec::default());
    give(&mut rig, Action::PowerCycle);
    let mut ready = Vec::new();
    for ms in [299, 1] {
        rig.advance(Duration::from_millis(ms));
        ready.push(rig.drive().output(Output::Ready));
    }
    assert_eq!(ready, [false, true]);
}
