//! What of the catalogues a model has wired, wherever it stands.

use super::Shows;
use super::compile::Wirer;
use crate::problem::{Path, Problem, suggest};
use crate::vocabulary::{Action, AlarmCause, HomeStarter, Input, Named, Output};

/// Signals that a machine moves, and that a homing step can wait for.
const SWITCHES: [Input; 3] = [Input::HomeSwitch, Input::LimitPos, Input::LimitNeg];

impl Wirer<'_> {
    pub(super) fn inputs_wired(&self) -> Vec<Input> {
        let wiring = &self.wiring;
        let machine = wiring.machine_inputs.iter().copied();
        let terminals = wiring.input_terminals.iter().flat_map(|it| &it.codes).map(|it| it.1);
        let words = wiring.input_words.iter().flat_map(|it| &it.positions).map(|it| it.1);
        let bits = wiring.input_bits.iter().flat_map(|(_, bits)| bits).map(|it| it.1);
        terminals.chain(words).chain(bits).chain(machine).collect()
    }

    pub(super) fn actions_wired(&self) -> Vec<Action> {
        let commands = self.wiring.commands.iter().flat_map(|it| &it.actions).map(|it| it.1);
        let triggers = self.wiring.triggers.iter().flat_map(|it| &it.actions).map(|it| it.1);
        commands.chain(triggers).collect()
    }

    pub(super) fn is_shown(&self, output: Output) -> bool {
        let wiring = &self.wiring;
        let terminals = wiring.output_terminals.iter().flat_map(|it| &it.codes).map(|it| it.1);
        let words = wiring.output_words.iter().flat_map(|it| &it.positions).map(|it| it.1);
        let bits = wiring.shows.iter().flatten().filter_map(|it| match it {
            Shows::Bits(bits) => Some(bits),
            _ => None,
        });
        let bits = bits.flatten().map(|it| it.1);
        terminals.chain(words).chain(bits).any(|it| it.signal == output)
    }

    /// The starters that a row of the model allows; `None` where no row decides.
    pub(super) fn starters(&self) -> Option<Vec<HomeStarter>> {
        let starter = self.wiring.homing.as_ref()?.starter.as_ref()?;
        Some(starter.codes.values().copied().collect())
    }

    /// Does a row of the model allow a homing that nobody asks for?
    pub(super) fn homes_at_first_enable(&self) -> bool {
        self.starters().is_some_and(|it| it.contains(&HomeStarter::FirstEnable))
    }

    /// The signal of a switch by its name.
    pub(super) fn switch(&mut self, name: &str, path: &Path) -> Option<Input> {
        let found = SWITCHES.into_iter().find(|it| it.name() == name);
        if found.is_none() {
            let names = SWITCHES.map(Named::name);
            let advice = suggest::did_you_mean(name, names)
                .unwrap_or_else(|| format!("known: {}", names.join(", ")));
            let what = format!("unknown switch `{name}`");
            self.problems.push(Problem::value(path.clone(), what).advise(advice));
        }
        found
    }

    /// Tells of `key`, which has no effect.
    pub(super) fn unused(&mut self, key: &str, why: &str, path: &Path) {
        let what = format!("`{key}` has no effect: {why}");
        self.problems.push(Problem::key(path.key(key), what).advise("remove it"));
    }

    /// Tells of `output` if it shows although nothing turns it on.
    pub(super) fn never_on(&mut self, output: Output, why: &str) {
        if self.is_shown(output) {
            let what = format!("output signal `{}` is never on: {why}", output.name());
            let path = Path::root().key("signals").key("outputs");
            self.problems.push(Problem::key(path, what).advise("remove it"));
        }
    }

    /// What `path` stands for ends in an alarm, so the alarm has a number.
    pub(super) fn needs_alarm(&mut self, name: &str, cause: AlarmCause, path: Path) {
        if self.wiring.alarm(cause).is_none() {
            let cause = cause.name();
            let what = format!("`{name}` can raise alarm `{cause}`, which has no number");
            let advice = format!("add `{cause}: {{code: N}}` to `alarms`");
            self.problems.push(Problem::key(path, what).advise(advice));
        }
    }
}
