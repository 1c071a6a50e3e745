//! Functions that are not simulated: said when they are asked for first, and no more until power comes on again.

use drivemu::bus::{Command, DriveOrder};
use drivemu::event::DriveId;
use drivemu::testkit::Rig;
use std::time::Duration;

#[test]
fn what_is_not_simulated_is_said_once() {
    let mut rig = Rig::builtin("hcfa-x").expect("embedded");
    let said = |rig: &Rig| rig.log().matches("DI 16 P_CL: not simulated").count();
    for times in 1..=2 {
        // DI2 is the forward torque limit; the value is kept.
        rig.ask("01 06 E4 02 00 10");
        for signal in [true, false, true, false] {
            let terminal = Command::Drive(DriveId(0), DriveOrder::Terminal { index: 1, signal });
            rig.command(terminal).expect("a terminal");
            rig.advance(Duration::from_millis(100));
            assert_eq!(said(&rig), times, "{}", rig.log());
        }
        rig.command(Command::Drive(DriveId(0), DriveOrder::PowerCycle)).expect("a drive");
    }
}
