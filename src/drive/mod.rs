//! One station of a drive: the only place that sees registers and behaviours.
//!
//! It is made of parts that own their fields and their deadlines: registers, comms, input signals, power stage, axis, device
//! faults, and what was told of orders without effect. What they share at an instant is handed to them
//! (`context.rs`), and what comes of it goes into one queue. A request becomes a plan, the plan is committed, and what
//! the written rows are wired to follows (`orders.rs`, `parts.rs`). What a row shows is computed when somebody looks
//! (`view.rs`). It knows no bytes on a line and no other drive.

mod acts;
mod axis;
mod comms;
mod context;
mod device_faults;
mod effects;
mod inputs;
mod no_effect;
mod orders;
mod outputs;
mod parts;
mod registers;
mod setup;
mod timer;
mod view;

pub use effects::DriveEffect;
pub use setup::{IssuedCommand, Setup};
pub use timer::Timer;
pub use view::View;

use crate::bank::{Bank, Causes, Gate, Kept};
use crate::behaviour::{CommandControl, LevelControl, MotorTimer, PowerControl, PowerStage};
use crate::event::{Decoder, DeviceFault, DeviceFaultChange, DriveEvent, Ignored, Ordered};
use crate::model::{Model, Shows};
use crate::motion::first_equal;
use crate::serial::Mode;
use crate::time::{Duration, Instant};
use crate::units::Unit;
use crate::vocabulary::{Action, AlarmCause, Cause, Detail, Refusal, RowId};
use crate::wire::{Request, Response, Span, Words};
use device_faults::FrozenFeedback;
use parts::{Parts, Update};
use std::cmp::Ordering;
use std::sync::Arc;
use timer::TimerOwner;

/// One station of a drive.
#[derive(Debug)]
pub struct Drive {
    parts: Parts,
    read: [u16; 125],
}

impl Drive {
    /// A drive of `model` as the bench sets it up, switched on at `now`.
    pub fn new(model: Arc<Model>, setup: &Setup, now: Instant) -> Self {
        let mut drive = Self { parts: Parts::new(model, setup, now), read: [0; 125] };
        drive.parts.powered = true;
        drive.power_on();
        drive
    }

    /// The model.
    pub fn model(&self) -> &Arc<Model> {
        self.parts.registers.model()
    }

    /// Which station of its device, from 0.
    pub fn station(&self) -> usize {
        self.parts.registers.station()
    }

    /// The unit address in force.
    pub fn unit(&self) -> u8 {
        self.parts.comms.unit()
    }

    /// The cells of its registers, which do not hold what the drive computes.
    pub fn bank(&self) -> &Bank {
        self.parts.registers.bank()
    }

    /// The unit of a row. That of a speed may be finer than the model says, where a row decides.
    pub fn unit_of(&self, row: RowId) -> Unit {
        self.parts.registers.unit_of(row)
    }

    /// How its requests, replies and values read at present, for the events that tell of them.
    pub fn decoder(&self) -> Decoder {
        self.parts.registers.decoder()
    }

    /// What it keeps over power-off.
    pub fn kept(&self) -> Kept {
        self.parts.registers.kept()
    }

    /// Has something been stored since this was asked last?
    pub fn take_stored(&mut self) -> bool {
        self.parts.registers.take_unsaved()
    }

    /// The mode that it talks in. `None` where a parameter held an undefined code when it took effect: such a drive is
    /// unreachable.
    pub fn mode(&self) -> Option<Mode> {
        self.parts.comms.mode()
    }

    /// Has it supply?
    pub fn is_powered(&self) -> bool {
        self.parts.powered
    }

    /// Has a master asked for a restart of the device since this was asked last?
    pub fn take_restart(&mut self) -> bool {
        std::mem::take(&mut self.parts.restart)
    }

    /// The order that the last request gave, if it gave one that does something each time.
    pub fn issued(&self) -> Option<IssuedCommand> {
        self.parts.issued
    }

    /// What has come out of it next, in order.
    pub fn poll_effect(&mut self) -> Option<DriveEffect> {
        self.parts.effects.pop()
    }

    /// The drive as it is at `now`: not before what has happened to it, and not after what will happen next by itself.
    pub fn at(&self, now: Instant) -> View<'_> {
        self.parts.at(now)
    }

    /// The first instant after `now` at which what `side` looks at is equal to what is waited for, before the next
    /// deadline and if nobody asks the drive for anything meanwhile.
    ///
    /// A number is met to the count also where the axis only passes it. A signal that is on only while speed or deviation
    /// pass through a window is missed where that takes less than a sixteenth of a ramp.
    pub fn next_time_when(
        &self,
        now: Instant,
        side: impl Fn(View<'_>) -> Ordering,
    ) -> Option<Instant> {
        let end = self.next_timer().map(|(at, _)| at);
        let marks = self.parts.axis.at(self.parts.context(now)).marks();
        let side = |at| side(self.at(at));
        first_equal(now, &marks, side).filter(|at| end.is_none_or(|end| *at < end))
    }

    /// Answers a request that arrived at `now`, or says why not.
    ///
    /// # Errors
    /// The refusal that the model puts first among all the causes that hold.
    pub fn request(&mut self, now: Instant, pdu: &[u8]) -> Result<Response<'_>, Refusal> {
        self.advance_to(now);
        self.parts.on_request();
        self.parts.issued = None;
        let line = &self.parts.registers.model().line;
        if let Some(function) = pdu.first().filter(|it| !line.functions.contains(it)) {
            let causes = Causes::of(Cause::Function, Detail::Function(*function));
            return Err(self.refuse(causes));
        }
        match Request::parse(pdu, line.length_check) {
            Ok(Request::Read(span)) => self.answer_read(span),
            Ok(Request::WriteOne { address, value }) => {
                self.write(Span::one(address), value)?;
                Ok(Response::WriteOne { address, value: value.get(0).unwrap_or(0) })
            }
            Ok(Request::WriteMany { span, values }) => {
                self.write(span, values)?;
                Ok(Response::WriteMany(span))
            }
            Ok(Request::MaskWrite { address, masks }) => {
                let word = masks.apply(self.parts.registers.word_at(address)).to_be_bytes();
                self.write(Span::one(address), Words::one(&word))?;
                Ok(Response::MaskWrite { address, masks })
            }
            Err(malformed) => Err(self.refuse(Causes::of_malformed(pdu, malformed, line))),
        }
    }

    fn answer_read(&mut self, span: Span) -> Result<Response<'_>, Refusal> {
        let Self { parts, read } = self;
        let (bank, model) = (parts.registers.bank(), parts.registers.model());
        let plan = bank.plan_read(model, span)?;
        let view = parts.at(parts.now);
        let (dark, mut seen) = (parts.no_effect.dark(&parts.registers), 0);
        let show = |row| {
            if dark != 0
                && let Some(Shows::OutputWord(word)) = model.wiring.shows(row)
            {
                seen |= dark & 1 << word;
            }
            view.show(row)
        };
        let len = plan.read(bank, model, show, read);
        let (view, no_effect, out) = parts.split_no_effect();
        no_effect.note_read(view.axis().context(), out, seen);
        Ok(Response::Read(&read[..len]))
    }

    fn write(&mut self, span: Span, words: Words<'_>) -> Result<(), Refusal> {
        let gate = Gate { enabled: self.parts.power.is_enabled() };
        let registers = &mut self.parts.registers;
        let plan = registers.bank().plan_write(registers.model(), span, words, gate)?;
        registers.commit(self.parts.now, &plan, &mut self.parts.effects);
        self.parts.react(&plan);
        Ok(())
    }

    fn refuse(&self, causes: Causes) -> Refusal {
        let refusal = causes.refusal(&self.parts.registers.model().line.refuse);
        refusal.expect("the model was checked: each cause that it can meet has a rung")
    }

    /// Trips with `cause` at `now`, if the model has an alarm for it.
    ///
    /// Returns whether it has.
    pub fn raise(&mut self, now: Instant, cause: AlarmCause) -> bool {
        self.advance_to(now);
        let tripped = self.parts.trip_by(cause, Some(Ordered::Raise(cause)));
        self.parts.update(Update::Axis);
        self.parts.report_inactive();
        tripped
    }

    /// Puts a signal on input terminal `index` at `now`, or takes it off.
    pub fn set_terminal(&mut self, now: Instant, index: u8, signal: bool) {
        self.advance_to(now);
        let order = Ordered::Terminal { index, on: signal };
        if self.parts.inputs.terminal(index) == signal {
            return self.parts.ignore(order, Ignored::AlreadySo);
        }
        self.parts.inputs.set_terminal(index, signal);
        let terminal = self.parts.registers.terminal_name(index);
        self.parts.effects.change(DriveEvent::Terminal { terminal, signal });
        let before = self.parts.inputs.active();
        self.parts.update(Update::Inputs);
        if let Some(why) = acts::why_no_signal(self.at(self.parts.now), index, before) {
            self.parts.ignore(order, why);
        }
        self.parts.report_inactive();
    }

    /// Has the contact on input terminal `index` leave its level and come back so many `times`, each edge
    /// `every` after the one before; both are above 0. One that bounces already begins anew.
    pub fn bounce_terminal(&mut self, now: Instant, index: u8, times: u16, every: Duration) {
        self.advance_to(now);
        let terminal = self.parts.registers.terminal_name(index);
        self.parts.effects.change(DriveEvent::Bouncing { terminal, times, every });
        self.parts.inputs.set_bounce(now, index, times, every);
        self.advance_to(now);
    }

    /// Something is wrong from `now` on, or no longer.
    ///
    /// Returns whether that can be: a cause needs an alarm of the model.
    pub fn set_device_fault(&mut self, now: Instant, device_fault: DeviceFault, on: bool) -> bool {
        self.advance_to(now);
        if let DeviceFault::Cause(cause) = device_fault
            && self.model().wiring.alarm(cause).is_none()
        {
            return false;
        }
        let is_so = match device_fault {
            DeviceFault::Blocked => self.parts.axis.is_blocked(),
            DeviceFault::Stuck(index) => self.parts.inputs.is_stuck(index),
            fault => self.parts.faults.has(fault),
        };
        if is_so != on {
            let (decoder, fault) = (self.decoder(), device_fault);
            let change = DeviceFaultChange { decoder, fault, on };
            self.parts.effects.change(DriveEvent::DeviceFault(change));
            self.change_device_fault(device_fault, on);
            self.parts.report_axis(None);
            self.parts.update(Update::Inputs);
            self.parts.update(Update::Axis);
            self.parts.report_inactive();
        }
        true
    }

    fn change_device_fault(&mut self, fault: DeviceFault, on: bool) {
        match fault {
            DeviceFault::Blocked => self.parts.axis.set_blocked(self.parts.now, on),
            DeviceFault::Stuck(index) => {
                let (axis, inputs, _) = self.parts.split_inputs();
                inputs.set_stuck(axis, index, on);
            }
            fault => {
                let cause = self.parts.faults.set(fault, on);
                if let Some(cause) = cause.filter(|_| self.parts.powered) {
                    self.parts.trip(cause);
                }
            }
        }
        let axis = self.parts.axis.at(self.parts.context(self.parts.now));
        let seen = FrozenFeedback { position: axis.seen_position(), speed: axis.seen_speed() };
        self.parts.faults.freeze(seen);
    }

    /// Power off and on. What moved stands.
    pub fn power_cycle(&mut self, now: Instant) {
        self.advance_to(now);
        self.parts.registers.power_cycle();
        self.parts.powered = true;
        self.power_on();
    }

    /// Power off. What moved coasts, and nobody answers.
    pub fn power_off(&mut self, now: Instant) {
        self.advance_to(now);
        if !std::mem::take(&mut self.parts.powered) {
            return;
        }
        self.parts.effects.change(DriveEvent::PowerOff);
        self.parts.power.power_off();
        self.parts.report_power();
        self.parts.inputs.stop_words();
        self.parts.comms.power_off();
        self.parts.axis.power_off(now);
        self.parts.report_axis(None);
    }

    fn power_on(&mut self) {
        self.parts.power.power_off();
        self.parts.report_power();
        self.parts.registers.power_on();
        let control = power_control(self.parts.registers.model());
        let ready_after = self.parts.registers.model().wiring.servo.ready_after;
        self.parts.power = PowerStage::power_on(self.parts.now, ready_after, control);
        let (cx, axis, _) = self.parts.split();
        axis.power_on(cx);
        self.parts.no_effect.power_on();
        self.parts.inputs.stop_words();
        // What is active from the start has not risen.
        let active =
            self.parts.inputs.gather(self.parts.axis.at(self.parts.context(self.parts.now)));
        self.parts.inputs.set_active(active);
        let moved = self.parts.comms.power_on(&self.parts.registers);
        self.parts.effects.change(DriveEvent::PowerOn);
        moved.into_iter().for_each(|change| self.parts.effects.change(change));
        self.parts.update(Update::Inputs);
        self.parts.power.advance(self.parts.now);
        self.parts.report_power();
        self.parts.update(Update::Axis);
        let (view, no_effect, _) = self.parts.split_no_effect();
        no_effect.power_on_inputs(view);
    }

    /// Lets time pass up to `now`: every deadline until then happens at its own instant.
    pub fn advance_to(&mut self, now: Instant) {
        while let Some((at, _)) = self.next_timer().filter(|(at, _)| *at <= now) {
            self.parts.now = self.parts.now.max(at);
            TimerOwner::ALL.into_iter().for_each(|part| self.wake_if_due(part));
            self.parts.update(Update::Axis);
            // What happened may be what the chain waits for.
            if self.parts.axis.chain_due_at().is_some_and(|at| at <= self.parts.now) {
                self.parts.effects.woken(Timer::Chain);
                self.parts.update(Update::Chain);
            }
            self.parts.report_inactive();
        }
        self.parts.now = self.parts.now.max(now);
    }

    /// Wakes `part` if it is due.
    fn wake_if_due(&mut self, part: TimerOwner) {
        let mut last = None;
        let is_due = |at: Instant, timer: Timer, last| {
            at <= self.parts.now && timer.wakes() == Some(part) && Some(timer) > last
        };
        while let Some(timer) = {
            let timers = self.timers(self.parts.axis.timers());
            timers.filter(|(at, it)| is_due(*at, *it, last)).map(|(_, it)| it).min()
        } {
            last = Some(timer);
            self.parts.effects.woken(timer);
        }
        if last.is_some() {
            self.parts.wake(part);
        }
    }

    /// What will happen next by itself, and when.
    pub fn next_timer(&self) -> Option<(Instant, Timer)> {
        self.timers(self.parts.axis.next_timer()).min()
    }

    /// All its deadlines, in any order; of those of its axis, `of_axis`.
    fn timers(
        &self,
        of_axis: impl IntoIterator<Item = (Instant, MotorTimer)>,
    ) -> impl Iterator<Item = (Instant, Timer)> {
        let ready = self.parts.power.ready_at().map(|at| (at, Timer::Ready));
        let axis = of_axis.into_iter().map(|(at, timer)| (at, Timer::Axis(timer)));
        let chain = self.parts.axis.chain_due_at().map(|at| (at, Timer::Chain));
        let others = ready.into_iter().chain(axis).chain(chain);
        others.chain(self.parts.inputs.timers()).chain(self.parts.comms.timer())
    }

    /// When the first watchdog expires if the master says no more.
    pub fn watchdog_at(&self) -> Option<Instant> {
        self.parts.inputs.word_timers().chain(self.parts.comms.timer()).map(|(at, _)| at).min()
    }
}

/// What asks for the power stage of a model: commands, where it has them, or signals alone.
fn power_control(model: &Model) -> PowerControl {
    let wiring = &model.wiring;
    let is_order = |action: &Action| matches!(action, Action::Enable | Action::Release);
    let values = wiring.commands.iter().flat_map(|it| &it.actions).map(|(_, action)| action);
    let bits = wiring.triggers.iter().flat_map(|it| &it.actions).map(|(_, action)| action);
    let on = wiring.servo.enabled_at_power_on;
    match on || values.chain(bits).any(is_order) {
        true => PowerControl::Commands(CommandControl::new(on)),
        false => PowerControl::Levels(LevelControl::default()),
    }
}
