//! Holds what leaves a line against what its drives say that they did: one answer a request, from the unit that
//! was asked, and nothing else, but for what a fault rule says that it did.

use crate::event::{DriveId, FaultEffect, Transaction, What};
use crate::wire::{Coding, Exception, Frame, Response, ascii, mbap, rtu};

/// Frames that have to come yet.
#[derive(Debug, Default)]
pub struct Replies {
    held: Vec<Vec<u8>>,
}

/// The outputs of one call, in order, as far as they count here.
#[derive(Debug, Clone, Copy)]
pub enum SoakEvent {
    /// A frame left.
    Frame(Frame),
    /// Something was told.
    Told(What),
}

/// How things were before the call: how frames are coded, which drive answered to a unit, and whether a frame was
/// waiting for its end, so that one call may close two.
pub struct Context<'a> {
    pub coding: Coding,
    pub pending: bool,
    pub answers: &'a dyn Fn(u8) -> Option<DriveId>,
}

impl Replies {
    /// Nobody is there any more to hear what was held back.
    pub fn hang_up(&mut self) {
        self.held.clear();
    }

    /// Goes through the outputs of one call.
    pub fn check(&mut self, seen: &[SoakEvent], context: &Context<'_>) -> Result<(), String> {
        let mut frames: Vec<Frame> = Vec::new();
        let mut rest = seen.iter().peekable();
        while let Some(next) = rest.next() {
            let what = match next {
                SoakEvent::Frame(frame) => {
                    frames.push(*frame);
                    continue;
                }
                SoakEvent::Told(what) => what,
            };
            let hit_by = match (what, rest.peek()) {
                (What::Transaction(_), Some(SoakEvent::Told(What::Fault { effect, .. }))) => {
                    Some(*effect)
                }
                _ => None,
            };
            // That one is about the second of two requests, which no drive saw.
            let hit_by = hit_by.filter(|it| !context.pending || !it.spares_the_drive());
            match what {
                What::Transaction(it) => {
                    addressed(it, context)?;
                    rest.next_if(|_| hit_by.is_some());
                    self.answered(it, hit_by, &mut frames, context.coding)?;
                }
                What::Fault { unit, effect, .. } => {
                    self.hit_by(*unit, *effect, &mut frames, context.coding)?;
                }
                What::BadCrc { frame, answered: Some((_, code)), .. } => {
                    let function = frame.get(1).map_or(0, |it| it & 0x7F);
                    let want = exception(function, *code);
                    let [got] = self.own(&mut frames)?;
                    same(&got, &framed(context.coding, frame[0], &want))?;
                }
                _ => {}
            }
        }
        self.come(&frames)
    }

    /// A drive has answered, and perhaps a rule has acted on the reply.
    fn answered(
        &mut self,
        it: &Transaction,
        hit_by: Option<FaultEffect>,
        frames: &mut Vec<Frame>,
        coding: Coding,
    ) -> Result<(), String> {
        let whole = framed(coding, it.unit, &it.answer);
        let exact = |got: &Frame| same(got, &whole);
        match hit_by {
            None => exact(&self.own::<1>(frames)?[0]),
            Some(FaultEffect::ReplyLost) => self.own::<0>(frames).map(drop),
            Some(
                FaultEffect::BadChecksum | FaultEffect::BitsFlipped(_) | FaultEffect::Truncated(_),
            ) => {
                let [got] = self.own(frames)?;
                match got[..] == whole[..] {
                    true => Err("a damaged reply is as good as new".into()),
                    false => Ok(()),
                }
            }
            Some(FaultEffect::Extra(_) | FaultEffect::Duplicated) => {
                let [first, second] = self.own(frames)?;
                exact(&first)?;
                if hit_by == Some(FaultEffect::Duplicated) { exact(&second) } else { Ok(()) }
            }
            Some(FaultEffect::Garbage(_) | FaultEffect::Echoed) => {
                exact(&self.own::<2>(frames)?[1])
            }
            Some(FaultEffect::Delayed(_) | FaultEffect::Late) => {
                self.own::<0>(frames)?;
                self.held.push(whole.to_vec());
                Ok(())
            }
            Some(FaultEffect::Split { .. }) => {
                let [first] = self.own(frames)?;
                let (head, tail) = whole.split_at(first.len());
                self.held.push(tail.to_vec());
                same(&first, head)
            }
            Some(FaultEffect::WrongUnit(unit)) => {
                same(&self.own::<1>(frames)?[0], &framed(coding, unit, &it.answer))
            }
            Some(FaultEffect::WrongFunction(function)) => {
                let mut answer = it.answer;
                answer[0] = function | answer[0] & 0x80;
                same(&self.own::<1>(frames)?[0], &framed(coding, it.unit, &answer))
            }
            Some(FaultEffect::RequestLost | FaultEffect::Exception(_) | FaultEffect::Busy) => {
                Err("a drive has executed what it never saw".into())
            }
        }
    }

    /// A rule has acted, and no drive was asked, or all were.
    fn hit_by(
        &mut self,
        unit: u8,
        effect: FaultEffect,
        frames: &mut Vec<Frame>,
        coding: Coding,
    ) -> Result<(), String> {
        let code = match effect {
            FaultEffect::RequestLost => return self.own::<0>(frames).map(drop),
            FaultEffect::Echoed => return self.own::<1>(frames).map(drop),
            FaultEffect::Exception(code) => code,
            FaultEffect::Busy => 6,
            _ => return Err(format!("{effect:?} of an answer that never left")),
        };
        let [got] = self.own(frames)?;
        let exception = exception(function(&got, coding) & 0x7F, code);
        same(&got, &framed(coding, unit, &exception))
    }

    /// The last `N` frames; those before were held back until now.
    fn own<const N: usize>(&mut self, frames: &mut Vec<Frame>) -> Result<[Frame; N], String> {
        let Some(first) = frames.len().checked_sub(N) else {
            return Err(format!("{} frames left where {N} belong to a request", frames.len()));
        };
        let own = frames.split_off(first);
        self.come(frames)?;
        frames.clear();
        Ok(std::array::from_fn(|i| own[i]))
    }

    /// All of `frames` were held back until now.
    fn come(&mut self, frames: &[Frame]) -> Result<(), String> {
        for frame in frames {
            let held = self.held.iter().position(|it| it[..] == frame[..]);
            let held = held.ok_or_else(|| format!("nobody asked for {frame:?}"))?;
            self.held.remove(held);
        }
        Ok(())
    }
}

/// The drive that executed a request is the one that was asked.
fn addressed(it: &Transaction, context: &Context<'_>) -> Result<(), String> {
    let asked = (context.answers)(it.unit);
    let anybody = context.coding == Coding::Mbap && [0, 0xFF].contains(&it.unit);
    match asked == Some(it.drive) || anybody && asked.is_none() {
        true => Ok(()),
        false => Err(format!("drive {} answered for unit {}", it.drive.0, it.unit)),
    }
}

/// The function that a frame names; 0 where it is too short for one.
fn function(frame: &[u8], coding: Coding) -> u8 {
    let function = match coding {
        Coding::Rtu => frame.get(1).copied(),
        Coding::Mbap => frame.get(7).copied(),
        Coding::Ascii => frame
            .get(3..5)
            .and_then(|digits| std::str::from_utf8(digits).ok())
            .and_then(|digits| u8::from_str_radix(digits, 16).ok()),
    };
    function.unwrap_or(0)
}

fn exception(function: u8, code: u8) -> crate::wire::Pdu {
    Response::Exception(Exception { function, code }).encode()
}

/// The number of every transaction on TCP.
pub const TRANSACTION: u16 = 77;

/// A frame as it travels.
pub fn framed(coding: Coding, unit: u8, pdu: &[u8]) -> Frame {
    match coding {
        Coding::Rtu => rtu::encode(unit, pdu),
        Coding::Ascii => ascii::encode(unit, pdu),
        Coding::Mbap => mbap::encode(TRANSACTION, unit, pdu),
    }
}

fn same(got: &[u8], want: &[u8]) -> Result<(), String> {
    let hex = crate::wire::hex::to_hex;
    match got == want {
        true => Ok(()),
        false => Err(format!("{} left where {} belongs", hex(got), hex(want))),
    }
}

impl FaultEffect {
    /// Did no drive see the request?
    fn spares_the_drive(self) -> bool {
        matches!(self, Self::RequestLost | Self::Exception(_) | Self::Busy)
    }
}
