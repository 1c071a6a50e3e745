//! Writes the event log to stdout and to a file, from a thread of its own.
//!
//! A pipe that nobody reads must not stop a drive: lines queue up to a limit, then they are dropped and
//! counted, and the log says how many when it can write again.

use crate::bus::Bus;
use crate::event::Event;
use crate::log::{json, text};
use crate::text::one_line;
use crate::time::Duration;
use std::fs::File;
use std::io::{self, BufWriter, Write};
use std::path::Path;
use std::sync::mpsc::{Receiver, SyncSender, TrySendError, sync_channel};

/// How long the end of a run waits for a slow reader to take the last lines.
const LAST_LINES: Duration = Duration::from_secs(1);

/// Lines that may wait for a slow reader.
const QUEUE: usize = 65_536;

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
    /// How it looks on stdout; `None` for not at all.
    format: Option<LogFormat>,
    /// Several lines: each event says on which it was.
    names: bool,
    to_file: bool,
    queue: Option<SyncSender<Entry>>,
    dropped: u64,
    /// Ends when the writer has written everything.
    written: Receiver<()>,
}

struct Entry {
    stdout: Option<String>,
    file: Option<String>,
}

impl Logger {
    /// Starts a log on stdout in `format`, and in a file as JSON. `names`: should the text say on which line
    /// an event was?
    ///
    /// # Errors
    /// If the file can't be created.
    pub fn start(format: Option<LogFormat>, names: bool, file: Option<&Path>) -> io::Result<Self> {
        let file = file.map(File::create).transpose()?;
        let (queue, entries) = sync_channel(QUEUE);
        let to_file = file.is_some();
        let (writing, written) = sync_channel(0);
        std::thread::Builder::new().name("log".into()).spawn(move || {
            write(&entries, file.map(BufWriter::new));
            drop(writing);
        })?;
        Ok(Self { format, names, to_file, queue: Some(queue), dropped: 0, written })
    }

    /// Logs an event of the line called `name`.
    pub fn log(&mut self, event: &Event, name: &str, bus: &Bus) {
        let object = || json::object(event, name, bus).to_string();
        let file = self.to_file.then(object);
        let stdout = self.format.map(|format| match format {
            LogFormat::Json => file.clone().unwrap_or_else(object),
            LogFormat::Text => self.text(event, name, bus),
        });
        self.send(Entry { stdout, file });
    }

    fn text(&self, event: &Event, name: &str, bus: &Bus) -> String {
        let line = text::line(event, bus);
        match (self.names, line.split_once(' ')) {
            (true, Some((time, what))) => format!("{time} {} {what}", one_line(name)),
            _ => line,
        }
    }

    fn send(&mut self, entry: Entry) {
        let Some(queue) = &self.queue else { return };
        if self.dropped > 0 {
            let lost =
                format!("{} lines of the log were lost: its reader is too slow", self.dropped);
            let stdout = self.format.map(|format| match format {
                LogFormat::Text => lost.clone(),
                LogFormat::Json => lost_object(&lost, self.dropped),
            });
            let file = self.to_file.then(|| lost_object(&lost, self.dropped));
            if queue.try_send(Entry { stdout, file }).is_err() {
                self.dropped += 1;
                return;
            }
            self.dropped = 0;
        }
        match queue.try_send(entry) {
            Ok(()) => {}
            Err(TrySendError::Full(_)) => self.dropped += 1,
            Err(TrySendError::Disconnected(_)) => self.queue = None,
        }
    }
}

impl Drop for Logger {
    /// Writes what is left. A reader that stopped reading must not hold up the end of the run for long.
    fn drop(&mut self) {
        self.queue = None;
        // Nothing is ever sent: this waits for the writer to end.
        let _ = self.written.recv_timeout(LAST_LINES);
    }
}

fn lost_object(text: &str, count: u64) -> String {
    serde_json::json!({"event": "log_lost", "lines": count, "text": text}).to_string()
}

fn write(entries: &Receiver<Entry>, mut file: Option<BufWriter<File>>) {
    let mut stdout = Some(BufWriter::new(io::stdout()));
    while let Ok(entry) = entries.recv() {
        let mut next = Some(entry);
        // One flush for all that has queued up meanwhile.
        while let Some(entry) = next {
            put(&mut stdout, entry.stdout);
            put(&mut file, entry.file);
            next = entries.try_recv().ok();
        }
        flush(&mut stdout);
        flush(&mut file);
    }
}

/// Writes a line. A reader that went away (`| head`) ends this output, not the drive.
fn put<W: Write>(output: &mut Option<W>, line: Option<String>) {
    let (Some(writer), Some(line)) = (output.as_mut(), line) else { return };
    if writeln!(writer, "{line}").is_err() {
        *output = None;
    }
}

fn flush<W: Write>(output: &mut Option<W>) {
    if output.as_mut().is_some_and(|writer| writer.flush().is_err()) {
        *output = None;
    }
}
