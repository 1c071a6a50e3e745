//! Every number that a drive computes, in the row of the made-up drive that shows it.

use super::{FIRST, acme, by_bit, raise, row_showing, running, segment, underway};
use drivemu::bench::DeviceSpec;
use drivemu::bus::{Command, DriveOrder};
use drivemu::event::DeviceFault;
use drivemu::model::Shows;
use drivemu::testkit::Rig;
use drivemu::vocabulary::{AlarmCause, Input, Named, Quantity};

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
            Quantity::BusVoltage => {
                let row = row_showing(&rig, &Shows::Quantity(quantity));
                let mut seen = vec![rig.drive().show(row)];
                for cause in [AlarmCause::UnderVoltage, AlarmCause::OverVoltage] {
                    hold_cause(&mut rig, cause, true);
                    seen.push(rig.drive().show(row));
                    hold_cause(&mut rig, cause, false);
                }
                seen.push(rig.drive().show(row));
                assert_eq!(seen, [480, 300, 905, 480], "in tenths");
                assert_eq!(rig.drive().quantity(quantity), 48);
                continue;
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

/// Has a cause stand, or go.
fn hold_cause(rig: &mut Rig, cause: AlarmCause, on: bool) {
    let device_fault = DeviceFault::Cause(cause);
    rig.command(Command::Drive(FIRST, DriveOrder::DeviceFault { device_fault, on }))
        .expect("an alarm of the model");
}
