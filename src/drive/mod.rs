//! One station of a drive: the only place that sees registers and behaviours.
//!
//! It keeps the time up to which everything has happened to it; a position is that of this instant.
//! A request becomes a plan, the plan is committed, and what the written rows are wired to reacts
//! (`react.rs`). What a row shows is computed when somebody looks (`show.rs`). It knows no bytes on a line and no
//! other drive.

mod alarms;
mod comms;
mod course;
mod device_faults;
mod gear;
mod home;
mod interrupt;
mod issued;
mod levels;
mod memory;
mod motion;
mod next_time;
mod no_effect;
mod not_simulated;
mod react;
mod segments;
mod settings;
mod setup;
mod show;
mod signals;
mod timer;
mod view;
mod windows;

pub use issued::IssuedCommand;
pub use setup::Setup;
pub use timer::Timer;
pub use view::View;

use crate::bank::{Bank, Causes, Gate, word_of};
use crate::behaviour::{Chain, LevelControl, Motor, PowerControl, PowerStage, Watchdog};
use crate::event::{Change, Ignored, Ordered};
use crate::model::{Located, Model};
use crate::serial::Mode;
use crate::time::Instant;
use crate::vocabulary::{Action, AlarmCause, Cause, Detail, Inputs, Modifiers, Refusal};
use crate::wire::{Request, Response, Span, Words};
use comms::Comms;
use course::Course;
use device_faults::DeviceFaults;
use interrupt::Interrupt;
use levels::Velocity;
use memory::Memory;
use no_effect::NoEffect;
use settings::Moment;
use std::cell::Cell;
use std::collections::VecDeque;
use std::sync::Arc;
use timer::Sleeper;

/// One station of a drive.
#[derive(Debug)]
pub struct Drive {
    model: Arc<Model>,
    station: usize,
    /// Up to here everything has happened.
    now: Instant,
    /// Values that the bench gave it; they survive a factory reset no more than a real user's do.
    bank: Bank,
    memory: Memory,
    /// Has it supply?
    powered: bool,
    device_faults: DeviceFaults,
    power_stage: PowerStage,
    /// Watchdogs of the input words.
    word_watchdogs: Vec<Watchdog>,
    comms: Comms,
    /// Signals on the input terminals, bit by bit.
    terminals: u16,
    inputs: Inputs,
    motor: Motor,
    /// What the motion under way goes by.
    course: Option<Course>,
    /// The values of settings that count, by slot, as far as they are not live: in the base unit of each.
    taken: Vec<f64>,
    /// Counts for one revolution: what the row says when the axis stands.
    counts_per_rev: f64,
    /// The velocity segment that is active.
    velocity: Option<Velocity>,
    /// Number of the position segment that started last.
    segment: u16,
    chain: Chain,
    interrupt: Interrupt,
    /// Do its positive counts go the machine's negative way? Then so do those of its motor.
    reversed: bool,
    /// Where the motor is when the position register says 0.
    zero: i64,
    /// Revolutions of the encoder when its turns were cleared; a battery keeps them over power-off.
    cleared_turns: i64,
    /// Has an origin been found since power came on?
    home_done: bool,
    /// Number of the last homing method.
    method: i64,
    /// Has the power stage not been on since power came on?
    never_enabled: bool,
    /// What the position is called whenever power comes on: there is no absolute encoder.
    position_at_power_on: i64,
    /// What was told of orders that have no effect.
    no_effect: NoEffect,
    /// Functions that are not simulated and of which the log has told since power came on, as bits by index.
    told_not_simulated: u64,
    changes: VecDeque<Change>,
    /// What has woken it, since somebody asked.
    woken: VecDeque<Timer>,
    /// A master has asked for a restart of the whole device, which only the bus knows.
    restart: bool,
    /// What the request under way has ordered.
    issued: Option<IssuedCommand>,
    read: [u16; 125],
}

impl Drive {
    /// A drive of `model` as the bench sets it up, switched on at `now`.
    pub fn new(model: Arc<Model>, setup: &Setup, now: Instant) -> Self {
        let mut bank = Bank::new(&model, setup.station);
        bank.recall(&model, &setup.kept);
        setup.values.iter().for_each(|(row, raw)| bank.preset(&model, *row, *raw));
        let words = model.wiring.input_words.as_ref().map_or(0, |words| words.rows.len());
        let mut drive = Self {
            power_stage: PowerStage::power_on(
                now,
                Default::default(),
                PowerControl::Levels(LevelControl::default()),
            ),
            word_watchdogs: vec![Watchdog::default(); words],
            comms: Comms::new(setup.switches),
            motor: Motor::standing(
                now,
                setup.start as f64,
                model.wiring.axis.coast,
                setup.machine,
                None,
            ),
            course: None,
            taken: vec![0.0; model.wiring.axis.slots.into()],
            counts_per_rev: 1.0,
            velocity: None,
            segment: 0,
            chain: Chain::default(),
            interrupt: Interrupt::default(),
            reversed: false,
            zero: 0,
            cleared_turns: 0,
            home_done: false,
            method: 0,
            never_enabled: true,
            no_effect: NoEffect::new(&model.wiring),
            model,
            station: setup.station,
            now,
            bank,
            memory: Memory::default(),
            powered: true,
            device_faults: DeviceFaults::default(),
            terminals: setup.terminals,
            inputs: Inputs::default(),
            position_at_power_on: setup.position,
            told_not_simulated: 0,
            changes: VecDeque::with_capacity(8),
            woken: VecDeque::with_capacity(4),
            restart: false,
            issued: None,
            read: [0; 125],
        };
        drive.power_on(now);
        drive
    }

    /// The model.
    pub fn model(&self) -> &Arc<Model> {
        &self.model
    }

    /// Which station of its device, from 0.
    pub fn station(&self) -> usize {
        self.station
    }

    /// The unit address in force.
    pub fn unit(&self) -> u8 {
        self.comms.unit()
    }

    /// The values of its registers, for those who look from outside.
    pub fn bank(&self) -> &Bank {
        &self.bank
    }

    /// The mode that it talks in. `None` where a parameter held a code that stands for nothing when it took
    /// effect: such a drive hears nobody.
    pub fn mode(&self) -> Option<Mode> {
        self.comms.mode()
    }

    /// Answers a request that arrived at `now`, or says why not.
    pub fn request(&mut self, now: Instant, pdu: &[u8]) -> Result<Response<'_>, Refusal> {
        self.advance_to(now);
        self.hear();
        self.issued = None;
        if let Some(function) = pdu.first().filter(|it| !self.model.line.functions.contains(it)) {
            let causes = Causes::of(Cause::Function, Detail::Function(*function));
            return Err(self.refuse(causes));
        }
        match Request::parse(pdu, self.model.line.length_check) {
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
                let word = masks.apply(self.held_word(address)).to_be_bytes();
                self.write(Span::one(address), Words::one(&word))?;
                Ok(Response::MaskWrite { address, masks })
            }
            Err(malformed) => {
                Err(self.refuse(Causes::of_malformed(pdu, malformed, &self.model.line)))
            }
        }
    }

    /// Trips with `cause` at `now`, if the model has an alarm for it.
    ///
    /// Returns whether it has.
    pub fn raise(&mut self, now: Instant, cause: AlarmCause) -> bool {
        self.advance_to(now);
        let tripped = self.trip_by(cause, Some(Ordered::Raise(cause)));
        self.update_axis();
        self.explain();
        tripped
    }

    /// Puts a signal on input terminal `index` at `now`, or takes it off.
    pub fn set_terminal(&mut self, now: Instant, index: u8, signal: bool) {
        self.advance_to(now);
        let bit = 1 << index;
        let order = Ordered::Terminal { index, on: signal };
        if (self.terminals & bit != 0) == signal {
            return self.ignore(order, Ignored::AlreadySo);
        }
        self.terminals ^= bit;
        self.changes.push_back(Change::Terminal { index, signal });
        let before = self.inputs;
        self.gather_inputs();
        if let Some(why) = self.why_no_signal(index, before) {
            self.ignore(order, why);
        }
        self.explain();
    }

    /// Power off and on. What moved stands.
    pub fn power_cycle(&mut self, now: Instant) {
        self.advance_to(now);
        self.bank.power_cycle();
        self.powered = true;
        self.power_on(now);
    }

    /// Power off. What moved runs out, and nobody answers.
    pub fn power_off(&mut self, now: Instant) {
        self.advance_to(now);
        if !std::mem::take(&mut self.powered) {
            return;
        }
        self.changes.push_back(Change::PoweredOff);
        self.power_stage.power_off();
        self.report_power_stage();
        self.word_watchdogs.iter_mut().for_each(Watchdog::stop);
        self.comms.power_off();
        self.chain.end();
        self.motor.follow(now, Default::default());
        self.tell_stages(None);
    }

    /// Has it supply?
    pub fn is_powered(&self) -> bool {
        self.powered
    }

    /// Has a master asked for a restart of the device since this was asked last?
    pub fn take_restart(&mut self) -> bool {
        std::mem::take(&mut self.restart)
    }

    /// The order that the last request gave, if it gave one that does something each time.
    pub fn issued(&self) -> Option<IssuedCommand> {
        self.issued
    }

    /// Lets time pass up to `now`: every deadline until then happens at its own instant.
    pub fn advance_to(&mut self, now: Instant) {
        while let Some((at, _)) = self.next_timer().filter(|(at, _)| *at <= now) {
            self.now = self.now.max(at);
            Sleeper::ALL.into_iter().for_each(|part| self.wake(part));
            self.update_axis();
            self.advance_chain();
            self.explain();
        }
        self.now = self.now.max(now);
    }

    /// Wakes `part` if it is due.
    fn wake(&mut self, part: Sleeper) {
        let due = |(at, timer): &(Instant, Timer)| *at <= self.now && timer.wakes() == Some(part);
        let mut timers: Vec<_> = self.timers().filter(due).map(|(_, timer)| timer).collect();
        if timers.is_empty() {
            return;
        }
        timers.sort_unstable();
        self.woken.extend(timers);
        match part {
            Sleeper::PowerStage => {
                self.power_stage.advance(self.now);
                self.report_power_stage();
            }
            Sleeper::Contacts => self.bounce(),
            Sleeper::Switches => {
                if self.motor.take_switch_edge(self.now) {
                    self.gather_inputs();
                }
            }
            Sleeper::Axis => {
                self.motor.advance(self.now);
                self.tell_stages(None);
            }
            Sleeper::InputWords => self.expire_words(),
            Sleeper::Comms => self.end_silence(),
        }
    }

    /// What will happen next by itself, and when.
    pub fn next_timer(&self) -> Option<(Instant, Timer)> {
        self.timers().min()
    }

    /// All its deadlines, in any order.
    fn timers(&self) -> impl Iterator<Item = (Instant, Timer)> {
        let ready = self.power_stage.ready_at().map(|at| (at, Timer::Ready));
        let axis = self.motor.timers().map(|(at, timer)| (at, Timer::Axis(timer)));
        let chain = self.chain.deadline().map(|at| (at, Timer::Chain));
        let others = ready.into_iter().chain(axis).chain(chain);
        others.chain(self.device_faults.timers()).chain(self.watchdogs())
    }

    /// What a master keeps from expiring.
    fn watchdogs(&self) -> impl Iterator<Item = (Instant, Timer)> {
        let words = (0u8..).map(Timer::HoldWord).zip(&self.word_watchdogs);
        let words = words.filter_map(|(timer, word)| Some((word.deadline()?, timer)));
        words.chain(self.comms.silent_at().map(|at| (at, Timer::MasterSilence)))
    }

    /// When the first watchdog expires if the master says no more.
    pub fn watchdog_at(&self) -> Option<Instant> {
        self.watchdogs().map(|(at, _)| at).min()
    }

    /// The drive as it is at `now`: not before what has happened to it, and not after what will happen next by itself.
    pub fn at(&self, now: Instant) -> View<'_> {
        View::new(self, now)
    }

    /// The next change that has not been told yet.
    pub fn poll_change(&mut self) -> Option<Change> {
        self.changes.pop_front()
    }

    /// The next deadline that has woken it and that nobody was told of.
    pub fn poll_woken(&mut self) -> Option<Timer> {
        self.woken.pop_front()
    }

    fn answer_read(&mut self, span: Span) -> Result<Response<'_>, Refusal> {
        let plan = self.bank.plan_read(&self.model, span)?;
        let (mut read, dark) = (self.read, Cell::new(0));
        let show = |row| {
            self.dark_word(row).into_iter().for_each(|word| dark.set(dark.get() | 1 << word));
            self.show(self.now, row)
        };
        let len = plan.read(&self.bank, &self.model, show, &mut read);
        self.read = read;
        self.look_at_dark(dark.into_inner());
        Ok(Response::Read(&self.read[..len]))
    }

    /// The word at `address` that the register holds, whatever it shows; 0 where there is none.
    fn held_word(&self, address: u16) -> u16 {
        let Located::Word { row: id, word, .. } = self.model.map.locate(address) else { return 0 };
        let row = self.model.map.row(id);
        word_of(row, self.bank.order(&self.model, row), self.bank.raw(id), word)
    }

    fn write(&mut self, span: Span, words: Words<'_>) -> Result<(), Refusal> {
        let gate = Gate { enabled: self.power_stage.is_enabled() };
        let plan = self.bank.plan_write(&self.model, span, words, gate)?;
        self.bank.commit(&self.model, &plan);
        self.note_stored(&plan);
        self.react(&plan);
        Ok(())
    }

    fn refuse(&self, causes: Causes) -> Refusal {
        let refusal = causes.refusal(&self.model.line.refuse);
        refusal.expect("the model was checked: each cause that can occur has an exception code")
    }

    fn power_on(&mut self, now: Instant) {
        self.power_stage.power_off();
        self.report_power_stage();
        self.memory.power_on();
        let (servo, axis) = (self.model.wiring.servo, &self.model.wiring.axis);
        self.power_stage = PowerStage::power_on(now, servo.ready_after, self.power_control());
        self.motor = self.motor.switched_on(now, axis.coast, axis.position_gain);
        (self.home_done, self.never_enabled) = (false, true);
        self.told_not_simulated = 0;
        (self.course, self.velocity, self.segment) = (None, None, 0);
        self.counts_per_rev = self.counts_asked_for();
        self.take_settings(Moment::Start);
        self.interrupt = Interrupt::default();
        self.chain.end();
        self.word_watchdogs.iter_mut().for_each(Watchdog::stop);
        // What is active from the start has not risen.
        self.inputs = self.active_inputs(self.now);
        self.zero = self
            .seen_position(self.now)
            .saturating_sub(self.gear().counts(self.position_at_power_on));
        let moved = self.comms.power_on(&self.model, &self.bank);
        self.changes.push_back(Change::PoweredOn);
        self.changes.extend(moved);
        self.gather_inputs();
        self.power_stage.advance(now);
        self.report_power_stage();
        self.update_axis();
        self.begin_explaining();
    }

    /// Carries out `action`.
    ///
    /// # Errors
    /// Why it has no effect.
    fn act(&mut self, action: Action, modifiers: Modifiers) -> Result<(), Ignored> {
        if self.waits_for_rest(action) {
            return Err(Ignored::Moving);
        }
        let mut done = Ok(());
        match action {
            Action::QuickStop
            | Action::Stop
            | Action::HomeStart
            | Action::MoveStart
            | Action::RunStart => done = self.order(action, modifiers),
            Action::Enable => done = self.power_stage.order(true),
            Action::Release => done = self.power_stage.order(false),
            Action::AlarmReset => done = self.power_stage.reset(),
            Action::EncoderReset => done = self.power_stage.reset_of(AlarmCause::Encoder),
            Action::ClearAlarmHistory => self.forget_alarms(),
            Action::ClearPosition => {
                self.zero = self.seen_position(self.now);
                self.changes.push_back(Change::PositionCleared);
            }
            Action::ClearTurns => {
                self.cleared_turns = self.full_turns(self.now);
                self.changes.push_back(Change::TurnsCleared);
            }
            Action::StoreAll => {
                self.bank.store_all(&self.model);
                self.changes.push_back(Change::Stored);
                self.note_stored_all();
            }
            Action::RestoreFactory => {
                self.bank.restore_factory(&self.model, self.station);
                // Input words are 0 then, so there is nothing left to fall back.
                self.word_watchdogs.iter_mut().for_each(Watchdog::stop);
                self.hear();
                self.changes.push_back(Change::FactoryRestored);
                self.note_stored_all();
                self.gather_inputs();
                self.follow_line_settings();
            }
            Action::PowerCycle => self.restart = true,
        }
        self.report_power_stage();
        self.update_axis();
        done
    }
}
