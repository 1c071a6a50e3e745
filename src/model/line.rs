//! How a drive talks, compiled: functions, limits, word order, the ladder of refusals.

use super::raw::{
    RawFormat, RawLengthCheck, RawLine, RawLongAccess, RawUnlistedReads, RawWordOrder,
    RawWriteOnlyReads,
};
use super::rows::{Compiled, order};
use super::{Access, RowId, duration};
use crate::problem::{Path, Problem, suggest};
use crate::serial::{Format, Mode};
use crate::time::Duration;
use crate::vocabulary::{Cause, Named};
use crate::wire::LengthCheck;
use crate::wire::function::{READ, WRITE_MANY, WRITE_ONE};
use std::collections::BTreeMap;

/// What a drive may take to reply.
const LONGEST_REPLY: Duration = Duration::from_secs(10);

/// How a drive talks.
#[derive(Debug)]
pub struct LineRules {
    /// Function codes that it knows.
    pub functions: Vec<u8>,
    /// Where its unit address comes from.
    pub unit: UnitRule,
    /// Where its baud rate comes from.
    pub baud: Coded<u32>,
    /// Number of DIP switches above those of the address that hold the code of the baud rate; 0 where its row does.
    pub baud_switches: u8,
    /// Where framing and character format come from.
    pub format: Coded<WireFormat>,
    /// Characters of silence that end an RTU frame.
    pub silence: f64,
    /// From the end of that silence to the beginning of a reply, where replies are paced.
    pub reply_after: Duration,
    /// Most registers in one read.
    pub max_read: u16,
    /// Most registers in one write.
    pub max_write: u16,
    /// Exception code that answers a wrong CRC; `None` is silence.
    pub crc_error: Option<u8>,
    /// How far the lengths in a 0x10 request must agree.
    pub length_check: LengthCheck,
    /// Which word of a pair stands first.
    pub word_order: WordOrder,
    /// May a request touch one word of a pair alone?
    pub long_access: LongAccess,
    /// Does reading a write-only row give 0 (or is it refused)?
    pub write_only_reads_zero: bool,
    /// Does reading an address without a row give 0 (or is it refused)?
    pub unlisted_reads_zero: bool,
    /// Causes and their codes, first one first.
    pub refuse: Refuse,
}

impl LineRules {
    /// From the end of a request to the beginning of its reply in `mode`. CR LF ends an ASCII frame, so there
    /// the drive waits for no silence.
    pub fn turnaround(&self, mode: Mode) -> Duration {
        match mode.ascii {
            true => self.reply_after,
            false => mode.settings.silence(self.silence) + self.reply_after,
        }
    }
}

/// Where the unit address comes from.
#[derive(Debug)]
pub struct UnitRule {
    /// The row.
    pub row: RowId,
    /// Number of DIP switches; 0 without any.
    pub switches: u8,
    /// The address when switches and row say 0.
    pub zero: u8,
}

/// A row, or one hex digit of it, whose values are codes for something.
#[derive(Debug)]
pub struct Coded<T> {
    /// The row.
    pub row: RowId,
    /// Which hex digit from the right; `None` is the whole value.
    pub digit: Option<u8>,
    /// Meaning by code.
    pub codes: BTreeMap<i64, T>,
}

impl<T: Copy> Coded<T> {
    /// What `value` of the row stands for, if anything.
    pub fn decode(&self, value: i64) -> Option<T> {
        self.codes.get(&self.code_in(value)).copied()
    }

    /// The code in `value` of the row: the whole of it, or one digit.
    pub fn code_in(&self, value: i64) -> i64 {
        code_in(value, self.digit)
    }
}

/// The code in `value`: the whole of it, or one hex digit.
pub(super) fn code_in(value: i64, digit: Option<u8>) -> i64 {
    digit.map_or(value, |digit| value >> (4 * digit) & 0xF)
}

/// Framing and character format.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct WireFormat {
    /// ASCII instead of RTU.
    pub ascii: bool,
    /// The shape of a character.
    pub format: Format,
}

/// Which word of a pair stands at the lower address.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum RegisterOrder {
    /// The high one.
    HighFirst,
    /// The low one.
    LowFirst,
}

/// Word order: fixed, or as a row says.
#[derive(Debug)]
pub enum WordOrder {
    /// Always the same.
    Fixed(RegisterOrder),
    /// By value of a row.
    Row {
        /// The row.
        row: RowId,
        /// Register order by value.
        codes: BTreeMap<i64, RegisterOrder>,
    },
}

/// May a request touch one word of a pair alone?
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum LongAccess {
    /// Yes.
    Any,
    /// No.
    Whole,
}

/// The ladder of refusals: causes in the order in which they answer, each with its code.
#[derive(Debug)]
pub struct Refuse(Vec<(Cause, u8)>);

impl Refuse {
    /// Causes and codes, first one first.
    pub fn ladder(&self) -> impl Iterator<Item = (Cause, u8)> + '_ {
        self.0.iter().copied()
    }

    /// The code that `cause` answers with, if the ladder has it.
    pub fn code(&self, cause: Cause) -> Option<u8> {
        self.0.iter().find(|(it, _)| *it == cause).map(|(_, code)| *code)
    }
}

pub(super) fn compile(
    raw: &RawLine,
    rows: &Compiled,
    problems: &mut Vec<Problem>,
) -> Option<LineRules> {
    let path = Path::root().key("line");
    if raw.functions.is_empty() {
        let what = "a drive needs at least one function code";
        problems.push(
            Problem::value(path.key("functions"), what)
                .advise("list those of 0x03, 0x06 and 0x10 that it supports"),
        );
    }
    for (i, function) in raw.functions.iter().enumerate() {
        if ![READ, WRITE_ONE, WRITE_MANY].contains(function) {
            let what = format!("function code 0x{function:02X} is not supported");
            let path = path.key("functions").index(i);
            problems.push(Problem::value(path, what).advise("supported: 0x03, 0x06, 0x10"));
        }
    }
    within(raw.max_read, 1..=125, &path.key("max_read"), problems);
    within(raw.max_write, 1..=123, &path.key("max_write"), problems);
    if !(1.5..=100.0).contains(&raw.silence) {
        let what = format!("`silence` must be between 1.5 and 100 characters, not {}", raw.silence);
        problems.push(Problem::value(path.key("silence"), what));
    }
    let reply_after = raw.reply_after.as_deref();
    let reply_after = reply_after.and_then(|it| duration(it, &path.key("reply_after"), problems));
    if reply_after.is_some_and(|it| it > LONGEST_REPLY) {
        let what = "`reply_after` must be at most 10 s";
        problems.push(Problem::value(path.key("reply_after"), what));
    }
    if raw.crc_error.is_some_and(|code| code == 0 || code > 0x7F) {
        let what = "an exception code must be between 0x01 and 0x7F";
        problems.push(Problem::value(path.key("crc_error"), what).advise("use null for no reply"));
    }
    let unit_path = path.key("unit");
    if raw.unit.switches.is_some_and(|count| !(1..=8).contains(&count)) {
        let what = "`switches` must be between 1 and 8";
        problems.push(Problem::value(unit_path.key("switches"), what));
    }
    let unit = rows.find(&raw.unit.register, &unit_path.key("register"), problems);
    if let Some(row) = unit.map(|id| rows.map.row(id)).filter(|row| !row.admits(0))
        && raw.unit.zero != 0
    {
        let what = format!("`zero` has no effect: {} is never 0", row.id);
        problems.push(Problem::key(unit_path.key("zero"), what).advise("remove it"));
    }
    let baud_path = path.key("baud");
    if let Some(code) = raw.baud.codes.iter().find(|(_, baud)| !(50..=4_000_000).contains(*baud)) {
        let what = format!("{} is not a baud rate", code.1);
        problems.push(Problem::value(baud_path.key("codes").key(code.0), what));
    }
    let baud = rows.find(&raw.baud.register, &baud_path.key("register"), problems);
    coded(baud, raw.baud.digit, &raw.baud.codes, rows, &baud_path, problems);
    let baud_switches = raw.baud.switches.unwrap_or(0);
    baud_switches_fit(raw, &baud_path, problems);
    let word_order = word_order(&raw.word_order, rows, &path.key("word_order"), problems);
    let format = format(&raw.format, rows, &path.key("format"), problems);
    let refuse = refuse(raw, rows, &path.key("refuse"), problems);
    let unit =
        UnitRule { row: unit?, switches: raw.unit.switches.unwrap_or(0), zero: raw.unit.zero };
    Some(LineRules {
        functions: raw.functions.clone(),
        unit,
        baud: Coded { row: baud?, digit: raw.baud.digit, codes: raw.baud.codes.clone() },
        baud_switches,
        format: format?,
        silence: raw.silence,
        reply_after: reply_after.unwrap_or_default(),
        max_read: raw.max_read,
        max_write: raw.max_write,
        crc_error: raw.crc_error,
        length_check: match raw.length_check {
            RawLengthCheck::Strict => LengthCheck::Strict,
            RawLengthCheck::CountOnly => LengthCheck::CountOnly,
        },
        word_order: word_order?,
        long_access: match raw.long_access {
            RawLongAccess::Any => LongAccess::Any,
            RawLongAccess::Whole => LongAccess::Whole,
        },
        write_only_reads_zero: raw.write_only_reads == RawWriteOnlyReads::Zero,
        unlisted_reads_zero: raw.unlisted_reads == RawUnlistedReads::Zero,
        refuse,
    })
}

/// Is there room for the switches, and a code for each way to set them?
fn baud_switches_fit(raw: &RawLine, path: &Path, problems: &mut Vec<Problem>) {
    let Some(count) = raw.baud.switches else { return };
    let room = 8u8.saturating_sub(raw.unit.switches.unwrap_or(0));
    if !(1..=room).contains(&count) {
        let what = "address and baud rate switches together must be between 1 and 8";
        problems.push(Problem::value(path.key("switches"), what));
    } else if let Some(code) = (0..1i64 << count).find(|code| !raw.baud.codes.contains_key(code)) {
        let what = format!("{count} switches can be set to {code}, which is not in `codes`");
        problems.push(Problem::value(path.key("codes"), what));
    }
}

fn within(
    value: u16,
    allowed: std::ops::RangeInclusive<u16>,
    path: &Path,
    problems: &mut Vec<Problem>,
) {
    if !allowed.contains(&value) {
        let what =
            format!("must be between {} and {}, not {value}", allowed.start(), allowed.end());
        problems.push(Problem::value(path.clone(), what).advise("a frame cannot hold more"));
    }
}

/// Is there such a hex digit in a word?
pub(super) fn has_digit(digit: Option<u8>, path: &Path, problems: &mut Vec<Problem>) -> bool {
    let is_there = digit.is_none_or(|digit| digit <= 3);
    if !is_there {
        let what = "a word has hex digits 0 to 3, counted from the right";
        problems.push(Problem::value(path.key("digit"), what));
    }
    is_there
}

/// Does each code have a value of the row, or of one hex digit of it, and the factory value a code?
pub(super) fn coded<T>(
    row: Option<RowId>,
    digit: Option<u8>,
    codes: &BTreeMap<i64, T>,
    rows: &Compiled,
    path: &Path,
    problems: &mut Vec<Problem>,
) {
    if !has_digit(digit, path, problems) {
        return;
    }
    let Some(row) = row.map(|row| rows.map.row(row)) else { return };
    let of = |value| code_in(value, digit);
    let holds = |code: i64| match digit {
        None => row.admits(code),
        Some(_) => {
            let words = |(low, high): &(i64, i64)| (*low.max(&0))..=(*high.min(&0xFFFF));
            row.spans.iter().flat_map(words).any(|value| of(value) == code)
        }
    };
    for code in codes.keys().filter(|code| !holds(**code)) {
        let what = format!("{} is never {code}", row.id);
        problems.push(Problem::key(path.key("codes").key(code), what));
    }
    let init = of(row.kind.value(row.init));
    if row.admits(row.kind.value(row.init)) && !codes.contains_key(&init) {
        let what = format!("the factory value of {}, {init}, is not in `codes`", row.id);
        problems.push(Problem::key(path.key("codes"), what));
    }
}

fn format(
    raw: &RawFormat,
    rows: &Compiled,
    path: &Path,
    problems: &mut Vec<Problem>,
) -> Option<Coded<WireFormat>> {
    let row = rows.find(&raw.register, &path.key("register"), problems);
    coded(row, raw.digit, &raw.codes, rows, path, problems);
    let mut codes = BTreeMap::new();
    for (code, text) in &raw.codes {
        let (ascii, shape) = match text.strip_prefix("ascii ") {
            Some(shape) => (true, shape),
            None => (false, text.as_str()),
        };
        let path = path.key("codes").key(code);
        match shape.parse::<Format>() {
            Ok(format) if !ascii && format.data_bits == 7 => {
                let what = "RTU needs 8 data bits";
                problems.push(Problem::value(path, what).advise("write `ascii 7E1` for ASCII"));
            }
            Ok(format) => {
                codes.insert(*code, WireFormat { ascii, format });
            }
            Err(what) => problems.push(Problem::value(path, what)),
        }
    }
    Some(Coded { row: row?, digit: raw.digit, codes })
}

fn word_order(
    raw: &RawWordOrder,
    rows: &Compiled,
    path: &Path,
    problems: &mut Vec<Problem>,
) -> Option<WordOrder> {
    Some(match raw {
        RawWordOrder::Fixed(fixed) => WordOrder::Fixed(order(*fixed)),
        RawWordOrder::Register { register, codes } => {
            let row = rows.find(register, &path.key("register"), problems)?;
            coded(Some(row), None, codes, rows, path, problems);
            let codes = codes.iter().map(|(value, raw)| (*value, order(*raw))).collect();
            WordOrder::Row { row, codes }
        }
    })
}

fn refuse(raw: &RawLine, rows: &Compiled, path: &Path, problems: &mut Vec<Problem>) -> Refuse {
    let mut ladder: Vec<(Cause, u8)> = Vec::new();
    let mut meant: Vec<Cause> = Vec::new();
    for (i, rung) in raw.refuse.iter().enumerate() {
        let path = path.index(i);
        if rung.len() != 1 {
            let what = "one cause per entry: their order matters";
            problems.push(Problem::value(path.clone(), what).advise("- {function: 0x01}"));
        }
        for (name, code) in rung {
            let path = path.key(name);
            let Some(cause) = Cause::parse(name) else {
                let causes = || Cause::ALL.iter().map(|cause| cause.name());
                meant.extend(suggest::nearest(name, causes()).and_then(Cause::parse));
                let advice = suggest::did_you_mean(name, causes());
                let what = format!("unknown refusal cause `{name}`");
                problems.push(Problem::key(path, what).advise_if(advice));
                continue;
            };
            if *code == 0 || *code > 0x7F {
                let what = "an exception code must be between 0x01 and 0x7F";
                problems.push(Problem::value(path.clone(), what));
            }
            if ladder.iter().any(|(it, _)| *it == cause) {
                problems.push(Problem::key(path, "duplicate cause"));
                continue;
            }
            ladder.push((cause, *code));
        }
    }
    let listed: Vec<Cause> = ladder.iter().map(|(cause, _)| *cause).chain(meant).collect();
    for cause in raisable(raw, rows).into_iter().filter(|cause| !listed.contains(cause)) {
        let what =
            format!("the drive can refuse for `{}`, which has no exception code", cause.name());
        let advice = format!("add `- {{{}: CODE}}`: {}", cause.name(), cause.about());
        problems.push(Problem::key(path.clone(), what).advise(advice));
    }
    Refuse(ladder)
}

/// The causes that a request can meet on this model.
fn raisable(raw: &RawLine, rows: &Compiled) -> Vec<Cause> {
    let any = |test: fn(&super::Row) -> bool| rows.map.rows().any(|(_, row)| test(row));
    let mut causes = vec![Cause::Function, Cause::Length, Cause::Quantity, Cause::Address];
    if raw.long_access == RawLongAccess::Whole && any(|row| row.kind.words() == 2) {
        causes.push(Cause::SplitLong);
    }
    if any(|row| row.access == Access::Read) {
        causes.push(Cause::ReadOnly);
    }
    if raw.write_only_reads == RawWriteOnlyReads::Refused && any(|row| row.access == Access::Write)
    {
        causes.push(Cause::WriteOnly);
    }
    if any(|row| row.access != Access::Read && row.spans != [row.kind.limits()]) {
        causes.push(Cause::Range);
    }
    if any(|row| row.locked_while_enabled) {
        causes.push(Cause::State);
    }
    causes
}
