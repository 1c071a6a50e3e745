//! What is drawn depends on seed, line, rule and occurrence, and on nothing else.

use super::{READ, ask, drive_of, effects};
use crate::properties::traffic::{Piece, pieces};
use drivemu::bus::WakeReason;
use drivemu::event::EventKind;
use drivemu::medium::{FaultEffect, FaultKind, Preset};
use drivemu::testkit::Rig;
use drivemu::time::Duration;
use proptest::prelude::*;

fn run(specs: &[&str], seed: u64, n: usize) -> (Rig, Vec<u8>) {
    let mut rig = drive_of("hcfa-x", specs, seed);
    let mut bytes = Vec::new();
    for _ in 0..n {
        bytes.extend(ask(&mut rig, READ));
        bytes.extend(rig.advance(Duration::from_millis(1)));
    }
    (rig, bytes)
}

/// Which rule acted, each time that one did.
fn acted(rig: &Rig, name: &str) -> Vec<(u64, FaultEffect)> {
    let told = |event: &drivemu::event::Event| match &event.kind {
        EventKind::Fault(hit) if *hit.rule == *name => Some((event.at.as_nanos(), hit.effect)),
        _ => None,
    };
    rig.events().iter().filter_map(told).collect()
}

#[test]
fn a_probability_is_kept() {
    let (n, p) = (20_000, 0.1);
    let sigma = (f64::from(n) * p * (1.0 - p)).sqrt();
    for seed in [0, 1, 7, u64::MAX] {
        let (rig, _) = run(&["lose_reply:probability=0.1"], seed, n as usize);
        let off = effects(&rig).len() as f64 - f64::from(n) * p;
        assert!(off.abs() < 3.0 * sigma, "seed {seed}: off by {off}, sigma is {sigma}");
    }
}

const BUSY: &str = "busy:name=first,probability=0.2";
const DELAY: &str = "delay:name=second,probability=0.2,ms=1-9";

/// A rule decides the same whatever stands beside it: it only loses what an earlier one takes.
#[test]
fn rules_do_not_disturb_each_other() {
    let (alone, _) = run(&[DELAY], 3, 2000);
    let (with, _) = run(&[BUSY, DELAY], 3, 2000);
    let (behind, _) = run(&[DELAY, BUSY], 3, 2000);
    let want = acted(&alone, "second");
    assert!(want.len() > 300);
    assert_eq!(acted(&behind, "second"), want);
    let taken: Vec<u64> = acted(&with, "first").iter().map(|(at, _)| *at).collect();
    let left: Vec<_> = want.iter().filter(|(at, _)| !taken.contains(at)).copied().collect();
    assert!(left.len() < want.len());
    assert_eq!(acted(&with, "second"), left);
}

#[test]
fn one_seed_one_run() {
    let specs = ["flip_bits:probability=0.1,bits=3", "noisy_cable", "delay:ms=0-3,every=5"];
    let (first, bytes) = run(&specs, 42, 2000);
    let (second, again) = run(&specs, 42, 2000);
    assert!(bytes == again && first.log() == second.log());
    let (_, other) = run(&specs, 43, 2000);
    assert!(bytes != other);
    // Two lines of a bench have fault rules of their own.
    let text = |name| {
        format!(
            "seed: 5\nlines:\n- name: {name}\n  pty: auto\n  drives: [{{model: hcfa-x}}]\n  \
             faults: [{{do: lose_reply, probability: 0.5}}]\n"
        )
    };
    let lost = |name| {
        let mut rig = Rig::bench(&text(name), &drivemu::bench::BuiltinLibrary).expect("good");
        (0..64).map(|_| ask(&mut rig, READ).is_empty()).collect::<Vec<_>>()
    };
    assert!(lost("a") == lost("a") && lost("a") != lost("b"));
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 24, failure_persistence: None, ..Default::default() })]

    /// No traffic brings it down under any faults, what is held leaves, and the seed says it all.
    #[test]
    fn any_traffic_under_any_faults(seed: u64, traffic in pieces(1..40)) {
        let spec = |kind: &FaultKind| match kind.name {
            "delay" => "delay:ms=0-40,probability=0.1".to_owned(),
            "exception" => "exception:code=4,probability=0.1".to_owned(),
            name => format!("{name}:probability=0.1"),
        };
        let presets = Preset::ALL.iter().map(|preset| preset.name.to_owned());
        let specs: Vec<_> = FaultKind::ALL.iter().map(spec).chain(presets).collect();
        let specs: Vec<&str> = specs.iter().map(String::as_str).collect();
        let run = || {
            let mut rig = drive_of("yako-closed-loop", &specs, seed);
            let mut sent = Vec::new();
            for Piece { bytes, pause } in &traffic {
                sent.extend(rig.push(bytes));
                sent.extend(rig.advance(*pause));
            }
            sent.extend(rig.advance(Duration::from_secs(60)));
            (sent, rig.log(), rig.bus().poll_at())
        };
        let (sent, log, wake) = run();
        prop_assert!(!matches!(wake.map(|it| it.reason), Some(WakeReason::Reply(_))));
        prop_assert_eq!((sent, log, wake), run());
    }
}
