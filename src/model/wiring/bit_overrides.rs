//! Settings that take the signals of input bits away: to a connector, say, that is the signal's only source then.

use super::compile::Wirer;
use super::{BitOverride, Reaction};
use crate::model::raw::RawInputs;
use crate::problem::{At, Path, Problem};

impl Wirer<'_> {
    /// To be called when the bits are wired.
    pub(super) fn bit_overrides(&mut self, raw: &RawInputs, path: &Path) {
        for (register, bits) in &raw.claims {
            let path = path.key(register);
            let Some(row) = self.row_key(register, &path) else { continue };
            for (bit, claim) in bits {
                let path = path.key(bit);
                if !raw.bits.get(register).is_some_and(|bits| bits.contains_key(bit)) {
                    let what = format!("bit {bit} of {register} has no signal to override");
                    self.problems.push(Problem::key(path.clone(), what).advise("remove it"));
                }
                let Some(by) = self.digit(claim, &path) else { continue };
                self.react(by.row, Reaction::Inputs, &path.key("register"), At::Value);
                self.wiring.bit_overrides.push(BitOverride { row, bit: *bit, by });
            }
        }
    }
}
