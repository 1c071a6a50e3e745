//! The way of a homing as the sentences of a manual make it: ramps and stretches at constant speed, one after the other.
//!
//! Ends where a limit or a hard stop that no sentence is about comes in between: what a drive does then is said elsewhere.

use super::print::{About, Phase, Sentences, Until};
use super::scene::Scene;

/// A stretch of constant acceleration, in counts and seconds since the homing began.
#[derive(Debug, Clone, Copy)]
pub struct Leg {
    pub from: f64,
    pub seconds: f64,
    position: f64,
    speed: f64,
    accel: f64,
}

impl Leg {
    /// Position and speed, that part of the way through it.
    pub fn at(&self, part: f64) -> (f64, f64) {
        let t = part * self.seconds;
        (self.position + self.speed * t + self.accel * t * t / 2.0, self.speed + self.accel * t)
    }
}

/// Speeds in counts a second, the slope in counts a second squared.
#[derive(Debug, Clone, Copy)]
pub struct Speeds {
    pub high: f64,
    pub low: f64,
    pub slope: f64,
    /// Counts of pressing that make a collision.
    pub collision: f64,
}

/// The course of a homing.
pub struct Course<'a> {
    scene: &'a Scene,
    about: About,
    speeds: Speeds,
    position: f64,
    speed: f64,
    now: f64,
    mark: Option<f64>,
    pub legs: Vec<Leg>,
    /// The phases that were gone through to their end.
    pub done: Vec<Phase>,
}

/// What comes first on the way of a phase.
enum Comes {
    /// What it waits for, at this position.
    Wanted(f64),
    /// A limit.
    Limit(f64),
    Nothing,
}

impl<'a> Course<'a> {
    pub fn new(all: &Sentences, speeds: Speeds, scene: &'a Scene) -> Self {
        let position = scene.start as f64;
        let mut it = Self {
            scene,
            about: all.about,
            speeds,
            position,
            speed: 0.0,
            now: 0.0,
            mark: None,
            legs: Vec::new(),
            done: Vec::new(),
        };
        let active = it.zone().is_some_and(|[from, to]| from <= position && position < to);
        let found =
            if active { it.follow(&all.active, &[]) } else { it.follow(&all.idle, &all.at_limit) };
        if let (true, Some(forward)) = (found, all.refined) {
            it.refine(forward);
        }
        it
    }

    /// Goes through the phases. Do they end at the origin?
    fn follow(&mut self, phases: &[Phase], at_limit: &[Phase]) -> bool {
        let mut found = false;
        for (i, phase) in phases.iter().enumerate() {
            match self.comes(phase) {
                Comes::Wanted(at) => self.reach(phase, at),
                Comes::Limit(at) if i == 0 && !at_limit.is_empty() => {
                    self.go(phase.forward, phase.high, at);
                    self.brake();
                    self.done.push(at_limit[0]);
                    return self.follow(&at_limit[1..], &[]);
                }
                Comes::Limit(at) => {
                    self.go(phase.forward, phase.high, at);
                    return false;
                }
                Comes::Nothing => return false,
            }
            self.done.push(*phase);
            found = i + 1 == phases.len();
        }
        found
    }

    /// Goes on to what ends the phase, and stops if that is said.
    fn reach(&mut self, phase: &Phase, at: f64) {
        self.go(phase.forward, phase.high, at);
        match phase.until {
            Until::Index { .. } => self.mark = Some(at),
            Until::HardStop => return self.press(phase),
            _ => {}
        }
        // What is passed downwards is passed just below.
        self.position = if phase.forward { at } else { at.next_down() };
        if phase.stops {
            self.brake();
        }
    }

    /// Held by a hard stop until the command is far enough beyond it.
    fn press(&mut self, phase: &Phase) {
        let (legs, held) = (self.legs.len(), self.position);
        let beyond = if phase.forward { self.speeds.collision } else { -self.speeds.collision };
        self.go(phase.forward, phase.high, held + beyond);
        for leg in &mut self.legs[legs..] {
            (leg.position, leg.speed, leg.accel) = (held, 0.0, 0.0);
        }
        (self.position, self.speed) = (held, 0.0);
    }

    /// From the origin, a whole count, at the low speed to the next index pulse. The limit that is the origin is no limit.
    fn refine(&mut self, forward: bool) {
        (self.position, self.speed) = (self.position.floor(), 0.0);
        let until = Until::Index { after: None };
        let phase = Phase { forward, high: false, until, stops: false };
        let origin = if forward { About::Positive } else { About::Negative };
        match self.comes(&phase) {
            Comes::Limit(_) if self.about != origin => {}
            Comes::Wanted(_) | Comes::Limit(_) => {
                if let Some(mark) = self.mark_ahead(forward, self.position) {
                    self.reach(&phase, mark);
                    self.done.push(phase);
                }
            }
            Comes::Nothing => {}
        }
    }

    fn comes(&self, phase: &Phase) -> Comes {
        let Phase { forward, until, .. } = *phase;
        let ahead = |at: &f64| if forward { *at > self.position } else { *at <= self.position };
        let edge = |on: bool| {
            let [from, to] = self.zone()?;
            Some(if on == forward { from } else { to }).filter(|at| at.is_finite() && ahead(at))
        };
        let wanted = match until {
            Until::Switch { on } => edge(on),
            Until::Index { after: None } => self.mark_ahead(forward, self.position),
            Until::Index { after: Some(on) } => edge(on)
                .and_then(|at| self.mark_ahead(forward, if forward { at } else { at.next_down() })),
            Until::SameIndex => return self.mark.map_or(Comes::Nothing, Comes::Wanted),
            Until::Limit => unreachable!("a limit is met instead of what is wanted"),
            Until::HardStop => {
                let [low, high] = self.scene.stops;
                Some(if forward { high } else { low } as f64)
            }
        };
        match (self.limit_ahead(forward, until), wanted) {
            (Some(limit), Some(wanted)) => {
                let nearer = if forward { limit < wanted } else { limit > wanted };
                let index = matches!(until, Until::Index { .. });
                let first = nearer || index && limit == wanted;
                if first { Comes::Limit(limit) } else { Comes::Wanted(wanted) }
            }
            (Some(limit), None) => Comes::Limit(limit),
            (None, Some(wanted)) => Comes::Wanted(wanted),
            (None, None) => Comes::Nothing,
        }
    }

    /// Where the limit ahead turns on, unless the phase waits for it; here, if the axis is beyond.
    fn limit_ahead(&self, forward: bool, until: Until) -> Option<f64> {
        let own = if forward { About::Positive } else { About::Negative };
        if self.about == own && until == (Until::Switch { on: true }) {
            return None;
        }
        let machine = &self.scene.machine;
        if forward {
            machine.positive_limit.map(|it| self.position.max(it as f64))
        } else {
            machine.negative_limit.map(|it| self.position.min(it as f64))
        }
    }

    fn zone(&self) -> Option<[f64; 2]> {
        let machine = &self.scene.machine;
        match self.about {
            About::Home => machine.home.map(|it| [it.from as f64, it.to as f64]),
            About::Negative => machine.negative_limit.map(|it| [f64::NEG_INFINITY, it as f64]),
            About::Positive => machine.positive_limit.map(|it| [it as f64, f64::INFINITY]),
            About::Nothing => None,
        }
    }

    fn mark_ahead(&self, forward: bool, from: f64) -> Option<f64> {
        let count = from.floor() as i64;
        let mark =
            if forward { self.scene.mark_above(count) } else { self.scene.mark_at_or_below(count) };
        mark.map(|it| it as f64)
    }

    fn go(&mut self, forward: bool, high: bool, to: f64) {
        let sign = if forward { 1.0 } else { -1.0 };
        let speed = if high { self.speeds.high } else { self.speeds.low };
        let (way, slow) = ((to - self.position) * sign, self.speed * sign);
        let accel = self.speeds.slope.copysign(speed - slow);
        let ramp = (speed * speed - slow * slow) / (2.0 * accel);
        match ramp < way {
            true => {
                self.push((speed - slow) / accel, accel * sign);
                self.speed = speed * sign;
                self.push((way - ramp) / speed, 0.0);
            }
            false => {
                let end = (slow * slow + 2.0 * accel * way).max(0.0).sqrt();
                self.push((end - slow) / accel, accel * sign);
            }
        }
        self.position = to;
    }

    fn brake(&mut self) {
        let slope = -self.speeds.slope.copysign(self.speed);
        self.push(self.speed / -slope, slope);
        self.speed = 0.0;
    }

    fn push(&mut self, seconds: f64, accel: f64) {
        let (from, position, speed) = (self.now, self.position, self.speed);
        let leg = Leg { from, seconds, position, speed, accel };
        (self.position, self.speed) = leg.at(1.0);
        self.now += seconds;
        self.legs.push(leg);
    }
}
