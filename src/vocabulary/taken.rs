//! When a value of a setting counts.

use super::named_terms;

named_terms! {
    /// When a value that somebody writes to the row of a setting counts.
    Taken {
        Live "live" "at once: a motion under way that goes by it is planned anew, from where the axis is and as fast as it goes",
        AtOrder "at_order" "with the next order, also one that is given in motion; a stop, and a level that comes or goes, are orders too",
        AtStart "at_start" "when a motion next starts from standstill",
    }
}
