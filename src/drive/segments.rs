//! Moves and runs that rising edges start, by number and in chains.

use super::Drive;
use super::course::{Course, MoveOrigin, MoveRows};
use crate::behaviour::{ChainRule, MOST_WAITS, Phase, Wait};
use crate::event::{Change, Ignored};
use crate::model::{ChainLink, ChainRules};
use crate::time::Duration;
use crate::vocabulary::{Condition, Input, Inputs, Lasts, Setting, Target};

impl Drive {
    /// Starts what the edges in `risen` ask for, in the order of the catalogue.
    pub(super) fn start_by_inputs(&mut self, risen: Inputs) {
        let starts = [
            Input::MoveStart,
            Input::SegmentStart,
            Input::SegmentStep,
            Input::SegmentRun,
            Input::InterruptStart,
        ];
        for input in starts.into_iter().filter(|it| risen.has(*it)) {
            let started = match input {
                Input::MoveStart => self.start_move(),
                Input::SegmentStart => self.start_position_segment(),
                Input::SegmentStep => self.step_chain(),
                Input::InterruptStart => self.start_interrupt(),
                _ => self.start_velocity_segment(),
            };
            self.heed(input, started);
            self.update_axis();
        }
    }

    /// The number that is selected, where the first is `first`.
    pub(super) fn selected(&self, first: u16) -> u16 {
        let selects = [Input::Select0, Input::Select1, Input::Select2, Input::Select3];
        let bit = |(bit, input)| u16::from(self.inputs.has(input)) << bit;
        selects.into_iter().enumerate().map(bit).fold(first, u16::saturating_add)
    }

    /// The position segment that comes next.
    pub(super) fn next_segment(&self) -> u16 {
        let Some(segments) = &self.model.wiring.axis.segments.position else { return 0 };
        let link = segments.get(self.segment).and_then(|it| it.link.as_ref());
        match link.filter(|_| self.chain.is_under_way()) {
            Some(link) => {
                u16::try_from(self.bank.value(&self.model, link.next)).unwrap_or(u16::MAX)
            }
            None => self.selected(segments.first),
        }
    }

    /// Lets go of what is over: a chain that something broke off, a run by an edge that has ended. Where
    /// the axis has arrived, the chain is told.
    pub(super) fn settle_segments(&mut self, free: bool) {
        self.settle_interrupt();
        let phase = self.motor.phase();
        let arrived = self.motor.has_arrived();
        if !(free && (arrived || phase == Phase::Moving)) {
            self.chain.end();
        } else if let Some(at) = self.in_position_at(self.now) {
            self.chain.arrive(self.now, at);
        }
        let waits = free && self.inputs.has(Input::ZeroSpeedClamp);
        if !matches!(phase, Phase::Jogging { .. }) && !waits {
            self.velocity = self.velocity.filter(|it| !it.by_edge);
        }
    }

    /// Goes on with the chain, if it is time to.
    pub(super) fn advance_chain(&mut self) {
        let Some(why) = self.chain.due(self.now) else { return };
        let (from, to) = (self.segment, self.next_segment());
        if let Err(why) = self.target_of(to) {
            return self.end_chain(to, why);
        }
        self.changes.push_back(Change::ChainStep { from, to, why });
        // The motion under origin, if there is one, is that of the segment which gives origin.
        match self.move_by_segment(to, true) {
            Ok(()) => self.update_axis(),
            Err(why) => self.end_chain(to, why),
        }
    }

    fn end_chain(&mut self, at: u16, why: Ignored) {
        self.chain.end();
        self.changes.push_back(Change::ChainEnded { at, why });
    }

    fn start_move(&mut self) -> Result<(), Ignored> {
        let interrupt = self.motor.phase() == Phase::Running;
        let absolute = self.axis(self.order_moment()).is_set(Setting::MoveAbsolute);
        self.go_to(MoveRows::AxisWiring, absolute && !interrupt, interrupt)
    }

    fn start_position_segment(&mut self) -> Result<(), Ignored> {
        let segments = self.model.wiring.axis.segments.position.as_ref();
        let first = segments.map_or(0, |it| it.first);
        self.move_by_segment(self.selected(first), false)
    }

    /// Starts position segment `number`. In a chain it takes the place of the segment under origin; otherwise
    /// of a run by an edge, from where that is.
    fn move_by_segment(&mut self, number: u16, chained: bool) -> Result<(), Ignored> {
        let model = self.model.clone();
        let segments = model.wiring.axis.segments.position.as_ref().ok_or(Ignored::NoSegment)?;
        let segment = segments.get(number).ok_or(Ignored::NoSegment)?;
        let running = self.velocity.is_some_and(|it| it.by_edge);
        let absolute = self.target_of(number)? == Target::Absolute && !running;
        self.motor.may_start(chained || running)?;
        self.go_to(MoveRows::Segment(number), absolute, chained || running)?;
        self.segment = number;
        if let (Some(rules), Some(link)) = (&segments.chain, &segment.link) {
            let rule = self.chain_rule(rules, link);
            if !self.chain.begin(self.now, rule) {
                self.end_chain(number, Ignored::NoMotion);
            }
        }
        Ok(())
    }

    /// What the target of position segment `number` is, if there is such a segment and it is not empty.
    fn target_of(&self, number: u16) -> Result<Target, Ignored> {
        let segments = self.model.wiring.axis.segments.position.as_ref();
        let segment = segments.and_then(|it| it.get(number)).ok_or(Ignored::NoSegment)?;
        let target = segment.kind.get(|row| self.bank.value(&self.model, row));
        target.filter(|it| *it != Target::None).ok_or(Ignored::NoSegment)
    }

    fn step_chain(&mut self) -> Result<(), Ignored> {
        if !self.chain.step(self.now) {
            return Err(Ignored::NoChain);
        }
        self.advance_chain();
        Ok(())
    }

    /// By level it needs no start: it has been wanted since the level came. By an edge it may take the place of one that
    /// an edge has started.
    fn start_velocity_segment(&mut self) -> Result<(), Ignored> {
        if self.velocity_lasts() == Some(Lasts::Edge) {
            let before = self.velocity.filter(|it| it.by_edge);
            self.motor.may_start(before.is_some())?;
            self.velocity = self.selected_velocity(true);
            let course = self.course.take();
            let may = self.may_run_velocity(before.is_some());
            if may.is_err() {
                self.velocity = before;
            }
            // What begins anew takes its settings anew; what goes on or ends has those that it began with.
            if may.is_err() || self.wanted_run().is_none() {
                self.course = course;
            }
            may?;
        }
        match self.velocity {
            None => Err(Ignored::NoSegment),
            Some(_) => Ok(()),
        }
    }

    /// May the velocity segment begin that is selected? At speed 0 it ends one that is under origin; while speeds are clamped
    /// to 0 it waits.
    fn may_run_velocity(&self, under_way: bool) -> Result<(), Ignored> {
        match self.wanted_run() {
            Some((_, ramp)) => self.motor.may_go(self.now, ramp.speed),
            None if self.velocity.is_none() => Err(Ignored::NoSegment),
            None if under_way || self.inputs.has(Input::ZeroSpeedClamp) => Ok(()),
            None => Err(Ignored::NoSpeed),
        }
    }

    /// Goes where the settings of a move say; whatever chain there was is over.
    pub(super) fn go_to(
        &mut self,
        rows: MoveRows,
        absolute: bool,
        interrupt: bool,
    ) -> Result<(), Ignored> {
        let moment = self.order_moment();
        let (by, ramp) = self.settings(self.move_rows(rows), moment).next_move();
        let reverse = self.inputs.has(Input::ReversePosition);
        let (now, zero, gear) = (self.now, self.zero, self.gear());
        // A target is a place as the position register counts, which may have begun anew.
        let begun = self.position(self.now) - self.wrapped(self.position(self.now));
        let mut origin = MoveOrigin { from: begun, zero, gear, reverse };
        let target = |here: i64| {
            if !absolute {
                origin.from = gear.units(here.saturating_sub(zero));
            }
            origin.target(by)
        };
        self.motor.start_move(now, target, ramp, interrupt)?;
        self.take_settings(moment);
        self.course = Some(Course::Move { rows, origin });
        self.tell_stages(rows.segment());
        self.replace_interrupt();
        self.chain.end();
        Ok(())
    }

    /// Finds out anew when the axis comes to the places that its chain waits for.
    pub(super) fn look_at_places(&mut self) {
        let (now, motor) = (self.now, &self.motor);
        self.chain.sample(now, |place| motor.reaches(now, place));
    }

    /// What the rows of a segment say about when it gives origin.
    fn chain_rule(&self, rules: &ChainRules, link: &ChainLink) -> ChainRule {
        let raw = self.bank.raw(link.rule);
        let is_set = |bit: Option<u8>| bit.is_some_and(|bit| raw >> bit & 1 != 0);
        let mut waits = [None; MOST_WAITS];
        for (slot, (i, condition)) in waits.iter_mut().zip(rules.conditions(raw)) {
            let value = rules.value(condition, self.bank.value(&self.model, link.values[i]));
            *slot = Some(match condition {
                Condition::Delay => {
                    // Where it is more than there is time for, it never comes.
                    let time = Duration::try_from_secs_f64(value.max(0.0));
                    Wait::Delay(time.unwrap_or(Duration::MAX))
                }
                Condition::Step => Wait::Step,
                Condition::Position => {
                    let place = self.place(value.round() as i64);
                    Wait::Position { place, at: self.motor.reaches(self.now, place) }
                }
            });
        }
        ChainRule { waits, all: is_set(rules.all), through: is_set(rules.through) }
    }
}
