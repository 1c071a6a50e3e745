//! No order is silent: whatever a master or a terminal asks for, in whatever situation, either something happens or
//! the log says why not, in one line and once.

use crate::expect::{read, root};
use crate::kit::{MODELS, rig_of, text_of};
use drivemu::bench::DeviceSpec;
use drivemu::bus::{Command, DriveOrder};
use drivemu::event::{DriveEvent, DriveId, EventKind};
use drivemu::model::{RowId, Wiring};
use drivemu::testkit::{Rig, to_hex};
use drivemu::vocabulary::{Action, Input, Output};
use std::time::Duration;

const FIRST: DriveId = DriveId(0);

/// What a drive is doing when an order comes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Situation {
    /// Power has just come on.
    NotReady,
    /// No bit of an input word is enabled.
    Disabled,
    Off,
    Ready,
    Alarm,
    Homing,
    Moving,
    Jogging,
    AtLimits,
    Held,
    /// No command of a move is taken.
    Inhibited,
}

const SITUATIONS: [Situation; 11] = [
    Situation::NotReady,
    Situation::Disabled,
    Situation::Off,
    Situation::Ready,
    Situation::Alarm,
    Situation::Homing,
    Situation::Moving,
    Situation::Jogging,
    Situation::AtLimits,
    Situation::Held,
    Situation::Inhibited,
];

/// An order.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Order {
    /// A bit of a row is set.
    Bit(RowId, u8),
    /// The last terminal, with the function of this number, becomes active.
    Terminal(u16),
    /// A value is written.
    Value(RowId, u16),
}

#[test]
fn each_order_does_something_or_says_why_not() {
    let mut silent = Vec::new();
    let mut tried = 0;
    for model in MODELS.iter().copied().chain(["acme-s1.yaml"]) {
        let orders = orders(&wired(model, Situation::Ready, None));
        assert!(orders.len() > 10, "{model}: {orders:?}");
        for situation in SITUATIONS {
            for order in &orders {
                let mut rig = wired(model, situation, Some(*order));
                if !get_into(&mut rig, situation) || is_so(&rig, *order) {
                    continue;
                }
                tried += 1;
                let before = rig.events().len();
                give(&mut rig, *order);
                let all = drive_events(&rig, before);
                let why = all.iter().filter(|it| matches!(it, DriveEvent::NoEffect { .. })).count();
                if all.is_empty() || why > 1 {
                    let log = rig.log_from(before.saturating_sub(3));
                    silent.push(format!("{model}, {situation:?}, {order:?}:\n{log}"));
                }
                // Refreshed like this, it says nothing new.
                let before = rig.events().len();
                if let Order::Bit(row, _) = order {
                    let raw = rig.drive().bank().raw(*row) as u16;
                    for _ in 0..3 {
                        rig.advance(Duration::from_millis(1));
                        write(&mut rig, *row, raw);
                    }
                    let again = drive_events(&rig, before);
                    if again.iter().any(|it| matches!(it, DriveEvent::NoEffect { .. })) {
                        let log = rig.log_from(before.saturating_sub(3));
                        silent.push(format!("AGAIN {model}, {situation:?}, {order:?}:\n{log}"));
                    }
                }
            }
        }
    }
    assert!(tried > 1000, "{tried}");
    let count = silent.len();
    silent.truncate(40);
    assert!(silent.is_empty(), "{count} of {tried}\n{}", silent.join("\n"));
}

/// What programs read: what was ordered, where, and why nothing came of it, each in a field of its own.
#[cfg(feature = "cli")]
#[test]
fn the_log_tells_programs_what_and_why() {
    let objects = |model: &str, requests: &[&str]| -> Vec<serde_json::Value> {
        let mut rig = rig_of(text_of(model), &[], &DeviceSpec::default());
        requests.iter().for_each(|request| drop(rig.ask(request)));
        let object = |event| crate::kit::object(event);
        let all = rig.events().iter().map(object);
        all.filter(|it| it["event"] == "no_effect").collect()
    };
    let told = objects("hcfa-x", &["01 06 36 07 00 02", "01 03 36 88 00 01", "01 06 14 0C 00 01"]);
    let fields = |at: usize, names: &[&str]| -> Vec<String> {
        names.iter().map(|name| told[at][*name].to_string()).collect()
    };
    let bit = ["order", "row", "bit", "on", "reason", "by", "by_bit"];
    let want = ["\"bit\"", "\"VDI1\"", "1", "true", "\"disabled\"", "\"P09.05\"", "1"];
    assert_eq!(fields(0, &bit), want);
    let want = ["\"read\"", "\"VDO1\"", "null", "null", "\"disabled\"", "\"P09.09\"", "null"];
    assert_eq!(fields(1, &bit), want);
    let action = ["order", "action", "reason", "by", "by_value"];
    let want = ["\"action\"", "\"home_start\"", "\"not_allowed\"", "\"P08.88\"", "0"];
    assert_eq!(fields(2, &action), want);
    assert_eq!(told[0]["text"], "unit 1 VDI1 bit 1 S_ON has no effect: P09.05 bit 1 is 0");
    assert_eq!(told[0]["why"], "P09.05 bit 1 is 0");
}

/// Signals that order nothing: later orders look at them.
fn is_condition(input: Input) -> bool {
    matches!(
        input,
        Input::HomeSwitch
            | Input::LimitPos
            | Input::LimitNeg
            | Input::EnableInhibit
            | Input::SegmentReverse
            | Input::ReversePosition
            | Input::ReverseSpeed
            | Input::ZeroSpeedClamp
            | Input::Pause
            | Input::ClearDeviation
            | Input::CommandInhibit
            | Input::InterruptInhibit
            | Input::Select0
            | Input::Select1
            | Input::Select2
            | Input::Select3
    )
}

/// A drive of `model` that has all it needs for the situation and for the order.
fn wired(model: &str, situation: Situation, order: Option<Order>) -> Rig {
    let text = match model.strip_suffix(".yaml") {
        Some(_) => read(&root("tests/models").join(model)),
        None => text_of(model).to_owned(),
    };
    let mut spec = DeviceSpec::default();
    let mut set = |name: &str, value: i64| {
        spec.set.insert(name.to_owned(), value);
    };
    let own: &[(&str, i64)] = match model {
        "hcfa-x" => &[("P08.06", 1_000_000), ("P08.86", 1), ("P08.88", 1), ("P08.89", 2)],
        "k-series" => &[("group0_target", 1_000_000), ("group0_speed", 100), ("group0_type", 2)],
        "acme-s1.yaml" => {
            &[("P002", 600), ("P003", 1_000_000), ("S161", 1_000_000), ("P040", 0x1000)]
        }
        _ => &[("target", 1_000_000)],
    };
    own.iter().for_each(|(name, value)| set(name, *value));
    let plain = rig_of(&text, &[], &DeviceSpec::default());
    let wiring = wiring(&plain);
    let id = |row: &RowId| plain.drive().model().map.row(*row).id.clone();
    let enables = wiring.input_words.iter().flat_map(|words| &words.enabled_by);
    let enabled = if situation == Situation::Disabled { 0 } else { 0xFFFF };
    enables.for_each(|row| set(&id(row), enabled));
    if let Some(terminals) = &wiring.input_terminals {
        terminals.functions.iter().for_each(|row| set(&id(row), 0));
        for (row, input) in terminals.functions.iter().zip(by_terminal(situation)) {
            let code = terminals.codes.iter().find(|(_, it)| it == input);
            code.into_iter().for_each(|(code, _)| set(&id(row), (*code).into()));
        }
        if let (Some(Order::Terminal(code)), Some(row)) = (order, terminals.functions.last()) {
            set(&id(row), code.into());
        }
    }
    rig_of(&text, &[], &spec)
}

/// The signals that bring a drive into a situation, where only terminals do.
fn by_terminal(situation: Situation) -> &'static [Input] {
    match situation {
        Situation::Jogging => &[Input::JogPos],
        Situation::AtLimits => &[Input::LimitPos, Input::LimitNeg],
        Situation::Held => &[Input::Stop],
        _ => &[],
    }
}

/// All orders that the model knows, and values and bits that it does not.
fn orders(rig: &Rig) -> Vec<Order> {
    let wiring = wiring(rig);
    let mut orders = Vec::new();
    for row in wiring.input_words.iter().flat_map(|words| &words.rows) {
        orders.extend((0..16).map(|bit| Order::Bit(*row, bit)));
    }
    for (row, _) in &wiring.input_bits {
        orders.extend((0..16).map(|bit| Order::Bit(*row, bit)));
    }
    if let Some(terminals) = &wiring.input_terminals {
        orders.extend(terminals.codes.iter().map(|(code, _)| Order::Terminal(*code)));
        orders.push(Order::Terminal(0));
    }
    for commands in &wiring.commands {
        let values = commands.actions.iter().map(|(value, _)| *value as u16).chain([9]);
        let row = rig.drive().model().map.row(commands.row);
        let values = values.filter(|value| row.admits(i64::from(*value)));
        orders.extend(values.map(|value| Order::Value(commands.row, value)));
    }
    for triggers in &wiring.triggers {
        orders.extend((0..16).map(|bit| Order::Value(triggers.row, 1 << bit)));
    }
    orders.retain(|order| signal(wiring, *order).is_none_or(|it| !is_condition(it)));
    orders
}

/// The signal that an order is about.
fn signal(wiring: &Wiring, order: Order) -> Option<Input> {
    match order {
        Order::Bit(row, bit) => {
            let bits = wiring.input_bits.iter().filter(|(it, _)| *it == row);
            let mut bits = bits.flat_map(|(_, bits)| bits).filter(|(it, _)| *it == bit);
            let words = wiring.input_words.as_ref();
            let word = words.and_then(|words| words.rows.iter().position(|it| *it == row));
            let position = word.map(|word| word as u16 * 16 + u16::from(bit));
            let positions = words.map_or(&[][..], |words| &words.positions);
            let by_word = positions.iter().find(|(it, _)| Some(*it) == position);
            bits.next().map(|(_, it)| *it).or(by_word.map(|(_, it)| *it))
        }
        Order::Terminal(code) => wiring.input_terminals.as_ref()?.meaning(u32::from(code)),
        Order::Value(..) => None,
    }
}

/// Has the drive been told so already?
fn is_so(rig: &Rig, order: Order) -> bool {
    match order {
        Order::Bit(row, bit) => rig.drive().bank().raw(row) >> bit & 1 != 0,
        Order::Terminal(_) | Order::Value(..) => false,
    }
}

fn give(rig: &mut Rig, order: Order) {
    match order {
        Order::Bit(row, bit) => {
            let raw = rig.drive().bank().raw(row) as u16 | 1 << bit;
            write(rig, row, raw);
        }
        Order::Terminal(_) => {
            let terminals = wiring(rig).input_terminals.as_ref().expect("it has terminals");
            let index = terminals.functions.len() as u8 - 1;
            rig.command(Command::Drive(FIRST, DriveOrder::Terminal { index, signal: true }))
                .expect("it can");
        }
        Order::Value(row, value) => write(rig, row, value),
    }
}

/// Brings the drive into the situation, if that can be.
fn get_into(rig: &mut Rig, situation: Situation) -> bool {
    let on = |rig: &mut Rig| by_action(rig, Action::Enable) || by_signal(rig, Input::ServoOn);
    match situation {
        Situation::NotReady => {
            let ready_after = wiring(rig).servo.ready_after;
            rig.command(Command::Drive(FIRST, DriveOrder::PowerCycle)).expect("it can");
            return !ready_after.is_zero();
        }
        Situation::Disabled => return wiring(rig).input_words.is_some(),
        Situation::Off => {
            by_action(rig, Action::Release);
            return !rig.drive().output(Output::Enabled);
        }
        _ => drop(on(rig)),
    }
    assert!(rig.drive().output(Output::Enabled), "{}", rig.log());
    let moves = |rig: &mut Rig| by_action(rig, Action::MoveStart);
    let is = |rig: &mut Rig, output| {
        rig.advance(Duration::from_millis(20));
        rig.drive().output(output)
    };
    match situation {
        Situation::Alarm => {
            let cause = wiring(rig).alarms.iter().find(|it| it.resettable).expect("one").cause;
            rig.command(Command::Drive(FIRST, DriveOrder::Raise(cause))).expect("it can");
            is(rig, Output::Alarm)
        }
        Situation::Homing => {
            let started = by_signal(rig, Input::HomeStart) || by_action(rig, Action::HomeStart);
            started && is(rig, Output::Moving)
        }
        Situation::Moving => {
            let started = moves(rig) || by_signal(rig, Input::SegmentStart);
            started && is(rig, Output::Moving)
        }
        Situation::Jogging => by_signal(rig, Input::JogPos) && is(rig, Output::Moving),
        Situation::AtLimits => by_signal(rig, Input::LimitPos) && by_signal(rig, Input::LimitNeg),
        Situation::Held => by_signal(rig, Input::Stop) || by_signal(rig, Input::QuickStop),
        Situation::Inhibited => {
            by_signal(rig, Input::CommandInhibit) || by_signal(rig, Input::ClearDeviation)
        }
        _ => true,
    }
}

/// Makes a signal active, if something can.
fn by_signal(rig: &mut Rig, input: Input) -> bool {
    let (drive, wiring) = (rig.drive(), wiring(rig));
    let mut bits: Vec<(RowId, u8)> = Vec::new();
    if let Some(words) = &wiring.input_words {
        let positions = words.positions.iter().filter(|(_, it)| *it == input);
        bits.extend(positions.map(|(at, _)| (words.rows[usize::from(at / 16)], (at % 16) as u8)));
    }
    for (row, own) in &wiring.input_bits {
        bits.extend(own.iter().filter(|(_, it)| *it == input).map(|(bit, _)| (*row, *bit)));
    }
    if let Some((row, bit)) = bits.pop() {
        give(rig, Order::Bit(row, bit));
        return true;
    }
    let Some(terminals) = &wiring.input_terminals else { return false };
    let raw = |row: &RowId| drive.bank().raw(*row);
    let index = terminals.functions.iter().position(|it| terminals.meaning(raw(it)) == Some(input));
    let Some(index) = index.filter(|index| index + 1 < terminals.functions.len()) else {
        return false;
    };
    rig.command(Command::Drive(FIRST, DriveOrder::Terminal { index: index as u8, signal: true }))
        .is_ok()
}

/// Gives an action, if something can.
fn by_action(rig: &mut Rig, action: Action) -> bool {
    let wiring = wiring(rig);
    let commands = wiring.commands.iter().find_map(|commands| {
        let (value, _) = commands.actions.iter().find(|(_, it)| *it == action)?;
        Some((commands.row, *value as u16))
    });
    let triggers = wiring.triggers.iter().find_map(|triggers| {
        let (bit, _) = triggers.actions.iter().find(|(_, it)| *it == action)?;
        Some((triggers.row, 1 << bit))
    });
    let Some((row, value)) = triggers.or(commands) else { return false };
    write(rig, row, value);
    true
}

fn write(rig: &mut Rig, row: RowId, value: u16) {
    let (unit, at) = (rig.drive().unit(), rig.drive().model().map.row(row).at.to_be_bytes());
    let value = value.to_be_bytes();
    let request = to_hex(&[unit, 6, at[0], at[1], value[0], value[1]]);
    assert_eq!(rig.ask(&request), request, "{}", rig.log());
}

/// What the drive has told from event number `first` on, apart from levels of its terminals.
fn drive_events(rig: &Rig, first: usize) -> Vec<DriveEvent> {
    let change = |what: &EventKind| match what {
        EventKind::Drive { event: DriveEvent::Terminal { .. }, .. } => None,
        EventKind::Drive { event: change, .. } => Some(change.clone()),
        _ => None,
    };
    rig.events()[first..].iter().filter_map(|event| change(&event.kind)).collect()
}

fn wiring(rig: &Rig) -> &Wiring {
    &rig.drive().model().wiring
}
