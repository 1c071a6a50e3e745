//! What models say about segments, interrupt positioning and commands that are inhibited: what a target is, how long a
//! run lasts, what a chain waits for.

use super::named_terms;

named_terms! {
    /// A condition for the next segment of a chain.
    Condition {
        Delay "delay" "so much time has passed since the axis stands in position",
        HomingStep "step" "input `segment_step` has risen since the segment started",
        Position "position" "the axis has reached that position since the segment started",
    }
}

named_terms! {
    /// What the target of a position segment is.
    Target {
        Relative "relative" "a way to go",
        Absolute "absolute" "a position",
        None "none" "the segment is empty: nothing starts it",
    }
}

named_terms! {
    /// What becomes of what the axis is behind its command when that is inhibited.
    InhibitRule {
        Clears "clears" "it is dropped, as by `clear_deviation`",
        Keeps "keeps" "it is made up for",
    }
}

named_terms! {
    /// What becomes of interrupt positioning.
    InterruptRule {
        Off "off" "`interrupt_start` does nothing",
        Free "free" "each `interrupt_start` counts",
        Locks "locks" "once one has run, none counts until `interrupt_unlock`",
    }
}

named_terms! {
    /// How long a velocity segment lasts.
    Lasts {
        Level "level" "while `segment_run` is active",
        Edge "edge" "from the rising edge of `segment_run` until something stops it",
    }
}
