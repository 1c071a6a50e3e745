//! Numbers by role: rows that show what the drive computes, and what its motions and outputs go by.

use super::compile::Wirer;
use super::{SettingRow, Shows};
use crate::model::raw::{RawModel, RawQuantity};
use crate::model::{Applies, RowId};
use crate::problem::{At, Path, Problem, suggest};
use crate::units::{Dimension, Unit};
use crate::vocabulary::{Named, Quantity, Setting, Taken, Threshold};

impl Wirer<'_> {
    pub(super) fn quantities(&mut self, raw: &RawModel) {
        let path = Path::root().key("settings_taken");
        let taken = raw.settings_taken.as_deref();
        let taken = taken.and_then(|it| self.word(it, "effect time", &path));
        self.taken = taken.unwrap_or(Taken::AtOrder);
        let path = Path::root().key("quantities");
        for (name, raw) in &raw.quantities {
            let (path, register) = (path.key(name), raw.register());
            if let Some(threshold) = Threshold::parse(name) {
                self.threshold(threshold, register, &path);
                self.no_setting(name, raw, &path);
                continue;
            }
            let (quantity, setting) = (Quantity::parse(name), Setting::parse(name));
            if quantity.is_none() && setting.is_none() {
                self.no_quantity(name, &path);
                continue;
            }
            let Some(row) = self.row(register, &path) else { continue };
            if let Some(quantity) = quantity {
                self.dimension(row, name, &[quantity.dimension()], &path);
                self.show(row, Shows::Quantity(quantity), &path, At::Value);
                self.no_setting(name, raw, &path);
            }
            if let Some(setting) = setting {
                let it = self.setting(setting, row, raw, &path);
                self.wiring.axis.settings.push(it);
            }
        }
    }

    /// The row of a setting, and when its values count.
    pub(super) fn setting(
        &mut self,
        setting: Setting,
        row: RowId,
        raw: &RawQuantity,
        path: &Path,
    ) -> SettingRow {
        self.dimension(row, setting.name(), setting.dimensions(), path);
        let said =
            raw.taken().and_then(|it| self.word::<Taken>(it, "effect time", &path.key("taken")));
        let printed = match self.rows.map.row(row).applies {
            Some(Applies::Now) => Some(Taken::Live),
            Some(Applies::AtStop) => Some(Taken::AtStart),
            Some(Applies::PowerOn) | None => None,
        };
        let silent = if setting.is_bound() { Taken::Live } else { self.taken };
        let slot = self.wiring.axis.slots;
        self.wiring.axis.slots += 1;
        SettingRow { setting, row, taken: said.or(printed).unwrap_or(silent), slot }
    }

    /// Something goes by `settings_taken`. To be called when the axis is wired.
    pub(super) fn settings_taken(&mut self, raw: &RawModel) {
        let silent =
            |it: &SettingRow| !it.setting.is_bound() && self.rows.map.row(it.row).applies.is_none();
        if raw.settings_taken.is_some() && !self.wiring.axis.all_settings().any(silent) {
            let what = "`settings_taken` has no effect: all settings have `applies` in their rows";
            let problem = Problem::key(Path::root().key("settings_taken"), what);
            self.problems.push(problem.advise("remove it"));
        }
    }

    /// What no motion goes by counts whenever somebody looks.
    fn no_setting(&mut self, name: &str, raw: &RawQuantity, path: &Path) {
        if raw.taken().is_some() {
            let what = format!("`taken` has no effect: `{name}` is not a setting of a motion");
            let problem = Problem::key(path.key("taken"), what);
            self.problems.push(problem.advise("remove it"));
        }
    }

    fn no_quantity(&mut self, name: &str, path: &Path) {
        let names = || {
            let quantities = Quantity::ALL.iter().map(|it| it.name());
            let settings = Setting::ALL.iter().map(|it| it.name());
            quantities.chain(settings).chain(Threshold::ALL.iter().map(|it| it.name()))
        };
        let advice = suggest::did_you_mean(name, names())
            .unwrap_or_else(|| format!("known: {}", names().collect::<Vec<_>>().join(", ")));
        let what = format!("unknown quantity `{name}`");
        self.problems.push(Problem::key(path.clone(), what).advise(advice));
    }

    pub(super) fn dimension(&mut self, row: RowId, name: &str, want: &[Dimension], path: &Path) {
        let row = self.rows.map.row(row);
        if want.contains(&row.unit.dimension) {
            return;
        }
        let symbols: Vec<_> = want.iter().flat_map(|it| Unit::symbols_of(*it)).collect();
        let (what, advice) = match symbols.as_slice() {
            [] => ("has no unit".to_owned(), "remove the unit".to_owned()),
            [first, ..] => {
                let what = format!("is in {}", symbols.join(" or "));
                (what, format!("give the row `unit: {first}`"))
            }
        };
        let have = match row.unit_text.as_str() {
            "" => "has no unit".to_owned(),
            unit => format!("is in {unit}"),
        };
        let what = format!("`{name}` {what}, but {} {have}", row.id);
        let advice = format!("{advice}, or wire another row");
        self.problems.push(Problem::value(path.clone(), what).advise(advice));
    }
}
