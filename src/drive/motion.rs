//! The axis as its drive sees it: orders and levels become motions, and what motions tell is in the drive's
//! coordinate. What rows say about them is read in `settings.rs`.

use super::Drive;
use crate::behaviour::{Stage, Wants};
use crate::event::Change;
use crate::words::{Action, Input, Modifier, Modifiers};

impl Drive {
    /// Where the axis stands, in the drive's coordinate.
    pub(super) fn position(&self) -> i64 {
        self.motor.position(self.now).saturating_sub(self.zero)
    }

    /// How fast the axis goes, in revolutions a minute.
    pub(super) fn rpm(&self) -> f64 {
        rpm(self.motor.speed(self.now), self.counts_per_rev())
    }

    /// Has the axis follow the power stage and the levels: after everything that may have changed them, and
    /// at the end of each motion.
    pub(super) fn settle(&mut self) {
        let has = |input| self.inputs.has(input);
        let run = self.wanted_run();
        let wants = Wants {
            power: self.servo.is_enabled(),
            stop: has(Input::Stop),
            quick_stop: has(Input::QuickStop),
            jog: run.map(|(_, ramp)| ramp),
        };
        let segment = run.and_then(|(level, _)| level.segment());
        let mut stages = Stages::new(self, segment);
        let tell = &mut |stage| stages.push(stage);
        if self.changes_over(run) {
            self.motor.follow(self.now, Wants { jog: None, ..wants }, tell);
        }
        self.motor.follow(self.now, wants, tell);
        self.changes.extend(stages.changes());
        self.run = run;
        self.settle_segments(wants.power && !wants.stop && !wants.quick_stop);
    }

    /// Lets a motion end that is due.
    pub(super) fn end_motion(&mut self) {
        let mut stages = Stages::new(self, None);
        self.motor.advance(self.now, &mut |stage| stages.push(stage));
        self.changes.extend(stages.changes());
    }

    /// Carries out an order to the axis.
    pub(super) fn order(&mut self, action: Action, modifiers: Modifiers) {
        let (now, model) = (self.now, self.model.clone());
        let rows = &model.wiring.axis.settings;
        let mut stages = Stages::new(self, None);
        let tell = &mut |stage| stages.push(stage);
        let done = match action {
            Action::MoveStart => {
                let [absolute, interrupt] =
                    [Modifier::Absolute, Modifier::Interrupt].map(|it| modifiers.has(it));
                self.go_to(rows, absolute, interrupt, None)
            }
            Action::RunStart => {
                let ramp = self.settings(rows).run(false);
                self.motor.start_run(now, ramp, tell)
            }
            Action::QuickStop => {
                self.chain.end();
                self.motor.quick_stop(now, tell);
                Ok(())
            }
            _ => {
                self.chain.end();
                self.motor.stop(now, tell);
                Ok(())
            }
        };
        self.changes.extend(stages.changes());
        if let Err(why) = done {
            self.changes.push_back(Change::Ignored { action, why });
        }
    }

    /// Is `action` one that needs an axis at rest, while it moves?
    pub(super) fn waits_for_rest(&self, action: Action) -> bool {
        matches!(action, Action::StoreAll | Action::RestoreFactory) && self.motor.is_moving()
    }
}

/// What an axis tells in one instant, as its drive tells it. An order makes two of them at most: that a
/// motion begins, and that it is over at once; levels may stop a motion and begin another.
pub(super) struct Stages {
    /// The segment that moves the axis.
    segment: Option<u16>,
    zero: i64,
    counts_per_rev: f64,
    told: [Option<Change>; 6],
}

impl Stages {
    pub(super) fn new(drive: &Drive, segment: Option<u16>) -> Self {
        let (zero, counts_per_rev) = (drive.zero, drive.counts_per_rev());
        Self { segment, zero, counts_per_rev, told: [None; 6] }
    }

    pub(super) fn push(&mut self, stage: Stage) {
        let mrpm = |speed| (rpm(speed, self.counts_per_rev) * 1000.0).round() as i64;
        let place = |count: i64| count.saturating_sub(self.zero);
        let change = match (stage, self.segment) {
            (Stage::Moves(to), None) => Change::Moves { to: place(to) },
            (Stage::Moves(to), Some(number)) => Change::PositionSegment { number, to: place(to) },
            (Stage::Runs(speed), _) => Change::Runs { mrpm: mrpm(speed) },
            (Stage::Jogs(speed), None) => Change::Jogs { mrpm: mrpm(speed) },
            (Stage::Jogs(speed), Some(number)) => {
                Change::VelocitySegment { number, mrpm: mrpm(speed) }
            }
            (Stage::Stops, _) => Change::Stops,
            (Stage::Coasts, _) => Change::Coasts,
            (Stage::Stands(at), _) => Change::Stands { at: place(at) },
        };
        if let Some(slot) = self.told.iter_mut().find(|it| it.is_none()) {
            *slot = Some(change);
        }
    }

    pub(super) fn changes(self) -> impl Iterator<Item = Change> {
        self.told.into_iter().flatten()
    }
}

fn rpm(counts_per_s: f64, counts_per_rev: f64) -> f64 {
    counts_per_s * 60.0 / counts_per_rev
}
