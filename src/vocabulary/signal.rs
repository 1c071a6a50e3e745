//! Named bits into and out of a drive.

use super::{Named, named_terms};

named_terms! {
    /// A signal into the drive. Active while any of its sources is.
    Input {
        ServoOn "servo_on" "level: power stage on while active and no alarm stands against it",
        AlarmReset "alarm_reset" "rising edge: clear an alarm whose cause is gone, if a reset can clear it",
        AlarmForce "alarm_force" "level: the drive trips with alarm cause `forced`",
        Release "release" "level: power stage off while active, whatever else asks for it",
        EnableInhibit "enable_inhibit" "level: the power stage can't be switched on while active; one that is on stays on",
        Stop "stop" "level: the axis slows down to a standstill and starts nothing while active",
        QuickStop "quick_stop" "level: the axis stops at once, without a ramp, and starts nothing while active",
        JogPos "jog_pos" "level: the axis goes at `jog.speed` while active; with `jog_neg` at the same time it stops",
        JogNeg "jog_neg" "level: the same in the negative direction",
        HomeSwitch "home_switch" "level: the home switch, or another mark that a homing looks for",
        LimitPos "limit_pos" "level: the positive limit; no motion goes on in the positive direction",
        LimitNeg "limit_neg" "level: the negative limit; no motion goes on in the negative direction",
        HomeStart "home_start" "rising edge: start a homing",
        InchPos "inch_pos" "level: the axis goes at `inch.speed` while active, a jog in position control with settings of its own; with `inch_neg` at the same time it stops",
        InchNeg "inch_neg" "level: the same in the negative direction",
        Run "run" "level: the axis goes at `run.speed` while active",
        MoveStart "move_start" "rising edge: go `move.target` counts on, or with `move.absolute` to that position; ignored while the axis moves, but a run by `run_start` goes over into a move from where it is",
        SegmentStart "segment_start" "rising edge: start the position segment that `select_0` to `select_3` select; ignored while the axis moves, but a velocity segment that an edge started goes over into a move from where it is",
        SegmentStep "segment_step" "rising edge: condition `step` of a chain",
        SegmentRun "segment_run" "go at the velocity segment that is selected, while active; where `trigger` is `edge`, at the one selected when this rises, until stopped",
        SegmentReverse "segment_reverse" "level: velocity segments run in the opposite direction",
        Pause "pause" "level: a move slows down to a standstill and goes on to its target when this falls; one that starts meanwhile waits for that",
        ClearDeviation "clear_deviation" "level: what the axis is behind its command is dropped: it stands where it is, a move under way is over, and none starts while active",
        CommandInhibit "command_inhibit" "level: no move starts while active, and the command of one under way stands at once; `axis.inhibit` says what becomes of what the axis is behind it",
        ReverseSpeed "reverse_speed" "level: jogs, runs and velocity segments go in the opposite direction",
        ZeroSpeedClamp "zero_speed_clamp" "level: a jog, run or velocity segment slows down to a standstill and goes on when this falls; no `run_start` while active",
        InterruptStart "interrupt_start" "rising edge: interrupt positioning: go the way of `axis.interrupt` on from where the axis is, in place of any motion but a homing",
        InterruptUnlock "interrupt_unlock" "level: interrupt positioning is not locked while active, and no longer locked then",
        InterruptInhibit "interrupt_inhibit" "level: no interrupt positioning starts while active; one under way goes on",
        ReversePosition "reverse_position" "level: a move that starts while active goes the opposite way, or to the position of the opposite sign",
        Select0 "select_0" "bit 0 of the selection: the number of a segment, counted from the first",
        Select1 "select_1" "bit 1 of the selection",
        Select2 "select_2" "bit 2 of the selection",
        Select3 "select_3" "bit 3 of the selection",
    }
}

named_terms! {
    /// A signal out of the drive.
    Output {
        Powered "powered" "the drive has supply; as long as it can answer at all, it has",
        Ready "ready" "initialised and no alarm: an enable would be accepted",
        Enabled "enabled" "power stage on",
        Alarm "alarm" "an alarm stands",
        BrakeOpen "brake_open" "the holding brake is released; follows `enabled`",
        Moving "moving" "a motion is under way, or its end still to be made up for: off once the axis stands where its command ended",
        InPosition "in_position" "the last move has ended, and the axis is where it was to end; off from the start of any motion",
        ZeroSpeed "zero_speed" "the speed is 0, or not above `zero.speed`",
        HomeDone "home_done" "the origin was found; off at power-on and from the start of a homing",
        AtLimitPos "limit_pos" "signal `limit_pos` is active",
        AtLimitNeg "limit_neg" "signal `limit_neg` is active",
        BeyondPos "beyond_soft_pos" "the position is more than `limit.soft_pos`, and soft limits are in force",
        BeyondNeg "beyond_soft_neg" "the position is less than `limit.soft_neg`, and soft limits are in force",
        Selected0 "selected_0" "bit 0 of the selection: signal `select_0` is active",
        Selected1 "selected_1" "bit 1 of the selection",
        Selected2 "selected_2" "bit 2 of the selection",
        Selected3 "selected_3" "bit 3 of the selection",
        Segment0 "segment_0" "bit 0 of `segment.running`",
        Segment1 "segment_1" "bit 1 of `segment.running`",
        Segment2 "segment_2" "bit 2 of `segment.running`",
        Segment3 "segment_3" "bit 3 of `segment.running`",
        Segment4 "segment_4" "bit 4 of `segment.running`",
        Turning "turning" "the speed is above `turning.speed`, in either direction",
        SpeedReached "speed_reached" "the speed, in either direction, is within `reached.window` of `reached.speed`",
        SpeedAgrees "speed_agrees" "in speed control: the speed is less than `agrees.window` from the one that was ordered, 0 once the axis is to stop",
        Coincides "coincides" "in position control: the axis is within `coincides.window` of its command, in motion too",
        Near "near" "in position control: the axis is within `near.window` of its command, in motion too",
        InterruptActive "interrupt_active" "an interrupt positioning is under way, until the axis is in position",
        InterruptDone "interrupt_done" "the axis is in position after an interrupt positioning; for `interrupt.done_time`",
        Settled "settled" "in position control: the command is at rest, and the axis within `position.window` of it for `position.settle`; before the first motion too",
        Arrived "arrived" "in speed control `speed_agrees`, in position control `settled`",
        CommandPresent "command_present" "in position control the command is on its way, in speed control the speed that was ordered is above `command.speed`",
        TorqueLimited "torque_limited" "the axis is held back from its command: all the torque there is does not move it",
        EncoderA "encoder_a" "track A of the encoder, one cycle of A and B in four counts",
        EncoderB "encoder_b" "track B of the encoder, a quarter of a cycle behind A in the positive direction",
        EncoderZ "encoder_z" "the encoder is on the zero mark of its revolution",
        User0 "user_0" "bit 0 of the row that `signals.outputs.user` names",
        User1 "user_1" "bit 1 of the same row",
        User2 "user_2" "bit 2 of the same row",
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
