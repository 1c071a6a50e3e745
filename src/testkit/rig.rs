//! One line with drives and a clock that moves only when told to.

use crate::bench::{
    Bench, BenchLine, BuiltinLibrary, Device, DeviceSpec, Library, LineBuilder, PortSpec, Saved,
    StateFile, WireSpec,
};
use crate::bus::{Bus, Carrier, Command, CommandError, LineCommand, LinkId, Output};
use crate::drive::View;
use crate::event::{DriveId, Event};
use crate::line::Framing;
use crate::medium::LineBehaviour;
use crate::model::{Choices, load};
use crate::problem::Problem;
use crate::scenario::{self, Director, Order, Verdict};
use crate::time::{Duration, Instant};
use crate::wire::{crc16, rtu};
use std::sync::Arc;

/// One line with drives under a virtual clock.
///
/// It is set up first (`with_...`), each time on a line that is switched on anew; then it is used.
#[derive(Debug)]
pub struct Rig {
    line: BenchLine,
    framing: Framing,
    seed: u64,
    /// The scenario as it was before its first step.
    scenario: Director,
    /// Something has happened to it since it was switched on: it can't be set up any more.
    used: bool,
    bus: Bus,
    director: Director,
    link: LinkId,
    now: Instant,
    events: Vec<Event>,
    log: Vec<String>,
}

/// A rig that has been handed over to a server.
#[cfg(feature = "cli")]
#[derive(Debug)]
pub(super) struct InUse {
    pub(super) name: String,
    pub(super) wire: WireSpec,
    pub(super) bus: Bus,
    pub(super) director: Director,
    pub(super) link: LinkId,
    pub(super) now: Instant,
    pub(super) events: Vec<Event>,
}

impl Rig {
    /// A line with one embedded model on it, as it leaves the factory and ready.
    ///
    /// # Errors
    /// If there is no such model.
    pub fn builtin(name: &str) -> Result<Self, Vec<Problem>> {
        let (_, text) = BuiltinLibrary
            .fetch(name)
            .map_err(|what| vec![Problem::value(Default::default(), what)])?;
        Self::model(&text, &Choices::new(), &DeviceSpec::default())
    }

    /// A line with one drive of the model in `text`.
    ///
    /// # Errors
    /// Everything that is wrong with the model or the settings.
    pub fn model(text: &str, choices: &Choices, spec: &DeviceSpec) -> Result<Self, Vec<Problem>> {
        let model = Arc::new(load(text, choices)?);
        let device = Device::new(model, spec).map_err(|problems| {
            let problem = |problem: crate::bench::SpecProblem| {
                Problem::value(Default::default(), problem.what).advise_if(problem.advice)
            };
            problems.into_iter().map(problem).collect::<Vec<_>>()
        })?;
        Ok(Self::line(LineBuilder::new("line", vec![device]).build_unmatched()))
    }

    /// The first line of a bench file. Its port is not opened.
    ///
    /// # Errors
    /// Everything that is wrong with the file.
    pub fn bench(text: &str, library: &dyn Library) -> Result<Self, Vec<Problem>> {
        let Bench { seed, lines } = crate::bench::parse(text, library)?;
        let line = lines.into_iter().next().expect("a bench that was read has a line");
        Ok(Self { seed: seed.unwrap_or(0), ..Self::off(line) }.switched_on())
    }

    /// A line as a bench describes it, with its framing, initialised.
    pub fn line(line: BenchLine) -> Self {
        Self::off(line).switched_on()
    }

    /// The same line with another framing.
    ///
    /// # Panics
    /// If the rig is in use.
    #[must_use]
    pub fn with_framing(mut self, framing: Framing) -> Self {
        self.must_be_new("with_framing");
        self.framing = framing;
        self.switched_on()
    }

    /// The same line with what the drives of another rig have kept: the text of [`state`](Self::state), or of a state
    /// file. Start values win over it, and on a line of a bench so do its speed and format.
    ///
    /// # Errors
    /// Everything that is wrong with the text, or with these drives for it.
    ///
    /// # Panics
    /// If the rig is in use.
    pub fn with_state(mut self, text: &str) -> Result<Self, Vec<Problem>> {
        self.must_be_new("with_state");
        let mut saved = Saved::read(text)?;
        for (i, device) in self.line.devices.iter_mut().enumerate() {
            saved.give(&self.line.name, i, device);
        }
        saved.finish()?;
        Ok(self.switched_on())
    }

    /// What the drives keep over power-off, as the text of a state file.
    pub fn state(&self) -> String {
        let mut state = StateFile::default();
        state.keep_all(&self.line.name, &self.bus);
        state.text()
    }

    /// The same line with another seed; without one it is 0.
    ///
    /// # Panics
    /// If the rig is in use.
    #[must_use]
    pub fn with_seed(mut self, seed: u64) -> Self {
        self.must_be_new("with_seed");
        self.seed = seed;
        self.switched_on()
    }

    /// The same line with a fault rule more, in compact form (`lose_reply:every=10`). On a rig in use:
    /// [`add_fault`](Self::add_fault).
    ///
    /// # Errors
    /// Everything that is wrong with the rule.
    ///
    /// # Panics
    /// If the rig is in use.
    pub fn with_fault(mut self, spec: &str) -> Result<Self, Vec<Problem>> {
        self.must_be_new("with_fault");
        self.line.add_fault(spec)?;
        Ok(self.switched_on())
    }

    /// The same line with other line behaviour. On a rig in use: [`LineCommand::SetBehaviour`].
    ///
    /// # Panics
    /// If the rig is in use.
    #[must_use]
    pub fn with_line_behaviour(mut self, line_behaviour: LineBehaviour) -> Self {
        self.must_be_new("with_line_behaviour");
        self.line.line_behaviour = line_behaviour;
        self.switched_on()
    }

    /// The same line with the steps that the scenario in `text` has for it.
    ///
    /// # Errors
    /// Everything that is wrong with the scenario, or with this line for it as it is by now.
    ///
    /// # Panics
    /// If the rig is in use.
    pub fn with_scenario(mut self, text: &str) -> Result<Self, Vec<Problem>> {
        self.must_be_new("with_scenario");
        let scenario = scenario::parse(text, std::slice::from_ref(&self.line))?;
        self.scenario = scenario.directors().next().unwrap_or_default();
        Ok(self.switched_on())
    }

    /// What became of the steps of its scenario so far.
    pub fn verdicts(&self) -> &[Verdict] {
        self.director.verdicts()
    }

    /// Ends the scenario: what has not come has failed.
    pub fn finish(&mut self) -> &[Verdict] {
        self.used = true;
        self.director.finish(self.now);
        self.drain();
        self.verdicts()
    }

    /// A line that is not powered yet.
    fn off(line: BenchLine) -> Self {
        let framing = line.wire.framing(1.0);
        let mut bus = Bus::new();
        let link = open(&mut bus, &line, framing);
        Self {
            line,
            framing,
            seed: 0,
            scenario: Director::default(),
            used: false,
            bus,
            director: Director::default(),
            link,
            now: Instant::ZERO,
            events: Vec::new(),
            log: Vec::new(),
        }
    }

    /// Switches it on, with all that it is set up with, at the beginning of time, and waits until it is ready.
    fn switched_on(self) -> Self {
        let (mut bus, director) = (self.fresh_bus(), self.scenario.clone());
        let link = open(&mut bus, &self.line, self.framing);
        let (now, events, log) = (Instant::ZERO, Vec::new(), Vec::new());
        let mut rig = Self { bus, director, link, now, events, log, ..self };
        let ready = rig.line.devices.iter().map(|device| device.model.wiring.servo.ready_after);
        rig.pass_time(ready.max().unwrap_or_default());
        rig
    }

    /// Whatever has happened to a rig in use would be lost when it is switched on anew.
    fn must_be_new(&self, what: &str) {
        assert!(!self.used, "`{what}` must be called before the first use of a rig");
    }

    /// The line's name, its bus and the link that the test's master has, as they are by now; the steps to come; what
    /// has happened.
    #[cfg(feature = "cli")]
    pub(super) fn into_served(self) -> InUse {
        let Self { line, bus, director, link, now, events, .. } = self;
        InUse { name: line.name, wire: line.wire, bus, director, link, now, events }
    }

    /// How the line is set.
    pub fn wire(&self) -> WireSpec {
        self.line.wire
    }

    /// The same drives on a bus of their own, just switched on, as if nothing had ever happened to this one.
    pub fn fresh_bus(&self) -> Bus {
        self.line.bus(self.seed)
    }

    /// The time.
    pub fn now(&self) -> Instant {
        self.now
    }

    /// Lets time pass, and gives back what came meanwhile.
    pub fn advance(&mut self, by: Duration) -> Vec<u8> {
        self.used = true;
        self.pass_time(by)
    }

    fn pass_time(&mut self, by: Duration) -> Vec<u8> {
        self.now += by;
        self.pass();
        self.drain()
    }

    /// Sends the frame `request` (unit, function, data in hex; the CRC is added) and gives back the answer
    /// without its CRC, empty for silence.
    ///
    /// # Panics
    /// If `request` is not hex, or the answer is not one RTU frame.
    pub fn ask(&mut self, request: &str) -> String {
        let mut bytes = super::hex(request).expect("a request in hex");
        bytes.extend(crc16(&bytes).to_le_bytes());
        let answer = self.send(&bytes);
        if answer.is_empty() {
            return String::new();
        }
        rtu::decode(&answer).expect("an answer with its CRC");
        super::to_hex(&answer[..answer.len() - 2])
    }

    /// Puts `bytes` on the line, lets it fall silent where a drive waits for that, and returns what was received.
    pub fn send(&mut self, bytes: &[u8]) -> Vec<u8> {
        self.used = true;
        self.bus.receive(self.now, self.link, bytes);
        let mut answer = self.drain();
        while let Some(at) = self.bus.silence_at(self.link) {
            self.now = self.now.max(at);
            self.pass();
            answer.extend(self.drain());
        }
        answer
    }

    /// Puts `bytes` on the line and gives back what comes at once.
    pub fn push(&mut self, bytes: &[u8]) -> Vec<u8> {
        self.used = true;
        self.bus.receive(self.now, self.link, bytes);
        self.drain()
    }

    /// Puts a fault rule in compact form on the line from now on.
    ///
    /// # Errors
    /// The first thing that is wrong with it.
    pub fn add_fault(&mut self, spec: &str) -> Result<(), String> {
        let taken: Vec<_> = self.bus.faults().names().collect();
        let fault_set =
            self.line.fault(spec, &taken).map_err(|problems| problems[0].to_string())?;
        if !fault_set.line_behaviour.is_empty() {
            let line_behaviour = self.bus.line_behaviour().clone().and(fault_set.line_behaviour);
            self.command(LineCommand::SetBehaviour(line_behaviour))
                .map_err(|error| error.to_string())?;
        }
        fault_set.rules.into_iter().try_for_each(|rule| {
            self.command(LineCommand::AddFault(rule)).map_err(|error| error.to_string())
        })
    }

    /// Gives the first drive, or its line, an order as scenarios write it: `terminal I1 on`, `raise overload`,
    /// `fault lose_reply:every=10`.
    ///
    /// # Errors
    /// What is wrong with the order, or why it was not carried out.
    pub fn order(&mut self, text: &str) -> Result<(), String> {
        let order = Order::parse(text, self.drive().model()).map_err(|no| no.to_string())?;
        let command = match order {
            Order::Drive(order) => Command::Drive(DriveId(0), order),
            Order::Fault(spec) => return self.add_fault(&spec),
            Order::NoFault(name) => LineCommand::RemoveFault(name).into(),
        };
        self.command(command).map_err(|error| error.to_string())
    }

    /// Does something to the drives or to the faults.
    ///
    /// # Errors
    /// If there is no such drive, terminal, alarm or rule.
    pub fn command(&mut self, command: impl Into<Command>) -> Result<(), CommandError> {
        self.used = true;
        let reply = self.bus.command(self.now, command.into());
        self.drain();
        reply.map(|_| ())
    }

    /// The first drive of the line, as it is now.
    pub fn drive(&self) -> View<'_> {
        self.bus.view(DriveId(0))
    }

    /// The drive that answers to `unit`, as it is now.
    pub fn unit(&self, unit: u8) -> Option<View<'_>> {
        self.bus.find(unit).map(|id| self.bus.view(id))
    }

    /// The line itself.
    pub fn bus(&self) -> &Bus {
        &self.bus
    }

    /// Everything that happened so far.
    pub fn events(&self) -> &[Event] {
        &self.events
    }

    /// The log so far, as people read it.
    pub fn log(&self) -> String {
        self.log_from(0)
    }

    /// The log from event number `first` on, counted from 0.
    pub fn log_from(&self, first: usize) -> String {
        self.log[first..].iter().map(|line| format!("{line}\n")).collect()
    }

    /// What a test that fails has to say: `what` went wrong, the log, and what has woken the line last, by name.
    pub fn report(&self, what: &str) -> String {
        let mut text = format!("{what}\n--- log\n{}--- woken by\n", self.log());
        self.bus.wakes().for_each(|wake| text += &format!("{wake}\n"));
        text
    }

    /// Lets what is due happen.
    fn pass(&mut self) {
        self.director.advance_to(&mut self.bus, self.now);
    }

    fn drain(&mut self) -> Vec<u8> {
        self.director.poll(&mut self.bus);
        let mut sent = Vec::new();
        while let Some(output) = self.bus.poll_output() {
            match output {
                Output::Transmit { frame, .. } => sent.extend_from_slice(&frame),
                Output::Event(event) => {
                    self.log.push(event.to_string());
                    self.events.push(event);
                }
                Output::Moved(mode) => {
                    self.line.wire.mode = mode;
                    self.bus.reframe_all(self.line.wire.framing(1.0));
                }
                Output::Keep(_) | Output::Close(_) => {}
            }
        }
        sent
    }
}

/// Opens a link for the master of a test, which stands at the first port of `line`.
fn open(bus: &mut Bus, line: &BenchLine, framing: Framing) -> LinkId {
    match line.ports.first().map(PortSpec::carrier) {
        Some(Carrier::Uart) => bus.open_on(Carrier::Uart, framing),
        _ => bus.open(framing),
    }
}
