//! How a drive talks: the section `line` resolved and checked.

use super::names::{Names, code_rules};
use super::rows::order;
use super::terminals::hold;
use super::uses::Uses;
use crate::model::raw::{
    RawBaud, RawFormat, RawLengthCheck, RawLine, RawLongAccess, RawUnit, RawUnlistedReads,
    RawWordOrder, RawWriteOnlyReads,
};
use crate::model::{
    Access, Coded, HoldTime, LineRules, LongAccess, Reaction, Refuse, Row, UnitRule, WireFormat,
    WordOrder,
};
use crate::problem::{At, Path, Problem, has_unread, suggest};
use crate::serial::Format;
use crate::time::Duration;
use crate::vocabulary::{Cause, Named};
use crate::wire::{LengthCheck, function};
use std::collections::BTreeMap;
use std::ops::RangeInclusive;

/// What a drive may take to reply.
const LONGEST_REPLY: Duration = Duration::from_secs(10);

fn path() -> Path {
    Path::root().key("line")
}

/// How the drive talks, unless the rows for that are missing.
pub(super) fn compile(raw: &RawLine, names: &mut Names) -> Option<LineRules> {
    let path = path();
    functions(raw, &path.key("functions"), names);
    within(raw.max_read, 1..=125, &path.key("max_read"), names);
    within(raw.max_write, 1..=123, &path.key("max_write"), names);
    if !(1.5..=100.0).contains(&raw.silence) {
        let what = format!("`silence` must be between 1.5 and 100 characters, not {}", raw.silence);
        names.report(Problem::value(path.key("silence"), what));
    }
    let reply_after = names.duration(raw.reply_after.as_deref(), &path.key("reply_after"));
    if reply_after.is_some_and(|it| it > LONGEST_REPLY) {
        let what = "`reply_after` must be at most 10 s";
        names.report(Problem::value(path.key("reply_after"), what));
    }
    if raw.crc_error.is_some_and(|code| code == 0 || code > 0x7F) {
        let what = "an exception code must be between 0x01 and 0x7F";
        names.report(Problem::value(path.key("crc_error"), what).advise("use null for no reply"));
    }
    let unit = unit(&raw.unit, &path.key("unit"), names);
    let baud = baud(raw, &path.key("baud"), names);
    let word_order = word_order(&raw.word_order, &path.key("word_order"), names);
    let format = format(&raw.format, &path.key("format"), names);
    let refuse = refuse(raw, &path.key("refuse"), names);
    Some(LineRules {
        functions: raw.functions.clone(),
        unit: unit?,
        baud: baud?,
        baud_switches: raw.baud.switches.unwrap_or(0),
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

/// A write to the rows of unit, speed and format changes how the drive is reached.
pub(super) fn reactions(raw: &RawLine, uses: &mut Uses, names: &mut Names) {
    let registers = [
        ("unit", &raw.unit.register),
        ("baud", &raw.baud.register),
        ("format", &raw.format.register),
    ];
    // Switches that hold the speed leave nothing to do for its row, nor for that of the format.
    let by_rows = if raw.baud.switches.is_some() { 1 } else { registers.len() };
    for (key, register) in registers.into_iter().take(by_rows) {
        // Rows that are not there were told of.
        if let Some((row, _)) = names.rows.map.rows().find(|(_, row)| row.id == *register) {
            let path = path().key(key).key("register");
            uses.react(row, Reaction::Line, &path, At::Value, names);
        }
    }
}

/// How long the master may be silent.
pub(super) fn timeout(raw: &RawLine, uses: &mut Uses, names: &mut Names) -> Option<HoldTime> {
    let path = path().key("timeout");
    let timeout = hold(raw.timeout.as_ref()?, &path, names)?;
    uses.react(timeout.row, Reaction::Timeout, &path.key("register"), At::Value, names);
    Some(timeout)
}

fn functions(raw: &RawLine, path: &Path, names: &mut Names) {
    let supported = function::ALL.map(|code| format!("0x{code:02X}")).join(", ");
    if raw.functions.is_empty() {
        let what = "a drive needs at least one function code";
        let problem = Problem::value(path.clone(), what);
        names.report(problem.advise(format!("supported: {supported}")));
    }
    for (i, code) in raw.functions.iter().enumerate() {
        if !function::ALL.contains(code) {
            let what = format!("function code 0x{code:02X} is not supported");
            let problem = Problem::value(path.index(i), what);
            names.report(problem.advise(format!("supported: {supported}")));
        }
    }
}

fn within(value: u16, allowed: RangeInclusive<u16>, path: &Path, names: &mut Names) {
    if !allowed.contains(&value) {
        let what =
            format!("must be between {} and {}, not {value}", allowed.start(), allowed.end());
        names.report(Problem::value(path.clone(), what).advise("a frame cannot hold more"));
    }
}

fn unit(raw: &RawUnit, path: &Path, names: &mut Names) -> Option<UnitRule> {
    if raw.switches.is_some_and(|count| !(1..=8).contains(&count)) {
        let what = "`switches` must be between 1 and 8";
        names.report(Problem::value(path.key("switches"), what));
    }
    let id = names.row(&raw.register, &path.key("register"))?;
    let row = names.get(id);
    if !row.admits(0) && raw.zero != 0 {
        let what = format!("`zero` has no effect: {} is never 0", row.id);
        names.report(Problem::key(path.key("zero"), what).advise("remove it"));
    }
    Some(UnitRule { row: id, switches: raw.switches.unwrap_or(0), zero: raw.zero })
}

fn baud(raw: &RawLine, path: &Path, names: &mut Names) -> Option<Coded<u32>> {
    let RawBaud { register, digit, codes, .. } = &raw.baud;
    if let Some(code) = codes.iter().find(|(_, baud)| !(50..=4_000_000).contains(*baud)) {
        let what = format!("{} is not a baud rate", code.1);
        names.report(Problem::value(path.key("codes").key(code.0), what));
    }
    let row = names.row(register, &path.key("register"));
    code_rules(row, *digit, codes, path, names);
    baud_switches(raw, path, names);
    Some(Coded { row: row?, digit: *digit, codes: codes.clone() })
}

/// There is room for the switches, and a code for each way to set them.
fn baud_switches(raw: &RawLine, path: &Path, names: &mut Names) {
    let Some(count) = raw.baud.switches else { return };
    let room = 8u8.saturating_sub(raw.unit.switches.unwrap_or(0));
    if !(1..=room).contains(&count) {
        let what = "address and baud rate switches together must be between 1 and 8";
        names.report(Problem::value(path.key("switches"), what));
    } else if let Some(code) = (0..1i64 << count).find(|code| !raw.baud.codes.contains_key(code)) {
        let what = format!("{count} switches can be set to {code}, which is not in `codes`");
        names.report(Problem::value(path.key("codes"), what));
    }
}

fn format(raw: &RawFormat, path: &Path, names: &mut Names) -> Option<Coded<WireFormat>> {
    let row = names.row(&raw.register, &path.key("register"));
    code_rules(row, raw.digit, &raw.codes, path, names);
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
                names.report(Problem::value(path, what).advise("write `ascii 7E1` for ASCII"));
            }
            Ok(format) => {
                codes.insert(*code, WireFormat { ascii, format });
            }
            Err(what) => names.report(Problem::value(path, what)),
        }
    }
    Some(Coded { row: row?, digit: raw.digit, codes })
}

fn word_order(raw: &RawWordOrder, path: &Path, names: &mut Names) -> Option<WordOrder> {
    Some(match raw {
        RawWordOrder::Fixed(fixed) => WordOrder::Fixed(order(*fixed)),
        RawWordOrder::Register { register, codes } => {
            let row = names.row(register, &path.key("register"))?;
            code_rules(Some(row), None, codes, path, names);
            let codes = codes.iter().map(|(value, raw)| (*value, order(*raw))).collect();
            WordOrder::Row { row, codes }
        }
    })
}

/// The ladder of refusals, with a rung for each cause that a request can meet.
fn refuse(raw: &RawLine, path: &Path, names: &mut Names) -> Refuse {
    let mut ladder: Vec<(Cause, u8)> = Vec::new();
    let mut meant: Vec<Cause> = Vec::new();
    for (i, rung) in raw.refuse.iter().enumerate() {
        let path = path.index(i);
        if has_unread(names.problems, &path) {
            continue;
        }
        if rung.len() != 1 {
            let what = "one cause per entry: their order matters";
            names.report(Problem::value(path.clone(), what).advise("- {function: 0x01}"));
        }
        for (name, code) in rung {
            let path = path.key(name);
            let Some(cause) = Cause::parse(name) else {
                let causes = || Cause::ALL.iter().map(|cause| cause.name());
                meant.extend(suggest::nearest(name, causes()).and_then(Cause::parse));
                let advice = suggest::did_you_mean(name, causes());
                let what = format!("unknown refusal cause `{name}`");
                names.report(Problem::key(path, what).advise_if(advice));
                continue;
            };
            if *code == 0 || *code > 0x7F {
                let what = "an exception code must be between 0x01 and 0x7F";
                names.report(Problem::value(path.clone(), what));
            }
            if ladder.iter().any(|(it, _)| *it == cause) {
                names.report(Problem::key(path, "duplicate cause"));
                continue;
            }
            ladder.push((cause, *code));
        }
    }
    let listed: Vec<Cause> = ladder.iter().map(|(cause, _)| *cause).chain(meant).collect();
    if has_unread(names.problems, path) {
        return Refuse::new(ladder);
    }
    for cause in possible_causes(raw, names).into_iter().filter(|cause| !listed.contains(cause)) {
        let what =
            format!("the drive can refuse for `{}`, which has no exception code", cause.name());
        let advice = format!("add `- {{{}: CODE}}`: {}", cause.name(), cause.about());
        names.report(Problem::key(path.clone(), what).advise(advice));
    }
    Refuse::new(ladder)
}

/// The causes that a request can meet on this model.
fn possible_causes(raw: &RawLine, names: &Names) -> Vec<Cause> {
    let any = |test: fn(&Row) -> bool| names.rows.map.rows().any(|(_, row)| test(row));
    let mut causes = vec![Cause::Function, Cause::Length, Cause::Quantity, Cause::Address];
    if raw.long_access == RawLongAccess::Whole && any(|row| row.kind.words() == 2) {
        causes.push(Cause::SplitLong);
    }
    if any(|row| row.access == Access::Read) {
        causes.push(Cause::ReadOnly);
    }
    let refused = raw.write_only_reads == RawWriteOnlyReads::Refused;
    if refused && any(|row| row.access == Access::Write) {
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
