//! Numbers that outputs and an alarm go by: a model says which row holds them, or fixes them.

use super::named_terms;
use crate::units::Dimension;

named_terms! {
    /// A number that something of the axis is held against at any time.
    Threshold {
        ZeroSpeed "zero.speed" "`zero_speed` is on up to this speed; default 0",
        TurningSpeed "turning.speed" "`turning` is on above this speed",
        ReachedSpeed "reached.speed" "the target speed of `speed_reached`",
        ReachedWindow "reached.window" "tolerance of `speed_reached` around `reached.speed`",
        PositionWindow "position.window" "in-position window: maximum distance from the target for `in_position` and `settled`; default 0",
        PositionSettle "position.settle" "minimum time within `position.window`; default 0",
        InterruptDoneTime "interrupt.done_time" "how long `interrupt_done` stays on",
        CoincidesWindow "coincides.window" "maximum following error for `coincides`",
        NearWindow "near.window" "maximum following error for `near`",
        AgreesWindow "agrees.window" "tolerance of `speed_agrees` around the commanded speed",
        CommandSpeed "command.speed" "`command_present` is on above this speed; default 0",
        Deviation "limit.deviation" "maximum following error before alarm `position_deviation`",
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
