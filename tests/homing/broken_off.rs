//! A homing that something breaks off: what the axis does, and what is left of the homing, for every alarm and every other cause.

use super::oracle::Hcfa;
use super::scene::{Scene, Setting, hcfa_x, k_series, yako};
use drivemu::bus::{Command, DriveOrder};
use drivemu::event::{DriveEvent, DriveId, EventKind};
use drivemu::motion::{Machine, Zone};
use drivemu::testkit::Rig;
use drivemu::vocabulary::{AlarmCause, HomeEnd, Output, Quantity};
use std::time::Duration;

const DRIVE: DriveId = DriveId(0);

/// A home switch that is far away.
fn settings() -> Vec<Setting> {
    let scene = Scene {
        machine: Machine {
            home: Some(Zone { from: 9_000_000, to: 9_100_000 }),
            ..Machine::default()
        },
        start: 0,
        fast: 600,
        slow: 60,
        ramp_ms: 500,
        closed: 0,
        stops: [0, 0],
    };
    let mut k = k_series(&scene);
    k.spec.set.insert("quick_deceleration".into(), 60);
    let hcfa = hcfa_x(Hcfa { mode: 2, rule: 5, source: 0 }, &scene);
    vec![hcfa, k, yako("yako-closed-loop", 24, &scene), yako("yako-open-loop", 24, &scene)]
}

fn homing(setting: &Setting) -> Rig {
    let mut rig = setting.begin();
    rig.advance(Duration::from_secs(1));
    assert!(rig.drive().output(Output::Moving) && setting.read_speed(&mut rig) == 600);
    rig
}

/// Alarms that a manual has stop the axis, or after which it is assumed to; all others switch the power off at once.
fn brakes(model: &str, cause: AlarmCause) -> bool {
    match model {
        "hcfa-x" => matches!(
            cause,
            AlarmCause::HomingLimitPos | AlarmCause::HomingLimitNeg | AlarmCause::HomingTime
        ),
        "k-series" => cause == AlarmCause::CommTimeout,
        _ => false,
    }
}

fn lost(rig: &Rig) -> Option<HomeEnd> {
    rig.events().iter().rev().find_map(|event| match event.kind {
        EventKind::Drive { event: DriveEvent::HomingAborted { why, .. }, .. } => Some(why),
        _ => None,
    })
}

/// No origin, and the position goes on from what it said.
fn is_over(rig: &mut Rig, setting: &Setting, why: HomeEnd, before: i64) {
    rig.advance(Duration::from_secs(2));
    let text = rig.log();
    assert_eq!(lost(rig), Some(why), "{text}");
    let [moving, done] = [Output::Moving, Output::HomeDone].map(|it| rig.drive().output(it));
    assert!(!moving && !done, "{text}");
    assert!(rig.drive().quantity(Quantity::PositionActual) >= before, "{text}");
    assert_eq!(setting.read_speed(rig), 0, "{text}");
    if setting.model == "hcfa-x" {
        assert_eq!(rig.ask("01 03 140C 0001"), "01 03 02 00 00", "{text}");
    }
}

#[test]
fn every_alarm_stops_a_homing_as_it_is_said_to() {
    for setting in settings() {
        let model = setting.model;
        let alarms = homing(&setting).drive().model().wiring.alarms.clone();
        assert!(alarms.len() >= 3, "{model}");
        for alarm in alarms {
            let mut rig = homing(&setting);
            let before = rig.drive().quantity(Quantity::PositionActual);
            rig.command(Command::Drive(DRIVE, DriveOrder::Raise(alarm.cause)))
                .expect("it has power");
            let brakes = brakes(model, alarm.cause);
            let told = format!("{model} {:?}\n{}", alarm.cause, rig.log());
            let [alarms, enabled, moving] =
                [Output::Alarm, Output::Enabled, Output::Moving].map(|it| rig.drive().output(it));
            assert_eq!((alarms, enabled, moving), (true, brakes, true), "{told}");
            // Without power it takes 200 ms from whatever speed; the slopes are a second on K, half a second on HCFA.
            rig.advance(Duration::from_millis(199));
            let left = setting.read_speed(&mut rig);
            assert!(if brakes { left > 300 } else { (0..=5).contains(&left) }, "{left} {told}");
            rig.advance(Duration::from_millis(1));
            assert_eq!(rig.drive().output(Output::Moving), brakes, "{told}");
            is_over(&mut rig, &setting, HomeEnd::Alarm, before);
            assert!(!rig.drive().output(Output::Enabled), "{told}");
        }
    }
}

#[test]
fn power_that_goes_leaves_no_origin() {
    for setting in settings() {
        let mut rig = homing(&setting);
        for on in [false, true] {
            rig.command(Command::Drive(DRIVE, DriveOrder::Power(on))).expect("the other way round");
        }
        rig.advance(Duration::from_secs(2));
        let outputs = [Output::Moving, Output::HomeDone, Output::InPosition];
        assert!(outputs.iter().all(|it| !rig.drive().output(*it)), "{}", rig.log());
    }
}
