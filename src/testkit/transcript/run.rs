//! Plays a transcript against drives under the virtual clock.

use super::{Check, DriveLine, Script, TranscriptFailure, TranscriptStep};
use crate::bench::{BenchLine, Device, DeviceSpec, Library, LineBuilder, Mismatch, machine};
use crate::drive::View;
use crate::testkit::{Rig, to_hex};
use crate::units::parse_integer;
use crate::vocabulary::{Named, Output, Quantity};
use crate::wire::{ascii, rtu};

/// Plays the transcript in `text`, and gives back the line as it is then, with all that has happened.
///
/// # Errors
/// The first line that did not come out as it says, with the log.
pub fn run(text: &str, library: &dyn Library) -> Result<Rig, TranscriptFailure> {
    let script = Script::parse(text)?;
    let line = line(&script, library)?;
    let mut player = TranscriptPlayer { rig: Rig::line(line), pending: None, told: 0 };
    for (number, step) in &script.steps {
        let played = player.settle(step).and_then(|()| player.play(step));
        played.map_err(|what| player.failure(*number, what))?;
    }
    let last = script.steps.last().map_or(1, |(number, _)| *number);
    let settled = player.settle(&TranscriptStep::Log(String::new()));
    settled.map_err(|what| player.failure(last, what))?;
    Ok(player.rig)
}

fn line(script: &Script, library: &dyn Library) -> Result<BenchLine, TranscriptFailure> {
    let mut devices = Vec::new();
    for drive in &script.drives {
        devices.push(
            device(drive, library).map_err(|what| TranscriptFailure { line: drive.line, what })?,
        );
    }
    let builder = LineBuilder::new("line", devices)
        .settings(script.settings)
        .ascii(script.ascii)
        .strict(script.strict);
    let (mut line, mismatches) = builder.build();
    if let Some(Mismatch { device, what }) = mismatches.into_iter().next() {
        return Err(TranscriptFailure { line: script.drives[device].line, what });
    }
    for (number, spec) in &script.faults {
        let added = line.add_fault(spec);
        added.map_err(|problems| TranscriptFailure {
            line: *number,
            what: problems[0].to_string(),
        })?;
    }
    Ok(line)
}

fn device(drive: &DriveLine, library: &dyn Library) -> Result<Device, String> {
    let model = library.model(&drive.model, &drive.options)?;
    let spec = DeviceSpec {
        unit: drive.unit,
        set: drive.set.clone(),
        switches: drive.switches,
        terminals: drive.terminals.clone(),
        machine: machine(&drive.machine, &model.wiring)
            .map_err(|problems| problems[0].what.clone())?,
        start: drive.machine.start.into(),
        position: drive.machine.position.into(),
    };
    Device::new(model, &spec).map_err(|problems| problems[0].what.clone())
}

struct TranscriptPlayer {
    rig: Rig,
    /// A request whose answer has not been looked at: what was asked and what came.
    pending: Option<(Option<Vec<u8>>, Vec<u8>)>,
    /// Events up to the last one that a `log` step has found.
    told: usize,
}

impl TranscriptPlayer {
    /// An answer that no step looks at must be an echo, or silence to a broadcast.
    fn settle(&mut self, next: &TranscriptStep) -> Result<(), String> {
        if matches!(next, TranscriptStep::Answer(_) | TranscriptStep::Bytes(_)) {
            return Ok(());
        }
        match self.pending.take() {
            Some((Some(echo), got)) => same(echo, got),
            _ => Ok(()),
        }
    }

    fn play(&mut self, step: &TranscriptStep) -> Result<(), String> {
        match step {
            TranscriptStep::Ask(unit, pdu) => {
                let unit = unit.unwrap_or_else(|| self.rig.drive().unit());
                let frame = self.frame(unit, pdu);
                let got = self.rig.send(&frame);
                let echo =
                    if unit == crate::wire::BROADCAST { Vec::new() } else { self.echo(unit, pdu) };
                self.pending = Some((Some(echo), got));
            }
            TranscriptStep::Send(bytes) => {
                let got = self.rig.send(bytes);
                self.pending = Some((None, got));
            }
            TranscriptStep::Answer(want) => {
                let got = self.take_answer()?;
                let unit = if self.ascii() { ascii_unit(&got) } else { got.first().copied() };
                let frame = |pdu: &Vec<u8>| self.frame(unit.unwrap_or(0), pdu);
                same(want.as_ref().map(frame).unwrap_or_default(), got)?;
            }
            TranscriptStep::Bytes(want) => {
                let got = self.take_answer()?;
                same(want.clone().unwrap_or_default(), got)?;
            }
            // What comes meanwhile is looked at like an answer: nothing, unless the next line says otherwise.
            TranscriptStep::Wait(by) => {
                let got = self.rig.advance(*by);
                self.pending = Some((Some(Vec::new()), got));
            }
            TranscriptStep::Look(unit, checks) => {
                let drive = match unit {
                    None => self.rig.drive(),
                    Some(unit) => {
                        self.rig.unit(*unit).ok_or(format!("no drive has unit {unit}"))?
                    }
                };
                checks.iter().try_for_each(|check| look(drive, check))?;
            }
            TranscriptStep::Do(words) => self.act(words)?,
            TranscriptStep::Log(want) => {
                let new = self.rig.log_from(self.told);
                let says = |line: &str| line.contains(want.as_str());
                let at = new.lines().position(says).ok_or_else(|| {
                    format!("the log does not contain `{want}`; new lines:\n{new}")
                })?;
                self.told += at + 1;
            }
        }
        Ok(())
    }

    fn act(&mut self, words: &[String]) -> Result<(), String> {
        self.rig.order(&words.join(" "))
    }

    fn take_answer(&mut self) -> Result<Vec<u8>, String> {
        self.pending.take().map(|(_, got)| got).ok_or("no request was sent".into())
    }

    /// Does the line talk ASCII right now? Its drives may have taken it along to another mode.
    fn ascii(&self) -> bool {
        self.rig.wire().mode.ascii
    }

    fn frame(&self, unit: u8, pdu: &[u8]) -> Vec<u8> {
        if self.ascii() {
            ascii::encode(unit, pdu).to_vec()
        } else {
            rtu::encode(unit, pdu).to_vec()
        }
    }

    /// The answer that only repeats: of a 0x10 request its head.
    fn echo(&self, unit: u8, pdu: &[u8]) -> Vec<u8> {
        match pdu.first() {
            Some(&crate::wire::function::WRITE_MANY) => self.frame(unit, &pdu[..pdu.len().min(5)]),
            _ => self.frame(unit, pdu),
        }
    }

    fn failure(&self, line: usize, what: String) -> TranscriptFailure {
        TranscriptFailure { line, what: self.rig.report(&what) }
    }
}

fn ascii_unit(frame: &[u8]) -> Option<u8> {
    u8::from_str_radix(std::str::from_utf8(frame.get(1..3)?).ok()?, 16).ok()
}

fn same(want: Vec<u8>, got: Vec<u8>) -> Result<(), String> {
    let text = |bytes: &[u8]| if bytes.is_empty() { "silence".into() } else { to_hex(bytes) };
    if want == got {
        Ok(())
    } else {
        Err(format!("wrong answer\n  want {}\n  got  {}", text(&want), text(&got)))
    }
}

fn look(drive: View<'_>, check: &Check) -> Result<(), String> {
    let Check { name, want } = check;
    let row = drive.model().map.find(name);
    let got = if let Some(signal) = Output::parse(name) {
        if drive.output(signal) { "on".to_owned() } else { "off".to_owned() }
    } else if let Some(quantity) = Quantity::parse(name) {
        drive.quantity(quantity).to_string()
    } else if let Some(row) = row {
        drive.value(row).to_string()
    } else {
        return Err(format!("unknown signal, quantity or register `{name}`"));
    };
    let as_number = parse_integer(want).map(|number| number.to_string());
    if got == *want || Some(&got) == as_number.as_ref() {
        Ok(())
    } else {
        Err(format!("{name} is {got}, not {want}"))
    }
}
