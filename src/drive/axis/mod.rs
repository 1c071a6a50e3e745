//! The axis of a drive: orders and levels become motions by what rows say, in the drive's coordinate.
//!
//! It owns its motor and everything that is about motions. What it shows is in `observe.rs`; what the motor reports
//! becomes changes in `report.rs`.

mod course;
mod homing;
mod interrupt;
mod levels;
mod observe;
mod orders;
mod origin;
mod report;
mod segments;
mod settings;

pub(super) use homing::may_start_by_input as may_home_by_input;
pub(super) use observe::AxisView;
pub(super) use orders::SegmentStart;
pub(super) use report::change;

use super::context::DriveContext;
use super::effects::EffectQueue;
use super::setup::Setup;
use crate::behaviour::{Commands, Effect, Jog, Motor, MotorLevels, MotorTimer, Phase, Ramp};
use crate::event::{DriveEvent, Ignored};
use crate::model::{AlarmStop, Model};
use crate::time::Instant;
use crate::vocabulary::{HomeEnd, HomeStarter, InhibitRule, Input, Setting, Threshold};
use course::Course;
use homing::HomeRequest;
use interrupt::Interrupt;
use observe::order_moment;
use origin::{Origin, Ratio};
use segments::SegmentState;
use settings::{Moment, TakenSettings};

/// The axis of a drive.
#[derive(Debug)]
pub(super) struct Axis {
    motor: Motor,
    origin: Origin,
    settings: TakenSettings,
    /// What the motion under way goes by.
    course: Option<Course>,
    segments: SegmentState,
    interrupt: Interrupt,
    /// Number of the last homing method.
    method: i64,
    /// Has the power stage not been on since power came on?
    never_enabled: bool,
}

/// What came of following the levels.
#[derive(Debug, Clone, Copy)]
pub(super) struct Followed {
    /// The velocity segment that is asked for.
    pub(super) segment: Option<u16>,
    /// Nothing keeps the axis at rest.
    pub(super) free: bool,
}

impl Axis {
    /// At rest without power, as the bench sets it up.
    pub(super) fn new(model: &Model, setup: &Setup, now: Instant) -> Self {
        let axis = &model.wiring.axis;
        Self {
            motor: Motor::standing(now, setup.start as f64, axis.coast, setup.machine, None),
            origin: Origin::new(setup.position),
            settings: TakenSettings::new(axis.slots),
            course: None,
            segments: SegmentState::default(),
            interrupt: Interrupt::default(),
            method: 0,
            never_enabled: true,
        }
    }

    /// Power comes on. The axis stands where it is.
    pub(super) fn power_on(&mut self, cx: DriveContext<'_>) {
        let axis = &cx.model().wiring.axis;
        self.motor = self.motor.switched_on(cx.now, axis.coast, axis.position_gain);
        self.course = None;
        (self.segments.velocity, self.segments.number) = (None, 0);
        self.segments.chain.end();
        self.settings.take_counts_per_rev(cx.registers);
        self.settings.take(cx.registers, Moment::Start);
        self.interrupt = Interrupt::default();
        self.never_enabled = true;
        let position = self.at(cx).seen_position();
        self.origin.power_on(Ratio::of(cx.registers), position);
    }

    /// Power goes off. What moves coasts.
    pub(super) fn power_off(&mut self, now: Instant) {
        self.segments.chain.end();
        self.motor.follow(now, MotorLevels::default());
    }

    /// The axis at the instant of `cx`.
    pub(super) fn at<'a>(&'a self, cx: DriveContext<'a>) -> AxisView<'a> {
        AxisView::new(self, cx)
    }

    /// Is a motion under way?
    pub(super) fn is_moving(&self) -> bool {
        self.motor.is_moving()
    }

    /// Is it looking for its origin?
    pub(super) fn is_homing(&self) -> bool {
        self.motor.is_homing()
    }

    /// Does something block it?
    pub(super) fn is_blocked(&self) -> bool {
        self.motor.is_blocked()
    }

    /// Something blocks it where it is, or lets it go.
    pub(super) fn set_blocked(&mut self, now: Instant, on: bool) {
        match on {
            true => self.motor.block(now),
            false => self.motor.free(now),
        }
    }

    /// Has a switch of the machine changed up to `now`? Asked once for each time, and before [`Self::advance`].
    pub(super) fn take_switch_edge(&mut self, now: Instant) -> bool {
        self.motor.take_switch_edge(now)
    }

    /// What the motor is due to do by itself at `now` is done.
    pub(super) fn advance(&mut self, now: Instant) {
        self.motor.advance(now);
    }

    /// What the motor reports next.
    pub(super) fn poll_effect(&mut self) -> Option<Effect> {
        self.motor.poll_effect()
    }

    /// What the motor will do by itself.
    pub(super) fn next_timer(&self) -> Option<(Instant, MotorTimer)> {
        self.motor.next_timer()
    }

    /// All that the motor waits for.
    pub(super) fn timers(&self) -> impl Iterator<Item = (Instant, MotorTimer)> {
        self.motor.timers()
    }

    /// When a segment gives way by itself.
    pub(super) fn chain_due_at(&self) -> Option<Instant> {
        self.segments.chain.deadline()
    }

    /// Follows power stage, inputs and settings. To be called after everything that may have changed them, and at the end of
    /// each motion.
    pub(super) fn follow(&mut self, cx: DriveContext<'_>) -> Followed {
        self.follow_settings(cx);
        let (run, moment) = (self.at(cx).wanted_run(), order_moment(&self.motor));
        let jog = run.map(|(level, ramp)| {
            let takes_over = !self.at(cx).is_under_way(level);
            Jog { ramp, takes_over, by_position: level.by_position() }
        });
        let decel =
            self.course.and_then(|it| it.decel(cx.registers, &self.settings, self.motor.phase()));
        let wants = MotorLevels { jog, decel, ..self.wants(cx) };
        self.motor.follow(cx.now, wants);
        let begins = jog.is_some_and(|jog| jog.takes_over) && self.motor.phase().is_jogging();
        if let Some((level, _)) = run.filter(|_| begins) {
            self.settings.take(cx.registers, moment);
            self.course = Some(Course::Level(level));
        }
        Followed {
            segment: run.and_then(|(level, _)| level.segment()),
            free: wants.power && !wants.stop && !wants.quick_stop,
        }
    }

    /// What is wanted of the motor, apart from runs.
    fn wants(&self, cx: DriveContext<'_>) -> MotorLevels {
        let commands = self.commands(cx);
        let limits = &cx.model().wiring.limits;
        MotorLevels {
            power: cx.power.is_enabled(),
            // What brakes for an alarm starts nothing.
            stop: cx.has(Input::Stop) || cx.power.is_braking(),
            quick_stop: cx.has(Input::QuickStop),
            pause: cx.has(Input::Pause),
            commands,
            jog: None,
            decel: None,
            switches: cx.inputs,
            soft_limits: self.at(cx).soft_limits(),
            limit_stop: cx.registers.chosen(&limits.stop).unwrap_or_default(),
            deviation: self
                .at(cx)
                .threshold(Threshold::Deviation)
                .filter(|_| commands != Commands::Cleared),
        }
    }

    /// What becomes of the commands of moves.
    fn commands(&self, cx: DriveContext<'_>) -> Commands {
        let rule = || cx.registers.chosen(&cx.model().wiring.axis.inhibit);
        let inhibited = cx.has(Input::CommandInhibit);
        match cx.has(Input::ClearDeviation) {
            true => Commands::Cleared,
            false if inhibited && rule() == Some(InhibitRule::Keeps) => Commands::Inhibited,
            false if inhibited => Commands::Cleared,
            false => Commands::Taken,
        }
    }

    /// Has positive counts go the way that a row says, once the axis stands. The position register goes on from what it says.
    pub(super) fn follow_direction(&mut self, cx: DriveContext<'_>) {
        let row = cx.model().wiring.axis.reversed;
        let reversed = row.is_some_and(|row| cx.registers.value(row) != 0);
        if reversed != self.origin.reversed && !self.motor.is_moving() {
            let position = self.at(cx).seen_position().saturating_sub(self.origin.zero);
            self.motor.reverse_direction(cx.now);
            self.origin.reversed = reversed;
            self.origin.zero = self.motor.position(cx.now).saturating_sub(position);
        }
    }

    /// Has the motion under way go by what its settings say now.
    fn follow_settings(&mut self, cx: DriveContext<'_>) {
        if !self.motor.is_moving() {
            self.course = None;
            self.settings.take_counts_per_rev(cx.registers);
        }
        match self.course {
            Some(Course::Run) => {
                let ramp = self.run_by_order(cx, Moment::UnderWay);
                self.motor.retune_run(cx.now, ramp);
            }
            Some(Course::Move { rows, origin }) => {
                let rows = rows.of(cx.model());
                let settings = self.settings.of(cx.registers, rows, Moment::UnderWay);
                let (by, ramp) = settings.next_move();
                self.motor.retune_move(cx.now, origin.target(by), ramp);
            }
            Some(Course::Home { finish, factor }) => {
                let retuned = self.motor.home_order().and_then(|order| {
                    homing::retuned(cx.registers, &self.settings, (finish, factor), order)
                });
                if let Some((finish, factor, order)) = retuned {
                    self.course = Some(Course::Home { finish, factor });
                    self.motor.retune_home(cx.now, order);
                }
            }
            // What a level asks for is followed with the levels.
            Some(Course::Level(_) | Course::Alarm) | None => {}
        }
    }

    /// Lets go of what is over: a chain that something broke off, a run by an edge that has ended. Where the axis has
    /// arrived, the chain is told.
    pub(super) fn settle_segments(&mut self, cx: DriveContext<'_>, free: bool) {
        let in_position_at = self.at(cx).in_position_at();
        self.interrupt.update(cx, &self.motor, in_position_at);
        let phase = self.motor.phase();
        let arrived = self.motor.has_arrived();
        if !(free && (arrived || phase == Phase::Moving)) {
            self.segments.chain.end();
        } else if let Some(at) = in_position_at {
            self.segments.chain.arrive(cx.now, at);
        }
        let waits = free && cx.has(Input::ZeroSpeedClamp);
        if !matches!(phase, Phase::Jogging { .. }) && !waits {
            self.segments.velocity = self.segments.velocity.filter(|it| !it.by_edge);
        }
    }

    /// Follows the signals that select a velocity segment.
    pub(super) fn select_velocity(&mut self, cx: DriveContext<'_>) {
        self.segments.select_velocity(cx);
    }

    /// A stop has begun: settings that are taken then count.
    pub(super) fn take_stop_settings(&mut self, cx: DriveContext<'_>) {
        self.settings.take(cx.registers, Moment::Stop);
    }

    /// The motion was planned anew: finds out when the axis comes to the places that its chain waits for.
    pub(super) fn sample_places(&mut self, cx: DriveContext<'_>) {
        let motor = &self.motor;
        self.segments.chain.sample(cx.now, |place| motor.reaches(cx.now, place));
    }

    /// Is this the first time that the power stage is on, and does a row want a homing then?
    pub(super) fn take_first_enable(&mut self, cx: DriveContext<'_>) -> bool {
        let first = self.never_enabled && cx.power.is_enabled();
        self.never_enabled &= !first;
        first && homing::starter(cx.registers) == Some(HomeStarter::FirstEnable)
    }

    /// Looks for the origin because `starter` says so.
    ///
    /// # Errors
    /// Why it does not: rows ask for none, or the axis can't.
    pub(super) fn home(
        &mut self,
        cx: DriveContext<'_>,
        out: &mut EffectQueue,
        starter: HomeStarter,
    ) -> Result<(), Ignored> {
        let HomeRequest { method, order, finish, factor } =
            HomeRequest::read(cx.registers, &self.settings, starter)?;
        self.motor.start_home(cx.now, order)?;
        self.settings.take(cx.registers, Moment::Start);
        self.course = Some(Course::Home { finish, factor });
        (self.method, self.origin.found) = (method, false);
        out.change(DriveEvent::HomingStarted { method });
        Ok(())
    }

    /// The homing is done: the position register says from now on what it is set to say.
    pub(super) fn finish_home(&mut self, cx: DriveContext<'_>, origin: i64) -> DriveEvent {
        let finish = match self.course {
            Some(Course::Home { finish, .. }) => finish,
            _ => homing::FINISH,
        };
        let settings = self.settings.axis(cx.registers, Moment::UnderWay);
        let way = settings.way(Setting::HomeOffset).unwrap_or(0);
        let goes_on = finish.go && !finish.of_origin;
        let point = if goes_on { origin.saturating_add(way) } else { origin };
        let coordinate = settings.way(Setting::HomeCoordinate).unwrap_or(0);
        self.origin.find(finish, point, coordinate);
        let position = observe::wrapped(cx.registers, self.at(cx).position());
        DriveEvent::HomingComplete { method: self.method, position }
    }

    /// The position register says 0 from now on.
    pub(super) fn clear_position(&mut self, cx: DriveContext<'_>) {
        self.origin.zero = self.at(cx).seen_position();
    }

    /// The counter of turns says 0 from now on.
    pub(super) fn clear_turns(&mut self, cx: DriveContext<'_>) {
        self.origin.cleared_turns = self.at(cx).full_turns();
    }

    /// An alarm ends a homing.
    pub(super) fn abort_homing(&mut self) {
        self.motor.lose_origin(HomeEnd::Alarm);
    }

    /// Stops for an alarm.
    pub(super) fn brake(&mut self, cx: DriveContext<'_>, stop: AlarmStop) {
        let decel = self.settings.axis(cx.registers, Moment::Stop).slope(Setting::AlarmDecel);
        match (stop, decel) {
            (AlarmStop::Coast, _) => {}
            (AlarmStop::Ramp, Some(decel)) => {
                self.motor.stop_with(cx.now, decel.of(0.0));
                self.course = Some(Course::Alarm);
            }
            (AlarmStop::Ramp, None) => self.motor.slow_to_rest(cx.now),
            (AlarmStop::Quick, _) => self.motor.stop_with(cx.now, f64::INFINITY),
        }
    }

    /// How a run by order goes: turned round, or kept at rest, while signals say so.
    fn run_by_order(&self, cx: DriveContext<'_>, moment: Moment) -> Ramp {
        let settings = self.settings.axis(cx.registers, moment);
        let ramp = settings.run(cx.has(Input::ReverseSpeed));
        match cx.has(Input::ZeroSpeedClamp) {
            true => Ramp { speed: 0.0, ..ramp },
            false => ramp,
        }
    }
}
