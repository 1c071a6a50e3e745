//! What an axis shows at an instant, in the drive's coordinate, and what it could do.

use super::course::Course;
use super::interrupt;
use super::levels::Level;
use super::origin::Ratio;
use super::settings::Moment;
use super::{Axis, segments};
use crate::behaviour::{Control, Motor, Ramp};
use crate::drive::context::DriveContext;
use crate::drive::registers::Registers;
use crate::event::Ignored;
use crate::motion::{Machine, State, Switch};
use crate::time::{Duration, Instant};
use crate::vocabulary::{Input, Lasts, Quantity, Setting, SoftLimitRule, Threshold};

/// `position` as the row of the actual position shows it, which has fewer bits than an axis has counts.
pub(super) fn wrapped(registers: &Registers, position: i64) -> i64 {
    let row = registers.model().wiring.row_of(Quantity::PositionActual);
    row.map_or(position, |row| {
        let kind = registers.model().map.row(row).kind;
        kind.value(kind.wrapped(position))
    })
}

/// The moment of an order that is given now.
pub(super) fn order_moment(motor: &Motor) -> Moment {
    if motor.is_moving() { Moment::Order } else { Moment::Start }
}

/// An axis at an instant, beside what other parts show then.
#[derive(Debug, Clone, Copy)]
pub(in crate::drive) struct AxisView<'a> {
    axis: &'a Axis,
    cx: DriveContext<'a>,
}

impl<'a> AxisView<'a> {
    pub(super) fn new(axis: &'a Axis, cx: DriveContext<'a>) -> Self {
        Self { axis, cx }
    }

    /// What it is seen beside.
    pub(in crate::drive) fn context(self) -> DriveContext<'a> {
        self.cx
    }

    /// Its motor.
    pub(in crate::drive) fn motor(self) -> &'a Motor {
        &self.axis.motor
    }

    /// Where the axis is and how fast it goes, in the machine's coordinate, which no register shows and which stays as it
    /// is when positive counts go the other way.
    pub(in crate::drive) fn state(self) -> State {
        let State { position, speed } = self.axis.motor.feedback(self.cx.now);
        let sign = if self.axis.origin.reversed { -1.0 } else { 1.0 };
        State { position: sign * position, speed: sign * speed }
    }

    /// What stands along the axis.
    pub(in crate::drive) fn machine(self) -> Machine {
        let machine = *self.axis.motor.machine();
        if self.axis.origin.reversed { machine.mirrored() } else { machine }
    }

    /// The switch of the machine that `signal` is wired to. Which end of the machine is its positive one does not
    /// depend on which way the drive counts.
    pub(in crate::drive) fn switch(self, signal: Input) -> Option<Switch> {
        match (signal, self.axis.origin.reversed) {
            (Input::HomeSwitch, _) => Some(Switch::Home),
            (Input::LimitPos, false) | (Input::LimitNeg, true) => Some(Switch::PositiveLimit),
            (Input::LimitNeg, false) | (Input::LimitPos, true) => Some(Switch::NegativeLimit),
            _ => None,
        }
    }

    /// Has the machine such a switch?
    pub(in crate::drive) fn has_switch(self, switch: Switch) -> bool {
        self.axis.motor.machine().has(switch)
    }

    /// Is the switch active?
    pub(in crate::drive) fn is_switched(self, switch: Switch) -> bool {
        self.axis.motor.machine().is_active(switch, self.axis.motor.state(self.cx.now).position)
    }

    /// Where the motor seems to be, in counts.
    pub(in crate::drive) fn seen_position(self) -> i64 {
        self.cx
            .faults
            .seen
            .map_or_else(|| self.axis.motor.position(self.cx.now), |seen| seen.position)
    }

    /// How fast it seems to go, in counts per second.
    pub(in crate::drive) fn seen_speed(self) -> f64 {
        self.cx.faults.seen.map_or_else(|| self.axis.motor.speed(self.cx.now), |seen| seen.speed)
    }

    /// Where the axis stands, in units of position.
    pub(in crate::drive) fn position(self) -> i64 {
        self.axis.origin.shown(Ratio::of(self.cx.registers), self.seen_position())
    }

    /// Where the encoder is, in the drive's coordinate and in counts, whatever the gear.
    pub(in crate::drive) fn feedback(self) -> i64 {
        self.seen_position().saturating_sub(self.axis.origin.zero)
    }

    /// Counts from the zero mark of the encoder, below a revolution.
    pub(in crate::drive) fn encoder_angle(self) -> i64 {
        self.seen_position().rem_euclid(self.axis.settings.counts_per_rev() as i64)
    }

    /// The same as a part of a revolution.
    pub(in crate::drive) fn encoder_turn(self) -> f64 {
        self.encoder_angle() as f64 / self.axis.settings.counts_per_rev()
    }

    /// Whole revolutions of the encoder since its turns were cleared.
    pub(in crate::drive) fn encoder_turns(self) -> i64 {
        self.full_turns() - self.axis.origin.cleared_turns
    }

    /// Whole revolutions of the encoder, whatever was cleared.
    pub(super) fn full_turns(self) -> i64 {
        self.seen_position().div_euclid(self.axis.settings.counts_per_rev() as i64)
    }

    /// How fast the axis goes, in revolutions a minute.
    pub(in crate::drive) fn rpm(self) -> f64 {
        self.axis.settings.rpm(self.seen_speed())
    }

    /// The speed that was ordered, in revolutions a minute, where speed is what is controlled.
    pub(in crate::drive) fn rpm_ordered(self) -> Option<f64> {
        match self.axis.motor.control()? {
            Control::Position => None,
            Control::Speed(speed) => Some(self.axis.settings.rpm(speed)),
        }
    }

    /// Counts that the encoder is behind the command: of a frozen one all that it has missed, in position control.
    pub(in crate::drive) fn deviation(self) -> f64 {
        let deviation = self.axis.motor.deviation(self.cx.now);
        match self.axis.motor.control() {
            Some(Control::Position) => {
                let missed =
                    self.axis.motor.position(self.cx.now).saturating_sub(self.seen_position());
                deviation + missed as f64
            }
            _ => deviation,
        }
    }

    /// Has an origin been found since power came on?
    pub(in crate::drive) fn is_homed(self) -> bool {
        self.axis.origin.found
    }

    /// Is the command at rest in position control, and the axis with it for as long as it takes to settle?
    pub(in crate::drive) fn is_settled(self) -> bool {
        let at = self.axis.motor.rests_at(self.cx.now, self.position_window());
        let follows = self.axis.motor.control() == Some(Control::Position);
        follows && at.is_some_and(|at| at + self.settling_time() <= self.cx.now)
    }

    /// When the axis is, or will be, where its last move was to end, for as long as it takes to settle. That move has
    /// ended.
    pub(in crate::drive) fn in_position_at(self) -> Option<Instant> {
        let at = self.axis.motor.arrives_at(self.cx.now, self.position_window())?;
        Some(at + self.settling_time())
    }

    fn position_window(self) -> f64 {
        self.threshold(Threshold::PositionWindow).unwrap_or(0.0)
    }

    fn settling_time(self) -> Duration {
        let time = self.threshold(Threshold::PositionSettle).unwrap_or(0.0);
        // Rows hold no times that are negative or beyond a few years.
        Duration::try_from_secs_f64(time).unwrap_or_default()
    }

    /// A threshold in the base unit of its dimension, increments in counts.
    pub(in crate::drive) fn threshold(self, threshold: Threshold) -> Option<f64> {
        self.axis.settings.threshold(self.cx.registers, threshold)
    }

    /// Positions of the motor between which the axis has to stay, if such are in force.
    pub(super) fn soft_limits(self) -> Option<[i64; 2]> {
        let settings = self.axis.settings.axis(self.cx.registers, Moment::UnderWay);
        let low = settings.counts(Setting::SoftLimitNeg)?;
        let high = settings.counts(Setting::SoftLimitPos)?;
        let rule = self.cx.registers.chosen(&self.cx.model().wiring.limits.soft);
        let in_force = match rule.unwrap_or(SoftLimitRule::Always) {
            SoftLimitRule::Off => false,
            SoftLimitRule::AfterHoming => self.axis.origin.found,
            SoftLimitRule::Always => true,
        };
        let gear = Ratio::of(self.cx.registers);
        in_force.then(|| [low, high].map(|it| self.axis.origin.place(gear, it)))
    }

    /// Is the axis beyond the negative and the positive soft limit, if such are in force?
    pub(in crate::drive) fn beyond_soft_limits(self) -> [bool; 2] {
        let Some([low, high]) = self.soft_limits() else { return [false; 2] };
        let position = self.axis.motor.state(self.cx.now).position;
        [position < low as f64, position > high as f64]
    }

    /// The position segment that started last.
    pub(in crate::drive) fn segment(self) -> u16 {
        self.axis.segments.number
    }

    /// The position segment that comes next.
    pub(in crate::drive) fn next_segment(self) -> u16 {
        self.axis.segments.next(self.cx)
    }

    /// Is interrupt positioning under way, and has one just come to its end?
    pub(in crate::drive) fn interrupt_shows(self) -> (bool, bool) {
        let done_at = self.axis.interrupt.done_at(self.in_position_at());
        let shown = interrupt::shown_time(self.cx.registers, &self.axis.settings);
        self.axis.interrupt.shows(self.cx.now, done_at, shown)
    }

    /// May interrupt positioning start right now?
    ///
    /// # Errors
    /// Why not.
    pub(in crate::drive) fn may_interrupt(self) -> Result<(), Ignored> {
        self.axis.interrupt.may_start(self.cx, &self.axis.motor)
    }

    /// Is there an interrupt positioning to unlock?
    pub(in crate::drive) fn can_unlock_interrupt(self) -> bool {
        self.axis.interrupt.can_unlock()
    }

    /// Instants after now between which what the axis shows changes in one direction only, if nothing happens to it.
    pub(in crate::drive) fn marks(self) -> Vec<Instant> {
        let mut marks = self.axis.motor.marks(self.cx.now);
        let done_at = self.axis.interrupt.done_at(self.in_position_at());
        let forgotten =
            done_at.map(|at| at + interrupt::shown_time(self.cx.registers, &self.axis.settings));
        marks.extend(forgotten.filter(|at| *at > self.cx.now));
        marks.sort_unstable();
        marks
    }

    /// What levels ask for, if they ask for one thing.
    pub(in crate::drive) fn level(self) -> Option<Level> {
        Level::asked_for(self.cx.inputs, self.axis.segments.velocity)
    }

    /// The run that levels ask for, at the speed that counts. Levels that contradict each other ask for none.
    pub(in crate::drive) fn wanted_run(self) -> Option<(Level, Ramp)> {
        let level = self.level().filter(|_| !self.cx.has(Input::ZeroSpeedClamp))?;
        let moment = match self.is_under_way(level) {
            true => Moment::UnderWay,
            false => order_moment(&self.axis.motor),
        };
        // Without a speed there is nothing to begin, and nothing to end again and again.
        let ramp = level.ramp(self.cx.registers, &self.axis.settings, moment);
        Some((level, ramp.filter(|ramp| ramp.speed != 0.0)?))
    }

    /// Does the axis run because of this level?
    pub(super) fn is_under_way(self, level: Level) -> bool {
        self.axis.motor.phase().is_jogging() && self.axis.course == Some(Course::Level(level))
    }

    /// Does the axis run because `input` asks for it?
    pub(in crate::drive) fn runs_by(self, input: Input) -> bool {
        let by = matches!(self.axis.course, Some(Course::Level(level)) if level.input() == input);
        by && self.axis.motor.phase().is_jogging()
    }

    /// Is a velocity segment asked for?
    pub(in crate::drive) fn has_velocity_segment(self) -> bool {
        self.axis.segments.velocity.is_some()
    }

    /// May the velocity segment begin that is selected? At speed 0 it ends one that is under way; while speeds are clamped
    /// to 0 it waits.
    ///
    /// # Errors
    /// Why not.
    pub(super) fn may_run_velocity(self, under_way: bool) -> Result<(), Ignored> {
        match self.wanted_run() {
            Some((_, ramp)) => self.axis.motor.may_go(self.cx.now, ramp.speed),
            None if self.axis.segments.velocity.is_none() => Err(Ignored::NoSegment),
            None if under_way || self.cx.has(Input::ZeroSpeedClamp) => Ok(()),
            None => Err(Ignored::NoSpeed),
        }
    }

    /// Why an order to stop has no effect, if it has none; one that stops `at_once` also ends a ramp.
    pub(in crate::drive) fn why_no_stop(self, at_once: bool) -> Option<Ignored> {
        let slowing = self.axis.motor.phase().is_slowing();
        match () {
            () if self.axis.segments.chain.is_under_way() => None,
            () if !self.axis.motor.is_moving() => Some(Ignored::AlreadyStopped),
            () if slowing && !(at_once && self.cx.power.is_enabled()) => Some(Ignored::Stopping),
            () => None,
        }
    }

    /// How long a velocity segment lasts that begins now.
    pub(in crate::drive) fn lasts_by_edge(self) -> bool {
        segments::velocity_lasts(self.cx.registers) == Some(Lasts::Edge)
    }
}
