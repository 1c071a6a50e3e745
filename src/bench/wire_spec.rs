//! How a line is set, and what that means for telling frames apart.

use super::Device;
use crate::drive::Drive;
use crate::line::Framing;
use crate::serial::{Mode, Settings};
use crate::time::{Duration, Instant};

/// How a line is set.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct WireSpec {
    /// Transmission mode, speed and character format.
    pub mode: Mode,
    /// RTU frames end by silence only.
    pub strict: bool,
    /// Characters of silence that end a frame.
    pub silence: f64,
    /// A pseudo-terminal carries nothing while the master's port is set to another speed than the line.
    pub match_baud: bool,
}

/// Silence that a patient line waits for at least where the CRC does not fit: schedulers and USB adapters stretch a pause inside a
/// frame to 3-16 ms.
pub const PATIENT_GAP: Duration = Duration::from_millis(20);

/// Longest pause inside an ASCII frame (serial line, 2.5.2.1).
const ASCII_GAP: Duration = Duration::from_secs(1);

impl WireSpec {
    /// How a line with `devices` is set: as told, else as the first drive's own parameters say.
    pub fn of(
        devices: &[Device],
        settings: Option<Settings>,
        ascii: Option<bool>,
        strict: bool,
    ) -> Self {
        let first = devices.first();
        let own = first.and_then(|device| {
            Drive::new(device.model.clone(), device.setups.first()?, Instant::ZERO).mode()
        });
        let own = own.unwrap_or(Mode { ascii: false, settings: Settings::STANDARD });
        Self {
            mode: Mode {
                ascii: ascii.unwrap_or(own.ascii),
                settings: settings.unwrap_or(own.settings),
            },
            strict,
            silence: first.map_or(3.5, |device| device.model.line.silence),
            match_baud: false,
        }
    }

    /// The framing of a serial line at `rate` emulated seconds per wall second. Pauses between bytes are
    /// facts of the wall, so every gap grows with the rate.
    pub fn framing(&self, rate: f64) -> Framing {
        if self.mode.ascii {
            return Framing::Ascii { gap: ASCII_GAP.mul_f64(rate) };
        }
        let silence = self.mode.settings.silence(self.silence);
        let patience = (!self.strict).then(|| silence.max(PATIENT_GAP).mul_f64(rate));
        Framing::Rtu { silence: silence.mul_f64(rate), patience }
    }
}
