//! The settings of a serial port, in the words of the library that sets them.
//!
//! Which settings a drive has, and when they change, is decided elsewhere.

use std::io;

use tokio_serial::{DataBits, Parity, SerialPort, SerialPortBuilder, SerialStream, StopBits};

use super::said;

/// Baud and format; no flow control, as on RS-485.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Tuning {
    baud: u32,
    data_bits: DataBits,
    parity: Parity,
    stop_bits: StopBits,
}

impl Tuning {
    /// Checks settings given as plain values: 7 or 8, `'N'`, `'E'` or `'O'`, 1 or 2.
    pub(super) fn new(baud: u32, data_bits: u8, parity: char, stop_bits: u8) -> io::Result<Self> {
        let none = |what: String| Err(said(io::ErrorKind::InvalidInput, what));
        let data_bits = match data_bits {
            7 => DataBits::Seven,
            8 => DataBits::Eight,
            _ => return none(format!("no such setting: {data_bits} data bits (7 or 8)")),
        };
        let parity = match parity {
            'N' => Parity::None,
            'E' => Parity::Even,
            'O' => Parity::Odd,
            _ => return none(format!("no such setting: parity {parity} (N, E or O)")),
        };
        let stop_bits = match stop_bits {
            1 => StopBits::One,
            2 => StopBits::Two,
            _ => return none(format!("no such setting: {stop_bits} stop bits (1 or 2)")),
        };
        match baud {
            // To the system, 0 means to hang up.
            0 => none("no such setting: 0 baud".into()),
            _ => Ok(Self { baud, data_bits, parity, stop_bits }),
        }
    }

    /// What an open port says it has; where it says nothing, as `wanted`.
    pub(super) fn of(port: &SerialStream, wanted: Self) -> Self {
        Self {
            baud: port.baud_rate().unwrap_or(wanted.baud),
            data_bits: port.data_bits().unwrap_or(wanted.data_bits),
            parity: port.parity().unwrap_or(wanted.parity),
            stop_bits: port.stop_bits().unwrap_or(wanted.stop_bits),
        }
    }

    /// Opens a port with these settings; a pseudo-terminal that refuses them, with fewer.
    pub(super) fn open(self, path: &str) -> tokio_serial::Result<SerialStream> {
        let asked = SerialStream::open(&self.builder(path));
        if asked.is_ok() || !is_pseudo_terminal(path) {
            return asked;
        }
        let no_parity = Self { parity: Parity::None, ..self };
        // macOS refuses a baud there as well; to the library, 0 means to leave it alone.
        let no_baud = Self { baud: 0, ..no_parity };
        // The first refusal says most, so it is the one to tell.
        SerialStream::open(&no_parity.builder(path))
            .or_else(|_| SerialStream::open(&no_baud.builder(path)))
            .or(asked)
    }

    fn builder(self, path: &str) -> SerialPortBuilder {
        tokio_serial::new(path, self.baud)
            .data_bits(self.data_bits)
            .parity(self.parity)
            .stop_bits(self.stop_bits)
    }

    /// Moves an open port to these settings, one after the other.
    pub(super) fn apply(self, port: &mut SerialStream) -> tokio_serial::Result<()> {
        port.set_data_bits(self.data_bits)?;
        port.set_parity(self.parity)?;
        port.set_stop_bits(self.stop_bits)?;
        port.set_baud_rate(self.baud)
    }

    /// Can a line that was asked for `wanted` run with this? A divider rarely hits a baud exactly; 2 % is
    /// what a character of 11 bits bears.
    pub(super) fn serves(self, wanted: Self) -> bool {
        Self { baud: wanted.baud, ..self } == wanted
            && self.baud.abs_diff(wanted.baud) <= wanted.baud / 50
    }
}

impl std::fmt::Display for Tuning {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let parity = match self.parity {
            Parity::None => 'N',
            Parity::Even => 'E',
            Parity::Odd => 'O',
        };
        let (data, stop) = (u8::from(self.data_bits), u8::from(self.stop_bits));
        write!(f, "{}-{data}{parity}{stop}", self.baud)
    }
}

/// Is this one, or a link to one? Linux and macOS name them so.
pub(super) fn is_pseudo_terminal(path: &str) -> bool {
    std::fs::canonicalize(path).is_ok_and(|path| {
        path.starts_with("/dev/pts") || path.to_string_lossy().starts_with("/dev/ttys")
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn prints_as_people_write_it() {
        assert_eq!(Tuning::new(115_200, 8, 'N', 1).unwrap().to_string(), "115200-8N1");
        assert_eq!(Tuning::new(9600, 7, 'E', 2).unwrap().to_string(), "9600-7E2");
        assert_eq!(Tuning::new(9600, 8, 'O', 1).unwrap().to_string(), "9600-8O1");
    }

    #[test]
    fn refuses_what_no_port_has() {
        for (baud, data, parity, stop) in
            [(9600, 6, 'N', 1), (9600, 8, 'n', 1), (9600, 8, 'N', 3), (0, 8, 'N', 1)]
        {
            let refused = Tuning::new(baud, data, parity, stop).unwrap_err();
            assert_eq!(refused.kind(), io::ErrorKind::InvalidInput);
            assert!(refused.to_string().starts_with("no such setting: "), "{refused}");
        }
    }

    #[test]
    fn a_baud_may_be_a_little_off_and_a_format_not() {
        let wanted = Tuning::new(115_200, 8, 'E', 1).unwrap();
        assert!(Tuning { baud: 115_384, ..wanted }.serves(wanted));
        assert!(!Tuning { baud: 125_000, ..wanted }.serves(wanted));
        assert!(!Tuning { parity: Parity::None, ..wanted }.serves(wanted));
    }
}
