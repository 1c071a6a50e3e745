//! Numbers that outputs go by: a model says which row holds them, or fixes them.

use super::words;
use crate::units::Dimension;

words! {
    /// A number that an output is held against, whenever somebody looks at it.
    Threshold {
        ZeroSpeed "zero.speed" "`zero_speed` shows up to this speed; 0 if left out",
        TurningSpeed "turning.speed" "`turning` shows above this speed",
        ReachedSpeed "reached.speed" "the speed that `speed_reached` is about",
        ReachedWindow "reached.window" "how far from `reached.speed` it still shows",
        AgreesWindow "agrees.window" "how near `speed_agrees` takes a speed for the one that was ordered",
    }
}

impl Threshold {
    /// What it measures; the row's unit must fit.
    pub fn dimension(self) -> Dimension {
        match self {
            Self::ZeroSpeed
            | Self::TurningSpeed
            | Self::ReachedSpeed
            | Self::ReachedWindow
            | Self::AgreesWindow => Dimension::Speed,
        }
    }
}
