//! What outputs want to know of an axis beyond position and speed.

use super::{Motor, Phase};

impl Motor {
    /// The speed that a run or a jog was ordered to have, in counts per second; `None` in any other phase.
    pub fn speed_ordered(&self) -> Option<f64> {
        let by_speed = matches!(self.phase, Phase::Running | Phase::Jogging { .. });
        by_speed.then(|| self.trajectory.last_speed())
    }
}
