//! What can be seen of the program at the other end of a terminal: how it has set its port, and whether it reads.

use crate::event::PortSettings;
use crate::server::port::Tty;
use crate::server::serve::LineServer;
use tracing::warn;

/// What was seen last.
#[derive(Debug, Default)]
pub struct Watch {
    /// Settings that were told already.
    told: Option<PortSettings>,
    /// The other end has stopped reading.
    stalled: bool,
}

impl Watch {
    /// Tells, once, if the master's port is set to something that no wire would carry. Gives its baud if that is why
    /// nobody understands it.
    pub fn poll(&mut self, line: &mut LineServer, tty: &Tty) -> Option<u32> {
        let port = settings(line, tty)?;
        let heard = !line.matches_baud() || port.same_baud();
        let told = self.told.replace(port);
        // Settings that fit are worth a word only where others were told before.
        let is_news = !port.fits() || told.is_some_and(|told| !told.fits());
        if is_news && told != Some(port) {
            line.tell_port(port, heard);
        }
        (!heard).then_some(port.baud)
    }

    /// Does a frame of the line reach the master as it is?
    pub fn carries(&self, line: &LineServer, tty: &Tty) -> bool {
        !line.matches_baud() || settings(line, tty).is_none_or(PortSettings::same_baud)
    }

    /// Of `len` bytes of an answer the port has taken so many.
    pub fn sent(&mut self, line: &LineServer, taken: usize, len: usize) {
        if taken < len && !self.stalled {
            warn!("{}: replies are not being read; they are lost, as on a wire", line.name);
        }
        self.stalled = taken < len;
    }

    /// The program has left.
    pub fn left(&mut self) {
        self.stalled = false;
    }
}

/// How the master's port and the line are set; a real port does not tell.
fn settings(line: &LineServer, tty: &Tty) -> Option<PortSettings> {
    let Tty::Pty(pty) = tty else { return None };
    let (baud, stop_bits) = pty.master_settings().ok()?;
    Some(PortSettings { baud, stop_bits, line: line.settings() })
}
