//! Plays the steps of a soak test on a bus, either closely, with every call held against what must be true, or by
//! looking only now and then.

use super::InjectedBug;
use super::master;
use super::replies::{Context, Replies, SoakEvent, framed};
use super::scene::{Draws, Scene};
use super::step::{FrameDamage, SoakStep};
use crate::bank::Bank;
use crate::bench::WireSpec;
use crate::bus::{Bus, Command, LineCommand, LinkId, Output};
use crate::drive::View;
use crate::event::{DriveId, Event, EventKind};
use crate::model::Located;
use crate::model::{Counts, Model};
use crate::motion::State;
use crate::time::{Duration, Instant};
use crate::units::Dimension;
use crate::wire::Coding;
use crate::wire::function::{EXCEPTION, READ, WRITE_MANY};

/// How often somebody polling.
#[derive(Debug, Clone)]
pub enum Polling {
    /// At each instant at which something happens, and then everything is checked.
    Frequent,
    /// Now and then, as the draws fall.
    Rare(Draws),
}

/// What came of it.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Played {
    /// Every byte that left, in order.
    pub sent: Vec<u8>,
    /// Everything that happened.
    pub events: Vec<Event>,
}

/// Plays `steps` in `scene`.
///
/// # Errors
/// When something was not as it must be, and what.
pub fn play(
    scene: &Scene,
    steps: &[SoakStep],
    polling: Polling,
    bug: Option<InjectedBug>,
) -> Result<Played, (Instant, String)> {
    let mut player = SoakPlayer::new(scene, polling, bug);
    for step in steps {
        player.step(step).map_err(|what| (player.now, format!("{step}: {what}")))?;
    }
    Ok(player.played)
}

struct SoakPlayer<'a> {
    scene: &'a Scene,
    bus: Bus,
    link: LinkId,
    wire: WireSpec,
    now: Instant,
    polling: Polling,
    bug: Option<InjectedBug>,
    replies: Replies,
    axes: Vec<SoakAxis>,
    played: Played,
}

/// How things stood before a call.
struct Before {
    at: Instant,
    banks: Vec<Bank>,
    units: Vec<Option<DriveId>>,
    coding: Coding,
    /// A frame was waiting for its end.
    pending: bool,
}

impl<'a> SoakPlayer<'a> {
    fn new(scene: &'a Scene, polling: Polling, bug: Option<InjectedBug>) -> Self {
        let (mut bus, wire) = (scene.bus(), scene.line.wire);
        let link = bus.open(scene.framing(wire));
        let axes = bus.drives().map(|(_, drive)| SoakAxis::of(drive.at(bus.now()))).collect();
        let (replies, played) = (Replies::default(), Played::default());
        Self { scene, bus, link, wire, now: Instant::ZERO, polling, bug, replies, axes, played }
    }

    fn step(&mut self, step: &SoakStep) -> Result<(), String> {
        match step {
            SoakStep::Wait(by) => self.wait(*by),
            SoakStep::Ask { unit, pdu, damage } => self.ask(*unit, pdu, *damage),
            SoakStep::Noise(bytes) => {
                self.receive(bytes)?;
                if self.scene.is_tcp() {
                    self.hang_up();
                }
                Ok(())
            }
            SoakStep::Listen => self.listen(),
            SoakStep::Do(command) => self.command(command.clone()),
            SoakStep::Fault(spec) => {
                let taken: Vec<_> = self.bus.faults().names().collect();
                // A rule that can do nothing here is refused, and nothing has happened then.
                let fault_set = self.scene.line.fault(spec, &taken).unwrap_or_default();
                let mut rules = fault_set.rules.into_iter();
                rules.try_for_each(|rule| self.command(LineCommand::AddFault(rule).into()))
            }
            SoakStep::NoFault(name) => self.command(LineCommand::RemoveFault(name.clone()).into()),
        }
    }

    fn ask(&mut self, unit: u8, pdu: &[u8], damage: FrameDamage) -> Result<(), String> {
        let mut frame = framed(self.coding(), unit, pdu).to_vec();
        let (at, pause) = match damage {
            FrameDamage::Whole => (frame.len(), Duration::ZERO),
            FrameDamage::Cut(at) if !self.scene.is_tcp() => {
                frame.truncate(at.min(frame.len()));
                (frame.len(), Duration::ZERO)
            }
            FrameDamage::Cut(at) => (at.min(frame.len()), Duration::ZERO),
            FrameDamage::Pieces(at, pause) => (at.min(frame.len()), pause),
            FrameDamage::Flipped(bit) => {
                let bits = if self.coding() == Coding::Ascii { 7 } else { 8 };
                let at = bit / 8 % frame.len();
                frame[at] ^= u8::from(!self.scene.is_tcp()) << (bit % bits);
                (frame.len(), Duration::ZERO)
            }
        };
        let (first, second) = frame.split_at(at);
        self.receive(first)?;
        if second.is_empty() {
            return Ok(());
        }
        self.wait(pause)?;
        self.receive(second)
    }

    /// Once the line is silent, whoever answers to a unit hears what it is asked.
    fn listen(&mut self) -> Result<(), String> {
        self.fall_silent()?;
        for unit in 1..=u8::MAX {
            let Some(id) = self.bus.find(unit) else { continue };
            let Some(row) = self.bus.drive(id).model().showcase() else { continue };
            let [high, low] = row.at.to_be_bytes();
            let read = [READ, high, low, 0, row.kind.words() as u8];
            let first = self.played.events.len();
            self.ask(unit, &read, FrameDamage::Whole)?;
            self.fall_silent()?;
            let heard = |event: &Event| match &event.kind {
                EventKind::Transaction(it) => it.unit == unit && it.request[..] == read,
                EventKind::Fault(hit) => hit.unit == unit,
                _ => false,
            };
            if !self.played.events[first..].iter().any(heard) {
                return Err(format!("unit {unit} does not hear a clean read"));
            }
        }
        Ok(())
    }

    fn fall_silent(&mut self) -> Result<(), String> {
        while let Some(at) = self.bus.silence_at(self.link) {
            self.wait(at.since(self.now))?;
        }
        Ok(())
    }

    /// The client goes, and comes back at once.
    fn hang_up(&mut self) {
        self.bus.close(self.link);
        self.replies.hang_up();
        self.link = self.bus.open(self.scene.framing(self.wire));
    }

    fn command(&mut self, command: Command) -> Result<(), String> {
        let now = self.now;
        // Not every drive has that terminal or alarm, and not every rule is there.
        self.call(Some(&command), |bus| drop(bus.command(now, command.clone())))
    }

    fn receive(&mut self, bytes: &[u8]) -> Result<(), String> {
        let (now, link) = (self.now, self.link);
        self.call(None, |bus| bus.receive(now, link, bytes))
    }

    fn wait(&mut self, by: Duration) -> Result<(), String> {
        let end = self.now + by;
        loop {
            let next = match &mut self.polling {
                Polling::Frequent => self.bus.poll_at().map(|wake| wake.at),
                Polling::Rare(draws) => draws.one_in(3).then(|| {
                    let left = end.since(self.now).as_nanos() as u64;
                    self.now + Duration::from_nanos(draws.between(0, left))
                }),
            };
            let at = next.filter(|at| *at < end).unwrap_or(end);
            self.now = at;
            self.call(None, |bus| bus.advance_to(at))?;
            if at == end {
                return Ok(());
            }
        }
    }

    fn coding(&self) -> Coding {
        match (self.scene.is_tcp(), self.wire.mode.ascii) {
            (true, _) => Coding::Mbap,
            (false, true) => Coding::Ascii,
            (false, false) => Coding::Rtu,
        }
    }

    /// Does `act` to the bus and takes all that comes of it.
    fn call(
        &mut self,
        command: Option<&Command>,
        act: impl FnOnce(&mut Bus),
    ) -> Result<(), String> {
        if matches!(self.polling, Polling::Rare(_)) {
            act(&mut self.bus);
            self.drain();
            return Ok(());
        }
        let mut before = self.before();
        act(&mut self.bus);
        let mut seen = self.drain();
        self.damage(&mut seen, &mut before);
        self.check(&seen, &before, command)
    }

    fn before(&self) -> Before {
        let banks = self.bus.drives().map(|(_, drive)| drive.bank().clone()).collect();
        let units = (0..=u8::MAX).map(|unit| self.bus.find(unit)).collect();
        let pending = self.bus.silence_at(self.link).is_some();
        Before { at: self.bus.now(), banks, units, coding: self.coding(), pending }
    }

    fn drain(&mut self) -> Vec<SoakEvent> {
        let mut seen = Vec::new();
        while let Some(output) = self.bus.poll_output() {
            match output {
                Output::Transmit { frame, .. } => {
                    self.played.sent.extend_from_slice(&frame);
                    seen.push(SoakEvent::Frame(frame));
                }
                Output::Event(event) => {
                    seen.push(SoakEvent::Told(event.kind.clone()));
                    self.played.events.push(event);
                }
                Output::Moved(mode) => {
                    self.wire.mode = mode;
                    self.bus.reframe_all(self.scene.framing(self.wire));
                }
                Output::Close(_) => self.hang_up(),
                Output::Keep(_) => {}
            }
        }
        seen
    }

    fn check(
        &mut self,
        seen: &[SoakEvent],
        before: &Before,
        command: Option<&Command>,
    ) -> Result<(), String> {
        let answers = |unit: u8| before.units[usize::from(unit)];
        let (coding, pending) = (before.coding, before.pending);
        self.replies.check(seen, &Context { coding, answers: &answers, pending })?;
        let drives: Vec<_> = self.bus.drives().map(|(_, drive)| drive).collect();
        let idle = command.is_none() && !master::may_change(seen);
        if idle && drives.iter().zip(&before.banks).any(|(drive, bank)| drive.bank() != bank) {
            return Err("a row has changed, and nobody has written it".into());
        }
        master::written(seen, &self.bus)?;
        let time = self.bus.now().since(before.at);
        for (i, drive) in drives.into_iter().enumerate() {
            let drive = drive.at(self.bus.now());
            let mut now = SoakAxis::of(drive);
            now.came_from(&self.axes[i], time, drive)
                .map_err(|what| format!("the axis of drive {i} {what}"))?;
            now.keep_finest(&self.axes[i]);
            self.axes[i] = now;
        }
        match self.bus.poll_at().filter(|wake| wake.at <= self.bus.now()) {
            Some(wake) => Err(format!("{} is overdue", wake.reason)),
            None => Ok(()),
        }
    }

    /// The bug that was planted, if there is one.
    fn damage(&self, seen: &mut Vec<SoakEvent>, before: &mut Before) {
        let answered = seen.windows(2).enumerate().find_map(|(i, it)| match it {
            [SoakEvent::Frame(frame), SoakEvent::Told(EventKind::Transaction(told))] => {
                Some((i, *frame, told.clone()))
            }
            _ => None,
        });
        let Some((i, frame, told)) = answered else { return };
        let refused = told.reply[0] & EXCEPTION != 0;
        match self.bug {
            Some(InjectedBug::AnswersTwice) if refused => seen.insert(i, SoakEvent::Frame(frame)),
            Some(InjectedBug::WritesHalf) if refused && told.request[0] == WRITE_MANY => {
                let at = u16::from_be_bytes([told.request[1], told.request[2]]);
                let (drive, was) = (usize::from(told.drive.0), &mut before.banks);
                if let Located::Word { row, .. } = self.bus.drive(told.drive).model().map.locate(at)
                {
                    let other = !was[drive].raw(row);
                    was[drive].set(row, other);
                }
            }
            _ => {}
        }
    }
}

/// What was seen of one axis.
#[derive(Debug, Clone, Copy)]
pub struct SoakAxis {
    state: State,
    counts_per_rev: f64,
}

impl SoakAxis {
    /// The axis of `drive`.
    pub fn of(drive: View<'_>) -> Self {
        let counts_per_rev = match drive.model().wiring.axis.counts_per_rev {
            Counts::Fixed(counts) => counts.into(),
            Counts::Row(row) => drive.bank().value(drive.model(), row) as f64,
        };
        Self { state: drive.axis_state(), counts_per_rev }
    }

    /// Remembers the finest resolution that the drive has been set to: a motion keeps the one it began with.
    pub fn keep_finest(&mut self, before: &Self) {
        self.counts_per_rev = self.counts_per_rev.max(before.counts_per_rev);
    }

    /// Can `drive` have moved it there from `before`, in `time`?
    pub fn came_from(&self, before: &Self, time: Duration, drive: View<'_>) -> Result<(), String> {
        let (from, to) = (before.state.position, self.state.position);
        let top = top_rpm(drive.model()) / 60.0 * self.counts_per_rev.max(before.counts_per_rev);
        let most = top * time.as_secs_f64() * 1.001 + 1.0;
        if (to - from).abs() > most {
            return Err(format!("from {from} to {to} in {time:?}, which is {most} at most"));
        }
        let stops =
            drive.machine().hard_stop.filter(|[low, high]| to < *low as f64 || to > *high as f64);
        match stops {
            Some([low, high]) => Err(format!("at {to}, beyond the hard stops {low} and {high}")),
            None => Ok(()),
        }
    }
}

/// The fastest that any row of `model` can ask for.
fn top_rpm(model: &Model) -> f64 {
    let speeds = model.map.rows().filter(|(_, row)| row.unit.dimension == Dimension::Speed);
    let ends = speeds.flat_map(|(_, row)| {
        let limits = [row.kind.limits()];
        let spans = if row.spans.is_empty() { &limits[..] } else { &row.spans };
        let ends = spans.iter().flat_map(|(low, high)| [*low, *high]).map(|it| it as f64);
        ends.map(|it| (it * row.unit.scale).abs()).collect::<Vec<_>>()
    });
    ends.fold(0.0, f64::max)
}
