//! Conversations as text: what a master says, what the drive answers, what time does in between.
//!
//! ```text
//! model acme-s1.yaml unit 1            # more such lines put more drives on the line
//! line 19200 8N1 strict                # optional; `ascii`, `strict`
//! option crc_error exception           # optional, for the model line above
//! set C003 20                          # optional, likewise; also `switches 5`, `terminal I1`, `machine {home: [50, 60]}`
//! fault lose_reply:count=1,from=30     # optional: a fault rule on the line
//!
//! > 03 1003 0001                       # unit and checksum are added; `>2 03 ...` asks unit 2
//! < 03 02 0014
//! > 06 1003 001E                       # without a `<` line the answer must be an echo of the request
//! > 06 1003 0064
//! < 86 42
//! >> 01 03 10 03 00 01 00 00           # bytes as they are
//! << 01 83 7F 00 D0
//! >> ":0103100300018"                  # characters, CR LF is added
//! << -                                 # silence
//! + 200ms                              # time passes; what comes meanwhile is for a `<` or `<<` line
//! ? alarm off  C003 30                 # signals, quantities and registers of the drive
//! ! power_cycle                        # also `terminal I1 on` and every other line that a scenario can `do`
//! log refused, range 0..50             # the log says so, later than what the last such line found
//! ```
//!
//! What stands behind `#` is a comment.

mod run;

pub use run::run;

use crate::bench::raw::RawMachine;
use crate::problem::decode::decode;
use crate::problem::{Path, Problem, parse};
use crate::serial::Settings;
use crate::testkit::hex;
use crate::time::{Duration, parse_duration};
use crate::units::parse_integer;
use std::collections::BTreeMap;
use thiserror::Error;

/// Where and why a transcript failed.
#[derive(Debug, Clone, PartialEq, Eq, Error)]
#[error("line {line}: {what}")]
pub struct TranscriptFailure {
    /// Line of the transcript, from 1.
    pub line: usize,
    /// What came instead of what.
    pub what: String,
}

/// A transcript as it is written.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Script {
    /// The `model` lines, in order.
    pub drives: Vec<DriveLine>,
    /// Speed and format, if it says.
    pub settings: Option<Settings>,
    /// ASCII framing, if it says.
    pub ascii: Option<bool>,
    /// Frames end by silence only.
    pub strict: bool,
    /// Fault rules in compact form, each with its line.
    pub faults: Vec<(usize, String)>,
    /// What happens, each with its line.
    pub steps: Vec<(usize, TranscriptStep)>,
}

/// A drive of a transcript.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct DriveLine {
    /// Line in the transcript.
    pub line: usize,
    /// Name of a built-in model, or a model file.
    pub model: String,
    /// Unit address.
    pub unit: Option<u8>,
    /// Choices of model options, by name.
    pub options: BTreeMap<String, String>,
    /// Start values.
    pub set: BTreeMap<String, i64>,
    /// Address switches.
    pub switches: Option<u8>,
    /// Input terminals with a signal.
    pub terminals: Vec<String>,
    /// The machine on its axis.
    pub machine: RawMachine,
}

/// One step.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum TranscriptStep {
    /// Ask a unit, by PDU; `None` is the first drive.
    Ask(Option<u8>, Vec<u8>),
    /// Send bytes as they are.
    Send(Vec<u8>),
    /// The answer to the last [`TranscriptStep::Ask`], by PDU; `None` is silence.
    Answer(Option<Vec<u8>>),
    /// The answer as bytes; `None` is silence.
    Bytes(Option<Vec<u8>>),
    /// Time passes.
    Wait(Duration),
    /// Look at a drive; `None` is the first.
    Look(Option<u8>, Vec<Check>),
    /// Do something to a drive.
    Do(Vec<String>),
    /// The log says this.
    Log(String),
}

/// One thing to look at.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Check {
    /// Signal, quantity or register.
    pub name: String,
    /// `on`, `off` or a number.
    pub want: String,
}

impl Script {
    /// Reads a transcript.
    ///
    /// # Errors
    /// The first line that is none of a transcript's.
    pub fn parse(text: &str) -> Result<Self, TranscriptFailure> {
        let mut script = Self::default();
        for (i, line) in text.lines().enumerate() {
            let number = i + 1;
            let content = line.split('#').next().unwrap_or_default().trim();
            if content.is_empty() {
                continue;
            }
            let fail = |what: String| TranscriptFailure { line: number, what };
            script.line(number, content).map_err(fail)?;
        }
        if script.drives.is_empty() {
            return Err(TranscriptFailure { line: 1, what: "no `model` line".into() });
        }
        Ok(script)
    }

    fn line(&mut self, number: usize, line: &str) -> Result<(), String> {
        let (word, rest) = line.split_once(' ').unwrap_or((line, ""));
        let rest = rest.trim();
        let step = match word {
            ">>" => TranscriptStep::Send(bytes(rest)?),
            "<<" => TranscriptStep::Bytes(silence_or(rest, bytes)?),
            "<" => TranscriptStep::Answer(silence_or(rest, hex)?),
            "+" => TranscriptStep::Wait(
                parse_duration(rest).ok_or_else(|| format!("`{rest}` is not a duration"))?,
            ),
            "!" => TranscriptStep::Do(rest.split_whitespace().map(str::to_owned).collect()),
            "log" => TranscriptStep::Log(rest.to_owned()),
            _ if word.starts_with('>') => TranscriptStep::Ask(unit(&word[1..])?, hex(rest)?),
            _ if word.starts_with('?') => TranscriptStep::Look(unit(&word[1..])?, checks(rest)?),
            _ => return self.header(number, word, rest),
        };
        self.steps.push((number, step));
        Ok(())
    }

    fn header(&mut self, number: usize, word: &str, rest: &str) -> Result<(), String> {
        let words: Vec<&str> = rest.split_whitespace().collect();
        match (word, words.as_slice()) {
            ("model", [model, more @ ..]) => {
                let mut drive =
                    DriveLine { line: number, model: (*model).into(), ..Default::default() };
                match more {
                    [] => {}
                    ["unit", unit] => drive.unit = Some(number_of(unit)?),
                    _ => return Err("expected `model NAME` or `model NAME unit N`".into()),
                }
                self.drives.push(drive);
                return Ok(());
            }
            ("line", [baud, format, flags @ ..]) => {
                self.settings = Some(format!("{baud}-{format}").parse()?);
                for flag in flags {
                    match *flag {
                        "strict" => self.strict = true,
                        "ascii" => self.ascii = Some(true),
                        _ => return Err(format!("unknown flag `{flag}`; known: strict, ascii")),
                    }
                }
                return Ok(());
            }
            ("fault", [spec]) => {
                self.faults.push((number, (*spec).into()));
                return Ok(());
            }
            _ => {}
        }
        let drive = self.drives.last_mut().ok_or("the first line must be `model NAME`")?;
        match (word, words.as_slice()) {
            ("option", [name, choice]) => {
                drive.options.insert((*name).into(), (*choice).into());
            }
            ("set", [name, value]) => {
                let value =
                    parse_integer(value).ok_or_else(|| format!("`{value}` is not a number"))?;
                drive.set.insert((*name).into(), value);
            }
            ("switches", [value]) => drive.switches = Some(number_of(value)?),
            ("terminal", [name]) => drive.terminals.push((*name).into()),
            ("position", [value]) => {
                let position = parse_integer(value).and_then(|position| position.try_into().ok());
                drive.machine.position = position.ok_or(format!("`{value}` is not a position"))?;
            }
            ("machine", _) => {
                let position = drive.machine.position;
                drive.machine = RawMachine { position, ..machine(rest)? };
            }
            _ => return Err(format!("unknown transcript line `{word}`")),
        }
        Ok(())
    }
}

/// A machine as a bench has it, on one line.
fn machine(text: &str) -> Result<RawMachine, String> {
    let read = parse(text).and_then(|(tree, mut problems)| {
        let machine = decode(&tree, &Path::root(), &[], &mut problems);
        machine.filter(|_| problems.is_empty()).ok_or(problems)
    });
    read.map_err(|problems| problems.first().map(Problem::to_string).unwrap_or_default())
}

fn unit(text: &str) -> Result<Option<u8>, String> {
    if text.is_empty() { Ok(None) } else { number_of(text).map(Some) }
}

fn number_of(text: &str) -> Result<u8, String> {
    text.parse().map_err(|_| format!("`{text}` is not a number from 0 to 255"))
}

fn bytes(text: &str) -> Result<Vec<u8>, String> {
    match text.strip_prefix('"').and_then(|text| text.strip_suffix('"')) {
        Some(characters) => Ok([characters.as_bytes(), b"\r\n"].concat()),
        None => hex(text),
    }
}

fn silence_or(
    text: &str,
    read: fn(&str) -> Result<Vec<u8>, String>,
) -> Result<Option<Vec<u8>>, String> {
    if text == "-" { Ok(None) } else { read(text).map(Some) }
}

fn checks(text: &str) -> Result<Vec<Check>, String> {
    let words: Vec<&str> = text.split_whitespace().collect();
    let pairs = words.chunks_exact(2);
    if !pairs.remainder().is_empty() || words.is_empty() {
        return Err("expected pairs of a name and its value".into());
    }
    Ok(pairs.map(|pair| Check { name: pair[0].into(), want: pair[1].into() }).collect())
}
