//! What happens in a storm, one thing after the other: drawn beforehand, so that leaving one out leaves the others
//! as they are.

use super::dice::Dice;
use super::drill::{Axis, drill};
use super::master;
use super::world::World;
use crate::bus::Command;
use crate::event::DriveId;
use crate::fault::Kind;
use crate::time::Duration;
use crate::words::{AlarmCause, Word};
use std::fmt;

/// One thing that happens.
#[derive(Debug, Clone, PartialEq)]
pub enum Step {
    /// Nothing, for so long.
    Wait(Duration),
    /// A master sends a frame.
    Ask {
        /// To whom.
        unit: u8,
        /// What.
        pdu: Vec<u8>,
        /// What becomes of the frame on its way.
        way: Way,
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
pub enum Way {
    /// It arrives.
    Whole,
    /// Its end never comes. On TCP it comes later.
    Cut(usize),
    /// It comes in two pieces with a pause between them.
    Pieces(usize, Duration),
    /// One of its bits is turned over. Not on TCP, which carries what it is given.
    Flipped(usize),
}

/// Everything that happens on `world`, `count` steps.
pub fn draw(world: &World, count: usize, mut stream: impl FnMut(u64) -> Dice) -> Vec<Step> {
    let steps = |n: usize| {
        let mut dice = stream(n as u64);
        match dice.one_in(16) {
            true => drill(axis(world, &mut dice), &mut dice),
            false => vec![step(world, n, &mut dice)],
        }
    };
    (0..count).flat_map(steps).chain([Step::Listen]).collect()
}

fn axis<'a>(world: &'a World, dice: &mut Dice) -> Axis<'a> {
    let devices = &world.line.devices;
    let at = dice.between(0, devices.len() as u64 - 1) as usize;
    let before: usize = devices[..at].iter().map(|device| device.setups.len()).sum();
    let station = dice.between(0, devices[at].setups.len() as u64 - 1) as u8;
    let drive = DriveId(before as u16 + u16::from(station));
    Axis { model: &devices[at].model, drive, unit: world.unit(at) + station }
}

fn step(world: &World, n: usize, dice: &mut Dice) -> Step {
    match dice.between(0, 99) {
        0..20 => Step::Wait(dice.pause(Duration::from_secs(4))),
        20..28 => Step::Listen,
        28..36 => Step::Do(terminal(world, dice)),
        36 => {
            let cause = *dice.pick(AlarmCause::ALL).expect("there are some");
            Step::Do(Command::Raise { drive: drive(world, dice), cause })
        }
        37 => Step::Do(Command::PowerCycle { drive: drive(world, dice) }),
        38..44 => fault(world, n, dice),
        44..50 => Step::NoFault(rule(dice.between(0, n as u64))),
        50..54 => Step::Noise(dice.bytes(60)),
        _ => {
            let (unit, pdu) = master::request(world, dice);
            Step::Ask { unit, pdu, way: way(dice) }
        }
    }
}

fn way(dice: &mut Dice) -> Way {
    let at = dice.between(1, 9) as usize;
    match dice.between(0, 19) {
        0 => Way::Cut(at),
        1 => Way::Flipped(dice.between(0, 60) as usize),
        2..4 => Way::Pieces(at, dice.pause(Duration::from_millis(40))),
        _ => Way::Whole,
    }
}

fn drive(world: &World, dice: &mut Dice) -> DriveId {
    let count: usize = world.line.devices.iter().map(|device| device.setups.len()).sum();
    DriveId(dice.between(0, count as u64 - 1) as u16)
}

fn terminal(world: &World, dice: &mut Dice) -> Command {
    let (index, signal) = (dice.between(0, 9) as u8, dice.one_in(2));
    Command::Terminal { drive: drive(world, dice), index, signal }
}

fn rule(n: u64) -> String {
    format!("f{n}")
}

fn fault(world: &World, n: usize, dice: &mut Dice) -> Step {
    let possible = |kind: &Kind| {
        kind.preset().is_none() && !(world.is_tcp() && kind.impossible_on_tcp().is_some())
    };
    let kinds: Vec<_> = Kind::ALL.iter().copied().filter(possible).collect();
    let kind = *dice.pick(&kinds).expect("most are possible");
    let mut spec = format!("{}:name={}", kind.name(), rule(n as u64));
    for key in kind.keys() {
        let value = match *key {
            "ms" => format!("{}-{}", dice.between(1, 20), dice.between(20, 900)),
            "code" => dice.between(1, 0xFF).to_string(),
            "to" => dice.between(1, 0x7F).to_string(),
            // The number of the transaction stays whole.
            "at" => dice.between(2, 6).to_string(),
            _ => dice.between(1, 12).to_string(),
        };
        spec += &format!(",{key}={value}");
    }
    spec += &match dice.between(0, 3) {
        0 => format!(",every={}", dice.between(1, 4)),
        1 => format!(",probability=0.{}", dice.between(1, 9)),
        2 => format!(",count={},unit={}", dice.between(1, 5), dice.between(1, 6)),
        _ => format!(
            ",skip={},function={}",
            dice.between(0, 3),
            dice.pick(&[3, 6, 16]).expect("one")
        ),
    };
    Step::Fault(spec)
}

impl fmt::Display for Step {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Wait(by) => write!(f, "wait {by:?}"),
            Self::Ask { unit, pdu, way } => {
                write!(f, "ask unit {unit}: {}", crate::wire::hex::to_hex(pdu))?;
                if *way == Way::Whole { Ok(()) } else { write!(f, " ({way:?})") }
            }
            Self::Noise(bytes) => write!(f, "noise {}", crate::wire::hex::to_hex(bytes)),
            Self::Listen => write!(f, "listen"),
            Self::Do(command) => write!(f, "do {command:?}"),
            Self::Fault(spec) => write!(f, "fault {spec}"),
            Self::NoFault(name) => write!(f, "no fault {name}"),
        }
    }
}
