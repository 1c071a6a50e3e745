//! Which rows a model uses, and when a value written to one takes effect.

use super::{Choice, Counts, HomingRules, Number, Reaction, Wiring};
use crate::model::{Applies, Model, RowId};
use crate::vocabulary::{Named, Taken};

impl Wiring {
    /// Every row that shows, sets off or decides something. One may come more than once.
    pub fn rows(&self) -> impl Iterator<Item = RowId> + '_ {
        let shows = self.shows.iter().map(Option::is_some);
        let reacts = self.reactions.iter().map(|it| *it != Reaction::None);
        let by_index =
            shows.zip(reacts).enumerate().filter(|(_, (shows, reacts))| *shows || *reacts);
        let thresholds = self.thresholds.iter().filter_map(|(_, number)| number.row());
        let hold = self.input_words.iter().flat_map(|it| &it.hold).map(|it| it.row);
        let enabled_by = self.output_words.iter().filter_map(|it| it.enabled_by);
        let terminals = self.output_terminals.iter();
        let terminals =
            terminals.flat_map(|it| it.functions.iter().copied().chain(it.normally_closed));
        by_index
            .map(|(i, _)| RowId(i as u16))
            .chain(self.axis.rows())
            .chain(self.homing.iter().flat_map(HomingRules::rows))
            .chain(self.limits.rows())
            .chain(self.user_outputs)
            .chain(thresholds)
            .chain(hold)
            .chain(enabled_by)
            .chain(terminals)
    }

    /// Can a value of `row` count from a standstill on? An axis turns round there and takes settings, and a
    /// homing starts.
    pub fn counts_from_standstill(&self, row: RowId) -> bool {
        let settings = self.axis.all_settings().map(|it| it.row);
        let homing = self.homing.iter().flat_map(HomingRules::rows);
        let axis = self.axis.reversed.into_iter().chain(self.axis.counts_per_rev.row());
        settings.chain(homing).chain(axis).any(|it| it == row)
    }
}

impl Model {
    /// What goes by the value of `row`, and when a new one counts for it. Empty for a row that nothing goes by,
    /// or whose value is an order or a signal.
    pub fn counts(&self, row: RowId) -> Vec<(&'static str, Taken)> {
        let (wiring, axis) = (&self.wiring, &self.wiring.axis);
        let mut counts = Vec::new();
        let mut add = |name, taken| {
            if !counts.contains(&(name, taken)) {
                counts.push((name, taken));
            }
        };
        let settings = axis.all_settings().filter(|it| it.row == row);
        settings.for_each(|it| add(it.setting.name(), it.taken));
        let thresholds = wiring.thresholds.iter().filter(|(_, it)| *it == Number::Row(row));
        thresholds.for_each(|(it, _)| add(it.name(), Taken::Live));
        let is = |choice: Option<RowId>| choice == Some(row);
        let hold = wiring.input_words.as_ref().and_then(|it| it.hold.as_ref()).map(|it| it.row);
        let whole = [
            ("axis.counts_per_rev", axis.counts_per_rev == Counts::Row(row), Taken::AtStart),
            ("axis.reversed", is(axis.reversed), Taken::AtStart),
            ("axis.speed_unit", is(axis.speed_unit.as_ref().map(|it| it.row)), Taken::Live),
            ("limits.stop", is(wiring.limits.stop.as_ref().and_then(Choice::row)), Taken::Live),
            ("limits.soft", is(wiring.limits.soft.as_ref().and_then(Choice::row)), Taken::Live),
            ("line.timeout", wiring.timeout.as_ref().is_some_and(|it| it.row == row), Taken::Live),
            ("hold", is(hold), Taken::Live),
        ];
        whole.into_iter().filter(|it| it.1).for_each(|(name, _, taken)| add(name, taken));
        if axis.segments.rules().any(|it| it == row) {
            add("axis.segments", Taken::AtOrder);
        }
        if let Some(homing) = &wiring.homing {
            let live = self.map.row(row).applies == Some(Applies::Now);
            let ordered = if live { Taken::Live } else { Taken::AtOrder };
            let homing = [
                ("homing.method", is(homing.method), Taken::AtOrder),
                ("homing.starter", is(homing.starter.as_ref().map(|it| it.row)), Taken::AtOrder),
                ("homing.limit", is(homing.limit.as_ref().and_then(Choice::row)), ordered),
                ("homing.limit_source", is(homing.source.as_ref().and_then(Choice::row)), ordered),
                ("homing.index", is(homing.index.as_ref().and_then(Choice::row)), ordered),
                ("homing.finish", is(homing.finish.as_ref().and_then(Choice::row)), ordered),
                ("homing.time_factor", is(homing.time_factor.map(|it| it.row)), ordered),
            ];
            // A homing starts from standstill only, so its order is a start.
            let at = |taken| if taken == Taken::AtOrder { Taken::AtStart } else { taken };
            homing.into_iter().filter(|it| it.1).for_each(|(name, _, taken)| add(name, at(taken)));
        }
        counts
    }
}
