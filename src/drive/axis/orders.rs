//! Orders to an axis: moves, runs and segments, by command, by an edge or one after the other.

use super::course::{Course, MoveOrigin, MoveRows};
use super::observe::{order_moment, wrapped};
use super::origin::Ratio;
use super::{Axis, segments};
use crate::behaviour::Phase;
use crate::drive::context::DriveContext;
use crate::drive::effects::EffectQueue;
use crate::event::{ChainEnd, DriveEvent, Ignored};
use crate::time::Instant;
use crate::vocabulary::{Input, Lasts, Setting, Target};

/// A motion that has started.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub(in crate::drive) struct SegmentStart {
    /// The position segment that it is.
    pub(in crate::drive) segment: Option<u16>,
    /// The segment at which its chain has gone round without moving anything, and ends.
    pub(in crate::drive) endless: Option<u16>,
}

impl Axis {
    /// Slows down to a standstill by order, or stands `at_once`; a chain is over.
    ///
    /// # Errors
    /// Why that has no effect.
    pub(in crate::drive) fn stop(
        &mut self,
        cx: DriveContext<'_>,
        at_once: bool,
    ) -> Result<(), Ignored> {
        let why = self.at(cx).why_no_stop(at_once);
        self.segments.chain.end();
        match at_once {
            true => self.motor.quick_stop(cx.now),
            false => self.motor.stop(cx.now),
        }
        why.map_or(Ok(()), Err)
    }

    /// Runs: also when it runs already, and with `interrupt` when it moves to a position.
    ///
    /// # Errors
    /// Why it does not.
    pub(in crate::drive) fn start_run(
        &mut self,
        cx: DriveContext<'_>,
        interrupt: bool,
    ) -> Result<(), Ignored> {
        let moment = order_moment(&self.motor);
        if cx.has(Input::ZeroSpeedClamp) {
            return Err(Ignored::Inhibited);
        }
        let ramp = self.run_by_order(cx, moment);
        let over = match self.motor.phase() {
            Phase::Running => true,
            Phase::Moving => interrupt,
            _ => false,
        };
        self.motor.start_run(cx.now, ramp, over)?;
        self.settings.take(cx.registers, moment);
        self.course = Some(Course::Run);
        Ok(())
    }

    /// Moves as the settings of moves say.
    ///
    /// # Errors
    /// Why it does not.
    pub(in crate::drive) fn start_move(
        &mut self,
        cx: DriveContext<'_>,
        absolute: bool,
        interrupt: bool,
    ) -> Result<(), Ignored> {
        self.go_to(cx, MoveRows::Axis, absolute, interrupt)
    }

    /// Starts what the edge of `input` asks for.
    ///
    /// # Errors
    /// Why nothing starts.
    pub(in crate::drive) fn start_by_input(
        &mut self,
        cx: DriveContext<'_>,
        input: Input,
    ) -> Result<SegmentStart, Ignored> {
        match input {
            Input::MoveStart => {
                let interrupt = self.motor.phase() == Phase::Running;
                let settings = self.settings.axis(cx.registers, order_moment(&self.motor));
                let absolute = settings.is_set(Setting::MoveAbsolute);
                self.go_to(cx, MoveRows::Axis, absolute && !interrupt, interrupt)?;
            }
            Input::SegmentStart => {
                let segments = cx.model().wiring.axis.segments.position.as_ref();
                let first = segments.map_or(0, |it| it.first);
                let number = segments::selected(cx.inputs, first);
                return self.start_segment(cx, number, false);
            }
            Input::InterruptStart => {
                let in_position_at = self.at(cx).in_position_at();
                self.interrupt.update(cx, &self.motor, in_position_at);
                self.interrupt.may_start(cx, &self.motor)?;
                self.go_to(cx, MoveRows::Interrupt, false, true)?;
                self.interrupt.start();
            }
            _ => self.start_velocity_segment(cx)?,
        }
        Ok(SegmentStart::default())
    }

    /// The edge that a chain may wait for has come.
    ///
    /// # Errors
    /// None waits for it.
    pub(in crate::drive) fn step_chain(&mut self, now: Instant) -> Result<(), Ignored> {
        if self.segments.chain.step(now) { Ok(()) } else { Err(Ignored::NoChain) }
    }

    /// Goes on with the chain, if it is time to.
    pub(in crate::drive) fn advance_chain(
        &mut self,
        cx: DriveContext<'_>,
        out: &mut EffectQueue,
    ) -> Option<SegmentStart> {
        let why = self.segments.chain.due(cx.now)?;
        let (from, to) = (self.segments.number, self.segments.next(cx));
        let started = segments::target_of(cx.registers, to).and_then(|_| {
            out.change(DriveEvent::ChainStep { from, to, why });
            // The motion under way, if there is one, is that of the segment which gives way.
            self.start_segment(cx, to, true)
        });
        match started {
            Ok(started) => Some(started),
            Err(why) => {
                self.segments.chain.end();
                let end = ChainEnd { decoder: cx.registers.decoder(), at: to, why };
                out.change(DriveEvent::ChainEnded(end));
                None
            }
        }
    }

    /// Starts position segment `number`. In a chain it takes the place of the segment under way; otherwise of a run by an
    /// edge, from where that is.
    fn start_segment(
        &mut self,
        cx: DriveContext<'_>,
        number: u16,
        chained: bool,
    ) -> Result<SegmentStart, Ignored> {
        let running = self.segments.runs_by_edge();
        let absolute = segments::target_of(cx.registers, number)? == Target::Absolute && !running;
        self.motor.may_start(chained || running)?;
        self.go_to(cx, MoveRows::Segment(number), absolute, chained || running)?;
        let goes_on = self.segments.begin(cx, &self.motor, &self.origin, number);
        Ok(SegmentStart { segment: Some(number), endless: (!goes_on).then_some(number) })
    }

    /// By level it needs no start: it has been wanted since the level came. By an edge it may take the place of one that
    /// an edge has started.
    fn start_velocity_segment(&mut self, cx: DriveContext<'_>) -> Result<(), Ignored> {
        if segments::velocity_lasts(cx.registers) == Some(Lasts::Edge) {
            let before = self.segments.velocity.filter(|it| it.by_edge);
            self.motor.may_start(before.is_some())?;
            self.segments.velocity = segments::selected_velocity(cx, true);
            let course = self.course.take();
            let may = self.at(cx).may_run_velocity(before.is_some());
            if may.is_err() {
                self.segments.velocity = before;
            }
            // What begins anew takes its settings anew; what goes on or ends has those that it began with.
            if may.is_err() || self.at(cx).wanted_run().is_none() {
                self.course = course;
            }
            may?;
        }
        match self.segments.velocity {
            None => Err(Ignored::NoSegment),
            Some(_) => Ok(()),
        }
    }

    /// Goes where the settings of a move say; whatever chain there was is over.
    fn go_to(
        &mut self,
        cx: DriveContext<'_>,
        rows: MoveRows,
        absolute: bool,
        interrupt: bool,
    ) -> Result<(), Ignored> {
        let moment = order_moment(&self.motor);
        let settings = self.settings.of(cx.registers, rows.of(cx.model()), moment);
        let (by, ramp) = settings.next_move();
        let reverse = cx.has(Input::ReversePosition);
        let (zero, gear) = (self.origin.zero, Ratio::of(cx.registers));
        // A target is a place as the position register counts, which may have begun anew.
        let position = self.at(cx).position();
        let begun = position - wrapped(cx.registers, position);
        let mut origin = MoveOrigin { from: begun, zero, gear, reverse };
        let target = |here: i64| {
            if !absolute {
                origin.from = gear.units(here.saturating_sub(zero));
            }
            origin.target(by)
        };
        self.motor.start_move(cx.now, target, ramp, interrupt)?;
        self.settings.take(cx.registers, moment);
        self.course = Some(Course::Move { rows, origin });
        self.interrupt.replace(cx.registers);
        self.segments.chain.end();
        Ok(())
    }
}
