//! What happens in a soak test, one thing after the other: drawn beforehand, so that leaving one out leaves the others
//! as they are. Now and then it is what a PLC does to have an axis move, which left to chance would hardly ever happen.

use super::master::{self, one, setting};
use super::scene::{Draws, Scene};
use crate::bus::{Command, DriveOrder};
use crate::event::DriveId;
use crate::medium::{FaultKind, KeyForm};
use crate::model::Model;
use crate::time::Duration;
use crate::vocabulary::{Action, AlarmCause, Input, Named, RowId};
use std::fmt;

/// One thing that happens.
#[derive(Debug, Clone, PartialEq)]
pub enum SoakStep {
    /// Nothing, for so long.
    Wait(Duration),
    /// A master sends a frame.
    Ask {
        /// To whom.
        unit: u8,
        /// What.
        pdu: Vec<u8>,
        /// What becomes of the frame on its way.
        damage: FrameDamage,
    },
    /// Bytes that nobody meant; on TCP the client hangs up behind them.
    Noise(Vec<u8>),
    /// The line falls silent, and then each drive that hears it is asked something harmless.
    Listen,
    /// Something happens to a drive.
    Do(Command),
    /// A fault rule from now on.
    Fault(String),
    /// No such rule from now on.
    NoFault(String),
}

/// What becomes of a request's frame.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum FrameDamage {
    /// It arrives.
    Whole,
    /// Its end never comes. On TCP it comes later.
    Cut(usize),
    /// It comes in two pieces with a pause between them.
    Pieces(usize, Duration),
    /// One of its bits is turned over. Not on TCP, which carries what it is given.
    Flipped(usize),
}

/// Everything that happens on `scene`, `count` steps.
pub fn draw(scene: &Scene, count: usize, mut stream: impl FnMut(u64) -> Draws) -> Vec<SoakStep> {
    let steps = |n: usize| {
        let mut draws = stream(n as u64);
        match draws.one_in(16) {
            true => routine(axis(scene, &mut draws), &mut draws),
            false => vec![step(scene, n, &mut draws)],
        }
    };
    (0..count).flat_map(steps).chain([SoakStep::Listen]).collect()
}

fn axis<'a>(scene: &'a Scene, draws: &mut Draws) -> RoutineAxis<'a> {
    let devices = &scene.line.devices;
    let at = draws.between(0, devices.len() as u64 - 1) as usize;
    let before: usize = devices[..at].iter().map(|device| device.setups.len()).sum();
    let station = draws.between(0, devices[at].setups.len() as u64 - 1) as u8;
    let drive = DriveId(before as u16 + u16::from(station));
    RoutineAxis { model: &devices[at].model, drive, unit: scene.unit(at) + station }
}

fn step(scene: &Scene, n: usize, draws: &mut Draws) -> SoakStep {
    match draws.between(0, 99) {
        0..20 => SoakStep::Wait(draws.pause(Duration::from_secs(4))),
        20..28 => SoakStep::Listen,
        28..36 => SoakStep::Do(terminal(scene, draws)),
        36 => {
            let cause = *draws.pick(AlarmCause::ALL).expect("there are some");
            SoakStep::Do(Command::Drive(drive(scene, draws), DriveOrder::Raise(cause)))
        }
        37 => SoakStep::Do(Command::Drive(drive(scene, draws), DriveOrder::PowerCycle)),
        38..44 => fault(scene, n, draws),
        44..50 => SoakStep::NoFault(rule(draws.between(0, n as u64))),
        50..54 => SoakStep::Noise(draws.bytes(60)),
        _ => {
            let (unit, pdu) = master::request(scene, draws);
            SoakStep::Ask { unit, pdu, damage: damage(draws) }
        }
    }
}

fn damage(draws: &mut Draws) -> FrameDamage {
    let at = draws.between(1, 9) as usize;
    match draws.between(0, 19) {
        0 => FrameDamage::Cut(at),
        1 => FrameDamage::Flipped(draws.between(0, 60) as usize),
        2..4 => FrameDamage::Pieces(at, draws.pause(Duration::from_millis(40))),
        _ => FrameDamage::Whole,
    }
}

fn drive(scene: &Scene, draws: &mut Draws) -> DriveId {
    let count: usize = scene.line.devices.iter().map(|device| device.setups.len()).sum();
    DriveId(draws.between(0, count as u64 - 1) as u16)
}

fn terminal(scene: &Scene, draws: &mut Draws) -> Command {
    let (index, signal) = (draws.between(0, 9) as u8, draws.one_in(2));
    Command::Drive(drive(scene, draws), DriveOrder::Terminal { index, signal })
}

fn rule(n: u64) -> String {
    format!("f{n}")
}

fn fault(scene: &Scene, n: usize, draws: &mut Draws) -> SoakStep {
    let possible = |kind: &&FaultKind| !(scene.is_tcp() && kind.impossible_on_tcp.is_some());
    let kinds: Vec<_> = FaultKind::ALL.iter().filter(possible).collect();
    let kind = *draws.pick(&kinds).expect("most are possible");
    let mut spec = format!("{kind}:name={}", rule(n as u64));
    for key in kind.keys {
        let value = match key.form {
            KeyForm::Milliseconds => {
                format!("{}-{}", draws.between(1, 20), draws.between(20, 900))
            }
            KeyForm::Number(least, most) => draws.between(least.max(1), most.min(12)).to_string(),
        };
        spec += &format!(",{}={value}", key.name);
    }
    spec += &match draws.between(0, 3) {
        0 => format!(",every={}", draws.between(1, 4)),
        1 => format!(",probability=0.{}", draws.between(1, 9)),
        2 => format!(",count={},unit={}", draws.between(1, 5), draws.between(1, 6)),
        _ => format!(
            ",skip={},function={}",
            draws.between(0, 3),
            draws.pick(&[3, 6, 16]).expect("one")
        ),
    };
    SoakStep::Fault(spec)
}

impl fmt::Display for SoakStep {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Wait(by) => write!(f, "wait {by:?}"),
            Self::Ask { unit, pdu, damage } => {
                write!(f, "ask unit {unit}: {}", crate::wire::hex::to_hex(pdu))?;
                if *damage == FrameDamage::Whole { Ok(()) } else { write!(f, " ({damage:?})") }
            }
            Self::Noise(bytes) => write!(f, "noise {}", crate::wire::hex::to_hex(bytes)),
            Self::Listen => write!(f, "listen"),
            Self::Do(command) => write!(f, "do {command:?}"),
            Self::Fault(spec) => write!(f, "fault {spec}"),
            Self::NoFault(name) => write!(f, "no fault {name}"),
        }
    }
}

/// Whom a routine is for.
#[derive(Debug, Clone, Copy)]
struct RoutineAxis<'a> {
    model: &'a Model,
    drive: DriveId,
    unit: u8,
}

/// Alarms away, power on, a few settings, a start.
fn routine(axis: RoutineAxis<'_>, draws: &mut Draws) -> Vec<SoakStep> {
    let mut steps = Vec::new();
    if draws.one_in(3) {
        steps.extend(axis.order(Action::AlarmReset, Input::AlarmReset));
    }
    steps.extend(axis.order(Action::Enable, Input::ServoOn));
    steps.extend((0..draws.between(0, 4)).map(|_| axis.ask(setting(axis.model, draws))));
    let starts = [
        (Action::MoveStart, Input::MoveStart),
        (Action::MoveStart, Input::SegmentStart),
        (Action::RunStart, Input::JogPos),
        (Action::RunStart, Input::JogNeg),
        (Action::HomeStart, Input::HomeStart),
        (Action::RunStart, Input::SegmentRun),
    ];
    let (action, input) = *draws.pick(&starts).expect("there are some");
    steps.extend(axis.order(action, input));
    steps.push(SoakStep::Wait(draws.pause(Duration::from_secs(3))));
    steps
}

impl RoutineAxis<'_> {
    /// What gives `action`, or else `input`, by the first way that the model has.
    fn order(self, action: Action, input: Input) -> Vec<SoakStep> {
        let wiring = &self.model.wiring;
        let commands = wiring.commands.iter();
        let commands =
            commands.flat_map(|it| it.actions.iter().map(|(v, a)| (it.row, *v as u16, *a)));
        let triggers = wiring.triggers.iter();
        let triggers =
            triggers.flat_map(|it| it.actions.iter().map(|(b, a)| (it.row, 1 << *b, *a)));
        match commands.chain(triggers).find(|(.., it)| *it == action) {
            Some((row, value, _)) => vec![self.write(row, value)],
            None => self.signal(input),
        }
    }

    /// What makes `input` active.
    fn signal(self, input: Input) -> Vec<SoakStep> {
        let wiring = &self.model.wiring;
        let words = wiring.input_words.iter();
        let word = words.flat_map(|it| {
            let mine = it.positions.iter().filter(|(_, signal)| *signal == input);
            mine.map(move |(position, _)| (it, usize::from(position / 16), 1 << (position % 16)))
        });
        if let Some((words, word, bit)) = word.into_iter().next() {
            let enabled = words.enabled_by.get(word).map(|row| self.write(*row, u16::MAX));
            return enabled.into_iter().chain([self.write(words.rows[word], bit)]).collect();
        }
        let bits = wiring.input_bits.iter();
        let mut bits = bits.flat_map(|(row, bits)| bits.iter().map(|(bit, it)| (*row, *bit, *it)));
        if let Some((row, bit, _)) = bits.find(|(.., it)| *it == input) {
            return vec![self.write(row, 1 << bit)];
        }
        let Some(terminals) = &wiring.input_terminals else { return Vec::new() };
        let init = |row: &RowId| terminals.meaning(self.model.map.row(*row).init);
        let index = terminals.functions.iter().position(|row| init(row) == Some(input));
        let set = |index: usize| {
            let (drive, index) = (self.drive, index as u8);
            let put = |signal| {
                SoakStep::Do(Command::Drive(drive, DriveOrder::Terminal { index, signal }))
            };
            [put(false), put(true)]
        };
        index.map(set).into_iter().flatten().collect()
    }

    fn write(self, row: RowId, value: u16) -> SoakStep {
        self.ask(one(self.model.map.row(row).at, value))
    }

    fn ask(self, pdu: Vec<u8>) -> SoakStep {
        SoakStep::Ask { unit: self.unit, pdu, damage: FrameDamage::Whole }
    }
}
