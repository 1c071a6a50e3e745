//! The word that was probably meant.
//!
//! Deliberately shy: a far-fetched guess costs the reader more than none.

/// The candidate most like `word`, if one is like it enough: at most every third character differs
/// and at least one agrees. Upper and lower case are the same; of equals the first wins.
pub fn nearest<'a>(word: &str, candidates: impl IntoIterator<Item = &'a str>) -> Option<&'a str> {
    let word = word.to_lowercase();
    let length = word.chars().count();
    let mut best: Option<(usize, &str)> = None;
    for candidate in candidates {
        let lower = candidate.to_lowercase();
        let other = lower.chars().count();
        let limit = (length.max(other) / 3).max(1).min(length.min(other).saturating_sub(1));
        let to_beat = best.map_or(usize::MAX, |(distance, _)| distance);
        // A distance is never below the difference in length; asking first keeps a word as long as
        // a file from being compared letter by letter.
        if length.abs_diff(other) > limit {
            continue;
        }
        // Not Levenshtein: swapped digits are the most common slip in a register number.
        let distance = strsim::osa_distance(&word, &lower);
        if distance <= limit && distance < to_beat {
            best = Some((distance, candidate));
        }
    }
    best.map(|(_, candidate)| candidate)
}

/// The nearest candidate as advice: ``did you mean `x`?``.
pub fn did_you_mean<'a>(
    word: &str,
    candidates: impl IntoIterator<Item = &'a str>,
) -> Option<String> {
    nearest(word, candidates).map(|candidate| format!("did you mean `{candidate}`?"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nearest_word() {
        for (word, candidates, want) in [
            ("C06.40", &["C05.31", "C06.04", "C07.40x"][..], Some("C06.04")),
            ("jog.sped", &["jog.accel", "jog.speed", "jog.pos"], Some("jog.speed")),
            ("fuctions", &["format", "functions", "faults"], Some("functions")),
            ("FUNCTIONS", &["function", "functions"], Some("functions")),
            ("homing-method", &["homing_method"], Some("homing_method")),
            ("tie", &["tin", "tip", "lie"], Some("tin")),
            ("rww", &["r", "w", "rw"], Some("rw")),
            ("x", &["r", "w", "rw"], None),
            ("R", &["w", "r"], Some("r")),
            ("ab", &["cd", "ac"], Some("ac")),
            ("速渡", &["速度", "加速"], Some("速度")),
            ("vendor", &["name", "products"], None),
            ("", &["a", "ab"], None),
            ("speed", &[], None),
        ] {
            assert_eq!(nearest(word, candidates.iter().copied()), want, "{word:?}");
        }
        let long = "x".repeat(1_000_000);
        assert_eq!(nearest(&long, ["xx", "y"]), None);
    }

    #[test]
    fn as_advice() {
        assert_eq!(did_you_mean("baut", ["baud"]).as_deref(), Some("did you mean `baud`?"));
        assert_eq!(did_you_mean("unit", ["baud"]), None);
    }
}
