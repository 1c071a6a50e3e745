//! What power stage and motor report, as changes of the drive: positions in its coordinate and speeds in its units.

use super::Axis;
use super::observe::wrapped;
use super::origin::Ratio;
use crate::behaviour::{Effect, Replan};
use crate::drive::context::DriveContext;
use crate::event::{DriveEvent, MilliRpm, Replanned};

/// The change that `effect` is, about a segment where `segment` says so. What takes another form later is none yet.
pub(in crate::drive) fn change(
    axis: &Axis,
    cx: DriveContext<'_>,
    effect: Effect,
    segment: Option<u16>,
) -> Option<DriveEvent> {
    let units = AxisUnits { axis, cx };
    let at = |position: i64| units.at(position);
    let method = axis.method;
    Some(match effect {
        Effect::Ready => DriveEvent::Ready,
        Effect::Enabled(on) => DriveEvent::Servo { on },
        Effect::AlarmRaised { cause, code } => DriveEvent::Alarm { cause, code },
        Effect::AlarmCleared => DriveEvent::AlarmCleared,
        Effect::MoveStarted(to) => match segment {
            None => DriveEvent::Moving { to: at(to) },
            Some(number) => DriveEvent::PositionSegment { number, to: at(to) },
        },
        Effect::RunStarted(speed) => DriveEvent::Running { rpm: units.mrpm(speed) },
        Effect::JogStarted(speed) => match segment {
            None => DriveEvent::Jogging { rpm: units.mrpm(speed) },
            Some(number) => DriveEvent::VelocitySegment { number, rpm: units.mrpm(speed) },
        },
        Effect::Replanned(what) => DriveEvent::Replanned(units.replanned(what)),
        Effect::MovePaused => DriveEvent::Pausing,
        Effect::MoveResumed(to) => DriveEvent::Resumed { to: at(to) },
        Effect::DeviationCleared(counts) => DriveEvent::DeviationCleared { counts },
        Effect::Stopping => DriveEvent::Stopping,
        Effect::Coasting => DriveEvent::Coasting,
        Effect::Stopped(position) => DriveEvent::Stopped { at: at(position) },
        Effect::LimitReached { forward, soft } => DriveEvent::Limit { forward, soft },
        Effect::HardStopHit(position) => DriveEvent::HardStop { at: at(position) },
        Effect::DeviationExceeded => DriveEvent::PositionDeviation,
        Effect::HomingStepStarted(step, speed) => {
            DriveEvent::HomingMoving { method, step, rpm: units.mrpm(speed) }
        }
        Effect::HomingStepDone(step, position) => {
            DriveEvent::HomingFound { method, step, at: at(position) }
        }
        Effect::HomingLimit { forward, turns, at: position } => {
            DriveEvent::HomingLimit { method, forward, turns, at: at(position) }
        }
        Effect::IndexSearchStarted { forward } => DriveEvent::HomingIndex { method, forward },
        Effect::IndexFound(position) => DriveEvent::HomingOrigin { method, at: at(position) },
        // Told once the position register says what it is to say.
        Effect::HomingDone(_) => return None,
        Effect::HomingAborted { why, .. } => DriveEvent::HomingAborted { method, why },
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
    fn mrpm(self, speed: f64) -> MilliRpm {
        MilliRpm((self.axis.settings.rpm(speed) * 1000.0).round() as i64)
    }

    fn replanned(self, what: Replan) -> Replanned {
        // What is no number above 0 is at once.
        let slope = |it: f64| (it > 0.0 && it.is_finite()).then(|| self.mrpm(it));
        match what {
            Replan::Target(to) => Replanned::Target { to: self.at(to) },
            Replan::Speed(speed) => Replanned::Speed { rpm: self.mrpm(speed) },
            Replan::SlowSpeed(speed) => Replanned::SlowSpeed { rpm: self.mrpm(speed) },
            Replan::StartSpeed(speed) => Replanned::StartSpeed { rpm: self.mrpm(speed) },
            Replan::Accel(accel) => Replanned::Acceleration { rpm_per_s: slope(accel) },
            Replan::Decel(decel) => Replanned::Deceleration { rpm_per_s: slope(decel) },
            Replan::HomeOffset(by) => Replanned::HomeOffset { by },
            Replan::TimeLimit(time) => Replanned::TimeLimit { time },
        }
    }
}
