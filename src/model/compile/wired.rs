//! What of the vocabularies a model has wired, wherever it stands; and what must be wired for something else to have an effect.

use super::names::Names;
use super::uses::Uses;
use crate::model::{Alarm, Shows, Wiring};
use crate::problem::{Path, Problem};
use crate::vocabulary::{Action, AlarmCause, Input, Named, Output, Quantity};

/// The signals, actions and quantities of a model.
pub(super) struct Wired {
    inputs: Vec<Input>,
    actions: Vec<Action>,
    outputs: Vec<Output>,
    quantities: Vec<Quantity>,
}

impl Wired {
    /// What `wiring` has, of which all signals are there, and what rows show.
    pub fn of(wiring: &Wiring, uses: &Uses) -> Self {
        let terminals = wiring.input_terminals.iter().flat_map(|it| &it.codes).map(|it| it.1);
        let words = wiring.input_words.iter().flat_map(|it| &it.positions).map(|it| it.1);
        let bits = wiring.input_bits.iter().flat_map(|(_, bits)| bits).map(|it| it.1);
        let machine = wiring.machine_inputs.iter().copied();
        let inputs = terminals.chain(words).chain(bits).chain(machine).collect();

        let commands = wiring.commands.iter().flat_map(|it| &it.actions).map(|it| it.1);
        let triggers = wiring.triggers.iter().flat_map(|it| &it.actions).map(|it| it.1);
        let actions = commands.chain(triggers).collect();

        let shown = |shows: &'_ Shows| match shows {
            Shows::Bits(bits) => bits.iter().map(|it| it.1.signal).collect(),
            _ => Vec::new(),
        };
        let terminals = wiring.output_terminals.iter().flat_map(|it| &it.codes).map(|it| it.1);
        let words = wiring.output_words.iter().flat_map(|it| &it.bits).map(|it| it.1);
        let bits = uses.shows.iter().flatten().flat_map(shown);
        let outputs = terminals.chain(words).map(|it| it.signal).chain(bits).collect();

        let quantity = |shows: &Shows| match shows {
            Shows::Quantity(quantity) => Some(*quantity),
            _ => None,
        };
        let quantities = uses.shows.iter().flatten().filter_map(quantity).collect();
        Self { inputs, actions, outputs, quantities }
    }

    /// Does anything make the input signal active?
    pub fn has(&self, input: Input) -> bool {
        self.inputs.contains(&input)
    }

    /// Does anything ask for the action?
    pub fn does(&self, action: Action) -> bool {
        self.actions.contains(&action)
    }

    /// Does the output signal show anywhere?
    pub fn shows(&self, output: Output) -> bool {
        self.outputs.contains(&output)
    }

    /// Does a row show the quantity?
    pub fn shows_quantity(&self, quantity: Quantity) -> bool {
        self.quantities.contains(&quantity)
    }

    /// Reports `output` if it shows although nothing turns it on.
    pub fn never_on(&self, output: Output, why: &str, names: &mut Names) {
        if self.shows(output) {
            let what = format!("output signal `{}` is never on: {why}", output.name());
            let path = Path::root().key("signals").key("outputs");
            names.report(Problem::key(path, what).advise("remove it"));
        }
    }
}

/// What `path` stands for ends in an alarm, so the alarm has a number.
pub(super) fn needs_alarm(
    name: &str,
    cause: AlarmCause,
    path: Path,
    alarms: &[Alarm],
    names: &mut Names,
) {
    if !alarms.iter().any(|alarm| alarm.cause == cause) {
        let cause = cause.name();
        let what = format!("`{name}` can raise alarm `{cause}`, which has no number");
        let advice = format!("add `{cause}: {{code: N}}` to `alarms`");
        names.report(Problem::key(path, what).advise(advice));
    }
}

/// Reports `name`, which takes a motion, where nothing starts one.
pub(super) fn without_motion(name: &str, path: &Path, names: &mut Names) {
    let what = format!("`{name}` has no effect: nothing starts a motion");
    let advice = "wire what starts it, or remove it";
    names.report(Problem::key(path.clone(), what).advise(advice));
}
