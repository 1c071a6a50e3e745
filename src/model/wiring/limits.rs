//! What the limits of an axis do: words resolved, and whether there is a limit at all.

use super::Limits;
use super::compile::Wirer;
use crate::model::raw::RawLimits;
use crate::problem::{Path, Problem};
use crate::words::{Input, Setting, Word};

impl Wirer<'_> {
    pub(super) fn limits(&mut self, raw: &RawLimits) {
        let path = Path::root().key("limits");
        let stop = self.words_chosen(&raw.stop, "way to stop", &path.key("stop"));
        let soft = self.words_chosen(&raw.soft, "rule for soft limits", &path.key("soft"));
        let has = |wirer: &Self, setting| wirer.wiring.axis.setting(setting).is_some();
        let softs = [Setting::SoftLimitPos, Setting::SoftLimitNeg];
        let wired = softs.map(|setting| has(self, setting));
        match wired {
            [true, true] => {}
            [false, false] => {
                if soft.is_some() {
                    let what = "`soft` changes nothing: no row holds a soft limit";
                    let advice = "wire `limit.soft_pos` and `limit.soft_neg`, or leave it out";
                    self.problems.push(Problem::key(path.key("soft"), what).advise(advice));
                }
            }
            _ => {
                let name = softs[usize::from(wired[0])].name();
                let what = format!("no row holds `{name}`, and soft limits are two");
                self.problems.push(Problem::key(Path::root().key("quantities"), what));
            }
        }
        let inputs = self.inputs_wired();
        let any = [Input::LimitPos, Input::LimitNeg].iter().any(|it| inputs.contains(it));
        if stop.is_some() && !any && wired == [false, false] {
            let what = "`stop` changes nothing: there is no limit";
            self.problems.push(Problem::key(path.key("stop"), what).advise("leave it out"));
        }
        self.wiring.limits = Limits { stop, soft };
    }
}
