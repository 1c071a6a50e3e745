//! Motions by number, compiled: which rows each segment goes by.

use super::chain::{ChainRules, Link};
use super::choice::Choice;
use crate::words::{Lasts, RowId, Setting, Target};

/// Motions by number.
#[derive(Debug, Default)]
pub struct Segments {
    /// Moves.
    pub position: Option<PositionSegments>,
    /// Runs.
    pub velocity: Option<VelocitySegments>,
}

/// Moves by number.
#[derive(Debug)]
pub struct PositionSegments {
    /// Number of the first.
    pub first: u16,
    /// All of them.
    pub list: Vec<PositionSegment>,
    /// What those that follow each other have in common.
    pub chain: Option<ChainRules>,
}

/// A move.
#[derive(Debug)]
pub struct PositionSegment {
    /// The rows that it goes by.
    pub settings: Vec<(Setting, RowId)>,
    /// What its target is.
    pub kind: Choice<Target>,
    /// How it gives way to the next.
    pub link: Option<Link>,
}

/// Runs by number.
#[derive(Debug)]
pub struct VelocitySegments {
    /// Number of the first.
    pub first: u16,
    /// The rows that each goes by.
    pub list: Vec<Vec<(Setting, RowId)>>,
    /// How long one lasts.
    pub trigger: Choice<Lasts>,
}

impl PositionSegments {
    /// The segment with that number.
    pub fn get(&self, number: u16) -> Option<&PositionSegment> {
        self.list.get(usize::from(number.checked_sub(self.first)?))
    }
}

impl VelocitySegments {
    /// The rows of the segment with that number.
    pub fn get(&self, number: u16) -> Option<&[(Setting, RowId)]> {
        self.list.get(usize::from(number.checked_sub(self.first)?)).map(Vec::as_slice)
    }
}

impl Segments {
    /// Every row that a segment goes by.
    pub fn rows(&self) -> impl Iterator<Item = RowId> {
        let moves = self.position.iter().flat_map(|it| &it.list).flat_map(|segment| {
            let links = segment.link.iter().flat_map(Link::rows);
            rows_of(&segment.settings).chain(segment.kind.row()).chain(links)
        });
        let runs = self.velocity.iter().flat_map(|it| {
            it.list.iter().flat_map(|settings| rows_of(settings)).chain(it.trigger.row())
        });
        moves.chain(runs)
    }
}

fn rows_of(settings: &[(Setting, RowId)]) -> impl Iterator<Item = RowId> {
    settings.iter().map(|(_, row)| *row)
}
