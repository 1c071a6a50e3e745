//! Times as files write them, with the advice for those who forget the unit.

use crate::problem::{Path, Problem};
use crate::time::{Duration, parse_duration};

/// Reads `500ms` at `path`.
pub fn duration(text: &str, path: &Path, problems: &mut Vec<Problem>) -> Option<Duration> {
    let duration = parse_duration(text);
    if duration.is_none() {
        let what = format!("`{text}` is not a duration");
        let advice = "write a number with us, ms, s or min: 500ms";
        problems.push(Problem::value(path.clone(), what).advise(advice));
    }
    duration
}
