//! What a homing comes to, as a formula: which edge, passed in which direction, and which index pulse after it.
//!
//! Deliberately without steps: where they begin and how they turn round must not matter.

use super::scene::{Reach, Scene};

/// How a homing ends.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum End {
    /// The axis rests on its origin.
    Origin(i64),
    /// Without an origin and without an alarm, because of a limit.
    Limit,
    /// Alarm of a limit.
    LimitAlarm,
    /// Alarm of the time limit.
    Late,
    /// Alarm of the position deviation.
    Deviates,
    /// On an index mark near a limit; if not `sure`, perhaps nowhere, and late.
    NextTo { limit: i64, within: i64, sure: bool },
}

/// What a method looks for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Mark {
    NegativeLimit,
    PositiveLimit,
    Lower,
    Upper,
}
use Mark::{Lower, NegativeLimit, PositiveLimit, Upper};

/// CiA 402 methods 17 to 30, and 1 to 14 in the same order: what is passed last, and in the positive direction?
const METHODS: [(Mark, bool); 14] = [
    (NegativeLimit, true),
    (PositiveLimit, false),
    (Lower, false),
    (Lower, true),
    (Upper, true),
    (Upper, false),
    (Lower, false),
    (Lower, true),
    (Upper, false),
    (Upper, true),
    (Upper, true),
    (Upper, false),
    (Lower, true),
    (Lower, false),
];

/// How `method` of CiA 402 ends in `scene`.
pub fn cia402(method: i64, scene: &Scene) -> End {
    let [negative, positive] = scene.limits();
    let short_of = |mark: Option<i64>, forward: bool| {
        let free = |mark: &i64| if forward { *mark < positive } else { *mark > negative };
        mark.filter(free).map_or(End::Limit, End::Origin)
    };
    let (number, index) = match method {
        1..=14 => (method, true),
        17..=30 => (method - 16, false),
        33 => return short_of(scene.mark_at_or_below(scene.start), false),
        34 => return short_of(scene.mark_above(scene.start), true),
        _ => return End::Origin(scene.start),
    };
    let (mark, forward) = METHODS[number as usize - 1];
    let [from, to] = scene.home();
    let (end, reached) = match number {
        // The home switch has to be ahead, in the positive or in the negative direction.
        3 | 4 => (Reach::Positive, scene.start < to),
        5 | 6 => (Reach::Negative, scene.start >= from),
        _ => (Reach::Middle, true),
    };
    if !has(mark, scene) || !reached && scene.reach() != end {
        return End::Limit;
    }
    let edge = place(mark, scene);
    match (index, forward) {
        (false, _) => End::Origin(rest(edge, forward)),
        (true, true) => short_of(scene.mark_above(edge), true),
        (true, false) => short_of(scene.mark_at_or_below(edge - 1), false),
    }
}

/// How a homing against a hard stop ends.
pub fn hard_stop(method: i64, turned: bool, scene: &Scene) -> End {
    let [low, high] = scene.machine.hard_stop.expect("the scene has them");
    let forward = matches!(method, -2 | -4) != turned;
    match method {
        _ if scene.machine.negative_limit.is_some() => End::Limit,
        -4 | -3 => End::Origin(if forward { high } else { low }),
        _ if forward => scene.mark_at_or_below(high).map_or(End::Deviates, End::Origin),
        _ => scene.mark_above(low).map_or(End::Deviates, End::Origin),
    }
}

/// Settings of a homing of the X series.
#[derive(Debug, Clone, Copy)]
pub struct Hcfa {
    /// P08.89.
    pub mode: i64,
    /// P08.90.
    pub rule: i64,
    /// Digit 3 of P07.08.
    pub source: i64,
}

/// How a homing of the X series ends in `scene`.
pub fn hcfa(how: Hcfa, scene: &Scene) -> End {
    let Hcfa { mode, rule, source } = how;
    let search = mode % 2 == 0;
    let stops = scene.machine.hard_stop.filter(|_| source == 1);
    // The axis is at a limit at or below the first of them, and at or above the second.
    let [negative, positive] = scene.limits();
    let [low, high] = stops.unwrap_or([negative - 1, positive]);
    // The mark on the edge of the limit switch is passed when the switch turns on.
    let lowest = if stops.is_some() { low } else { negative };
    let missed = if rule < 3 { End::Late } else { End::LimitAlarm };
    let [from, to] = scene.home();
    let origin = match mode {
        0 => high - 1,
        1 if source == 1 => low,
        1 => low + 1,
        6 | 7 => {
            let mark = if search {
                scene.mark_above(scene.start)
            } else {
                scene.mark_at_or_below(scene.start)
            };
            let free = |mark: &i64| if search { *mark < high } else { *mark > lowest };
            return match mark.filter(free) {
                Some(mark) => End::Origin(mark),
                None if rule >= 3 => End::LimitAlarm,
                None => {
                    let limit = if search { high.max(scene.start) } else { low.min(scene.start) };
                    let within = scene.every() + scene.fast_way(10_000) + 2;
                    let sure = scene.mark_at_or_below(high - 1).is_some_and(|it| it > lowest);
                    End::NextTo { limit, within, sure }
                }
            };
        }
        8 => return End::Origin(scene.start),
        _ => {
            let (mark, forward) =
                [(Lower, true), (Upper, false), (Upper, true), (Lower, false)][mode as usize - 2];
            let ahead = if search { scene.start < to } else { scene.start >= from };
            if !has(mark, scene) || rule >= 3 && !ahead {
                return missed;
            }
            rest(place(mark, scene), forward)
        }
    };
    let forward = match rule % 3 {
        0 => !search,
        1 => search,
        _ => return End::Origin(origin),
    };
    let mark = if forward { scene.mark_above(origin) } else { scene.mark_at_or_below(origin) };
    // The limit that is the origin does not end the way, but a hard stop beyond it holds the axis.
    if mode < 2 && forward == search {
        return mark.map_or(End::Deviates, End::Origin);
    }
    match mark.filter(|mark| if forward { *mark < high } else { *mark > lowest }) {
        Some(mark) => End::Origin(mark),
        None => missed,
    }
}

/// Is that edge within the travel?
fn has(mark: Mark, scene: &Scene) -> bool {
    match mark {
        Lower => scene.reach() != Reach::Negative,
        Upper => scene.reach() != Reach::Positive,
        NegativeLimit | PositiveLimit => true,
    }
}

fn place(mark: Mark, scene: &Scene) -> i64 {
    match mark {
        NegativeLimit => scene.limits()[0],
        PositiveLimit => scene.limits()[1],
        Lower => scene.home()[0],
        Upper => scene.home()[1],
    }
}

/// Where the axis rests after it has passed an edge: a mark belongs to its upper side.
fn rest(edge: i64, forward: bool) -> i64 {
    edge - i64::from(!forward)
}
