//! The ladder of refusals: which cause answers when a request meets several, and that nothing has changed.
//!
//! A row of the tables beside this file is a request with the causes that it meets, the one that answers
//! first. That it meets the others too is shown by a copy of the model whose ladder puts them first.
//! `function` and `length` are different: a request that meets one of them has no registers to meet others with,
//! whatever their order, so the tables only show what they look like with each other cause in reach.

mod hcfa_x;
mod k_series;
mod yako;

use crate::kit::{last_refusal, rig, rig_of, text_of};
use drivemu::bench::DeviceSpec;
use drivemu::testkit::Rig;
use drivemu::vocabulary::{Cause, Named};
use std::collections::{BTreeMap, BTreeSet};

/// A request that is refused.
struct Row {
    /// The causes that it meets, in the order of the model's ladder.
    met: &'static [Cause],
    /// Unit, function, data.
    ask: &'static str,
    /// Function and code of the exception, as the manual or the protocol says.
    answer: &'static str,
}

/// A model, set up so that every cause can be met.
struct Table {
    model: &'static str,
    options: &'static [(&'static str, &'static str)],
    /// Input terminals with a signal.
    terminals: &'static [&'static str],
    rows: &'static [Row],
    /// Pairs of causes that no request meets together, and why.
    never: &'static [(&'static [Cause], &'static [Cause], &'static str)],
}

const TABLES: [Table; 4] = [hcfa_x::TABLE, k_series::TABLE, yako::CLOSED_LOOP, yako::OPEN_LOOP];

/// Causes that leave nothing of a request that another could be met with.
const GATES: [Cause; 2] = [Cause::Function, Cause::Length];

#[test]
fn the_first_cause_answers() {
    for table in &TABLES {
        let mut rig = table.rig(table.text());
        for row in table.rows {
            let (answer, cause) = ask(&mut rig, row);
            assert_eq!(
                answer,
                row.answer,
                "{}: {:?} {}\n{}",
                table.model,
                row.met,
                row.ask,
                rig.log()
            );
            assert_eq!(cause, row.met[0], "{}: {}", table.model, row.ask);
        }
    }
}

#[test]
fn each_cause_that_a_row_names_is_met() {
    for table in &TABLES {
        // Rows that need the same ladder share a drive: a refused request leaves it as it was.
        let mut ladders: BTreeMap<_, Vec<_>> = BTreeMap::new();
        for (row, first, second) in table.pairs().filter(|(_, first, _)| !GATES.contains(first)) {
            let others = row.met.iter().filter(|it| ![first, second].contains(it)).copied();
            let others: Vec<_> = others.collect();
            ladders.entry((vec![], others.clone())).or_default().push((row, first));
            ladders.entry((vec![second], others)).or_default().push((row, second));
        }
        for ((top, bottom), rows) in ladders {
            let mut rig = table.rig(&reordered(table.text(), &top, &bottom));
            for (row, want) in rows {
                let (_, cause) = ask(&mut rig, row);
                assert_eq!(cause, want, "{}: {} with {top:?} first", table.model, row.ask);
            }
        }
    }
}

#[test]
fn each_cause_and_each_pair_is_in_a_table() {
    for table in &TABLES {
        let ladder = table.ladder();
        let alone = |cause: Cause| table.rows.iter().any(|row| row.met == [cause]);
        let paired: BTreeSet<_> = table.pairs().map(|(_, first, second)| (first, second)).collect();
        for (i, first) in ladder.iter().enumerate() {
            let model = table.model;
            assert!(alone(*first) != table.excused(*first, *first), "{model}: {first:?} alone");
            for second in &ladder[i + 1..] {
                let (pair, excused) =
                    (paired.contains(&(*first, *second)), table.excused(*first, *second));
                assert!(pair != excused, "{model}: {first:?} and {second:?}");
            }
        }
        for (first, second) in paired {
            let place = |cause| ladder.iter().position(|it| *it == cause).expect("a rung");
            assert!(place(first) < place(second), "{}: {first:?} {second:?}", table.model);
        }
    }
}

#[test]
fn a_refused_request_changes_nothing() {
    for table in &TABLES {
        let mut rig = table.rig(table.text());
        let before = rig.drive().bank().clone();
        for row in table.rows {
            let events = rig.events().len();
            ask(&mut rig, row);
            assert!(rig.drive().bank() == &before, "{}: {}", table.model, row.ask);
            // One event: the refusal. No signal moved, no word was refreshed.
            assert_eq!(rig.events().len() - events, 1, "{}", rig.log());
        }
    }
}

/// The last of many registers is wrong; the good ones before it stay as they were.
#[test]
fn a_refused_0x10_writes_none_of_its_registers() {
    let cases = [
        ("hcfa-x", "01 10 085C 0003 06 0001 0001 0000", "P08.92"),
        ("hcfa-x", "01 10 0905 0007 0E 0001 0001 0001 0001 0001 0001 003D", "P09.05"),
        ("yako-closed-loop", "01 10 0020 0004 08 0001 0001 0001 FFFF", "start_speed"),
        (
            "yako-open-loop",
            "01 10 0060 0010 20 0000 0001 0001 0001 0001 0001 \
          0000 0001 0001 0001 0001 0001 0000 0001 0001 FFFF",
            "segment1_target",
        ),
        ("k-series", "01 10 05F5 0008 10 0001 0001 0001 0001 0001 0001 0001 FFFF", "acceleration"),
    ];
    for (model, request, first) in cases {
        let options: &[_] = if model == "k-series" { &[("fc10", "on")] } else { &[] };
        let mut rig = rig(model, options, &DeviceSpec::default());
        let before = rig.drive().bank().clone();
        let refused = rig.ask(request);
        assert!(refused.starts_with("01 90"), "{model}: {refused}");
        assert!(rig.drive().bank() == &before, "{model}: {request}");
        // The same with a last register that is well writes them all.
        let (head, _) = request.rsplit_once(' ').expect("more than a word");
        assert_eq!(
            rig.ask(&format!("{head} 0001")).replace(' ', ""),
            request.replace(' ', "")[..12]
        );
        assert!(rig.drive().bank() != &before, "{model}");
        let row = rig.drive().model().map.find(first).expect("a row");
        assert_eq!(rig.drive().bank().value(rig.drive().model(), row), 1, "{model}: {first}");
    }
}

impl Table {
    fn text(&self) -> &'static str {
        text_of(self.model)
    }

    fn rig(&self, text: &str) -> Rig {
        let terminals = self.terminals.iter().map(|it| (*it).to_owned()).collect();
        rig_of(text, self.options, &DeviceSpec { terminals, ..DeviceSpec::default() })
    }

    fn ladder(&self) -> Vec<Cause> {
        let rig = self.rig(self.text());
        rig.drive().model().line.refuse.ladder().map(|(cause, _)| cause).collect()
    }

    /// Every two causes that a row names, in its order.
    fn pairs(&self) -> impl Iterator<Item = (&'static Row, Cause, Cause)> {
        self.rows.iter().flat_map(|row| {
            let behind =
                move |i: usize| row.met[i + 1..].iter().map(move |it| (row, row.met[i], *it));
            (0..row.met.len()).flat_map(behind)
        })
    }

    fn excused(&self, first: Cause, second: Cause) -> bool {
        self.never.iter().any(|(some, others, _)| {
            let both = |a, b| some.contains(&a) && others.contains(&b);
            both(first, second) || both(second, first)
        })
    }
}

/// Sends a row's request: the answer without its unit, and the cause.
fn ask(rig: &mut Rig, row: &Row) -> (String, Cause) {
    let answer = rig.ask(row.ask);
    let refusal = last_refusal(rig).unwrap_or_else(|| panic!("{} was not refused", row.ask));
    (answer.get(3..).unwrap_or_default().to_owned(), refusal.cause)
}

/// The model's text with the rungs of `top` at the top of its ladder and those of `bottom` below all others.
fn reordered(text: &str, top: &[Cause], bottom: &[Cause]) -> String {
    let lines: Vec<&str> = text.lines().collect();
    let start = lines.iter().position(|it| it.starts_with("  refuse:")).expect("a ladder") + 1;
    let len = lines[start..].iter().take_while(|it| it.starts_with("    - {")).count();
    let (rungs, behind) = lines[start..].split_at(len);
    let of = |cause: &Cause| {
        let head = format!("    - {{{}:", cause.name());
        *rungs.iter().find(|it| it.starts_with(&head)).expect("a rung")
    };
    let top: Vec<_> = top.iter().map(of).collect();
    let bottom: Vec<_> = bottom.iter().map(of).collect();
    let middle = rungs.iter().filter(|it| !top.contains(it) && !bottom.contains(it)).copied();
    let rungs = top.iter().copied().chain(middle).chain(bottom.iter().copied());
    let lines = lines[..start].iter().copied().chain(rungs).chain(behind.iter().copied());
    lines.collect::<Vec<_>>().join("\n")
}
