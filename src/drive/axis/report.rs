//! What power stage and motor report, as changes of the drive: positions in its coordinate and speeds in its units.

use super::Axis;
use super::observe::wrapped;
use super::origin::Ratio;
use crate::behaviour::{Effect, Replan};
use crate::drive::context::DriveContext;
use crate::event::{Change, Replanned};

/// The change that `effect` is, about a segment where `segment` says so. What takes another form later is none yet.
pub(in crate::drive) fn change(
    axis: &Axis,
    cx: DriveContext<'_>,
    effect: Effect,
    segment: Option<u16>,
) -> Option<Change> {
    let units = AxisUnits { axis, cx };
    let at = |position: i64| units.at(position);
    let method = axis.method;
    Some(match effect {
        Effect::Ready => Change::Ready,
        Effect::Enabled(on) => Change::Enabled(on),
        Effect::AlarmRaised { cause, code } => Change::Alarm { cause, code },
        Effect::AlarmCleared => Change::AlarmCleared,
        Effect::MoveStarted(to) => match segment {
            None => Change::Moves { to: at(to) },
            Some(number) => Change::PositionSegment { number, to: at(to) },
        },
        Effect::RunStarted(speed) => Change::Runs { mrpm: units.mrpm(speed) },
        Effect::JogStarted(speed) => match segment {
            None => Change::Jogs { mrpm: units.mrpm(speed) },
            Some(number) => Change::VelocitySegment { number, mrpm: units.mrpm(speed) },
        },
        Effect::Replanned(what) => Change::Replans(units.replanned(what)),
        Effect::MovePaused => Change::Pauses,
        Effect::MoveResumed(to) => Change::Resumes { to: at(to) },
        Effect::DeviationCleared(counts) => Change::DeviationCleared { counts },
        Effect::Stopping => Change::Stops,
        Effect::Coasting => Change::Coasts,
        Effect::Stopped(position) => Change::Stands { at: at(position) },
        Effect::LimitReached { forward, soft } => Change::Limit { forward, soft },
        Effect::HardStopHit(position) => Change::Hits { at: at(position) },
        Effect::DeviationExceeded => Change::Deviates,
        Effect::HomingStepStarted(step, speed) => {
            Change::Seeks { method, step, mrpm: units.mrpm(speed) }
        }
        Effect::HomingStepDone(step, position) => Change::Finds { method, step, at: at(position) },
        Effect::HomingLimit { forward, turns, at: position } => {
            Change::FindsLimit { method, forward, turns, at: at(position) }
        }
        Effect::IndexSearchStarted { forward } => Change::Refines { method, forward },
        Effect::IndexFound(position) => Change::Origin { method, at: at(position) },
        // Told once the position register says what it is to say.
        Effect::HomingDone(_) => return None,
        Effect::HomingAborted { why, .. } => Change::HomingLost { method, why },
    })
}

/// The drive's coordinate and units.
#[derive(Clone, Copy)]
struct AxisUnits<'a> {
    axis: &'a Axis,
    cx: DriveContext<'a>,
}

impl AxisUnits<'_> {
    /// A position of the motor as the position register shows it.
    fn at(self, position: i64) -> i64 {
        let registers = self.cx.registers;
        wrapped(registers, self.axis.origin.shown(Ratio::of(registers), position))
    }

    /// Thousandths of a revolution a minute.
    fn mrpm(self, speed: f64) -> i64 {
        (self.axis.settings.rpm(speed) * 1000.0).round() as i64
    }

    fn replanned(self, what: Replan) -> Replanned {
        // What is no number above 0 is at once.
        let slope = |it: f64| (it > 0.0 && it.is_finite()).then(|| self.mrpm(it));
        match what {
            Replan::Target(to) => Replanned::Target { to: self.at(to) },
            Replan::Speed(speed) => Replanned::Speed { mrpm: self.mrpm(speed) },
            Replan::SlowSpeed(speed) => Replanned::SlowSpeed { mrpm: self.mrpm(speed) },
            Replan::StartSpeed(speed) => Replanned::StartSpeed { mrpm: self.mrpm(speed) },
            Replan::Accel(accel) => Replanned::Acceleration { mrpm_per_s: slope(accel) },
            Replan::Decel(decel) => Replanned::Deceleration { mrpm_per_s: slope(decel) },
            Replan::HomeOffset(by) => Replanned::HomeOffset { by },
            Replan::TimeLimit(time) => Replanned::TimeLimit { time },
        }
    }
}
