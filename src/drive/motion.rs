//! The axis as its drive sees it: what rows say about motions, in counts, and what motions tell, in the
//! drive's coordinate.

use super::Drive;
use crate::behaviour::{Ramp, Stage, Wants};
use crate::event::Change;
use crate::model::{Choice, Counts};
use crate::motion::Move;
use crate::units::Dimension;
use crate::words::{Action, HomeStarter, Input, Modifier, Modifiers, Setting, SoftLimitRule};

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
        loop {
            let wants = self.wants();
            self.motor.follow(self.now, wants);
            // An axis that tells of a fault has changed what is wanted of it.
            if !self.tell_stages() {
                break;
            }
        }
        self.home_at_first_enable();
    }

    /// Positions of the machine between which the axis has to stay, if such are in force.
    pub(super) fn soft_limits(&self) -> Option<[i64; 2]> {
        let low = self.counts(Setting::SoftLimitNeg)?;
        let high = self.counts(Setting::SoftLimitPos)?;
        let rule = &self.model.wiring.limits.soft;
        let in_force = match self.chosen(rule).unwrap_or(SoftLimitRule::Always) {
            SoftLimitRule::Off => false,
            SoftLimitRule::AfterHoming => self.home_done,
            SoftLimitRule::Always => true,
        };
        in_force.then(|| [low, high].map(|it| self.zero.saturating_add(it)))
    }

    /// Tells what the axis has told. Has it changed what is wanted of the axis?
    pub(super) fn tell_stages(&mut self) -> bool {
        let mut changed = false;
        while let Some(stage) = self.motor.poll_stage() {
            let change = self.told(stage);
            self.changes.extend(change);
            changed |= self.follow_stage(stage);
        }
        changed
    }

    /// Carries out an order to the axis.
    pub(super) fn order(&mut self, action: Action, modifiers: Modifiers) {
        let (now, zero) = (self.now, self.zero);
        let done = match action {
            Action::MoveStart => {
                let (by, how) = self.next_move();
                let absolute = modifiers.has(Modifier::Absolute);
                let target = |here: i64| (if absolute { zero } else { here }).saturating_add(by);
                let interrupt = modifiers.has(Modifier::Interrupt);
                self.motor.start_move(now, target, how, interrupt)
            }
            Action::RunStart => {
                let speed = self.speed(Setting::RunSpeed);
                let ramp = self.ramp(speed, Setting::RunAccel, Setting::RunDecel);
                self.motor.start_run(now, ramp)
            }
            Action::HomeStart => self.home(HomeStarter::Command),
            Action::QuickStop => {
                self.motor.quick_stop(now);
                Ok(())
            }
            _ => {
                self.motor.stop(now);
                Ok(())
            }
        };
        self.tell_stages();
        if let Err(why) = done {
            self.changes.push_back(Change::Ignored { action, why });
        }
    }

    /// Is `action` one that needs an axis at rest, while it moves?
    pub(super) fn waits_for_rest(&self, action: Action) -> bool {
        matches!(action, Action::StoreAll | Action::RestoreFactory) && self.motor.is_moving()
    }

    fn wants(&self) -> Wants {
        let has = |input| self.inputs.has(input);
        Wants {
            power: self.servo.is_enabled(),
            stop: has(Input::Stop),
            quick_stop: has(Input::QuickStop),
            jog: self.jog(has(Input::JogPos), has(Input::JogNeg)),
            switches: self.inputs,
            soft_limits: self.soft_limits(),
            limit_stop: self.chosen(&self.model.wiring.limits.stop).unwrap_or_default(),
            deviation: self.counts(Setting::Deviation),
        }
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
    pub(super) fn ramp(&self, speed: f64, accel: Setting, decel: Setting) -> Ramp {
        let accel = self.slope(accel, speed.abs());
        let decel = self.slope(decel, speed.abs()).or(accel);
        Ramp { speed, accel: accel.unwrap_or(0.0), decel: decel.unwrap_or(0.0) }
    }

    /// Counts per second squared.
    pub(super) fn slope(&self, setting: Setting, speed: f64) -> Option<f64> {
        let (value, dimension) = self.setting(setting)?;
        Some(match dimension {
            Dimension::Time => speed / value,
            _ => counts_per_s(value, self.counts_per_rev()),
        })
    }

    /// Counts per second.
    pub(super) fn speed(&self, setting: Setting) -> f64 {
        let rpm = self.setting(setting).map_or(0.0, |(value, _)| value);
        counts_per_s(rpm, self.counts_per_rev())
    }

    /// Counts, if a row holds them.
    pub(super) fn counts(&self, setting: Setting) -> Option<i64> {
        self.setting(setting).map(|(value, _)| value.round() as i64)
    }

    /// What a choice comes to, if there is one.
    pub(super) fn chosen<T: Copy>(&self, choice: &Option<Choice<T>>) -> Option<T> {
        choice.as_ref()?.get(|row| self.bank.value(&self.model, row))
    }

    /// What the axis tells, as its drive tells it.
    fn told(&self, stage: Stage) -> Option<Change> {
        let at = |position: i64| position.saturating_sub(self.zero);
        let method = self.method;
        Some(match stage {
            Stage::Moves(to) => Change::Moves { to: at(to) },
            Stage::Runs(speed) => Change::Runs { mrpm: self.mrpm(speed) },
            Stage::Jogs(speed) => Change::Jogs { mrpm: self.mrpm(speed) },
            Stage::Stops => Change::Stops,
            Stage::Coasts => Change::Coasts,
            Stage::Stands(position) => Change::Stands { at: at(position) },
            Stage::Limit { forward, soft } => Change::Limit { forward, soft },
            Stage::Hits(position) => Change::Hits { at: at(position) },
            Stage::Deviates => Change::Deviates,
            Stage::Seeks(step, speed) => Change::Seeks { method, step, mrpm: self.mrpm(speed) },
            Stage::Finds(step, position) => Change::Finds { method, step, at: at(position) },
            Stage::FindsLimit { forward, turns, at: position } => {
                Change::FindsLimit { method, forward, turns, at: at(position) }
            }
            Stage::Refines { forward } => Change::Refines { method, forward },
            Stage::Refined(position) => Change::Origin { method, at: at(position) },
            // Told once the position register says what it is to say.
            Stage::Homed(_) => return None,
            Stage::Lost { why, .. } => Change::HomingLost { method, why },
        })
    }

    /// Thousandths of a revolution a minute.
    fn mrpm(&self, speed: f64) -> i64 {
        (rpm(speed, self.counts_per_rev()) * 1000.0).round() as i64
    }

    /// The value of a setting in the base unit of its dimension.
    pub(super) fn setting(&self, setting: Setting) -> Option<(f64, Dimension)> {
        let row = self.model.wiring.axis.setting(setting)?;
        let unit = self.model.map.row(row).unit;
        Some((self.bank.value(&self.model, row) as f64 * unit.scale, unit.dimension))
    }

    pub(super) fn counts_per_rev(&self) -> f64 {
        match self.model.wiring.axis.counts_per_rev {
            Counts::Fixed(counts) => counts.into(),
            Counts::Row(row) => self.bank.value(&self.model, row) as f64,
        }
    }
}

fn counts_per_s(rpm: f64, counts_per_rev: f64) -> f64 {
    rpm * counts_per_rev / 60.0
}

fn rpm(counts_per_s: f64, counts_per_rev: f64) -> f64 {
    counts_per_s * 60.0 / counts_per_rev
}
