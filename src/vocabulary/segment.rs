//! What models say about segments, interrupt positioning and commands that are inhibited: what a target is, how long a
//! run lasts, what a chain waits for.

use super::named_terms;

named_terms! {
    /// A condition for the next segment of a chain.
    Condition {
        Delay "delay" "the given time has passed since the axis came to be in position",
        Step "step" "a rising edge of input `segment_step` since the segment started",
        Position "position" "the axis has reached the given position since the segment started",
    }
}

named_terms! {
    /// What the target of a position segment is.
    Target {
        Relative "relative" "a distance",
        Absolute "absolute" "an absolute position",
        None "none" "the segment is empty and cannot be started",
    }
}

named_terms! {
    /// What becomes of what the axis is behind its command when that is inhibited.
    InhibitRule {
        Clears "clears" "it is cleared, as by `clear_deviation`",
        Keeps "keeps" "it is kept, and made up afterwards",
    }
}

named_terms! {
    /// What becomes of interrupt positioning.
    InterruptRule {
        Off "off" "`interrupt_start` has no effect",
        Free "free" "each `interrupt_start` is accepted",
        Locks "locks" "after one has run, further ones are locked until `interrupt_unlock`",
    }
}

named_terms! {
    /// How long a velocity segment lasts.
    Lasts {
        Level "level" "while `segment_run` is active",
        Edge "edge" "from the rising edge of `segment_run` until it is stopped",
    }
}
