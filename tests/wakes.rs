//! What has woken a drive, by name: in the order of one instant, and in the message of a test that fails.

use crate::kit::{Conversation, rig_of};
use drivemu::bench::DeviceSpec;
use drivemu::bus::WakeReason;
use drivemu::testkit::Rig;
use drivemu::time::Duration;

/// Two input words, held for a second, and a master that may be silent for a second: all three end at once.
fn silenced() -> Rig {
    let text = include_str!("models/acme-s1.yaml");
    let mut rig = rig_of(text, &[], &DeviceSpec::default());
    let unit = rig.drive().unit();
    assert_ne!(rig.ask(&format!("{unit:02X} 06 1004 000A")), "");
    assert_ne!(rig.ask(&format!("{unit:02X} 10 2101 0002 04 0008 0080")), "");
    rig.advance(Duration::from_secs(2));
    rig
}

/// The names of what has woken its drives, in order.
fn woken(rig: &Rig) -> Vec<String> {
    let names = rig.bus().wakes().filter_map(|wake| match wake.reason {
        WakeReason::Drive(_, timer) => Some(timer.to_string()),
        _ => None,
    });
    names.collect()
}

/// The first wake-up that did not come in its turn, with the report of the rig.
fn in_order(rig: &Rig, want: &[&str]) -> Result<(), String> {
    let got = woken(rig);
    let differs = |i: &usize| got.get(*i).map(String::as_str) != want.get(*i).copied();
    match (0..got.len().max(want.len())).find(differs) {
        None => Ok(()),
        Some(i) => {
            let [got, want] = [got.get(i).map(String::as_str), want.get(i).copied()]
                .map(|it| it.unwrap_or("nothing"));
            Err(rig.report(&format!("woken by {got}, not by {want}")))
        }
    }
}

/// The parts of one instant are woken in the order of the table, and time by time.
#[test]
fn deadlines_come_in_order() {
    let rig = silenced();
    let [first, second] = [0, 1].map(|word| format!("hold time of input word {word}"));
    in_order(&rig, &["ready", &first, &second, "master silence"])
        .unwrap_or_else(|it| panic!("{it}"));
}

/// A deadline that comes out of its turn is found by its name, with when it came and what came before it.
#[test]
fn a_deadline_out_of_its_turn_is_named() {
    let rig = silenced();
    let [first, second] = [0, 1].map(|word| format!("hold time of input word {word}"));
    let told = in_order(&rig, &["ready", "master silence", &first, &second]).expect_err("swapped");
    assert!(
        told.starts_with("woken by hold time of input word 0, not by master silence\n"),
        "{told}"
    );
    let trace = told.split_once("--- woken by\n").expect("a trace").1;
    let at: Vec<_> = trace.lines().filter(|line| line.contains("drive 0: ")).collect();
    let expired = ["hold time of input word 0", "hold time of input word 1", "master silence"];
    let (ready, last) = at.split_first().expect("it was woken");
    assert!(ready.ends_with("drive 0: ready"), "{trace}");
    assert!(last.iter().zip(expired).all(|(line, name)| line.ends_with(name)), "{trace}");
    let time = |line: &str| line.split_once("  ").expect("a time").0.to_owned();
    assert!(last.iter().all(|line| time(line) == time(last[0])), "{trace}");
}

/// So does a transcript: what went wrong, the log, and the wake-ups.
#[test]
fn a_transcript_that_fails_tells_them() {
    let conversation = Conversation { path: "here.txt".into(), texts: Vec::new() };
    let text = "model hcfa-x\nset P09.05 0xFFFF\nset P09.11 0\n+ 1s\n> 06 3607 0020\n+ 3s\n? powered off\n";
    let failure = conversation.play_text(text).expect_err("it has supply");
    let trace = failure.split_once("--- woken by\n").expect("a trace").1;
    for name in ["drive 0: ready", "drive 0: hold time of input word 0"] {
        assert!(trace.contains(name), "{failure}");
    }
}
