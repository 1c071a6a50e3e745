//! A serial port that the system gives us: a USB adapter, a built-in UART, another program's pseudo-terminal.
//!
//! It can be unplugged at any time. However the system puts that (no bytes, `EIO`, `ENXIO`, `ENODEV`), it is
//! told as one kind of error, `NotConnected`; the caller drops the port, waits and opens it again.
//!
//! The system may also take other settings than it was asked for, without a word: a pseudo-terminal has no
//! parity. That is no error, since the line works; [`Serial::note`] says it.

use std::io::{self, ErrorKind};
use std::os::unix::fs::FileTypeExt;
use std::pin::Pin;
use std::task::{Context, Poll, ready};

use tokio::io::{AsyncRead, ReadBuf};
use tokio_serial::{DataBits, Parity, SerialPort, SerialPortBuilder, SerialStream, StopBits};

use super::{is_hang_up, said};

/// An open serial port, ours alone.
#[derive(Debug)]
pub struct Serial {
    stream: SerialStream,
    path: String,
    note: Option<String>,
}

impl Serial {
    /// Opens a port: `data_bits` 7 or 8, `parity` `'N'`, `'E'` or `'O'`, `stop_bits` 1 or 2, no flow control.
    ///
    /// # Errors
    /// `NotFound`, `PermissionDenied`, `ResourceBusy` (another program has it), `InvalidInput` (not a serial
    /// port, or no such setting), or what else the system says; each as a sentence for the user.
    ///
    /// # Panics
    /// Outside a Tokio runtime with I/O.
    pub fn open(
        path: &str,
        baud: u32,
        data_bits: u8,
        parity: char,
        stop_bits: u8,
    ) -> io::Result<Self> {
        let wanted = Tuning::new(baud, data_bits, parity, stop_bits)?;
        // A plain file would open, and then fail with an unhelpful message.
        if std::fs::metadata(path).is_ok_and(|found| !found.file_type().is_char_device()) {
            return Err(said(ErrorKind::InvalidInput, format!("{path} is not a serial port")));
        }
        let stream = wanted.open(path).map_err(|e| refusal(path, &e))?;
        let mut serial = Self { stream, path: path.to_owned(), note: None };
        serial.compare(wanted);
        Ok(serial)
    }

    /// Moves the open port to other settings, at once: see [`Serial::unsent`].
    ///
    /// # Errors
    /// `InvalidInput`, or what the system says; then some of the settings may have been taken.
    pub fn retune(
        &mut self,
        baud: u32,
        data_bits: u8,
        parity: char,
        stop_bits: u8,
    ) -> io::Result<()> {
        let wanted = Tuning::new(baud, data_bits, parity, stop_bits)?;
        match wanted.apply(&mut self.stream) {
            Err(e) if !is_pseudo_terminal(&self.path) => return Err(refusal(&self.path, &e)),
            _ => self.compare(wanted),
        }
        Ok(())
    }

    /// What the port did not take as it was asked to, as a sentence for the user.
    pub fn note(&self) -> Option<&str> {
        self.note.as_deref()
    }

    /// Bytes written that have not left yet. Wait for 0 before [`Serial::retune`]: what is still on its way
    /// would leave at the new baud.
    ///
    /// # Errors
    /// What the system says.
    pub fn unsent(&self) -> io::Result<u32> {
        Ok(self.stream.bytes_to_write()?)
    }

    /// Waits for bytes; at least one arrives, unless `buf` is empty.
    ///
    /// # Errors
    /// `NotConnected` when the port was unplugged.
    pub fn poll_read(&mut self, cx: &mut Context<'_>, buf: &mut [u8]) -> Poll<io::Result<usize>> {
        if buf.is_empty() {
            return Poll::Ready(Ok(0));
        }
        let mut buf = ReadBuf::new(buf);
        let done = ready!(Pin::new(&mut self.stream).poll_read(cx, &mut buf));
        Poll::Ready(self.some(done.map(|()| buf.filled().len())))
    }

    /// Has something arrived that was not read yet? So has the end of a port that was unplugged.
    pub fn is_anything_waiting(&self) -> bool {
        self.stream.bytes_to_read().map_or(true, |bytes| bytes > 0)
    }

    /// Sends an answer in one write and says how many of its bytes were taken; the rest is lost.
    ///
    /// # Errors
    /// As for [`Serial::poll_read`].
    pub fn write_now(&mut self, bytes: &[u8]) -> io::Result<usize> {
        match self.stream.try_write(bytes) {
            Err(e) if e.kind() == ErrorKind::WouldBlock => Ok(0),
            Err(e) if is_hang_up(&e) => Err(self.unplugged()),
            done => done,
        }
    }

    /// A read of no bytes, and every hang-up, means the same.
    fn some(&self, done: io::Result<usize>) -> io::Result<usize> {
        match done {
            Ok(0) => Err(self.unplugged()),
            Err(e) if is_hang_up(&e) => Err(self.unplugged()),
            done => done,
        }
    }

    fn unplugged(&self) -> io::Error {
        said(ErrorKind::NotConnected, format!("{} was unplugged", self.path))
    }

    /// Notes what the port says it has against what it was asked for.
    fn compare(&mut self, wanted: Tuning) {
        let got = Tuning::of(&self.stream, wanted);
        self.note = (!got.serves(wanted)).then(|| {
            let path = &self.path;
            let why = if is_pseudo_terminal(path) {
                " (a pseudo-terminal; bytes pass nevertheless)"
            } else {
                ""
            };
            format!("{path}: requested {wanted}, but the port is at {got}{why}")
        });
    }
}

fn refusal(path: &str, error: &tokio_serial::Error) -> io::Error {
    use tokio_serial::ErrorKind as Kind;
    let (kind, why) = match error.kind {
        // The library's word for a port that is locked, whether by ioctl or by file lock.
        Kind::NoDevice => (ErrorKind::ResourceBusy, "in use by another program"),
        Kind::Io(ErrorKind::NotFound) => (ErrorKind::NotFound, "no such device"),
        Kind::Io(ErrorKind::PermissionDenied) => (
            ErrorKind::PermissionDenied,
            "permission denied; add yourself to the group that owns it, usually dialout \
             (sudo usermod -aG dialout $USER), and log in again",
        ),
        Kind::Io(kind) => (kind, &*error.description),
        Kind::InvalidInput => (ErrorKind::InvalidInput, &*error.description),
        Kind::Unknown => (ErrorKind::Other, &*error.description),
    };
    said(kind, format!("cannot open {path}: {why}"))
}

/// Baud and format; no flow control, as on RS-485.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
struct Tuning {
    baud: u32,
    data_bits: DataBits,
    parity: Parity,
    stop_bits: StopBits,
}

impl Tuning {
    /// Checks settings given as plain values: 7 or 8, `'N'`, `'E'` or `'O'`, 1 or 2.
    fn new(baud: u32, data_bits: u8, parity: char, stop_bits: u8) -> io::Result<Self> {
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
    fn of(port: &SerialStream, wanted: Self) -> Self {
        Self {
            baud: port.baud_rate().unwrap_or(wanted.baud),
            data_bits: port.data_bits().unwrap_or(wanted.data_bits),
            parity: port.parity().unwrap_or(wanted.parity),
            stop_bits: port.stop_bits().unwrap_or(wanted.stop_bits),
        }
    }

    /// Opens a port with these settings; a pseudo-terminal that refuses them, with fewer.
    fn open(self, path: &str) -> tokio_serial::Result<SerialStream> {
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
    fn apply(self, port: &mut SerialStream) -> tokio_serial::Result<()> {
        port.set_data_bits(self.data_bits)?;
        port.set_parity(self.parity)?;
        port.set_stop_bits(self.stop_bits)?;
        port.set_baud_rate(self.baud)
    }

    /// Can a line that was asked for `wanted` run with this? A divider rarely hits a baud exactly; 2 % is
    /// what a character of 11 bits bears.
    fn serves(self, wanted: Self) -> bool {
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
    use super::super::pty::Pty;
    use super::*;
    use std::future::poll_fn;
    use std::time::Duration;
    use tokio::time::timeout;

    fn pair() -> (Pty, Serial) {
        let pty = Pty::open(None).unwrap();
        let serial = open_8n1(pty.path().to_str().unwrap()).unwrap();
        (pty, serial)
    }

    fn open_8n1(path: &str) -> io::Result<Serial> {
        Serial::open(path, 19200, 8, 'N', 1)
    }

    async fn heard(serial: &mut Serial) -> io::Result<Vec<u8>> {
        let mut buf = [0; 300];
        let read = poll_fn(|cx| serial.poll_read(cx, &mut buf));
        let count = timeout(Duration::from_secs(2), read).await.unwrap()?;
        Ok(buf[..count].to_vec())
    }

    #[tokio::test]
    async fn passes_every_byte_untouched_both_ways() {
        let (mut pty, mut serial) = pair();
        let all: Vec<u8> = (0..=255).collect();
        assert_eq!(pty.write_now(&all).unwrap(), 256);
        let mut got = Vec::new();
        while got.len() < all.len() {
            got.extend(heard(&mut serial).await.unwrap());
        }
        assert_eq!(got, all);
        assert!(!serial.is_anything_waiting());

        assert_eq!(serial.write_now(&all).unwrap(), 256);
        let mut buf = [0; 300];
        let mut got = Vec::new();
        while got.len() < all.len() {
            let read = poll_fn(|cx| pty.poll_read(cx, &mut buf));
            let input = timeout(Duration::from_secs(2), read).await.unwrap().unwrap();
            got.extend_from_slice(&buf[..input.len]);
        }
        assert_eq!(got, all);
        assert_eq!(serial.unsent().unwrap(), 0);
    }

    #[tokio::test]
    async fn every_face_of_being_unplugged_is_not_connected() {
        let (pty, mut serial) = pair();
        drop(pty);
        for _ in 0..2 {
            let read = heard(&mut serial).await.unwrap_err();
            assert_eq!(read.kind(), ErrorKind::NotConnected, "{read}");
            assert!(read.to_string().ends_with("was unplugged"));
            assert!(serial.is_anything_waiting());
            let write = serial.write_now(b"x").unwrap_err();
            assert_eq!(write.kind(), ErrorKind::NotConnected, "{write}");
        }
    }

    #[tokio::test]
    async fn being_unplugged_wakes_a_read_that_waits() {
        let (pty, mut serial) = pair();
        let reading = tokio::spawn(async move { heard(&mut serial).await });
        tokio::task::yield_now().await;
        drop(pty);
        assert_eq!(reading.await.unwrap().unwrap_err().kind(), ErrorKind::NotConnected);
    }

    #[tokio::test]
    async fn a_reader_that_stops_is_not_waited_for() {
        let (_pty, mut serial) = pair();
        let mut taken = 0;
        loop {
            match serial.write_now(&[7; 256]).unwrap() {
                0 => break,
                count => taken += count,
            }
            assert!(taken < 10_000_000, "a full buffer must show");
        }
        assert!(taken >= 1024, "room for a few answers, found {taken}");
    }

    #[tokio::test]
    async fn says_what_a_pseudo_terminal_did_not_take() {
        let (pty, mut serial) = pair();
        assert_eq!(serial.note(), None);
        serial.retune(57600, 8, 'E', 2).unwrap();
        let path = pty.path().display();
        if cfg!(target_os = "linux") {
            let note = serial.note().unwrap();
            assert!(
                note.starts_with(&format!(
                    "{path}: requested 57600-8E2, but the port is at 57600-8N2 (a "
                )),
                "{note}"
            );
            assert_eq!(pty.master_settings().unwrap(), (57600, 2));
        }
        drop(serial);
        let mut serial = Serial::open(pty.path().to_str().unwrap(), 9600, 8, 'E', 1).unwrap();
        assert_eq!(serial.note().is_some(), cfg!(target_os = "linux"));
        serial.retune(9600, 8, 'N', 1).unwrap();
        assert_eq!(serial.note(), None);
    }

    #[tokio::test]
    async fn refuses_in_clear_words() {
        let (pty, _serial) = pair();
        let path = pty.path().to_str().unwrap();
        let file = tempfile::NamedTempFile::new().unwrap();
        let file = file.path().to_str().unwrap();
        for (path, kind, words) in [
            (path, ErrorKind::ResourceBusy, "in use by another program"),
            ("/dev/ttyNone9", ErrorKind::NotFound, "no such device"),
            (file, ErrorKind::InvalidInput, "is not a serial port"),
            ("/dev/null", ErrorKind::Other, "cannot open /dev/null: "),
        ] {
            let refused = open_8n1(path).unwrap_err();
            assert_eq!(refused.kind(), kind, "{refused}");
            let text = refused.to_string();
            assert!(text.contains(words) && text.contains(path), "{text}");
        }
        let locked = tokio_serial::Error::new(
            tokio_serial::ErrorKind::Io(ErrorKind::PermissionDenied),
            "Permission denied",
        );
        assert!(refusal("/dev/ttyUSB0", &locked).to_string().contains("dialout"));
    }

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
