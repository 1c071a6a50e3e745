//! When a value of a setting counts.

use super::named_terms;

named_terms! {
    /// When a value that somebody writes to the row of a setting counts.
    Taken {
        Live "live" "immediately: a motion in progress that uses it is planned again from the current position and speed",
        AtOrder "at_order" "with the next command, including one given during motion; a stop, and a level signal that changes, count as commands",
        AtStart "at_start" "at the next start from standstill",
    }
}
