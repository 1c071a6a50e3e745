//! Inputs that change what others do: each from every source, active and no longer.

use super::{by_bit, give, write_row};
use drivemu::testkit::Rig;
use drivemu::vocabulary::{Action, Input, Output, Quantity};
use std::time::Duration;

/// Does `input` act from `source`, and no longer once it has fallen?
pub fn acts(rig: &mut Rig, input: Input, source: fn(&mut Rig, Input, bool), place: &str) {
    match input {
        Input::EnableInhibit => {
            source(rig, input, true);
            give(rig, Action::Enable);
            assert!(!rig.drive().output(Output::Enabled), "{place}{}", rig.log());
            source(rig, input, false);
            assert!(rig.drive().output(Output::Enabled), "{place}{}", rig.log());
            source(rig, input, true);
            assert!(rig.drive().output(Output::Enabled), "{place}{}", rig.log());
        }
        Input::InterruptStart | Input::InterruptInhibit => {
            write_row(rig, "P025", 1);
            give(rig, Action::Enable);
            let inhibits = input == Input::InterruptInhibit;
            source(rig, input, true);
            if inhibits {
                by_bit(rig, Input::InterruptStart, true);
            }
            rig.advance(Duration::from_secs(5));
            let want = if inhibits { 0 } else { 10_000 };
            assert_eq!(rig.drive().quantity(Quantity::PositionActual), want, "{place}");
        }
        Input::InterruptUnlock => {
            write_row(rig, "P025", 2);
            give(rig, Action::Enable);
            for want in [10_000, 10_000, 20_000] {
                by_bit(rig, Input::InterruptStart, true);
                rig.advance(Duration::from_secs(5));
                by_bit(rig, Input::InterruptStart, false);
                let position = rig.drive().quantity(Quantity::PositionActual);
                assert_eq!(position, want, "{place}");
                if rig.log().contains("locked") {
                    source(rig, input, true);
                    source(rig, input, false);
                }
            }
        }
        Input::ReversePosition => {
            give(rig, Action::Enable);
            source(rig, input, true);
            for want in [-200_000, 0] {
                give(rig, Action::MoveStart);
                source(rig, input, false);
                rig.advance(Duration::from_secs(5));
                let position = rig.drive().quantity(Quantity::PositionActual);
                assert_eq!(position, want, "{place}");
            }
        }
        Input::Pause => {
            give(rig, Action::Enable);
            give(rig, Action::MoveStart);
            rig.advance(Duration::from_millis(200));
            source(rig, input, true);
            rig.advance(Duration::from_millis(400));
            assert_eq!(rig.drive().quantity(Quantity::SpeedActual), 0, "{place}{}", rig.log());
            assert!(rig.drive().quantity(Quantity::PositionActual) < 100_000, "{place}");
            source(rig, input, false);
            rig.advance(Duration::from_secs(5));
            assert_eq!(rig.drive().quantity(Quantity::PositionActual), 200_000, "{place}");
        }
        Input::ClearDeviation | Input::CommandInhibit => {
            give(rig, Action::Enable);
            give(rig, Action::MoveStart);
            rig.advance(Duration::from_millis(200));
            let here = rig.drive().quantity(Quantity::PositionActual);
            source(rig, input, true);
            assert_eq!(rig.drive().quantity(Quantity::ErrorFollowing), 0, "{place}");
            rig.advance(Duration::from_millis(400));
            assert_eq!(rig.drive().quantity(Quantity::PositionActual), here, "{place}");
            give(rig, Action::MoveStart);
            assert!(!rig.drive().output(Output::Moving), "it is a level: {place}");
            source(rig, input, false);
            give(rig, Action::MoveStart);
            assert!(rig.drive().output(Output::Moving), "{place}{}", rig.log());
        }
        Input::ReverseSpeed | Input::ZeroSpeedClamp => {
            give(rig, Action::Enable);
            by_bit(rig, Input::JogPos, true);
            let speed = if input == Input::ReverseSpeed { -60 } else { 0 };
            for (on, want) in [(true, speed), (false, 60)] {
                source(rig, input, on);
                rig.advance(Duration::from_millis(500));
                let got = rig.drive().quantity(Quantity::SpeedActual);
                assert_eq!(got, want, "{place}{}", rig.log());
            }
        }
        _ => unreachable!("{place}"),
    }
}
