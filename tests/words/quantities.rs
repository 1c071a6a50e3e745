//! Every number that a drive computes, in the row of the made-up drive that shows it.

use super::{acme, by_bit, raise, row_showing, running, segment, underway};
use drivemu::bench::DeviceSpec;
use drivemu::model::Shows;
use drivemu::words::{AlarmCause, Input, Quantity, Word};

#[test]
fn each_quantity_shows() {
    let switches = Some(9);
    let spec = DeviceSpec { switches, position: -70_000, ..DeviceSpec::default() };
    for &quantity in Quantity::ALL {
        let mut rig = acme(&spec);
        let want = match quantity {
            Quantity::PositionActual | Quantity::PositionFeedback => -70_000,
            Quantity::PositionCommand => {
                underway(&mut rig);
                // 200 ms at 1310720 counts/s2.
                -70_000 + 26_214
            }
            Quantity::CommandRate => {
                underway(&mut rig);
                let value = rig.drive().show(row_showing(&rig, &Shows::Quantity(quantity)));
                assert_eq!((value, rig.drive().quantity(quantity)), (2621, 262_144), "in 0.1 kHz");
                continue;
            }
            // A revolution is 131072 counts.
            Quantity::EncoderAngle | Quantity::EncoderTurns | Quantity::ElectricalAngle => {
                rig = acme(&DeviceSpec { start: -131_072 - 32_768 - 8192, ..spec.clone() });
                match quantity {
                    Quantity::EncoderAngle => 131_072 - 32_768 - 8192,
                    Quantity::EncoderTurns => -2,
                    // Four pole pairs: an eighth of a revolution is half a turn of the field.
                    _ => 270,
                }
            }
            Quantity::SpeedActual => {
                running(&mut rig);
                let row = row_showing(&rig, &Shows::Quantity(quantity));
                let value = rig.drive().show(row) as i64;
                assert_eq!((value, rig.drive().quantity(quantity)), (600, 60), "in tenths");
                continue;
            }
            Quantity::ErrorFollowing => {
                underway(&mut rig);
                // 262144 counts/s by a gain of 100 1/s, less what a ramp of 1310720 counts/s2 is behind that.
                2490
            }
            Quantity::AlarmCode => {
                raise(&mut rig, AlarmCause::Overload);
                0x41
            }
            Quantity::SegmentRunning => {
                segment::start(&mut rig, &[Input::Select0, Input::Select1]);
                by_bit(&mut rig, Input::Select0, false);
                19
            }
            Quantity::SegmentNext => {
                by_bit(&mut rig, Input::Select1, true);
                18
            }
            Quantity::UnitInUse | Quantity::UnitSwitches => 9,
        };
        let row = row_showing(&rig, &Shows::Quantity(quantity));
        let value = rig.drive().model().map.row(row).kind.value(rig.drive().show(row));
        assert_eq!((value, rig.drive().quantity(quantity)), (want, want), "`{}`", quantity.name());
    }
}
