//! What holds for an axis whatever it is reported.

use super::*;
use crate::behaviour::effect::Replan;
use crate::motion::Switch;
use crate::vocabulary::{Input, Inputs, LimitStop};
use proptest::prelude::*;

const HOW: Ramp = Ramp {
    speed: 4000.0,
    accel: Slope::Rate(20_000.0),
    decel: Slope::Rate(10_000.0),
    start_speed: 0.0,
};
const COAST: Duration = Duration::from_millis(200);

/// Something that happens to an axis.
#[derive(Debug, Clone, Copy)]
enum MotorOrder {
    Follow {
        power: bool,
        stop: bool,
        quick_stop: bool,
        jog: i8,
    },
    Move {
        target: i64,
        interrupt: bool,
    },
    Run {
        speed: f64,
    },
    /// Settings change on the way.
    Tune {
        speed: f64,
        accel: f64,
        decel: f64,
        by: i64,
    },
    Stop,
    QuickStop,
}

fn ramp(speed: f64) -> Ramp {
    Ramp { speed, ..HOW }
}

/// Orders with the milliseconds before each; where `gentle`, none that changes the speed at once.
fn orders(gentle: bool) -> impl Strategy<Value = Vec<(u64, MotorOrder)>> {
    let level = (prop::bool::weighted(0.8), prop::bool::weighted(0.2), any::<bool>(), -1..2i8);
    let follow = level.prop_map(move |(power, stop, quick_stop, jog)| {
        let quick_stop = quick_stop && stop && !gentle;
        MotorOrder::Follow { power, stop, quick_stop, jog }
    });
    let order = prop_oneof![
        4 => follow,
        3 => (-3000i64..3000, any::<bool>()).prop_map(|(target, interrupt)| MotorOrder::Move { target, interrupt }),
        2 => (-4000.0..4000.0).prop_map(|speed| MotorOrder::Run { speed }),
        3 => (-4000.0..4000.0, 1e3..2e4, 1e4..2e4, -3000i64..3000).prop_map(|(speed, accel, decel, by)| {
            // Now and then the speed becomes 0.
            let speed = if f64::abs(speed) < 400.0 { 0.0 } else { speed };
            MotorOrder::Tune { speed, accel, decel, by }
        }),
        1 => Just(MotorOrder::Stop),
        1 => Just(if gentle { MotorOrder::Stop } else { MotorOrder::QuickStop }),
    ];
    prop::collection::vec((0u64..900, order), 1..25)
}

/// An axis with a clock, as a drive keeps it.
struct MotorBench {
    motor: Motor,
    levels: MotorLevels,
    now: Instant,
    reported: Vec<(Instant, Effect)>,
    /// The greatest jump of a position or a speed, commanded or not, that a change of settings made.
    jump: f64,
    tuned: usize,
}

/// Machines with limits, hard stops, both or neither.
fn machines() -> impl Strategy<Value = Machine> {
    let side = || prop::option::of((100i64..2000, 0i64..300));
    (side(), side(), any::<bool>()).prop_map(|(below, above, stops)| Machine {
        negative_limit: below.map(|(at, _)| -at),
        positive_limit: above.map(|(at, _)| at),
        hard_stop: stops.then(|| {
            let far = |side: Option<(i64, i64)>| side.map_or(2500, |(at, more)| at + more);
            [-far(below), far(above)]
        }),
        ..Machine::default()
    })
}

impl MotorBench {
    fn new(machine: Machine) -> Self {
        let motor = Motor::standing(Instant::ZERO, 0.0, COAST, machine, Some(50.0));
        let levels = MotorLevels { power: true, ..MotorLevels::default() };
        let mut bench =
            Self { motor, levels, now: Instant::ZERO, reported: Vec::new(), jump: 0.0, tuned: 0 };
        bench.follow();
        bench
    }

    fn follow(&mut self) {
        let position = self.motor.state(self.now).position;
        let mut switches = Inputs::default();
        for (switch, signal) in
            [(Switch::PositiveLimit, Input::LimitPos), (Switch::NegativeLimit, Input::LimitNeg)]
        {
            if self.motor.machine().is_active(switch, position) {
                switches.insert(signal);
            }
        }
        self.motor.follow(self.now, MotorLevels { switches, ..self.levels });
        self.levels.jog.iter_mut().for_each(|jog| jog.takes_over = false);
        self.hear();
        if self.motor.take_switch_edge(self.now) {
            self.follow();
        }
    }

    fn hear(&mut self) {
        while let Some(stage) = self.motor.poll_effect() {
            self.reported.push((self.now, stage));
        }
    }

    fn advance_to(&mut self, now: Instant) {
        while let Some((at, _)) = self.motor.next_timer().filter(|(at, _)| *at <= now) {
            self.now = at;
            if self.motor.take_switch_edge(at) {
                self.follow();
            }
            self.motor.advance(at);
            self.follow();
        }
        self.now = now;
    }

    fn obey(&mut self, order: MotorOrder) {
        let now = self.now;
        // Whether it may start is another test's.
        let _ = match order {
            MotorOrder::Follow { power, stop, quick_stop, jog } => {
                let jog = (jog != 0).then(|| ramp(3000.0 * f64::from(jog)));
                let jog = jog.map(|ramp| {
                    let same = self.levels.jog.is_some_and(|before| before.ramp == ramp);
                    Jog { ramp, takes_over: !same, by_position: false }
                });
                self.levels = MotorLevels { power, stop, quick_stop, jog, ..self.levels };
                Ok(())
            }
            MotorOrder::Move { target, interrupt } => {
                self.motor.start_move(now, |here| here + target, HOW, interrupt)
            }
            MotorOrder::Run { speed } => self.motor.start_run(now, ramp(speed), false),
            MotorOrder::Tune { speed, accel, decel, by } => {
                let (accel, decel) = (Slope::Rate(accel), Slope::Rate(decel));
                self.tune(Ramp { speed, accel, decel, start_speed: 0.0 }, by);
                Ok(())
            }
            MotorOrder::Stop => {
                self.motor.stop(now);
                Ok(())
            }
            MotorOrder::QuickStop => {
                self.motor.quick_stop(now);
                Ok(())
            }
        };
        self.hear();
        self.follow();
    }
}

impl MotorBench {
    /// The motion under way goes by `ramp`, and ends `by` counts from here if it ends anywhere.
    fn tune(&mut self, ramp: Ramp, by: i64) {
        let now = self.now;
        let states =
            |motor: &Motor| [motor.position_loop.setpoint(now), motor.position_loop.feedback(now)];
        let (before, phase) = (states(&self.motor), self.motor.phase());
        match phase {
            Phase::Moving => {
                let target = self.motor.position_loop.command_count(now) + by;
                self.motor.retune_move(now, target, ramp);
            }
            Phase::Running => self.motor.retune_run(now, ramp),
            Phase::Stopping => self.motor.retune_stop(now, ramp.decel),
            // Without a speed a level asks for nothing; turning round is an order.
            Phase::Jogging { forward } if ramp.speed != 0.0 => {
                let speed = ramp.speed.abs() * if forward { 1.0 } else { -1.0 };
                let ramp = Ramp { speed, ..ramp };
                self.levels.jog = Some(Jog { ramp, takes_over: false, by_position: false });
                self.follow();
            }
            _ => return,
        }
        if self.motor.phase() == phase {
            self.tuned += 1;
            for (was, is) in before.into_iter().zip(states(&self.motor)) {
                let jumps = [is.position - was.position, is.speed - was.speed];
                self.jump = jumps.iter().fold(self.jump, |most, it| most.max(it.abs()));
            }
        }
    }
}

/// The whole story, looked at every so many milliseconds.
fn play(
    machine: Machine,
    orders: &[(u64, MotorOrder)],
    step_ms: u64,
    mut look: impl FnMut(&MotorBench),
) -> MotorBench {
    let mut bench = MotorBench::new(machine);
    let mut ms = 0;
    let end = (3000, MotorOrder::Stop);
    for (wait, order) in orders.iter().chain([&end]) {
        let until = ms + wait;
        while ms < until {
            ms = (ms + step_ms).min(until);
            bench.advance_to(Instant::from_millis(ms));
            look(&bench);
        }
        bench.obey(*order);
        look(&bench);
    }
    bench
}

proptest! {
    #[test]
    fn slices_of_time_make_no_difference(
        machine in machines(), orders in orders(false), step in 1u64..50,
    ) {
        let seldom = play(machine, &orders, u64::MAX / 2, |_| {});
        let often = play(machine, &orders, step, |_| {});
        prop_assert_eq!(seldom.reported, often.reported);
        prop_assert_eq!(seldom.motor, often.motor);
    }

    #[test]
    fn settings_that_change_make_no_jump(machine in machines(), orders in orders(false)) {
        let bench = play(machine, &orders, u64::MAX / 2, |_| {});
        prop_assert!(bench.jump < 1e-6, "{}", bench.jump);
    }

    #[test]
    fn it_goes_nowhere_without_passing_what_lies_between(
        machine in machines(), orders in orders(false),
    ) {
        let mut last: Option<(Instant, State)> = None;
        let mut worst = 0.0f64;
        play(machine, &orders, 1, |bench| {
            let state = bench.motor.feedback(bench.now);
            if let Some([low, high]) = machine.hard_stop {
                worst = worst.max(low as f64 - state.position).max(state.position - high as f64);
            }
            if bench.motor.next_timer().is_some_and(|(at, _)| at <= bench.now) {
                worst = f64::INFINITY;
            }
            if let Some((at, was)) = last {
                let most = 4000.0 * bench.now.since(at).as_secs_f64();
                worst = worst.max((state.position - was.position).abs() - most);
            }
            worst = worst.max(state.speed.abs() - 4000.0);
            last = Some((bench.now, state));
        });
        prop_assert!(worst < 1e-5, "{}", worst);
    }

    #[test]
    fn the_speed_keeps_to_its_ramps(orders in orders(true)) {
        let mut last: Option<(Instant, f64)> = None;
        let mut worst = 0.0f64;
        play(Machine::default(), &orders, 1, |bench| {
            let speed = bench.motor.feedback(bench.now).speed;
            if let Some((at, was)) = last {
                // To coast takes 200 ms from whatever speed, which is no steeper than the ramps here.
                worst = worst.max((speed - was).abs() - 20_000.0 * bench.now.since(at).as_secs_f64());
            }
            last = Some((bench.now, speed));
        });
        prop_assert!(worst < 1e-5, "{}", worst);
    }

    #[test]
    fn without_power_or_held_it_comes_to_rest(
        machine in machines(), orders in orders(false), held: bool,
    ) {
        let mut bench = play(machine, &orders, u64::MAX / 2, |_| {});
        bench.obey(MotorOrder::Follow { power: held, stop: held, quick_stop: false, jog: 1 });
        let at = bench.now + Duration::from_millis(500);
        bench.advance_to(at);
        prop_assert!(!bench.motor.is_moving());
        let (place, reported) = (bench.motor.state(at), bench.reported.len());
        for (wait, order) in orders {
            bench.advance_to(bench.now + Duration::from_millis(wait));
            if !matches!(order, MotorOrder::Follow { .. }) {
                bench.obey(order);
            }
        }
        prop_assert_eq!(bench.motor.state(bench.now), place);
        prop_assert_eq!(bench.reported.len(), reported);
    }
}

/// The property above would hold for an axis that never follows.
#[test]
fn settings_that_change_are_followed() {
    let mut bench = MotorBench::new(Machine::default());
    bench.obey(MotorOrder::Run { speed: 1000.0 });
    bench.advance_to(Instant::from_millis(500));
    bench.obey(MotorOrder::Tune { speed: 2000.0, accel: 1e4, decel: 1e4, by: 0 });
    bench.advance_to(Instant::from_millis(1000));
    assert_eq!(bench.motor.state(bench.now).speed, 2000.0);
    assert_eq!((bench.tuned, bench.jump), (1, 0.0));
    assert!(bench.reported.iter().any(|(_, it)| *it == Effect::Replanned(Replan::Speed(2000.0))));
}

#[test]
fn says_why_it_does_not_start() {
    let start = |levels: MotorLevels, running: bool| {
        let mut bench = MotorBench::new(Machine::default());
        if running {
            bench.obey(MotorOrder::Run { speed: 1000.0 });
        }
        bench.levels = levels;
        bench.follow();
        bench.motor.start_run(bench.now, ramp(5.0), false)
    };
    let ready = MotorLevels { power: true, ..MotorLevels::default() };
    assert_eq!(start(ready, false), Ok(()));
    assert_eq!(start(ready, true), Err(Ignored::Moving));
    assert_eq!(start(MotorLevels { stop: true, ..ready }, false), Err(Ignored::Held));
    assert_eq!(start(MotorLevels { quick_stop: true, ..ready }, true), Err(Ignored::Held));
    assert_eq!(
        start(MotorLevels { power: false, stop: true, ..ready }, true),
        Err(Ignored::PowerOff)
    );
}

#[test]
fn coasts_only_while_it_moves() {
    let coasts = |pause: bool, until: u64| {
        let mut bench = MotorBench::new(Machine::default());
        bench.obey(MotorOrder::Move { target: 2000, interrupt: false });
        bench.advance_to(Instant::from_millis(300));
        bench.levels.pause = pause;
        bench.follow();
        bench.advance_to(Instant::from_millis(until));
        let held = bench.motor.phase() == Phase::Moving;
        bench.levels.power = false;
        bench.follow();
        (held, bench.reported.iter().any(|(_, it)| *it == Effect::Coasting))
    };
    assert_eq!(coasts(false, 310), (true, true));
    assert_eq!(coasts(true, 2000), (true, false));
}

/// The names of the timers that wake an axis which makes `order`, in their order.
fn wakes(machine: Machine, levels: MotorLevels, order: MotorOrder) -> String {
    let mut bench = MotorBench::new(machine);
    bench.levels = MotorLevels { power: true, ..levels };
    bench.follow();
    bench.obey(order);
    let mut names = Vec::new();
    while let Some((at, timer)) = bench.motor.next_timer() {
        names.push(format!("{timer:?}"));
        bench.advance_to(at);
    }
    names.join(" ")
}

#[test]
fn wakes_by_name() {
    let far = MotorOrder::Move { target: 3000, interrupt: false };
    let (free, no_levels) = (Machine::default(), MotorLevels::default());
    assert_eq!(wakes(free, no_levels, far), "TargetReached");
    let hard_stop = Some([-1600, 1600]);
    let machine = Machine { positive_limit: Some(1500), hard_stop, ..Machine::default() };
    // A limit stops it at once, or on a ramp that may end beyond the hard stop.
    let ramp = MotorLevels { limit_stop: LimitStop::Ramp, ..no_levels };
    assert_eq!(wakes(machine, no_levels, far), "SwitchEdge");
    assert_eq!(wakes(machine, ramp, far), "SwitchEdge HardStop Standstill");
    let soft = MotorLevels { soft_limits: Some([-500, 500]), ..ramp };
    assert_eq!(wakes(free, soft, far), "SoftLimit Standstill");
    // At 4000 counts per second it is 80 behind.
    let deviation = MotorLevels { deviation: Some(79.0), ..no_levels };
    assert_eq!(wakes(free, deviation, far), "DeviationLimit TargetReached");
    assert_eq!(wakes(free, no_levels, MotorOrder::Run { speed: 1000.0 }), "");
    // One that stands at its target arrives at once.
    let nowhere = MotorOrder::Move { target: 0, interrupt: false };
    assert_eq!(wakes(free, no_levels, nowhere), "");
}

#[test]
fn a_paused_move_waits_for_its_level_and_for_nothing_else() {
    let levels = MotorLevels { pause: true, ..MotorLevels::default() };
    let far = MotorOrder::Move { target: 3000, interrupt: false };
    assert_eq!(wakes(Machine::default(), levels, far), "");
}
