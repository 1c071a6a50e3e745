//! Runs a bench: opens all its ports, says so, serves them until somebody ends it.

use super::clock::Clock;
use super::destination::Destination;
use super::library::plain;
use super::logger::{LogFormat, Logger};
use super::outputs::{OutputFiles, report};
use super::port::{Listener, Pty, Serial, Tty};
use super::ready::{Endpoint, Ready, ReadyUnit};
use super::scenario_run::ScenarioRun;
use super::serve::{Frames, LineServer, Reopen, lock, serve_tcp, serve_tty};
use super::stop::Stop;
use super::store::Store;
use crate::bench::{Bench, BenchLine, PortSpec};
use crate::bus::Bus;
use crate::scenario::{Scenario, Verdict, junit};
use crate::serial::{Parity, Settings};
use std::future::Future;
use std::io;
use std::path::{Path, PathBuf};
use std::pin::Pin;
use std::sync::{Arc, Mutex};
use thiserror::Error;
use tokio::sync::Notify;
use tracing::info;

/// How to run a bench.
#[derive(Debug)]
pub struct RunOptions {
    /// The seed, told to everybody.
    pub seed: u64,
    /// Emulated seconds for each second of the wall.
    pub rate: f64,
    /// What the log on stdout looks like.
    pub format: LogFormat,
    /// The log as JSON lines.
    pub log_file: Option<Destination>,
    /// Written when every port is open, and gone when they are closed.
    pub ready_file: Option<Destination>,
    /// Where drives keep what they store.
    pub store: Option<Store>,
    /// What happens to the lines, and what should come of it.
    pub play: Option<Play>,
    /// Paths of links are relative to this.
    pub base: PathBuf,
}

/// A scenario to play.
#[derive(Debug)]
pub struct Play {
    /// What it is called in the report.
    pub name: String,
    /// Its steps.
    pub scenario: Scenario,
    /// The report is written here when the run is over.
    pub junit: Option<Destination>,
}

/// What became of the steps of each line.
pub type Judged = Vec<(String, Vec<Verdict>)>;

/// What went wrong with a run.
#[derive(Debug, Error)]
pub enum RunError {
    /// A port can't be opened.
    #[error("{0}")]
    Port(String),
    /// A file of the run can't be written, or not all of it.
    #[error("cannot write {}: {error}", .0.display(), error = plain(.1))]
    File(PathBuf, io::Error),
    /// A line has ended by itself, which none does unless this program is wrong.
    #[error("a line ended unexpectedly: {}", .0.as_deref().unwrap_or("no reason"))]
    LineEnded(Option<String>),
    /// The system lets nobody listen for signals.
    #[error("cannot listen for signals: {0}")]
    Signals(io::Error),
}

/// How a run has ended.
#[derive(Debug, Default)]
pub struct Ended {
    /// What became of the steps of a scenario that is a test.
    pub judged: Judged,
    /// What went wrong: with the run, or with what it had to write.
    pub errors: Vec<RunError>,
}

type Task = Pin<Box<dyn Future<Output = ()>>>;

/// Runs `bench` until a signal ends it, or the last step of a scenario that is a test. Whatever ends it, the report on
/// the scenario is written.
pub async fn run(bench: Bench, mut options: RunOptions) -> Ended {
    let over = Arc::new(Notify::new());
    let scenario = options.play.as_ref().map(|play| play.scenario.clone());
    let is_test = scenario.as_ref().is_some_and(Scenario::is_test);
    let directors = scenario.into_iter().flat_map(Scenario::directors);
    let stages: Vec<_> = directors.map(|it| ScenarioRun::new(it, over.clone())).collect();
    let clock = Clock::start(options.rate);
    let (end, mut errors) = match OutputFiles::open(&mut options, bench.lines.len() > 1) {
        Ok(mut outputs) => {
            let over = is_test.then_some(&*over);
            let end = serve(&bench, clock, &stages, over, &mut outputs, &options).await;
            (end, outputs.end())
        }
        Err(error) => (Err(error), Vec::new()),
    };
    let why = end.as_ref().map_or_else(RunError::to_string, |why| (*why).to_owned());
    let now = clock.now();
    let verdicts = stages.iter().map(|scenario| scenario.verdicts(now, &why));
    let names = bench.lines.iter().map(|line| line.name.clone());
    let mut judged = names.zip(verdicts).collect::<Judged>();
    if let Some(play) = &options.play
        && let Some(destination) = &play.junit
    {
        errors.extend(report(destination, &junit(&play.name, &judged)).err());
    }
    if !is_test || end.is_err() {
        judged.clear();
    }
    match end {
        Ok(why) => info!("{why}: ended"),
        Err(error) => errors.insert(0, error),
    }
    Ended { judged, errors }
}

/// Opens all ports, says so, and serves them until something ends that; says what did. `over` is told of when the
/// steps of a test are.
async fn serve(
    bench: &Bench,
    clock: Clock,
    stages: &[ScenarioRun],
    over: Option<&Notify>,
    outputs: &mut OutputFiles,
    options: &RunOptions,
) -> Result<&'static str, RunError> {
    // Before anybody can learn that the run has begun.
    let mut stop = Stop::listen().map_err(RunError::Signals)?;
    let (mut tasks, mut endpoints) = (Vec::new(), Vec::new());
    for (i, line) in bench.lines.iter().enumerate() {
        let shared = (&outputs.log, outputs.store.as_ref(), stages.get(i).cloned());
        let (task, endpoint) = open(line, clock, shared, options)?;
        tasks.push(task);
        endpoints.push(endpoint);
    }
    // Whoever is told that the run is ready may look into it.
    outputs.save()?;
    info!("seed {}", options.seed);
    bench.lines.iter().zip(&endpoints).for_each(|(line, endpoint)| introduce(line, endpoint));
    outputs.ready(&Ready { seed: options.seed, endpoints })?;
    let mut served = tokio::task::JoinSet::new();
    let local = tokio::task::LocalSet::new();
    tasks.into_iter().for_each(|task| {
        served.spawn_local_on(task, &local);
    });
    let end = local.run_until(async {
        tokio::select! {
            why = stop.requested() => Ok(why),
            Some(ended) = served.join_next() => {
                Err(RunError::LineEnded(ended.err().map(|error| error.to_string())))
            }
            () = all_over(stages, over) => Ok("the scenario is over"),
        }
    });
    let end = end.await;
    // Ports close here: links are removed, clients see the end.
    served.abort_all();
    local.await;
    end
}

/// Waits for the last step of all lines; for ever without one to wait for.
async fn all_over(stages: &[ScenarioRun], over: Option<&Notify>) {
    let Some(over) = over else { return std::future::pending().await };
    while !stages.iter().all(ScenarioRun::is_over) {
        over.notified().await;
    }
}

/// What lines share, and the steps of one.
type Shared<'a> = (&'a Arc<Mutex<Logger>>, Option<&'a Arc<Mutex<Store>>>, Option<ScenarioRun>);

fn open(
    line: &BenchLine,
    clock: Clock,
    (log, store, scenario): Shared<'_>,
    options: &RunOptions,
) -> Result<(Task, Endpoint), RunError> {
    let (bus, name) = (line.bus(options.seed), line.name.clone());
    let (wire, settings) = (line.wire, line.wire.mode.settings);
    let mut endpoint = endpoint(line, &bus);
    if let Some(store) = store {
        lock(store).take(&name, &bus);
    }
    let (log, store) = (Some(log.clone()), store.cloned());
    let served = |frames| LineServer { name, bus, clock, frames, log, store, scenario };
    let refused = |error: io::Error| RunError::Port(error.to_string());
    let task: Task = match &line.port {
        PortSpec::Pty(link) => {
            let link = link.as_ref().map(|link| options.base.join(link));
            let pty = open_pty(link.as_deref(), settings).map_err(refused)?;
            endpoint.path = Some(pty.path().display().to_string());
            endpoint.link = pty.link().map(|link| link.display().to_string());
            let reopen: Reopen = Box::new(|settings| Ok(Tty::Pty(open_pty(None, settings)?)));
            Box::pin(serve_tty(served(Frames::Serial(wire)), Tty::Pty(pty), reopen))
        }
        PortSpec::Serial(path) => {
            let serial = open_serial(path, settings).map_err(refused)?;
            if let Some(note) = serial.note() {
                tracing::warn!("{note}");
            }
            endpoint.path = Some(path.clone());
            let path = path.clone();
            let reopen: Reopen =
                Box::new(move |settings| Ok(Tty::Serial(open_serial(&path, settings)?)));
            Box::pin(serve_tty(served(Frames::Serial(wire)), Tty::Serial(serial), reopen))
        }
        PortSpec::Tcp(addr) => {
            let listener = Listener::bind(addr).map_err(refused)?;
            endpoint.addr = Some(local(&listener, addr)?);
            endpoint.line = None;
            endpoint.framing = "mbap";
            Box::pin(serve_tcp(served(Frames::Mbap), listener))
        }
        PortSpec::RtuOverTcp(addr) => {
            let listener = Listener::bind(addr).map_err(refused)?;
            endpoint.addr = Some(local(&listener, addr)?);
            Box::pin(serve_tcp(served(Frames::Serial(wire)), listener))
        }
    };
    Ok((task, endpoint))
}

fn open_pty(link: Option<&Path>, settings: Settings) -> io::Result<Pty> {
    let pty = Pty::open(link)?;
    // So that a program that sets nothing is not blamed for it. Where that can't be done, it is.
    let _ = pty.preset(settings.baud, settings.format.stop_bits);
    Ok(pty)
}

fn open_serial(path: &str, Settings { baud, format }: Settings) -> io::Result<Serial> {
    Serial::open(path, baud, format.data_bits, format.parity.letter(), format.stop_bits)
}

fn local(listener: &Listener, asked: &str) -> Result<String, RunError> {
    let addr = listener.local_addr();
    let addr = addr.map_err(|error| RunError::Port(format!("{asked}: {error}")))?;
    Ok(addr.to_string())
}

fn endpoint(line: &BenchLine, bus: &Bus) -> Endpoint {
    let unit = |drive: &crate::drive::Drive| ReadyUnit {
        unit: drive.unit(),
        model: drive.model().name.clone(),
    };
    Endpoint {
        kind: match line.port {
            PortSpec::Pty(_) => "pty",
            PortSpec::Serial(_) => "serial",
            PortSpec::Tcp(_) => "tcp",
            PortSpec::RtuOverTcp(_) => "rtu-over-tcp",
        },
        path: None,
        link: None,
        addr: None,
        name: line.name.clone(),
        line: Some(line.wire.mode.settings.to_string()),
        framing: if line.wire.mode.ascii { "ascii" } else { "rtu" },
        units: bus.drives().map(|(_, drive)| unit(drive)).collect(),
    }
}

/// Says who is where, and what a newcomer would type next.
fn introduce(line: &BenchLine, endpoint: &Endpoint) {
    let units = endpoint.units.iter().map(|it| format!("unit {} {}", it.unit, it.model));
    let units = units.collect::<Vec<_>>().join(", ");
    // The link as the user wrote it, rather than where that leads.
    let link = match &line.port {
        PortSpec::Pty(Some(link)) => Some(link),
        _ => None,
    };
    let place = link.or(endpoint.path.as_ref()).or(endpoint.addr.as_ref());
    let place = place.cloned().unwrap_or_default();
    let settings = match &endpoint.line {
        Some(settings) => format!("{settings} {}", endpoint.framing.to_uppercase()),
        None => "Modbus TCP".into(),
    };
    info!("{}: {units} on {place} ({settings})", endpoint.name);
    if !line.line_behaviour.is_empty() {
        info!("{}: {}", endpoint.name, line.line_behaviour);
    }
    let parity = line.wire.mode.settings.format.parity;
    if matches!(line.port, PortSpec::Pty(_)) && parity != Parity::None {
        info!("a pseudo-terminal carries no parity bit: open {place} with parity none");
    }
    if let Some(command) = suggestion(line, endpoint, &place) {
        info!("try: {command}");
    }
}

/// An `mbpoll` call that reads something from the first unit; mbpoll speaks no ASCII and no RTU over TCP.
fn suggestion(line: &BenchLine, endpoint: &Endpoint, place: &str) -> Option<String> {
    let device = line.devices.first()?;
    let unit = endpoint.units.iter().find(|it| it.unit != crate::wire::BROADCAST)?.unit;
    let row = device.model.showcase()?;
    let read = format!("-a {unit} -0 -r {} -c {} -1", row.at, row.kind.words());
    let Settings { baud, format } = line.wire.mode.settings;
    match &line.port {
        PortSpec::Pty(_) | PortSpec::Serial(_) if !line.wire.mode.ascii => {
            let parity = match format.parity {
                _ if matches!(line.port, PortSpec::Pty(_)) => "none",
                Parity::None => "none",
                Parity::Even => "even",
                Parity::Odd => "odd",
            };
            let stop = format.stop_bits;
            let place = quoted(place);
            Some(format!("mbpoll -m rtu -b {baud} -P {parity} -s {stop} {read} {place}"))
        }
        PortSpec::Tcp(_) => {
            let (host, port) = place.rsplit_once(':')?;
            Some(format!("mbpoll -m tcp -p {port} {read} {host}"))
        }
        _ => None,
    }
}

/// A path as a shell takes it.
fn quoted(path: &str) -> String {
    let plain = |c: char| c.is_ascii_alphanumeric() || "/._-+:,@%".contains(c);
    match path.chars().all(plain) {
        true => path.to_owned(),
        false => format!("'{}'", path.replace('\'', r"'\''")),
    }
}
