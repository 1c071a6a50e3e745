//! Machines at random, and how a drive homes on them.

use super::oracle::{End, Hcfa};
use crate::kit::rig;
use drivemu::bench::DeviceSpec;
use drivemu::event::{DriveEvent, Event, EventKind};
use drivemu::motion::{Index, Machine, Zone};
use drivemu::testkit::Rig;
use drivemu::time::Duration;
use drivemu::vocabulary::{AlarmCause, HomeEnd, Output, Quantity, Then};
use proptest::prelude::*;

/// Farther than any axis gets.
const FAR: i64 = 10_000_000;

/// How far the home switch reaches.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Reach {
    /// It has both edges between the limits.
    Middle,
    /// It is on to the positive end of travel.
    Positive,
    /// It is on to the negative end of travel.
    Negative,
}

/// A machine, where its axis stands, and how fast it homes.
#[derive(Debug, Clone)]
pub struct Scene {
    pub machine: Machine,
    pub start: i64,
    /// Revolutions a minute.
    pub fast: i64,
    /// Revolutions a minute.
    pub slow: i64,
    pub ramp_ms: i64,
    /// Normally closed terminals, bit by bit.
    pub closed: i64,
    /// The hard stops, where the machine may have some.
    pub stops: [i64; 2],
}

impl Scene {
    pub fn limits(&self) -> [i64; 2] {
        let Machine { negative_limit, positive_limit, .. } = self.machine;
        [negative_limit, positive_limit].map(|it| it.expect("the scene has them"))
    }

    pub fn home(&self) -> [i64; 2] {
        let Zone { from, to } = self.machine.home.expect("the scene has one");
        [from, to]
    }

    pub fn reach(&self) -> Reach {
        match self.home() {
            [_, FAR] => Reach::Positive,
            [from, _] if from == -FAR => Reach::Negative,
            _ => Reach::Middle,
        }
    }

    pub fn every(&self) -> i64 {
        self.index().every
    }

    /// Counts to slow down in from the fast speed, and one.
    pub fn fast_way(&self, counts_per_rev: i64) -> i64 {
        self.fast * counts_per_rev * self.ramp_ms / (2 * 60_000) + 1
    }

    /// The ramp in steps of 10 rpm/s.
    pub fn acceleration(&self) -> i64 {
        (self.fast * 100 / self.ramp_ms).max(1)
    }

    /// The first index mark above `count` that the axis gets to.
    pub fn mark_above(&self, count: i64) -> Option<i64> {
        self.within((count - self.index().offset).div_euclid(self.every()) + 1)
    }

    /// The last index mark at or below `count` that the axis can leave downwards.
    pub fn mark_at_or_below(&self, count: i64) -> Option<i64> {
        self.within((count - self.index().offset).div_euclid(self.every()))
    }

    pub fn is_mark(&self, count: i64) -> bool {
        self.mark_at_or_below(count) == Some(count)
    }

    pub fn with_stops(mut self) -> Self {
        self.machine.hard_stop = Some(self.stops);
        self
    }

    /// Without hard stops.
    pub fn without_stops(mut self) -> Self {
        self.machine.hard_stop = None;
        self
    }

    /// Without limit switches, whose terminals then are normally open: a closed one without a wire is active.
    pub fn without_limits(mut self) -> Self {
        self.closed &= 1;
        (self.machine.negative_limit, self.machine.positive_limit) = (None, None);
        self
    }

    fn index(&self) -> Index {
        self.machine.index.expect("the scene has marks")
    }

    fn within(&self, number: i64) -> Option<i64> {
        let mark = number * self.every() + self.index().offset;
        let held = |[low, high]: [i64; 2]| mark <= low || high < mark;
        (!self.machine.hard_stop.is_some_and(held)).then_some(mark)
    }
}

/// Machines with home switch, limits and index, with or without hard stops, and an axis anywhere.
pub fn scenes() -> impl Strategy<Value = Scene> {
    let gaps = (1..4000i64, 0..8000i64, 1..6000i64, 0..8000i64, 0..4000i64);
    let reach =
        prop::sample::select(&[Reach::Middle, Reach::Middle, Reach::Positive, Reach::Negative][..]);
    let marks = (1..6000i64, -6000..6000i64);
    let speeds = (100..3000i64, 20..300i64, 30..2000i64);
    let start = any::<prop::sample::Index>();
    (gaps, reach, marks, speeds, start, -20_000..20_000i64, any::<bool>(), 0..8i64).prop_map(
        |(gaps, reach, (every, offset), (fast, slow, ramp_ms), start, negative, stops, closed)| {
            let (below, before, wide, behind, above) = gaps;
            let (from, to) = (negative + before, negative + before + wide);
            let positive = to + behind;
            let ends = [negative - below, positive + above];
            let travel = usize::try_from(ends[1] - ends[0]).expect("it is some way");
            let home = match reach {
                Reach::Middle => Zone { from, to },
                Reach::Positive => Zone { from, to: FAR },
                Reach::Negative => Zone { from: -FAR, to },
            };
            Scene {
                machine: Machine {
                    home: Some(home),
                    negative_limit: Some(negative),
                    positive_limit: Some(positive),
                    hard_stop: stops.then_some(ends),
                    index: Some(Index { every, offset }),
                },
                start: ends[0] + start.index(travel + 1) as i64,
                fast,
                slow,
                ramp_ms,
                closed,
                stops: ends,
            }
        },
    )
}

/// A drive that is about to home.
pub struct Setting {
    pub model: &'static str,
    pub options: &'static [(&'static str, &'static str)],
    pub spec: DeviceSpec,
    /// Unit, function and data of what starts it.
    start: &'static str,
}

impl Setting {
    /// The position register counts as the machine does, until a homing is done.
    fn new(model: &'static str, scene: &Scene, set: &[(&str, i64)], start: &'static str) -> Self {
        let set = set.iter().map(|(row, value)| ((*row).to_owned(), *value)).collect();
        let (machine, start_at) = (scene.machine, scene.start);
        let spec = DeviceSpec {
            set,
            machine,
            start: start_at,
            position: start_at,
            ..DeviceSpec::default()
        };
        Self { model, options: &[], spec, start }
    }
}

pub fn yako(model: &'static str, method: i64, scene: &Scene) -> Setting {
    let mut set = vec![
        ("home_method", method),
        ("home_speed", scene.fast),
        ("home_slow_speed", scene.slow),
        ("home_ramp_time", scene.ramp_ms),
        ("home_offset_mode", 9),
        ("input_level", scene.closed),
    ];
    if model == "yako-closed-loop" {
        // An increment is a count then, and no ramp beyond a hard stop is so long.
        set.extend([("encoder_resolution", 1000), ("deviation_alarm", 65_535)]);
    }
    Setting::new(model, scene, &set, "01 06 0027 0010")
}

pub fn hcfa_x(how: Hcfa, scene: &Scene) -> Setting {
    let set = [
        ("P08.88", 3),
        ("P08.89", how.mode),
        ("P08.90", how.rule),
        ("P08.92", scene.fast),
        ("P08.93", scene.slow),
        ("P08.94", scene.ramp_ms),
        ("P08.95", 65_535),
        ("P07.08", how.source * 0x100 + 0x9),
        ("P04.01", 1),
        ("P04.02", 28),
        ("P04.03", 14),
        ("P04.04", 15),
    ];
    let mut setting = Setting::new("hcfa-x", scene, &set, "01 06 140C 0001");
    setting.spec.terminals = vec!["DI1".into()];
    setting
}

pub fn k_series(scene: &Scene) -> Setting {
    let set = [
        ("reference_speed_to", scene.fast),
        ("reference_speed_off", scene.slow),
        ("acceleration", scene.acceleration()),
        ("comm_io", 1),
    ];
    Setting::new("k-series", scene, &set, "01 06 0451 8001")
}

impl Setting {
    /// A drive that homes from now on.
    pub fn begin(&self) -> Rig {
        let mut rig = rig(self.model, self.options, &self.spec);
        rig.ask(self.start);
        rig
    }

    /// What a master reads of the speed, in revolutions a minute.
    pub fn read_speed(&self, rig: &mut Rig) -> i64 {
        let answer = rig.ask(match self.model {
            "hcfa-x" => "01 03 1501 0001",
            "k-series" => "01 03 0420 0001",
            _ => "01 03 000C 0001",
        });
        let word = answer.split_whitespace().skip(3).collect::<String>();
        u16::from_str_radix(&word, 16).expect("a word").cast_signed().into()
    }
}

/// How a homing went.
#[derive(Debug, PartialEq)]
pub struct Outcome {
    pub end: End,
    position: i64,
    events: Vec<Event>,
}

/// Homes, looking at the axis after each of `slices`, in microseconds, and at the end.
pub fn play(setting: &Setting, scene: &Scene, slices: &[u64]) -> Outcome {
    let mut rig = setting.begin();
    let kept = setting.model.starts_with("yako");
    let limit = Duration::from_secs(4000);
    let slices = slices.iter().map(|us| Duration::from_micros(*us)).chain(std::iter::repeat(limit));
    let mut spent = Duration::ZERO;
    for slice in slices {
        if spent >= limit {
            break;
        }
        let slice = slice.min(limit - spent);
        rig.advance(slice);
        spent += slice;
        let at = rig.drive().quantity(Quantity::PositionActual);
        let beyond = |[low, high]: [i64; 2]| at < low || high < at;
        let counts_as_machine = kept || !rig.drive().output(Output::HomeDone);
        assert!(
            !(counts_as_machine && scene.machine.hard_stop.is_some_and(beyond)),
            "{}",
            rig.log()
        );
    }
    assert!(!rig.drive().output(Output::Moving), "it goes on for ever\n{}", rig.log());
    let position = rig.drive().quantity(Quantity::PositionActual);
    Outcome { end: end(&rig, scene, kept), position, events: rig.events().to_vec() }
}

fn end(rig: &Rig, scene: &Scene, kept: bool) -> End {
    let told = |want: &dyn Fn(&DriveEvent) -> Option<i64>| {
        rig.events().iter().rev().find_map(|event| match &event.kind {
            EventKind::Drive { event: change, .. } => want(change),
            _ => None,
        })
    };
    let alarm = |cause| {
        told(&|change| {
            matches!(change, DriveEvent::Alarm { cause: it, .. } if *it == cause).then_some(0)
        })
        .is_some()
    };
    let position = rig.drive().quantity(Quantity::PositionActual);
    let lost = told(&|change| match change {
        DriveEvent::HomingAborted { why, .. } => Some(*why as i64),
        _ => None,
    });
    match lost {
        None => {
            let found = told(&|change| match change {
                DriveEvent::HomingOrigin { at, .. } => Some(*at),
                DriveEvent::HomingFound { step, at, .. } if step.then == Then::Origin => Some(*at),
                _ => None,
            });
            let origin = found.unwrap_or(scene.start);
            assert!(rig.drive().output(Output::HomeDone), "{}", rig.log());
            assert_eq!(position, if kept { origin } else { 0 }, "{}", rig.log());
            End::Origin(origin)
        }
        Some(_) if alarm(AlarmCause::HomingTime) => End::Late,
        Some(_) if alarm(AlarmCause::HomingLimitPos) || alarm(AlarmCause::HomingLimitNeg) => {
            End::LimitAlarm
        }
        Some(_) if alarm(AlarmCause::PositionDeviation) => End::Deviates,
        Some(why) => {
            assert_eq!(why, HomeEnd::Limit as i64, "{}", rig.log());
            End::Limit
        }
    }
}
