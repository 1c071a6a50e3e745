//! What a drive shows in each situation: one table a model, `tests/status/<model>.txt`, out of the manual.
//!
//! A table's columns are situations, each the steps of a transcript from a drive that is ready; its rows are bits and numbers,
//! read over the wire. `.` is not looked at. Of a row with bits all sixteen are: those that the table has not are 0. Behind `by` stands a
//! setting with its value: it is written before such a row is read, in the order of the table and after the others.

use crate::expect::{files, read};
use crate::kit::{Files, MODELS};
use drivemu::bench::Library;
use drivemu::model::{Model, RegisterOrder, RowId, WordOrder};
use drivemu::testkit::transcript::{self, Script};
use drivemu::units::parse_integer;
use std::collections::BTreeMap;
use std::fmt::Write as _;

/// A file, read.
#[derive(Default)]
struct Table {
    /// The lines of a transcript that set the drive up.
    setup: String,
    /// Steps by name of the situation, with those of the one that it follows.
    situations: BTreeMap<String, String>,
    /// The situations in order of the columns.
    columns: Vec<String>,
    rows: Vec<Line>,
}

/// A row of a table: what is read, and what it shows in each situation.
struct Line {
    register: String,
    bit: Option<u8>,
    by: Option<(String, i64)>,
    cells: Vec<String>,
}

/// What a register shows, once a setting has been written where it needs one.
struct Shown<'a> {
    register: &'a str,
    by: Option<&'a (String, i64)>,
    value: i64,
}

#[test]
fn each_table_is_true() {
    let mut failures = Vec::new();
    let mut models = Vec::new();
    for path in files("tests/status", "txt") {
        let name = path.file_stem().expect("a file").to_string_lossy().into_owned();
        let table = Table::parse(&read(&path)).unwrap_or_else(|what| panic!("{name}: {what}"));
        let script = Script::parse(&table.setup).unwrap_or_else(|it| panic!("{name}: {it}"));
        let drive = &script.drives[0];
        let model = Files.model(&drive.model, &drive.options).expect("a model");
        for (column, situation) in table.columns.iter().enumerate() {
            let failed = table.check(&model, column, situation).err();
            failures.extend(failed.map(|what| format!("{name}, {situation}: {what}")));
        }
        models.push(name);
    }
    assert!(failures.is_empty(), "{} failed\n\n{}", failures.len(), failures.join("\n\n"));
    assert_eq!(models, MODELS);
}

impl Table {
    fn parse(text: &str) -> Result<Self, String> {
        let mut table = Self::default();
        let mut situation: Option<String> = None;
        for line in text.lines() {
            let line = line.split('#').next().unwrap_or_default().trim();
            if line.is_empty() {
                continue;
            }
            if line.contains('|') {
                table.row(line)?;
            } else if let Some(rest) = line.strip_prefix("situation ") {
                let (name, after) = rest.split_once(" after ").unwrap_or((rest, ""));
                let steps = match after {
                    "" => String::new(),
                    after => table.situations.get(after).ok_or(format!("no {after}"))?.clone(),
                };
                table.situations.insert(name.into(), steps);
                situation = Some(name.into());
            } else if let Some(name) = &situation {
                writeln!(table.situations.entry(name.clone()).or_default(), "{line}")
                    .expect("a string");
            } else {
                writeln!(table.setup, "{line}").expect("a string");
            }
        }
        Ok(table)
    }

    fn row(&mut self, line: &str) -> Result<(), String> {
        let mut cells = line.split('|').map(|cell| cell.trim().to_owned());
        let (name, place) = (cells.next().unwrap_or_default(), cells.next().unwrap_or_default());
        let cells: Vec<_> = cells.collect();
        if self.columns.is_empty() {
            let unknown = cells.iter().find(|it| !self.situations.contains_key(*it));
            self.columns.clone_from(&cells);
            return unknown.map_or(Ok(()), |it| Err(format!("no situation `{it}`")));
        }
        if cells.len() != self.columns.len() {
            return Err(format!("{name}: {} cells, not {}", cells.len(), self.columns.len()));
        }
        let (place, by) = place.split_once(" by ").unwrap_or((&place, ""));
        let by = match by.split_once(' ') {
            None => None,
            Some((row, value)) => Some((row.to_owned(), parse_integer(value).ok_or("no value")?)),
        };
        let (register, bit) = match place.split_once(" bit ") {
            Some((register, bit)) => (register, Some(bit.parse().map_err(|_| "no bit")?)),
            None => (place, None),
        };
        self.rows.push(Line { register: register.into(), bit, by, cells });
        Ok(())
    }

    /// Plays a situation, reads every register of the table, and holds them against column `column`.
    fn check(&self, model: &Model, column: usize, situation: &str) -> Result<(), String> {
        let mut text = format!("{}\n{}", self.setup, self.situations[situation]);
        let mut registers: BTreeMap<usize, &str> = BTreeMap::new();
        for Shown { register, by, value } in self.values(column)? {
            let find =
                |name: &str| model.map.find(name).ok_or(format!("unknown register `{name}`"));
            if let Some((setting, value)) = by {
                let at = model.map.row(find(setting)?).at;
                write!(text, "\n> 06 {at:04X} {value:04X}").expect("a string");
            }
            let row = find(register)?;
            registers.insert(text.lines().count() + 2, register);
            let at = model.map.row(row).at;
            let words = words(model, row, value);
            let count = words.len();
            let hex: String = words.iter().map(|word| format!(" {word:04X}")).collect();
            write!(text, "\n> 03 {at:04X} {count:04X}\n< 03 {:02X}{hex}", 2 * count)
                .expect("a string");
        }
        let played = transcript::run(&text, &Files).map_err(|failure| {
            let register = registers.get(&failure.line).or(registers.get(&(failure.line - 1)));
            format!("{}: {}", register.unwrap_or(&"its steps"), failure.what)
        });
        played.map(|_| ())
    }

    /// What each register shows in a column, in the order of the table, those that need a setting last.
    fn values(&self, column: usize) -> Result<Vec<Shown<'_>>, String> {
        let mut values: Vec<Shown<'_>> = Vec::new();
        for Line { register, bit, by, cells } in &self.rows {
            let cell = &cells[column];
            if cell == "." {
                continue;
            }
            let number = parse_integer(cell).ok_or(format!("no number `{cell}`"))?;
            let (by, value) = (by.as_ref(), number << bit.unwrap_or(0));
            let same = |it: &&mut Shown<'_>| it.register == register && it.by.or(by).is_none();
            match values.iter_mut().find(same) {
                Some(word) => word.value |= value,
                None => values.push(Shown { register, by, value }),
            }
        }
        values.sort_by_key(|it| it.by.is_some());
        Ok(values)
    }
}

/// The words of a row that shows `value`, by address.
fn words(model: &Model, row: RowId, value: i64) -> Vec<u16> {
    let kind = model.map.row(row).kind;
    let raw = kind.wrapped(value);
    let low_first = matches!(model.line.word_order, WordOrder::Fixed(RegisterOrder::LowFirst));
    match (kind.words(), low_first) {
        (1, _) => vec![raw as u16],
        (_, true) => vec![raw as u16, (raw >> 16) as u16],
        (_, false) => vec![(raw >> 16) as u16, raw as u16],
    }
}
