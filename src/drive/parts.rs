//! The parts of a drive, and how they follow each other: what is told to which, in which order.
//!
//! What may have changed is a list of [`Update`]s. One at a time is carried out; what it makes necessary comes before all that
//! was on the list already, so events come in the order of cause and effect. The number of updates is bounded: more of them
//! are an endless loop.

use super::axis::{self, Axis, AxisView};
use super::comms::Comms;
use super::context::DriveContext;
use super::device_faults::DeviceFaults;
use super::effects::EffectQueue;
use super::inputs::InputSignals;
use super::no_effect::NoEffectReports;
use super::registers::Registers;
use super::setup::{IssuedCommand, Setup};
use super::timer::TimerOwner;
use super::view::View;
use crate::behaviour::{Effect, LevelControl, PowerControl, PowerLevels, PowerStage, Trip};
use crate::event::{ChainEnd, DriveEvent, Ignored, Ordered};
use crate::model::{AlarmStop, Model};
use crate::time::{Duration, Instant};
use crate::vocabulary::{Action, AlarmCause, HomeEnd, HomeStarter, Input, Inputs, Named};
use std::sync::Arc;

/// What may have to be brought up to date.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Update {
    /// The input signals, after their sources.
    Inputs,
    /// The axis, after power stage, inputs and settings, and at the end of a motion.
    Axis,
    /// What is wanted of the motor: a part of the axis, again where it has reported what changes that.
    Motor,
    /// A homing at the first enable.
    FirstEnable,
    /// The input signals, if a switch of the machine has changed.
    Switches,
    /// The homing that this starts.
    Home(HomeStarter),
    /// The motion that the edge of this signal starts.
    Start(Input),
    /// The chain, if it is time to go on.
    Chain,
    /// What was asked for and is not simulated.
    NotSimulated,
}

/// More updates in one go are an endless loop; soak tests and transcripts stay below a hundred.
const MOST_UPDATES: usize = 1000;

/// Signals whose edges start motions, in the order in which they do.
const STARTS: [Input; 5] = [
    Input::MoveStart,
    Input::SegmentStart,
    Input::SegmentStep,
    Input::SegmentRun,
    Input::InterruptStart,
];

/// The parts of a drive.
#[derive(Debug)]
pub(super) struct Parts {
    pub(super) registers: Registers,
    pub(super) comms: Comms,
    pub(super) inputs: InputSignals,
    pub(super) power: PowerStage,
    pub(super) axis: Axis,
    pub(super) faults: DeviceFaults,
    pub(super) no_effect: NoEffectReports,
    pub(super) effects: EffectQueue,
    /// When the last thing happened to it.
    pub(super) now: Instant,
    /// Has it supply?
    pub(super) powered: bool,
    /// A master has asked for a restart of the whole device, which only the bus knows.
    pub(super) restart: bool,
    /// What the request under way has ordered.
    pub(super) issued: Option<IssuedCommand>,
    /// What is still to be brought up to date, the next last.
    pending: Vec<Update>,
}

impl Parts {
    /// Without supply at `now`, as the bench sets them up.
    pub(super) fn new(model: Arc<Model>, setup: &Setup, now: Instant) -> Self {
        let off = PowerControl::Levels(LevelControl::default());
        Self {
            comms: Comms::new(setup.switches),
            inputs: InputSignals::new(&model, setup.terminals),
            power: PowerStage::power_on(now, Duration::ZERO, off),
            axis: Axis::new(&model, setup, now),
            faults: DeviceFaults::default(),
            no_effect: NoEffectReports::new(&model.wiring),
            effects: EffectQueue::new(),
            now,
            powered: false,
            restart: false,
            issued: None,
            pending: Vec::with_capacity(16),
            registers: Registers::new(model, setup),
        }
    }

    /// As they are at `now`.
    pub(super) fn at(&self, now: Instant) -> View<'_> {
        let axis = self.axis.at(self.context(now));
        View::new(axis, &self.inputs, &self.comms, self.powered)
    }

    /// What parts see of each other at `now`.
    pub(super) fn context(&self, now: Instant) -> DriveContext<'_> {
        DriveContext {
            now,
            registers: &self.registers,
            inputs: self.inputs.active(),
            power: &self.power,
            faults: &self.faults,
        }
    }

    /// The axis, what it sees of the others, and where its effects go.
    pub(super) fn split(&mut self) -> (DriveContext<'_>, &mut Axis, &mut EffectQueue) {
        let Self { registers, inputs, power, faults, axis, effects, now, .. } = self;
        let inputs = inputs.active();
        (DriveContext { now: *now, registers, inputs, power, faults }, axis, effects)
    }

    /// The input signals, the axis with the switches that it moves, and where effects go.
    pub(super) fn split_inputs(&mut self) -> (AxisView<'_>, &mut InputSignals, &mut EffectQueue) {
        let Self { registers, inputs, power, faults, axis, effects, now, .. } = self;
        let active = inputs.active();
        let cx = DriveContext { now: *now, registers, inputs: active, power, faults };
        (axis.at(cx), inputs, effects)
    }

    /// What tells of orders without effect, what it looks at, and where its effects go.
    pub(super) fn split_no_effect(&mut self) -> (View<'_>, &mut NoEffectReports, &mut EffectQueue) {
        let Self { registers, inputs, power, faults, axis, comms, effects, no_effect, .. } = self;
        let active = inputs.active();
        let cx = DriveContext { now: self.now, registers, inputs: active, power, faults };
        (View::new(axis.at(cx), inputs, comms, self.powered), no_effect, effects)
    }

    /// Brings up to date what may have changed, and everything that follows from it.
    ///
    /// # Panics
    /// In a debug build, if there are more than [`MOST_UPDATES`]. A release build leaves the rest as it is.
    pub(super) fn update(&mut self, what: Update) {
        debug_assert!(self.pending.is_empty(), "updates are carried out one at a time");
        self.pending.push(what);
        for _ in 0..MOST_UPDATES {
            let Some(next) = self.pending.pop() else { return };
            self.carry_out(next);
        }
        debug_assert!(self.pending.is_empty(), "an endless loop: {:?}", self.pending);
        self.pending.clear();
    }

    fn carry_out(&mut self, update: Update) {
        match update {
            Update::Inputs => self.update_inputs(),
            Update::Axis => {
                if self.powered {
                    self.retrip();
                    let (cx, axis, _) = self.split();
                    axis.follow_direction(cx);
                    self.pending.extend([Update::Switches, Update::FirstEnable, Update::Motor]);
                }
            }
            Update::Motor => self.update_motor(),
            Update::FirstEnable => {
                let (cx, axis, _) = self.split();
                if axis.take_first_enable(cx) {
                    self.pending.push(Update::Home(HomeStarter::FirstEnable));
                }
            }
            Update::Switches => {
                if self.axis.take_switch_edge(self.now) {
                    self.pending.push(Update::Inputs);
                }
            }
            Update::Home(starter) => self.home(starter),
            Update::Start(input) => self.start(input),
            Update::Chain => {
                let (cx, axis, out) = self.split();
                if let Some(started) = axis.advance_chain(cx, out) {
                    self.report_start(started);
                    self.pending.push(Update::Axis);
                }
            }
            Update::NotSimulated => {
                let (view, no_effect, out) = self.split_no_effect();
                no_effect.report_not_simulated(view, out);
            }
        }
    }

    /// Looks at every source of input signals, and has the others follow.
    fn update_inputs(&mut self) {
        if !self.powered {
            return;
        }
        let now = self.inputs.gather(self.axis.at(self.context(self.now)));
        let before = self.inputs.set_active(now);
        let risen = now.risen_since(before);
        let (view, no_effect, _) = self.split_no_effect();
        no_effect.note_inputs(view, before);
        self.report_redundant(risen);
        if now.has(Input::AlarmForce) {
            let order = risen.has(Input::AlarmForce).then_some(Ordered::Input(Input::AlarmForce));
            self.trip_by(AlarmCause::Forced, order);
        }
        self.retrip();
        if risen.has(Input::AlarmReset) {
            let done = self.power.reset();
            self.report_power();
            self.report_edge(Input::AlarmReset, done);
        }
        self.power.set_levels(PowerLevels {
            enable: now.has(Input::ServoOn),
            release: now.has(Input::Release),
            inhibit: now.has(Input::EnableInhibit),
        });
        self.report_power();
        if before.risen_since(now).has(Input::ServoOn) && self.power.is_latched_on() {
            self.ignore(Ordered::InputOff(Input::ServoOn), Ignored::Latched);
        }
        let (cx, axis, _) = self.split();
        axis.select_velocity(cx);
        self.pending.push(Update::NotSimulated);
        let starts = STARTS.into_iter().rev().filter(|it| risen.has(*it));
        self.pending.extend(starts.map(Update::Start));
        if risen.has(Input::HomeStart) {
            self.pending.push(Update::Home(HomeStarter::Input));
        }
        self.pending.push(Update::Axis);
    }

    /// Tells of signals that ask for what is so already.
    fn report_redundant(&mut self, risen: Inputs) {
        let (axis, enabled) = (self.axis.at(self.context(self.now)), self.power.is_enabled());
        let so = [
            (Input::ServoOn, enabled.then_some(Ignored::AlreadyOn)),
            (Input::Release, (!enabled).then_some(Ignored::AlreadyOff)),
            (Input::Stop, axis.why_no_stop(false)),
            (Input::QuickStop, axis.why_no_stop(true)),
            (Input::InterruptUnlock, (!axis.can_unlock_interrupt()).then_some(Ignored::NotLocked)),
        ];
        for (input, why) in so {
            if let Some(why) = why.filter(|_| risen.has(input)) {
                self.ignore(Ordered::Input(input), why);
            }
        }
    }

    fn update_motor(&mut self) {
        let (cx, axis, _) = self.split();
        let followed = axis.follow(cx);
        let changed = self.report_axis(followed.segment);
        let (cx, axis, _) = self.split();
        axis.settle_segments(cx, followed.free);
        // An axis that has braked for an alarm and stands is switched off.
        let braked = self.power.is_braking() && !self.is_moving();
        if braked {
            self.power.braked();
            self.report_power();
        }
        if braked || changed {
            self.pending.push(Update::Motor);
        }
    }

    /// Looks for the origin, or tells why not.
    fn home(&mut self, starter: HomeStarter) {
        let (cx, axis, out) = self.split();
        let done = axis.home(cx, out, starter);
        self.report_axis(None);
        match (starter, done) {
            (HomeStarter::Input, done) => self.report_edge(Input::HomeStart, done),
            (_, Err(why)) => self.ignore(Ordered::Action(Action::HomeStart), why),
            (_, Ok(())) => {}
        }
        self.pending.push(Update::Axis);
    }

    /// Starts what an edge of `input` asks for, or tells why not.
    fn start(&mut self, input: Input) {
        self.pending.push(Update::Axis);
        let (cx, axis, _) = self.split();
        let done = match input {
            Input::SegmentStep => {
                let done = axis.step_chain(cx.now);
                self.pending.extend(done.is_ok().then_some(Update::Chain));
                done
            }
            _ => axis.start_by_input(cx, input).map(|started| self.report_start(started)),
        };
        self.report_edge(input, done);
    }

    /// Reports a motion that has started.
    fn report_start(&mut self, started: axis::SegmentStart) {
        self.report_axis(started.segment);
        if let Some(at) = started.endless {
            let end = ChainEnd { decoder: self.registers.decoder(), at, why: Ignored::NoMotion };
            self.effects.change(DriveEvent::ChainEnded(end));
        }
    }

    /// Reports what the power stage has reported.
    pub(super) fn report_power(&mut self) {
        while let Some(effect) = self.power.poll_effect() {
            self.report(effect, None);
        }
    }

    /// Reports what the axis has reported, which is about a segment where `segment` says so, and acts on it. Has that changed
    /// what is wanted of the axis?
    pub(super) fn report_axis(&mut self, segment: Option<u16>) -> bool {
        let mut changed = false;
        while let Some(effect) = self.axis.poll_effect() {
            self.report(effect, segment);
            changed |= self.act_on(effect);
        }
        changed
    }

    fn report(&mut self, effect: Effect, segment: Option<u16>) {
        let (cx, axis, out) = self.split();
        axis::change(axis, cx, effect, segment).into_iter().for_each(|it| out.change(it));
    }

    fn act_on(&mut self, effect: Effect) -> bool {
        let (cx, axis, out) = self.split();
        match effect {
            Effect::HomingDone(origin) => {
                let change = axis.finish_home(cx, origin);
                out.change(change);
                self.registers.end_home_commands();
                true
            }
            Effect::HomingAborted { why, forward, alarm } => {
                self.registers.end_home_commands();
                alarm
                    && self.trip(match (why, forward) {
                        (HomeEnd::TimeLimit, _) => AlarmCause::HomingTime,
                        (_, true) => AlarmCause::HomingLimitPos,
                        (_, false) => AlarmCause::HomingLimitNeg,
                    })
            }
            Effect::DeviationExceeded => self.trip(AlarmCause::PositionDeviation),
            Effect::Stopping | Effect::LimitReached { .. } => {
                axis.take_stop_settings(cx);
                false
            }
            Effect::Replanned(_) | Effect::MovePaused | Effect::MoveResumed(_) => {
                axis.sample_places(cx);
                false
            }
            _ => false,
        }
    }

    /// `part` is due.
    pub(super) fn wake(&mut self, part: TimerOwner) {
        match part {
            TimerOwner::PowerStage => {
                self.power.advance(self.now);
                self.report_power();
            }
            TimerOwner::Contacts => {
                let (axis, inputs, out) = self.split_inputs();
                inputs.bounce(axis, out);
                self.update(Update::Inputs);
            }
            TimerOwner::Switches => self.update(Update::Switches),
            TimerOwner::Axis => {
                self.axis.advance(self.now);
                self.report_axis(None);
            }
            TimerOwner::InputWords => self.expire_words(),
            // The next master who speaks starts the time anew.
            TimerOwner::Comms => {
                if self.comms.take_silence(self.now) {
                    self.trip(AlarmCause::CommTimeout);
                }
            }
        }
    }

    /// Trips with `cause`, if the model has an alarm for it. Returns whether it has.
    pub(super) fn trip(&mut self, cause: AlarmCause) -> bool {
        let Some(alarm) = self.registers.model().wiring.alarm(cause) else { return false };
        let (code, stop) = (alarm.code, alarm.stop);
        let trip = Trip { cause, code, resettable: alarm.resettable };
        let (is_first, was_braking) = (self.power.alarm().is_none(), self.power.is_braking());
        let brakes = stop != AlarmStop::Coast && self.is_moving();
        self.axis.abort_homing();
        self.power.trip(trip, brakes);
        self.report_power();
        if is_first {
            self.registers.remember_alarm(code);
        }
        if self.power.is_braking() && !was_braking {
            let (cx, axis, _) = self.split();
            axis.brake(cx, stop);
            self.report_axis(None);
        }
        true
    }

    /// Trips with `cause` because of `order`, and says so where that has no effect: an alarm is active, and the axis
    /// stops for it as before. Returns whether the model has an alarm for it.
    pub(super) fn trip_by(&mut self, cause: AlarmCause, order: Option<Ordered>) -> bool {
        let (active, braking) = (self.power.alarm().is_some(), self.power.is_braking());
        let tripped = self.trip(cause);
        let same = tripped && active && braking == self.power.is_braking();
        if let Some(order) = order.filter(|_| same) {
            self.ignore(order, Ignored::Alarm);
        }
        tripped
    }

    /// Trips again with what is there and has no alarm.
    fn retrip(&mut self) {
        let causes = self.faults.active_causes(self.inputs.active());
        self.power.set_active_causes(causes);
        if self.power.alarm().is_none() {
            for cause in AlarmCause::ALL.iter().filter(|cause| causes.has(**cause)) {
                self.trip(*cause);
            }
        }
    }

    pub(super) fn is_moving(&self) -> bool {
        self.axis.is_moving()
    }

    /// Tells of an order that has no effect.
    pub(super) fn ignore(&mut self, order: Ordered, why: Ignored) {
        let (cx, _, out) = self.split();
        cx.ignore(out, order, why);
    }

    /// Tells of an edge of `input` that has no effect, if it has none.
    fn report_edge(&mut self, input: Input, done: Result<(), Ignored>) {
        let (view, no_effect, out) = self.split_no_effect();
        no_effect.report_edge(view, out, input, done);
    }

    /// Tells of signals that have no effect, once everything of this instant is done.
    pub(super) fn report_inactive(&mut self) {
        let (view, no_effect, out) = self.split_no_effect();
        no_effect.report_inactive(view, out);
    }

    /// A master spoke to this drive.
    pub(super) fn on_request(&mut self) {
        self.comms.on_request(self.now, &self.registers);
    }

    /// Lets input words fall back that were not refreshed in time.
    pub(super) fn expire_words(&mut self) {
        let Self { registers, inputs, effects, .. } = self;
        if inputs.expire_words(self.now, registers, effects) {
            self.update(Update::Inputs);
        }
    }
}
