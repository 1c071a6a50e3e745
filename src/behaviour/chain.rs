//! A chain of segments: when the segment under way gives way to the next one.
//!
//! Each condition is an instant from which on it is met, so the instant at which the chain goes on is known
//! as soon as they are: nothing is looked at in between. Which segment comes next, and how the axis goes
//! there, is for others to say.

use crate::time::{Duration, Instant};
use crate::vocabulary::Condition;

/// Most conditions of a segment.
pub const MOST_WAITS: usize = 4;

/// A chain may take this many steps in one instant. One that takes more goes round without moving anything
/// and would never be done.
const MOST_STEPS_AT_ONCE: u16 = 256;

/// What a segment waits for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Wait {
    /// So much time in position.
    Delay(Duration),
    /// A rising edge.
    Step,
    /// The axis at a place.
    Position {
        /// A count of the machine.
        place: i64,
        /// When it gets there, if at all.
        at: Option<Instant>,
    },
}

impl Wait {
    fn condition(self) -> Condition {
        match self {
            Self::Delay(_) => Condition::Delay,
            Self::Step => Condition::Step,
            Self::Position { .. } => Condition::Position,
        }
    }
}

/// When a segment gives way.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct ChainRule {
    /// What it waits for. Nothing at all: for the position with `through`, else for ever.
    pub waits: [Option<Wait>; MOST_WAITS],
    /// For all of them instead of the first.
    pub all: bool,
    /// It gives way in motion; otherwise it is done first.
    pub through: bool,
}

impl ChainRule {
    /// Is there nothing that a segment could wait for?
    fn is_last(&self) -> bool {
        self.waits.iter().all(Option::is_none) && !self.through
    }
}

/// A chain, under way or not.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Chain {
    under_way: Option<ChainState>,
    /// When a segment began last.
    began: Instant,
    /// How many have begun at that instant before.
    at_once: u16,
}

/// The segment under way.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
struct ChainState {
    rule: ChainRule,
    /// Since when it stands in position.
    arrived: Option<Instant>,
    /// When the edge came.
    stepped: Option<Instant>,
}

impl Chain {
    /// Is a segment under way, or waiting to give way?
    pub fn is_under_way(&self) -> bool {
        self.under_way.is_some()
    }

    /// A segment begins, the first of a chain or the next. False where the chain has gone round without moving anything,
    /// and ends with it.
    pub fn begin(&mut self, now: Instant, rule: ChainRule) -> bool {
        self.at_once = if self.began == now { self.at_once + 1 } else { 0 };
        self.began = now;
        let goes_on = self.at_once < MOST_STEPS_AT_ONCE;
        let link = ChainState { rule, arrived: None, stepped: None };
        self.under_way = (goes_on && !rule.is_last()).then_some(link);
        goes_on
    }

    /// Nothing follows.
    pub fn end(&mut self) {
        self.under_way = None;
    }

    /// The axis stands in position from `at` on, which may be yet to come; what has not come by `now` may change.
    pub fn arrive(&mut self, now: Instant, at: Instant) {
        for link in self.under_way.iter_mut().filter(|it| it.arrived.is_none_or(|it| it > now)) {
            link.arrived = Some(at);
        }
    }

    /// Places that the axis has not come to by `now` it comes to when `reaches` says.
    pub fn sample(&mut self, now: Instant, reaches: impl Fn(i64) -> Option<Instant>) {
        let waits = self.under_way.iter_mut().flat_map(|link| &mut link.rule.waits).flatten();
        for wait in waits {
            if let Wait::Position { place, at } = wait
                && at.is_none_or(|at| at > now)
            {
                *at = reaches(*place);
            }
        }
    }

    /// The edge came. Does the segment under way wait for it?
    pub fn step(&mut self, now: Instant) -> bool {
        let Some(link) = &mut self.under_way else { return false };
        let waits = link.rule.waits.contains(&Some(Wait::Step)) && link.stepped.is_none();
        link.stepped.get_or_insert(now);
        waits
    }

    /// When it goes on by itself.
    pub fn deadline(&self) -> Option<Instant> {
        self.under_way.and_then(|link| link.done()).map(|(at, _)| at)
    }

    /// Does it go on? Then why: the condition that decided, or none if there are none.
    pub fn due(&self, now: Instant) -> Option<Option<Condition>> {
        let (at, why) = self.under_way?.done()?;
        (at <= now).then_some(why)
    }
}

impl ChainState {
    /// When the segment is done with, and what decided that.
    fn done(&self) -> Option<(Instant, Option<Condition>)> {
        let ChainRule { waits, all, through } = self.rule;
        let mut waits = waits.into_iter().flatten().peekable();
        if waits.peek().is_none() {
            return self.arrived.map(|at| (at, None));
        }
        let mut met = waits.map(|it| self.met(it).map(|at| (at, it.condition())));
        let (at, why) = match all {
            true => met.try_fold(None, |last, it| it.map(|it| last.max(Some(it))))??,
            false => met.flatten().min()?,
        };
        let arrived = if through { Some(at) } else { self.arrived };
        arrived.map(|arrived| (at.max(arrived), Some(why)))
    }

    /// Since when a condition is met.
    fn met(&self, wait: Wait) -> Option<Instant> {
        match wait {
            Wait::Delay(time) => self.arrived.map(|at| at + time),
            Wait::Step => self.stepped,
            Wait::Position { at, .. } => at,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const DELAY: Wait = Wait::Delay(Duration::from_millis(50));

    fn ms(ms: u64) -> Instant {
        Instant::from_millis(ms)
    }

    /// When a segment gives way that begins at 0, gets its edge at 30 and arrives at 100.
    fn done(waits: &[Wait], all: bool, through: bool) -> Option<(Instant, Option<Condition>)> {
        let mut rule = ChainRule { all, through, ..ChainRule::default() };
        rule.waits.iter_mut().zip(waits).for_each(|(slot, wait)| *slot = Some(*wait));
        let mut chain = Chain::default();
        chain.begin(ms(0), rule);
        chain.step(ms(30));
        chain.step(ms(35));
        chain.arrive(ms(100), ms(100));
        chain.arrive(ms(105), ms(105));
        let at = chain.deadline()?;
        assert_eq!(chain.due(ms(0)), None);
        chain.due(at).map(|why| (at, why))
    }

    #[test]
    fn conditions_alone() {
        let place = |at| Wait::Position { place: 7, at: Some(ms(at)) };
        assert_eq!(done(&[DELAY], false, true), Some((ms(150), Some(Condition::Delay))));
        assert_eq!(done(&[Wait::Step], false, true), Some((ms(30), Some(Condition::Step))));
        assert_eq!(done(&[place(60)], false, true), Some((ms(60), Some(Condition::Position))));
        assert_eq!(done(&[Wait::Position { place: 7, at: None }], false, true), None);
        // Without `through` the segment is done first.
        assert_eq!(done(&[Wait::Step], false, false), Some((ms(100), Some(Condition::Step))));
        assert_eq!(done(&[DELAY], false, false), Some((ms(150), Some(Condition::Delay))));
    }

    #[test]
    fn conditions_together() {
        let either = done(&[DELAY, Wait::Step], false, true);
        assert_eq!(either, Some((ms(30), Some(Condition::Step))));
        let both = done(&[DELAY, Wait::Step], true, true);
        assert_eq!(both, Some((ms(150), Some(Condition::Delay))));
        let never = Wait::Position { place: 7, at: None };
        assert_eq!(done(&[never, Wait::Step], false, true), Some((ms(30), Some(Condition::Step))));
        assert_eq!(done(&[never, Wait::Step], true, true), None);
    }

    #[test]
    fn without_conditions_it_stops_or_goes_on_in_position() {
        assert_eq!(done(&[], false, false), None);
        assert_eq!(done(&[], true, true), Some((ms(100), None)));
    }

    #[test]
    fn what_never_moves_comes_to_an_end() {
        let mut chain = Chain::default();
        let rule = ChainRule { through: true, ..ChainRule::default() };
        let mut steps = 0;
        chain.begin(ms(5), rule);
        while chain.is_under_way() {
            chain.arrive(ms(5), ms(5));
            assert_eq!(chain.due(ms(5)), Some(None));
            steps += 1;
            assert_eq!(chain.begin(ms(5), rule), steps < MOST_STEPS_AT_ONCE);
        }
        assert_eq!(steps, MOST_STEPS_AT_ONCE);
        assert!(chain.begin(ms(6), rule));
        assert!(chain.is_under_way());
    }
}
