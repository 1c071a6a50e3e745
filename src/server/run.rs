//! Runs a bench: opens all its ports, reports them, and serves them until the run is ended.
//!
//! What a run writes besides what it says on the wire (log, ready file, state file) is prepared before the first port
//! opens, and what could not be written is told at the end: a disk that is full stops no drive.

use super::clock::Clock;
use super::destination::{Destination, Written};
use super::endpoints::{Endpoint, Ready, introduce, open};
use super::input::plain;
use super::line_server::{LineHandle, LineServer};
use super::lock;
use super::logger::{LogFormat, Logger};
use super::paths::PathLock;
use super::store::Store;
use crate::bench::{Bench, BenchLine};
use crate::scenario::{Scenario, Verdict, junit};
use std::collections::BTreeMap;
use std::convert::Infallible;
use std::io;
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex};
use thiserror::Error;
use tokio::signal::unix::{Signal, SignalKind, signal};
use tokio::sync::mpsc;
use tokio::task::JoinSet;
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
    Port(io::Error),
    /// A file of the run can't be written, or not all of it.
    #[error("cannot write {}: {error}", .0.display(), error = plain(.1))]
    File(PathBuf, io::Error),
    /// A line has ended by itself, which none does unless this program is wrong.
    #[error("a line ended unexpectedly: {}", .0.as_deref().unwrap_or("no reason"))]
    LineEnded(Option<String>),
    /// The operating system does not let us listen for signals.
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

/// Runs `bench` until a signal ends it, or the last step of a scenario that is a test. Whatever ends it, the report on
/// the scenario is written.
pub async fn run(bench: Bench, mut options: RunOptions) -> Ended {
    let is_test = options.play.as_ref().is_some_and(|play| play.scenario.is_test());
    let (handles, mut lines) = lines(&bench, &options);
    let (end, mut errors) = match OutputFiles::open(&mut options, bench.lines.len() > 1) {
        Ok(mut outputs) => {
            let end = match open_all(&bench, &mut lines, &mut outputs, &options) {
                Ok(mut stop) => {
                    let mut started = Started::new(lines, handles);
                    let end = started.until_end(&mut stop, is_test).await;
                    lines = started.close().await;
                    end
                }
                Err(error) => Err(error),
            };
            (end, outputs.end())
        }
        Err(error) => (Err(error), Vec::new()),
    };
    let why = end.as_ref().map_or_else(RunError::to_string, |why| (*why).to_owned());
    let judge = |line: LineServer| (line.name().to_owned(), line.end(&why));
    let mut judged: Judged = lines.into_iter().map(judge).collect();
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

/// The lines of `bench`, switched on, with the steps that the scenario has for each. Masters can't reach them yet.
fn lines(bench: &Bench, options: &RunOptions) -> (Vec<LineHandle>, Vec<LineServer>) {
    let clock = Clock::start(options.rate);
    let scenario = options.play.as_ref().map(|play| play.scenario.clone());
    let mut directors = scenario.into_iter().flat_map(Scenario::directors);
    let line = |line: &BenchLine| {
        let (handle, inbox) = LineHandle::new();
        let (name, bus) = (line.name.clone(), line.bus(options.seed));
        let server = LineServer::new(name, bus, line.wire, clock, inbox);
        (handle, server.with_director(directors.next().unwrap_or_default()))
    };
    bench.lines.iter().map(line).unzip()
}

/// Opens all ports and says so. From then on the run can be ended from outside.
fn open_all(
    bench: &Bench,
    lines: &mut [LineServer],
    outputs: &mut OutputFiles,
    options: &RunOptions,
) -> Result<Stop, RunError> {
    let stop = Stop::listen().map_err(RunError::Signals)?;
    let mut endpoints: Vec<Vec<Endpoint>> = Vec::new();
    for (line, server) in bench.lines.iter().zip(lines) {
        outputs.attach(server);
        endpoints.push(open(line, server, &options.base).map_err(RunError::Port)?);
    }
    // The state file must exist when the run reports that it is ready.
    outputs.save()?;
    info!("seed {}", options.seed);
    bench.lines.iter().zip(&endpoints).for_each(|(line, endpoints)| introduce(line, endpoints));
    let endpoints = endpoints.into_iter().flatten().collect();
    outputs.ready(&Ready { seed: options.seed, endpoints })?;
    Ok(stop)
}

/// Lines that are served, each in a task of its own.
struct Started {
    tasks: JoinSet<(usize, LineServer, io::Result<()>)>,
    handles: Vec<LineHandle>,
    /// Each line drops what it has of it with the last of its steps.
    all_over: mpsc::Receiver<Infallible>,
    ended: BTreeMap<usize, LineServer>,
}

impl Started {
    fn new(lines: Vec<LineServer>, handles: Vec<LineHandle>) -> Self {
        let (over, all_over) = mpsc::channel(1);
        let mut tasks = JoinSet::new();
        for (i, mut line) in lines.into_iter().enumerate() {
            line.tell_over(over.clone());
            tasks.spawn(async move {
                let served = line.serve().await;
                (i, line, served)
            });
        }
        Self { tasks, handles, all_over, ended: BTreeMap::new() }
    }

    /// Waits until something ends the run, and says what did.
    async fn until_end(
        &mut self,
        stop: &mut Stop,
        is_test: bool,
    ) -> Result<&'static str, RunError> {
        tokio::select! {
            why = stop.requested() => Ok(why),
            Some(task) = self.tasks.join_next() => {
                let why = match task {
                    Ok((i, line, served)) => {
                        self.ended.insert(i, line);
                        served.err().map(|error| error.to_string())
                    }
                    Err(panic) => Some(panic.to_string()),
                };
                Err(RunError::LineEnded(why))
            }
            None = self.all_over.recv(), if is_test => Ok("the scenario is over"),
        }
    }

    /// Ends all lines and gives them back. Of one that panicked nothing is left.
    async fn close(mut self) -> Vec<LineServer> {
        for handle in &self.handles {
            handle.stop().await;
        }
        while let Some(task) = self.tasks.join_next().await {
            self.ended.extend(task.ok().map(|(i, line, _)| (i, line)));
        }
        self.ended.into_values().collect()
    }
}

/// The signals that end a run: SIGINT, SIGTERM and SIGHUP, from the moment this is made, since a
/// process that waits for the ready file may end the run at once. Under `nohup` a hang-up ends nothing.
#[derive(Debug)]
struct Stop {
    int: Signal,
    term: Signal,
    hang_up: Option<Signal>,
}

impl Stop {
    fn listen() -> io::Result<Self> {
        let (int, term) = (signal(SignalKind::interrupt())?, signal(SignalKind::terminate())?);
        let hang_up = (!is_hang_up_ignored()).then(|| signal(SignalKind::hangup())).transpose()?;
        Ok(Self { int, term, hang_up })
    }

    /// Waits for a signal that ends the run, and returns it.
    async fn requested(&mut self) -> &'static str {
        tokio::select! {
            _ = self.int.recv() => "SIGINT",
            _ = self.term.recv() => "SIGTERM",
            Some(_) = async { self.hang_up.as_mut()?.recv().await } => "SIGHUP",
        }
    }
}

/// Was the process started with SIGHUP ignored? No where the system does not say.
fn is_hang_up_ignored() -> bool {
    let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    let ignored = status.lines().find_map(|line| line.strip_prefix("SigIgn:"));
    let ignored = ignored.and_then(|mask| u64::from_str_radix(mask.trim(), 16).ok());
    // Signal number 1 is the lowest bit.
    ignored.is_some_and(|mask| mask & 1 != 0)
}

/// The outputs of a run.
#[derive(Debug)]
struct OutputFiles {
    /// The log, shared by all lines.
    log: Arc<Mutex<Logger>>,
    /// Where drives keep what they store, shared by all lines.
    store: Option<Arc<Mutex<Store>>>,
    ready: Option<(Destination, Option<Written>)>,
    /// Keeps other runs from the ready file.
    _mark: Option<PathLock>,
}

impl OutputFiles {
    /// Starts the log, and removes a ready file and a report of an earlier run, which would speak of that one.
    /// `names`: has the run several lines?
    ///
    /// # Errors
    /// What the file system says.
    fn open(options: &mut RunOptions, names: bool) -> Result<Self, RunError> {
        let report = options.play.as_ref().and_then(|play| play.junit.as_ref());
        let ready_file = options.ready_file.as_ref().map(Destination::path);
        let mark = match ready_file {
            Some(path) => written(path, PathLock::file(path))?,
            None => None,
        };
        for old in options.ready_file.iter().chain(report) {
            written(old.path(), old.forget())?;
        }
        let log = Logger::start(Some(options.format), names, options.log_file.as_ref());
        let path = options.log_file.as_ref().map_or(Path::new("stdout"), Destination::path);
        let log = log.map_err(|error| RunError::File(path.to_owned(), error))?;
        let store = options.store.take().map(|store| Arc::new(Mutex::new(store)));
        let ready = options.ready_file.take().map(|ready| (ready, None));
        Ok(Self { log: Arc::new(Mutex::new(log)), store, ready, _mark: mark })
    }

    /// Has `line` write its events to the log, and what its drives store to the state file.
    fn attach(&self, line: &mut LineServer) {
        line.subscribe(Box::new(self.log.clone()));
        if let Some(store) = &self.store {
            line.keep_in(store.clone());
        }
    }

    /// Every port is open: writes the ready file; the state file exists by then.
    ///
    /// # Errors
    /// What the file system says.
    fn ready(&mut self, ready: &Ready) -> Result<(), RunError> {
        let Some((destination, result)) = &mut self.ready else { return Ok(()) };
        let text = serde_json::to_string(ready).map_err(io::Error::from);
        let done = text.and_then(|text| destination.write(&format!("{text}\n")));
        *result = Some(done.map_err(|error| RunError::File(destination.path().to_owned(), error))?);
        Ok(())
    }

    /// Writes what drives have stored.
    ///
    /// # Errors
    /// What the file system says.
    fn save(&self) -> Result<(), RunError> {
        self.with_store(Store::save)
    }

    /// The run is over: takes back the ready file and writes what is left. Gives back what could not be written.
    fn end(self) -> Vec<RunError> {
        let mut errors = Vec::new();
        errors.extend(self.with_store(Store::finish).err());
        if let Some((destination, Some(result))) = self.ready {
            let ended = match result {
                Written::File(file) => destination.take_back(file),
                Written::UnderWay(sink) => sink.finish(),
            };
            errors.extend(written(destination.path(), ended).err());
        }
        let log = lock(&self.log).finish();
        errors.extend(log.into_iter().map(|(name, error)| RunError::File(name.into(), error)));
        errors
    }

    fn with_store(&self, act: fn(&mut Store) -> io::Result<()>) -> Result<(), RunError> {
        let Some(mut store) = self.store.as_ref().map(|it| lock(it)) else { return Ok(()) };
        let result = act(&mut store);
        written(store.path(), result)
    }
}

/// Writes the report of a run that is over.
///
/// # Errors
/// What the file system says.
fn report(destination: &Destination, text: &str) -> Result<(), RunError> {
    let done = destination.write(text).and_then(|done| match done {
        Written::File(_) => Ok(()),
        Written::UnderWay(sink) => sink.finish(),
    });
    written(destination.path(), done)
}

/// A file of the run was written, or the run has failed.
fn written<T>(path: &Path, result: io::Result<T>) -> Result<T, RunError> {
    result.map_err(|error| RunError::File(path.to_owned(), error))
}
