//! Named bits into and out of a drive.

use super::{Named, named_terms};

named_terms! {
    /// A signal into the drive. Active while any of its sources is.
    Input {
        ServoOn "servo_on" "level: the power stage is on while active, unless an alarm prevents it",
        AlarmReset "alarm_reset" "rising edge: clear an alarm that is resettable and whose cause is no longer present",
        AlarmForce "alarm_force" "level: the drive trips with alarm cause `forced`",
        Release "release" "level: the power stage is off while active, with priority over all enables",
        EnableInhibit "enable_inhibit" "level: the power stage cannot be switched on while active; if it is on, it stays on",
        Stop "stop" "level: the axis decelerates to standstill, and no motion starts while active",
        QuickStop "quick_stop" "level: the axis stops immediately, without a ramp, and no motion starts while active",
        JogPos "jog_pos" "level: the axis jogs at `jog.speed` while active; together with `jog_neg` it stops",
        JogNeg "jog_neg" "level: the same in the negative direction",
        HomeSwitch "home_switch" "level: the home switch, or another reference mark for homing",
        LimitPos "limit_pos" "level: the positive limit switch; motion in the positive direction is blocked",
        LimitNeg "limit_neg" "level: the negative limit switch; motion in the negative direction is blocked",
        HomeStart "home_start" "rising edge: start homing",
        InchPos "inch_pos" "level: the axis moves at `inch.speed` while active: a jog in position control with its own settings; together with `inch_neg` it stops",
        InchNeg "inch_neg" "level: the same in the negative direction",
        Run "run" "level: the axis runs at `run.speed` while active",
        MoveStart "move_start" "rising edge: move by `move.target` counts, or with `move.absolute` to that position; ignored while the axis moves, except that a run by `run_start` changes into a move from its current position",
        SegmentStart "segment_start" "rising edge: start the position segment selected by `select_0` to `select_3`; ignored while the axis moves, except that a velocity segment started by an edge changes into a move from its current position",
        SegmentStep "segment_step" "rising edge: meets condition `step` of a chain",
        SegmentRun "segment_run" "run the selected velocity segment while active; with `trigger: edge`, run the one selected at the rising edge until stopped",
        SegmentReverse "segment_reverse" "level: velocity segments run in the opposite direction",
        Pause "pause" "level: a move decelerates to standstill, and resumes towards its target when this falls; a move started meanwhile waits for that",
        ClearDeviation "clear_deviation" "level: clears the following error: the axis stops where it is, a move in progress ends, and no move starts while active",
        CommandInhibit "command_inhibit" "level: no move starts while active, and the command of a move in progress stops immediately; `axis.inhibit` decides about the remaining following error",
        ReverseSpeed "reverse_speed" "level: jogs, runs and velocity segments run in the opposite direction",
        ZeroSpeedClamp "zero_speed_clamp" "level: a jog, run or velocity segment decelerates to standstill and resumes when this falls; `run_start` is ignored while active",
        InterruptStart "interrupt_start" "rising edge: start interrupt positioning: move by the distance of `axis.interrupt` from the current position, in place of any motion except homing",
        InterruptUnlock "interrupt_unlock" "level: unlocks interrupt positioning, and keeps it unlocked while active",
        InterruptInhibit "interrupt_inhibit" "level: no interrupt positioning starts while active; one in progress continues",
        ReversePosition "reverse_position" "level: a move started while active goes in the opposite direction, or to the position with the sign inverted",
        Select0 "select_0" "bit 0 of the segment selection: the number of a segment, counted from the first",
        Select1 "select_1" "bit 1 of the segment selection",
        Select2 "select_2" "bit 2 of the segment selection",
        Select3 "select_3" "bit 3 of the segment selection",
    }
}

named_terms! {
    /// A signal out of the drive.
    Output {
        Powered "powered" "the drive has power; always on while the drive can reply",
        Ready "ready" "initialised and no alarm: ready to be enabled",
        Enabled "enabled" "the power stage is on",
        Alarm "alarm" "an alarm is active",
        BrakeOpen "brake_open" "the holding brake is released; follows `enabled`",
        Moving "moving" "a motion is in progress; off once the axis is at rest at the end of its command",
        InPosition "in_position" "the last move has ended and the axis is within `position.window` of its target; off from the start of any motion",
        ZeroSpeed "zero_speed" "the speed is 0, or not above `zero.speed`",
        HomeDone "home_done" "homing is complete; off at power-on and from the start of a homing",
        AtLimitPos "limit_pos" "signal `limit_pos` is active",
        AtLimitNeg "limit_neg" "signal `limit_neg` is active",
        BeyondPos "beyond_soft_pos" "the position is above `limit.soft_pos`, and soft limits are in force",
        BeyondNeg "beyond_soft_neg" "the position is below `limit.soft_neg`, and soft limits are in force",
        Selected0 "selected_0" "bit 0 of the segment selection: signal `select_0` is active",
        Selected1 "selected_1" "bit 1 of the segment selection",
        Selected2 "selected_2" "bit 2 of the segment selection",
        Selected3 "selected_3" "bit 3 of the segment selection",
        Segment0 "segment_0" "bit 0 of `segment.running`",
        Segment1 "segment_1" "bit 1 of `segment.running`",
        Segment2 "segment_2" "bit 2 of `segment.running`",
        Segment3 "segment_3" "bit 3 of `segment.running`",
        Segment4 "segment_4" "bit 4 of `segment.running`",
        Turning "turning" "the speed is above `turning.speed`, in either direction",
        SpeedReached "speed_reached" "the speed, in either direction, is within `reached.window` of `reached.speed`",
        SpeedAgrees "speed_agrees" "in speed control: the speed is within `agrees.window` of the commanded speed, which is 0 after a stop",
        Coincides "coincides" "in position control: the axis is within `coincides.window` of its command, also during motion",
        Near "near" "in position control: the axis is within `near.window` of its command, also during motion",
        InterruptActive "interrupt_active" "interrupt positioning is in progress, until the axis is in position",
        InterruptDone "interrupt_done" "the axis is in position after interrupt positioning; on for `interrupt.done_time`",
        Settled "settled" "in position control: the command is at rest and the axis has been within `position.window` of it for `position.settle`; also before the first motion",
        Arrived "arrived" "in speed control: `speed_agrees`; in position control: `settled`",
        CommandPresent "command_present" "in position control: the command is moving; in speed control: the commanded speed is above `command.speed`",
        TorqueLimited "torque_limited" "the torque limit is reached: the axis is blocked and does not follow its command",
        EncoderA "encoder_a" "encoder track A; one cycle of A and B is four counts",
        EncoderB "encoder_b" "encoder track B, a quarter of a cycle behind A in the positive direction",
        EncoderZ "encoder_z" "the encoder is at its zero mark",
        User0 "user_0" "bit 0 of the row named by `signals.outputs.user`",
        User1 "user_1" "bit 1 of that row",
        User2 "user_2" "bit 2 of that row",
    }
}

/// A set of input signals.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Inputs(u64);

impl Inputs {
    /// Is `signal` active?
    pub fn has(self, signal: Input) -> bool {
        self.0 & (1 << signal as u8) != 0
    }

    /// Makes `signal` active.
    pub fn insert(&mut self, signal: Input) {
        self.0 |= 1 << signal as u8;
    }

    /// The signals that are active, in the order of the catalogue.
    pub fn iter(self) -> impl Iterator<Item = Input> {
        Input::ALL.iter().copied().filter(move |signal| self.has(*signal))
    }

    /// Signals active here and not in `before`.
    #[must_use]
    pub fn risen_since(self, before: Self) -> Self {
        Self(self.0 & !before.0)
    }
}

/// A set of output signals.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Outputs(u64);

impl Outputs {
    /// Is `signal` active?
    pub fn has(self, signal: Output) -> bool {
        self.0 & (1 << signal as u8) != 0
    }

    /// Makes `signal` active if `active`.
    #[must_use]
    pub fn with(self, signal: Output, active: bool) -> Self {
        Self(self.0 | u64::from(active) << signal as u8)
    }
}
