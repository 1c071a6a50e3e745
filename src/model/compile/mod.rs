//! The compiler: from a file with its options laid over it to a [`Model`], in passes.
//!
//! A pass is a function. It takes its section of the file and what passes before it have made, returns its own
//! part of the model, and reports what is wrong. None stops the others, so that all mistakes of a file are told at
//! once. What passes have in common: [`Names`] looks rows and words up and takes reports, [`Uses`] holds what
//! each row shows and sets off, [`Wired`] says which words of the vocabulary are wired at all.

mod alarms;
mod axis;
mod expand;
mod homing;
mod inputs;
mod limits;
mod line;
mod motions;
mod names;
mod outputs;
mod quantities;
mod rows;
mod segments;
mod steps;
mod terminals;
mod uses;
mod wired;

pub use names::duration;

use super::raw::RawModel;
use super::{Model, NotSimulated, OptionInfo, RowId, ServoWiring, Station, Wiring};
use crate::problem::decode::decode;
use crate::problem::tree::Node;
use crate::problem::{Path, Problem};
use crate::time::Duration;
use names::Names;
use uses::Uses;
use wired::Wired;

/// Compiles `file`. Its options are chosen and laid over it already.
pub(super) fn compile(
    file: &Node,
    options: Vec<OptionInfo>,
    problems: &mut Vec<Problem>,
) -> Option<Model> {
    // The rows, and the rest of the file as it is written.
    let (entries, lost) = expand::expand(file, problems);
    let later = ["registers", "repeats", "fill", "options"];
    let raw: RawModel = decode(file, &Path::root(), &later, problems)?;
    let rows = rows::compile(entries, lost, &raw.windows, problems);
    let names = &mut Names { rows: &rows, problems };
    identity(&raw, names);
    let stations = stations(&raw, names);
    let line = line::compile(&raw.line, names);

    // Numbers and signals: what each row is used for.
    let (inputs, outputs) = (&raw.signals.inputs, &raw.signals.outputs);
    let mut uses = Uses::new(rows.map.len());
    let mut absent = NotSimulated::default();
    let numbers = quantities::compile(&raw, &mut uses, names);
    let input_codes = inputs::codes(inputs, &mut absent, names);
    let machine_inputs = inputs::machine(inputs, names);
    let input_terminals = inputs::terminals(inputs, &input_codes, &mut uses, &mut absent, names);
    let input_words = inputs::words(inputs, &input_codes, &mut uses, &mut absent, names);
    let input_bits = inputs::bits(inputs, &mut uses, &mut absent, names);
    inputs::monitors(inputs, &input_bits, &mut uses, names);
    let bit_overrides = inputs::overrides(inputs, &mut uses, names);
    let commands = inputs::commands(inputs, &mut uses, names);
    let triggers = inputs::triggers(inputs, &mut uses, names);
    let output_codes = outputs::codes(outputs, &mut absent, names);
    let output_terminals =
        outputs::terminals(outputs, &output_codes, &mut uses, &mut absent, names);
    let output_words = outputs::words(outputs, &output_codes, &mut uses, &mut absent, names);
    outputs::bits(outputs, &mut uses, names);
    terminals::digits(&mut absent, names);
    line::reactions(&raw.line, &mut uses, names);
    let timeout = line::timeout(&raw.line, &mut uses, names);
    let alarm_history = alarms::history(&raw, &mut uses, names);

    // What goes by signals.
    let mut wiring = Wiring {
        input_terminals,
        machine_inputs,
        input_words,
        input_bits,
        bit_overrides,
        commands,
        triggers,
        output_terminals,
        output_words,
        not_simulated: absent,
        servo: servo(&raw, names),
        alarm_history,
        timeout,
        ..Wiring::default()
    };
    let wired = &Wired::of(&wiring, &uses);
    wiring.user_outputs = outputs::user(outputs, wired, names);
    wiring.alarms = alarms::compile(&raw, wired, names);
    wiring.homing = homing::compile(&raw, wired, &numbers, &wiring.alarms, names);
    let homing = wiring.homing.as_ref();
    wiring.limits = limits::compile(&raw, wired, &numbers, homing, &wiring.alarms, names);
    wiring.axis = axis::compile(raw.axis.as_ref(), wired, &numbers, names);

    // Whether everything goes together.
    quantities::check_thresholds(&numbers, wired, names);
    motions::check(raw.axis.is_some(), wired, &numbers, homing, names);
    homing::check_starters(homing, wired, names);
    alarms::check(&raw, &wiring.alarms, wired, &numbers, names);
    quantities::check_taken(&raw, &wiring.axis, names);
    if wiring.axis.position_gain.is_none() {
        quantities::without_deviation(&numbers, wired, names);
    }
    wiring.thresholds = numbers.thresholds;
    wiring.quantity_rows = uses.quantity_rows();
    wiring.shows = uses.shows;
    wiring.reactions = uses.reactions;
    let line = line?;
    uses::check_unused(&line, &wiring, names);
    Some(Model {
        vendor: raw.model.vendor,
        name: raw.model.name,
        about: raw.model.about,
        products: raw.model.products,
        manual: format!("{}, {}", raw.manual.title, raw.manual.rev),
        options,
        line,
        map: rows.map,
        stations,
        wiring,
    })
}

/// The format and the name of the model.
fn identity(raw: &RawModel, names: &mut Names) {
    if raw.format != 1 {
        let what = format!("unsupported format {}; this version reads format 1", raw.format);
        names.report(Problem::value(Path::root().key("format"), what));
    }
    let name = &raw.model.name;
    let plain = |c: char| c.is_ascii_lowercase() || c.is_ascii_digit() || c == '-';
    if name.is_empty() || !name.chars().all(plain) {
        let what = format!("invalid model name `{name}`");
        let path = Path::root().key("model").key("name");
        names.report(Problem::value(path, what).advise("use lower-case letters, digits and `-`"));
    }
}

/// The stations of the device; one without a name, if the file has none.
fn stations(raw: &RawModel, names: &mut Names) -> Vec<Station> {
    if raw.stations.is_empty() {
        return vec![Station { name: String::new(), init: Vec::new() }];
    }
    let mut stations: Vec<Station> = Vec::new();
    for (i, station) in raw.stations.iter().enumerate() {
        let path = Path::root().key("stations").index(i);
        if stations.iter().any(|it| it.name == station.name) {
            let what = format!("duplicate station name `{}`", station.name);
            names.report(Problem::value(path.key("name"), what));
        }
        let path = path.key("init");
        let mut init: Vec<(RowId, u32)> = Vec::new();
        for (id, value) in &station.init {
            let path = path.key(id);
            let Some(id) = names.row(id, &path) else { continue };
            let row = names.get(id);
            if !row.admits(*value) {
                let what = format!("{value} is outside the range {}", row.range_text());
                names.report(Problem::value(path, what));
            }
            init.push((id, row.kind.raw(*value)));
        }
        stations.push(Station { name: station.name.clone(), init });
    }
    stations
}

/// When the drive is ready and what it does at power-on.
fn servo(raw: &RawModel, names: &mut Names) -> ServoWiring {
    let path = Path::root().key("servo").key("ready_after");
    let ready_after = names.duration(raw.servo.ready_after.as_deref(), &path);
    ServoWiring {
        ready_after: ready_after.unwrap_or(Duration::ZERO),
        enabled_at_power_on: raw.servo.enabled_at_power_on,
    }
}
