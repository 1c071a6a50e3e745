//! What chains of segments wait for: every condition, alone and with another.

use super::{acme, by_bit, give, write_row};
use drivemu::bench::DeviceSpec;
use drivemu::testkit::Rig;
use drivemu::vocabulary::{Action, Condition, Input, Named, Quantity};
use std::time::Duration;

/// Selects a segment and starts it.
pub(super) fn start(rig: &mut Rig, selects: &[Input]) {
    give(rig, Action::Enable);
    selects.iter().for_each(|it| by_bit(rig, *it, true));
    by_bit(rig, Input::SegmentStart, true);
    by_bit(rig, Input::SegmentStart, false);
}

/// Starts segment 16 with `rule` and the value of its first condition, and segment 17 to follow; and lets
/// the first end, which takes it less than half a second.
pub(super) fn chain(rig: &mut Rig, rule: u16, value: u16) {
    for (row, value) in [("S165", 17), ("S166", rule), ("S167", value)] {
        write_row(rig, row, value);
    }
    start(rig, &[]);
    rig.advance(Duration::from_millis(500));
}

#[test]
fn each_condition_counts() {
    for &condition in Condition::ALL {
        let mut rig = acme(&DeviceSpec::default());
        let (code, value) = match condition {
            Condition::Delay => (1, 10),
            Condition::Step => (2, 0),
            Condition::Position => (3, 4),
        };
        chain(&mut rig, code, value);
        let running = |rig: &Rig| rig.drive().quantity(Quantity::SegmentRunning);
        match condition {
            Condition::Delay => rig.advance(Duration::from_secs(1)),
            Condition::Step => {
                assert_eq!(running(&rig), 16, "{}", rig.log());
                by_bit(&mut rig, Input::SegmentStep, true);
                Vec::new()
            }
            // It is where the segment ends.
            Condition::Position => Vec::new(),
        };
        assert_eq!(running(&rig), 17, "`{}`\n{}", condition.name(), rig.log());
    }
}

/// What a program reads in the log of segments, and that people read the same.
#[cfg(feature = "cli")]
#[test]
fn the_log_tells_of_segments() {
    let mut rig = acme(&DeviceSpec::default());
    by_bit(&mut rig, Input::SegmentStart, true);
    by_bit(&mut rig, Input::SegmentStart, false);
    chain(&mut rig, 3, 4);
    rig.advance(Duration::from_secs(1));
    by_bit(&mut rig, Input::SegmentRun, true);
    let kinds = ["position_segment", "velocity_segment", "chain_step", "no_effect"];
    let want = [
        "no_effect | segment_start | the servo is off | unit 5 segment_start has no effect: the servo is off",
        "position_segment | 16 | 40000 | unit 5 position segment 16: moving to 40000",
        "chain_step | 16 | 17 | position reached | unit 5 segment 16 chained to segment 17: position reached",
        "position_segment | 17 | -5000 | unit 5 position segment 17: moving to -5000",
        "velocity_segment | 0 | 60.0 | unit 5 velocity segment 0: running at 60 rpm",
    ];
    assert_eq!(super::motion::told(&rig, &kinds), want);
}

/// What a program reads where no segment follows, and that people read the same.
#[cfg(feature = "cli")]
#[test]
fn the_log_tells_where_a_chain_ends() {
    let mut rig = acme(&DeviceSpec::default());
    for (row, value) in [("S165", 15), ("S166", 1), ("S167", 10)] {
        write_row(&mut rig, row, value);
    }
    start(&mut rig, &[]);
    rig.advance(Duration::from_secs(5));
    let want =
        "chain_ended | 15 | no such segment | unit 5 chain ended at segment 15: no such segment";
    assert_eq!(super::motion::told(&rig, &["chain_ended"]), [want]);
}
