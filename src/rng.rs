//! Random numbers that depend on a seed, a name and a count, and on nothing else.
//!
//! A [`Fork`] is a family of streams of ChaCha8, whose output is the same on every machine and in every
//! version. Its key is, in 32 bytes: the seed (little endian), the FNV-1a hash of 64 bits of each of two
//! names, and zeros. Stream `n` of it is for the `n`th draw, so that a draw more or less at
//! one time moves nothing at the next.
//!
//! Numbers are made from the stream here, not by a library whose ways may change.

use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::{Rng as _, SeedableRng};

/// All streams of one name.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Fork {
    key: [u8; 32],
}

/// One stream of random numbers.
#[derive(Debug, Clone)]
pub struct Rng(ChaCha8Rng);

/// How likely something is, in steps of 2^-53.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Chance(u64);

/// 2^53: what a [`Chance`] is held against.
const CERTAIN: f64 = (1u64 << 53) as f64;

impl Fork {
    /// The streams for `part` of `whole`, in a run with `seed`.
    pub fn new(seed: u64, whole: &str, part: &str) -> Self {
        let mut key = [0; 32];
        key[..8].copy_from_slice(&seed.to_le_bytes());
        key[8..16].copy_from_slice(&fnv1a(whole).to_le_bytes());
        key[16..24].copy_from_slice(&fnv1a(part).to_le_bytes());
        Self { key }
    }

    /// Stream number `n`, from its beginning.
    pub fn stream(&self, n: u64) -> Rng {
        let mut rng = ChaCha8Rng::from_seed(self.key);
        rng.set_stream(n);
        Rng(rng)
    }
}

impl Rng {
    /// A number from `low` to `high`, both included; `low` if they are the wrong way round.
    pub fn between(&mut self, low: u64, high: u64) -> u64 {
        let count = u128::from(high.saturating_sub(low)) + 1;
        low + ((u128::from(self.0.next_u64()) * count) >> 64) as u64
    }

    /// Did it happen?
    pub fn happens(&mut self, Chance(chance): Chance) -> bool {
        self.0.next_u64() >> 11 < chance
    }
}

impl Chance {
    /// A probability from 0 to 1; what lies outside becomes the nearer of them.
    pub fn new(probability: f64) -> Self {
        Self((probability.clamp(0.0, 1.0) * CERTAIN) as u64)
    }
}

/// FNV-1a, 64 bits.
pub(crate) fn fnv1a(text: &str) -> u64 {
    let step = |hash: u64, byte: u8| (hash ^ u64::from(byte)).wrapping_mul(1_099_511_628_211);
    text.bytes().fold(14_695_981_039_346_656_037, step)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// If this fails, recorded seeds no longer reproduce their runs.
    #[test]
    fn the_streams_never_change() {
        assert_eq!(fnv1a("foobar"), 0x8594_4171_F739_67E8, "as published");
        let fork = Fork::new(1, "line", "lose_reply");
        let draw = |n| (0..4).map(|_| fork.stream(n).between(0, 999)).collect::<Vec<_>>();
        let mut stream = fork.stream(1);
        let four: Vec<_> = (0..4).map(|_| stream.between(0, 999)).collect();
        assert_eq!(four, [650, 415, 422, 452]);
        assert_eq!(draw(1), vec![four[0]; 4]);
    }

    #[test]
    fn each_part_of_the_name_tells() {
        let mut seen = std::collections::BTreeSet::new();
        for (seed, whole, part) in [(1, "a", "b"), (2, "a", "b"), (1, "b", "a"), (1, "ab", "")] {
            for n in 0..4 {
                seen.insert(Fork::new(seed, whole, part).stream(n).between(0, u64::MAX));
            }
        }
        assert_eq!(seen.len(), 16);
    }

    #[test]
    fn limits_are_reached_and_kept() {
        let fork = Fork::new(7, "", "");
        let drawn: std::collections::BTreeSet<u64> =
            (0..200).map(|n| fork.stream(n).between(3, 6)).collect();
        assert_eq!(drawn.into_iter().collect::<Vec<_>>(), [3, 4, 5, 6]);
        assert_eq!(fork.stream(0).between(5, 5), 5);
        assert!((0..200).all(|n| fork.stream(n).happens(Chance::new(1.0))));
        assert!((0..200).all(|n| !fork.stream(n).happens(Chance::new(0.0))));
    }
}
