//! HCFA X: the guide prints no codes, so these are the protocol's.

use super::{Row, Table};
use drivemu::vocabulary::Cause::{
    Address, Function, Length, Quantity, Range, ReadOnly, SplitLong, State,
};

pub const TABLE: Table = Table {
    model: "hcfa-x",
    options: &[("run_lock", "at_stop_rows"), ("read_limit", "16")],
    terminals: &["DI1"],
    rows: ROWS,
    never: &[
        (
            &[Quantity],
            &[ReadOnly, Range, State],
            "a frame has no room for more words than a write may carry, and none at all name no row",
        ),
        (&[ReadOnly], &[State], "no locked row within 123 words of one that can only be read"),
    ],
};

const ROWS: &[Row] = &[
    Row { met: &[Function], ask: "01 04 1501 0001", answer: "84 01" },
    Row { met: &[Length], ask: "01 10 0304 0001 04 0064 0064", answer: "90 03" },
    Row { met: &[Quantity], ask: "01 03 1501 0000", answer: "83 03" },
    Row { met: &[Address], ask: "01 03 0000 0001", answer: "83 02" },
    Row { met: &[Address], ask: "01 03 FFFF 0002", answer: "83 02" },
    Row { met: &[SplitLong], ask: "01 03 1507 0001", answer: "83 02" },
    Row { met: &[ReadOnly], ask: "01 06 1501 0001", answer: "86 02" },
    Row { met: &[Range], ask: "01 06 0900 0000", answer: "86 03" },
    Row { met: &[Range], ask: "01 06 E900 00F8", answer: "86 03" },
    Row { met: &[State], ask: "01 06 0858 0001", answer: "86 04" },
    Row { met: &[State], ask: "01 10 E859 0002 04 0001 0001", answer: "90 04" },
    // With the others in reach.
    Row { met: &[Function, Length], ask: "01 04 15", answer: "84 01" },
    Row { met: &[Function, Quantity], ask: "01 04 1501 0000", answer: "84 01" },
    Row { met: &[Function, Address], ask: "01 04 0000 0001", answer: "84 01" },
    Row { met: &[Function, SplitLong], ask: "01 04 1507 0001", answer: "84 01" },
    Row { met: &[Function, ReadOnly], ask: "01 05 1501 FF00", answer: "85 01" },
    Row { met: &[Function, Range], ask: "01 05 0900 FF00", answer: "85 01" },
    Row { met: &[Function, State], ask: "01 05 0858 FF00", answer: "85 01" },
    Row { met: &[Length, Quantity], ask: "01 10 0304 0000 02 0064", answer: "90 03" },
    Row { met: &[Length, Address], ask: "01 10 0000 0001 04 0001 0001", answer: "90 03" },
    Row { met: &[Length, SplitLong], ask: "01 10 0806 0001 04 0001 0001", answer: "90 03" },
    Row { met: &[Length, ReadOnly], ask: "01 10 1501 0001 04 0001 0001", answer: "90 03" },
    Row { met: &[Length, Range], ask: "01 10 0900 0001 04 0000 0000", answer: "90 03" },
    Row { met: &[Length, State], ask: "01 10 0858 0001 04 0001 0001", answer: "90 03" },
    Row { met: &[Quantity, Address], ask: "01 03 0401 0011", answer: "83 03" },
    Row { met: &[Quantity, Address, SplitLong], ask: "01 03 1508 0011", answer: "83 03" },
    Row { met: &[Address, SplitLong], ask: "01 03 1508 0002", answer: "83 02" },
    Row { met: &[Address, ReadOnly], ask: "01 10 1501 0002 04 0001 0001", answer: "90 02" },
    Row { met: &[Address, Range], ask: "01 10 0902 0002 04 0009 0001", answer: "90 02" },
    Row { met: &[Address, State], ask: "01 10 0857 0002 04 0001 0001", answer: "90 02" },
    Row { met: &[SplitLong, ReadOnly], ask: "01 06 1507 0001", answer: "86 02" },
    Row { met: &[SplitLong, Range], ask: "01 06 0861 7FFF", answer: "86 02" },
    Row {
        met: &[Address, SplitLong, State],
        ask: "01 10 085A 0007 0E 0001 0001 0001 0001 0001 0001 0001",
        answer: "90 02",
    },
    Row { met: &[ReadOnly, Range], ask: "01 06 1515 FFFF", answer: "86 02" },
    Row { met: &[Range, State], ask: "01 06 0858 0009", answer: "86 03" },
];
