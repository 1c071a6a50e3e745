//! What happened: the values that the log, the tests and later tools are made from. No text here.

mod no_effect;
mod replanned;

pub use no_effect::{Ignored, Ordered};
pub use replanned::Replanned;

use crate::medium::FaultHit;
use crate::serial::{Mode, Settings};
use crate::time::{Duration, Instant};
use crate::vocabulary::{Action, AlarmCause, Condition, HomeEnd, HomingStep, Refusal, RowId};
use crate::wire::ascii::BadAscii;
use crate::wire::mbap::BadHeader;
use crate::wire::rtu::BadCrc;
use crate::wire::{Frame, Inline, NoiseCause, Pdu};

/// Something that happened on a line, and when.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Event {
    /// When, in the emulated world.
    pub at: Instant,
    /// What.
    pub what: What,
}

/// Number of a drive on its bus, from 0.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub struct DriveId(pub u16);

/// What happened.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum What {
    /// A drive heard a request and answered.
    Transaction(Transaction),
    /// A drive executed a broadcast, or refused to; either way it did not answer.
    Broadcast {
        /// Who.
        drive: DriveId,
        /// Its unit address at the time.
        unit: u8,
        /// The request's PDU.
        request: Pdu,
        /// Why it did not execute it.
        refusal: Option<Refusal>,
    },
    /// A broadcast that nobody can execute, because it asks for an answer.
    BroadcastRead {
        /// The request's PDU.
        request: Pdu,
    },
    /// Traffic of others.
    Foreign {
        /// Its unit address.
        unit: u8,
        /// PDU.
        pdu: Pdu,
        /// An answer rather than a request?
        answer: bool,
    },
    /// A frame with a wrong CRC.
    BadCrc {
        /// The frame.
        frame: Frame,
        /// Both values.
        crc: BadCrc,
        /// The drive that answers such a frame with an exception, and the code.
        answered: Option<(DriveId, u8)>,
    },
    /// An ASCII frame that does not add up.
    BadAscii {
        /// Its characters.
        characters: Frame,
        /// Why.
        why: BadAscii,
    },
    /// Bytes that are no frame.
    Noise {
        /// The first of them.
        head: Inline<16>,
        /// How many there were.
        len: usize,
        /// Why they are none.
        why: NoiseCause,
    },
    /// All drives of the line talk in another mode now, and the line goes with them.
    Moved(Mode),
    /// The port of the master is set to something else than the line, or no longer.
    Port {
        /// How both are set.
        port: PortSettings,
        /// Does the line understand it?
        understood: bool,
    },
    /// A TCP stream that could not be followed and was closed.
    Lost(BadHeader),
    /// A fault rule did something to a request or its reply.
    Fault(FaultHit),
    /// A step of a scenario.
    Step(RemarkId),
    /// A master has given an order again whose answer it can't have heard, and the drive got it twice.
    RepeatedCommand {
        /// Who.
        drive: DriveId,
        /// The unit address that was asked.
        unit: u8,
        /// The order.
        action: Action,
        /// How often that has happened to this drive by now.
        count: u64,
    },
    /// A drive did something without being asked on this line, or as a consequence.
    Drive {
        /// Who.
        drive: DriveId,
        /// Its unit address at the time.
        unit: u8,
        /// What.
        change: Change,
    },
}

/// How the port of a master is set, and the line behind it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct PortSettings {
    /// Bits per second of the master's port.
    pub baud: u32,
    /// Its stop bits, 1 or 2.
    pub stop_bits: u8,
    /// How the line is set.
    pub line: Settings,
}

impl PortSettings {
    /// Do they talk at one speed?
    pub fn same_baud(self) -> bool {
        self.baud == self.line.baud
    }

    /// Are they the same, as far as can be seen?
    pub fn fits(self) -> bool {
        self.same_baud() && self.stop_bits == self.line.format.stop_bits
    }
}

/// Number of a remark on its bus, from 0.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct RemarkId(pub u32);

/// What is to be told of a step of a scenario.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Remark {
    /// Its name.
    pub step: String,
    /// What became of it.
    pub outcome: Outcome,
    /// Why it failed.
    pub what: String,
}

/// What became of a step.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Outcome {
    /// What it waited for has come.
    Begins,
    /// What it expects holds.
    Passed,
    /// It does not hold, or something could not be done.
    Failed,
}

/// A request to one drive and its answer.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Transaction {
    /// Who.
    pub drive: DriveId,
    /// The unit address that was asked.
    pub unit: u8,
    /// The request's PDU.
    pub request: Pdu,
    /// The answer's PDU.
    pub answer: Pdu,
    /// Why it was refused, if it was.
    pub refusal: Option<Refusal>,
}

/// A change in a drive.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Change {
    /// Power came on.
    PoweredOn,
    /// Power went off.
    PoweredOff,
    /// Initialised: it can be enabled.
    Ready,
    /// The power stage went on or off.
    Enabled(bool),
    /// An alarm was raised.
    Alarm {
        /// Why.
        cause: AlarmCause,
        /// The vendor's number.
        code: u16,
    },
    /// The alarm is gone.
    AlarmCleared,
    /// The alarms of the past are forgotten.
    AlarmHistoryCleared,
    /// An input word was not refreshed in time and returned to 0.
    WordExpired {
        /// The word.
        word: RowId,
        /// The row with its time.
        hold: RowId,
        /// How long it held, in milliseconds.
        held_ms: u32,
    },
    /// The position register was set to 0.
    PositionCleared,
    /// The turns of the encoder count from 0.
    TurnsCleared,
    /// All values were stored.
    Stored,
    /// A master wears the memory out.
    Wear {
        /// The row that it stores; `None` for all at once.
        row: Option<RowId>,
        /// How often it was stored.
        writes: u32,
        /// In this time; `None` for ever.
        within: Option<Duration>,
    },
    /// All values are as they left the factory.
    FactoryRestored,
    /// It answers to another unit address now.
    Unit {
        /// The old one.
        from: u8,
        /// The new one.
        to: u8,
    },
    /// It talks in another mode now.
    Mode {
        /// The old one; `None` where its parameters held codes that stand for nothing.
        from: Option<Mode>,
        /// The new one.
        to: Option<Mode>,
    },
    /// It goes to a position.
    Moves {
        /// In counts of the drive.
        to: i64,
    },
    /// It goes at a speed by order.
    Runs {
        /// In thousandths of a revolution a minute; the sign is the direction.
        mrpm: i64,
    },
    /// It goes at a speed while a level asks for it.
    Jogs {
        /// In thousandths of a revolution a minute; the sign is the direction.
        mrpm: i64,
    },
    /// A position segment begins.
    PositionSegment {
        /// Its number.
        number: u16,
        /// Where to, in counts of the drive.
        to: i64,
    },
    /// A velocity segment begins.
    VelocitySegment {
        /// Its number.
        number: u16,
        /// In thousandths of a revolution a minute; the sign is the direction.
        mrpm: i64,
    },
    /// A chain goes on.
    ChainStep {
        /// Number of the segment so far.
        from: u16,
        /// Number of the next one.
        to: u16,
        /// The condition that was met last of those that count; `None` where there is none.
        why: Option<Condition>,
    },
    /// A chain has ended at a segment that can't follow.
    ChainEnded {
        /// Number of the segment.
        at: u16,
        /// Why it can't.
        why: Ignored,
    },
    /// A motion under way goes by another setting from now on.
    Replans(Replanned),
    /// A level holds its move back: it slows down to a standstill, and the move is not over.
    Pauses,
    /// The move that was held back goes on.
    Resumes {
        /// Where to, in counts of the drive.
        to: i64,
    },
    /// It gives up what it was behind its command.
    DeviationCleared {
        /// Counts.
        counts: i64,
    },
    /// It slows down to a standstill.
    Stops,
    /// Its power stage went off while it moved: it runs out.
    Coasts,
    /// It stands.
    Stands {
        /// In counts of the drive.
        at: i64,
    },
    /// A limit ends the motion.
    Limit {
        /// The positive one?
        forward: bool,
        /// One that the drive keeps by itself, without a switch?
        soft: bool,
    },
    /// It runs against a hard stop.
    Hits {
        /// In counts of the drive.
        at: i64,
    },
    /// It should be farther from where it is than is allowed.
    Deviates,
    /// It looks for its origin.
    Homes {
        /// Number of the method.
        method: i64,
    },
    /// It takes a homing step.
    Seeks {
        /// Number of the method.
        method: i64,
        /// The step.
        step: HomingStep,
        /// In thousandths of a revolution a minute; the sign is the direction.
        mrpm: i64,
    },
    /// What a homing step waited for has come.
    Finds {
        /// Number of the method.
        method: i64,
        /// The step.
        step: HomingStep,
        /// In counts of the drive.
        at: i64,
    },
    /// A homing step has come to a limit instead.
    FindsLimit {
        /// Number of the method.
        method: i64,
        /// The positive one?
        forward: bool,
        /// Does it go on from there? Otherwise it waits for its time limit.
        turns: bool,
        /// In counts of the drive.
        at: i64,
    },
    /// A homing looks for the index pulse that refines its origin.
    Refines {
        /// Number of the method.
        method: i64,
        /// In the positive direction?
        forward: bool,
    },
    /// A homing has found the origin.
    Origin {
        /// Number of the method.
        method: i64,
        /// In counts of the drive, as they were until now.
        at: i64,
    },
    /// A homing is done.
    Homed {
        /// Number of the method.
        method: i64,
        /// What the position register says now, in counts of the drive.
        position: i64,
    },
    /// A homing ended without an origin.
    HomingLost {
        /// Number of the method.
        method: i64,
        /// Why.
        why: HomeEnd,
    },
    /// An order has no effect.
    NoEffect {
        /// What was ordered.
        order: Ordered,
        /// Why nothing comes of it.
        why: Ignored,
    },
    /// Something is wrong with the device from now on, or no longer.
    DeviceFault {
        /// What.
        device_fault: DeviceFault,
        /// From now on?
        on: bool,
    },
    /// The contact on an input terminal begins to bounce.
    Bounces {
        /// Index from 0.
        index: u8,
        /// So many times it leaves its level and comes back.
        times: u16,
        /// From one edge to the next.
        every: Duration,
    },
    /// An input terminal got another level.
    Terminal {
        /// Index from 0.
        index: u8,
        /// Carries a signal?
        signal: bool,
    },
}

/// What can be wrong with a device, apart from its line, for as long as somebody says so.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum DeviceFault {
    /// The cause of an alarm stands: the drive trips, and no reset helps.
    Cause(AlarmCause),
    /// The axis can't leave the count at which it is.
    Blocked,
    /// There is no feedback: position and speed stay as they were seen last, and the drive trips if it has an
    /// alarm for that.
    EncoderLost,
    /// Position and speed stay as they were seen last, and the drive does not notice.
    Frozen,
    /// The input terminal of this index, from 0, keeps its level.
    Stuck(u8),
}
