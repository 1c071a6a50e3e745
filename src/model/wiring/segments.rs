//! Motions by number, compiled: which rows each segment goes by.

use super::SettingRow;
use super::chain::{ChainLink, ChainRules};
use super::choice::Choice;
use crate::vocabulary::{Lasts, RowId, Target};

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
    pub settings: Vec<SettingRow>,
    /// What its target is.
    pub kind: Choice<Target>,
    /// How it gives way to the next.
    pub link: Option<ChainLink>,
}

/// Runs by number.
#[derive(Debug)]
pub struct VelocitySegments {
    /// Number of the first.
    pub first: u16,
    /// The rows that each goes by.
    pub list: Vec<Vec<SettingRow>>,
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
    pub fn get(&self, number: u16) -> Option<&[SettingRow]> {
        self.list.get(usize::from(number.checked_sub(self.first)?)).map(Vec::as_slice)
    }
}

impl Segments {
    /// The settings of all of them.
    pub fn settings(&self) -> impl Iterator<Item = &SettingRow> {
        let moves = self.position.iter().flat_map(|it| &it.list).flat_map(|it| &it.settings);
        moves.chain(self.velocity.iter().flat_map(|it| &it.list).flatten())
    }

    /// Every row that a segment goes by.
    pub fn rows(&self) -> impl Iterator<Item = RowId> {
        self.settings().map(|it| it.row).chain(self.rules())
    }

    /// The rows of what is no number of a segment's motion: kinds, triggers and chains.
    pub fn rules(&self) -> impl Iterator<Item = RowId> {
        let moves = self.position.iter().flat_map(|it| &it.list).flat_map(|segment| {
            let links = segment.link.iter().flat_map(ChainLink::rows);
            segment.kind.row().into_iter().chain(links)
        });
        moves.chain(self.velocity.iter().filter_map(|it| it.trigger.row()))
    }
}
