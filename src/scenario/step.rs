//! A step as it is carried out: what it waits for, what it does, what it expects.

use super::raw::RawKind;
use crate::bus::{Bus, Command, RequestCounts};
use crate::drive::View;
use crate::event::DriveId;
use crate::time::{Duration, Instant};
use crate::vocabulary::{Named, Output, Quantity, RowId};
use std::cmp::Ordering;

/// One step.
#[derive(Debug, Clone, PartialEq)]
pub struct ScenarioStep {
    /// Name in the log and the report.
    pub name: String,
    /// What it waits for.
    pub trigger: Trigger,
    /// What is done.
    pub commands: Vec<Command>,
    /// How many times, and the time from one to the next.
    pub repeat: Option<(u32, Duration)>,
    /// What has to hold then.
    pub expect: Vec<Condition>,
    /// It may take so long.
    pub within: Duration,
}

/// What a step waits for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Trigger {
    /// An instant.
    At(Instant),
    /// So much time since the step above was done; none at all is at once.
    Wait(Duration),
    /// So many transactions since then.
    After {
        /// How many.
        n: u64,
        /// Which.
        kind: RawKind,
        /// With whom; `None` with any.
        drive: Option<DriveId>,
    },
    /// Something that holds.
    When(Condition),
}

/// Something that holds for a drive or does not.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Condition {
    /// The drive that is observed.
    pub drive: DriveId,
    /// What is looked at.
    pub subject: Subject,
    /// What it has to be.
    pub test: Test,
}

/// What a condition looks at.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Subject {
    /// A signal: 1 for on.
    Signal(Output),
    /// A number.
    Quantity(Quantity),
    /// What a row shows.
    Row(RowId),
}

/// What a number has to be.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Test {
    /// Equal to this number; a signal is 1 or 0.
    Is(i64),
    /// More than the first and less than the second, as far as they are given.
    Within(Option<i64>, Option<i64>),
}

impl RawKind {
    /// How many of these are in `counts`.
    pub(super) fn count(self, counts: RequestCounts) -> u64 {
        match self {
            Self::Read => counts.reads,
            Self::Write => counts.writes,
            Self::Any => counts.all(),
        }
    }
}

impl Condition {
    /// Does it hold?
    pub fn holds(&self, drive: View<'_>) -> bool {
        self.side(drive) == Ordering::Equal
    }

    /// Equal where it holds; else on which side of that the value is.
    pub fn side(&self, drive: View<'_>) -> Ordering {
        let value = self.value(drive);
        match self.test {
            Test::Is(want) => value.cmp(&want),
            Test::Within(Some(above), _) if value <= above => Ordering::Less,
            Test::Within(_, Some(below)) if value >= below => Ordering::Greater,
            Test::Within(..) => Ordering::Equal,
        }
    }

    /// What is instead of what should be: `alarm of unit 1 is off, not on`.
    pub fn tell(&self, bus: &Bus) -> String {
        let drive = bus.view(self.drive);
        let name = match self.subject {
            Subject::Signal(signal) => signal.name().to_owned(),
            Subject::Quantity(quantity) => quantity.name().to_owned(),
            Subject::Row(row) => drive.model().map.row(row).label(),
        };
        let text = |value: i64| match (self.subject, value) {
            (Subject::Signal(_), 0) => "off".to_owned(),
            (Subject::Signal(_), _) => "on".to_owned(),
            _ => value.to_string(),
        };
        let want = match self.test {
            Test::Is(want) => text(want),
            Test::Within(above, below) => {
                let above = above.map(|it| format!("above {it}"));
                let below = below.map(|it| format!("below {it}"));
                above.into_iter().chain(below).collect::<Vec<_>>().join(" and ")
            }
        };
        format!("{name} of unit {} is {}, not {want}", drive.unit(), text(self.value(drive)))
    }

    fn value(&self, drive: View<'_>) -> i64 {
        match self.subject {
            Subject::Signal(signal) => drive.output(signal).into(),
            Subject::Quantity(quantity) => drive.quantity(quantity),
            Subject::Row(row) => drive.value(row),
        }
    }
}
