//! Tables in docs/drives that are made from the models: alarms, outputs, and when settings count.

use crate::expect::{read, root, same};
use crate::kit::{MODELS, text_of};
use drivemu::model::builtin::Builtin;
use drivemu::model::{AlarmStop, Applies, Choices, Model, Row, Shown, Shows};
use drivemu::vocabulary::{Action, AlarmCause, Input, Named, Output, Threshold};
use serde_yaml::Value;
use std::fmt::Write as _;

const BEGIN: &str =
    "<!-- Generated from the model by `UPDATE_DOCS=1 cargo test`, down to the next mark. -->\n";
const END: &str = "<!-- Written by hand again. -->\n";

#[test]
fn the_tables_of_each_drive_are_up_to_date() {
    let mut bad = Vec::new();
    for name in MODELS {
        let path = root(&format!("docs/drives/{name}.md"));
        let page = read(&path);
        let model = Builtin::find(name).expect("embedded").load(&Choices::new()).expect("valid");
        let file: Value = serde_yaml::from_str(text_of(name)).expect("YAML");
        let (before, rest) = page.split_once(BEGIN).expect("a mark where the tables begin");
        let (_, after) = rest.split_once(END).expect("a mark where they end");
        let tables = alarms(&model, &file["alarms"])
            + &outputs(&model, &file["quantities"])
            + &settings(&model)
            + &not_simulated(&model);
        let page = format!("{before}{BEGIN}{tables}\n{END}{after}");
        bad.extend(same(&path, &page, "UPDATE_DOCS").err());
    }
    assert!(bad.is_empty(), "{}", bad.join("\n"));
}

/// The page of each drive has every option with its choices, the default first.
#[test]
fn each_option_stands_on_the_page_of_its_drive() {
    let mut bad = Vec::new();
    for name in MODELS {
        let page = read(&root(&format!("docs/drives/{name}.md")));
        let builtin = Builtin::find(name).expect("embedded");
        for option in builtin.load(&Choices::new()).expect("valid").options {
            let start = format!("| `{}` | `{}`", option.name, option.default);
            let row = page.lines().find(|line| line.starts_with(&start)).unwrap_or_default();
            let choices = row.split('|').nth(2).unwrap_or_default();
            let missing = option.choices.iter().find(|it| !choices.contains(&format!("`{it}`")));
            if let Some(choice) = missing {
                bad.push(format!(
                    "{name}: option {} lacks its row, or {choice} there",
                    option.name
                ));
            }
        }
    }
    assert!(bad.is_empty(), "{}", bad.join("\n"));
}

fn alarms(model: &Model, file: &Value) -> String {
    let mut out = String::from(
        "\n## Alarms\n\n| cause | number | raised when | the axis | cleared by | assumed |\n\
         |---|---|---|---|---|---|\n",
    );
    let mut alarms = model.wiring.alarms.clone();
    alarms.sort_by_key(|alarm| alarm.code);
    for alarm in alarms {
        let (name, about) = (alarm.cause.name(), alarm.cause.about());
        let stop = match alarm.stop {
            AlarmStop::Coast => "coasts",
            AlarmStop::Ramp => "decelerates, then the servo is off",
            AlarmStop::Quick => "stops at once, then the servo is off",
        };
        let assumed = file[name]["assumed"].as_str().unwrap_or_default();
        let code = alarm.code;
        let cleared = cleared_by(model, alarm.cause, alarm.resettable);
        writeln!(out, "| `{name}` | {code} | {about} | {stop} | {cleared} | {assumed} |")
            .expect("a string");
    }
    out
}

/// What a master, or whoever has the terminals, can do about an alarm.
fn cleared_by(model: &Model, cause: AlarmCause, resettable: bool) -> String {
    let wiring = &model.wiring;
    let clears = |action: Action| match action {
        Action::AlarmReset => resettable,
        Action::EncoderReset => cause == AlarmCause::Encoder,
        _ => false,
    };
    let mut ways = Vec::new();
    for commands in &wiring.commands {
        let code = code(model.map.row(commands.row));
        let values = commands.actions.iter().filter(|(_, action)| clears(*action));
        ways.extend(values.map(|(value, _)| format!("{code} := 0x{value:04X}")));
    }
    let codes = wiring.input_terminals.iter().flat_map(|it| &it.codes);
    let codes = codes.filter(|(_, input)| *input == Input::AlarmReset && resettable);
    ways.extend(codes.map(|(code, _)| format!("input function {code}")));
    for (row, bits) in &wiring.input_bits {
        let code = code(model.map.row(*row));
        let bits = bits.iter().filter(|(_, input)| *input == Input::AlarmReset && resettable);
        ways.extend(bits.map(|(bit, _)| format!("{code} bit {bit}")));
    }
    ways.push("a power cycle".into());
    ways.join(", ")
}

fn outputs(model: &Model, numbers: &Value) -> String {
    let mut out = String::from("\n## Outputs\n\n| signal | where | active when |\n|---|---|---|\n");
    for output in Output::ALL {
        let places = places(model, *output);
        if !places.is_empty() {
            let (name, about) = (output.name(), output.about());
            writeln!(out, "| `{name}` | {} | {about} |", places.join(", ")).expect("a string");
        }
    }
    let thresholds = Threshold::ALL.iter().map(|it| it.name());
    let mut line = String::new();
    for name in thresholds {
        if let Some(number) = numbers[name].as_str() {
            let comma = if line.is_empty() { "" } else { ", " };
            write!(line, "{comma}`{name}` {number}").expect("a string");
        }
    }
    if !line.is_empty() {
        writeln!(out, "\nThey go by {line}.").expect("a string");
    }
    out
}

/// What the manual has and nothing emulates.
fn not_simulated(model: &Model) -> String {
    let labels = &model.wiring.not_simulated.labels;
    if labels.is_empty() {
        return String::new();
    }
    let mut out = String::from(
        "\n## Not simulated\n\nThese have no effect; the log reports the first use after power-on.\n\n",
    );
    for label in labels {
        writeln!(out, "- {label}").expect("a string");
    }
    out
}

/// When a value counts that a master writes; of segments the first stands for all.
fn settings(model: &Model) -> String {
    let mut out = String::from(
        "\n## When settings take effect\n\n| row | name | printed effect time | takes effect |\n|---|---|---|---|\n",
    );
    let axis = &model.wiring.axis;
    let rules: Vec<_> = axis.segments.rules().collect();
    let (mut told, mut rows) = (Vec::new(), Vec::new());
    let settings: Vec<_> = axis.all_settings().map(|it| it.row).collect();
    for (id, row) in model.map.rows() {
        let counts = model.counts(id);
        // Rows of segments have the number of the segment in their names.
        let name: String = row.name.chars().filter(|c| !c.is_ascii_digit()).collect();
        let of_segments = settings.contains(&id) && told.contains(&name);
        if counts.is_empty() || of_segments || rules.contains(&id) {
            continue;
        }
        told.push(name);
        let printed = match row.applies {
            None => "",
            Some(Applies::Now) => "immediately",
            Some(Applies::AtStop) => "at a stop",
            Some(Applies::PowerOn) => "at power-on",
        };
        let counts: Vec<_> =
            counts.iter().map(|(name, taken)| format!("`{name}` {}", taken.name())).collect();
        rows.push(format!("| {} | {} | {printed} | {} |", code(row), row.name, counts.join(", ")));
    }
    out.push_str(&rows.join("\n"));
    out.push_str("\n\n[What these times mean](../models.md#when-settings-take-effect).\n");
    out
}

/// Where an output shows: functions of terminals and words, bits of rows.
fn places(model: &Model, output: Output) -> Vec<String> {
    let wiring = &model.wiring;
    let is = |shown: &Shown| shown.signal == output;
    let turned = |shown: &Shown| if shown.inverted { ", inverted" } else { "" };
    let codes = wiring.output_terminals.iter().flat_map(|it| &it.codes).filter(|it| is(&it.1));
    let mut places: Vec<_> =
        codes.map(|(code, it)| format!("output function {code}{}", turned(it))).collect();
    for (id, row) in model.map.rows() {
        if let Some(Shows::Bits(bits)) = wiring.shows(id) {
            let bits = bits.iter().filter(|it| is(&it.1));
            places.extend(bits.map(|(bit, it)| format!("{} bit {bit}{}", code(row), turned(it))));
        }
    }
    places
}

/// The manual's code of a row, or its address where our own word stands for it.
fn code(row: &Row) -> String {
    if row.id.starts_with(char::is_lowercase) {
        format!("0x{:04X}", row.at)
    } else {
        row.id.clone()
    }
}
