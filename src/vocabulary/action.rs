//! What a write to a command row sets off.

use super::named_terms;

named_terms! {
    /// Something a drive does at once when told to. Of several at once the one that stands first acts.
    Action {
        QuickStop "quick_stop" "stop immediately, without a ramp",
        Stop "stop" "decelerate to standstill with the deceleration of the current motion",
        HomeStart "home_start" "start homing; ignored while the axis moves",
        MoveStart "move_start" "move by `move.target` counts, or with `absolute` to that position; ignored while the axis moves unless `interrupt` is set, which also aborts a homing",
        RunStart "run_start" "run at `run.speed` until stopped; the sign gives the direction; a run in progress takes the new speed, a move only with `interrupt`; ignored during any other motion",
        Enable "enable" "switch on the power stage",
        Release "release" "switch off the power stage; it stays off until it is enabled again",
        AlarmReset "alarm_reset" "clear an alarm that is resettable and whose cause is no longer present",
        EncoderReset "encoder_reset" "clear alarm `encoder`, even where it is not resettable; other alarms are not affected",
        ClearAlarmHistory "clear_alarm_history" "clear the alarms in `alarm_history`",
        ClearPosition "clear_position" "set the current position to 0",
        ClearTurns "clear_turns" "set the multi-turn count of the encoder to 0",
        StoreAll "store_all" "store all current values in non-volatile memory; ignored while the axis moves",
        RestoreFactory "restore_factory" "restore the factory values of all parameters; ignored while the axis moves",
        PowerCycle "power_cycle" "restart the drive, as after a power cycle",
    }
}

named_terms! {
    /// What a bit beside those that trigger says about the action.
    Modifier {
        Absolute "absolute" "`move.target` is an absolute position, not a distance",
        Interrupt "interrupt" "a move replaces the motion in progress, or a run replaces a move",
    }
}

impl Action {
    /// Does it say where to go from here, so that twice is not the same as once? The others say how things
    /// are to be in the end.
    pub fn adds_up(self, modifiers: Modifiers) -> bool {
        match self {
            Self::MoveStart => !modifiers.has(Modifier::Absolute),
            Self::QuickStop
            | Self::Stop
            | Self::Enable
            | Self::Release
            | Self::ClearAlarmHistory => false,
            Self::HomeStart
            | Self::RunStart
            | Self::AlarmReset
            | Self::EncoderReset
            | Self::ClearPosition
            | Self::ClearTurns
            | Self::StoreAll
            | Self::RestoreFactory
            | Self::PowerCycle => true,
        }
    }
}

/// The modifiers that came with an action.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Modifiers(u8);

impl Modifiers {
    /// Is `modifier` set?
    pub fn has(self, modifier: Modifier) -> bool {
        self.0 & (1 << modifier as u8) != 0
    }

    /// Sets `modifier`.
    pub fn insert(&mut self, modifier: Modifier) {
        self.0 |= 1 << modifier as u8;
    }
}
