//! Homing on machines of any geometry: the axis ends on the edge or index pulse that the method stands for, or the
//! homing fails as the manual says, exactly when it cannot succeed.
//!
//! What a method stands for is said by `oracle.rs` without any steps. How it gets there, and how fast, is said by `print.rs` in the words of
//! the manuals, and held against what a master reads by `speeds.rs`. What cannot succeed: methods 3 to 6 and 19 to 22
//! with the axis on the wrong side of a home switch that does not reach to the end of travel; any method whose edge
//! of the home switch lies beyond the end of travel; an index pulse that lies at a limit or beyond. Room for ramps is
//! no condition: a hard stop does as well.

mod broken_off;
mod course;
mod oracle;
mod print;
mod scene;
mod speeds;

use drivemu::motion::Machine;
use oracle::{End, Hcfa, cia402, hard_stop, hcfa};
use proptest::prelude::*;
use scene::{Scene, hcfa_x, play, scenes, yako};

const CLOSED: &[i64] = &[
    1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 17, 18, 19, 20, 21, 22, 23, 24, 25, 26, 27, 28,
    29, 30, 33, 34, 35,
];
const OPEN: &[i64] = &[17, 18, 19, 20, 21, 22, 23, 24, 25, 26, 27, 28, 29, 30, 35];

fn config(cases: u32) -> ProptestConfig {
    ProptestConfig { cases, failure_persistence: None, ..ProptestConfig::default() }
}

proptest! {
    #![proptest_config(config(384))]

    #[test]
    fn yako_methods_end_as_in_cia_402(
        (model, method) in prop_oneof![
            prop::sample::select(CLOSED).prop_map(|it| ("yako-closed-loop", it)),
            prop::sample::select(OPEN).prop_map(|it| ("yako-open-loop", it)),
        ],
        scene in scenes(),
    ) {
        let end = play(&yako(model, method, &scene), &scene, &[]).end;
        prop_assert_eq!(end, cia402(method, &scene), "method {}", method);
    }

    /// With a limit switch before the hard stop the homing is over there.
    #[test]
    fn yako_collisions_end_at_the_hard_stop(
        method in -4..=-1i64, turned: bool, limits: bool, scene in scenes().prop_map(Scene::with_stops),
    ) {
        let scene = if limits { scene } else { scene.without_limits() };
        let mut setting = yako("yako-closed-loop", method, &scene);
        setting.options = if turned { &[("collision_sign", "minus_one_positive")] } else { &[] };
        let end = play(&setting, &scene, &[]).end;
        prop_assert_eq!(end, hard_stop(method, turned, &scene));
    }

    #[test]
    fn hcfa_modes_end_as_chapter_7_says(
        mode in 0..=8i64, rule in 0..=5i64, source in 0..=2i64, scene in scenes(),
    ) {
        let scene = if source == 0 { scene } else { scene.with_stops() };
        let how = Hcfa { mode, rule, source };
        let end = play(&hcfa_x(how, &scene), &scene, &[]).end;
        match hcfa(how, &scene) {
            // Which one depends on how far the axis slowed down beyond the limit.
            End::NextTo { limit, within, sure } => match end {
                End::Origin(at) => {
                    prop_assert!(scene.is_mark(at) && (at - limit).abs() <= within, "{at} {limit}");
                }
                other => prop_assert!(!sure && other == End::Late, "{other:?}"),
            },
            want => prop_assert_eq!(end, want, "{:?}", how),
        }
    }

    #[test]
    fn k_series_backs_off_its_switch(scene in scenes()) {
        let end = play(&scene::k_series(&scene), &scene, &[]).end;
        prop_assert_eq!(end, cia402(19, &scene));
    }

    /// Whoever looks more often sees the same homing, bit for bit.
    #[test]
    fn slices_of_time_home_no_differently(
        method in prop::sample::select(CLOSED), mode in 0..=8i64, rule in 0..=5i64, source in 0..=2i64, scene in scenes(),
        slices in prop::collection::vec(1..3_000_000u64, 1..60),
    ) {
        let settings = [yako("yako-closed-loop", method, &scene), hcfa_x(Hcfa { mode, rule, source }, &scene)];
        for setting in settings {
            prop_assert_eq!(play(&setting, &scene, &[]), play(&setting, &scene, &slices));
        }
    }
}

/// The properties would hold for drives that always fail, or never do: here are both, and each of them often enough.
#[test]
fn there_is_something_to_find_and_something_to_miss() {
    let scene = Scene {
        machine: Machine {
            home: Some(drivemu::motion::Zone { from: 5000, to: 6000 }),
            negative_limit: Some(0),
            positive_limit: Some(20_000),
            hard_stop: Some([-500, 20_500]),
            index: Some(drivemu::motion::Index { every: 700, offset: 0 }),
        },
        start: 1000,
        fast: 60,
        slow: 30,
        ramp_ms: 100,
        closed: 0,
        stops: [-500, 20_500],
    };
    let ends = CLOSED.iter().map(|method| cia402(*method, &scene));
    let misses: Vec<i64> =
        CLOSED.iter().copied().filter(|it| cia402(*it, &scene) == End::Limit).collect();
    assert_eq!(misses, [5, 6, 21, 22]);
    assert_eq!(ends.filter(|it| matches!(it, End::Origin(_))).count(), CLOSED.len() - 4);
    assert_eq!(cia402(24, &scene), End::Origin(5000));
    assert_eq!(cia402(8, &scene), End::Origin(5600));
}
