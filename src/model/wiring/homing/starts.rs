//! What starts a homing: a signal, an action or a row, and whether they agree.

use super::super::compile::Wirer;
use crate::problem::{Path, Problem};
use crate::vocabulary::{Action, HomeStarter, HomingStep, Input, Method, Named, Output};

impl Wirer<'_> {
    /// A homing has a starter, a starter has a homing, and what shows or needs one has one.
    pub(in crate::model::wiring) fn homing_starts(&mut self, inputs: &[Input], actions: &[Action]) {
        let wired = [
            (HomeStarter::Input, inputs.contains(&Input::HomeStart)),
            (HomeStarter::Command, actions.contains(&Action::HomeStart)),
        ];
        let any = wired.iter().any(|(_, wired)| *wired) || self.homes_at_first_enable();
        let path = Path::root().key("homing");
        let Some(homing) = &self.wiring.homing else {
            if any {
                let what = "`home_start` is wired, but there is no `homing`";
                self.problems
                    .push(Problem::key(Path::root().key("signals"), what).advise("add `homing`"));
            }
            return self.never_on(Output::HomeDone, "there is no `homing`");
        };
        let looks =
            |step: HomingStep| step.until.edge().is_some_and(|it| it.signal == Input::HomeSwitch);
        let looked_for = homing.methods.values().flat_map(Method::all_steps).any(looks);
        if inputs.contains(&Input::HomeSwitch) && !looked_for {
            let what = "`home_switch` has no effect: no homing step waits for it";
            let signals = Path::root().key("signals").key("inputs");
            self.problems.push(Problem::key(signals, what).advise("remove it"));
        }
        if !any {
            let what = "`homing` has no effect: nothing starts it";
            let problem = Problem::key(path, what);
            self.problems.push(problem.advise("wire `home_start`, or remove it"));
            return;
        }
        let Some(starters) = self.starters() else { return };
        for (starter, wired) in wired.into_iter().filter(|(it, is)| starters.contains(it) != *is) {
            let name = starter.name();
            let what = match wired {
                true => format!("no code is `{name}`, but `home_start` is wired"),
                false => format!("`{name}` starts nothing: no such `home_start` is wired"),
            };
            let advice = match starter {
                HomeStarter::Input => "an input signal needs its code, and a code its signal",
                _ => "an action needs its code, and a code its action",
            };
            self.problems.push(Problem::key(path.key("starter"), what).advise(advice));
        }
    }
}
