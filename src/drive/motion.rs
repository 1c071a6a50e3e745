//! The axis as its drive sees it: orders and levels become motions, and what motions tell is in the drive's
//! coordinate. What rows say about them is read in `settings.rs`.

use super::Drive;
use super::course::{Course, MoveRows};
use super::settings::Moment;
use crate::behaviour::{Commands, Control, Effect, MotorLevels, Phase, Replan};
use crate::event::{Change, Ignored, Replanned};
use crate::model::AlarmStop;
use crate::motion::{Machine, State};
use crate::time::Instant;
use crate::vocabulary::{
    Action, HomeStarter, InhibitRule, Input, Modifier, Modifiers, Setting, SoftLimitRule, Threshold,
};

impl Drive {
    /// Where the axis stands, in the drive's coordinate and its units.
    pub(super) fn position(&self, now: Instant) -> i64 {
        self.shown(self.seen_position(now))
    }

    /// A position of the machine in the drive's coordinate and its units.
    pub(super) fn shown(&self, position: i64) -> i64 {
        self.gear().units(position.saturating_sub(self.zero))
    }

    /// A position in the drive's coordinate and its units, in that of the machine.
    pub(super) fn place(&self, position: i64) -> i64 {
        self.gear().counts(position).saturating_add(self.zero)
    }

    /// Has positive counts go the origin that a row says, once the axis stands. The position register goes on from what it says.
    fn follow_direction(&mut self) {
        let row = self.model.wiring.axis.reversed;
        let reversed = row.is_some_and(|row| self.bank.value(&self.model, row) != 0);
        if reversed != self.reversed && !self.motor.is_moving() {
            let position = self.seen_position(self.now).saturating_sub(self.zero);
            self.motor.reverse_direction(self.now);
            self.reversed = reversed;
            self.zero = self.motor.position(self.now).saturating_sub(position);
        }
    }

    /// Where the axis is and how fast it goes, in the machine's coordinate, which no register shows and
    /// which stays as it is when positive counts go the other origin.
    pub(super) fn axis_state(&self, now: Instant) -> State {
        let State { position, speed } = self.motor.feedback(now);
        let sign = if self.reversed { -1.0 } else { 1.0 };
        State { position: sign * position, speed: sign * speed }
    }

    /// What stands along the axis.
    pub(super) fn machine(&self) -> Machine {
        let machine = *self.motor.machine();
        if self.reversed { machine.mirrored() } else { machine }
    }

    /// How fast the axis goes, in revolutions a minute.
    pub(super) fn rpm(&self, now: Instant) -> f64 {
        rpm(self.seen_speed(now), self.counts_per_rev)
    }

    /// The speed that was ordered, in revolutions a minute, where speed is what is controlled.
    pub(super) fn rpm_ordered(&self) -> Option<f64> {
        match self.motor.control()? {
            Control::Position => None,
            Control::Speed(speed) => Some(rpm(speed, self.counts_per_rev)),
        }
    }

    /// Has the axis follow the power stage and the levels: after everything that may have changed them, and
    /// at the end of each motion.
    pub(super) fn update_axis(&mut self) {
        if !self.powered {
            return;
        }
        self.uphold_causes();
        self.follow_direction();
        loop {
            self.follow_settings();
            let (run, moment) = (self.wanted_run(), self.order_moment());
            let jog = self.jog(run);
            let wants = MotorLevels { jog, decel: self.decel(), ..self.wants() };
            self.motor.follow(self.now, wants);
            let begins = jog.is_some_and(|jog| jog.takes_over) && self.motor.phase().is_jogging();
            if let Some((level, _)) = run.filter(|_| begins) {
                self.take_settings(moment);
                self.course = Some(Course::Level(level));
            }
            let changed = self.tell_stages(run.and_then(|(level, _)| level.segment()));
            self.settle_segments(wants.power && !wants.stop && !wants.quick_stop);
            // An axis that tells of a fault has changed what is wanted of it, and so has one that has braked for an alarm.
            if !(self.release_brake() || changed) {
                break;
            }
        }
        self.home_at_first_enable();
        if self.motor.take_switch_edge(self.now) {
            self.gather_inputs();
        }
    }

    /// Switches an axis off that has braked for an alarm and stands. Has it?
    fn release_brake(&mut self) -> bool {
        let stands = self.power_stage.is_braking() && !self.motor.is_moving();
        if stands {
            self.power_stage.braked();
            self.report_power_stage();
        }
        stands
    }

    /// Positions of the machine between which the axis has to stay, if such are in force.
    pub(super) fn soft_limits(&self) -> Option<[i64; 2]> {
        let settings = self.axis(Moment::UnderWay);
        let low = settings.counts(Setting::SoftLimitNeg)?;
        let high = settings.counts(Setting::SoftLimitPos)?;
        let rule = &self.model.wiring.limits.soft;
        let in_force = match self.chosen(rule).unwrap_or(SoftLimitRule::Always) {
            SoftLimitRule::Off => false,
            SoftLimitRule::AfterHoming => self.home_done,
            SoftLimitRule::Always => true,
        };
        in_force.then(|| [low, high].map(|it| self.place(it)))
    }

    /// Reports what has become of the power stage.
    pub(super) fn report_power_stage(&mut self) {
        while let Some(effect) = self.power_stage.poll_effect() {
            let change = self.told(effect, None);
            self.changes.extend(change);
        }
    }

    /// Tells what the axis has told, which is about a segment where `segment` says so. Has it changed what is
    /// wanted of the axis?
    pub(super) fn tell_stages(&mut self, segment: Option<u16>) -> bool {
        let mut changed = false;
        while let Some(stage) = self.motor.poll_effect() {
            let change = self.told(stage, segment);
            self.changes.extend(change);
            changed |= self.follow_stage(stage);
        }
        changed
    }

    /// Stops the axis for an alarm.
    pub(super) fn brake(&mut self, stop: AlarmStop) {
        let decel = self.axis(Moment::Stop).slope(Setting::AlarmDecel);
        match (stop, decel) {
            (AlarmStop::Coast, _) => {}
            (AlarmStop::Ramp, Some(decel)) => {
                self.motor.stop_with(self.now, decel.of(0.0));
                self.course = Some(Course::Alarm);
            }
            (AlarmStop::Ramp, None) => self.motor.slow_to_rest(self.now),
            (AlarmStop::Quick, _) => self.motor.stop_with(self.now, f64::INFINITY),
        }
        self.tell_stages(None);
    }

    /// Carries out an order to the axis.
    ///
    /// # Errors
    /// Why it has no effect.
    pub(super) fn order(&mut self, action: Action, modifiers: Modifiers) -> Result<(), Ignored> {
        let now = self.now;
        let [absolute, interrupt] =
            [Modifier::Absolute, Modifier::Interrupt].map(|it| modifiers.has(it));
        let done = match action {
            Action::MoveStart => self.go_to(MoveRows::AxisWiring, absolute, interrupt),
            Action::RunStart => self.start_run(interrupt),
            Action::HomeStart => self.home(HomeStarter::Command),
            _ => {
                let at_once = action == Action::QuickStop;
                let why = self.why_no_stop(at_once);
                self.chain.end();
                match at_once {
                    true => self.motor.quick_stop(now),
                    false => self.motor.stop(now),
                }
                why.map_or(Ok(()), Err)
            }
        };
        self.tell_stages(None);
        done
    }

    /// Runs: also when it runs already, and with `interrupt` when it moves to a position.
    fn start_run(&mut self, interrupt: bool) -> Result<(), Ignored> {
        let moment = self.order_moment();
        if self.inputs.has(Input::ZeroSpeedClamp) {
            return Err(Ignored::Inhibited);
        }
        let ramp = self.run_by_order(moment);
        let over = match self.motor.phase() {
            Phase::Running => true,
            Phase::Moving => interrupt,
            _ => false,
        };
        self.motor.start_run(self.now, ramp, over)?;
        self.take_settings(moment);
        self.course = Some(Course::Run);
        Ok(())
    }

    /// Is `action` one that needs an axis at rest, while it moves?
    pub(super) fn waits_for_rest(&self, action: Action) -> bool {
        matches!(action, Action::StoreAll | Action::RestoreFactory) && self.motor.is_moving()
    }

    /// What is wanted of the axis, apart from runs.
    fn wants(&self) -> MotorLevels {
        let (has, commands) = (|input| self.inputs.has(input), self.commands());
        MotorLevels {
            power: self.power_stage.is_enabled(),
            // What brakes for an alarm starts nothing.
            stop: has(Input::Stop) || self.power_stage.is_braking(),
            quick_stop: has(Input::QuickStop),
            pause: has(Input::Pause),
            commands,
            jog: None,
            decel: None,
            switches: self.inputs,
            soft_limits: self.soft_limits(),
            limit_stop: self.chosen(&self.model.wiring.limits.stop).unwrap_or_default(),
            deviation: self
                .threshold(Threshold::Deviation)
                .filter(|_| commands != Commands::Cleared),
        }
    }

    /// What becomes of the commands of moves.
    fn commands(&self) -> Commands {
        let keeps = || self.chosen(&self.model.wiring.axis.inhibit) == Some(InhibitRule::Keeps);
        let inhibited = self.inputs.has(Input::CommandInhibit);
        match self.inputs.has(Input::ClearDeviation) {
            true => Commands::Cleared,
            false if inhibited && keeps() => Commands::Inhibited,
            false if inhibited => Commands::Cleared,
            false => Commands::Taken,
        }
    }

    /// What the axis tells, as its drive tells it.
    fn told(&self, stage: Effect, segment: Option<u16>) -> Option<Change> {
        let at = |position: i64| self.wrapped(self.shown(position));
        let method = self.method;
        Some(match stage {
            Effect::Ready => Change::Ready,
            Effect::Enabled(on) => Change::Enabled(on),
            Effect::AlarmRaised { cause, code } => Change::Alarm { cause, code },
            Effect::AlarmCleared => Change::AlarmCleared,
            Effect::MoveStarted(to) => match segment {
                None => Change::Moves { to: at(to) },
                Some(number) => Change::PositionSegment { number, to: at(to) },
            },
            Effect::RunStarted(speed) => Change::Runs { mrpm: self.mrpm(speed) },
            Effect::JogStarted(speed) => match segment {
                None => Change::Jogs { mrpm: self.mrpm(speed) },
                Some(number) => Change::VelocitySegment { number, mrpm: self.mrpm(speed) },
            },
            Effect::Replanned(what) => Change::Replans(self.replanned(what)),
            Effect::MovePaused => Change::Pauses,
            Effect::MoveResumed(to) => Change::Resumes { to: at(to) },
            Effect::DeviationCleared(counts) => Change::DeviationCleared { counts },
            Effect::Stopping => Change::Stops,
            Effect::Coasting => Change::Coasts,
            Effect::Stopped(position) => Change::Stands { at: at(position) },
            Effect::LimitReached { forward, soft } => Change::Limit { forward, soft },
            Effect::HardStopHit(position) => Change::Hits { at: at(position) },
            Effect::DeviationExceeded => Change::Deviates,
            Effect::HomingStepStarted(step, speed) => {
                Change::Seeks { method, step, mrpm: self.mrpm(speed) }
            }
            Effect::HomingStepDone(step, position) => {
                Change::Finds { method, step, at: at(position) }
            }
            Effect::HomingLimit { forward, turns, at: position } => {
                Change::FindsLimit { method, forward, turns, at: at(position) }
            }
            Effect::IndexSearchStarted { forward } => Change::Refines { method, forward },
            Effect::IndexFound(position) => Change::Origin { method, at: at(position) },
            // Told once the position register says what it is to say.
            Effect::HomingDone(_) => return None,
            Effect::HomingAborted { why, .. } => Change::HomingLost { method, why },
        })
    }

    fn replanned(&self, what: Replan) -> Replanned {
        // What is no number above 0 is at once.
        let slope = |it: f64| (it > 0.0 && it.is_finite()).then(|| self.mrpm(it));
        match what {
            Replan::Target(to) => Replanned::Target { to: self.wrapped(self.shown(to)) },
            Replan::Speed(speed) => Replanned::Speed { mrpm: self.mrpm(speed) },
            Replan::SlowSpeed(speed) => Replanned::SlowSpeed { mrpm: self.mrpm(speed) },
            Replan::StartSpeed(speed) => Replanned::StartSpeed { mrpm: self.mrpm(speed) },
            Replan::Accel(accel) => Replanned::Acceleration { mrpm_per_s: slope(accel) },
            Replan::Decel(decel) => Replanned::Deceleration { mrpm_per_s: slope(decel) },
            Replan::HomeOffset(by) => Replanned::HomeOffset { by },
            Replan::TimeLimit(time) => Replanned::TimeLimit { time },
        }
    }

    /// Thousandths of a revolution a minute.
    fn mrpm(&self, speed: f64) -> i64 {
        (rpm(speed, self.counts_per_rev) * 1000.0).round() as i64
    }
}

fn rpm(counts_per_s: f64, counts_per_rev: f64) -> f64 {
    counts_per_s * 60.0 / counts_per_rev
}
