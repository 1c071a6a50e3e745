//! Others on the line: what they say, when, and that our drives and our answers don't mind.

use super::{ANSWER, Bench, MS, READ, frame};
use drivemu::bus::WakeReason;
use drivemu::event::EventKind;
use drivemu::rng::Fork;
use drivemu::serial::Settings;
use drivemu::time::{Duration, Instant};
use drivemu::wire::rtu;

const CHATTER: &str = "chatter: {units: [7, 8], every: 50ms}";

fn servo(line_behaviour: &str, seed: u64) -> Bench {
    let line = format!("pty: auto, {line_behaviour}, drives: [{{model: hcfa-x}}]");
    Bench::seeded(&line, seed)
}

/// What others say within a minute that nobody disturbs.
fn minute(line_behaviour: &str, seed: u64) -> Bench {
    let mut bench = servo(line_behaviour, seed);
    bench.wait(60_000 * MS);
    bench
}

/// Who asks or answers in a frame; noise is too short for one.
fn unit(bytes: &[u8]) -> Option<u8> {
    (bytes.len() > 3).then(|| rtu::decode(bytes).expect("a good frame").unit)
}

/// Requests, answers and bursts of noise that our drives have heard, and nothing else.
fn heard(bench: &Bench) -> [usize; 3] {
    let mut heard = [0; 3];
    for event in &bench.events {
        match &event.kind {
            EventKind::Foreign { reply, .. } => heard[usize::from(*reply)] += 1,
            EventKind::Noise { .. } => heard[2] += 1,
            other => panic!("{other:?}"),
        }
    }
    heard
}

#[test]
fn an_idle_line_has_a_deadline() {
    let bench = servo(CHATTER, 0);
    assert_eq!(bench.bus.poll_at().map(|wake| wake.reason), Some(WakeReason::Chatter));
}

#[test]
fn they_talk_as_often_as_told_to_units_that_are_told() {
    for (every, want) in [("50ms", 1200), ("200ms", 300)] {
        let bench = minute(&format!("chatter: {{units: [7, 8], every: {every}}}"), 1);
        let [requests, _, noise] = heard(&bench);
        assert!((want * 4 / 5..want * 11 / 10).contains(&(requests + noise)), "{want}: {requests}");
        assert!((want / 40..want / 10).contains(&noise), "{want}: {noise}");
        let units = bench.sent.iter().filter_map(|(_, bytes)| unit(bytes));
        let units: std::collections::BTreeSet<_> = units.collect();
        assert_eq!(units.into_iter().collect::<Vec<_>>(), [7, 8]);
    }
}

/// Our drives hear all of it as traffic of others: requests, answers, and some requests without.
#[test]
fn drives_follow_and_never_answer() {
    for strict in ["", ", strict: true"] {
        let bench = minute(&format!("{CHATTER}{strict}"), 2);
        let [requests, answers, noise] = heard(&bench);
        assert!(answers > 900 && requests > answers && requests < answers * 5 / 4, "{requests}");
        let said = bench.sent.len();
        assert_eq!(requests + answers + noise, said, "nothing else is said{strict}");
    }
}

/// What our master asks is answered, whenever it asks, and nobody speaks between request and reply.
#[test]
fn our_answers_stay_right() {
    let framings = ["strict: false", "strict: true", "pacing: line", "echo: true"];
    for (line_behaviour, seed) in framings.into_iter().zip(0..) {
        let mut bench =
            servo(&format!("{line_behaviour}, chatter: {{units: [7], every: 8ms}}"), seed);
        let mut rng = Fork::new(seed, "others", "test").stream(0);
        let mut disturbed = 0;
        for _ in 0..2000 {
            let before = bench.sent.len();
            bench.wait(Duration::from_micros(rng.between(5_000, 40_000)));
            disturbed += usize::from(bench.sent.len() > before);
            let before = bench.sent.len();
            bench.receive(&frame(READ));
            while bench.sent[before..].last().is_none_or(|(_, bytes)| *bytes != frame(ANSWER)) {
                let wake = bench.bus.poll_at().expect("an answer is due");
                bench.until(wake.at);
            }
            let said = bench.sent[before..].iter().filter(|(_, bytes)| *bytes != frame(READ));
            assert_eq!(said.count(), 1, "{line_behaviour}: the answer alone");
        }
        assert!(disturbed > 500, "{line_behaviour}: {disturbed}");
    }
}

/// On each link the drives hear the others, and each master is answered right behind the other's answer.
#[test]
fn masters_on_several_links_are_answered() {
    let line_behaviour = "settings: 9600-8N2, chatter: {units: [7], every: 8ms}";
    let line =
        format!("rtu_over_tcp: '127.0.0.1:0', {line_behaviour}, drives: [{{model: hcfa-x}}]");
    let mut bench = Bench::new(&line);
    let framing = super::line(&line).wire.framing(1.0);
    let links = [bench.link, bench.bus.open(framing)];
    let mut rng = Fork::new(0, "others", "links").stream(0);
    for _ in 0..500 {
        bench.wait(Duration::from_micros(rng.between(5_000, 40_000)));
        bench.sent.clear();
        for link in links {
            bench.link = link;
            bench.receive(&frame(READ));
        }
        let answers = bench.sent.iter().map(|(_, bytes)| bytes.clone()).collect::<Vec<_>>();
        assert_eq!(answers, [frame(ANSWER), frame(ANSWER)]);
    }
}

/// Silence lies before each of their frames, also behind a reply of ours.
#[test]
fn they_keep_silence() {
    let mut bench = servo(&format!("{CHATTER}, pacing: line"), 3);
    let settings: Settings = "9600-8N2".parse().expect("settings");
    let mut last = Instant::ZERO;
    for _ in 0..500 {
        bench.wait(37 * MS);
        for (at, bytes) in std::mem::take(&mut bench.sent) {
            let begins = at - settings.characters(bytes.len() as f64);
            let is_noise = bytes.len() < 4;
            assert!(is_noise || begins >= last + settings.silence(3.5), "{at}");
            last = at;
        }
        bench.receive(&frame(READ));
        last = bench.bus.now();
    }
}

#[test]
fn one_seed_one_chatter() {
    let first = minute(CHATTER, 42);
    assert!(first.sent == minute(CHATTER, 42).sent && first.sent != minute(CHATTER, 43).sent);
}

/// A drive that takes one of their addresses is not asked: it would answer.
#[test]
fn nobody_asks_a_drive_that_is_here() {
    let mut bench = servo("chatter: {units: [7]}", 0);
    bench.receive(&frame(&[6, 0x09, 0x00, 0, 7]));
    bench.sent.clear();
    bench.wait(10_000 * MS);
    assert!(!bench.sent.is_empty() && bench.sent.iter().all(|it| unit(&it.1).is_none()));
}

/// In ASCII framing they speak ASCII.
#[test]
fn they_speak_as_the_line_does() {
    let line = "pty: auto, settings: 9600-7E1, ascii: true, chatter: {units: [9]}, drives: [{model: k-series}]";
    let mut bench = Bench::new(line);
    bench.wait(10_000 * MS);
    let frames = bench.sent.iter().filter(|(_, bytes)| bytes.len() > 3).collect::<Vec<_>>();
    assert!(frames.len() > 100 && frames.iter().all(|(_, bytes)| bytes.starts_with(b":09")));
}
