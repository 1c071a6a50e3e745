//! Motions by number, compiled: which rows each segment goes by.

use super::chain::{ChainRules, Link};
use crate::model::line::Coded;
use crate::words::{RowId, Setting};

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
    /// What its target is; nothing where it is empty.
    pub kind: PerRow<Target>,
    /// How it gives way to the next.
    pub link: Option<Link>,
}

/// What the target of a move is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Target {
    /// A way to go.
    Relative,
    /// A position.
    Absolute,
}

/// Runs by number.
#[derive(Debug)]
pub struct VelocitySegments {
    /// Number of the first.
    pub first: u16,
    /// The rows that each goes by.
    pub list: Vec<Vec<(Setting, RowId)>>,
    /// How long one lasts.
    pub trigger: PerRow<Lasts>,
}

/// How long a run lasts.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Lasts {
    /// While its signal is active.
    Level,
    /// From the rising edge of its signal until something stops it.
    Edge,
}

/// Something that is always the same, or as a row says.
#[derive(Debug)]
pub enum PerRow<T> {
    /// Always the same.
    Fixed(T),
    /// As a row says.
    Row(Coded<T>),
}

impl<T: Copy> PerRow<T> {
    /// What it is, given the values of rows; nothing where a row holds a value that stands for nothing.
    pub fn get(&self, value: impl FnOnce(RowId) -> i64) -> Option<T> {
        match self {
            Self::Fixed(it) => Some(*it),
            Self::Row(coded) => coded.decode(value(coded.row)),
        }
    }

    fn row(&self) -> Option<RowId> {
        match self {
            Self::Fixed(_) => None,
            Self::Row(coded) => Some(coded.row),
        }
    }
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
