//! One of each event, as drives would tell it.

use crate::kit::{rig, text_of};
use drivemu::bench::DeviceSpec;
use drivemu::event::{
    Broadcast, ChainEnd, Decoder, DeviceFault, DeviceFaultChange, DriveEvent, DriveId, Event,
    EventKind, Here, Ignored, MilliRpm, NoEffect, Ordered, Outcome, Remark, Replanned, RowName,
    TerminalName, Transaction,
};
use drivemu::model::{Choices, load};
use drivemu::serial::{Mode, Settings};
use drivemu::testkit::hex;
use drivemu::time::{Duration, Instant};
use drivemu::vocabulary::{
    Action, AlarmCause, Cause, Condition, Detail, HomeEnd, HomingStep, Input, Pace, Refusal, RowId,
    SignalEdge, Then, Until,
};
use drivemu::wire::ascii::BadAscii;
use drivemu::wire::mbap::BadHeader;
use drivemu::wire::{Frame, Inline, NoiseCause, Pdu};

/// One of each, in the order of the page.
pub fn all() -> Vec<Event> {
    let kinds = transactions().into_iter().chain(of_the_line()).chain(rules_and_steps());
    let drive = drive_events().into_iter().map(|event| EventKind::Drive {
        drive: DriveId(0),
        unit: 1,
        line: None,
        event,
    });
    let at = |i: usize| Instant::from_millis(1000 + 250 * i as u64);
    kinds.chain(drive).enumerate().map(|(i, kind)| Event { at: at(i), kind }).collect()
}

fn decoder() -> Decoder {
    rig("hcfa-x", &[], &DeviceSpec::default()).bus().drive(DriveId(0)).decoder()
}

fn row(id: &str) -> RowId {
    let model = load(text_of("hcfa-x"), &Choices::new()).expect("a good model");
    model.map.find(id).expect("a row")
}

fn pdu(text: &str) -> Pdu {
    Pdu::from_slice(&hex(text).expect("hex"))
}

fn transactions() -> Vec<EventKind> {
    let transaction = |request: &str, reply: &str, refusal| {
        let (request, reply) = (pdu(request), pdu(reply));
        let (drive, unit) = (DriveId(0), 1);
        let decoder = decoder();
        EventKind::Transaction(Transaction { drive, unit, decoder, request, reply, refusal })
    };
    let range = Refusal {
        cause: Cause::Range,
        code: 3,
        detail: Detail::Value { row: row("P09.00"), got: 300 },
    };
    let function = Refusal { cause: Cause::Function, code: 1, detail: Detail::Function(0x2B) };
    let broadcast = |request: &str, refusal| Broadcast {
        drive: DriveId(0),
        unit: 1,
        decoder: decoder(),
        request: pdu(request),
        refusal,
    };
    vec![
        transaction("03 0304 0001", "03 02 00FA", None),
        transaction("06 0304 00FA", "06 0304 00FA", None),
        transaction("06 0900 012C", "86 03", Some(range)),
        transaction("2B 0000", "AB 01", Some(function)),
        EventKind::Broadcast(broadcast("06 0304 00FA", None)),
        EventKind::Broadcast(broadcast("06 0900 012C", Some(range))),
        EventKind::BroadcastRead { request: pdu("03 0304 0001") },
        EventKind::RepeatedCommand {
            drive: DriveId(0),
            unit: 1,
            action: Action::MoveStart,
            count: 1,
        },
    ]
}

fn settings(text: &str) -> Settings {
    text.parse().expect("settings")
}

fn of_the_line() -> Vec<EventKind> {
    let mut units = drivemu::line::Units::new();
    units.insert(1);
    let here = Some(Here::Units(units));
    let (baud, stop_bits, line) = (19_200, 2, settings("9600-8N2"));
    vec![
        EventKind::Foreign { unit: 5, pdu: pdu("03 0304 0001"), reply: false, here },
        EventKind::Foreign { unit: 5, pdu: pdu("03 02 0064"), reply: true, here: None },
        EventKind::BadCrc {
            frame: Frame::from_slice(&hex("01 03 03 04 00 01 85 C1").expect("hex")),
            got: Inline::from_slice(&[0x85, 0xC1]),
            expected: Inline::from_slice(&[0xC4, 0x4F]),
            exception: None,
        },
        EventKind::BadAscii {
            characters: Frame::from_slice(b"010301300001C1"),
            why: BadAscii::Lrc { got: 0xC1, want: 0xCA },
        },
        EventKind::Noise {
            head: Inline::from_slice(&[0, 0xFF]),
            len: 2,
            why: NoiseCause::TooShort,
        },
        EventKind::LineSettings { mode: Mode { ascii: false, settings: settings("19200-8N2") } },
        EventKind::PortSettings { baud, stop_bits, line, fits: false, passes: true },
        EventKind::StreamClosed { why: BadHeader::Protocol(0x0103) },
    ]
}

fn rules_and_steps() -> Vec<EventKind> {
    let mut faulty = rig("hcfa-x", &[], &DeviceSpec::default());
    faulty.add_fault("split:at=3,gap_ms=50").expect("a good rule");
    faulty.send(&drivemu::wire::rtu::encode(1, &[3, 3, 4, 0, 1]));
    let hit = faulty.events().iter().find(|it| matches!(it.kind, EventKind::Fault(_)));
    let step = |outcome, what: &str| {
        EventKind::Step(Remark { step: "reset".into(), outcome, what: what.into() })
    };
    vec![
        hit.expect("it acts").kind.clone(),
        step(Outcome::Begins, ""),
        step(Outcome::Passed, ""),
        step(Outcome::Failed, "alarm of unit 1 is on, not off"),
    ]
}

fn drive_events() -> Vec<DriveEvent> {
    let name = |id: &str| RowName(decoder(), row(id));
    let mode = |text: &str| Some(Mode { ascii: false, settings: settings(text) });
    let (method, at) = (24, 4777);
    let edge = SignalEdge { signal: Input::HomeSwitch, on: true };
    let step =
        HomingStep { forward: true, pace: Pace::Fast, until: Until::Edge(edge), then: Then::Ramp };
    let mut all = vec![
        DriveEvent::PowerOn,
        DriveEvent::PowerOff,
        DriveEvent::Ready,
        DriveEvent::Servo { on: true },
        DriveEvent::Alarm { cause: AlarmCause::Overload, code: 4 },
        DriveEvent::AlarmCleared,
        DriveEvent::AlarmHistoryCleared,
        DriveEvent::WordExpired { word: name("VDI1"), hold: name("P09.11"), held_ms: 5000 },
        DriveEvent::UnitChanged { from: 1, to: 5 },
        DriveEvent::ModeChanged { from: mode("9600-8N2"), to: mode("19200-8N2") },
        DriveEvent::ModeChanged { from: mode("9600-8N2"), to: None },
        DriveEvent::PositionCleared,
        DriveEvent::TurnsCleared,
        DriveEvent::Stored,
        DriveEvent::ExcessiveWrites {
            row: Some(name("P03.04")),
            writes: 100,
            within: Some(Duration::from_secs(60)),
        },
        DriveEvent::ExcessiveWrites { row: None, writes: 100_000, within: None },
        DriveEvent::FactoryRestored,
        DriveEvent::Moving { to: 5000 },
        DriveEvent::Running { rpm: MilliRpm(-60_000) },
        DriveEvent::Jogging { rpm: MilliRpm(100_000) },
        DriveEvent::PositionSegment { number: 1, to: 5000 },
        DriveEvent::VelocitySegment { number: 2, rpm: MilliRpm(60_000) },
        DriveEvent::ChainStep { from: 0, to: 1, why: Some(Condition::Delay) },
        DriveEvent::ChainStep { from: 0, to: 1, why: None },
        DriveEvent::ChainEnded(ChainEnd { decoder: decoder(), at: 3, why: Ignored::NoSegment }),
    ];
    all.extend(replanned().into_iter().map(DriveEvent::Replanned));
    all.extend([
        DriveEvent::Pausing,
        DriveEvent::Resumed { to: 5000 },
        DriveEvent::DeviationCleared { counts: 200 },
        DriveEvent::Stopping,
        DriveEvent::Coasting,
        DriveEvent::Stopped { at: 5000 },
        DriveEvent::Limit { forward: true, soft: false },
        DriveEvent::HardStop { at: 5000 },
        DriveEvent::PositionDeviation,
        DriveEvent::HomingStarted { method },
        DriveEvent::HomingMoving { method, step, rpm: MilliRpm(120_000) },
        DriveEvent::HomingFound { method, step, at },
        DriveEvent::HomingLimit { method, forward: true, turns: true, at },
        DriveEvent::HomingIndex { method, forward: false },
        DriveEvent::HomingOrigin { method, at },
        DriveEvent::HomingComplete { method, position: 0 },
        DriveEvent::HomingAborted { method, why: HomeEnd::TimeLimit },
    ]);
    all.extend(no_effects());
    for fault in [
        DeviceFault::Cause(AlarmCause::OverVoltage),
        DeviceFault::Blocked,
        DeviceFault::EncoderLost,
        DeviceFault::Frozen,
        DeviceFault::Stuck(0),
    ] {
        let change = DeviceFaultChange { decoder: decoder(), fault, on: true };
        all.push(DriveEvent::DeviceFault(change));
    }
    let terminal = TerminalName(decoder(), 0);
    let every = Duration::from_millis(5);
    all.push(DriveEvent::Bouncing { terminal: terminal.clone(), times: 3, every });
    all.push(DriveEvent::Terminal { terminal, signal: true });
    all
}

fn replanned() -> Vec<Replanned> {
    let rpm = MilliRpm(300_000);
    vec![
        Replanned::Target { to: 5000 },
        Replanned::Speed { rpm },
        Replanned::SlowSpeed { rpm },
        Replanned::StartSpeed { rpm },
        Replanned::Acceleration { rpm_per_s: Some(rpm) },
        Replanned::Deceleration { rpm_per_s: None },
        Replanned::HomeOffset { by: 100 },
        Replanned::TimeLimit { time: Some(Duration::from_secs(3)) },
        Replanned::TimeLimit { time: None },
    ]
}

/// Each shape of an order and each shape of a reason.
fn no_effects() -> Vec<DriveEvent> {
    let (jog, word) = (row("P03.04"), row("VDI1"));
    let orders = [
        (
            Ordered::Bit { row: word, bit: 1, on: true },
            Ignored::Disabled { row: jog, bit: Some(1) },
        ),
        (Ordered::Read(word), Ignored::Disabled { row: jog, bit: None }),
        (Ordered::Action(Action::MoveStart), Ignored::After(Action::HomeStart)),
        (Ordered::Input(Input::JogPos), Ignored::PowerOff),
        (Ordered::Input(Input::HomeStart), Ignored::Starter { row: jog, value: 0 }),
        (Ordered::Input(Input::HomeStart), Ignored::NoEdge { since: Instant::from_millis(1000) }),
        (Ordered::InputOff(Input::ServoOn), Ignored::OtherSource(Input::ServoOn)),
        (Ordered::Write { row: jog, value: 5 }, Ignored::Overridden { row: word }),
        (Ordered::Terminal { index: 0, on: true }, Ignored::NoFunction { row: jog, value: 0 }),
        (Ordered::Function(0), Ignored::NotSimulated),
        (Ordered::Raise(AlarmCause::Overload), Ignored::OtherAlarm(AlarmCause::Encoder)),
    ];
    let no_effect =
        |(order, why)| DriveEvent::NoEffect(NoEffect { decoder: decoder(), order, why });
    orders.into_iter().map(no_effect).collect()
}
