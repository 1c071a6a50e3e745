//! Holds what leaves a line against what its drives say that they did: one answer a request, from the unit that
//! was asked, and nothing else, but for what a fault rule says that it did.

use crate::event::{DriveId, EventKind, Transaction};
use crate::medium::{FaultHit, Leaves, LeavingReply, Passage};
use crate::wire::{BROADCAST, Coding, Exception, Frame, Response, ascii, mbap, rtu};

/// Frames that have to come yet.
#[derive(Debug, Default)]
pub struct Replies {
    held: Vec<Vec<u8>>,
}

/// The outputs of one call, in order, as far as they count here.
#[derive(Debug, Clone)]
pub enum SoakEvent {
    /// A frame left.
    Frame(Frame),
    /// Something was told.
    Told(EventKind),
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
            let hit = match (what, rest.peek()) {
                (EventKind::Transaction(_), Some(SoakEvent::Told(EventKind::Fault(hit)))) => {
                    Some(hit)
                }
                _ => None,
            };
            // That one is about the second of two requests, which no drive saw.
            let hit =
                hit.filter(|it| !context.pending || it.effect.passage() == Passage::Delivered);
            match what {
                EventKind::Transaction(it) => {
                    addressed(it, context)?;
                    rest.next_if(|_| hit.is_some());
                    let leaves = hit.map_or(Leaves::INTACT, |hit| hit.effect.leaves());
                    self.answered(it, leaves, &mut frames, context.coding)?;
                }
                EventKind::Fault(hit) => self.spared(hit, &mut frames, context.coding)?,
                EventKind::BadCrc { frame, exception: Some(code), .. } => {
                    let function = frame.get(1).map_or(0, |it| it & 0x7F);
                    let want = exception(function, *code);
                    let want = framed(context.coding, frame[0], &want);
                    self.own(1, &mut frames, |own| same(&own[0], &want))?;
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
        leaves: Leaves,
        frames: &mut Vec<Frame>,
        coding: Coding,
    ) -> Result<(), String> {
        let whole = framed(coding, it.unit, &it.reply);
        let Leaves { before, reply, after } = leaves;
        let is_there = !matches!(reply, LeavingReply::Later | LeavingReply::Nothing);
        let fits = |own: &[Frame]| match (reply, own.get(before)) {
            (LeavingReply::Intact, Some(left)) => same(left, &whole),
            (LeavingReply::Beginning, Some(left)) if whole.starts_with(left) => Ok(()),
            (LeavingReply::Changed, Some(left)) if left[..] != whole[..] => Ok(()),
            (LeavingReply::Changed, _) => Err("a damaged reply is as good as new".into()),
            (LeavingReply::Later | LeavingReply::Nothing, _) => Ok(()),
            (LeavingReply::Intact | LeavingReply::Beginning, _) => Err("no such reply".into()),
        };
        let own = self.own(before + usize::from(is_there) + after, frames, fits)?;
        match reply {
            LeavingReply::Beginning => self.held.push(whole[own[before].len()..].to_vec()),
            LeavingReply::Later => self.held.push(whole.to_vec()),
            LeavingReply::Intact | LeavingReply::Changed | LeavingReply::Nothing => {}
        }
        Ok(())
    }

    /// A rule has acted, and no drive was asked, or all were.
    fn spared(
        &mut self,
        hit: &FaultHit,
        frames: &mut Vec<Frame>,
        coding: Coding,
    ) -> Result<(), String> {
        match hit.effect.passage() {
            Passage::Lost => self.own(0, frames, |_| Ok(())).map(drop),
            Passage::Answered(code) => {
                let fits = |own: &[Frame]| {
                    let exception = exception(function(&own[0], coding) & 0x7F, code);
                    same(&own[0], &framed(coding, hit.unit, &exception))
                };
                self.own(1, frames, fits).map(drop)
            }
            Passage::Delivered if hit.unit == BROADCAST => {
                self.own(hit.effect.leaves().before, frames, |_| Ok(())).map(drop)
            }
            Passage::Delivered => Err(format!("{hit}, but nobody gave an answer")),
        }
    }

    /// The `count` frames that belong to a request, which `fits` them. Those around them were held back until now.
    fn own(
        &mut self,
        count: usize,
        frames: &mut Vec<Frame>,
        fits: impl Fn(&[Frame]) -> Result<(), String>,
    ) -> Result<Vec<Frame>, String> {
        let Some(last) = frames.len().checked_sub(count) else {
            return Err(format!("{} frames left where {count} belong to a request", frames.len()));
        };
        let mut result = Ok(Vec::new());
        for first in (0..=last).rev() {
            let mut others = frames.clone();
            let own: Vec<Frame> = others.drain(first..first + count).collect();
            result = fits(&own).and_then(|()| self.come(&others)).map(|()| own);
            if result.is_ok() {
                frames.clear();
                break;
            }
        }
        result
    }

    /// All of `frames` were held back until now.
    fn come(&mut self, frames: &[Frame]) -> Result<(), String> {
        let mut held = self.held.clone();
        for frame in frames {
            let place = held.iter().position(|it| it[..] == frame[..]);
            held.remove(place.ok_or_else(|| format!("nobody asked for {frame:?}"))?);
        }
        self.held = held;
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
