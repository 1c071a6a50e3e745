//! K series: 6.3 prints the codes; the options let every cause be met.

use super::{Row, Table};
use drivemu::vocabulary::Cause::{Address, Function, Length, Quantity, Range, ReadOnly, WriteOnly};

pub const TABLE: Table = Table {
    model: "k-series",
    options: &[("fc10", "on"), ("wo_read", "exception_02")],
    terminals: &[],
    rows: ROWS,
    never: &[(&[WriteOnly], &[ReadOnly, Range], "met by reads, and these by writes")],
};

const ROWS: &[Row] = &[
    Row { met: &[Function], ask: "01 04 0000 0001", answer: "84 01" },
    Row { met: &[Length], ask: "01 03 0000", answer: "83 03" },
    Row { met: &[Length], ask: "01 06 0000 0001 00", answer: "86 03" },
    Row { met: &[Quantity], ask: "01 03 0000 0015", answer: "83 03" },
    Row { met: &[Quantity], ask: "01 03 0000 0000", answer: "83 03" },
    Row { met: &[Address], ask: "01 03 040A 0001", answer: "83 02" },
    Row { met: &[Address], ask: "01 06 FFFF 0001", answer: "86 02" },
    Row { met: &[ReadOnly], ask: "01 06 0420 0001", answer: "86 02" },
    Row { met: &[WriteOnly], ask: "01 03 0540 0001", answer: "83 02" },
    Row { met: &[Range], ask: "01 06 0064 0007", answer: "86 03" },
    // With the others in reach.
    Row { met: &[Function, Length], ask: "01 17 00", answer: "97 01" },
    Row { met: &[Function, Quantity], ask: "01 04 0000 0015", answer: "84 01" },
    Row { met: &[Function, Address], ask: "01 04 040A 0001", answer: "84 01" },
    Row { met: &[Function, ReadOnly], ask: "01 05 0420 FF00", answer: "85 01" },
    Row { met: &[Function, WriteOnly], ask: "01 04 0540 0001", answer: "84 01" },
    Row { met: &[Function, Range], ask: "01 05 0064 FF00", answer: "85 01" },
    Row { met: &[Length, Quantity], ask: "01 03 0000 0015 00", answer: "83 03" },
    Row { met: &[Length, Address], ask: "01 03 040A 0001 00", answer: "83 03" },
    Row { met: &[Length, ReadOnly], ask: "01 10 0420 0001 04 0001 0001", answer: "90 03" },
    Row { met: &[Length, WriteOnly], ask: "01 03 0540 0001 00", answer: "83 03" },
    Row { met: &[Length, Range], ask: "01 10 0064 0001 04 0007 0007", answer: "90 03" },
    Row { met: &[Quantity, Address], ask: "01 03 03F8 0015", answer: "83 03" },
    Row {
        met: &[Quantity, Address],
        ask: "01 10 FFF8 000D 1A 0000 0000 0000 0000 0000 0000 0000 0000 0000 0000 0000 0000 0000",
        answer: "90 03",
    },
    Row {
        met: &[Quantity, ReadOnly],
        ask: "01 10 0420 000D 1A 0000 0000 0000 0000 0000 0000 0000 0000 0000 0000 0000 0000 0000",
        answer: "90 03",
    },
    Row { met: &[Quantity, Address, WriteOnly], ask: "01 03 0530 0015", answer: "83 03" },
    Row {
        met: &[Quantity, Range],
        ask: "01 10 0064 000D 1A 0007 0000 0000 0000 0000 0000 0000 0000 0000 0000 0000 0000 0000",
        answer: "90 03",
    },
    Row { met: &[Address, ReadOnly], ask: "01 10 0413 0002 04 0001 0001", answer: "90 02" },
    Row { met: &[Address, WriteOnly], ask: "01 03 0540 0003", answer: "83 02" },
    Row {
        met: &[Address, Range],
        ask: "01 10 05FB 0005 0A 1B58 0001 0001 0001 0001",
        answer: "90 02",
    },
    Row {
        met: &[ReadOnly, Range],
        ask: "01 10 05F4 0008 10 0001 0001 0001 0001 0001 0001 0001 1B58",
        answer: "90 02",
    },
];
