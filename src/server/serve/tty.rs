//! Serves a line on a terminal: a pseudo-terminal of ours, or a serial port that may go and come back.

mod watch;

use super::{LineServer, Send};
use crate::bus::LinkId;
use crate::serial::Settings;
use crate::server::clock::Clock;
use crate::server::port::{Input, Left, Tty};
use crate::time::Duration;
use std::io::{self, ErrorKind};
use tracing::{info, warn};
use watch::Watch;

/// Opens the port again after it was lost, with the line's present settings.
pub type Reopen = Box<dyn Fn(Settings) -> io::Result<Tty>>;

/// How long an answer may take to leave a port before it moves: 256 characters at 2400 baud.
const FLUSH: Duration = Duration::from_millis(1200);

/// How often it is looked whether it has left.
const FLUSH_STEP: Duration = Duration::from_millis(1);

/// How often a lost port is looked for.
const LOOK_AGAIN: Duration = Duration::from_millis(250);

/// Serves `line` on `tty` for ever.
pub async fn serve_tty(mut line: LineServer, mut tty: Tty, reopen: Reopen) {
    let mut watch = Watch::default();
    loop {
        let lost = serve_until_lost(&mut line, &mut tty, &mut watch).await;
        warn!("{}: the port disappeared ({lost}); waiting for it", line.name);
        tty = wait_for(&mut line, &reopen).await;
        info!("{}: the port is back", line.name);
    }
}

async fn serve_until_lost(line: &mut LineServer, tty: &mut Tty, watch: &mut Watch) -> io::Error {
    let mut link = line.bus.open(line.framing());
    let mut buffer = [0; 1024];
    let error = loop {
        if let Err(error) = send_all(line, link, tty, watch).await {
            break error;
        }
        let read = tokio::select! {
            biased;
            read = tty.read(&mut buffer) => read,
            () = line.woken() => tty.try_read(&mut buffer),
        };
        let Input { len, left } = match read {
            Ok(input) => input,
            Err(error) => break error,
        };
        if left == Left::Before {
            // Not a link of its own: the rest of a frame may have come with its first bytes.
            line.bus.forget_replies(link);
            watch.left();
        }
        match &buffer[..len] {
            [] => line.advance(),
            bytes => match watch.poll(line, tty) {
                None => line.receive(link, bytes),
                Some(theirs) => line.receive_unheard(link, bytes, theirs),
            },
        }
        if left == Left::After {
            line.hang_up(link);
            watch.left();
            link = line.bus.open(line.framing());
        }
    };
    line.bus.close(link);
    error
}

/// While the port is away the drives live on.
async fn wait_for(line: &mut LineServer, reopen: &Reopen) -> Tty {
    let mut told = ErrorKind::NotFound;
    loop {
        Clock::wall(LOOK_AGAIN).await;
        line.advance();
        while line.next_send().is_some() {}
        match reopen(line.settings()) {
            Ok(tty) => return tty,
            Err(error) if error.kind() != told => {
                told = error.kind();
                warn!("{}: {error}; still waiting", line.name);
            }
            Err(_) => {}
        }
    }
}

/// Sends what there is for the master of `link`; what is for one that has left is dropped.
async fn send_all(
    line: &mut LineServer,
    link: LinkId,
    tty: &mut Tty,
    watch: &mut Watch,
) -> io::Result<()> {
    while let Some(send) = line.next_send() {
        match send {
            Send::Frame(to, frame) => {
                if to == link && watch.carries(line, tty) {
                    let taken = tty.write_now(&frame)?;
                    watch.sent(line, taken, frame.len());
                }
            }
            Send::Move(mode) => retune(tty, mode.settings).await?,
            // Only a TCP stream can be lost.
            Send::Close(_) => {}
        }
    }
    Ok(())
}

/// Moves the port to other settings, once the answer in the old ones has left.
async fn retune(tty: &mut Tty, Settings { baud, format }: Settings) -> io::Result<()> {
    match tty {
        // The port of a program that has it open stays as that has set it, which may be wrong from now on.
        Tty::Pty(pty) if pty.is_open_elsewhere() => Ok(()),
        // Only what others see of it; bytes pass all the same.
        Tty::Pty(pty) => {
            let _ = pty.preset(baud, format.stop_bits);
            Ok(())
        }
        Tty::Serial(serial) => {
            let mut patience = FLUSH;
            while serial.unsent()? > 0 && !patience.is_zero() {
                Clock::wall(FLUSH_STEP).await;
                patience = patience.saturating_sub(FLUSH_STEP);
            }
            serial.retune(baud, format.data_bits, format.parity.letter(), format.stop_bits)?;
            serial.note().into_iter().for_each(|note| warn!("{note}"));
            Ok(())
        }
    }
}
