//! Orders that come twice because nobody heard the first answer: `repeated_command`.

use super::{SILENCE, acme, ask, drive_of, frame};
use drivemu::bus::{Command, DriveOrder};
use drivemu::event::{DriveEvent, DriveId, Event, EventKind};
use drivemu::medium::FaultKind;
use drivemu::testkit::Rig;
use drivemu::time::Duration;
use drivemu::vocabulary::{Action, AlarmCause, Named};

/// A stepper's relative move by 1000 counts, which takes 1 s and a half.
const DISTANCE: &[u8] = &[0x10, 0, 0x24, 0, 2, 4, 0, 0, 0x03, 0xE8];
const MOVE: &[u8] = &[0x06, 0x00, 0x27, 0x00, 0x01];
/// To a position, not by a way.
const MOVE_TO: &[u8] = &[0x06, 0x00, 0x27, 0x00, 0x05];
const STATUS: &[u8] = &[0x03, 0x00, 0x07, 0x00, 0x01];

/// A stepper with these rules and a distance to go.
fn stepper(specs: &[&str]) -> Rig {
    let mut rig = drive_of("yako-closed-loop", &[], 0);
    ask(&mut rig, DISTANCE);
    specs.iter().for_each(|spec| rig.add_fault(spec).expect("a good rule"));
    rig
}

fn repeated(rig: &Rig) -> u64 {
    let told =
        rig.events().iter().filter(|it| matches!(it.kind, EventKind::RepeatedCommand { .. }));
    assert_eq!(told.count() as u64, rig.bus().repeated_commands(DriveId(0)), "{}", rig.log());
    rig.bus().repeated_commands(DriveId(0))
}

fn moves(rig: &Rig) -> usize {
    let moved = |event: &&Event| {
        matches!(event.kind, EventKind::Drive { event: DriveEvent::Moving { .. }, .. })
    };
    rig.events().iter().filter(moved).count()
}

/// Gives `order`, lets it come to its end, and gives it again.
fn twice(rig: &mut Rig, order: &[u8]) -> Vec<u8> {
    ask(rig, order);
    rig.advance(Duration::from_secs(5));
    ask(rig, order)
}

#[test]
fn an_order_whose_answer_was_lost_comes_again() {
    let mut rig = stepper(&["lose_reply:count=1"]);
    assert_eq!(twice(&mut rig, MOVE), frame(MOVE));
    assert_eq!((moves(&rig), repeated(&rig)), (2, 1));
    let said = "unit 1 move_start repeated; the first reply never arrived (#1)\n";
    assert!(rig.log().ends_with(said), "{}", rig.log());
    rig.advance(Duration::from_secs(5));
    ask(&mut rig, MOVE);
    assert_eq!((moves(&rig), repeated(&rig)), (3, 1), "this one was meant");
}

#[test]
fn an_order_that_was_lost_itself_does_not() {
    let mut rig = stepper(&["lose_request:count=1"]);
    assert_eq!(twice(&mut rig, MOVE), frame(MOVE));
    assert_eq!((moves(&rig), repeated(&rig)), (1, 0));
}

/// A kind that is not held against here fails.
#[test]
fn each_kind_lets_the_answer_arrive_or_not() {
    for kind in FaultKind::ALL {
        let (spec, want) = match kind.name {
            "delay" => ("delay:ms=6000", 1),
            "split" => ("split:gap_ms=6000", 1),
            "reorder" => ("reorder:ms=6000", 1),
            "lose_reply" | "bad_crc" | "flip_bits" | "truncate" | "late" | "wrong_unit"
            | "wrong_function" => (kind.name, 1),
            "exception" => ("exception:code=4", 0),
            "lose_request" | "extra" | "garbage" | "duplicate" | "busy" | "echo" => (kind.name, 0),
            _ => panic!("nobody tests `{kind}`"),
        };
        let mut rig = stepper(&[spec]);
        twice(&mut rig, MOVE);
        assert_eq!(repeated(&rig), want, "{spec}\n{}", rig.log());
    }
    for spec in ["delay:ms=5000", "split:gap_ms=5000"] {
        let mut rig = stepper(&[spec]);
        twice(&mut rig, MOVE);
        assert_eq!(repeated(&rig), 0, "{spec}: it has arrived");
    }
}

/// An order that the axis ignores because it still moves is one too: next time the master may be slower.
#[test]
fn a_hasty_master_is_reported_as_well() {
    let mut rig = stepper(&["lose_reply:count=2"]);
    ask(&mut rig, MOVE);
    ask(&mut rig, MOVE);
    assert_eq!((moves(&rig), repeated(&rig)), (1, 1), "{}", rig.log());
    assert!(rig.log().contains("move_start has no effect: the axis is moving"), "{}", rig.log());
    rig.advance(Duration::from_secs(5));
    ask(&mut rig, MOVE);
    assert_eq!((moves(&rig), repeated(&rig)), (2, 2), "{}", rig.log());
}

/// What the drive did not obey the first time is not done twice.
#[test]
fn an_order_in_vain_may_come_again() {
    let mut rig = stepper(&["lose_reply:skip=1,count=1"]);
    ask(&mut rig, MOVE);
    assert_eq!(ask(&mut rig, MOVE), SILENCE);
    rig.advance(Duration::from_secs(5));
    ask(&mut rig, MOVE);
    assert_eq!((moves(&rig), repeated(&rig)), (2, 0), "{}", rig.log());
}

/// A master that looks, or gives another order, knows what it does.
#[test]
fn only_the_same_request_at_once_counts() {
    for between in [STATUS, MOVE_TO, DISTANCE] {
        let mut rig = stepper(&["lose_reply:count=1"]);
        ask(&mut rig, MOVE);
        rig.advance(Duration::from_secs(5));
        ask(&mut rig, between);
        rig.advance(Duration::from_secs(5));
        ask(&mut rig, MOVE);
        assert_eq!(repeated(&rig), 0, "{}", rig.log());
    }
    let mut rig = stepper(&["busy:skip=1,count=1", "lose_reply:count=1"]);
    twice(&mut rig, MOVE);
    ask(&mut rig, MOVE);
    assert_eq!(repeated(&rig), 1, "who is busy has seen nothing");
}

#[test]
fn to_a_position_is_the_same_once_and_twice() {
    let mut rig = stepper(&["lose_reply:count=1"]);
    twice(&mut rig, MOVE_TO);
    assert_eq!((moves(&rig), repeated(&rig)), (2, 0), "{}", rig.log());
}

/// An action that is not held against here does not compile.
#[test]
fn each_action_adds_up_or_does_not() {
    for &action in Action::ALL {
        let want = match action {
            Action::QuickStop
            | Action::Stop
            | Action::Enable
            | Action::Release
            | Action::ClearAlarmHistory => 0,
            Action::HomeStart
            | Action::MoveStart
            | Action::RunStart
            | Action::AlarmReset
            | Action::EncoderReset
            | Action::ClearPosition
            | Action::ClearTurns
            | Action::StoreAll
            | Action::RestoreFactory
            | Action::PowerCycle => 1,
        };
        let mut rig = acme(&[]);
        if matches!(action, Action::MoveStart | Action::RunStart | Action::HomeStart) {
            let enable = order(&rig, Action::Enable);
            ask(&mut rig, &enable);
            // A run needs a speed.
            ask(&mut rig, &[6, 0x20, 0x02, 0, 60]);
        } else if let Action::AlarmReset | Action::EncoderReset = action {
            let encoder = action == Action::EncoderReset;
            let cause = if encoder { AlarmCause::Encoder } else { AlarmCause::Overload };
            let drive = DriveId(0);
            rig.command(Command::Drive(drive, DriveOrder::Raise(cause)))
                .expect("an alarm of the model");
        }
        rig.add_fault("lose_reply:count=1").expect("a good rule");
        let order = order(&rig, action);
        (0..2).for_each(|_| drop(ask(&mut rig, &order)));
        assert_eq!(repeated(&rig), want, "{}\n{}", action.name(), rig.log());
    }
}

/// The request that gives `action`, as a value of the command row or a bit of the trigger row.
fn order(rig: &Rig, action: Action) -> Vec<u8> {
    let model = rig.drive().model();
    let commands =
        model.wiring.commands.iter().flat_map(|it| {
            it.actions.iter().map(|(value, action)| (it.row, *value as u16, *action))
        });
    let triggers = model
        .wiring
        .triggers
        .iter()
        .flat_map(|it| it.actions.iter().map(|(bit, action)| (it.row, 1 << *bit, *action)));
    let (row, value, _) =
        commands.chain(triggers).find(|(.., it)| *it == action).expect("the model wires all");
    let ([a, b], [c, d]) = (model.map.row(row).at.to_be_bytes(), value.to_be_bytes());
    vec![6, a, b, c, d]
}
