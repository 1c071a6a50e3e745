//! What of the catalogues a model has wired, wherever it stands.

use super::Shows;
use super::compile::Wirer;
use crate::words::{Action, Input, Output};

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
}
