//! What a run writes besides what it says on the wire: log, ready file, state file.
//!
//! All of it is prepared before the first port opens, and what could not be written is told at the end: a disk that is
//! full stops no drive.

use super::destination::{Destination, Written};
use super::endpoints::Ready;
use super::line_server::LineServer;
use super::lock;
use super::logger::Logger;
use super::paths::PathLock;
use super::run::{RunError, RunOptions};
use super::store::Store;
use std::io;
use std::path::Path;
use std::sync::{Arc, Mutex};

/// The outputs of a run.
#[derive(Debug)]
pub struct OutputFiles {
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
    pub fn open(options: &mut RunOptions, names: bool) -> Result<Self, RunError> {
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
    pub fn attach(&self, line: &mut LineServer) {
        line.subscribe(Box::new(self.log.clone()));
        if let Some(store) = &self.store {
            line.keep_in(store.clone());
        }
    }

    /// Every port is open: writes the ready file; the state file exists by then.
    ///
    /// # Errors
    /// What the file system says.
    pub fn ready(&mut self, ready: &Ready) -> Result<(), RunError> {
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
    pub fn save(&self) -> Result<(), RunError> {
        self.with_store(Store::save)
    }

    /// The run is over: takes back the ready file and writes what is left. Gives back what could not be written.
    pub fn end(self) -> Vec<RunError> {
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
pub fn report(destination: &Destination, text: &str) -> Result<(), RunError> {
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
