//! Where axes are: never beyond a hard stop, and never farther than their drives can have moved them meanwhile.

use crate::drive::View;
use crate::model::{Counts, Model};
use crate::motion::State;
use crate::time::Duration;
use crate::units::Dimension;

/// What was seen of one axis.
#[derive(Debug, Clone, Copy)]
pub struct SoakAxis {
    state: State,
    counts_per_rev: f64,
}

impl SoakAxis {
    /// The axis of `drive`.
    pub fn of(drive: View<'_>) -> Self {
        let counts_per_rev = match drive.model().wiring.axis.counts_per_rev {
            Counts::Fixed(counts) => counts.into(),
            Counts::Row(row) => drive.bank().value(drive.model(), row) as f64,
        };
        Self { state: drive.axis_state(), counts_per_rev }
    }

    /// Remembers the finest resolution that the drive has been set to: a motion keeps the one it began with.
    pub fn keep_finest(&mut self, before: &Self) {
        self.counts_per_rev = self.counts_per_rev.max(before.counts_per_rev);
    }

    /// Can `drive` have moved it there from `before`, in `time`?
    pub fn came_from(&self, before: &Self, time: Duration, drive: View<'_>) -> Result<(), String> {
        let (from, to) = (before.state.position, self.state.position);
        let top = top_rpm(drive.model()) / 60.0 * self.counts_per_rev.max(before.counts_per_rev);
        let most = top * time.as_secs_f64() * 1.001 + 1.0;
        if (to - from).abs() > most {
            return Err(format!("from {from} to {to} in {time:?}, which is {most} at most"));
        }
        let stops =
            drive.machine().hard_stop.filter(|[low, high]| to < *low as f64 || to > *high as f64);
        match stops {
            Some([low, high]) => Err(format!("at {to}, beyond the hard stops {low} and {high}")),
            None => Ok(()),
        }
    }
}

/// The fastest that any row of `model` can ask for.
fn top_rpm(model: &Model) -> f64 {
    let speeds = model.map.rows().filter(|(_, row)| row.unit.dimension == Dimension::Speed);
    let ends = speeds.flat_map(|(_, row)| {
        let limits = [row.kind.limits()];
        let spans = if row.spans.is_empty() { &limits[..] } else { &row.spans };
        let ends = spans.iter().flat_map(|(low, high)| [*low, *high]).map(|it| it as f64);
        ends.map(|it| (it * row.unit.scale).abs()).collect::<Vec<_>>()
    });
    ends.fold(0.0, f64::max)
}
