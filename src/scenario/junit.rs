//! What became of a scenario, as JUnit XML: the report that build servers read.

use super::Verdict;
use crate::time::Duration;
use std::fmt::Write as _;

/// The report on all lines, each with its name: a suite a line, a test case a verdict. Times are emulated seconds.
pub fn junit(scenario: &str, lines: &[(String, Vec<Verdict>)]) -> String {
    let mut out = String::from("<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n");
    let mut line = |text: String| writeln!(out, "{text}").expect("a string takes everything");
    line(format!("<testsuites name=\"{}\">", escaped(scenario)));
    for (name, verdicts) in lines {
        let failures = verdicts.iter().filter(|it| it.failure.is_some()).count();
        let time: Duration = verdicts.iter().map(|it| it.took).sum();
        let (name, time, tests) = (escaped(name), time.as_secs_f64(), verdicts.len());
        line(format!(
            "  <testsuite name=\"{name}\" tests=\"{tests}\" failures=\"{failures}\" time=\"{time:.3}\">"
        ));
        for Verdict { step, took, failure, .. } in verdicts {
            let (step, took) = (escaped(step), took.as_secs_f64());
            let case =
                format!("    <testcase classname=\"{name}\" name=\"{step}\" time=\"{took:.3}\"");
            match failure {
                None => line(format!("{case}/>")),
                Some(why) => line(format!(
                    "{case}>\n      <failure message=\"{}\"/>\n    </testcase>",
                    escaped(why)
                )),
            }
        }
        line("  </testsuite>".into());
    }
    line("</testsuites>".into());
    out
}

fn escaped(text: &str) -> String {
    let mut out = String::with_capacity(text.len());
    for c in text.chars() {
        match c {
            '&' => out.push_str("&amp;"),
            '<' => out.push_str("&lt;"),
            '>' => out.push_str("&gt;"),
            '"' => out.push_str("&quot;"),
            // XML has no other control characters than these, however they are written.
            c if c.is_control() && !matches!(c, '\t' | '\n' | '\r') => out.push('\u{FFFD}'),
            '\t' | '\n' | '\r' => write!(out, "&#{};", u32::from(c)).expect("a string"),
            c => out.push(c),
        }
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::time::Instant;

    #[test]
    fn names_may_hold_anything() {
        let verdict = |failure: Option<&str>| Verdict {
            step: "a < \"b\" & c\u{7}\n".into(),
            at: Instant::from_millis(1500),
            took: Duration::from_millis(1500),
            failure: failure.map(str::to_owned),
        };
        let text = junit("s", &[("cell".into(), vec![verdict(None), verdict(Some("5 > 4"))])]);
        let want = "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<testsuites name=\"s\">\n  \
            <testsuite name=\"cell\" tests=\"2\" failures=\"1\" time=\"3.000\">\n    \
            <testcase classname=\"cell\" name=\"a &lt; &quot;b&quot; &amp; c\u{FFFD}&#10;\" time=\"1.500\"/>\n    \
            <testcase classname=\"cell\" name=\"a &lt; &quot;b&quot; &amp; c\u{FFFD}&#10;\" time=\"1.500\">\n      \
            <failure message=\"5 &gt; 4\"/>\n    </testcase>\n  </testsuite>\n</testsuites>\n";
        assert_eq!(text, want);
    }
}
