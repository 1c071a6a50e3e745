//! What stands along the axis: switches, index marks, hard stops, in the machine's own coordinate.
//!
//! Pure geometry: it says what is active at a position and when a trajectory gets to the next mark. What
//! a drive does about it is not known here.

use super::{CrossingDirection, State, Trajectory};
use crate::time::Instant;

/// What stands along one axis, in counts.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Machine {
    /// Where the home switch is active.
    pub home: Option<Zone>,
    /// The negative limit switch is active below this.
    pub negative_limit: Option<i64>,
    /// The positive limit switch is active from this on.
    pub positive_limit: Option<i64>,
    /// The axis gets from the first to the second, both included, and no further.
    pub hard_stop: Option<[i64; 2]>,
    /// Marks of the encoder.
    pub index: Option<Index>,
}

/// Counts from `from` to before `to`.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Zone {
    /// The first count inside.
    pub from: i64,
    /// The first count beyond.
    pub to: i64,
}

/// Marks at `offset` and every `every` counts from there, both ways.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Index {
    /// Counts from one mark to the next; without any, below 1, there is none.
    pub every: i64,
    /// The count of one of them.
    pub offset: i64,
}

/// A switch beside the axis.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Switch {
    /// The home switch.
    Home,
    /// The limit switch at the negative end.
    NegativeLimit,
    /// The limit switch at the positive end.
    PositiveLimit,
}

/// A switch changes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct SwitchEdge {
    /// When.
    pub at: Instant,
    /// Is it active from then on?
    pub active: bool,
}

/// An index mark is passed.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct IndexPulse {
    /// When.
    pub at: Instant,
    /// The count of the mark.
    pub mark: i64,
    /// In which way.
    pub way: CrossingDirection,
}

/// The axis runs against a hard stop.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Hit {
    /// When.
    pub at: Instant,
    /// Where it gets stuck.
    pub position: i64,
    /// In which way.
    pub way: CrossingDirection,
}

impl Machine {
    /// The same seen from the other side: every count has the other sign, and the ends have changed places.
    #[must_use]
    pub fn mirrored(&self) -> Self {
        // A switch that was active from a count on is active up to it.
        let edge = |it: i64| 1i64.saturating_sub(it);
        Self {
            home: self.home.map(|it| Zone { from: edge(it.to), to: edge(it.from) }),
            negative_limit: self.positive_limit.map(edge),
            positive_limit: self.negative_limit.map(edge),
            hard_stop: self.hard_stop.map(|[low, high]| [high, low].map(i64::saturating_neg)),
            index: self.index.map(|it| Index { offset: it.offset.saturating_neg(), ..it }),
        }
    }

    /// Is `switch` active with the axis at `position`? One that is not there never is.
    pub fn is_active(&self, switch: Switch, position: f64) -> bool {
        self.span(switch).is_some_and(|[from, to]| from <= position && position < to)
    }

    /// Is `switch` there at all?
    pub fn has(&self, switch: Switch) -> bool {
        self.span(switch).is_some()
    }

    /// The next change of `switch` after `after`.
    pub fn next_edge(&self, switch: Switch, of: &Trajectory, after: Instant) -> Option<SwitchEdge> {
        let [from, to] = self.span(switch)?;
        let edge =
            |mark, way, active| Some(SwitchEdge { at: of.crossing(mark, way, after)?, active });
        let edges = [
            edge(from, CrossingDirection::Rising, true),
            edge(to, CrossingDirection::Rising, false),
            edge(to, CrossingDirection::Falling, true),
            edge(from, CrossingDirection::Falling, false),
        ];
        edges.into_iter().flatten().min_by_key(|it| it.at)
    }

    /// The next index mark passed after `after`, in either way. Downwards a mark is passed when the
    /// axis leaves it. None is passed beyond a hard stop.
    pub fn next_index(&self, of: &Trajectory, after: Instant) -> Option<IndexPulse> {
        let Index { every, offset } = self.index.filter(|it| it.every > 0)?;
        // The first mark to be passed is one of the two neighbours.
        let low = below(of.position(after), every, offset)?;
        let high = low.checked_add(every)?;
        let pulse = |mark, way| self.index_at(mark, way, of, after);
        let pulses =
            [pulse(low, CrossingDirection::Falling), pulse(high, CrossingDirection::Rising)];
        pulses.into_iter().flatten().min_by_key(|it| it.at)
    }

    /// When `mark`, an index mark, is passed after `after` in the given way.
    pub fn index_at(
        &self,
        mark: i64,
        way: CrossingDirection,
        of: &Trajectory,
        after: Instant,
    ) -> Option<IndexPulse> {
        let within = self.hard_stop.is_none_or(|[low, high]| low < mark && mark <= high);
        let at = of.crossing(mark as f64, way, after).filter(|_| within)?;
        Some(IndexPulse { at, mark, way })
    }

    /// Where the axis is if it is told to be at `state`: a hard stop holds it.
    pub fn hold(&self, state: State) -> State {
        match self.hard_stop {
            Some([low, _]) if state.position < low as f64 => State::at_rest(low as f64),
            Some([_, high]) if state.position > high as f64 => State::at_rest(high as f64),
            _ => state,
        }
    }

    /// When the axis next runs against a hard stop: the first instant after `after` at which the
    /// trajectory is beyond it. From there on it is where the axis would be.
    pub fn next_hit(&self, of: &Trajectory, after: Instant) -> Option<Hit> {
        let [low, high] = self.hard_stop?;
        let hit = |position: i64, mark, way| {
            let at = of.crossing(mark, way, after)?;
            Some(Hit { at, position, way })
        };
        // To stand on the stop is allowed, so the mark above is the next number.
        let high = hit(high, (high as f64).next_up(), CrossingDirection::Rising);
        let hits = [hit(low, low as f64, CrossingDirection::Falling), high];
        hits.into_iter().flatten().min_by_key(|it| it.at)
    }

    /// Where `switch` is active, from and before. A limit switch is active without end.
    fn span(&self, switch: Switch) -> Option<[f64; 2]> {
        match switch {
            Switch::Home => {
                let Zone { from, to } = self.home.filter(|it| it.from < it.to)?;
                Some([from as f64, to as f64])
            }
            Switch::NegativeLimit => Some([f64::NEG_INFINITY, self.negative_limit? as f64]),
            Switch::PositiveLimit => Some([self.positive_limit? as f64, f64::INFINITY]),
        }
    }
}

/// The last mark at or below `count`.
fn below(count: i64, every: i64, offset: i64) -> Option<i64> {
    count.checked_sub(offset)?.div_euclid(every).checked_mul(every)?.checked_add(offset)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::motion::{Move, State};

    const MACHINE: Machine = Machine {
        home: Some(Zone { from: 500, to: 600 }),
        negative_limit: Some(-200),
        positive_limit: Some(1000),
        hard_stop: Some([-300, 1100]),
        index: Some(Index { every: 700, offset: 100 }),
    };

    fn run(from: i64, to: i64) -> Trajectory {
        let how = Move { start_speed: 0.0, speed: 1000.0, accel: 1e4, decel: 1e4 };
        Trajectory::to_position(Instant::ZERO, State::at_rest(from as f64), to, how)
    }

    /// What happens on the way, as `active` at the counts shown one nanosecond before and at the edge.
    fn edges(switch: Switch, of: &Trajectory) -> Vec<(i64, i64, bool)> {
        let mut now = Instant::ZERO;
        let mut edges = Vec::new();
        while let Some(edge) = MACHINE.next_edge(switch, of, now) {
            now = edge.at;
            let before = Instant::from_nanos(now.as_nanos() - 1);
            assert_eq!(MACHINE.is_active(switch, of.state(now).position), edge.active);
            assert_eq!(MACHINE.is_active(switch, of.state(before).position), !edge.active);
            edges.push((of.position(before), of.position(now), edge.active));
        }
        edges
    }

    #[test]
    fn an_edge_lies_where_the_count_changes() {
        assert_eq!(edges(Switch::Home, &run(0, 900)), [(499, 500, true), (599, 600, false)]);
        assert_eq!(edges(Switch::Home, &run(900, 0)), [(600, 599, true), (500, 499, false)]);
        assert_eq!(edges(Switch::NegativeLimit, &run(0, -250)), [(-200, -201, true)]);
        assert_eq!(edges(Switch::PositiveLimit, &run(1050, 0)), [(1000, 999, false)]);
        assert_eq!(edges(Switch::PositiveLimit, &run(0, 900)), []);
    }

    #[test]
    fn resting_on_an_edge_is_above_it() {
        assert_eq!(edges(Switch::Home, &run(0, 500)), [(499, 500, true)]);
        assert_eq!(edges(Switch::Home, &run(900, 600)), []);
        assert_eq!(edges(Switch::Home, &run(500, 700)), [(599, 600, false)]);
    }

    #[test]
    fn what_is_not_there_is_never_active() {
        let none = Machine::default();
        let of = run(-5000, 5000);
        for switch in [Switch::Home, Switch::NegativeLimit, Switch::PositiveLimit] {
            assert!(!none.is_active(switch, 0.0));
            assert_eq!(none.next_edge(switch, &of, Instant::ZERO), None);
        }
        assert_eq!(none.next_hit(&of, Instant::ZERO), None);
        assert_eq!(none.next_index(&of, Instant::ZERO), None);
    }

    #[test]
    fn mirrored_it_is_the_same_machine() {
        let mirrored = MACHINE.mirrored();
        assert_eq!(mirrored.mirrored(), MACHINE);
        let turned = [
            (Switch::Home, Switch::Home),
            (Switch::NegativeLimit, Switch::PositiveLimit),
            (Switch::PositiveLimit, Switch::NegativeLimit),
        ];
        for (count, (one, other)) in (-400..1200).flat_map(|it| turned.map(|pair| (it, pair))) {
            let (here, there) = (f64::from(count), f64::from(-count));
            let same = mirrored.is_active(one, there) == MACHINE.is_active(other, here);
            assert!(same, "{one:?} at {count}");
        }
        let hit = mirrored.next_hit(&run(0, -1200), Instant::ZERO).expect("it goes beyond");
        assert_eq!((hit.position, hit.way), (-1100, CrossingDirection::Falling));
        let mark = mirrored.next_index(&run(0, -200), Instant::ZERO).map(|it| it.mark);
        assert_eq!(mark, Some(-100));
    }

    #[test]
    fn passes_each_index_mark_once() {
        let free = Machine { hard_stop: None, ..MACHINE };
        let marks = |of: Trajectory| {
            let first = free.next_index(&of, Instant::ZERO);
            let pulses = std::iter::successors(first, |it| free.next_index(&of, it.at));
            pulses.map(|it| (it.mark, it.way)).collect::<Vec<_>>()
        };
        let up = [-600, 100, 800, 1500].map(|it| (it, CrossingDirection::Rising));
        assert_eq!(marks(run(-1000, 1500)), up);
        assert_eq!(
            marks(run(1500, -600)),
            [1500, 800, 100].map(|it| (it, CrossingDirection::Falling))
        );
        // Too fast to stop: over the mark and back, or not as far as that.
        let how = Move { start_speed: 0.0, speed: 1000.0, accel: 1e4, decel: 1e4 };
        let over = |position| {
            let from = State { position, speed: 1000.0 };
            Trajectory::to_position(Instant::ZERO, from, 60, how)
        };
        assert_eq!(
            marks(over(80.0)),
            [(100, CrossingDirection::Rising), (100, CrossingDirection::Falling)]
        );
        assert_eq!(marks(over(49.0)), []);
    }

    #[test]
    fn passes_no_index_mark_beyond_a_hard_stop() {
        let mark = |from, to| MACHINE.next_index(&run(from, to), Instant::ZERO).map(|it| it.mark);
        assert_eq!(mark(50, 1500), Some(100));
        assert_eq!(mark(850, 1600), None);
        assert_eq!(mark(50, -1500), None);
    }

    #[test]
    fn gets_stuck_on_a_hard_stop() {
        let of = run(0, 1200);
        let hit = MACHINE.next_hit(&of, Instant::ZERO).expect("it goes beyond");
        assert_eq!(
            (hit.position, hit.way, of.position(hit.at)),
            (1100, CrossingDirection::Rising, 1100)
        );
        // Up to it is not against it; away from it neither; on into it at once.
        assert_eq!(MACHINE.next_hit(&run(0, 1100), Instant::ZERO), None);
        assert_eq!(MACHINE.next_hit(&run(0, -300), Instant::ZERO), None);
        assert_eq!(MACHINE.next_hit(&run(1100, 0), Instant::ZERO), None);
        let again = MACHINE.next_hit(&run(1100, 1200), Instant::ZERO).expect("it pushes");
        assert!(again.at < Instant::from_nanos(100_000), "{again:?}");
        let low = MACHINE.next_hit(&run(-300, -400), Instant::ZERO).expect("it pushes");
        assert_eq!((low.position, low.way), (-300, CrossingDirection::Falling));
    }
}
