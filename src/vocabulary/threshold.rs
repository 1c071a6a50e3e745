//! Numbers that outputs and an alarm go by: a model says which row holds them, or fixes them.

use super::named_terms;
use crate::units::Dimension;

named_terms! {
    /// A number that something of the axis is held against at any time.
    Threshold {
        ZeroSpeed "zero.speed" "`zero_speed` shows up to this speed; 0 if left out",
        TurningSpeed "turning.speed" "`turning` shows above this speed",
        ReachedSpeed "reached.speed" "the speed that `speed_reached` is about",
        ReachedWindow "reached.window" "how far from `reached.speed` it still shows",
        PositionWindow "position.window" "how far from its end a move may be for `in_position`; 0 if left out",
        PositionSettle "position.settle" "how long it must have been so near; 0 if left out",
        InterruptDoneTime "interrupt.done_time" "how long `interrupt_done` shows",
        CoincidesWindow "coincides.window" "how far the axis may be behind its command for `coincides`",
        NearWindow "near.window" "how far the axis may be behind its command for `near`",
        AgreesWindow "agrees.window" "how near `speed_agrees` takes a speed for the one that was ordered",
        CommandSpeed "command.speed" "`command_present` shows above this speed; 0 if left out",
        Deviation "limit.deviation" "how far the axis may be from its command before alarm `position_deviation`",
    }
}

impl Threshold {
    /// What it may measure; the row's unit must fit one of them.
    pub fn dimensions(self) -> &'static [Dimension] {
        match self {
            Self::ZeroSpeed
            | Self::TurningSpeed
            | Self::ReachedSpeed
            | Self::ReachedWindow
            | Self::AgreesWindow
            | Self::CommandSpeed => &[Dimension::Speed],
            Self::PositionWindow | Self::CoincidesWindow | Self::NearWindow => {
                &[Dimension::Position]
            }
            Self::Deviation => &[Dimension::Position, Dimension::Increments],
            Self::PositionSettle | Self::InterruptDoneTime => &[Dimension::Time],
        }
    }
}
