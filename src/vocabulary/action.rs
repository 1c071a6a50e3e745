//! What a write to a command row sets off.

use super::named_terms;

named_terms! {
    /// Something a drive does at once when told to. Of several at once the one that stands first acts.
    Action {
        QuickStop "quick_stop" "stop at once, without a ramp",
        Stop "stop" "slow down to a standstill, with the deceleration of the motion",
        HomeStart "home_start" "start a homing; ignored while the axis moves",
        MoveStart "move_start" "go `move.target` counts on, or with `absolute` to that position; ignored while the axis moves, unless `interrupt` is set; that breaks off a homing too",
        RunStart "run_start" "go at `run.speed` until stopped; its sign is the direction; a run under way takes the new speed, a move only with `interrupt`; ignored in any other motion",
        Enable "enable" "switch the power stage on",
        Release "release" "switch the power stage off; it stays off until told otherwise",
        AlarmReset "alarm_reset" "clear an alarm whose cause is gone, if a reset can clear it",
        EncoderReset "encoder_reset" "clear alarm `encoder`, also where no other reset can; any other alarm stays",
        ClearAlarmHistory "clear_alarm_history" "forget the alarms that `alarm_history` shows",
        ClearPosition "clear_position" "call the present position 0",
        ClearTurns "clear_turns" "count the revolutions of the encoder from 0, beginning with the present one",
        StoreAll "store_all" "keep all values in force over power-off; ignored while the axis moves",
        RestoreFactory "restore_factory" "put every value back as it left the factory; ignored while the axis moves",
        PowerCycle "power_cycle" "start anew, as if power had been off and on",
    }
}

named_terms! {
    /// What a bit beside those that trigger says about the action.
    Modifier {
        Absolute "absolute" "`move.target` is a position, not a way",
        Interrupt "interrupt" "a move takes the place of a motion under way, or a run that of a move",
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
