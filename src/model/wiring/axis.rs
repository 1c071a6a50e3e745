//! The axis, and whether what is wired to it goes together: what starts a motion has the numbers it needs,
//! and what changes nothing is told of.

use super::compile::Wirer;
use super::{Counts, Gear, Number};
use crate::model::raw::{RawAxis, RawCounts, RawGear, RawSegments};
use crate::problem::{Path, Problem};
use crate::units::{Dimension, Unit};
use crate::vocabulary::{Action, HomeStarter, Input, Named, Output, Quantity, Setting, Threshold};

/// A kind of motion: what it is called, what starts it, what it can't do without, what else it goes by.
struct SettingKind {
    name: &'static str,
    inputs: &'static [Input],
    action: Option<Action>,
    needs: &'static [Setting],
    takes: &'static [Setting],
}

const KINDS: [SettingKind; 7] = [
    SettingKind {
        name: "run",
        inputs: &[Input::Run],
        action: Some(Action::RunStart),
        needs: &[Setting::RunSpeed],
        takes: &[Setting::RunStartSpeed, Setting::RunAccel, Setting::RunDecel],
    },
    SettingKind {
        name: "jog",
        inputs: &[Input::JogPos, Input::JogNeg],
        action: None,
        needs: &[Setting::JogSpeed],
        takes: &[Setting::JogAccel, Setting::JogDecel],
    },
    SettingKind {
        name: "jog by `inch_pos`",
        inputs: &[Input::InchPos, Input::InchNeg],
        action: None,
        needs: &[Setting::InchSpeed],
        takes: &[Setting::InchAccel, Setting::InchDecel],
    },
    SettingKind {
        name: "move",
        inputs: &[Input::MoveStart],
        action: Some(Action::MoveStart),
        needs: &[Setting::MoveTarget, Setting::MoveSpeed],
        takes: &[Setting::MoveStartSpeed, Setting::MoveAccel, Setting::MoveDecel],
    },
    SettingKind {
        name: "homing",
        inputs: &[Input::HomeStart],
        action: Some(Action::HomeStart),
        needs: &[],
        takes: &[
            Setting::HomeFast,
            Setting::HomeSlow,
            Setting::HomeAccel,
            Setting::HomeWay,
            Setting::HomeCoordinate,
            Setting::HomeCollision,
            Setting::HomeTimeLimit,
        ],
    },
    SettingKind {
        name: "move by input",
        inputs: &[Input::MoveStart],
        action: None,
        needs: &[],
        takes: &[Setting::MoveAbsolute],
    },
    SettingKind {
        name: "segment",
        inputs: &[Input::SegmentStart, Input::SegmentRun, Input::InterruptStart],
        action: None,
        needs: &[],
        takes: &[],
    },
];

impl Wirer<'_> {
    pub(super) fn axis(&mut self, raw: Option<&RawAxis>) {
        let path = Path::root().key("axis");
        let (inputs, actions) = (self.inputs_wired(), self.actions_wired());
        let mut starter: Option<&str> = None;
        for kind in &KINDS {
            let by_input = kind.inputs.iter().find(|it| inputs.contains(it)).map(|it| it.name());
            let by_action = kind.action.filter(|it| actions.contains(it)).map(Named::name);
            let homes = kind.action == Some(Action::HomeStart) && self.homes_at_first_enable();
            let by = by_input.or(by_action).or(homes.then(|| HomeStarter::FirstEnable.name()));
            self.settings_fit(kind, by);
            starter = starter.or(by);
        }
        match (raw, starter) {
            (None, Some(starter)) => {
                let what = format!("`{starter}` moves an axis, but there is no `axis`");
                let problem = Problem::key(Path::root().key("signals"), what);
                self.problems
                    .push(problem.advise("add `axis: {counts_per_rev: N}`, or a row for N"));
            }
            (Some(_), None) => self.without_motion("axis", &path),
            _ => {}
        }
        if starter.is_none() {
            self.signals_without_motion(&inputs, &actions);
        }
        let none = RawSegments::default();
        let segments = raw.map_or(&none, |raw| &raw.segments);
        self.segments(segments, &path.key("segments"), &inputs);
        let interrupt = raw.and_then(|raw| raw.interrupt.as_ref());
        self.interrupt(interrupt, &path.key("interrupt"), &inputs);
        if let Some(raw) = raw {
            self.inhibit(&raw.inhibit, &path.key("inhibit"), &inputs);
        }
        self.homing_starts(&inputs, &actions);
        let Some(raw) = raw else { return };
        let per_rev = path.key("counts_per_rev");
        if let Some(counts) = self.per_rev(&raw.counts_per_rev, &per_rev) {
            self.not_zero(counts, &per_rev);
            self.wiring.axis.counts_per_rev = counts;
        }
        let encoder = raw.encoder.as_ref();
        self.wiring.axis.encoder = encoder.and_then(|it| self.per_rev(it, &path.key("encoder")));
        self.increments_fit(encoder.is_some(), &path);
        if let Some(coast) = self.duration(raw.coast.as_deref(), &path.key("coast")) {
            self.wiring.axis.coast = coast;
        }
        if raw.position_gain.is_some_and(|gain| !(0.1..=10_000.0).contains(&gain)) {
            let what = "`position_gain` must be between 0.1 and 10000 1/s";
            self.problems.push(Problem::value(path.key("position_gain"), what));
        }
        self.wiring.axis.position_gain = raw.position_gain;
        self.pole_pairs(raw.pole_pairs, &path);
        let reversed = raw.reversed.as_ref();
        self.wiring.axis.reversed = reversed.and_then(|it| self.row(it, &path.key("reversed")));
        self.wiring.axis.gear = raw.gear.as_ref().and_then(|it| self.gear(it, &path.key("gear")));
        let unit = raw.speed_unit.as_ref();
        let read = |wirer: &mut Self, text: &String, path: &Path| wirer.speed_unit(text, path);
        self.wiring.axis.speed_unit =
            unit.and_then(|it| self.chosen(it, &path.key("speed_unit"), read));
    }

    fn pole_pairs(&mut self, raw: Option<u16>, path: &Path) {
        let angle = super::Shows::Quantity(Quantity::ElectricalAngle);
        let shown = self.wiring.shows.iter().flatten().any(|it| *it == angle);
        let name = Quantity::ElectricalAngle.name();
        match raw {
            Some(0) => {
                let what = "`pole_pairs` must be at least 1";
                self.problems.push(Problem::value(path.key("pole_pairs"), what));
            }
            Some(_) if !shown => self.unused("pole_pairs", &format!("no row shows `{name}`"), path),
            Some(pairs) => self.wiring.axis.pole_pairs = pairs,
            None if shown => {
                let what = format!("`{name}` is shown, but the number of pole pairs is missing");
                let path = Path::root().key("quantities").key(name);
                self.problems
                    .push(Problem::key(path, what).advise("add `pole_pairs: N` to `axis`"));
            }
            None => {}
        }
    }

    fn speed_unit(&mut self, text: &str, path: &Path) -> Option<f64> {
        let unit = Unit::parse(text).filter(|it| it.dimension == Dimension::Speed);
        if unit.is_none() {
            let problem = Problem::value(path.clone(), format!("`{text}` is not a unit of speed"));
            self.problems.push(problem.advise("write `rpm`, or a factor and `rpm`: `0.1 rpm`"));
        }
        unit.map(|it| it.scale)
    }

    fn gear(&mut self, raw: &RawGear, path: &Path) -> Option<Gear> {
        let mut whole = |register: &str, key: &str| {
            let path = path.key(key);
            let row = self.row(register, &path)?;
            let it = self.rows.map.row(row);
            if it.spans.iter().any(|(low, _)| *low <= 0) {
                let what = format!(
                    "{} can be 0 or less, but a gear ratio needs numbers of at least 1",
                    it.id
                );
                let problem = Problem::value(path, what);
                self.problems.push(problem.advise("give the row a `range` that begins at 1"));
            }
            Some(row)
        };
        let numerator = whole(&raw.numerator, "numerator");
        let denominator = whole(&raw.denominator, "denominator");
        Some(Gear { numerator: numerator?, denominator: denominator? })
    }

    fn per_rev(&mut self, raw: &RawCounts, path: &Path) -> Option<Counts> {
        let row = match raw {
            RawCounts::Number(0) => {
                let what = "a revolution has at least 1 count";
                self.problems.push(Problem::value(path.clone(), what));
                return None;
            }
            RawCounts::Number(number) => return Some(Counts::Fixed(*number)),
            RawCounts::Row(register) => self.row(register, path)?,
        };
        let it = self.rows.map.row(row);
        if it.unit.dimension != Dimension::Resolution {
            let what = format!("{} must be in counts per revolution", it.id);
            let problem = Problem::value(path.clone(), what);
            self.problems.push(problem.advise("give the row `unit: counts/rev`"));
        }
        Some(Counts::Row(row))
    }

    fn not_zero(&mut self, counts: Counts, path: &Path) {
        let Counts::Row(row) = counts else { return };
        let it = self.rows.map.row(row);
        if it.spans.iter().any(|(low, _)| *low <= 0) {
            let what = format!("{} can be 0, but a revolution has at least 1 count", it.id);
            let problem = Problem::value(path.clone(), what);
            self.problems.push(problem.advise("give the row a `range` that begins at 1"));
        }
    }

    /// Rows in increments and what says how many of them make a revolution go together.
    fn increments_fit(&mut self, known: bool, path: &Path) {
        let settings = self.wiring.axis.settings.iter().map(|it| self.rows.map.row(it.row).unit);
        let thresholds = self.wiring.thresholds.iter().map(|(_, number)| match number {
            Number::Fixed(unit) => *unit,
            Number::Row(row) => self.rows.map.row(*row).unit,
        });
        let used = settings.chain(thresholds).any(|it| it.dimension == Dimension::Increments);
        let problem = match (used, known) {
            (true, false) => Problem::key(
                path.clone(),
                "a row is in `inc`, but the number of increments per revolution is missing",
            )
            .advise("add `encoder: N`, or a row for N"),
            (false, true) => Problem::key(
                path.key("encoder"),
                "`encoder` has no effect: no row that is wired is in `inc`",
            )
            .advise("remove it"),
            _ => return,
        };
        self.problems.push(problem);
    }

    /// A motion that something starts has the settings it needs; one that nothing starts has none.
    fn settings_fit(&mut self, kind: &SettingKind, by: Option<&str>) {
        let path = Path::root().key("quantities");
        for setting in kind.needs.iter().chain(kind.takes) {
            let wired = self.wiring.axis.setting(*setting).is_some();
            let name = setting.name();
            match by {
                Some(by) if !wired && kind.needs.contains(setting) => {
                    let what = format!("`{by}` is wired, but no row holds `{name}`");
                    let advice = format!("add `{name}: ROW` to `quantities`");
                    self.problems
                        .push(Problem::key(Path::root().key("signals"), what).advise(advice));
                }
                None if wired => {
                    let what = format!("`{name}` has no effect: nothing starts a {}", kind.name);
                    self.problems.push(
                        Problem::key(path.key(name), what)
                            .advise("wire what starts it, or remove it"),
                    );
                }
                _ => {}
            }
        }
    }

    /// What ends or shows a motion, where there is none.
    fn signals_without_motion(&mut self, inputs: &[Input], actions: &[Action]) {
        let path = Path::root().key("signals");
        let ends = [
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
        let ends = ends.into_iter().filter(|it| inputs.contains(it));
        let orders = [Action::Stop, Action::QuickStop].into_iter();
        let orders = orders.filter(|it| actions.contains(it)).map(Named::name);
        let outputs = [
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
        let shown = outputs.into_iter().filter(|it| self.is_shown(*it)).map(Named::name);
        let names: Vec<_> = ends.map(Named::name).chain(orders).chain(shown).collect();
        names.into_iter().for_each(|name| self.without_motion(name, &path));
        let path = Path::root().key("quantities");
        for setting in [Setting::SoftLimitPos, Setting::SoftLimitNeg] {
            if self.wiring.axis.setting(setting).is_some() {
                self.without_motion(setting.name(), &path.key(setting.name()));
            }
        }
        let deviation = Threshold::Deviation;
        if self.wiring.threshold(deviation).is_some() {
            self.without_motion(deviation.name(), &path.key(deviation.name()));
        }
        let moving = [
            Quantity::SpeedActual,
            Quantity::PositionCommand,
            Quantity::PositionFeedback,
            Quantity::CommandRate,
            Quantity::EncoderAngle,
            Quantity::EncoderTurns,
            Quantity::ElectricalAngle,
        ];
        for quantity in moving {
            let shows = super::Shows::Quantity(quantity);
            if self.wiring.shows.iter().flatten().any(|it| *it == shows) {
                let path = Path::root().key("quantities").key(quantity.name());
                self.without_motion(quantity.name(), &path);
            }
        }
    }

    pub(super) fn without_motion(&mut self, name: &str, path: &Path) {
        let what = format!("`{name}` has no effect: nothing starts a motion");
        let advice = "wire what starts it, or remove it";
        self.problems.push(Problem::key(path.clone(), what).advise(advice));
    }
}
