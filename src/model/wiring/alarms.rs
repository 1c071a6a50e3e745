//! What goes with alarms: the rows that remember them, and whether what raises, clears or follows one has an
//! alarm to do it with.

use super::compile::Wirer;
use super::{AlarmStop, Shows};
use crate::model::raw::{RawAlarmStop, RawModel};
use crate::problem::{At, Path, Problem};
use crate::units::{Dimension, Unit};
use crate::vocabulary::{Action, AlarmCause, Input, Named, Quantity, Setting};

impl Wirer<'_> {
    pub(super) fn alarm_history(&mut self, registers: &[String]) {
        let path = Path::root().key("alarm_history");
        let rows = self.row_list(registers, &path);
        for (i, row) in rows.iter().enumerate() {
            self.show(*row, Shows::PastAlarm(i as u16), &path.index(i), At::Value);
        }
        self.wiring.alarm_history = rows;
    }

    /// The voltage that `text` says, with its unit, of the alarm at `path`.
    pub(super) fn bus_voltage(&mut self, text: &str, path: &Path) -> Option<f64> {
        let (key, quantity) = ("bus_voltage", Quantity::BusVoltage);
        let shown = Shows::Quantity(quantity);
        if !self.wiring.shows.iter().flatten().any(|it| *it == shown) {
            self.unused(key, &format!("no row shows `{}`", quantity.name()), path);
        }
        let volts = Unit::parse(text).filter(|it| it.dimension == Dimension::Voltage);
        if volts.is_none() {
            let problem = Problem::value(path.key(key), format!("`{text}` is not a voltage"));
            self.problems.push(problem.advise("write a number with its unit: `180 V`"));
        }
        volts.map(|it| it.scale)
    }

    /// To be called when all the wiring is there.
    pub(super) fn alarms_fit(&mut self, raw: &RawModel) {
        let (inputs, actions) = (self.inputs_wired(), self.actions_wired());
        let signals = Path::root().key("signals");
        if inputs.contains(&Input::AlarmForce) {
            self.wired_alarm("alarm_force", AlarmCause::Forced, &signals);
        }
        if actions.contains(&Action::EncoderReset) {
            self.wired_alarm(Action::EncoderReset.name(), AlarmCause::Encoder, &signals);
        }
        if raw.line.timeout.is_some() {
            let path = Path::root().key("line").key("timeout");
            self.wired_alarm("timeout", AlarmCause::CommTimeout, &path);
        }
        self.history_fits(raw, actions.contains(&Action::ClearAlarmHistory));
        self.stops_fit(raw);
    }

    fn wired_alarm(&mut self, by: &str, cause: AlarmCause, path: &Path) {
        if self.wiring.alarm(cause).is_some() {
            return;
        }
        let name = cause.name();
        let what = format!("`{by}` is wired, but alarm `{name}` has no number");
        let advice = format!("add `{name}: {{code: N}}` to `alarms`");
        self.problems.push(Problem::key(path.clone(), what).advise(advice));
    }

    fn history_fits(&mut self, raw: &RawModel, cleared: bool) {
        let clear = Action::ClearAlarmHistory.name();
        if cleared && raw.alarm_history.is_empty() {
            let what = format!("`{clear}` is wired, but there is no alarm history");
            let problem = Problem::key(Path::root().key("signals"), what);
            self.problems.push(problem.advise("add `alarm_history: [ROW, ...]`"));
        }
        if !raw.alarm_history.is_empty() && raw.alarms.is_empty() {
            let what = "`alarm_history` has no effect: there are no `alarms`";
            let problem = Problem::key(Path::root().key("alarm_history"), what);
            self.problems.push(problem.advise("add them, or remove it"));
        }
    }

    fn stops_fit(&mut self, raw: &RawModel) {
        for (name, alarm) in &raw.alarms {
            if raw.axis.is_none() && alarm.stop != RawAlarmStop::Coast {
                self.without_motion("stop", &Path::root().key("alarms").key(name).key("stop"));
            }
        }
        let ramps = self.wiring.alarms.iter().any(|alarm| alarm.stop == AlarmStop::Ramp);
        if !ramps && self.wiring.axis.setting(Setting::AlarmDecel).is_some() {
            let decel = Setting::AlarmDecel.name();
            let what = format!("`{decel}` has no effect: no alarm stops with a ramp");
            let path = Path::root().key("quantities").key(decel);
            self.problems.push(Problem::key(path, what).advise("give one `stop: ramp`"));
        }
    }
}
