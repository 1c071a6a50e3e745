//! `drivemu run`: flags or a bench file become a bench, and the server runs it.

use super::args::{LogFormatArg, PacingArg, ParityArg, RunArgs};
use super::{CliError, FAILED, INVALID, NO_PORT};
use crate::bench::{
    Bench, BenchLine, Device, DeviceSpec, Library, LineBuilder, Mismatch, OverrideKey, PortSpec,
    Saved, SpecProblem, kind_of, parse_saved,
};
use crate::medium::{LineBehaviour, Pacing};
use crate::model::builtin::Builtin;
use crate::model::{Choices, Model, load};
use crate::problem::Problem;
use crate::problem::render::render;
use crate::scenario::{self, Verdict};
use crate::serial::{Parity, Settings};
use crate::server::{
    Destination, Diagnostics, Ended, FileLibrary, Judged, LogFormat, PathClaims, Play, RunError,
    RunOptions, Store, diagnose, is_path, plain, read_text, run as run_bench,
};
use crate::units::parse_integer;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::Arc;

pub fn run(args: RunArgs) -> Result<(), CliError> {
    diagnose(if args.quiet { Diagnostics::Quiet } else { Diagnostics::Normal });
    if !(1e-3..=1e6).contains(&args.rate) {
        return Err(CliError::invalid("--rate must be from 0.001 to 1000000"));
    }
    let mut paths = flags(&args).map_err(CliError::invalid)?;
    let (store, state) = args.state.as_deref().map(StateArg::open).transpose()?.unzip();
    let mut state = state.unwrap_or_default();
    let (mut bench, base, models) = bench(&args, &mut state.saved)?;
    lines(&bench, &base, &models, &mut paths).map_err(CliError::invalid)?;
    state.finish()?;
    for spec in &args.fault {
        for line in &mut bench.lines {
            let added = line.add_fault(spec);
            added.map_err(|problems| CliError::invalid(render(&problems, "--fault", spec)))?;
        }
    }
    let play = args.scenario.as_deref().map(|file| play(file, &args, &bench)).transpose()?;
    let seed = args.seed.or(bench.seed).unwrap_or_else(draw_seed);
    let options = RunOptions {
        seed,
        rate: args.rate,
        format: match args.format {
            LogFormatArg::Text => LogFormat::Text,
            LogFormatArg::Json => LogFormat::Json,
        },
        log_file: destination(args.log_file.as_deref())?,
        ready_file: destination(args.ready_file.as_deref())?,
        store,
        play,
        base,
    };
    let runtime = tokio::runtime::Builder::new_current_thread().enable_all().build();
    let runtime = runtime.map_err(|error| CliError { code: FAILED, text: error.to_string() })?;
    let Ended { judged, errors } = runtime.block_on(run_bench(bench, options));
    let is_port = |error: &RunError| matches!(error, RunError::Port(_));
    let code = if errors.iter().any(is_port) { NO_PORT } else { FAILED };
    let told = errors.iter().map(RunError::to_string).chain(failures(&judged));
    match told.collect::<Vec<_>>().as_slice() {
        [] => Ok(()),
        told => Err(CliError { code, text: told.join("\n") }),
    }
}

/// Where an output goes that a flag asks for.
fn destination(path: Option<&Path>) -> Result<Option<Destination>, CliError> {
    let find = |path: &Path| {
        Destination::find(path).map_err(|error| CliError {
            code: FAILED,
            text: format!("cannot write {}: {}", path.display(), plain(&error)),
        })
    };
    path.map(find).transpose()
}

/// The files that the flags name: none may be written that is read, and none twice.
fn flags(args: &RunArgs) -> Result<PathClaims, String> {
    let mut paths = PathClaims::new();
    let target = args.target.as_deref().unwrap_or(Builtin::default_name());
    if is_path(target) {
        paths.reads(target, Path::new(target))?;
    }
    let named = |flag: &str, path: &Path| format!("{flag} {}", path.display());
    if let Some(path) = &args.scenario {
        paths.reads(named("--scenario", path), path)?;
    }
    if let Some(path) = &args.state {
        paths.owns(named("--state", path), path, Some(&Store::beside(path)))?;
    }
    let outputs = [
        ("--log-file", &args.log_file),
        ("--ready-file", &args.ready_file),
        ("--junit", &args.junit),
    ];
    for (flag, path) in outputs {
        if let Some(path) = path {
            paths.writes(named(flag, path), path)?;
        }
    }
    Ok(paths)
}

/// The files that a bench names.
fn lines(
    bench: &Bench,
    base: &Path,
    models: &[PathBuf],
    paths: &mut PathClaims,
) -> Result<(), String> {
    for model in models {
        paths.reads(format!("the model {}", model.display()), model)?;
    }
    for line in &bench.lines {
        let name = |what: &str, path: &str| format!("the {what} {path} of line `{}`", line.name);
        for port in &line.ports {
            match port {
                PortSpec::Pty(Some(link)) => paths.links(name("link", link), &base.join(link))?,
                PortSpec::Serial(path) => paths.owns(name("port", path), Path::new(path), None)?,
                PortSpec::Pty(None) | PortSpec::Tcp(_) | PortSpec::RtuOverTcp(_) => {}
            }
        }
    }
    Ok(())
}

/// The scenario in `file`, for the lines of `bench`.
fn play(file: &Path, args: &RunArgs, bench: &Bench) -> Result<Play, CliError> {
    let name = file.display().to_string();
    let text = read_text(file)
        .map_err(|error| CliError::invalid(format!("cannot read {name}: {}", plain(&error))))?;
    let scenario = scenario::parse(&text, &bench.lines)
        .map_err(|problems| CliError::invalid(render(&problems, &name, &text)))?;
    let name = file.file_stem().unwrap_or_default().to_string_lossy().into_owned();
    Ok(Play { name, scenario, junit: destination(args.junit.as_deref())? })
}

/// One line for each step that failed.
fn failures(judged: &Judged) -> Vec<String> {
    let mut told = Vec::new();
    for (line, verdicts) in judged {
        for Verdict { step, at, failure, .. } in verdicts {
            let at =
                failure.as_ref().map(|why| format!("{line}: step {step} failed at {at} s: {why}"));
            told.extend(at);
        }
    }
    told
}

/// A seed that survives JSON: no more bits than a double has.
fn draw_seed() -> u64 {
    rand::random::<u64>() >> 11
}

/// The bench to run, what its paths are relative to, and the files of its models.
fn bench(args: &RunArgs, saved: &mut Saved) -> Result<(Bench, PathBuf, Vec<PathBuf>), CliError> {
    let target = args.target.as_deref().unwrap_or(Builtin::default_name());
    refuse_swallowed_model(args)?;
    let (file, text) = FileLibrary::new("").fetch(target).map_err(CliError::invalid)?;
    let kind = kind_of(&text);
    if kind == "scenario" {
        let text = format!("{file} is a scenario; write `run MODEL --scenario {file}`");
        return Err(CliError::invalid(text));
    }
    if kind == "bench" {
        refuse_flags_of_a_line(args)?;
        let base = Path::new(target).parent().unwrap_or(Path::new("")).to_owned();
        let library = FileLibrary::new(&base);
        let bench = parse_saved(&text, &library, saved);
        let bench = bench.map_err(|problems| CliError::invalid(render(&problems, &file, &text)))?;
        return Ok((bench, base, library.files()));
    }
    let compile = |choices: &Choices| {
        let model = load(&text, choices);
        model.map_err(|problems| CliError::invalid(render(&problems, &file, &text)))
    };
    let plain = compile(&Choices::new())?;
    let (choices, set) = override_keys(args, &plain)?;
    let model = if choices.is_empty() { plain } else { compile(&choices)? };
    let line = line(args, Arc::new(model), set, saved)?;
    Ok((Bench { seed: None, lines: vec![line] }, PathBuf::new(), Vec::new()))
}

/// `--pty MODEL` and `--tcp MODEL` take the model for a link or an address.
fn refuse_swallowed_model(args: &RunArgs) -> Result<(), CliError> {
    let link = args.pty.iter().flatten().filter_map(|link| link.to_str());
    let given = link
        .map(|link| ("--pty", link))
        .chain(args.tcp.iter().map(|address| ("--tcp", address.as_str())));
    for (flag, name) in given {
        if args.target.is_none() && Builtin::find(name).is_some() {
            let text =
                format!("`{flag} {name}` does not run the model {name}; write `run {name} {flag}`");
            return Err(CliError::invalid(text));
        }
    }
    Ok(())
}

/// A bench file says these things itself.
fn refuse_flags_of_a_line(args: &RunArgs) -> Result<(), CliError> {
    let flags = [
        ("--unit", args.unit.is_some()),
        ("--switches", args.switches.is_some()),
        ("--pty", args.pty.is_some()),
        ("--serial", args.serial.is_some()),
        ("--tcp", args.tcp.is_some()),
        ("--rtu-over-tcp", args.rtu_over_tcp.is_some()),
        ("--ascii", args.ascii),
        ("--baud", args.baud.is_some()),
        ("--data-bits", args.data_bits.is_some()),
        ("--parity", args.parity.is_some()),
        ("--stop-bits", args.stop_bits.is_some()),
        ("--set", !args.set.is_empty()),
        ("--match-baud", args.match_baud),
        ("--pacing", args.pacing == PacingArg::Line),
    ];
    match flags.iter().find(|(_, given)| *given) {
        Some((flag, _)) => {
            let text = format!("{flag} applies to a model only; in a bench file, set it there");
            Err(CliError::invalid(text))
        }
        None => Ok(()),
    }
}

/// `--set` speaks of options and of registers: sorts them out.
fn override_keys(
    args: &RunArgs,
    model: &Model,
) -> Result<(Choices, BTreeMap<String, i64>), CliError> {
    let (mut choices, mut set) = (Choices::new(), BTreeMap::new());
    for override_key in &args.set {
        let Some((key, value)) = override_key.split_once('=') else {
            return Err(CliError::invalid(format!("--set {override_key}: expected KEY=VALUE")));
        };
        if let Some(option) = model.options.iter().find(|option| option.name == key) {
            if !option.choices.iter().any(|choice| choice == value) {
                let all = option.choices.join(", ");
                return Err(CliError::invalid(format!(
                    "--set {override_key}: {key} accepts {all}"
                )));
            }
            if choices.insert(key.into(), value.into()).is_some() {
                return Err(CliError::invalid(format!(
                    "--set {override_key}: {key} is given twice"
                )));
            }
            continue;
        }
        let number = parse_integer(value).ok_or_else(|| {
            let text = format!(
                "--set {override_key}: `{value}` is not an integer, and {key} is not an option"
            );
            CliError::invalid(text)
        })?;
        if set.insert(key.into(), number).is_some() {
            return Err(CliError::invalid(format!("--set {override_key}: {key} is given twice")));
        }
    }
    Ok((choices, set))
}

fn line(
    args: &RunArgs,
    model: Arc<Model>,
    set: BTreeMap<String, i64>,
    saved: &mut Saved,
) -> Result<BenchLine, CliError> {
    let spec =
        DeviceSpec { unit: args.unit, switches: args.switches, set, ..DeviceSpec::default() };
    let mut device = Device::new(model, &spec).map_err(|problems| {
        let sentence = |problem: &SpecProblem| match &problem.advice {
            Some(advice) => {
                format!("{}: {} ({advice})\n", flag(&problem.override_key, &spec), problem.what)
            }
            None => format!("{}: {}\n", flag(&problem.override_key, &spec), problem.what),
        };
        CliError::invalid(problems.iter().map(sentence).collect::<String>())
    })?;
    let name = "line";
    saved.give(name, 0, &mut device);
    let port = port(args);
    if args.match_baud && !matches!(port, PortSpec::Pty(_)) {
        let text = "--match-baud applies to a pseudo-terminal only";
        return Err(CliError::invalid(text));
    }
    let pacing = match args.pacing {
        PacingArg::Ideal => Pacing::Ideal,
        PacingArg::Line => Pacing::Line,
    };
    let builder = LineBuilder::new(name, vec![device])
        .port(port)
        .ascii(args.ascii.then_some(true))
        .match_baud(args.match_baud)
        .behaviour(LineBehaviour { pacing, ..LineBehaviour::default() });
    let own = builder.wire().mode.settings;
    let told = Some(settings(args, own)).filter(|told| *told != own);
    let (line, mismatches) = builder.settings(told).build();
    if !line.is_serial() && (args.ascii || told.is_some()) {
        return Err(CliError { code: INVALID, text: "Modbus TCP has no serial settings".into() });
    }
    if !line.is_serial() && args.pacing == PacingArg::Line {
        let text = "--pacing line does not apply to Modbus TCP, which has no character times";
        return Err(CliError::invalid(text));
    }
    match mismatches.into_iter().next() {
        Some(Mismatch { what, .. }) => Err(CliError::invalid(what)),
        None => Ok(line),
    }
}

/// What on the command line asked for it.
fn flag(override_key: &OverrideKey, spec: &DeviceSpec) -> String {
    match override_key {
        OverrideKey::Set(name) | OverrideKey::SetName(name) => match spec.set.get(name) {
            Some(value) => format!("--set {name}={value}"),
            None => format!("--set {name}"),
        },
        OverrideKey::Unit => "--unit".into(),
        // These have no flags.
        OverrideKey::Switches | OverrideKey::Terminal(_) => "the drive".into(),
    }
}

fn port(args: &RunArgs) -> PortSpec {
    if let Some(path) = &args.serial {
        return PortSpec::Serial(path.clone());
    }
    if let Some(addr) = &args.tcp {
        return PortSpec::Tcp(addr.clone());
    }
    if let Some(addr) = &args.rtu_over_tcp {
        return PortSpec::RtuOverTcp(addr.clone());
    }
    let link = args.pty.clone().flatten();
    PortSpec::Pty(link.map(|link| link.display().to_string()))
}

fn settings(args: &RunArgs, own: Settings) -> Settings {
    let mut settings = own;
    settings.baud = args.baud.unwrap_or(own.baud);
    let format = &mut settings.format;
    format.data_bits = args.data_bits.unwrap_or(format.data_bits);
    format.stop_bits = args.stop_bits.unwrap_or(format.stop_bits);
    format.parity = match args.parity {
        None => format.parity,
        Some(ParityArg::None) => Parity::None,
        Some(ParityArg::Even) => Parity::Even,
        Some(ParityArg::Odd) => Parity::Odd,
    };
    settings
}

/// What `--state` names: a state file as it was found. Without one it is that of a first run.
#[derive(Debug, Default)]
struct StateArg {
    /// What is in it.
    saved: Saved,
    file: String,
    text: String,
}

impl StateArg {
    /// Takes the file at `path` for this run.
    fn open(path: &Path) -> Result<(Store, Self), CliError> {
        let file = path.display().to_string();
        let (store, text) = Store::open(path)
            .map_err(|error| CliError::invalid(format!("cannot use {file}: {}", plain(&error))))?;
        let mut state = Self { file, ..Self::default() };
        if let Some(text) = text {
            state.text = text;
            state.saved = Saved::read(&state.text).map_err(|problems| state.refused(&problems))?;
        }
        Ok((store, state))
    }

    /// Makes sure that everything in it has found its drive.
    fn finish(mut self) -> Result<(), CliError> {
        let saved = std::mem::take(&mut self.saved);
        saved.finish().map_err(|problems| self.refused(&problems))
    }

    fn refused(&self, problems: &[Problem]) -> CliError {
        let Self { file, text, .. } = self;
        let told = render(problems, file, text);
        let advice =
            format!("{file} was not changed: correct it, move it away, or give another --state");
        CliError::invalid(format!("{told}{advice}"))
    }
}
