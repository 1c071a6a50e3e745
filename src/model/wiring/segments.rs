//! Motions by number, how one follows another, and the move that interrupts others: the rows that they go by.

use super::Choice;
use crate::model::RowId;
use crate::units::Unit;
use crate::vocabulary::{Condition, InterruptRule, Lasts, Setting, Taken, Target};

/// The row of a setting.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct SettingRow {
    /// What for.
    pub setting: Setting,
    /// The row that holds its value.
    pub row: RowId,
    /// When a value counts that is written to it.
    pub taken: Taken,
    /// Where a drive keeps the value that counts, from 0 on.
    pub slot: u16,
}

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

    pub(super) fn settings_mut(&mut self) -> impl Iterator<Item = &mut SettingRow> {
        let moves = self.position.iter_mut().flat_map(|it| &mut it.list);
        let moves = moves.flat_map(|it| &mut it.settings);
        moves.chain(self.velocity.iter_mut().flat_map(|it| &mut it.list).flatten())
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

/// What all segments of a chain have in common.
#[derive(Debug)]
pub struct ChainRules {
    /// Which hex digit of the rule has the code of each condition, from the right.
    pub digits: Vec<u8>,
    /// Condition by code.
    pub codes: Vec<(u8, Condition)>,
    /// Unit of a condition's value.
    pub units: Vec<(Condition, Unit)>,
    /// Bit of the rule: wait for all conditions.
    pub all: Option<u8>,
    /// Bit of the rule: go on in motion.
    pub through: Option<u8>,
}

/// How one segment gives way.
#[derive(Debug)]
pub struct ChainLink {
    /// The row with the number of the next.
    pub next: RowId,
    /// The row with the rule.
    pub rule: RowId,
    /// The rows with the conditions' values.
    pub values: Vec<RowId>,
}

impl ChainLink {
    /// Every row of it.
    pub(super) fn rows(&self) -> impl Iterator<Item = RowId> {
        [self.next, self.rule].into_iter().chain(self.values.iter().copied())
    }
}

impl ChainRules {
    /// The conditions of `rule`, each with the index of its value.
    pub fn conditions(&self, rule: u32) -> impl Iterator<Item = (usize, Condition)> {
        self.digits.iter().enumerate().filter_map(move |(i, digit)| {
            let code = (rule >> (4 * digit) & 0xF) as u8;
            self.codes.iter().find(|(it, _)| *it == code).map(|(_, condition)| (i, *condition))
        })
    }

    /// `value` of a condition in the base unit of its dimension.
    pub fn value(&self, condition: Condition, value: i64) -> f64 {
        let unit = self.units.iter().find(|(it, _)| *it == condition);
        value as f64 * unit.map_or(1.0, |(_, unit)| unit.scale)
    }

    pub(in crate::model) fn waits_for_a_step(&self) -> bool {
        self.codes.iter().any(|(_, it)| *it == Condition::Step)
    }
}

/// A move that takes the place of a motion under way.
#[derive(Debug)]
pub struct InterruptWiring {
    /// The rows that it goes by.
    pub settings: Vec<SettingRow>,
    /// May it start?
    pub rule: Choice<InterruptRule>,
}

impl InterruptWiring {
    /// Every row of it.
    pub(super) fn rows(&self) -> impl Iterator<Item = RowId> {
        self.settings.iter().map(|it| it.row).chain(self.rule.row())
    }
}
