//! Documents that must not lie: generated ones are up to date, and examples in others work.
//!
//! `UPDATE_DOCS=1 cargo test` writes the generated ones anew.

mod architecture;
mod drives;
mod links;
mod readme;

use crate::expect::{read, root, same};
use crate::kit::Files;
use drivemu::model;
use drivemu::problem::render::render;
use drivemu::testkit::transcript;
use drivemu::units::{Dimension, Unit};
use drivemu::vocabulary::{
    Action, AlarmCause, Cause, Condition, HomeStarter, IndexRule, InhibitRule, Input,
    InterruptRule, Lasts, LimitRule, LimitSource, LimitStop, Modifier, Named, OriginPosition,
    OriginStop, Output, Pace, Quantity, Setting, SoftLimitRule, Taken, Target, Then, Threshold,
};
use serde_yaml::Value;
use std::fmt::Write as _;

#[test]
fn the_catalogue_of_roles_is_up_to_date() {
    let checked = same(&root("docs/roles.md"), &roles(), "UPDATE_DOCS");
    checked.unwrap_or_else(|what| panic!("{what}"));
}

/// docs/roles.md, from the tables in src/vocabulary.
fn roles() -> String {
    let mut out = String::from(
        "<!-- Generated from src/vocabulary by `UPDATE_DOCS=1 cargo test`; edit there, not here. -->\n\n\
         # Roles\n\n\
         The names that a model can use, and their meaning. How to use them: [models.md](models.md).\n",
    );
    let inputs = "Signals into the drive: `signals.inputs` wires them to terminals, words and bits. \
                  A signal is active while at least one of its sources is.";
    section::<Input>(&mut out, "Input signals", inputs);
    let outputs = "Signals out of the drive: `signals.outputs` wires them. `not` in front of a signal \
                   inverts it.";
    section::<Output>(&mut out, "Output signals", outputs);
    let actions = "Triggered by writing a value to a row of `signals.inputs.commands`, or a 1 to a bit of a row of \
                   `signals.inputs.triggers`, immediately and with every write. If several bits are set \
                   at once, only the action listed first here is executed.";
    section::<Action>(&mut out, "Actions", actions);
    let modifiers = "Bits of a row of `signals.inputs.triggers` that modify the action.";
    section::<Modifier>(&mut out, "Modifiers", modifiers);
    let quantities = "Values that the drive computes: `quantities` names the row that shows each.";
    section::<Quantity>(&mut out, "Quantities", quantities);
    out.push_str(
        "\nThe row must have this unit, with an optional factor (`0.1 rpm`, `100 ms`):\n\n",
    );
    for quantity in Quantity::ALL {
        units(&mut out, quantity.name(), &[quantity.dimension()]);
    }
    let settings = "Parameters of motions: `quantities` names the row that holds each.";
    section::<Setting>(&mut out, "Settings", settings);
    out.push_str("\nThe row must have this unit. A ramp time is the time from standstill, or from the start speed of a move or run, to the speed:\n\n");
    for setting in Setting::ALL {
        units(&mut out, setting.name(), setting.dimensions());
    }
    let taken = "When a value written to the row of a setting takes effect: `taken` in `quantities`, or \
                 `settings_taken`, where the row has no `applies`.";
    section::<Taken>(&mut out, "When settings take effect", taken);
    let thresholds = "Limits that outputs and an alarm compare with, at any time: `quantities` names the row that holds each, or \
                      gives a number with its unit.";
    section::<Threshold>(&mut out, "Thresholds", thresholds);
    out.push('\n');
    for threshold in Threshold::ALL {
        self::units(&mut out, threshold.name(), threshold.dimensions());
    }
    let units: Vec<_> = Unit::symbols().map(|it| format!("`{it}`")).collect();
    writeln!(out, "\nAll units: {}.", units.join(", ")).expect("a string");
    let conditions = "Conditions for the next segment of a chain: `axis.segments.position.chain` \
                      gives each a code.";
    section::<Condition>(&mut out, "Conditions", conditions);
    let targets = "Meaning of the target of a position segment: `axis.segments.position.kind`.";
    section::<Target>(&mut out, "Segment targets", targets);
    let rules = "Whether interrupt positioning may start: `axis.interrupt.rule`.";
    section::<InterruptRule>(&mut out, "Locking of interrupt positioning", rules);
    let inhibits =
        "What happens to the following error when `command_inhibit` rises: `axis.inhibit`.";
    section::<InhibitRule>(&mut out, "Inhibited commands", inhibits);
    let lasts = "How long a velocity segment runs: `axis.segments.velocity.trigger`.";
    section::<Lasts>(&mut out, "Segment triggers", lasts);
    homing(&mut out);
    let alarms = "Why a drive trips: `alarms` gives each a number. A cause without a number is never raised.";
    section::<AlarmCause>(&mut out, "Alarm causes", alarms);
    let causes = "Why a drive refuses a request: `line.refuse` lists them in order, each with its \
                  exception code. If several apply, the first in the list is reported.";
    section::<Cause>(&mut out, "Refusal causes", causes);
    out
}

/// The terms of `homing` and `limits`.
fn homing(out: &mut String) {
    section::<Pace>(out, "Homing speeds", "Speed of a homing step: `at`.");
    section::<Then>(
        out,
        "End of a homing step",
        "What happens at the end of a homing step: `then`.",
    );
    let starters = "What can start a homing: `homing.starter`.";
    section::<HomeStarter>(out, "Homing triggers", starters);
    let limit = "What happens when a homing step ends at a limit: `homing.limit`.";
    section::<LimitRule>(out, "Limits during homing", limit);
    let source = "How a homing detects a limit: `homing.limit_source`.";
    section::<LimitSource>(out, "Limit detection", source);
    let index = "How an index pulse refines the origin: `homing.index`.";
    section::<IndexRule>(out, "Use of the index pulse", index);
    let stop = "How the axis stops at the origin: `homing.stop`.";
    section::<OriginStop>(out, "Stopping at the origin", stop);
    let position = "Value of the position register after homing: `position` under `homing.finish`.";
    section::<OriginPosition>(out, "Position after homing", position);
    section::<LimitStop>(out, "Stopping at a limit", "How a limit stops the axis: `limits.stop`.");
    let soft = "When soft limits are in force: `limits.soft`.";
    section::<SoftLimitRule>(out, "Soft limits", soft);
}

/// The units that fit the role `name`.
fn units(out: &mut String, name: &str, dimensions: &[Dimension]) {
    let symbols = |it: &Dimension| match it {
        Dimension::None => vec!["no unit".to_owned()],
        _ => Unit::symbols_of(*it).map(|it| format!("`{it}`")).collect(),
    };
    let symbols: Vec<_> = dimensions.iter().flat_map(symbols).collect();
    writeln!(out, "- `{name}`: {}", symbols.join(" or ")).expect("a string");
}

fn section<W: Named>(out: &mut String, title: &str, about: &str) {
    write!(out, "\n## {title}\n\n{about}\n\n| name | meaning |\n| --- | --- |\n")
        .expect("a string");
    for word in W::ALL {
        writeln!(out, "| `{}` | {} |", word.name(), word.about().replace('|', "\\|"))
            .expect("a string");
    }
}

/// Every YAML on the page about models: a whole model, a part of acme-s1, or something that goes with it.
#[test]
fn the_examples_of_models_are_true() {
    let page = read(&root("docs/models.md"));
    let file = read(&root("tests/models/acme-s1.yaml"));
    let acme: Value = serde_yaml::from_str(&file).expect("YAML");
    let snippets = fenced(&page, "yaml");
    assert!(snippets.len() > 10, "{}", snippets.len());
    for snippet in snippets {
        let part: Value =
            serde_yaml::from_str(&snippet).unwrap_or_else(|e| panic!("{e}\n{snippet}"));
        let text = match part.as_mapping().and_then(|part| part.keys().next()) {
            _ if part.get("format").is_some() => snippet.clone(),
            Some(key) if acme.get(key).is_none() => format!("{file}\n{snippet}"),
            _ => {
                assert!(is_part(&part, &acme), "not what acme-s1.yaml says:\n{snippet}");
                continue;
            }
        };
        let problems = render(&model::check(&text), "models.md", &text);
        assert!(problems.is_empty(), "{problems}");
    }
    let (bad, good) = (
        fenced(&page, "text"),
        fenced(&page, "yaml")[0].replace("register: C002", "register: C0O2"),
    );
    assert_eq!(render(&model::check(&good), "acme-s0.yaml", &good), bad[0]);
    transcript::run(&bad[1], &Files).unwrap_or_else(|failure| panic!("{failure}"));
}

/// Does `whole` say everything that `part` says?
fn is_part(part: &Value, whole: &Value) -> bool {
    match (part, whole) {
        (Value::Mapping(part), Value::Mapping(whole)) => {
            part.iter().all(|(key, part)| whole.get(key).is_some_and(|whole| is_part(part, whole)))
        }
        _ => part == whole,
    }
}

/// The blocks of a page that are fenced as `kind`.
pub fn fenced(page: &str, kind: &str) -> Vec<String> {
    let open = format!("```{kind}\n");
    page.split(&open)
        .skip(1)
        .map(|rest| rest.split("```").next().unwrap_or_default().into())
        .collect()
}

/// The conversation in the head of testkit::transcript goes as it says.
#[test]
fn the_example_of_a_transcript_plays() {
    let head = read(&root("src/testkit/transcript.rs"));
    let lines = head.lines().map_while(|line| line.strip_prefix("//!")).map(str::trim_start);
    let example =
        lines.skip_while(|line| *line != "```text").skip(1).take_while(|line| *line != "```");
    let example = example.collect::<Vec<_>>().join("\n");
    transcript::run(&example, &Files).unwrap_or_else(|failure| panic!("{failure}\n{example}"));
}
