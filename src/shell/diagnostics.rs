//! Diagnostics on stderr: plain sentences, marked only where something is wrong.

use crate::text::one_line;
use std::fmt;
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

/// Sends diagnostics to stderr from now on.
pub fn diagnose(diagnostics: Diagnostics) {
    let level = match diagnostics {
        Diagnostics::Normal => Level::INFO,
        Diagnostics::Quiet => Level::WARN,
    };
    let subscriber = tracing_subscriber::fmt()
        .with_writer(std::io::stderr)
        .with_max_level(level)
        .event_format(Plain)
        .finish();
    // A second subscriber would only be a test's; the first one stays.
    let _ = tracing::subscriber::set_global_default(subscriber);
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
