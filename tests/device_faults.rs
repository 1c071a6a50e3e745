//! What goes wrong with devices, apart from their lines: how the log tells it to programs, and what it can't be done to.
//! What a master notices stands in tests/transcripts/yako/device-fault-*.txt.

use crate::kit::rig;
use drivemu::bench::DeviceSpec;
use drivemu::bus::{Command, CommandError, DriveOrder, LineCommand};
use drivemu::event::{DeviceFault, DriveId, Outcome, Remark};
use drivemu::testkit::Rig;
use drivemu::vocabulary::AlarmCause;
use std::time::Duration;

const FIRST: DriveId = DriveId(0);

fn drive(model: &str) -> Rig {
    rig(model, &[], &DeviceSpec::default())
}

#[cfg(feature = "cli")]
#[test]
fn each_device_fault_as_json() {
    use crate::kit::object;
    use serde_json::{Value, json};
    let all = [
        DeviceFault::Cause(AlarmCause::OverVoltage),
        DeviceFault::Blocked,
        DeviceFault::EncoderLost,
        DeviceFault::Frozen,
        DeviceFault::Stuck(1),
    ];
    for device_fault in all {
        let want = match device_fault {
            DeviceFault::Cause(cause) => {
                json!({"device_fault": "cause", "cause": format!("{cause:?}")})
            }
            DeviceFault::Blocked => json!({"device_fault": "blocked"}),
            DeviceFault::EncoderLost => json!({"device_fault": "encoder_lost"}),
            DeviceFault::Frozen => json!({"device_fault": "frozen"}),
            DeviceFault::Stuck(_) => json!({"device_fault": "stuck", "terminal": "X1"}),
        };
        let mut rig = drive("yako-closed-loop");
        for on in [true, false] {
            rig.command(Command::Drive(FIRST, DriveOrder::DeviceFault { device_fault, on }))
                .expect("it can be");
        }
        let told = rig.events().iter().map(object);
        let told: Vec<Value> = told.filter(|it| it["event"] == "device_fault").collect();
        let [begins, ends] = told.as_slice() else { panic!("{told:?}") };
        assert_eq!((&begins["on"], &ends["on"]), (&json!(true), &json!(false)));
        assert_eq!(begins["device_fault"], want["device_fault"]);
        assert_eq!(begins.get("terminal"), want.get("terminal"));
        assert_eq!(begins.get("cause").is_some(), want.get("cause").is_some());
    }
    let mut rig = drive("yako-closed-loop");
    let every = Duration::from_millis(5);
    rig.command(Command::Drive(FIRST, DriveOrder::Bounce { index: 2, times: 3, every }))
        .expect("a terminal");
    rig.command(Command::Drive(FIRST, DriveOrder::Power(false))).expect("it has power");
    let told = rig.events().iter().map(object);
    let told: Vec<Value> = told.collect();
    let bounces = told.iter().find(|it| it["event"] == "bouncing").expect("told");
    assert_eq!(
        (&bounces["terminal"], &bounces["times"], &bounces["every_ms"]),
        (&json!("X2"), &json!(3), &json!(5.0))
    );
    assert_eq!(told.last().expect("told")["event"], "servo");
    assert!(told.iter().any(|it| it["event"] == "power_off"), "{told:?}");
}

#[test]
fn stations_of_a_device_share_their_power() {
    let mut rig = drive("k-series");
    let units: Vec<u8> = rig.bus().drives().map(|(_, drive)| drive.unit()).collect();
    assert_eq!(units.len(), 2);
    rig.command(Command::Drive(DriveId(1), DriveOrder::Power(false))).expect("it has power");
    assert!(units.iter().all(|unit| rig.bus().find(*unit).is_none()));
    rig.command(Command::Drive(FIRST, DriveOrder::Power(true))).expect("it had power");
    assert!(units.iter().all(|unit| rig.bus().find(*unit).is_some()));
}

#[test]
fn what_can_not_be() {
    let mut rig = drive("yako-closed-loop");
    let cause = AlarmCause::CommTimeout;
    let no_alarm = Err(CommandError::NoAlarm("comm_timeout"));
    let hold = Command::Drive(
        FIRST,
        DriveOrder::DeviceFault { device_fault: DeviceFault::Cause(cause), on: true },
    );
    assert_eq!(rig.command(hold), no_alarm);
    let no_terminal = Err(CommandError::NoTerminal { got: 4, have: 4 });
    let stick = Command::Drive(
        FIRST,
        DriveOrder::DeviceFault { device_fault: DeviceFault::Stuck(4), on: true },
    );
    assert_eq!(rig.command(stick), no_terminal);
    let every = Duration::from_millis(1);
    assert_eq!(
        rig.command(Command::Drive(FIRST, DriveOrder::Bounce { index: 4, times: 1, every })),
        no_terminal
    );
    let bounce =
        |times, every| Command::Drive(FIRST, DriveOrder::Bounce { index: 0, times, every });
    let beyond = [(0, every), (3, Duration::ZERO), (3, Duration::from_nanos(999))];
    for (times, every) in beyond.into_iter().chain([(3, Duration::from_secs(61))]) {
        assert_eq!(rig.command(bounce(times, every)), Err(CommandError::NoBounce), "{every:?}");
    }
    rig.command(Command::Drive(FIRST, DriveOrder::Power(false))).expect("it has power");
    let raise = Command::Drive(FIRST, DriveOrder::Raise(AlarmCause::OverVoltage));
    assert_eq!(rig.command(raise), Err(CommandError::NoPower));
}

/// Names that come from a program instead of a file may hold anything; an event is one line all the same.
#[test]
fn an_event_is_one_line() {
    let mut rig = drive("yako-closed-loop");
    let step = "trip\n0.000 unit 1 ready\u{1b}[2J\u{202e}".to_owned();
    let what = "a\rb\u{85}".to_owned();
    rig.command(LineCommand::Tell(Remark { step, outcome: Outcome::Failed, what })).expect("told");
    let log = rig.log();
    let last = log.lines().last().expect("a line");
    let want = "step trip\\n0.000 unit 1 ready\\u{1b}[2J\\u{202e} failed: a\\rb\\u{85}";
    assert!(last.ends_with(want), "{log}");
}

/// Freed, a move makes up for what it is behind and still ends where it was to end; an axis without a position
/// control has lost its steps.
#[test]
fn a_move_goes_on_when_it_is_free() {
    for (model, end) in [("yako-closed-loop", 10_000), ("yako-open-loop", 9_200)] {
        let mut rig = drive(model);
        rig.ask("01 10 0020 0006 0C 0000 0000 0000 003C 0000 2710");
        rig.ask("01 06 0027 0001");
        rig.advance(Duration::from_secs(2));
        let block = |on| {
            Command::Drive(
                FIRST,
                DriveOrder::DeviceFault { device_fault: DeviceFault::Blocked, on },
            )
        };
        rig.command(block(true)).expect("it can be");
        rig.advance(Duration::from_millis(800));
        rig.command(block(false)).expect("it can be");
        rig.advance(Duration::from_secs(20));
        let position = rig.drive().quantity(drivemu::vocabulary::Quantity::PositionActual);
        assert!((position - end).abs() <= 1, "{model}: {position}\n{}", rig.log());
    }
}

/// On Modbus TCP unit 255 is whoever is there; without power nobody is.
#[test]
fn a_drive_without_power_is_not_there_on_tcp_either() {
    use crate::kit::drain;
    use drivemu::line::Framing;
    use drivemu::wire::mbap;
    let mut bus = drive("yako-closed-loop").fresh_bus();
    let link = bus.open(Framing::Mbap);
    for (on, answers) in [(true, true), (false, false), (true, true)] {
        bus.command(bus.now(), Command::Drive(FIRST, DriveOrder::Power(on))).expect("it can be");
        drain(&mut bus);
        bus.receive(bus.now(), link, &mbap::encode(1, 0xFF, &[3, 0, 6, 0, 1]));
        assert_eq!(!drain(&mut bus).sent.is_empty(), answers, "power {on}");
    }
}
