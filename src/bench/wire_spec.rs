//! How a line is set, what that means for telling frames apart, and how drives are set to it.

use super::Device;
use crate::drive::{Drive, Setup};
use crate::line::Framing;
use crate::model::{Coded, Model, RowId};
use crate::serial::{Mode, Settings};
use crate::time::{Duration, Instant};

/// How a line is set.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct WireSpec {
    /// Transmission mode, speed and character format.
    pub mode: Mode,
    /// RTU frames end by silence only.
    pub strict: bool,
    /// Characters of silence that end a frame.
    pub silence: f64,
    /// A pseudo-terminal carries nothing while the master's port is set to another speed than the line.
    pub match_baud: bool,
}

/// Silence that a patient line waits for at least where the CRC does not fit: schedulers and USB adapters stretch a pause inside a
/// frame to 3-16 ms.
pub const PATIENT_GAP: Duration = Duration::from_millis(20);

/// Longest pause inside an ASCII frame (serial line, 2.5.2.1).
const ASCII_GAP: Duration = Duration::from_secs(1);

impl WireSpec {
    /// How a line with `devices` is set: as told, else as the first drive's own parameters say.
    pub fn of(
        devices: &[Device],
        settings: Option<Settings>,
        ascii: Option<bool>,
        strict: bool,
    ) -> Self {
        let first = devices.first();
        let own = first.and_then(|device| {
            Drive::new(device.model.clone(), device.setups.first()?, Instant::ZERO).mode()
        });
        let own = own.unwrap_or(Mode { ascii: false, settings: Settings::STANDARD });
        Self {
            mode: Mode {
                ascii: ascii.unwrap_or(own.ascii),
                settings: settings.unwrap_or(own.settings),
            },
            strict,
            silence: first.map_or(3.5, |device| device.model.line.silence),
            match_baud: false,
        }
    }

    /// The framing of a serial line at `rate` emulated seconds per wall second. Pauses between bytes are
    /// facts of the wall, so every gap grows with the rate.
    pub fn framing(&self, rate: f64) -> Framing {
        if self.mode.ascii {
            return Framing::Ascii { gap: ASCII_GAP.mul_f64(rate) };
        }
        let silence = self.mode.settings.silence(self.silence);
        let patience = (!self.strict).then(|| silence.max(PATIENT_GAP).mul_f64(rate));
        Framing::Rtu { silence: silence.mul_f64(rate), patience }
    }
}

/// Sets the serial parameters of `device` to `mode`. Unless somebody has `told` the line how to talk, what
/// masters have stored in an earlier run stays.
///
/// # Errors
/// One sentence, if the drive has no code for that speed or format; it could never be on such a line.
pub fn match_line(device: &mut Device, mode: Mode, told: bool) -> Result<(), String> {
    let Mode { ascii, settings } = mode;
    let model = device.model.clone();
    let line = &model.line;
    let baud = code(&line.baud, |baud| *baud == settings.baud).ok_or_else(|| {
        let known: Vec<_> = line.baud.codes.values().map(u32::to_string).collect();
        format!(
            "{} does not support {} baud; it supports {}",
            model.name,
            settings.baud,
            known.join(", ")
        )
    })?;
    let format = code(&line.format, |it| it.ascii == ascii && it.format == settings.format);
    let format = format.ok_or_else(|| {
        let text = |it: &crate::model::WireFormat| {
            format!("{}{}", if it.ascii { "ASCII " } else { "" }, it.format)
        };
        let known: Vec<_> = line.format.codes.values().map(text).collect();
        if ascii && !line.format.codes.values().any(|it| it.ascii) {
            return format!("{} does not support ASCII, only RTU", model.name);
        }
        let kind = if ascii { "ASCII" } else { "RTU" };
        let (name, format) = (&model.name, settings.format);
        format!("{name} does not support {kind} {format}; it supports {}", known.join(", "))
    })?;
    if line.baud_switches != 0 {
        let shift = line.unit.switches;
        let row = model.map.row(line.format.row);
        if line.format.code_in(row.kind.value(row.init)) != format {
            return Err(format!(
                "{} has switches for its baud rate, and its character format is fixed",
                model.name
            ));
        }
        for setup in &mut device.setups {
            match i64::from(setup.switches >> shift) {
                0 => setup.switches |= (baud as u8) << shift,
                code if code == baud => {}
                code => {
                    let says = line.baud.codes.get(&code).copied().unwrap_or_default();
                    return Err(format!("its switches set {says} baud, but the line is at {mode}"));
                }
            }
        }
        return Ok(());
    }
    for setup in &mut device.setups {
        agrees(&model, setup, &line.baud, baud, mode)?;
        agrees(&model, setup, &line.format, format, mode)?;
        if told || !setup.kept.is_stored(line.baud.row) {
            put(&model, setup, &line.baud, baud);
        }
        if told || !setup.kept.is_stored(line.format.row) {
            put(&model, setup, &line.format, format);
        }
    }
    Ok(())
}

fn code<T>(coded: &Coded<T>, fits: impl Fn(&T) -> bool) -> Option<i64> {
    coded.codes.iter().find(|(_, meaning)| fits(meaning)).map(|(code, _)| *code)
}

/// A start value that somebody gave must not say something else than the line.
fn agrees<T: Copy>(
    model: &Model,
    setup: &Setup,
    coded: &Coded<T>,
    code: i64,
    mode: Mode,
) -> Result<(), String> {
    let Some(raw) = start_value(setup, coded.row) else { return Ok(()) };
    let row = model.map.row(coded.row);
    let value = row.kind.value(raw);
    match coded.code_in(value) == code {
        true => Ok(()),
        false => {
            Err(format!("{} = {value} does not match the line, which is at {mode}", row.label()))
        }
    }
}

/// Puts `code` into the row, or into the digit of it, leaving its other digits as they are.
fn put<T>(model: &Model, setup: &mut Setup, coded: &Coded<T>, code: i64) {
    let row = model.map.row(coded.row);
    let mut of_station = model.stations[setup.station].init.iter();
    let of_station = of_station.find(|(id, _)| *id == coded.row).map(|(_, raw)| *raw);
    let present = start_value(setup, coded.row).or(setup.kept.raw(coded.row));
    let present = present.or(of_station).unwrap_or(row.init);
    let raw = match coded.digit {
        None => row.kind.raw(code),
        Some(digit) => present & !(0xF << (4 * digit)) | (code as u32) << (4 * digit),
    };
    setup.values.push((coded.row, raw));
}

/// The start value of `row`, if it has one: of several the last counts.
fn start_value(setup: &Setup, row: RowId) -> Option<u32> {
    setup.values.iter().rev().find(|(id, _)| *id == row).map(|(_, raw)| *raw)
}
