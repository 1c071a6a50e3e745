//! Writes the event log to stdout and to a file, each behind a queue of its own.
//!
//! A pipe that is not read must not stop a drive: lines for which it is too slow are lost and counted, and the log says how
//! much when it can write again. An output that fails ends there; that is told at once, and again when the run ends.

use super::destination::Destination;
use super::input::plain;
use super::sink::Sink;
use crate::bus::Bus;
use crate::event::Event;
use crate::log::{json, text};
use crate::text::one_line;
use std::io::{self, ErrorKind, Write};
use std::path::Path;
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
}

#[derive(Debug)]
struct LogOutput {
    name: String,
    format: LogFormat,
    sink: Sink,
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
        Ok(Self { stdout: stdout.transpose()?, file, names })
    }

    /// Starts a log in the file at `path` alone, as JSON.
    ///
    /// # Errors
    /// If the file can't be created.
    pub fn to_file(path: &Path) -> io::Result<Self> {
        Self::start(None, false, Some(&Destination::find(path)?))
    }

    /// Logs an event of the line called `name`.
    pub fn log(&mut self, event: &Event, name: &str, bus: &Bus) {
        let object = || json::object(event, name, bus).to_string();
        let for_file = self.file.is_some().then(object);
        if let Some(stdout) = &mut self.stdout {
            stdout.put(match stdout.format {
                LogFormat::Json => for_file.clone().unwrap_or_else(object),
                LogFormat::Text => for_people(event, self.names.then_some(name), bus),
            });
        }
        if let (Some(file), Some(line)) = (&mut self.file, for_file) {
            file.put(line);
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

/// The text of an event, on the line called `name` if there are several.
fn for_people(event: &Event, name: Option<&str>, bus: &Bus) -> String {
    let line = text::line(event, bus);
    match (name, line.split_once(' ')) {
        (Some(name), Some((time, what))) => format!("{time} {} {what}", one_line(name)),
        _ => line,
    }
}

impl LogOutput {
    fn put(&mut self, mut line: String) {
        let lost = self.sink.lost();
        if lost > 0 {
            let text = format!("{lost} lines of the log were lost: the reader is too slow");
            let text = match self.format {
                LogFormat::Text => text,
                LogFormat::Json => {
                    serde_json::json!({"event": "log_lost", "lines": lost, "text": text})
                        .to_string()
                }
            };
            self.sink.tell_lost(text + "\n");
        }
        line.push('\n');
        self.sink.put(line);
        if let Some(why) = self.sink.has_failed() {
            error!("cannot write the log to {}: {}; the log ends there", self.name, plain(why));
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
