//! What the manuals print of each phase of a homing: direction, speed, what ends it, and whether the axis stops there.
//!
//! `+H^D` reads: forward at the high speed until the switch of the method turns on, then slow down to a standstill. `+`, `-`
//! are directions, `H`, `L` the high and the low speed. `^` is the switch turning on, `v` turning off, `|` the limit ahead, `#` a
//! hard stop; `Z` the next index pulse, `Z^` and `Zv` the first one after the switch has turned on or off, `=` the pulse of the
//! phase before. `D` slows down to a standstill, `C` goes on without stopping; the phase without either ends at the origin.

/// The switch that a method is about.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum About {
    Home,
    Negative,
    Positive,
    Nothing,
}

/// What ends a phase.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Until {
    Switch { on: bool },
    Index { after: Option<bool> },
    SameIndex,
    Limit,
    HardStop,
}

/// A phase.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Phase {
    pub forward: bool,
    pub high: bool,
    pub until: Until,
    /// Does the axis stop before the next one?
    pub stops: bool,
}

/// The sentences about one method.
#[derive(Debug, Clone)]
pub struct Sentences {
    pub about: About,
    /// The switch is off at the start.
    pub idle: Vec<Phase>,
    /// The same, and the limit comes first.
    pub at_limit: Vec<Phase>,
    /// The switch is on at the start.
    pub active: Vec<Phase>,
    /// The search for an index pulse after the origin: forward?
    pub refined: Option<bool>,
}

/// Methods 1 to 14 of appendix 1: a), b) where that is about a limit, and the last one. 17 to 30 are the same without Z.
const YAKO: [(About, &str, &str, &str); 14] = [
    (About::Negative, "-H^D +LZv", "", "+LZv"),
    (About::Positive, "+H^D -LZv", "", "-LZv"),
    (About::Home, "+H^D -LZv", "", "-LZv"),
    (About::Home, "+LZ^", "", "-HvD +LZ^"),
    (About::Home, "-H^D +LZv", "", "+LZv"),
    (About::Home, "-LZ^", "", "+HvD -LZ^"),
    (About::Home, "+H^D -LZv", "+H|D -H^C -LZv", "-LZv"),
    (About::Home, "+H^D -LvD +LZ^", "+H|D -H^C -LvD +LZ^", "-LvD +LZ^"),
    (About::Home, "+H^C +LvD -LZ^", "+H|D -H^D +LvD -LZ^", "+LvD -LZ^"),
    (About::Home, "+H^C +LZv", "+H|D -H^D +LZv", "+LZv"),
    (About::Home, "-H^D +LZv", "-H|D +H^C +LZv", "+LZv"),
    (About::Home, "-H^D +LvD -LZ^", "-H|D +H^C +LvD -LZ^", "+LvD -LZ^"),
    (About::Home, "-H^C -LvD +LZ^", "-H|D +H^D -LvD +LZ^", "-LvD +LZ^"),
    (About::Home, "-H^C -LZv", "-H|D +H^D -LZv", "-LZv"),
];

/// What appendix 1 prints of `method`; 33, 34 and those below 0 have no text there.
pub fn yako(method: i64) -> Sentences {
    let only = |idle: &str| sentences((About::Nothing, idle, "", ""));
    match method {
        1..=14 => sentences(YAKO[method as usize - 1]),
        17..=30 => {
            let (about, idle, at_limit, active) = YAKO[method as usize - 17];
            let [idle, at_limit, active] = [idle, at_limit, active].map(|it| it.replace('Z', ""));
            sentences((about, &idle, &at_limit, &active))
        }
        33 => only("-LZ"),
        34 => only("+LZ"),
        -1 => only("-H#D +LZ"),
        -2 => only("+H#D -LZ"),
        -3 => only("-H#"),
        -4 => only("+H#"),
        _ => only(""),
    }
}

/// What 7.1 says of a mode, with P08.90: P08.92 from the start, unless the signal is there already; P08.93 after the limit,
/// HOME_IN or Z has been met.
pub fn hcfa(mode: i64, rule: i64) -> Sentences {
    let even = match mode / 2 {
        0 => (About::Positive, "+H^D -Lv", "", "-Lv"),
        1 => (About::Home, "+H^D -LvD +L^", "+H|D -H^C -LvD +L^", "-LvD +L^"),
        2 => (About::Home, "+H^C +Lv", "+H|D -H^D +Lv", "+Lv"),
        3 => (About::Nothing, "+HZD -L=", "+H|D -HZD +L=", ""),
        _ => (About::Nothing, "", "", ""),
    };
    let mut all = sentences(even);
    let forward = mode % 2 == 0;
    if !forward {
        all.about = if all.about == About::Positive { About::Negative } else { all.about };
        let phases = all.idle.iter_mut().chain(&mut all.at_limit).chain(&mut all.active);
        phases.for_each(|phase| phase.forward = !phase.forward);
    }
    if rule >= 3 {
        all.at_limit.clear();
    }
    all.refined = match rule % 3 {
        0 if mode < 6 => Some(!forward),
        1 if mode < 6 => Some(forward),
        _ => None,
    };
    all
}

/// The K series, of which only the two speeds are printed.
pub fn k_series() -> Sentences {
    sentences((About::Home, "+H^D -Lv", "", "-Lv"))
}

fn sentences((about, idle, at_limit, active): (About, &str, &str, &str)) -> Sentences {
    let phases = |text: &str| text.split_whitespace().map(phase).collect();
    let [idle, at_limit, active] = [idle, at_limit, active].map(phases);
    Sentences { about, idle, at_limit, active, refined: None }
}

fn phase(text: &str) -> Phase {
    let (rest, stops) = match text.strip_suffix(['D', 'C']) {
        Some(rest) => (rest, text.ends_with('D')),
        None => (text, false),
    };
    let until = match &rest[2..] {
        "^" => Until::Switch { on: true },
        "v" => Until::Switch { on: false },
        "Z" => Until::Index { after: None },
        "Z^" => Until::Index { after: Some(true) },
        "Zv" => Until::Index { after: Some(false) },
        "=" => Until::SameIndex,
        "|" => Until::Limit,
        "#" => Until::HardStop,
        _ => panic!("`{text}` is no phase"),
    };
    Phase { forward: rest.starts_with('+'), high: &rest[1..2] == "H", until, stops }
}
