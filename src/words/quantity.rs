//! Numbers that the drive computes: a model says which row shows them.

use super::words;
use crate::units::Dimension;

words! {
    /// A number with a dimension.
    Quantity {
        PositionActual "position.actual" "where the axis stands, in the drive's coordinate",
        SpeedActual "speed.actual" "how fast the axis goes; negative in the negative direction",
        SegmentRunning "segment.running" "number of the position segment that started last; 0 after power-on",
        SegmentNext "segment.next" "number of the position segment that comes next in the chain under way; without one, of the one selected",
        AlarmCode "alarm.code" "the vendor's number of the present alarm, 0 without one",
        UnitInUse "unit.in_use" "the unit address that the drive answers to",
        UnitSwitches "unit.switches" "the address switches as they are set",
    }
}

impl Quantity {
    /// What it measures; the row's unit must fit.
    pub fn dimension(self) -> Dimension {
        match self {
            Self::PositionActual => Dimension::Position,
            Self::SpeedActual => Dimension::Speed,
            Self::SegmentRunning
            | Self::SegmentNext
            | Self::AlarmCode
            | Self::UnitInUse
            | Self::UnitSwitches => Dimension::None,
        }
    }
}
