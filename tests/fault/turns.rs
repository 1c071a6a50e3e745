//! Whom a rule hits: conditions, turns, chance, order, and rules that come and go.

use super::{ANSWER, READ, SILENCE, WRITE, acme, ask, drive, drive_of, effects, frame, hits};
use drivemu::bus::{CommandError, LineCommand};
use drivemu::testkit::Rig;
use drivemu::time::Duration;
use drivemu::wire::rtu;

/// Which of `n` equal requests were hit, counted from 1.
fn hit(specs: &[&str], n: usize) -> Vec<usize> {
    let mut rig = drive(specs);
    (1..=n).filter(|_| ask(&mut rig, READ) != frame(ANSWER)).collect()
}

#[test]
fn turns() {
    assert_eq!(hit(&["lose_reply:every=2"], 7), [2, 4, 6]);
    assert_eq!(hit(&["lose_reply:skip=3"], 5), [4, 5]);
    assert_eq!(hit(&["lose_reply:skip=1,every=3"], 8), [4, 7]);
    assert_eq!(hit(&["lose_reply:every=2,count=2"], 9), [2, 4]);
    assert_eq!(hit(&["lose_reply:count=1"], 3), [1]);
    assert_eq!(hit(&["lose_reply:probability=1"], 3), [1, 2, 3]);
}

#[test]
fn conditions() {
    let hit = |spec: &str, unit: u8, pdu: &[u8]| {
        let mut rig = super::super::line::cell(false).with_fault(spec).expect("a good rule");
        rig.send(&rtu::encode(unit, pdu));
        hits(&rig, "lose_reply") == 1
    };
    let read = |start: u8, count: u8| [3, 0x03, start, 0, count];
    assert!(hit("lose_reply:unit=1", 1, READ) && !hit("lose_reply:unit=2", 1, READ));
    assert!(hit("lose_reply:function=3", 1, READ) && !hit("lose_reply:function=6", 1, READ));
    assert!(hit("lose_reply:function=[0x06,0x03]", 1, READ));
    assert!(hit("lose_reply:function=0x2B", 1, &[0x2B, 0x0E]), "also one that nobody knows");
    assert!(hit("lose_reply:register=0x0304", 1, READ));
    assert!(hit("lose_reply:register=772", 1, WRITE), "decimal");
    assert!(hit("lose_reply:register=0304H", 1, WRITE), "as manuals print it");
    assert!(!hit("lose_reply:register=0x0305", 1, READ));
    assert!(hit("lose_reply:register=0x0305", 1, &read(4, 2)), "touched is enough");
    assert!(hit("lose_reply:register=0x0300-0x0304", 1, READ));
    assert!(!hit("lose_reply:register=0x0305-0x0308", 1, READ));
    assert!(hit("lose_reply:register=0x0300-0x0302", 1, &[16, 3, 2, 0, 1, 2, 0, 9]));
    assert!(!hit("lose_reply:register=0x0304", 1, &[0x2B, 0x0E]), "which touches none");
}

/// A row is meant wherever a window shows it, and both words of a pair.
#[test]
fn registers_by_name() {
    for (pdu, want) in [
        (READ, true),
        (&[0x03, 0xE3, 0x04, 0x00, 0x01][..], true),
        (&[0x03, 0x03, 0x05, 0x00, 0x01], false),
    ] {
        let mut rig = drive(&["lose_reply:register=P03.04"]);
        assert_eq!(ask(&mut rig, pdu).is_empty(), want, "{pdu:02X?}");
    }
    let mut rig = drive(&["lose_reply:register=P08.06"]);
    assert_eq!(ask(&mut rig, &[3, 0x08, 0x07, 0, 1]), SILENCE, "half of it, a refusal");
    // A word of ours for a row that has no code.
    let mut rig = drive_of("yako-closed-loop", &["lose_reply:register=accel_time"], 0);
    assert_eq!(ask(&mut rig, &[3, 0, 0x21, 0, 1]), SILENCE);
    assert_ne!(ask(&mut rig, &[3, 0, 0x23, 0, 1]), SILENCE);
}

#[test]
fn a_window_of_time() {
    // The rig is ready after a second.
    let mut rig = drive(&["lose_reply:from=1.5,until=2"]);
    let mut lost = Vec::new();
    for tenth in 10..25 {
        if ask(&mut rig, READ).is_empty() {
            lost.push(tenth);
        }
        let at = Duration::from_millis(100 * (tenth + 1));
        rig.advance(at - Duration::from_nanos(rig.now().as_nanos()));
    }
    assert_eq!(lost, [15, 16, 17, 18, 19]);
}

/// The first that holds acts, and the others count what they would have done.
#[test]
fn the_first_rule_acts() {
    let mut rig = drive(&["busy:every=3", "lose_reply:every=2", "exception:code=4,every=6"]);
    (0..12).for_each(|_| drop(ask(&mut rig, READ)));
    let (busy, lost) = ("busy", "lose_reply");
    assert_eq!(effects(&rig), [lost, busy, lost, busy, lost, busy, lost, busy]);
    assert_eq!((hits(&rig, "busy"), hits(&rig, "lose_reply")), (4, 4));
    assert_eq!(hits(&rig, "exception"), 0, "always another's turn");
}

#[test]
fn rules_come_and_go() {
    let mut rig = drive(&[]);
    rig.add_fault("lose_reply").expect("a good rule");
    rig.add_fault("lose_reply:unit=9").expect("a good rule");
    assert_eq!(rig.bus().faults().names().collect::<Vec<_>>(), ["lose_reply", "lose_reply-2"]);
    assert_eq!(ask(&mut rig, READ), SILENCE);
    assert_eq!(hits(&rig, "lose_reply"), 1);
    let remove = |rig: &mut Rig| rig.command(LineCommand::RemoveFault("lose_reply".into()));
    assert_eq!(remove(&mut rig), Ok(()));
    assert_eq!(rig.bus().faults().hits("lose_reply"), None);
    assert_eq!(ask(&mut rig, READ), frame(ANSWER));
    let gone = CommandError::NoFault("lose_reply".into());
    assert_eq!(remove(&mut rig), Err(gone.clone()));
    assert_eq!(gone.to_string(), "no fault rule `lose_reply` on this line");
    assert!(rig.log().contains("fault lose_reply: reply from unit 1 lost (hit 1)"));
}

#[test]
fn commands_are_refused() {
    let line = crate::kit::line_of(crate::kit::text_of("hcfa-x"), &[], &Default::default());
    let rule = || line.fault("bad_crc:name=x", &[]).expect("a good rule").rules.remove(0);
    let mut rig = drive(&["busy:name=x"]);
    let taken = rig.command(LineCommand::AddFault(rule())).expect_err("the name is taken");
    assert_eq!(taken.to_string(), "duplicate fault rule `x` on this line");
    // A bus that was never told how its line talks is Modbus TCP.
    let mut bus = drivemu::bus::Bus::new();
    let idle = bus.command(bus.now(), LineCommand::AddFault(rule()).into()).expect_err("no CRC");
    assert_eq!(idle.to_string(), "`x` has no effect here: Modbus TCP frames have no checksum");
}

#[test]
fn a_preset_takes_conditions_and_its_rules_its_name() {
    let rig = acme(&["sleepy_drive:unit=9", "sleepy_drive:name=tired,register=C003"]);
    let names: Vec<_> = rig.bus().faults().names().collect();
    assert_eq!(names[..2], ["sleepy_drive.lose_request", "sleepy_drive.busy"]);
    assert_eq!(names[2..4], ["sleepy_drive.delay", "sleepy_drive.delay-2"]);
    assert_eq!(names[7], "tired.delay-2");
    let mut rig = acme(&["sleepy_drive:unit=9"]);
    assert_ne!(ask(&mut rig, &[3, 0x10, 0x03, 0, 1]), SILENCE, "somebody else's");
    let mut rig = acme(&["sleepy_drive:unit=1"]);
    assert_eq!(ask(&mut rig, &[3, 0x10, 0x03, 0, 1]), SILENCE);
    assert_ne!(rig.advance(Duration::from_secs(2)), SILENCE);
}
