//! Motions: each has something that starts it and the numbers that it needs; without any motion, what belongs to one has no effect.

use super::homing::at_first_enable;
use super::names::Names;
use super::quantities::{Numbers, path};
use super::wired::{Wired, without_motion};
use crate::model::HomingRules;
use crate::problem::{Path, Problem};
use crate::vocabulary::{Action, HomeStarter, Input, Named, Output, Quantity, Setting, Threshold};

/// A kind of motion: what it is called, what starts it, what it can't do without, what else it goes by.
struct MotionKind {
    name: &'static str,
    inputs: &'static [Input],
    action: Option<Action>,
    needs: &'static [Setting],
    takes: &'static [Setting],
}

const KINDS: [MotionKind; 7] = [
    MotionKind {
        name: "run",
        inputs: &[Input::Run],
        action: Some(Action::RunStart),
        needs: &[Setting::RunSpeed],
        takes: &[Setting::RunStartSpeed, Setting::RunAccel, Setting::RunDecel],
    },
    MotionKind {
        name: "jog",
        inputs: &[Input::JogPos, Input::JogNeg],
        action: None,
        needs: &[Setting::JogSpeed],
        takes: &[Setting::JogAccel, Setting::JogDecel],
    },
    MotionKind {
        name: "jog by `inch_pos`",
        inputs: &[Input::InchPos, Input::InchNeg],
        action: None,
        needs: &[Setting::InchSpeed],
        takes: &[Setting::InchAccel, Setting::InchDecel],
    },
    MotionKind {
        name: "move",
        inputs: &[Input::MoveStart],
        action: Some(Action::MoveStart),
        needs: &[Setting::MoveTarget, Setting::MoveSpeed],
        takes: &[Setting::MoveStartSpeed, Setting::MoveAccel, Setting::MoveDecel],
    },
    MotionKind {
        name: "homing",
        inputs: &[Input::HomeStart],
        action: Some(Action::HomeStart),
        needs: &[],
        takes: &[
            Setting::HomeFast,
            Setting::HomeSlow,
            Setting::HomeAccel,
            Setting::HomeOffset,
            Setting::HomeCoordinate,
            Setting::HomeCollision,
            Setting::HomeTimeLimit,
        ],
    },
    MotionKind {
        name: "move by input",
        inputs: &[Input::MoveStart],
        action: None,
        needs: &[],
        takes: &[Setting::MoveAbsolute],
    },
    MotionKind {
        name: "segment",
        inputs: &[Input::SegmentStart, Input::SegmentRun, Input::InterruptStart],
        action: None,
        needs: &[],
        takes: &[],
    },
];

/// What ends, shows or bounds a motion, by where it stands in the file.
const INPUTS: [Input; 10] = [
    Input::Stop,
    Input::QuickStop,
    Input::LimitPos,
    Input::LimitNeg,
    Input::Pause,
    Input::ClearDeviation,
    Input::CommandInhibit,
    Input::ReverseSpeed,
    Input::ReversePosition,
    Input::ZeroSpeedClamp,
];
const ACTIONS: [Action; 2] = [Action::Stop, Action::QuickStop];
const OUTPUTS: [Output; 15] = [
    Output::Moving,
    Output::InPosition,
    Output::ZeroSpeed,
    Output::Turning,
    Output::SpeedReached,
    Output::SpeedAgrees,
    Output::Settled,
    Output::Arrived,
    Output::Coincides,
    Output::Near,
    Output::CommandPresent,
    Output::TorqueLimited,
    Output::EncoderA,
    Output::EncoderB,
    Output::EncoderZ,
];
const SETTINGS: [Setting; 2] = [Setting::SoftLimitPos, Setting::SoftLimitNeg];
const QUANTITIES: [Quantity; 7] = [
    Quantity::SpeedActual,
    Quantity::PositionCommand,
    Quantity::PositionFeedback,
    Quantity::CommandRate,
    Quantity::EncoderAngle,
    Quantity::EncoderTurns,
    Quantity::ElectricalAngle,
];

/// What starts motions has an axis, an axis has what starts motions, and each motion has its numbers.
pub(super) fn check(
    has_axis: bool,
    wired: &Wired,
    numbers: &Numbers,
    homing: Option<&HomingRules>,
    names: &mut Names,
) {
    let mut starter: Option<&str> = None;
    for kind in &KINDS {
        let by_input = kind.inputs.iter().find(|it| wired.has(**it)).map(|it| it.name());
        let by_action = kind.action.filter(|it| wired.does(*it)).map(Named::name);
        let homes = kind.action == Some(Action::HomeStart) && at_first_enable(homing);
        let by = by_input.or(by_action).or(homes.then(|| HomeStarter::FirstEnable.name()));
        match by {
            Some(by) => has_settings(kind, by, numbers, names),
            None => has_no_settings(kind, numbers, names),
        }
        starter = starter.or(by);
    }
    let signals = Path::root().key("signals");
    match starter {
        Some(starter) if !has_axis => {
            let what = format!("`{starter}` moves an axis, but there is no `axis`");
            let advice = "add `axis: {counts_per_rev: N}`, or a row for N";
            names.report(Problem::key(signals, what).advise(advice));
        }
        Some(_) => {}
        None => {
            if has_axis {
                without_motion("axis", &Path::root().key("axis"), names);
            }
            nothing_moves(wired, numbers, names);
        }
    }
}

/// A motion that something starts has the settings it needs.
fn has_settings(kind: &MotionKind, by: &str, numbers: &Numbers, names: &mut Names) {
    for setting in kind.needs.iter().filter(|it| !numbers.has(**it)) {
        let name = setting.name();
        let what = format!("`{by}` is wired, but no row holds `{name}`");
        let advice = format!("add `{name}: ROW` to `quantities`");
        names.report(Problem::key(Path::root().key("signals"), what).advise(advice));
    }
}

/// A motion that nothing starts has no settings.
fn has_no_settings(kind: &MotionKind, numbers: &Numbers, names: &mut Names) {
    let settings = kind.needs.iter().chain(kind.takes);
    for setting in settings.filter(|it| numbers.has(**it)) {
        let name = setting.name();
        let what = format!("`{name}` has no effect: nothing starts a {}", kind.name);
        let problem = Problem::key(path(name), what);
        names.report(problem.advise("wire what starts it, or remove it"));
    }
}

/// What belongs to motions, where there is none.
fn nothing_moves(wired: &Wired, numbers: &Numbers, names: &mut Names) {
    let inputs = INPUTS.into_iter().filter(|it| wired.has(*it)).map(Named::name);
    let actions = ACTIONS.into_iter().filter(|it| wired.does(*it)).map(Named::name);
    let outputs = OUTPUTS.into_iter().filter(|it| wired.shows(*it)).map(Named::name);
    let signals = Path::root().key("signals");
    for name in inputs.chain(actions).chain(outputs) {
        without_motion(name, &signals, names);
    }
    let settings = SETTINGS.into_iter().filter(|it| numbers.has(*it)).map(Named::name);
    let deviation = Threshold::Deviation;
    let deviation = numbers.has_threshold(deviation).then(|| deviation.name());
    let shown = QUANTITIES.into_iter().filter(|it| wired.shows_quantity(*it)).map(Named::name);
    for name in settings.chain(deviation).chain(shown) {
        without_motion(name, &path(name), names);
    }
}
