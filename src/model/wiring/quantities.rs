//! Numbers by role: rows that show what the drive computes, and rows that its motions go by.

use super::Shows;
use super::compile::Wirer;
use crate::model::RowId;
use crate::problem::{At, Path, Problem, suggest};
use crate::units::{Dimension, Unit};
use crate::words::{Quantity, Setting, Word};
use std::collections::BTreeMap;

impl Wirer<'_> {
    pub(super) fn quantities(&mut self, raw: &BTreeMap<String, String>) {
        let path = Path::root().key("quantities");
        for (name, register) in raw {
            let path = path.key(name);
            let (quantity, setting) = (Quantity::parse(name), Setting::parse(name));
            if quantity.is_none() && setting.is_none() {
                self.no_quantity(name, &path);
                continue;
            }
            let Some(row) = self.row(register, &path) else { continue };
            if let Some(quantity) = quantity {
                self.dimension(row, name, &[quantity.dimension()], &path);
                self.show(row, Shows::Quantity(quantity), &path, At::Value);
            }
            if let Some(setting) = setting {
                self.dimension(row, name, setting.dimensions(), &path);
                self.wiring.axis.settings.push((setting, row));
            }
        }
    }

    fn no_quantity(&mut self, name: &str, path: &Path) {
        let names = || {
            let quantities = Quantity::ALL.iter().map(|it| it.name());
            quantities.chain(Setting::ALL.iter().map(|it| it.name()))
        };
        let advice = suggest::did_you_mean(name, names())
            .unwrap_or_else(|| format!("known: {}", names().collect::<Vec<_>>().join(", ")));
        let what = format!("no quantity `{name}`");
        self.problems.push(Problem::key(path.clone(), what).advise(advice));
    }

    pub(super) fn dimension(&mut self, row: RowId, name: &str, want: &[Dimension], path: &Path) {
        let row = self.rows.map.row(row);
        if want.contains(&row.unit.dimension) {
            return;
        }
        let symbols: Vec<_> = want.iter().flat_map(|it| Unit::symbols_of(*it)).collect();
        let (what, advice) = match symbols.as_slice() {
            [] => ("is a plain number".to_owned(), "take the unit away".to_owned()),
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
