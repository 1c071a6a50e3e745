//! YAKO: 3.4 prints codes of its own, and frames that fix their order.

use super::{Row, Table};
use drivemu::vocabulary::Cause::{
    self, Address, AddressBeyond, Function, Length, Quantity, Range, ReadOnly, WriteOnly,
};

pub const CLOSED_LOOP: Table =
    Table { model: "yako-closed-loop", options: &[], terminals: &[], rows: CLOSED, never: NEVER };

pub const OPEN_LOOP: Table =
    Table { model: "yako-open-loop", options: &[], terminals: &[], rows: OPEN, never: NEVER };

const NEVER: &[(&[Cause], &[Cause], &str)] = &[
    (
        &[WriteOnly],
        &[Function, Length, Quantity, AddressBeyond, Address, ReadOnly, WriteOnly, Range],
        "there is no row that can only be written",
    ),
    (
        &[AddressBeyond],
        &[ReadOnly],
        "rows that can only be read lie 123 words and more below the top",
    ),
];

macro_rules! rows {
    ($($own:expr,)*) => {
        &[
            Row { met: &[Function], ask: "01 02 0000 0004", answer: "82 02" },
            Row { met: &[Length], ask: "01 10 0020 0001 04 0064 0064", answer: "90 07" },
            Row { met: &[Quantity], ask: "01 03 0060 0011", answer: "83 05" },
            Row { met: &[Quantity], ask: "01 03 0060 0000", answer: "83 05" },
            Row { met: &[AddressBeyond], ask: "01 03 0140 0001", answer: "83 04" },
            Row { met: &[AddressBeyond], ask: "01 03 FFFF 0002", answer: "83 04" },
            Row { met: &[AddressBeyond], ask: "01 06 FF00 FFFF", answer: "86 04" },
            Row { met: &[Address], ask: "01 03 0004 0001", answer: "83 03" },
            Row { met: &[Address], ask: "01 06 0012 0000", answer: "86 03" },
            Row { met: &[ReadOnly], ask: "01 06 0000 0001", answer: "86 06" },
            Row { met: &[ReadOnly], ask: "01 10 000A 0002 04 0000 0000", answer: "90 06" },
            Row { met: &[Range], ask: "01 06 0020 FFFF", answer: "86 07" },
            // With the others in reach.
            Row { met: &[Function, Length], ask: "01 02 00", answer: "82 02" },
            Row { met: &[Function, Quantity], ask: "01 04 0060 0011", answer: "84 02" },
            Row { met: &[Function, AddressBeyond], ask: "01 04 FF00 0001", answer: "84 02" },
            Row { met: &[Function, Address], ask: "01 04 0004 0001", answer: "84 02" },
            Row { met: &[Function, ReadOnly], ask: "01 05 0000 FF00", answer: "85 02" },
            Row { met: &[Function, Range], ask: "01 05 0020 FF00", answer: "85 02" },
            Row { met: &[Length, Quantity], ask: "01 03 0060 0011 00", answer: "83 07" },
            Row { met: &[Length, AddressBeyond], ask: "01 10 FF00 0001 04 0000 0000", answer: "90 07" },
            Row { met: &[Length, Address], ask: "01 10 0012 0001 04 0000 0000", answer: "90 07" },
            Row { met: &[Length, ReadOnly], ask: "01 10 0000 0001 04 0000 0000", answer: "90 07" },
            Row { met: &[Length, Range], ask: "01 10 0020 0001 04 FFFF FFFF", answer: "90 07" },
            Row { met: &[Quantity, AddressBeyond], ask: "01 03 FF00 0020", answer: "83 05" },
            Row { met: &[Quantity, Address], ask: "01 03 0020 0020", answer: "83 05" },
            Row {
                met: &[Quantity, Address, ReadOnly],
                ask: "01 10 0000 0011 22 0000 0000 0000 0000 0000 0000 0000 0000 0000 \
                      0000 0000 0000 0000 0000 0000 0000 0000",
                answer: "90 05",
            },
            Row {
                met: &[Quantity, Range],
                ask: "01 10 0060 0011 22 0000 0000 FFFF 0000 0000 0000 0000 0000 0000 \
                      0000 0000 0000 0000 0000 0000 0000 0000",
                answer: "90 05",
            },
            Row { met: &[Quantity, AddressBeyond, Address], ask: "01 03 00F8 0060", answer: "83 05" },
            Row { met: &[Address, ReadOnly], ask: "01 10 000C 0002 04 0000 0000", answer: "90 03" },
            Row { met: &[Address, Range], ask: "01 10 0011 0002 04 0001 0000", answer: "90 03" },
            Row {
                met: &[Address, ReadOnly, Range],
                ask: "01 10 000C 0005 0A 0000 0000 0000 0000 0005",
                answer: "90 03",
            },
            $($own,)*
        ]
    };
}

const CLOSED: &[Row] = rows![
    Row { met: &[AddressBeyond], ask: "01 03 011A 0001", answer: "83 04" },
    Row {
        met: &[AddressBeyond, Range],
        ask: "01 10 010D 000E 1C 270F 0000 0000 0000 0000 0000 0000 0000 0000 0000 0000 0000 0000 0000",
        answer: "90 04",
    },
];

const OPEN: &[Row] = rows![
    Row { met: &[Address], ask: "01 03 003C 0001", answer: "83 03" },
    Row { met: &[AddressBeyond, Range], ask: "01 10 013F 0002 04 7FFF 0000", answer: "90 04" },
];
