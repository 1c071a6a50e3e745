//! What outputs go by: every threshold turns its output where the made-up drive says.

use super::{acme, by_bit, give, write_row};
use drivemu::bench::DeviceSpec;
use drivemu::vocabulary::{Action, Input, Named, Output, Threshold};
use std::time::Duration;

#[test]
fn each_threshold_counts() {
    for &threshold in Threshold::ALL {
        // Milliseconds of a run or a move, just before the output turns and just after.
        let (action, output, edge) = match threshold {
            // 600 rpm/s: 2 rpm, 3 rpm, 45 rpm less 5 and more 5, 60 rpm less 0.5.
            Threshold::ZeroSpeed => (Action::RunStart, Output::ZeroSpeed, [3, 4]),
            Threshold::TurningSpeed => (Action::RunStart, Output::Turning, [4, 6]),
            Threshold::ReachedSpeed => (Action::RunStart, Output::SpeedReached, [66, 67]),
            Threshold::ReachedWindow => (Action::RunStart, Output::SpeedReached, [83, 84]),
            Threshold::CommandSpeed => {
                command_speed();
                continue;
            }
            Threshold::AgreesWindow => (Action::RunStart, Output::SpeedAgrees, [99, 100]),
            // 1310720 counts/s2 by a gain of 100 1/s are 13107 counts a second behind, from 10 ms on.
            Threshold::CoincidesWindow => (Action::MoveStart, Output::Coincides, [8, 10]),
            Threshold::NearWindow => (Action::MoveStart, Output::Near, [86, 87]),
            // The command ends at 605.2 ms with 655 counts to go: 48.8 ms for all but 5, and 20 ms more.
            Threshold::PositionWindow | Threshold::PositionSettle => {
                (Action::MoveStart, Output::InPosition, [673, 674])
            }
            // 10000 counts take 174.7 ms, the lag 48.8 + 20 ms more, the signal itself 200 ms.
            Threshold::InterruptDoneTime => (Action::Enable, Output::InterruptDone, [400, 444]),
            // 13107 counts a second behind are 5000 after 381.5 ms, and 10 ms that it takes to fall so far behind.
            Threshold::Deviation => (Action::MoveStart, Output::Alarm, [391, 392]),
        };
        let mut spec = DeviceSpec::default();
        if threshold == Threshold::Deviation {
            spec.set.insert("P048".into(), 5000);
        }
        let mut rig = acme(&spec);
        give(&mut rig, Action::Enable);
        match threshold {
            Threshold::InterruptDoneTime => {
                write_row(&mut rig, "P025", 1);
                by_bit(&mut rig, Input::InterruptStart, true);
            }
            _ => give(&mut rig, action),
        }
        let mut told = [false; 2];
        let mut ms = 0;
        for (told, at) in told.iter_mut().zip(edge) {
            rig.advance(Duration::from_millis(at - ms));
            (*told, ms) = (rig.drive().output(output), at);
        }
        assert!(told[0] != told[1], "`{}`: {told:?}\n{}", threshold.name(), rig.log());
    }
}

/// A run of 2 rpm is no command, one of 2.1 rpm is.
fn command_speed() {
    let told = [20, 21].map(|speed| {
        let set = [("P002".to_owned(), speed)].into_iter().collect();
        let mut rig = acme(&DeviceSpec { set, ..DeviceSpec::default() });
        give(&mut rig, Action::Enable);
        give(&mut rig, Action::RunStart);
        rig.drive().output(Output::CommandPresent)
    });
    assert_eq!(told, [false, true]);
}
