//! Each phase of each method at the speed that its manual prints: what a master reads in the middle of every ramp and every
//! stretch between them, against `course.rs`.

use super::course::{Course, Leg, Speeds};
use super::oracle::Hcfa;
use super::print::{self, Phase, Sentences};
use super::scene::{Scene, Setting, hcfa_x, k_series, scenes, yako};
use super::{CLOSED, OPEN, config};
use drivemu::event::{DriveEvent, EventKind};
use drivemu::time::Instant;
use drivemu::vocabulary::Quantity;
use proptest::prelude::*;

/// Parts of the way through a ramp or a stretch at which a master looks.
const PARTS: [f64; 3] = [0.1, 0.5, 0.9];

/// Shorter ones than this, in seconds, are over before anybody can say how fast they were.
const SHORT: f64 = 1e-4;

proptest! {
    #![proptest_config(config(256))]

    #[test]
    fn yako_phases_have_their_speeds(
        (model, method) in prop_oneof![
            prop::sample::select(CLOSED).prop_map(|it| ("yako-closed-loop", it)),
            prop::sample::select(OPEN).prop_map(|it| ("yako-open-loop", it)),
        ],
        scene in scenes().prop_map(Scene::without_stops),
    ) {
        hold(&yako(model, method, &scene), &print::yako(method), 1000.0, &scene)?;
    }

    #[test]
    fn yako_collisions_have_their_speeds(
        method in -4..=-1i64, scene in scenes().prop_map(|it| it.with_stops().without_limits()),
    ) {
        hold(&yako("yako-closed-loop", method, &scene), &print::yako(method), 1000.0, &scene)?;
    }

    #[test]
    fn hcfa_phases_have_their_speeds(
        mode in 0..=8i64, rule in 0..=5i64, scene in scenes().prop_map(Scene::without_stops),
    ) {
        let how = Hcfa { mode, rule, source: 0 };
        hold(&hcfa_x(how, &scene), &print::hcfa(mode, rule), 10_000.0, &scene)?;
    }

    #[test]
    fn k_series_phases_have_their_speeds(scene in scenes().prop_map(Scene::without_stops)) {
        hold(&k_series(&scene), &print::k_series(), 10_000.0, &scene)?;
    }
}

/// The phases that the axis goes through to their end, each stretch of them at the speed that is printed.
fn hold(
    setting: &Setting,
    all: &Sentences,
    counts_per_rev: f64,
    scene: &Scene,
) -> Result<Vec<Phase>, TestCaseError> {
    let per_s = |rpm: i64| rpm as f64 * counts_per_rev / 60.0;
    let high = per_s(scene.fast);
    let slope = match setting.model {
        "k-series" => per_s(scene.acceleration() * 10),
        _ => high * 1000.0 / scene.ramp_ms as f64,
    };
    let speeds = Speeds { high, low: per_s(scene.slow), slope, collision: 200.0 };
    let course = Course::new(all, speeds, scene);
    let mut rig = setting.begin();
    let begun = rig.events().iter().find_map(|event| match event.kind {
        EventKind::Drive { event: DriveEvent::HomingStarted { .. }, .. } => Some(event.at),
        _ => None,
    });
    let begun = begun.expect("it homes").as_secs_f64();
    let looks = |leg: &Leg| PARTS.map(|part| (leg.from + part * leg.seconds, leg.at(part)));
    for (seconds, (position, speed)) in
        course.legs.iter().filter(|leg| leg.seconds > SHORT).flat_map(looks)
    {
        let at = Instant::from_nanos(((begun + seconds) * 1e9).round() as u64);
        let now = rig.now();
        rig.advance(if at > now { at.since(now) } else { Default::default() });
        let is = rig.drive().quantity(Quantity::PositionActual);
        let reads = setting.read_speed(&mut rig);
        let want = speed * 60.0 / counts_per_rev;
        let (off, apart) = ((reads as f64 - want).abs(), (is as f64 - position.floor()).abs());
        prop_assert!(
            off <= 0.51 && apart <= 1.0,
            "after {seconds:.6} s: {reads} rpm at {is}, not {want:.2} at {position:.2}\n{}",
            rig.log()
        );
    }
    Ok(course.done)
}

/// The properties would hold for a course that ends at once: on a roomy machine, from anywhere, every printed phase is gone through.
#[test]
fn each_printed_phase_is_gone_through() {
    use drivemu::motion::{Index, Machine, Zone};
    let scene = |start, home: [i64; 2]| Scene {
        machine: Machine {
            home: Some(Zone { from: home[0], to: home[1] }),
            negative_limit: Some(0),
            positive_limit: Some(90_000),
            hard_stop: None,
            index: Some(Index { every: 700, offset: 50 }),
        },
        start,
        fast: 600,
        slow: 60,
        ramp_ms: 100,
        closed: 0,
        stops: [-5000, 95_000],
    };
    let scenes: Vec<Scene> = [-100, 1000, 45_000, 89_000, 90_500]
        .into_iter()
        .map(|start| scene(start, [40_000, 50_000]))
        .chain([scene(45_000, [40_000, 10_000_000]), scene(45_000, [-10_000_000, 50_000])])
        .collect();
    let mut missing = Vec::new();
    let mut go = |name: String, all: &Sentences, rev, setting: &dyn Fn(&Scene) -> Setting| {
        let held = |scene| hold(&setting(scene), all, rev, scene).expect("the printed speeds");
        let done: Vec<Phase> = scenes.iter().flat_map(held).collect();
        let printed = [&all.idle, &all.at_limit, &all.active].into_iter().flatten();
        missing.extend(printed.filter(|it| !done.contains(it)).map(|it| format!("{name}: {it:?}")));
    };
    for &method in CLOSED {
        let all = print::yako(method);
        go(format!("method {method}"), &all, 1000.0, &|it| yako("yako-closed-loop", method, it));
    }
    for (mode, rule) in (0..=8).flat_map(|mode| (0..=5).map(move |rule| (mode, rule))) {
        let how = Hcfa { mode, rule, source: 0 };
        go(format!("mode {mode}"), &print::hcfa(mode, rule), 10_000.0, &|it| hcfa_x(how, it));
    }
    go("search".into(), &print::k_series(), 10_000.0, &k_series);
    assert!(missing.is_empty(), "{}", missing.join("\n"));
}
