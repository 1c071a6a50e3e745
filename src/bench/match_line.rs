//! Sets each drive's own baud and format parameters to the line's, as whoever wired the cell has done.

use super::Device;
use crate::drive::Setup;
use crate::model::{Coded, Model, RowId};
use crate::serial::Mode;

/// Sets the serial parameters of `device` to `mode`.
///
/// # Errors
/// One sentence, if the drive has no code for that speed or format; it could never be on such a line.
pub fn match_line(device: &mut Device, mode: Mode) -> Result<(), String> {
    let Mode { ascii, settings } = mode;
    let model = device.model.clone();
    let line = &model.line;
    let baud = code(&line.baud, |baud| *baud == settings.baud).ok_or_else(|| {
        let known: Vec<_> = line.baud.codes.values().map(u32::to_string).collect();
        format!("{} can't do {} baud; it can do {}", model.name, settings.baud, known.join(", "))
    })?;
    let format = code(&line.format, |it| it.ascii == ascii && it.format == settings.format);
    let format = format.ok_or_else(|| {
        let text = |it: &crate::model::WireFormat| {
            format!("{}{}", if it.ascii { "ASCII " } else { "" }, it.format)
        };
        let known: Vec<_> = line.format.codes.values().map(text).collect();
        if ascii && !line.format.codes.values().any(|it| it.ascii) {
            return format!("{} can't do ASCII; it talks RTU only", model.name);
        }
        let kind = if ascii { "ASCII" } else { "RTU" };
        let (name, format) = (&model.name, settings.format);
        format!("{name} can't do {kind} {format}; it can do {}", known.join(", "))
    })?;
    for setup in &mut device.setups {
        agrees(&model, setup, line.baud.row, line.baud.digit, baud, mode)?;
        agrees(&model, setup, line.format.row, line.format.digit, format, mode)?;
        put(&model, setup, line.baud.row, line.baud.digit, baud);
        put(&model, setup, line.format.row, line.format.digit, format);
    }
    Ok(())
}

fn code<T>(coded: &Coded<T>, fits: impl Fn(&T) -> bool) -> Option<i64> {
    coded.codes.iter().find(|(_, meaning)| fits(meaning)).map(|(code, _)| *code)
}

/// A start value that somebody gave must not say something else than the line.
fn agrees(
    model: &Model,
    setup: &Setup,
    row: RowId,
    digit: Option<u8>,
    code: i64,
    mode: Mode,
) -> Result<(), String> {
    let given = setup.values.iter().rev().find(|(id, _)| *id == row);
    let Some((_, raw)) = given else { return Ok(()) };
    let value = model.map.row(row).kind.value(*raw);
    if digit.map_or(value, |digit| value >> (4 * digit) & 0xF) == code {
        return Ok(());
    }
    let label = model.map.row(row).label();
    Err(format!("{label} = {value} does not go with a line at {mode}"))
}

/// Puts `code` into the row, or into the digit of it, leaving its other digits as they are.
fn put(model: &Model, setup: &mut Setup, row: RowId, digit: Option<u8>, code: i64) {
    let value = |(id, raw): &(RowId, u32)| (*id == row).then_some(*raw);
    let of_station = &model.stations[setup.station].init;
    let present = setup.values.iter().rev().find_map(value);
    let present = present.or_else(|| of_station.iter().find_map(value));
    let present = present.unwrap_or(model.map.row(row).init);
    let raw = match digit {
        None => model.map.row(row).kind.raw(code),
        Some(digit) => present & !(0xF << (4 * digit)) | (code as u32) << (4 * digit),
    };
    setup.values.push((row, raw));
}
