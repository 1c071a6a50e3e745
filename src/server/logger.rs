//! Writes the event log to stdout and to a file, each behind a queue of its own. Whoever serves a line only queues the
//! event; the thread behind the queue makes text of it.
//!
//! A pipe that is not read must not stop a drive: lines for which it is too slow are lost and counted, and the log says how
//! much when it can write again. An output that fails ends there; that is told at once, and again when the run ends.

use super::destination::Destination;
use super::input::plain;
use super::sink::{Sink, Writable};
use crate::event::Event;
use crate::log::{self, LogNotice};
use std::io::{self, ErrorKind, Write};
use std::path::Path;
use std::sync::Arc;
use tracing::error;

/// Lines that may wait for a slow reader.
const ROOM: usize = 65_536;

/// What the log looks like on stdout.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum LogFormat {
    /// For people.
    Text,
    /// One JSON object a line.
    Json,
}

/// The event log of a run.
#[derive(Debug)]
pub struct Logger {
    stdout: Option<LogOutput>,
    file: Option<LogOutput>,
    /// Several lines: each event says on which it was.
    names: bool,
    /// The names of those that have logged something.
    lines: Vec<Arc<str>>,
}

#[derive(Debug)]
struct LogOutput {
    name: String,
    format: LogFormat,
    sink: Sink<LogEntry>,
}

/// What an output is given.
#[derive(Debug)]
enum LogEntry {
    /// An event of a line, for people; with the name of the line if there are several.
    Text(Event, Option<Arc<str>>),
    /// An event of a line, for programs.
    Json(Event, Arc<str>),
    /// Entries were lost.
    Lost(LogNotice, LogFormat),
}

impl Logger {
    /// Starts a log on stdout in `format`, and in a file as JSON. `names`: should the text say on which line
    /// an event was?
    ///
    /// # Errors
    /// If the file can't be created.
    pub fn start(
        format: Option<LogFormat>,
        names: bool,
        file: Option<&Destination>,
    ) -> io::Result<Self> {
        let file = file.map(|file| {
            let (name, format) = (file.path().display().to_string(), LogFormat::Json);
            Ok::<_, io::Error>(LogOutput { name, format, sink: file.stream(ROOM)? })
        });
        let file = file.transpose()?;
        let stdout = format.map(|format| {
            let open = || Ok(Box::new(Stdout) as Box<dyn Write>);
            let sink = Sink::start("stdout", ROOM, Box::new(open))?;
            Ok::<_, io::Error>(LogOutput { name: "stdout".into(), format, sink })
        });
        Ok(Self { stdout: stdout.transpose()?, file, names, lines: Vec::new() })
    }

    /// Starts a log in the file at `path` alone, as JSON.
    ///
    /// # Errors
    /// If the file can't be created.
    pub fn to_file(path: &Path) -> io::Result<Self> {
        Self::start(None, false, Some(&Destination::find(path)?))
    }

    /// Logs an event of the line called `name`.
    pub fn log(&mut self, event: &Event, name: &str) {
        let known = self.lines.iter().find(|it| &***it == name).cloned();
        let name = known.unwrap_or_else(|| {
            self.lines.push(name.into());
            self.lines[self.lines.len() - 1].clone()
        });
        let names = self.names;
        for output in self.stdout.iter_mut().chain(&mut self.file) {
            output.put(match output.format {
                LogFormat::Text => LogEntry::Text(event.clone(), names.then(|| name.clone())),
                LogFormat::Json => LogEntry::Json(event.clone(), name.clone()),
            });
        }
    }

    /// Writes what is left. A reader that stopped reading does not hold up the end of a run for long.
    ///
    /// # Errors
    /// Each output that could not be written, with its name. That a reader of stdout has gone or is too slow is none.
    pub fn finish(&mut self) -> Vec<(String, io::Error)> {
        let ended = |output: LogOutput| Some((output.name, output.sink.finish().err()?));
        let stdout = self.stdout.take().and_then(ended);
        let stdout = stdout.filter(|(_, error)| error.kind() != ErrorKind::TimedOut);
        stdout.into_iter().chain(self.file.take().and_then(ended)).collect()
    }
}

impl Drop for Logger {
    fn drop(&mut self) {
        // A caller that needs the result has asked for it.
        self.finish();
    }
}

impl Writable for LogEntry {
    fn write_to(&self, output: &mut dyn Write) -> io::Result<()> {
        match self {
            Self::Text(event, line) => writeln!(output, "{}", log::text(event, line.as_deref())),
            Self::Json(event, line) => writeln!(output, "{}", log::json(event, line)),
            Self::Lost(lines, LogFormat::Text) => writeln!(output, "{}", lines.text()),
            Self::Lost(lines, LogFormat::Json) => writeln!(output, "{}", lines.json()),
        }
    }
}

impl LogOutput {
    fn put(&mut self, entry: LogEntry) {
        let lost = self.sink.lost();
        if lost > 0 {
            self.sink.tell_lost(LogEntry::Lost(LogNotice::lost(lost), self.format));
        }
        self.sink.put(entry);
        if let Some(why) = self.sink.has_failed() {
            error!("can't write the log to {}: {}; it ends there", self.name, plain(why));
        }
    }
}

/// Stdout, whose reader may go away (`| head`): the rest is not needed then.
struct Stdout;

impl Write for Stdout {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        match io::stdout().write(bytes) {
            Err(error) if error.kind() == ErrorKind::BrokenPipe => Ok(bytes.len()),
            written => written,
        }
    }

    fn flush(&mut self) -> io::Result<()> {
        match io::stdout().flush() {
            Err(error) if error.kind() == ErrorKind::BrokenPipe => Ok(()),
            flushed => flushed,
        }
    }
}
