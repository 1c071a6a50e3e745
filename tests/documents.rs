//! Documents that must not lie: generated ones are up to date, and examples in others work.
//!
//! `UPDATE_DOCS=1 cargo test` writes the generated ones anew.

mod architecture;
mod drives;
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

/// docs/roles.md, from the tables in src/words.
fn roles() -> String {
    let mut out = String::from(
        "<!-- Generated from src/words by `UPDATE_DOCS=1 cargo test`; edit there, not here. -->\n\n\
         # Roles\n\n\
         The names that a model may use and what each means. How to use them: [models.md](models.md).\n",
    );
    let inputs = "Signals into the drive: `signals.inputs` wires them to terminals, words and bits. \
                  A signal is active while any of its sources is.";
    section::<Input>(&mut out, "Input signals", inputs);
    let outputs = "Signals out of the drive: `signals.outputs` wires them. `not` and a signal shows \
                   its opposite.";
    section::<Output>(&mut out, "Output signals", outputs);
    let actions = "What writing a value to a row of `signals.inputs.commands`, or a 1 to a bit of a row of \
                   `signals.inputs.triggers`, sets off, at once and with every write. Of several bits at \
                   once the action that stands first here acts alone.";
    section::<Action>(&mut out, "Actions", actions);
    let modifiers = "What other bits of a row of `signals.inputs.triggers` say about the action.";
    section::<Modifier>(&mut out, "Modifiers", modifiers);
    let quantities = "Numbers that the drive computes: `quantities` says which row shows each.";
    section::<Quantity>(&mut out, "Quantities", quantities);
    out.push_str("\nThe row's unit must fit, with any factor before it (`0.1 rpm`, `100 ms`):\n\n");
    for quantity in Quantity::ALL {
        units(&mut out, quantity.name(), &[quantity.dimension()]);
    }
    let settings = "Numbers that motions go by: `quantities` says which row holds each.";
    section::<Setting>(&mut out, "Settings", settings);
    out.push_str("\nThe row's unit must fit here too. A ramp in time is from standstill, of a move or run from its start speed, to the speed:\n\n");
    for setting in Setting::ALL {
        units(&mut out, setting.name(), setting.dimensions());
    }
    let taken = "When a value counts that is written to the row of a setting: `taken` in `quantities`, and \
                 `settings_taken`, where the row's `applies` says nothing.";
    section::<Taken>(&mut out, "When settings take effect", taken);
    let thresholds = "Numbers that outputs and an alarm go by, at any time: `quantities` says which row holds each, or \
                      gives a number with its unit.";
    section::<Threshold>(&mut out, "Thresholds", thresholds);
    out.push('\n');
    for threshold in Threshold::ALL {
        self::units(&mut out, threshold.name(), threshold.dimensions());
    }
    let units: Vec<_> = Unit::symbols().map(|it| format!("`{it}`")).collect();
    writeln!(out, "\nAll units: {}.", units.join(", ")).expect("a string");
    let conditions = "What a segment waits for before the next one of its chain: `axis.segments.position.chain` \
                      gives each its code.";
    section::<Condition>(&mut out, "Conditions", conditions);
    let targets = "What the target of a position segment is: `axis.segments.position.kind`.";
    section::<Target>(&mut out, "Targets of segments", targets);
    let rules = "Whether interrupt positioning may start: `axis.interrupt.rule`.";
    section::<InterruptRule>(&mut out, "Rules for interrupt positioning", rules);
    let inhibits =
        "What becomes of what the axis is behind when `command_inhibit` rises: `axis.inhibit`.";
    section::<InhibitRule>(&mut out, "Rules for inhibited commands", inhibits);
    let lasts = "How long a velocity segment lasts: `axis.segments.velocity.trigger`.";
    section::<Lasts>(&mut out, "Triggers of segments", lasts);
    homing(&mut out);
    let alarms =
        "Why a drive trips: `alarms` gives each its number. What has no number is never raised.";
    section::<AlarmCause>(&mut out, "Alarm causes", alarms);
    let causes = "Why a drive refuses a request: `line.refuse` puts them in order, each with its \
                  exception code. Of all that hold, the first in the list answers.";
    section::<Cause>(&mut out, "Causes of refusal", causes);
    out
}

/// The words of `homing` and `limits`.
fn homing(out: &mut String) {
    section::<Pace>(out, "Homing speeds", "How fast a homing step goes: `at`.");
    section::<Then>(out, "Ends of steps", "What happens at the end of a homing step: `then`.");
    let starters = "What may start a homing: `homing.starter`.";
    section::<HomeStarter>(out, "Homing triggers", starters);
    let limit = "What happens when a limit ends the way of a homing step: `homing.limit`.";
    section::<LimitRule>(out, "Limits during a homing", limit);
    let source = "What tells a homing that the axis has come to a limit: `homing.limit_source`.";
    section::<LimitSource>(out, "Limit detection", source);
    let index = "How an index pulse refines the origin: `homing.index`.";
    section::<IndexRule>(out, "Uses of the index pulse", index);
    let stop = "How the axis stops there: `homing.stop`.";
    section::<OriginStop>(out, "Stopping at the origin", stop);
    let position = "What the position register says in the end: `position` under `homing.finish`.";
    section::<OriginPosition>(out, "Positions after a homing", position);
    section::<LimitStop>(out, "Stopping at a limit", "How a limit stops the axis: `limits.stop`.");
    let soft = "When soft limits are in force: `limits.soft`.";
    section::<SoftLimitRule>(out, "Rules for soft limits", soft);
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
