//! One device of a bench: a model with its options, and what each station of it is set to.

use crate::bank::Kept;
use crate::drive::{Drive, Setup};
use crate::model::{Model, RowId};
use crate::motion::Machine;
use crate::problem::suggest;
use crate::time::Instant;
use std::collections::BTreeMap;
use std::sync::Arc;

/// A device as somebody asks for it.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct DeviceSpec {
    /// Unit address; of a device with several stations the first one's.
    pub unit: Option<u8>,
    /// Start values by register.
    pub set: BTreeMap<String, i64>,
    /// DIP switches: those of the address, above them those of the speed.
    pub switches: Option<u8>,
    /// Input terminals that carry a signal from the start, by name.
    pub terminals: Vec<String>,
    /// What stands along the axis, in counts of the machine.
    pub machine: Machine,
    /// Where the axis stands at power-on, in counts of the machine.
    pub start: i64,
    /// What the position register says at power-on, in counts.
    pub position: i64,
}

/// A device with its model: one [`Setup`] a station.
#[derive(Debug, Clone)]
pub struct Device {
    /// Its model, with options chosen.
    pub model: Arc<Model>,
    /// Its stations.
    pub setups: Vec<Setup>,
}

/// Which setting of a [`DeviceSpec`] can't be met.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum OverrideKey {
    /// The unit address.
    Unit,
    /// A start value.
    Set(String),
    /// The name that a start value goes by.
    SetName(String),
    /// The DIP switches.
    Switches,
    /// A terminal, by position in the list.
    Terminal(usize),
}

/// Why a setting can't be met.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct SpecProblem {
    /// Which.
    pub override_key: OverrideKey,
    /// Why.
    pub what: String,
    /// What to do.
    pub advice: Option<String>,
}

impl Device {
    /// Sets up a device of `model` as `spec` says.
    ///
    /// # Errors
    /// Every setting that the model can't meet.
    pub fn new(model: Arc<Model>, spec: &DeviceSpec) -> Result<Self, Vec<SpecProblem>> {
        let mut problems = Vec::new();
        let mut values = Vec::new();
        for (name, value) in &spec.set {
            match start_value(&model, name, *value) {
                Ok((row, _)) if values.iter().any(|(other, _)| *other == row) => {
                    let override_key = OverrideKey::SetName(name.clone());
                    let what = format!("{} is set twice", model.map.row(row).label());
                    problems.push(SpecProblem { override_key, what, advice: None });
                }
                Ok(value) => values.push(value),
                Err(problem) => problems.push(problem),
            }
        }
        if let (Some(name), Some(_)) = (names_unit(&model, spec), spec.unit) {
            let what = format!("{name} holds the unit address, which `unit` already sets");
            let advice = Some("remove one of the two".into());
            problems.push(SpecProblem {
                override_key: OverrideKey::SetName(name.clone()),
                what,
                advice,
            });
        }
        let switches = switches(&model, spec, &mut problems);
        let terminals = terminals(&model, spec, &mut problems);
        let setups = (0..model.stations.len()).map(|station| {
            let mut values = values.clone();
            values.extend(
                spec.unit.and_then(|unit| unit_value(&model, unit, station, &mut problems)),
            );
            Setup {
                station,
                kept: Kept::default(),
                values,
                switches,
                terminals,
                machine: spec.machine,
                start: spec.start,
                position: spec.position,
            }
        });
        let setups = setups.collect();
        match problems.is_empty() {
            true => Ok(Self { model, setups }),
            false => Err(problems),
        }
    }
}

impl Device {
    /// The unit addresses that its stations begin with.
    pub fn units(&self) -> impl Iterator<Item = u8> {
        let drive = |setup| Drive::new(self.model.clone(), setup, Instant::ZERO);
        self.setups.iter().map(move |setup| drive(setup).unit())
    }
}

/// The start value that is the unit address, if there is one.
fn names_unit<'a>(model: &Model, spec: &'a DeviceSpec) -> Option<&'a String> {
    spec.set.keys().find(|name| model.map.find(name) == Some(model.line.unit.row))
}

fn start_value(model: &Model, name: &str, value: i64) -> Result<(RowId, u32), SpecProblem> {
    let override_key = OverrideKey::Set(name.to_owned());
    let Some(id) = model.map.find(name) else {
        return Err(no_register(model, name));
    };
    let row = model.map.row(id);
    let asked = value;
    // People write the bits of a negative number as well as the number.
    let bits = row.kind.of_bits(value);
    let value = [Some(value), bits].into_iter().flatten().find(|value| row.admits(*value));
    match value {
        _ if model.wiring.shows(id).is_some() => {
            let what = format!("{} shows a computed value and cannot be set", row.label());
            Err(SpecProblem { override_key, what, advice: None })
        }
        Some(value) => Ok((id, row.kind.raw(value))),
        None => {
            let what = format!("{} accepts {}, not {}", row.label(), row.range_text(), asked);
            Err(SpecProblem { override_key, what, advice: None })
        }
    }
}

fn no_register(model: &Model, name: &str) -> SpecProblem {
    let override_key = OverrideKey::SetName(name.to_owned());
    if model.options.iter().any(|option| option.name == name) {
        let (what, advice) = (format!("`{name}` is an option, not a register"), "see `options`");
        return SpecProblem { override_key, what, advice: Some(advice.into()) };
    }
    if let Ok(address) = name.parse::<u16>() {
        let what = format!("no register at 0x{address:04X}");
        return SpecProblem { override_key, what, advice: None };
    }
    let ids = model.map.rows().map(|(_, row)| row.id.as_str());
    let options = model.options.iter().map(|option| option.name.as_str());
    let advice = suggest::did_you_mean(name, ids.chain(options));
    SpecProblem { override_key, what: format!("unknown register or option `{name}`"), advice }
}

fn unit_value(
    model: &Model,
    unit: u8,
    station: usize,
    problems: &mut Vec<SpecProblem>,
) -> Option<(RowId, u32)> {
    let row = model.map.row(model.line.unit.row);
    let value = i64::from(unit) + station as i64;
    if !row.admits(value) || value == 0 {
        if problems.iter().any(|problem| problem.override_key == OverrideKey::Unit) {
            return None;
        }
        let what = match value {
            0 => "unit 0 is the broadcast address and cannot be a drive's".into(),
            _ => format!("{} accepts {}, not {value}", row.label(), row.range_text()),
        };
        problems.push(SpecProblem { override_key: OverrideKey::Unit, what, advice: None });
        return None;
    }
    Some((model.line.unit.row, row.kind.raw(value)))
}

fn switches(model: &Model, spec: &DeviceSpec, problems: &mut Vec<SpecProblem>) -> u8 {
    let Some(switches) = spec.switches else { return 0 };
    let of_address = model.line.unit.switches;
    let count = of_address + model.line.baud_switches;
    let most = ((1u16 << count) - 1) as u8;
    let address = switches & ((1u16 << of_address) - 1) as u8;
    let mut refuse = |what: String, advice: Option<String>| {
        problems.push(SpecProblem { override_key: OverrideKey::Switches, what, advice });
    };
    if count == 0 {
        refuse("this drive has no DIP switches".into(), Some("use `unit`".into()));
    } else if switches > most {
        refuse(format!("{count} switches give 0..{most}, not {switches}"), None);
    } else if address != 0 && spec.unit.is_some_and(|unit| unit != address) {
        let what = format!("the switches set address {address}, so `unit` has no effect");
        refuse(what, Some("remove one of the two".into()));
    }
    switches
}

fn terminals(model: &Model, spec: &DeviceSpec, problems: &mut Vec<SpecProblem>) -> u16 {
    let terminals = model.wiring.input_terminals.as_ref();
    let names: Vec<String> =
        terminals.map_or(Vec::new(), |it| (0..it.functions.len()).map(|i| it.name(i)).collect());
    let mut signals = 0;
    for (i, name) in spec.terminals.iter().enumerate() {
        match names.iter().position(|it| it == name) {
            Some(index) => signals |= 1 << index,
            None => problems.push(SpecProblem {
                override_key: OverrideKey::Terminal(i),
                what: format!("unknown input terminal `{name}`"),
                advice: Some(match names.as_slice() {
                    [] => "this drive has none".into(),
                    [first, .., last] => format!("this drive has {first} to {last}"),
                    [only] => format!("this drive has {only}"),
                }),
            }),
        }
    }
    signals
}
