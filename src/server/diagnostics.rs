//! Diagnostics on stderr: plain sentences, marked only where something is wrong.
//!
//! They stand behind a queue: a stderr that is closed, full or never read stops nobody. What it does not take is lost,
//! and that is no failure of a run: there is nobody to tell.

use super::sink::Sink;
use crate::text::one_line;
use std::fmt;
use std::io::{self, Write};
use std::sync::{Mutex, PoisonError};
use tracing::{Event, Level, Subscriber};
use tracing_subscriber::fmt::FmtContext;
use tracing_subscriber::fmt::format::{FormatEvent, FormatFields, Writer};
use tracing_subscriber::registry::LookupSpan;

/// How much to say.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Diagnostics {
    /// What a user at a bench wants to know.
    Normal,
    /// Warnings and errors.
    Quiet,
}

/// Texts that may wait for a slow reader.
const ROOM: usize = 4096;

/// The way to stderr, which a process has only one of; `None` while nobody serves anything.
static STDERR: Mutex<Option<Sink<String>>> = Mutex::new(None);

/// Sends diagnostics to stderr from now on.
pub fn diagnose(diagnostics: Diagnostics) {
    let open = || Ok(Box::new(Forgiving) as Box<dyn Write>);
    // Without a thread to spare they go straight to stderr.
    let sink = Sink::start("stderr", ROOM, Box::new(open)).ok();
    *STDERR.lock().unwrap_or_else(PoisonError::into_inner) = sink;
    let level = match diagnostics {
        Diagnostics::Normal => Level::INFO,
        Diagnostics::Quiet => Level::WARN,
    };
    let subscriber = tracing_subscriber::fmt()
        .with_writer(|| Messages)
        .with_max_level(level)
        .event_format(Plain)
        .finish();
    // A second subscriber would only be a test's; the first one stays.
    let _ = tracing::subscriber::set_global_default(subscriber);
}

/// Says `text`, as it is, on stderr.
pub fn say(text: &str) {
    let mut sink = STDERR.lock().unwrap_or_else(PoisonError::into_inner);
    let Some(sink) = sink.as_mut() else {
        let _ = io::stderr().write_all(text.as_bytes());
        return;
    };
    if let lost @ 1.. = sink.lost() {
        sink.tell_lost(format!("warning: {lost} messages were lost: stderr is too slow\n"));
    }
    sink.put(text.to_owned());
}

/// Nothing more will be said: waits, not for long, until the rest is on stderr.
pub fn said() {
    let sink = STDERR.lock().unwrap_or_else(PoisonError::into_inner).take();
    // There is nobody to tell that nobody could be told.
    let _ = sink.map(Sink::finish);
}

/// What is written to it is one message.
struct Messages;

impl Write for Messages {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        say(&String::from_utf8_lossy(bytes));
        Ok(bytes.len())
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

/// Stderr, which may fail as it likes.
struct Forgiving;

impl Write for Forgiving {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        let _ = io::stderr().write_all(bytes);
        Ok(bytes.len())
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

struct Plain;

impl<S, N> FormatEvent<S, N> for Plain
where
    S: Subscriber + for<'a> LookupSpan<'a>,
    N: for<'a> FormatFields<'a> + 'static,
{
    fn format_event(
        &self,
        context: &FmtContext<'_, S, N>,
        mut writer: Writer<'_>,
        event: &Event<'_>,
    ) -> fmt::Result {
        match *event.metadata().level() {
            Level::ERROR => writer.write_str("error: ")?,
            Level::WARN => writer.write_str("warning: ")?,
            _ => {}
        }
        let mut text = String::new();
        context.field_format().format_fields(Writer::new(&mut text), event)?;
        writeln!(writer, "{}", one_line(&text))
    }
}
