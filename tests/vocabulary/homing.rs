//! What homings and limits go by: every word that a row can choose makes a difference, and the log tells of it.

use super::{acme, by_bit, give};
use drivemu::bench::DeviceSpec;
use drivemu::model::{Choice, Coded, HomingRules};
use drivemu::motion::{Index, Machine, Zone};
use drivemu::testkit::Rig;
use drivemu::vocabulary::{Action, Input, Named, Output, Quantity};
use std::fmt::Debug;
use std::time::Duration;

/// With a home switch on terminal I1; the negative limit is wired by itself.
const MACHINE: Machine = Machine {
    home: Some(Zone { from: 150_000, to: 160_000 }),
    negative_limit: Some(-180_000),
    positive_limit: None,
    hard_stop: Some([-200_000, 200_000]),
    index: Some(Index { every: 7000, offset: 0 }),
};
const ORDINARY: [(&str, i64); 7] = [
    ("T101", 13),
    ("P002", 600),
    ("P011", 300),
    ("P031", 600),
    ("P034", 1000),
    ("P036", 70),
    ("P039", 400),
];

#[test]
fn each_rule_of_a_homing_counts() {
    let rig = drive(0, None);
    let homing = rig.drive().model().wiring.homing.as_ref().expect("it homes");
    let HomingRules { starter, limit, source, index, finish, .. } = homing;
    each_counts(
        starter.as_ref().expect("a row"),
        |it| *it,
        |row| {
            let mut rig = drive(0, Some(row));
            let starts: [fn(&mut Rig); 3] = [
                |rig| give(rig, Action::Enable),
                |rig| by_bit(rig, Input::HomeStart, true),
                |rig| give(rig, Action::HomeStart),
            ];
            let started = starts.map(|start| {
                start(&mut rig);
                let moves = rig.drive().output(Output::Moving);
                give(&mut rig, Action::QuickStop);
                moves.into()
            });
            started.into()
        },
    );
    each_counts(chosen(limit), |it| *it, |row| home(drive(170_000, Some(row)), true));
    each_counts(
        chosen(source),
        |it| *it,
        |row| [false, true].map(|limit| home(drive(170_000, Some(row.clone())), limit)).concat(),
    );
    each_counts(chosen(index), |it| *it, |row| home(drive(0, Some(row)), false));
    each_counts(chosen(finish), |it| it.position, |row| home(drive(0, Some(row)), false));
}

#[test]
fn each_rule_of_limits_counts() {
    let rig = drive(0, None);
    let limits = &rig.drive().model().wiring.limits;
    each_counts(
        chosen(&limits.stop),
        |it| *it,
        |row| {
            let mut rig = run(drive(0, Some(row)));
            by_bit(&mut rig, Input::LimitPos, true);
            trace(&mut rig)
        },
    );
    each_counts(
        chosen(&limits.soft),
        |it| *it,
        |row| {
            let near = [row, ("P044".to_owned(), 5_000)];
            let fresh = trace(&mut run(drive_with(140_000, &near)));
            let mut homed = drive_with(140_000, &near);
            give(&mut homed, Action::Enable);
            give(&mut homed, Action::HomeStart);
            homed.advance(Duration::from_secs(30));
            assert!(homed.drive().output(Output::HomeDone), "{}", homed.log());
            [fresh, trace(&mut run(homed))].concat()
        },
    );
}

/// What a program reads in the log of a homing, and that people read the same.
#[cfg(feature = "cli")]
#[test]
fn the_log_tells_of_homings() {
    let set = [("P039", 100), ("P040", 0x3120), ("P048", 65_535)];
    let mut rig = drive_with(170_000, &set.map(|(row, value)| (row.to_owned(), value)));
    give(&mut rig, Action::Enable);
    for _ in 0..2 {
        give(&mut rig, Action::HomeStart);
        rig.advance(Duration::from_secs(20));
        by_bit(&mut rig, Input::LimitPos, true);
    }
    let fields = [
        "event", "method", "rpm", "until", "positive", "reverses", "at", "then", "position", "why",
        "text",
    ];
    let told = rig.events().iter().map(|event| {
        let object = crate::kit::object(event);
        let field = |name: &&str| object.get(*name).map(|value| value.to_string().replace('"', ""));
        fields.iter().filter_map(field).collect::<Vec<_>>().join(" | ")
    });
    let told: Vec<String> = told.filter(|it| it.starts_with("hom")).collect();
    let want = [
        "homing_started | 0 | unit 5 homing method 0 started",
        "homing_moving | 0 | 600.0 | home_switch on | unit 5 homing method 0: moving at 600 rpm until home_switch on",
        "homing_limit | 0 | true | true | 30005 | unit 5 homing method 0: positive limit at 30005, reversing",
        "homing_moving | 0 | -600.0 | home_switch on | unit 5 homing method 0: moving at -600 rpm until home_switch on",
        "homing_found | 0 | home_switch on | -9996 | keep | unit 5 homing method 0: home_switch on at -9996, continuing",
        "homing_moving | 0 | -30.0 | home_switch off | unit 5 homing method 0: moving at -30 rpm until home_switch off",
        "homing_found | 0 | home_switch off | -19996 | origin | unit 5 homing method 0: home_switch off at -19996, taken as origin",
        "homing_index | 0 | false | unit 5 homing method 0: moving backward to the next index pulse",
        "homing_origin | 0 | -22995 | unit 5 homing method 0: origin at -22995",
        "homing_complete | 0 | 70 | unit 5 homing method 0 complete, position 70",
        "homing_started | 0 | unit 5 homing method 0 started",
        "homing_moving | 0 | 600.0 | home_switch on | unit 5 homing method 0: moving at 600 rpm until home_switch on",
        "homing_limit | 0 | true | true | 70 | unit 5 homing method 0: positive limit at 70, reversing",
        "homing_moving | 0 | -600.0 | home_switch on | unit 5 homing method 0: moving at -600 rpm until home_switch on",
        "homing_limit | 0 | false | false | -326931 | unit 5 homing method 0: negative limit at -326931, waiting for the time limit",
        "homing_aborted | 0 | time_limit | unit 5 homing method 0 aborted: time limit exceeded",
    ];
    assert_eq!(told, want);
}

/// Does no word come to the same as another? `come_to` gets a row and a value that stands for the word.
fn each_counts<T, W: Named + PartialEq + Debug>(
    coded: &Coded<T>,
    word: impl Fn(&T) -> W,
    come_to: impl Fn((String, i64)) -> Vec<i64>,
) {
    let rig = drive(0, None);
    let model = rig.drive().model();
    let ordinary = rig.drive().bank().value(model, coded.row);
    let shift = 4 * coded.digit.unwrap_or(0);
    let mut seen: Vec<(W, Vec<i64>)> = Vec::new();
    for &wanted in W::ALL {
        let code = coded.codes.iter().find(|(_, it)| word(it) == wanted);
        let (code, _) = code.unwrap_or_else(|| panic!("nothing stands for `{}`", wanted.name()));
        let value = ordinary & !(0xF << shift) | code << shift;
        let came = come_to((model.map.row(coded.row).id.clone(), value));
        let same = seen.iter().find(|(_, it)| *it == came);
        assert!(same.is_none(), "{wanted:?} comes to the same as {:?}", same.map(|it| it.0));
        seen.push((wanted, came));
    }
}

fn chosen<T>(choice: &Option<Choice<T>>) -> &Coded<T> {
    match choice {
        Some(Choice::Row(coded)) => coded,
        _ => panic!("no row chooses"),
    }
}

fn drive(start: i64, row: Option<(String, i64)>) -> Rig {
    drive_with(start, row.as_slice())
}

fn drive_with(start: i64, rows: &[(String, i64)]) -> Rig {
    let ordinary = ORDINARY.iter().map(|(row, value)| ((*row).to_owned(), *value));
    let set = ordinary.chain(rows.iter().cloned()).collect();
    acme(&DeviceSpec { set, start, position: 5, machine: MACHINE, ..DeviceSpec::default() })
}

fn run(mut rig: Rig) -> Rig {
    give(&mut rig, Action::Enable);
    give(&mut rig, Action::RunStart);
    rig.advance(Duration::from_millis(300));
    rig
}

/// Homes, with the positive limit active or not.
fn home(mut rig: Rig, limit: bool) -> Vec<i64> {
    by_bit(&mut rig, Input::LimitPos, limit);
    give(&mut rig, Action::Enable);
    give(&mut rig, Action::HomeStart);
    trace(&mut rig)
}

/// Where the axis is from now on, and whether there is an alarm.
fn trace(rig: &mut Rig) -> Vec<i64> {
    let mut places = Vec::new();
    for _ in 0..600 {
        rig.advance(Duration::from_millis(50));
        places.push(rig.drive().quantity(Quantity::PositionActual));
        places.push(rig.drive().output(Output::Alarm).into());
    }
    places
}
