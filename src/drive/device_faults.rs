//! What is wrong with a device, apart from its line, its contacts and its axis: causes of alarms that are there, and feedback
//! that is gone. They come and go by command and outlast the power.

use crate::event::DeviceFault;
use crate::vocabulary::{AlarmCause, AlarmCauses, Input, Inputs};

/// What is wrong with it right now.
#[derive(Debug, Default)]
pub(super) struct DeviceFaults {
    causes: AlarmCauses,
    encoder_lost: bool,
    frozen: bool,
    /// What was seen of the axis last, while nothing new is.
    pub(super) seen: Option<FrozenFeedback>,
}

/// Position in counts of the motor, and speed in counts per second.
#[derive(Debug, Clone, Copy)]
pub(super) struct FrozenFeedback {
    pub(super) position: i64,
    pub(super) speed: f64,
}

impl DeviceFaults {
    /// Is it one of these, and there?
    pub(super) fn has(&self, fault: DeviceFault) -> bool {
        match fault {
            DeviceFault::Cause(cause) => self.causes.has(cause),
            DeviceFault::EncoderLost => self.encoder_lost,
            DeviceFault::Frozen => self.frozen,
            DeviceFault::Blocked | DeviceFault::Stuck(_) => false,
        }
    }

    /// It comes or goes, if it is one of these. Returns the cause of an alarm that comes with it.
    pub(super) fn set(&mut self, fault: DeviceFault, on: bool) -> Option<AlarmCause> {
        let cause = match fault {
            DeviceFault::Cause(cause) => {
                self.causes = self.causes.with(cause, on);
                Some(cause)
            }
            DeviceFault::EncoderLost => {
                self.encoder_lost = on;
                Some(AlarmCause::Encoder)
            }
            DeviceFault::Frozen => {
                self.frozen = on;
                None
            }
            DeviceFault::Blocked | DeviceFault::Stuck(_) => None,
        };
        cause.filter(|_| on)
    }

    /// Keeps what is `seen` of the axis, as long as nothing new is.
    pub(super) fn freeze(&mut self, seen: FrozenFeedback) {
        self.seen = (self.encoder_lost || self.frozen).then_some(seen);
    }

    /// Causes that are there while `inputs` are active: no reset clears their alarms.
    pub(super) fn active_causes(&self, inputs: Inputs) -> AlarmCauses {
        let forced = inputs.has(Input::AlarmForce);
        self.causes
            .with(AlarmCause::Forced, forced || self.causes.has(AlarmCause::Forced))
            .with(AlarmCause::Encoder, self.encoder_lost || self.causes.has(AlarmCause::Encoder))
    }
}
