//! A thousand soak tests, and bugs that they must find.

use crate::expect::{read, root};
use drivemu::event::EventKind;
use drivemu::medium::FaultKind;
use drivemu::model::{Choices, load};
use drivemu::testkit::soak::{InjectedBug, Options, Report, SEED, run, seeds};
use std::collections::BTreeMap;
use std::num::NonZero;
use std::panic::resume_unwind;
use std::process::Command;
use std::sync::LazyLock;
use std::sync::atomic::{AtomicU64, Ordering};
use std::thread;

/// Storms in every run of the tests.
const SEEDS: u64 = 1_000;

/// What happens in a thousand soak tests at least, besides every kind of fault, or they would hold for drives that do nothing.
#[rustfmt::skip]
const HAPPENS: [&str; 30] = [
    "BadAscii", "BadCrc", "Broadcast", "BroadcastRead", "Foreign", "StreamClosed", "LineSettings", "Noise", "Refusal",
    "RepeatedCommand", "Transaction", "Drive Alarm", "Drive AlarmCleared", "Drive Coasting", "Drive PositionDeviation",
    "Drive FactoryRestored", "Drive HomingFound", "Drive HardStop", "Drive HomingComplete", "Drive HomingAborted", "Drive Jogging",
    "Drive Limit", "Drive ModeChanged", "Drive Moving", "Drive PositionCleared", "Drive PositionSegment", "Drive Running",
    "Drive Stored", "Drive UnitChanged", "Drive WordExpired",
];

/// The embedded models and the made-up one.
static OPTIONS: LazyLock<Options> = LazyLock::new(|| {
    let acme = load(&read(&root("tests/models/acme-s1.yaml")), &Choices::new());
    let mut options = Options::builtin();
    options.models.push(acme.expect("a good model").into());
    options
});

fn passed(seed: u64, options: &Options) -> Report {
    run(seed, options).unwrap_or_else(|failure| panic!("{failure}"))
}

/// `SOAK_SEED=N cargo test soak` plays one of them.
#[test]
fn a_thousand_runs_pass() {
    let seeds: Vec<u64> = seeds(SEEDS).collect();
    let next = AtomicU64::new(0);
    let work = || {
        let mut seen = BTreeMap::<String, u64>::new();
        while let Some(seed) = seeds.get(next.fetch_add(1, Ordering::Relaxed) as usize) {
            let report = passed(*seed, &OPTIONS);
            report.events.iter().for_each(|it| *seen.entry(kind(&it.kind)).or_default() += 1);
        }
        seen
    };
    let count = thread::available_parallelism().map_or(1, NonZero::get);
    let mut seen: BTreeMap<String, u64> = BTreeMap::new();
    thread::scope(|scope| {
        let workers: Vec<_> = (0..count).map(|_| scope.spawn(work)).collect();
        for worker in workers {
            let part = worker.join().unwrap_or_else(|panic| resume_unwind(panic));
            part.into_iter().for_each(|(kind, n)| *seen.entry(kind).or_default() += n);
        }
    });
    let faults = FaultKind::ALL.iter().map(|kind| format!("Fault {kind}"));
    let happens = HAPPENS.iter().map(|it| (*it).to_owned()).chain(faults);
    let unseen: Vec<_> = happens.filter(|it| !seen.contains_key(it)).collect();
    assert!(seeds.len() < SEEDS as usize || unseen.is_empty(), "{unseen:?} never happen: {seen:?}");
}

/// What happened, without its numbers: `Drive Moving`, `Fault lose_reply`.
fn kind(what: &EventKind) -> String {
    let text = match what {
        EventKind::Drive { event: change, .. } => format!("Drive {change:?}"),
        EventKind::Fault(hit) => format!("Fault {}", hit.effect.name()),
        EventKind::Transaction(it) if it.refusal.is_some() => "Refusal".into(),
        what => format!("{what:?}"),
    };
    let words = text.split(|c: char| !c.is_alphanumeric() && c != '_').filter(|it| !it.is_empty());
    let mut words =
        words.take(if text.starts_with("Drive") || text.starts_with("Fault") { 2 } else { 1 });
    let first = words.next().unwrap_or_default();
    words.fold(first.to_owned(), |all, word| format!("{all} {word}"))
}

/// The bug is found within a few soak tests, the same again, and by a few steps of the soak test.
fn found(bug: InjectedBug, says: &str) {
    let options = Options { bug: Some(bug), ..OPTIONS.clone() };
    let failure = seeds(30).find_map(|seed| run(seed, &options).err()).expect("it is found");
    let text = failure.to_string();
    assert!(text.contains(says), "{text}");
    assert!(text.starts_with(&format!("{SEED}={}: ", failure.seed)), "{text}");
    assert!(failure.steps.len() <= 4, "{text}");
    assert_eq!(run(failure.seed, &options), Err(failure.clone()), "it replays");
    passed(failure.seed, &OPTIONS);
}

#[test]
fn an_answer_that_leaves_twice_is_found() {
    found(InjectedBug::AnswersTwice, "nobody asked for");
}

#[test]
fn a_refused_write_that_is_half_done_is_found() {
    found(InjectedBug::WritesHalf, "a row has changed, and nobody has written it");
}

#[test]
fn an_event_that_is_lost_between_looks_is_found() {
    found(InjectedBug::LosesEvent, "polled rarely");
}

#[test]
fn a_seed_says_it_all() {
    let [once, again, other] = [5, 5, 6].map(|seed| passed(seed, &OPTIONS));
    assert_eq!(once, again);
    assert_ne!(once, other);
}

/// Whoever is told a seed plays it by the variable alone.
#[test]
fn the_variable_plays_one_seed() {
    let play = |seed: &str| {
        let mut tests = Command::new(std::env::current_exe().expect("this program"));
        tests.args(["soak::a_thousand_runs_pass", "--exact"]).env(SEED, seed);
        let output = tests.output().expect("the tests start");
        (output.status.success(), String::from_utf8_lossy(&output.stdout).into_owned())
    };
    let (passed, said) = play("77");
    assert!(passed && said.contains("1 passed"), "{said}");
    let (passed, said) = play("seventy");
    assert!(!passed && said.contains("SOAK_SEED is a number"), "{said}");
}
