//! Outputs that a master sets itself.

use super::compile::Wirer;
use crate::problem::{At, Path, Problem};
use crate::vocabulary::{Named, Output};

impl Wirer<'_> {
    /// To be called when all that shows outputs is wired.
    pub(super) fn user_outputs(&mut self, register: Option<&str>, path: &Path) {
        let signals = [Output::User0, Output::User1, Output::User2];
        let shown = signals.into_iter().find(|it| self.is_shown(*it)).map(Named::name);
        let at = path.key("user");
        match (register, shown) {
            (Some(_), None) => {
                let what = "`user` has no effect: none of `user_0`, `user_1`, `user_2` is shown";
                self.problems.push(Problem::key(at.clone(), what).advise("show one"));
            }
            (None, Some(name)) => {
                let what = format!("`{name}` is shown, but no row holds it");
                let problem = Problem::key(path.clone(), what);
                self.problems.push(problem.advise("add `user: ROW` to `outputs`"));
            }
            _ => {}
        }
        let Some(row) = register.and_then(|register| self.row(register, &at)) else { return };
        self.writable(row, &at, At::Value);
        self.wiring.user_outputs = Some(row);
    }
}
