//! Alarms, the rows that remember them, and whether what raises, clears or follows one has an alarm to do it with.

use super::names::Names;
use super::quantities::{self, Numbers};
use super::uses::Uses;
use super::wired::{Wired, without_motion};
use crate::model::raw::{RawAlarmStop, RawModel};
use crate::model::{Alarm, AlarmStop, RowId, Shows};
use crate::problem::{At, Path, Problem};
use crate::units::{Dimension, Unit};
use crate::vocabulary::{Action, AlarmCause, Input, Named, Quantity, Setting};

/// The alarms that the drive can raise.
pub(super) fn compile(raw: &RawModel, wired: &Wired, names: &mut Names) -> Vec<Alarm> {
    let mut alarms = Vec::new();
    for (name, raw) in &raw.alarms {
        let path = path(name);
        if raw.code == 0 {
            names.report(Problem::value(path.key("code"), "code 0 means no alarm"));
        }
        let cause = names.by_key(|names| names.word::<AlarmCause>(name, "alarm cause", &path));
        let voltage = raw.bus_voltage.as_ref();
        let bus_voltage = voltage.and_then(|it| bus_voltage(it, wired, &path, names));
        let stop = match raw.stop {
            RawAlarmStop::Coast => AlarmStop::Coast,
            RawAlarmStop::Ramp => AlarmStop::Ramp,
            RawAlarmStop::Quick => AlarmStop::Quick,
        };
        let (code, resettable) = (raw.code, raw.resettable);
        alarms.extend(cause.map(|cause| Alarm { cause, code, resettable, bus_voltage, stop }));
    }
    alarms
}

fn path(name: &str) -> Path {
    Path::root().key("alarms").key(name)
}

/// The voltage that `text` says, with its unit, of the alarm at `path`.
fn bus_voltage(text: &str, wired: &Wired, path: &Path, names: &mut Names) -> Option<f64> {
    let (key, quantity) = ("bus_voltage", Quantity::BusVoltage);
    if !wired.shows_quantity(quantity) {
        names.without_effect(key, &format!("no row shows `{}`", quantity.name()), path);
    }
    let volts = Unit::parse(text).filter(|it| it.dimension == Dimension::Voltage);
    if volts.is_none() {
        let problem = Problem::value(path.key(key), format!("`{text}` is not a voltage"));
        names.report(problem.advise("write a number with its unit: `180 V`"));
    }
    volts.map(|it| it.scale)
}

/// Rows with the numbers of the alarms that were raised.
pub(super) fn history(raw: &RawModel, uses: &mut Uses, names: &mut Names) -> Vec<RowId> {
    let path = Path::root().key("alarm_history");
    let rows = names.row_list(&raw.alarm_history, &path);
    for (i, row) in rows.iter().enumerate() {
        uses.show(*row, Shows::PastAlarm(i as u16), &path.index(i), At::Value, names);
    }
    rows
}

/// What raises, clears or follows an alarm goes together with the alarms.
pub(super) fn check(
    raw: &RawModel,
    alarms: &[Alarm],
    wired: &Wired,
    numbers: &Numbers,
    names: &mut Names,
) {
    let signals = Path::root().key("signals");
    let encoder_reset = Action::EncoderReset;
    let raised = [
        (wired.has(Input::AlarmForce), "alarm_force", AlarmCause::Forced, &signals),
        (wired.does(encoder_reset), encoder_reset.name(), AlarmCause::Encoder, &signals),
        (
            raw.line.timeout.is_some(),
            "timeout",
            AlarmCause::CommTimeout,
            &Path::root().key("line").key("timeout"),
        ),
    ];
    for (_, by, cause, path) in raised.into_iter().filter(|it| it.0) {
        if !alarms.iter().any(|alarm| alarm.cause == cause) {
            let name = cause.name();
            let what = format!("`{by}` is wired, but alarm `{name}` has no number");
            let advice = format!("add `{name}: {{code: N}}` to `alarms`");
            names.report(Problem::key(path.clone(), what).advise(advice));
        }
    }
    check_history(raw, wired, names);
    check_stops(raw, alarms, numbers, names);
}

fn check_history(raw: &RawModel, wired: &Wired, names: &mut Names) {
    let clear = Action::ClearAlarmHistory;
    if wired.does(clear) && raw.alarm_history.is_empty() {
        let what = format!("`{}` is wired, but there is no alarm history", clear.name());
        let problem = Problem::key(Path::root().key("signals"), what);
        names.report(problem.advise("add `alarm_history: [ROW, ...]`"));
    }
    if !raw.alarm_history.is_empty() && raw.alarms.is_empty() {
        let what = "`alarm_history` has no effect: there are no `alarms`";
        let problem = Problem::key(Path::root().key("alarm_history"), what);
        names.report(problem.advise("add them, or remove it"));
    }
}

fn check_stops(raw: &RawModel, alarms: &[Alarm], numbers: &Numbers, names: &mut Names) {
    for (name, alarm) in &raw.alarms {
        if raw.axis.is_none() && alarm.stop != RawAlarmStop::Coast {
            without_motion("stop", &path(name).key("stop"), names);
        }
    }
    let ramps = alarms.iter().any(|alarm| alarm.stop == AlarmStop::Ramp);
    if !ramps && numbers.has(Setting::AlarmDecel) {
        let decel = Setting::AlarmDecel.name();
        let what = format!("`{decel}` has no effect: no alarm stops with a ramp");
        let problem = Problem::key(quantities::path(decel), what);
        names.report(problem.advise("give one `stop: ramp`"));
    }
}
