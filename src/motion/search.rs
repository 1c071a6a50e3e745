//! Finding the nanosecond at which a test starts to hold.
//!
//! A formula gives the moment as a real number; but what counts is what the state says at whole
//! nanoseconds. So the formula is only the guess, and the answer is the instant at which the test
//! holds while it does not yet hold one nanosecond before.

use crate::time::Instant;
use std::cmp::Ordering;

/// The first instant after `after` at which something comes to be equal, be it for a nanosecond. Between two
/// neighbouring `marks`, which ascend, it goes one way only.
pub fn first_equal(
    after: Instant,
    marks: &[Instant],
    side: impl Fn(Instant) -> Ordering,
) -> Option<Instant> {
    let (mut from, mut was) = (after, side(after));
    for &mark in marks {
        let is = side(mark);
        if is != was && was != Ordering::Equal {
            let gone = |ns| side(Instant::from_nanos(ns)) != was;
            let ns = change(from.as_nanos(), mark.as_nanos(), from.as_nanos(), gone);
            let at = Instant::from_nanos(ns);
            if side(at) == Ordering::Equal {
                return Some(at);
            }
        }
        (from, was) = (mark, is);
    }
    None
}

/// The first instant after `after` at which `holds` begins to hold.
///
/// Between two neighbouring `marks` (ascending, each with what `guess` needs for the stretch before it)
/// it changes at most once. Marks that are over already do no harm.
pub(super) fn first<S>(
    after: Instant,
    marks: impl Iterator<Item = (Instant, S)>,
    holds: impl Fn(Instant) -> bool,
    guess: impl Fn(S) -> Instant,
) -> Option<Instant> {
    let mut from = after;
    let mut held = holds(from);
    for (mark, stretch) in marks {
        if mark <= from {
            continue;
        }
        let hold = holds(mark);
        if hold && !held {
            let at = |ns| holds(Instant::from_nanos(ns));
            let guess = guess(stretch).as_nanos();
            let ns = change(from.as_nanos(), mark.as_nanos(), guess, at);
            return Some(Instant::from_nanos(ns));
        }
        (from, held) = (mark, hold);
    }
    None
}

/// The least number in `(low, high]` for which `holds`, which it does not for `low` and does for `high`.
fn change(mut low: u64, mut high: u64, guess: u64, holds: impl Fn(u64) -> bool) -> u64 {
    // Steps that double, away from a good guess, bracket the answer in two or three tests.
    let guess = guess.clamp(low + 1, high);
    let mut step = 1;
    if holds(guess) {
        high = guess;
        while high - low > step {
            if !holds(high - step) {
                low = high - step;
                break;
            }
            high -= step;
            step *= 2;
        }
    } else {
        low = guess;
        while high - low > step {
            if holds(low + step) {
                high = low + step;
                break;
            }
            low += step;
            step *= 2;
        }
    }
    while high - low > 1 {
        let middle = low + (high - low) / 2;
        if holds(middle) {
            high = middle;
        } else {
            low = middle;
        }
    }
    high
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn any_guess_will_do(low in 0u64..1000, len in 1u64..1000, part in 0.0..1.0, guess: u64) {
            let answer = low + 1 + (len as f64 * part) as u64;
            prop_assert_eq!(change(low, low + len, guess % 3000, |it| it >= answer), answer);
        }
    }
}
