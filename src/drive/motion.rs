//! The axis as its drive sees it: what rows say about motions, in counts, and what motions tell, in the
//! drive's coordinate.

use super::Drive;
use crate::behaviour::{Ramp, Stage, Wants};
use crate::event::Change;
use crate::model::{AlarmStop, Counts};
use crate::motion::Move;
use crate::units::Dimension;
use crate::words::{Action, Input, Modifier, Modifiers, Setting};

impl Drive {
    /// Where the axis stands, in the drive's coordinate.
    pub(super) fn position(&self) -> i64 {
        self.motor.position(self.now).saturating_sub(self.zero)
    }

    /// How fast the axis goes, in revolutions a minute.
    pub(super) fn rpm(&self) -> f64 {
        rpm(self.motor.speed(self.now), self.counts_per_rev())
    }

    /// How fast a run or a jog was ordered to go, in revolutions a minute.
    pub(super) fn rpm_ordered(&self) -> Option<f64> {
        self.motor.speed_ordered().map(|speed| rpm(speed, self.counts_per_rev()))
    }

    /// Has the axis follow the power stage and the levels: after everything that may have changed them, and
    /// at the end of each motion.
    pub(super) fn settle(&mut self) {
        if self.servo.is_braking() && !self.motor.is_moving() {
            self.servo.braked(&mut |change| self.changes.push_back(change));
        }
        let has = |input| self.inputs.has(input);
        let wants = Wants {
            power: self.servo.is_enabled(),
            // What brakes for an alarm starts nothing.
            stop: has(Input::Stop) || self.servo.is_braking(),
            quick_stop: has(Input::QuickStop),
            jog: self.jog(has(Input::JogPos), has(Input::JogNeg)),
        };
        let mut stages = Stages::new(self);
        self.motor.follow(self.now, wants, &mut |stage| stages.push(stage));
        self.changes.extend(stages.changes());
    }

    /// Lets a motion end that is due.
    pub(super) fn end_motion(&mut self) {
        let mut stages = Stages::new(self);
        self.motor.advance(self.now, &mut |stage| stages.push(stage));
        self.changes.extend(stages.changes());
    }

    /// Stops the axis for an alarm.
    pub(super) fn brake(&mut self, stop: AlarmStop) {
        let decel = self.slope(Setting::AlarmDecel, 0.0).unwrap_or(0.0);
        let mut stages = Stages::new(self);
        let tell = &mut |stage| stages.push(stage);
        match stop {
            AlarmStop::Coast => {}
            AlarmStop::Ramp => self.motor.stop_with(self.now, decel, tell),
            AlarmStop::Quick => self.motor.quick_stop(self.now, tell),
        }
        self.changes.extend(stages.changes());
    }

    /// Carries out an order to the axis.
    pub(super) fn order(&mut self, action: Action, modifiers: Modifiers) {
        let (now, zero) = (self.now, self.zero);
        let mut stages = Stages::new(self);
        let tell = &mut |stage| stages.push(stage);
        let done = match action {
            Action::MoveStart => {
                let (by, how) = self.next_move();
                let absolute = modifiers.has(Modifier::Absolute);
                let target = |here: i64| (if absolute { zero } else { here }).saturating_add(by);
                let interrupt = modifiers.has(Modifier::Interrupt);
                self.motor.start_move(now, target, how, interrupt, tell)
            }
            Action::RunStart => {
                let speed = self.speed(Setting::RunSpeed);
                let ramp = self.ramp(speed, Setting::RunAccel, Setting::RunDecel);
                self.motor.start_run(now, ramp, tell)
            }
            Action::QuickStop => {
                self.motor.quick_stop(now, tell);
                Ok(())
            }
            _ => {
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

    fn jog(&self, forward: bool, reverse: bool) -> Option<Ramp> {
        let speed = match (forward, reverse) {
            (true, false) => self.speed(Setting::JogSpeed).abs(),
            (false, true) => -self.speed(Setting::JogSpeed).abs(),
            _ => return None,
        };
        let ramp = || self.ramp(speed, Setting::JogAccel, Setting::JogDecel);
        // Without a speed there is nothing to begin, and nothing to end again and again.
        (speed != 0.0).then(ramp)
    }

    /// How far, or where to, and how.
    fn next_move(&self) -> (i64, Move) {
        let target = self.setting(Setting::MoveTarget).map_or(0.0, |(value, _)| value.round());
        let speed = self.speed(Setting::MoveSpeed).abs();
        let start_speed = self.speed(Setting::MoveStartSpeed).abs();
        let change = (speed - start_speed).max(0.0);
        let Ramp { accel, decel, .. } = self.ramp(change, Setting::MoveAccel, Setting::MoveDecel);
        (target as i64, Move { start_speed, speed, accel, decel })
    }

    /// Slopes that reach `speed` from standstill; what slows down is what speeds up where no row says more,
    /// and without either the speed changes at once.
    fn ramp(&self, speed: f64, accel: Setting, decel: Setting) -> Ramp {
        let accel = self.slope(accel, speed.abs());
        let decel = self.slope(decel, speed.abs()).or(accel);
        Ramp { speed, accel: accel.unwrap_or(0.0), decel: decel.unwrap_or(0.0) }
    }

    /// Counts per second squared.
    fn slope(&self, setting: Setting, speed: f64) -> Option<f64> {
        let (value, dimension) = self.setting(setting)?;
        Some(match dimension {
            Dimension::Time => speed / value,
            _ => counts_per_s(value, self.counts_per_rev()),
        })
    }

    /// Counts per second.
    fn speed(&self, setting: Setting) -> f64 {
        let rpm = self.setting(setting).map_or(0.0, |(value, _)| value);
        counts_per_s(rpm, self.counts_per_rev())
    }

    /// The value of a setting in the base unit of its dimension.
    fn setting(&self, setting: Setting) -> Option<(f64, Dimension)> {
        let row = self.model.wiring.axis.setting(setting)?;
        let unit = self.model.map.row(row).unit;
        Some((self.bank.value(&self.model, row) as f64 * unit.scale, unit.dimension))
    }

    fn counts_per_rev(&self) -> f64 {
        match self.model.wiring.axis.counts_per_rev {
            Counts::Fixed(counts) => counts.into(),
            Counts::Row(row) => self.bank.value(&self.model, row) as f64,
        }
    }
}

/// What an axis tells in one instant, as its drive tells it. An order makes two of them at most: that a
/// motion begins, and that it is over at once; levels may stop a motion and begin another.
struct Stages {
    zero: i64,
    counts_per_rev: f64,
    told: [Option<Change>; 6],
}

impl Stages {
    fn new(drive: &Drive) -> Self {
        Self { zero: drive.zero, counts_per_rev: drive.counts_per_rev(), told: [None; 6] }
    }

    fn push(&mut self, stage: Stage) {
        let mrpm = |speed| (rpm(speed, self.counts_per_rev) * 1000.0).round() as i64;
        let change = match stage {
            Stage::Moves(to) => Change::Moves { to: to.saturating_sub(self.zero) },
            Stage::Runs(speed) => Change::Runs { mrpm: mrpm(speed) },
            Stage::Jogs(speed) => Change::Jogs { mrpm: mrpm(speed) },
            Stage::Stops => Change::Stops,
            Stage::Coasts => Change::Coasts,
            Stage::Stands(at) => Change::Stands { at: at.saturating_sub(self.zero) },
        };
        if let Some(slot) = self.told.iter_mut().find(|it| it.is_none()) {
            *slot = Some(change);
        }
    }

    fn changes(self) -> impl Iterator<Item = Change> {
        self.told.into_iter().flatten()
    }
}

fn counts_per_s(rpm: f64, counts_per_rev: f64) -> f64 {
    rpm * counts_per_rev / 60.0
}

fn rpm(counts_per_s: f64, counts_per_rev: f64) -> f64 {
    counts_per_s * 60.0 / counts_per_rev
}
