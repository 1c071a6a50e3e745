//! What settings that are written on the way do to a motion.

use crate::time::Duration;

/// What has become different about a motion under way.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Replanned {
    /// Where a move ends.
    Target {
        /// In counts of the drive.
        to: i64,
    },
    /// The speed; of a homing the fast one.
    Speed {
        /// In thousandths of a revolution a minute; the sign is the direction.
        mrpm: i64,
    },
    /// The slow speed of a homing.
    SlowSpeed {
        /// In thousandths of a revolution a minute.
        mrpm: i64,
    },
    /// The speed that is taken at once.
    StartSpeed {
        /// In thousandths of a revolution a minute.
        mrpm: i64,
    },
    /// How it gets faster.
    Acceleration {
        /// In thousandths of a revolution a minute, a second; `None` is at once.
        mrpm_per_s: Option<i64>,
    },
    /// How it gets slower.
    Deceleration {
        /// In thousandths of a revolution a minute, a second; `None` is at once.
        mrpm_per_s: Option<i64>,
    },
    /// How far a homing goes on from the origin.
    HomeOffset {
        /// In counts of the drive.
        by: i64,
    },
    /// How long a homing may take.
    TimeLimit {
        /// Since it began; `None` is for ever.
        time: Option<Duration>,
    },
}
