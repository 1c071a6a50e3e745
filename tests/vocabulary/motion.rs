//! What motions go by: every setting and every modifier changes where the axis is, and when.

use super::{acme, give, give_with};
use drivemu::bench::DeviceSpec;
use drivemu::model::Row;
use drivemu::motion::{Machine, Zone};
use drivemu::testkit::Rig;
use drivemu::vocabulary::{Action, AlarmCause, Input, Modifier, Named, Output, Quantity, Setting};
use std::time::Duration;

#[test]
fn each_setting_counts() {
    for &setting in Setting::ALL {
        let (ordinary, row) = trace(setting, None);
        let (changed, _) = trace(setting, Some(row));
        assert!(ordinary != changed, "`{}` changes nothing", setting.name());
    }
}

#[test]
fn each_modifier_counts() {
    let spec = DeviceSpec { position: 5, ..DeviceSpec::default() };
    for &modifier in Modifier::ALL {
        let ends = [&[][..], &[modifier]].map(|modifiers| {
            let mut rig = acme(&spec);
            give(&mut rig, Action::Enable);
            give(&mut rig, Action::MoveStart);
            let wait = match modifier {
                Modifier::Absolute => 2000,
                Modifier::Interrupt => 200,
            };
            rig.advance(Duration::from_millis(wait));
            give_with(&mut rig, Action::MoveStart, modifiers);
            rig.advance(Duration::from_secs(5));
            assert!(rig.drive().output(Output::InPosition), "{}", rig.log());
            rig.drive().quantity(Quantity::PositionActual)
        });
        match modifier {
            Modifier::Absolute => assert_eq!(ends, [400_005, 200_000]),
            Modifier::Interrupt => assert!(ends[0] == 200_005 && ends[1] > 200_005, "{ends:?}"),
        }
    }
}

/// Where the axis is, every ten milliseconds, while it does what `setting` is about and then stops; and the
/// row with the setting. With `changed`, that row holds more.
fn trace(setting: Setting, changed: Option<(String, i64)>) -> (Vec<i64>, (String, i64)) {
    let machine = if is_free(setting) { Machine::default() } else { MACHINE };
    let mut spec = DeviceSpec { machine, position: 5, ..DeviceSpec::default() };
    spec.set = ordinary(setting).iter().map(|(row, value)| ((*row).into(), *value)).collect();
    spec.set.extend(changed);
    let mut rig = acme(&spec);
    let model = rig.drive().model().clone();
    let id = model.wiring.axis.setting(setting).expect("every setting is wired");
    let row: &Row = model.map.row(id);
    let most = row.spans.last().expect("a range").1;
    let more = (row.id.clone(), (rig.drive().bank().value(&model, id) * 2 + 7).min(most));
    give(&mut rig, Action::Enable);
    let mut places = Vec::new();
    match setting.name().split('.').next() {
        Some("run") => give(&mut rig, Action::RunStart),
        Some("move") if setting == Setting::MoveAbsolute => {
            super::by_bit(&mut rig, Input::MoveStart, true);
        }
        Some("inch") => super::by_bit(&mut rig, Input::InchPos, true),
        Some("move") => give(&mut rig, Action::MoveStart),
        Some("home") => give(&mut rig, Action::HomeStart),
        Some("limit") => give(&mut rig, Action::RunStart),
        _ => jog(&mut rig, true),
    }
    look(&mut rig, &mut places, 200);
    if setting == Setting::AlarmDecel {
        super::raise(&mut rig, AlarmCause::CommTimeout);
    }
    jog(&mut rig, false);
    super::by_bit(&mut rig, Input::InchPos, false);
    if setting.name().starts_with("run") {
        give(&mut rig, Action::Stop);
    }
    look(&mut rig, &mut places, 500);
    (places, more)
}

fn jog(rig: &mut Rig, on: bool) {
    super::by_bit(rig, Input::JogPos, on);
}

fn look(rig: &mut Rig, places: &mut Vec<i64>, count: usize) {
    for _ in 0..count {
        rig.advance(Duration::from_millis(10));
        places.push(rig.drive().quantity(Quantity::PositionActual));
        places.push(rig.drive().output(Output::Alarm).into());
    }
}

const MACHINE: Machine = Machine {
    home: Some(Zone { from: 150_000, to: 160_000 }),
    hard_stop: Some([-200_000, 200_000]),
    negative_limit: None,
    positive_limit: None,
    index: None,
};

/// What makes `setting` count: a method that goes by it, a limit that is reached.
fn ordinary(setting: Setting) -> &'static [(&'static str, i64)] {
    match setting {
        Setting::HomeFast | Setting::HomeSlow | Setting::HomeAccel | Setting::HomeCoordinate => {
            &[("T101", 13)]
        }
        Setting::HomeOffset => &[("T101", 13), ("P041", 6)],
        Setting::HomeCollision => &[("P030", 1)],
        Setting::HomeTimeLimit => &[("P030", 2)],
        Setting::SoftLimitPos => &[("P042", 0x20), ("P044", 50_000)],
        Setting::SoftLimitNeg => &[("P042", 0x20), ("P046", -50_000), ("P002", -600)],
        _ => &[],
    }
}

/// Does nothing limit its motion?
fn is_free(setting: Setting) -> bool {
    !matches!(setting.name().split('.').next(), Some("home" | "limit"))
}

/// What a program reads in the log of a motion, and that people read the same.
#[cfg(feature = "cli")]
#[test]
fn the_log_tells_of_motions() {
    let mut rig = acme(&DeviceSpec::default());
    give(&mut rig, Action::RunStart);
    give(&mut rig, Action::Enable);
    let second = Duration::from_secs(1);
    for action in [Action::MoveStart, Action::QuickStop, Action::RunStart, Action::Stop] {
        give(&mut rig, action);
        rig.advance(second);
    }
    jog(&mut rig, true);
    rig.advance(second);
    give(&mut rig, Action::Release);
    rig.advance(second);
    let told = told(
        &rig,
        &["moving", "running", "jogging", "stopping", "coasting", "stopped", "no_effect"],
    );
    let want = [
        "no_effect | run_start | the servo is off | unit 5 run_start has no effect: the servo is off",
        "moving | 200000 | unit 5 moving to 200000",
        "stopped | 200000 | unit 5 stopped at 200000",
        "no_effect | quick_stop | already stopped | unit 5 quick_stop has no effect: already stopped",
        "running | 60.0 | unit 5 running at 60 rpm",
        "stopping | unit 5 stopping",
        "stopped | 331072 | unit 5 stopped at 331072",
        "jogging | 60.0 | unit 5 jogging at 60 rpm",
        "coasting | unit 5 coasting: servo off",
        // A second less half a ramp, and half of the 100 ms in which it runs out.
        "stopped | 462144 | unit 5 stopped at 462144",
    ];
    assert_eq!(told, want);
}

/// What a program reads of the events of these kinds, and that people read the same.
#[cfg(feature = "cli")]
pub(super) fn told(rig: &Rig, kinds: &[&str]) -> Vec<String> {
    let fields = ["event", "segment", "from", "to", "rpm", "at", "action", "input", "why", "text"];
    let told = rig.events().iter().map(|event| {
        let object = crate::kit::object(event);
        let field = |name: &&str| object.get(*name).map(|value| value.to_string().replace('"', ""));
        fields.iter().filter_map(field).collect::<Vec<_>>().join(" | ")
    });
    told.filter(|it| kinds.iter().any(|kind| it.starts_with(kind))).collect()
}
