//! How an axis looks for its origin.

use super::{Choice, Coded, Digit};
use crate::model::RowId;
use crate::vocabulary::{
    HomeStarter, IndexRule, LimitRule, LimitSource, Method, OriginPosition, OriginStop,
};
use std::collections::BTreeMap;

/// How the axis looks for its origin.
#[derive(Debug)]
pub struct HomingRules {
    /// The row with the number of the method; `None` where there is one.
    pub method: Option<RowId>,
    /// Methods by number.
    pub methods: BTreeMap<i64, Method>,
    /// What starts it; `None` is everything that is wired.
    pub starter: Option<Coded<HomeStarter>>,
    /// What a limit on the way means.
    pub limit: Option<Choice<LimitRule>>,
    /// What tells that there is one.
    pub source: Option<Choice<LimitSource>>,
    /// Whether an index pulse refines the origin.
    pub index: Option<Choice<IndexRule>>,
    /// How the axis stands at the origin.
    pub stop: OriginStop,
    /// What happens there.
    pub finish: Option<Choice<Finish>>,
    /// Factor of the time limit; 0 is none.
    pub time_factor: Option<Digit>,
}

impl HomingRules {
    /// What a limit means where a file leaves it out.
    pub const LIMIT: LimitRule = LimitRule::Turn;
    /// What tells of a limit where a file leaves it out.
    pub const SOURCE: LimitSource = LimitSource::Switch;
    /// Whether an index pulse counts where a file leaves it out.
    pub const INDEX: IndexRule = IndexRule::None;

    /// The rows that it goes by, when it starts.
    pub fn rows(&self) -> impl Iterator<Item = RowId> + '_ {
        let choices = [
            self.limit.as_ref().and_then(Choice::row),
            self.source.as_ref().and_then(Choice::row),
            self.index.as_ref().and_then(Choice::row),
            self.finish.as_ref().and_then(Choice::row),
            self.starter.as_ref().map(|it| it.row),
            self.time_factor.map(|it| it.row),
            self.method,
        ];
        choices.into_iter().flatten()
    }
}

/// What happens when the origin is found.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Finish {
    /// Go on by `home.way`?
    pub go: bool,
    /// What the position register says then.
    pub position: OriginPosition,
    /// Does it say that of the origin, and not of where the axis stands in the end?
    pub of_origin: bool,
}
