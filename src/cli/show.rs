//! `drivemu show` and `drivemu models`: register maps, rows, and what is built in.

use super::{CliError, FAILED, print};
use super::args::{ShowArgs, TableFormat};
use crate::bench::Library;
use crate::model::{
    Access, Applies, Choices, Counts, Model, Number, Reaction, Row, RowId, RowKind, Shows,
    WordOrder, load,
};
use crate::problem::render::render;
use crate::server::FileLibrary;
use crate::vocabulary::Named;
use serde_json::{Value, json};
use crate::model::builtin::Builtin;

pub fn show(args: &ShowArgs) -> Result<(), CliError> {
    let (file, text) = FileLibrary::new("").fetch(&args.model).map_err(CliError::invalid)?;
    let model = load(&text, &Choices::new())
        .map_err(|problems| CliError::invalid(render(&problems, &file, &text)))?;
    let rows: Vec<RowId> = match &args.row {
        Some(name) => vec![find(&model, name)?],
        None => model.map.rows().map(|(id, _)| id).collect(),
    };
    match (args.format, args.row.is_some()) {
        (TableFormat::Json, _) => {
            let rows: Vec<Value> = rows.iter().map(|row| object(&model, *row)).collect();
            print(&format!("{:#}\n", Value::Array(rows)))
        }
        (TableFormat::Markdown, _) => print(&markdown(&model, &rows)),
        (TableFormat::Table, false) => print(&table(&model, &rows)),
        (TableFormat::Table, true) => print(&card(&model, rows[0])),
    }
}

fn find(model: &Model, name: &str) -> Result<RowId, CliError> {
    model.map.find(name).ok_or_else(|| {
        let ids = model.map.rows().map(|(_, row)| row.id.as_str());
        let advice = crate::problem::suggest::did_you_mean(name, ids);
        let advice = advice.map(|advice| format!(" ({advice})")).unwrap_or_default();
        CliError::invalid(format!("{} has no row `{name}`{advice}", model.name))
    })
}

fn table(model: &Model, rows: &[RowId]) -> String {
    let head =
        ["address", "row", "type", "access", "range", "init", "unit", "name", "assumed", "effect"];
    let mut lines = vec![head.map(str::to_owned)];
    for id in rows {
        let row = model.map.row(*id);
        lines.push([
            format!("0x{:04X}", row.at),
            row.id.clone(),
            kind(row.kind).into(),
            access(row.access).into(),
            shortened(&row.range_text(), 24),
            row.kind.value(row.init).to_string(),
            row.unit_text.clone(),
            row.name.clone(),
            if row.assumed.is_empty() { String::new() } else { "yes".into() },
            shortened(&wired(model, *id).unwrap_or_else(|| inert(row).into()), 48),
        ]);
    }
    let width = |column: usize| lines.iter().map(|line| line[column].chars().count()).max();
    let widths: Vec<usize> = (0..head.len()).map(|column| width(column).unwrap_or(0)).collect();
    let mut out = String::new();
    for line in &lines {
        let cells = line.iter().zip(&widths).map(|(cell, width)| format!("{cell:width$}"));
        out.push_str(cells.collect::<Vec<_>>().join("  ").trim_end());
        out.push('\n');
    }
    out
}

/// As many whole items of a list as fit into `most` characters; a row by itself shows all of them.
fn shortened(list: &str, most: usize) -> String {
    if list.chars().count() <= most {
        return list.to_owned();
    }
    let mut short = String::new();
    for item in list.split(", ") {
        if short.chars().count() + item.chars().count() + ", ...".len() > most {
            break;
        }
        short.push_str(item);
        short.push_str(", ");
    }
    short + "..."
}

fn markdown(model: &Model, rows: &[RowId]) -> String {
    let mut out = String::from(
        "| address | row | name | 中文 | type | access | range | init | unit | applies | taken | section | effect | assumed |\n\
         |---|---|---|---|---|---|---|---|---|---|---|---|---|---|\n",
    );
    for id in rows {
        let row = model.map.row(*id);
        let cells = [
            format!("0x{:04X}", row.at),
            row.id.clone(),
            row.name.clone(),
            row.zh.clone(),
            kind(row.kind).into(),
            access(row.access).into(),
            row.range_text(),
            row.kind.value(row.init).to_string(),
            row.unit_text.clone(),
            applies(row.applies).into(),
            counts(model, *id),
            row.see.clone(),
            wired(model, *id).unwrap_or_default(),
            row.assumed.clone(),
        ];
        out.push_str(&format!("| {} |\n", cells.map(|cell| cell.replace('|', "\\|")).join(" | ")));
    }
    out
}

/// Everything about one row.
fn card(model: &Model, id: RowId) -> String {
    let row = model.map.row(id);
    let mut out = format!("{}  0x{:04X}  {}\n", row.id, row.at, row.name);
    let mut line = |name: &str, text: &str| {
        if !text.is_empty() {
            out.push_str(&format!("  {name:<10}{text}\n"));
        }
    };
    line("zh", &row.zh);
    line("type", kind(row.kind));
    line("access", access(row.access));
    line("range", &row.range_text());
    line("init", &row.kind.value(row.init).to_string());
    line("unit", &row.unit_text);
    line("applies", applies(row.applies));
    line("taken", &counts(model, id));
    line("kept", &kept(model, row));
    line("section", &format!("{} ({})", row.see, model.manual));
    line("effect", wired(model, id).as_deref().unwrap_or(inert(row)));
    line("note", &row.note);
    line("assumed", &row.assumed);
    line("no effect", &not_simulated(model, id).join(", "));
    for window in model.map.windows().iter().filter(|window| window.base != 0) {
        if let Some(address) = row
            .at
            .checked_add(window.base)
            .filter(|_| (window.span.0..=window.span.1).contains(&row.at))
        {
            line("also at", &format!("0x{address:04X} (window {})", window.name));
        }
    }
    for (value, meaning) in &row.values {
        line(&format!("= {value}"), meaning);
    }
    for (bit, meaning) in &row.bits {
        line(&format!("bit {bit}"), meaning);
    }
    out
}

fn object(model: &Model, id: RowId) -> Value {
    let row = model.map.row(id);
    json!({
        "address": row.at,
        "row": row.id,
        "name": row.name,
        "zh": row.zh,
        "type": kind(row.kind),
        "access": access(row.access),
        "range": row.spans,
        "init": row.kind.value(row.init),
        "unit": row.unit_text,
        "applies": row.applies.map(|_| applies(row.applies)),
        "counts": model.counts(id).into_iter().map(|(name, taken)| (name, taken.name())).collect::<Vec<_>>(),
        "section": row.see,
        "values": row.values,
        "bits": row.bits,
        "note": row.note,
        "assumed": row.assumed,
        "wired_to": wired(model, id),
        "not_simulated": not_simulated(model, id),
    })
}

/// Functions that can be asked for through the row and that nothing emulates.
fn not_simulated(model: &Model, id: RowId) -> Vec<&str> {
    let wiring = &model.wiring;
    let has = |functions: &[RowId]| functions.contains(&id);
    let input = wiring.input_terminals.as_ref().is_some_and(|terminals| has(&terminals.functions));
    let output =
        wiring.output_terminals.as_ref().is_some_and(|terminals| has(&terminals.functions));
    wiring.not_simulated.of_row(id, input, output)
}

/// What a row does that nothing is wired to.
fn inert(row: &Row) -> &'static str {
    match row.access {
        Access::Read => "constant",
        Access::Write | Access::Both => "stored only",
    }
}

/// What the row is wired to, or `None` if it moves nothing.
fn wired(model: &Model, id: RowId) -> Option<String> {
    if model.map.row(id).inert {
        return None;
    }
    let shows = model.wiring.shows(id).map(|shows| match shows {
        Shows::Quantity(quantity) => quantity.name().to_owned(),
        Shows::Bits(bits) => bits
            .iter()
            .map(|(bit, shown)| {
                format!(
                    "bit {bit} {}{}",
                    if shown.inverted { "not " } else { "" },
                    shown.signal.name()
                )
            })
            .collect::<Vec<_>>()
            .join(", "),
        Shows::OutputWord(word) => format!("output word {}", word + 1),
        Shows::InputBits(of) => {
            let (row, _) = &model.wiring.input_bits[*of];
            format!("signals of {}", model.map.row(*row).id)
        }
        Shows::InputTerminals(_) => "input terminals".into(),
        Shows::OutputTerminals(_) => "output terminals".into(),
        Shows::PastAlarm(_) => "alarm history".into(),
    });
    let reaction = || match model.wiring.reaction(id) {
        Reaction::None => goes_by(model, id),
        Reaction::Trigger(index) => {
            let triggers = &model.wiring.triggers[usize::from(index)];
            let actions = triggers.actions.iter().map(|(bit, action)| (bit, action.name()));
            let modifiers = triggers.modifiers.iter().map(|(bit, modifier)| (bit, modifier.name()));
            let mut bits: Vec<_> = actions.chain(modifiers).collect();
            bits.sort_unstable();
            let bits = bits.iter().map(|(bit, name)| format!("bit {bit} {name}"));
            bits.collect::<Vec<_>>().join(", ")
        }
        Reaction::Inputs => "input signals".into(),
        Reaction::InputWord(word) => format!("input word {}", word + 1),
        Reaction::Command(index) => {
            let actions = &model.wiring.commands[usize::from(index)].actions;
            let action = |(value, action): &(i64, crate::vocabulary::Action)| {
                format!("{value} {}", action.name())
            };
            actions.iter().map(action).collect::<Vec<_>>().join(", ")
        }
        Reaction::Line => "communication settings".into(),
        Reaction::Timeout => "communication watchdog".into(),
    };
    Some(shows.unwrap_or_else(reaction))
}

/// What goes by the value of a row that sets nothing off.
fn goes_by(model: &Model, id: RowId) -> String {
    let axis = &model.wiring.axis;
    let settings = axis
        .settings
        .iter()
        .filter(|setting| setting.row == id)
        .map(|setting| setting.setting.name());
    let counts = (axis.counts_per_rev == Counts::Row(id)).then_some("counts per revolution");
    let encoder =
        (axis.encoder == Some(Counts::Row(id))).then_some("encoder increments per revolution");
    let segments = axis.segments.rows().any(|row| row == id).then_some("segments");
    let thresholds = model.wiring.thresholds.iter();
    let thresholds = thresholds
        .filter(|(_, number)| *number == Number::Row(id))
        .map(|(threshold, _)| threshold.name());
    let mut names: Vec<_> =
        settings.chain(counts).chain(encoder).chain(segments).chain(thresholds).collect();
    names.extend(whole(model, id));
    if names.is_empty() {
        names.extend(model.counts(id).into_iter().map(|(name, _)| name));
    }
    names.join(", ")
}

/// What a row without a setting of its own is for.
fn whole(model: &Model, id: RowId) -> impl Iterator<Item = &'static str> {
    let wiring = &model.wiring;
    let outputs = wiring.output_terminals.as_ref();
    let ordered = matches!(&model.line.word_order, WordOrder::Row { row, .. } if *row == id);
    let gear = wiring.axis.gear.as_ref();
    let interrupt = wiring.axis.interrupt.as_ref();
    let whole = [
        ("output terminals", outputs.is_some_and(|terminals| terminals.functions.contains(&id))),
        (
            "output terminals",
            outputs.is_some_and(|terminals| terminals.normally_closed == Some(id)),
        ),
        ("output words", wiring.output_words.iter().any(|word| word.enabled_by == Some(id))),
        ("user outputs", wiring.user_outputs == Some(id)),
        ("word order", ordered),
        ("gear", gear.is_some_and(|gear| [gear.numerator, gear.denominator].contains(&id))),
        (
            "interrupt positioning",
            interrupt.is_some_and(|interrupt| interrupt.rule.row() == Some(id)),
        ),
    ];
    whole.into_iter().filter(|(_, applies)| *applies).map(|(name, _)| name)
}

fn kind(kind: RowKind) -> &'static str {
    match kind {
        RowKind::U16 => "u16",
        RowKind::I16 => "i16",
        RowKind::U32 => "u32",
        RowKind::I32 => "i32",
    }
}

fn access(access: Access) -> &'static str {
    match access {
        Access::Read => "r",
        Access::Write => "w",
        Access::Both => "rw",
    }
}

/// Empty where nothing is printed.
fn applies(applies: Option<Applies>) -> &'static str {
    match applies {
        None => "",
        Some(Applies::Now) => "now",
        Some(Applies::AtStop) => "at stop",
        Some(Applies::PowerOn) => "at power-on",
    }
}

/// When a new value counts, for each that goes by it.
fn counts(model: &Model, id: RowId) -> String {
    let counts = model.counts(id);
    let times = counts.iter().map(|(name, taken)| format!("{name} {}", taken.name()));
    times.collect::<Vec<_>>().join(", ")
}

/// How a value survives power-off: a plain write does it, a write through another window, a command, or nothing.
fn kept(model: &Model, row: &Row) -> String {
    let keeps = |window: &&crate::model::Window| {
        let (first, last) = window.span;
        window.layer == crate::model::Layer::RamAndStore && (first..=last).contains(&row.at)
    };
    let commands = model.wiring.commands.iter().flat_map(|rows| &rows.actions);
    let stores = commands
        .map(|(_, action)| *action)
        .any(|action| action == crate::vocabulary::Action::StoreAll);
    let window = model.map.windows().iter().find(keeps);
    match (row.access, row.volatile, window) {
        (Access::Read, ..) => String::new(),
        _ if row.autosave => "with every write".into(),
        (_, false, Some(window)) if window.base == 0 => "with every write".into(),
        (_, false, Some(window)) => format!("when written through window {}", window.name),
        (_, false, None) if stores => "when all parameters are stored".into(),
        _ => "never".into(),
    }
}

pub fn models() -> Result<(), CliError> {
    for builtin in Builtin::all() {
        let model = builtin.load(&Choices::new()).map_err(|problems| {
            let text = format!("{} is broken: {}", builtin.file, problems[0]);
            CliError { code: FAILED, text }
        })?;
        let default = if model.name == Builtin::default_name() { " (default)" } else { "" };
        print(&format!("{}{default}\n    {}\n", model.name, model.about))?;
        print(&format!("    manual: {}\n", model.manual))?;
        if !model.products.is_empty() {
            print(&format!("    products: {}\n", model.products.join(", ")))?;
        }
        for option in &model.options {
            let choices = option.choices.iter().map(|choice| match *choice == option.default {
                true => format!("[{choice}]"),
                false => choice.clone(),
            });
            let choices = choices.collect::<Vec<_>>().join(" | ");
            print(&format!("    --set {}={choices}\n        {}\n", option.name, option.about))?;
        }
    }
    print("[A choice in brackets] is the default of its option.\n")
}
