//! Soak tests: a random master, random faults, terminals, alarms and power cuts, on lines with random drives, all from one
//! seed. Whatever happens, some things hold:
//!
//! - a request has one answer at most, which comes from the unit that was asked and says what its drive did,
//!   but for what a fault rule says that it did; nothing else leaves;
//! - what is refused or only read leaves every row as it was, and what is written is written whole;
//! - axes never jump and never leave their hard stops;
//! - once a line has been silent, each drive on it hears what it is asked;
//! - what will happen lies in the future once everything has been taken from the bus;
//! - the same seed gives the same bytes and the same events, however often the line is polled.
//!
//! For authors of models: a soak test finds what no list of cases does.
//!
//! ```
//! use drivemu::testkit::soak::{self, Options};
//!
//! let options = Options { steps: 20, ..Options::builtin() };
//! for seed in soak::seeds(3) {
//!     let report = soak::run(seed, &options).unwrap_or_else(|failure| panic!("{failure}"));
//!     assert!(!report.events.is_empty());
//! }
//! ```
//!
//! A failure says its seed as `SOAK_SEED=...`, and what is left of the steps when all that can be are left
//! out. With that variable set, [`seeds`] gives this seed alone.

mod master;
mod play;
mod replies;
mod scene;
mod step;

use crate::event::Event;
use crate::model::builtin::Builtin;
use crate::model::{Choices, Model};
use crate::rng::Fork;
use crate::time::Instant;
use play::{Played, Polling, play};
use scene::{Draws, Scene};
use std::sync::Arc;
use step::SoakStep;
use thiserror::Error;

/// The environment variable that names the one seed to play.
pub const SEED: &str = "SOAK_SEED";

/// What a soak test may be made of.
#[derive(Debug, Clone)]
pub struct Options {
    /// The models that drives are drawn from; one at least.
    pub models: Vec<Arc<Model>>,
    /// How many things happen.
    pub steps: usize,
    /// A bug to be found, for those who test the soak test itself.
    #[doc(hidden)]
    pub bug: Option<InjectedBug>,
}

/// Bugs that a soak test must find. Each is done around the drives, which have none of them.
#[doc(hidden)]
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum InjectedBug {
    /// An exception leaves twice.
    AnswersTwice,
    /// A refused write of many has changed its first row: the check gets to see another value from before.
    WritesHalf,
    /// Who polling seldom misses an event.
    LosesEvent,
}

/// A soak test that was passed.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Report {
    /// The models of the drives on the line, in order.
    pub models: Vec<String>,
    /// Every byte that left the line.
    pub sent: Vec<u8>,
    /// Everything that happened.
    pub events: Vec<Event>,
}

/// A soak test in which something was not as it must be.
#[derive(Debug, Clone, PartialEq, Eq, Error)]
#[error("{}", self.text())]
pub struct SoakFailure {
    /// Seed that reproduces the run.
    pub seed: u64,
    /// When, in emulated time, with all steps.
    pub at: Instant,
    /// What, with the steps that are left.
    pub what: String,
    /// The models of the drives.
    pub models: Vec<String>,
    /// The steps that it takes.
    pub steps: Vec<String>,
}

impl Options {
    /// Drives of all embedded models, and 60 things that happen.
    pub fn builtin() -> Self {
        let load =
            |builtin: Builtin| builtin.load(&Choices::new()).expect("an embedded model is good");
        let models = Builtin::all().map(load).map(Arc::new).collect();
        Self { models, steps: 60, bug: None }
    }
}

impl SoakFailure {
    fn text(&self) -> String {
        let Self { seed, at, what, models, steps } = self;
        let steps: String = steps.iter().map(|step| format!("\n  {step}")).collect();
        let models = models.join(", ");
        format!(
            "{SEED}={seed}: {what} (at {at} of the whole soak test)\non a line of {models}{steps}"
        )
    }
}

/// The seeds 0 to `count`, or that of the environment variable `SOAK_SEED` alone.
///
/// # Panics
/// If the variable holds no number.
pub fn seeds(count: u64) -> impl Iterator<Item = u64> {
    let only = std::env::var(SEED).ok();
    let only = only.map(|text| text.parse::<u64>().expect("SOAK_SEED is a number"));
    let all = only.map_or(0..count, |seed| seed..seed.saturating_add(1));
    all.into_iter()
}

/// Runs the soak test with this seed.
///
/// # Errors
/// If something was not as it must be.
pub fn run(seed: u64, options: &Options) -> Result<Report, SoakFailure> {
    let draws = |part: &str, n: u64| Draws(Fork::new(seed, "soak test", part).stream(n));
    let scene = Scene::draw(seed, &options.models, &mut draws("scene", 0));
    let steps = step::draw(&scene, options.steps, |n| draws("step", n));
    let models: Vec<_> =
        scene.line.devices.iter().map(|device| device.model.name.clone()).collect();
    let plays = |steps: &[SoakStep]| both(&scene, steps, draws("polling", 0), options.bug);
    match plays(&steps) {
        Ok(Played { sent, events }) => Ok(Report { models, sent, events }),
        Err((at, _)) => {
            let steps = shrink(steps, |steps| plays(steps).is_err());
            let what = plays(&steps).err().map(|(_, what)| what).unwrap_or_default();
            let steps = steps.iter().map(SoakStep::to_string).collect();
            Err(SoakFailure { seed, at, what, models, steps })
        }
    }
}

/// Plays it closely and again with few polling, which must be the same.
fn both(
    scene: &Scene,
    steps: &[SoakStep],
    draws: Draws,
    bug: Option<InjectedBug>,
) -> Result<Played, (Instant, String)> {
    let closely = play(scene, steps, Polling::Frequent, bug)?;
    let mut seldom = play(scene, steps, Polling::Rare(draws), None)?;
    if bug == Some(InjectedBug::LosesEvent) {
        seldom.events.pop();
    }
    if closely == seldom {
        return Ok(closely);
    }
    let pairs = closely.events.iter().zip(&seldom.events);
    let differ = pairs.into_iter().find(|(a, b)| a != b);
    let at = differ.map_or(Instant::ZERO, |(a, _)| a.at);
    let what = match differ {
        Some((a, b)) => format!("polled often it tells {a:?}, polled rarely {b:?}"),
        None => "polled rarely it gives other bytes or misses the end".into(),
    };
    Err((at, what))
}

/// Leaves out what can be, as long as it `fails`: halves first, then less and less.
fn shrink(mut steps: Vec<SoakStep>, fails: impl Fn(&[SoakStep]) -> bool) -> Vec<SoakStep> {
    let mut size = steps.len() / 2;
    while size > 0 {
        let mut from = 0;
        while from < steps.len() {
            let mut fewer = steps.clone();
            fewer.drain(from..steps.len().min(from + size));
            if fails(&fewer) { steps = fewer } else { from += size }
        }
        size /= 2;
    }
    steps
}
