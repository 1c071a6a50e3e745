//! What a soak test draws: one stream of numbers, and the questions that it is asked.

use crate::rng::Rng;
use crate::time::Duration;

/// One stream of numbers.
#[derive(Debug, Clone)]
pub struct Draws(pub Rng);

impl Draws {
    /// A number from `low` to `high`, both included.
    pub fn between(&mut self, low: u64, high: u64) -> u64 {
        self.0.between(low, high)
    }

    /// A whole number of `low` to `high`, both included.
    pub fn signed(&mut self, low: i64, high: i64) -> i64 {
        low.saturating_add(self.between(0, high.saturating_sub(low).max(0) as u64) as i64)
    }

    /// Did it happen, one time of `n`?
    pub fn one_in(&mut self, n: u64) -> bool {
        self.between(1, n) == 1
    }

    /// One of `from`, if there is any.
    pub fn pick<'a, T>(&mut self, from: &'a [T]) -> Option<&'a T> {
        let last = from.len().checked_sub(1)?;
        from.get(self.between(0, last as u64) as usize)
    }

    /// Any word.
    pub fn word(&mut self) -> u16 {
        self.between(0, 0xFFFF) as u16
    }

    /// Any byte.
    pub fn byte(&mut self) -> u8 {
        self.between(0, 0xFF) as u8
    }

    /// Up to `most` bytes, and one at least.
    pub fn bytes(&mut self, most: u64) -> Vec<u8> {
        let len = self.between(1, most);
        (0..len).map(|_| self.byte()).collect()
    }

    /// A pause: none, within a frame, or up to `most`.
    pub fn pause(&mut self, most: Duration) -> Duration {
        match self.between(0, 3) {
            0 => Duration::ZERO,
            1 => Duration::from_micros(self.between(1, 30_000)),
            _ => Duration::from_micros(self.between(0, most.as_micros() as u64)),
        }
    }
}
