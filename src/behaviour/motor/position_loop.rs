//! The position loop: what an axis is told, and where it is.
//!
//! The setpoint is a trajectory. The command is the setpoint as far as a hard stop lets the axis go. The feedback, where the
//! axis is, can be less: in a move, where the position is controlled, the axis runs behind by a lag, which goes along to
//! the stop that may end the move. In a run, a jog, a homing, or when it coasts, it has no lag.

use super::homing::IndexSearch;
use crate::motion::{CrossingDirection, Hit, IndexPulse, Lag, Machine, State, Switch, Trajectory};
use crate::time::Instant;
use std::cmp::Ordering;

/// What becomes of the lag when an axis gets another trajectory.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum LagRule {
    /// The setpoint starts as far ahead as the axis is to be behind, so that the axis goes on at its speed.
    Leads,
    /// The axis stays as far behind as it is.
    Carried,
    /// The setpoint starts where the axis is.
    None,
}

/// How a blocked axis goes on that comes free.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Release {
    /// Along another trajectory.
    Anew(Trajectory),
    /// It makes up for what it is behind, as far as its position is controlled.
    CatchUp,
    /// From where it is: what it did not go meanwhile is lost.
    GoOn,
}

/// What an axis is told, and where it is.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct PositionLoop {
    trajectory: Trajectory,
    /// How far the axis is behind it.
    lag: Lag,
    /// How fast a move makes up for that, 1/s; `None` at once.
    gain: Option<f64>,
    machine: Machine,
    /// The hard stops of the machine, while something else blocks the axis.
    unblocked: Option<Option<[i64; 2]>>,
}

impl PositionLoop {
    /// At rest at `position` of `machine`; `gain` is that of the position controller, 1/s.
    pub(super) fn at_rest(
        now: Instant,
        position: f64,
        machine: Machine,
        gain: Option<f64>,
    ) -> Self {
        let trajectory = Trajectory::rest(now, position);
        Self { trajectory, lag: Lag::NONE, gain, machine, unblocked: None }
    }

    /// The same at rest where the axis is, blocked if it is blocked.
    pub(super) fn switched_on(&self, now: Instant, gain: Option<f64>) -> Self {
        let Self { machine, unblocked, .. } = *self;
        Self { unblocked, ..Self::at_rest(now, self.feedback(now).position, machine, gain) }
    }

    pub(super) fn machine(&self) -> &Machine {
        &self.machine
    }

    pub(super) fn trajectory(&self) -> &Trajectory {
        &self.trajectory
    }

    /// Position and speed that the axis is told, not in whole counts.
    pub(super) fn setpoint(&self, now: Instant) -> State {
        self.trajectory.state(now)
    }

    /// The setpoint as far as a hard stop lets the axis go.
    pub(super) fn command(&self, now: Instant) -> State {
        self.machine.hold(self.setpoint(now))
    }

    /// The last whole count of the command.
    pub(super) fn command_count(&self, now: Instant) -> i64 {
        self.command(now).position.floor() as i64
    }

    /// Position and speed as they are, not in whole counts.
    pub(super) fn feedback(&self, now: Instant) -> State {
        self.machine.hold(self.lag.feedback(&self.trajectory, now))
    }

    /// The last whole count that the axis has reached.
    pub(super) fn position(&self, now: Instant) -> i64 {
        let position = self.lag.position(&self.trajectory, now);
        let [low, high] = self.machine.hard_stop.unwrap_or([i64::MIN, i64::MAX]);
        position.clamp(low, high)
    }

    /// The feedback, but that an axis stands which shows as arrived: the last half of a count takes for ever.
    pub(super) fn shown(&self, now: Instant) -> State {
        match self.settles_at(0.0).is_some_and(|at| at <= now) {
            true => self.command(now),
            false => self.feedback(now),
        }
    }

    /// Counts that the axis is behind its setpoint.
    pub(super) fn behind(&self, now: Instant) -> f64 {
        self.setpoint(now).position - self.feedback(now).position
    }

    /// How far the axis is behind, in counts. A homing is told where the axis is to be, so its command is as far ahead
    /// as the axis is to be behind at its speed, where the position is `controlled`.
    pub(super) fn deviation(&self, now: Instant, controlled: bool) -> f64 {
        match self.gain.filter(|_| controlled && !self.lag.makes_up()) {
            Some(gain) => self.behind(now) + self.feedback(now).speed / gain,
            None => self.behind(now),
        }
    }

    /// Does a hard stop hold the axis back from its setpoint?
    pub(super) fn is_held_back(&self, now: Instant) -> bool {
        self.command(now) != self.setpoint(now)
    }

    /// Does the axis have a lag, which it makes up for?
    pub(super) fn makes_up(&self) -> bool {
        self.lag.makes_up()
    }

    /// Instants after `now` between which what it shows changes in one direction only.
    pub(super) fn marks(&self, now: Instant) -> Vec<Instant> {
        self.lag.marks(&self.trajectory, now)
    }

    /// When the command first shows `position`, a count of the machine; `now` if it is there.
    pub(super) fn reaches(&self, now: Instant, position: i64) -> Option<Instant> {
        // A count is shown from its lower edge on, so from above it begins at the next one.
        let mark = |count: i64, way| self.trajectory.crossing(count as f64, way, now);
        match position.cmp(&self.command_count(now)) {
            Ordering::Equal => Some(now),
            Ordering::Greater => mark(position, CrossingDirection::Rising),
            Ordering::Less => mark(position.saturating_add(1), CrossingDirection::Falling),
        }
    }

    /// When the setpoint is at rest, and the axis within `window` counts of it for good.
    pub(super) fn settles_at(&self, window: f64) -> Option<Instant> {
        self.lag.settles_at(&self.trajectory, window)
    }

    /// When a switch of the machine changes.
    pub(super) fn next_switch_edge(&self, now: Instant) -> Option<Instant> {
        let switches = [Switch::Home, Switch::NegativeLimit, Switch::PositiveLimit];
        let edge = |switch| self.machine.next_edge(switch, &self.trajectory, now).map(|it| it.at);
        switches.into_iter().filter_map(edge).min()
    }

    /// When the axis runs against a hard stop.
    pub(super) fn next_hit(&self, now: Instant) -> Option<Hit> {
        self.machine.next_hit(&self.trajectory, now)
    }

    /// When it comes off one.
    pub(super) fn leaves_hard_stop_at(&self, now: Instant) -> Option<Instant> {
        let [low, high] = self.machine.hard_stop?;
        let falling = self.trajectory.crossing(high as f64, CrossingDirection::Falling, now);
        let rising = self.trajectory.crossing(beyond(low), CrossingDirection::Rising, now);
        [rising, falling].into_iter().flatten().min()
    }

    /// When the setpoint gets `counts` beyond the hard stop that holds the axis.
    pub(super) fn pressed_at(&self, counts: f64, now: Instant) -> Option<Instant> {
        let [low, high] = self.machine.hard_stop?;
        let (low, high) = (low as f64 - counts, (high as f64 + counts).next_up());
        let position = self.setpoint(now).position;
        if position < low || position >= high {
            return Some(now);
        }
        let rising = self.trajectory.crossing(high, CrossingDirection::Rising, now);
        let falling = self.trajectory.crossing(low, CrossingDirection::Falling, now);
        [rising, falling].into_iter().flatten().min()
    }

    /// When the axis gets to be more than `most` counts behind: a hard stop holds it, or it is too slow.
    pub(super) fn exceeds_at(&self, most: f64, now: Instant) -> Option<Instant> {
        let late = self.lag.exceeds_at(&self.trajectory, most, now);
        [late, self.pressed_at(most, now)].into_iter().flatten().min()
    }

    /// When the setpoint gets beyond the limit `at` that lies in the direction in which it goes.
    pub(super) fn passes_limit_at(&self, at: i64, forward: bool, now: Instant) -> Option<Instant> {
        match forward {
            true => self.trajectory.crossing(beyond(at), CrossingDirection::Rising, now),
            false => self.trajectory.crossing(at as f64, CrossingDirection::Falling, now),
        }
    }

    /// The next index mark that is passed and looked for.
    pub(super) fn next_index(&self, now: Instant, search: IndexSearch) -> Option<IndexPulse> {
        let way = match search.forward {
            true => CrossingDirection::Rising,
            false => CrossingDirection::Falling,
        };
        // While the axis turns round it may pass marks the other way.
        let after = self.trajectory.goes_at(way, now)?;
        let index = self.machine.index.or(Some(search.marks));
        match search.only {
            Some(mark) => self.machine.index_at(mark, way, &self.trajectory, after),
            None => Machine { index, ..self.machine }.next_index(&self.trajectory, after),
        }
    }

    /// From where a move starts: ahead of the command, where the axis goes without a lag so far.
    pub(super) fn move_start(&self, now: Instant) -> State {
        self.lead(now).0
    }

    fn lead(&self, now: Instant) -> (State, Lag) {
        let state = self.command(now);
        match self.gain {
            Some(gain) if self.lag == Lag::NONE => {
                let ahead = State { position: state.position + state.speed / gain, ..state };
                (ahead, Lag::at_speed(gain, state.speed))
            }
            _ => (state, self.carried_lag(now)),
        }
    }

    /// The lag as it goes along to the next trajectory, which starts where a hard stop lets the command be.
    fn carried_lag(&self, now: Instant) -> Lag {
        self.lag.with_deviation(self.command(now).position - self.feedback(now).position)
    }

    /// Begins `trajectory`. Does the command jump?
    pub(super) fn begin(&mut self, now: Instant, trajectory: Trajectory, rule: LagRule) -> bool {
        self.lag = match rule {
            LagRule::Leads => self.lead(now).1,
            LagRule::Carried => self.carried_lag(now),
            LagRule::None => Lag::NONE,
        };
        let jumps = trajectory.state(now).position != self.command(now).position;
        self.trajectory = trajectory;
        jumps
    }

    /// Goes on along `trajectory`, which starts where the present one is.
    pub(super) fn go_on(&mut self, now: Instant, trajectory: Trajectory) {
        self.lag = self.lag.with_deviation(self.lag.deviation(&self.trajectory, now));
        self.trajectory = trajectory;
    }

    /// The setpoint goes on `by` counts further on.
    pub(super) fn shift(&mut self, now: Instant, by: f64) {
        self.trajectory = self.trajectory.left(now, by);
    }

    /// The setpoint is at rest where the axis is.
    pub(super) fn rest_here(&mut self, now: Instant) {
        self.trajectory = Trajectory::rest(now, self.feedback(now).position);
    }

    /// The axis gives up what it is behind.
    pub(super) fn forget_lag(&mut self) {
        self.lag = self.lag.with_deviation(0.0);
    }

    /// Counts the other way, at rest: the same place has the other sign.
    pub(super) fn reverse(&mut self, now: Instant) {
        let command = self.command(now).position;
        self.lag = self.lag.with_deviation(self.feedback(now).position - command);
        self.trajectory = Trajectory::rest(now, 0.0 - command);
        self.machine = self.machine.mirrored();
    }

    pub(super) fn is_blocked(&self) -> bool {
        self.unblocked.is_some()
    }

    /// Something blocks the axis at the count where it is: it stands between two hard stops there, so everything that hard
    /// stops lead to follows.
    pub(super) fn block(&mut self, now: Instant) {
        let at = self.position(now);
        let own = self.machine.hard_stop.replace([at, at]);
        self.unblocked.get_or_insert(own);
    }

    /// A blocked axis comes free. Was it blocked?
    pub(super) fn unblock(&mut self, now: Instant, release: Release) -> bool {
        let Some(own) = self.unblocked.take() else { return false };
        let behind = self.behind(now);
        self.machine.hard_stop = own;
        match release {
            Release::Anew(trajectory) => self.trajectory = trajectory,
            Release::CatchUp if self.lag.makes_up() => {
                self.lag = self.lag.with_deviation(behind);
                self.shift(now, 0.0);
            }
            Release::CatchUp | Release::GoOn => self.shift(now, -behind),
        }
        true
    }
}

/// The first position that is more than `mark`.
fn beyond(mark: i64) -> f64 {
    (mark as f64).next_up()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::motion::Move;

    const HOW: Move = Move { start_speed: 0.0, speed: 1000.0, accel: 1e4, decel: 1e4 };

    fn ms(ms: u64) -> Instant {
        Instant::from_millis(ms)
    }

    /// On its way from 0 to 5000; at 1000 counts per second and a gain of 50/s it is 20 counts behind.
    fn moving(machine: Machine) -> PositionLoop {
        let mut at = PositionLoop::at_rest(ms(0), 0.0, machine, Some(50.0));
        let trajectory = Trajectory::to_position(ms(0), at.move_start(ms(0)), 5000, HOW);
        assert!(!at.begin(ms(0), trajectory, LagRule::Leads));
        at
    }

    #[test]
    fn a_move_runs_behind_and_a_run_does_not() {
        let at = moving(Machine::default());
        let now = ms(1000);
        assert!((at.deviation(now, true) - 20.0).abs() < 0.01, "{}", at.deviation(now, true));
        assert_eq!(at.command(now).position - at.feedback(now).position, at.behind(now));
        let mut at = at;
        let here = at.feedback(now);
        assert!(at.begin(now, Trajectory::to_speed(now, here, 1000.0, 1e4, 1e4), LagRule::None));
        assert_eq!(at.behind(ms(1500)), 0.0);
        // A move that takes its place commands as far ahead as the axis is to be behind.
        let from = at.move_start(ms(1500));
        assert!((from.position - at.feedback(ms(1500)).position - 20.0).abs() < 0.01, "{from:?}");
    }

    #[test]
    fn a_hard_stop_holds_the_command_back_but_not_the_setpoint() {
        let at = moving(Machine { hard_stop: Some([-100, 800]), ..Machine::default() });
        let hit = at.next_hit(ms(0)).expect("it goes beyond");
        assert_eq!(hit.position, 800);
        let now = ms(2000);
        assert!(at.is_held_back(now) && at.setpoint(now).position > 1000.0);
        assert_eq!((at.position(now), at.command_count(now)), (800, 800));
        let pressed = at.pressed_at(100.0, ms(0)).expect("it goes on");
        assert_eq!(at.setpoint(pressed).position.floor(), 900.0);
    }

    #[test]
    fn a_blocked_axis_catches_up_begins_anew_or_goes_on() {
        let blocked = || {
            let mut at = moving(Machine::default());
            at.block(ms(1000));
            let here = at.position(ms(1000));
            assert_eq!((at.is_blocked(), at.position(ms(2000))), (true, here));
            (at, here as f64)
        };
        let now = ms(2000);
        let (mut at, here) = blocked();
        let setpoint = at.setpoint(now);
        assert!(at.unblock(now, Release::CatchUp));
        assert_eq!((at.setpoint(now), at.feedback(now).position), (setpoint, here));
        assert_eq!(at.position(ms(60_000)), 5000);
        let (mut at, here) = blocked();
        assert!(at.unblock(now, Release::GoOn));
        assert_eq!(at.setpoint(now).position, here);
        let (mut at, here) = blocked();
        let rest = Trajectory::rest(now, here);
        assert!(at.unblock(now, Release::Anew(rest)));
        assert_eq!(at.setpoint(now), State::at_rest(here));
        assert!(!at.unblock(now, Release::GoOn), "it is free already");
    }

    #[test]
    fn the_other_way_round_it_is_in_the_same_place() {
        let mut at = moving(Machine { positive_limit: Some(700), ..Machine::default() });
        let trajectory = Trajectory::halt(ms(600), at.command(ms(600)));
        at.begin(ms(600), trajectory, LagRule::Carried);
        let (now, before) = (ms(5000), at.feedback(ms(5000)).position);
        at.reverse(now);
        assert!((at.feedback(now).position + before).abs() < 1e-6);
        assert_eq!(at.machine().negative_limit, Some(-699));
    }
}
