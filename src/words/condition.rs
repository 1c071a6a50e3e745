//! What a chain of segments waits for before it goes on. The model says which code stands for which.

use super::words;

words! {
    /// A condition for the next segment of a chain.
    Condition {
        Delay "delay" "so much time has passed since the axis stands in position",
        Step "step" "input `segment_step` has risen since the segment started",
        Position "position" "the axis has reached that position since the segment started",
    }
}
