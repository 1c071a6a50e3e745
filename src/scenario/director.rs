//! Carries out the steps of one line: it looks at the bus whenever something happens there, and gives it commands.
//!
//! It is a value like the bus: time and input come from outside, in the order of [`Director::advance_to`], then the
//! input, then [`Director::look`]. A condition is looked at whenever something happens on the line, and at the instant
//! at which it is going to hold by itself; nothing is polled.

use super::step::{ScenarioStep, Trigger};
use crate::bus::{Bus, LineCommand, RequestCounts};
use crate::event::{Outcome, Remark};
use crate::time::{Duration, Instant};

/// What became of a step that expects something, or that failed otherwise.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Verdict {
    /// Name of the step.
    pub step: String,
    /// When it was settled.
    pub at: Instant,
    /// Time since the step above was done.
    pub took: Duration,
    /// Why it failed, if it did.
    pub failure: Option<String>,
}

/// The steps of one line, and how far they are. By default there are none.
#[derive(Debug, Clone, Default)]
pub struct Director {
    steps: Vec<ScenarioStep>,
    limit: Option<Instant>,
    next: usize,
    state: StepState,
    /// When the step above was done, and what the drives had heard by then.
    since: Instant,
    request_counts: Vec<RequestCounts>,
    /// When to look again, if nothing happens on the line before.
    due: Option<Instant>,
    verdicts: Vec<Verdict>,
}

#[derive(Debug, Clone, Copy, Default)]
enum StepState {
    #[default]
    Waits,
    Repeats {
        left: u32,
        at: Instant,
    },
    Expects {
        until: Instant,
    },
}

impl Director {
    /// For a line that is switched on at the beginning of time; all is to be done until `limit`.
    pub fn new(steps: Vec<ScenarioStep>, limit: Option<Instant>) -> Self {
        Self {
            steps,
            limit,
            next: 0,
            state: StepState::Waits,
            since: Instant::ZERO,
            request_counts: Vec::new(),
            due: Some(Instant::ZERO),
            verdicts: Vec::new(),
        }
    }

    /// Is nothing left to do?
    pub fn is_over(&self) -> bool {
        self.next >= self.steps.len()
    }

    /// When it has to be called at the latest, apart from when the bus wants to be woken.
    pub fn poll_at(&self) -> Option<Instant> {
        self.due
    }

    /// Lets time pass for the bus up to `now`, and carries out what comes meanwhile, each thing at its own instant;
    /// of one instant the bus's first.
    pub fn advance_to(&mut self, bus: &mut Bus, now: Instant) {
        while !self.is_over() {
            let woken = bus.poll_at().map(|wake| wake.at);
            let next = [woken, self.due].into_iter().flatten().min();
            let Some(at) = next.filter(|at| *at <= now) else { break };
            bus.advance_to(at);
            self.poll(bus);
        }
        bus.advance_to(now);
    }

    /// Carries out what is to be done right now: after input, and whatever else may have changed something.
    pub fn poll(&mut self, bus: &mut Bus) {
        if self.is_over() {
            return;
        }
        while self.go_on(bus) {}
        self.due = self.next_poll(bus);
    }

    /// The run is over at `now`: what has not come has failed.
    pub fn finish(&mut self, now: Instant) {
        self.end(now, None);
    }

    /// The same, and why it is over.
    pub fn end(&mut self, now: Instant, why: Option<&str>) {
        while !self.is_over() {
            let failure = match why {
                Some(why) => format!("{}: {why}", self.unsettled()),
                None => self.unsettled().to_owned(),
            };
            self.judge(now, Some(failure));
        }
        self.due = None;
    }

    /// What became of the steps that are over.
    pub fn verdicts(&self) -> &[Verdict] {
        &self.verdicts
    }

    /// One thing is done. Was there any?
    fn go_on(&mut self, bus: &mut Bus) -> bool {
        let now = bus.now();
        let Some(step) = self.steps.get(self.next) else { return false };
        if self.limit.is_some_and(|limit| limit <= now) {
            let why = self.unsettled();
            self.settle(bus, Some(why.into()));
            self.finish(now);
            return false;
        }
        match self.state {
            StepState::Waits if self.has_come(&step.trigger, bus) => {
                let times = step.repeat.map_or(1, |(times, _)| times);
                self.act(bus, times);
            }
            StepState::Repeats { left, at } if at <= now => self.act(bus, left),
            StepState::Expects { until } => {
                let lacks = step.expect.iter().find(|it| !it.holds(bus.view(it.drive)));
                match lacks.map(|it| it.tell(bus)) {
                    Some(_) if now < until => return false,
                    failure => self.settle(bus, failure),
                }
            }
            StepState::Waits | StepState::Repeats { .. } => return false,
        }
        true
    }

    fn has_come(&self, trigger: &Trigger, bus: &Bus) -> bool {
        match *trigger {
            Trigger::At(at) => at <= bus.now(),
            Trigger::Wait(time) => self.since + time <= bus.now(),
            Trigger::When(condition) => condition.holds(bus.view(condition.drive)),
            Trigger::After { n, kind, drive } => {
                let drives =
                    bus.drives().map(|(id, _)| id).filter(|id| drive.is_none_or(|it| it == *id));
                let new = drives.map(|id| {
                    let before =
                        self.request_counts.get(usize::from(id.0)).copied().unwrap_or_default();
                    kind.count(bus.request_counts(id)) - kind.count(before)
                });
                new.sum::<u64>() >= n
            }
        }
    }

    /// Does what the step says, so many times from now on.
    fn act(&mut self, bus: &mut Bus, times: u32) {
        let (now, step) = (bus.now(), &self.steps[self.next]);
        tell(bus, step, Outcome::Begins, String::new());
        for command in &step.commands {
            if let Err(error) = bus.command(now, command.clone()) {
                let what = error.to_string();
                return self.settle(bus, Some(what));
            }
        }
        match step.repeat {
            Some((_, every)) if times > 1 => {
                self.state = StepState::Repeats { left: times - 1, at: now + every };
            }
            _ if step.expect.is_empty() => self.settle(bus, None),
            _ => self.state = StepState::Expects { until: now + step.within },
        }
    }

    /// The step is over.
    fn settle(&mut self, bus: &mut Bus, failure: Option<String>) {
        let step = &self.steps[self.next];
        if failure.is_some() || !step.expect.is_empty() {
            let outcome = if failure.is_some() { Outcome::Failed } else { Outcome::Passed };
            tell(bus, step, outcome, failure.clone().unwrap_or_default());
        }
        self.judge(bus.now(), failure);
        self.request_counts = bus.drives().map(|(id, _)| bus.request_counts(id)).collect();
    }

    /// Notes what became of the step, and goes on to the next.
    fn judge(&mut self, at: Instant, failure: Option<String>) {
        let step = &self.steps[self.next];
        if failure.is_some() || !step.expect.is_empty() {
            let (step, took) = (step.name.clone(), at.since(self.since));
            self.verdicts.push(Verdict { step, at, took, failure });
        }
        self.next += 1;
        (self.state, self.since) = (StepState::Waits, at);
    }

    /// Why the present step is not settled.
    fn unsettled(&self) -> &'static str {
        match self.state {
            StepState::Waits => "the run has ended before this step",
            StepState::Repeats { .. } | StepState::Expects { .. } => {
                "the run has ended during this step"
            }
        }
    }

    fn next_poll(&self, bus: &Bus) -> Option<Instant> {
        let step = self.steps.get(self.next)?;
        let next_time = |condition: &super::Condition| {
            let drive = bus.drive(condition.drive);
            drive.next_time_when(bus.now(), |view| condition.side(view))
        };
        let mut all = vec![self.limit];
        match self.state {
            StepState::Repeats { at, .. } => all.push(Some(at)),
            StepState::Waits => all.push(match step.trigger {
                Trigger::At(at) => Some(at),
                Trigger::Wait(time) => Some(self.since + time),
                Trigger::After { .. } => None,
                Trigger::When(condition) => next_time(&condition),
            }),
            StepState::Expects { until } => {
                all.push(Some(until));
                all.extend(step.expect.iter().map(next_time));
            }
        }
        all.into_iter().flatten().min()
    }
}

fn tell(bus: &mut Bus, step: &ScenarioStep, outcome: Outcome, what: String) {
    let remark = Remark { step: step.name.clone(), outcome, what };
    // Only drives and rules refuse commands.
    let told = bus.command(bus.now(), LineCommand::Tell(remark).into());
    debug_assert!(told.is_ok());
}
