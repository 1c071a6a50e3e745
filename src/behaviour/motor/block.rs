//! An axis that something blocks where it is, and that comes free again.
//!
//! Blocked it stands between two hard stops at one count, so everything that hard stops lead to follows: it is behind
//! its command, and a homing takes it for the end of the way.

use super::goal::Goal;
use super::{Motor, Phase};
use crate::time::{Duration, Instant};

impl Motor {
    /// The same axis when power comes on, standing where it is.
    #[must_use]
    pub fn switched_on(&self, now: Instant, coast: Duration, gain: Option<f64>) -> Self {
        let position = self.feedback(now).position;
        let blocked = self.blocked;
        Self { blocked, ..Self::standing(now, position, coast, self.machine, gain) }
    }

    /// Does something block it?
    pub fn is_blocked(&self) -> bool {
        self.blocked.is_some()
    }

    /// Blocks it at the count where it is.
    pub fn block(&mut self, now: Instant) {
        let at = self.position(now);
        let own = self.machine.hard_stop.replace([at, at]);
        self.blocked.get_or_insert(own);
        self.look_ahead(now);
        self.home_look(now);
    }

    /// Lets it go. Where its position is controlled it makes up for what it is behind; a run or a jog begins anew;
    /// anything else goes on from here, and what it did not go meanwhile is lost.
    pub fn free(&mut self, now: Instant) {
        let Some(own) = self.blocked.take() else { return };
        let (here, told) = (self.feedback(now), self.trajectory.state(now).position);
        self.machine.hard_stop = own;
        let behind = told - here.position;
        self.trajectory = match self.phase {
            Phase::Running | Phase::Jogging { .. } => match self.goal {
                Goal::Speed(ramp) => ramp.keep(now, here),
                _ => self.trajectory.left(now, -behind),
            },
            _ if self.wants.power && self.lag.makes_up() => {
                self.lag = self.lag.with_deviation(behind);
                self.trajectory.left(now, 0.0)
            }
            _ => self.trajectory.left(now, -behind),
        };
        self.look_ahead(now);
    }
}
