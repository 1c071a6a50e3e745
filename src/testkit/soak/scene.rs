//! The line of a soak test: its framing, the drives on it, what stands along their axes; and the numbers that decide.

use crate::bench::{BenchLine, Device, DeviceSpec, LineBuilder, PortSpec, WireSpec};
use crate::bus::Bus;
use crate::line::Framing;
use crate::model::Model;
use crate::motion::{Index, Machine, Zone};
use crate::rng::Rng;
use crate::serial::Mode;
use crate::time::Duration;
use std::sync::Arc;

/// The line of a soak test.
#[derive(Debug)]
pub struct Scene {
    /// The line. It has no rules to begin with.
    pub line: BenchLine,
    seed: u64,
}

impl Scene {
    /// A line with drives of some of `models`, of which there is one at least.
    pub fn draw(seed: u64, models: &[Arc<Model>], draws: &mut Draws) -> Self {
        let tcp = draws.one_in(6);
        let mut devices = Vec::new();
        for i in 0..draws.between(1, 3) {
            let model = draws.pick(models).expect("a soak test has models");
            let spec = DeviceSpec {
                unit: Some(1 + 2 * i as u8),
                machine: machine(draws),
                position: draws.signed(-2000, 2000),
                ..DeviceSpec::default()
            };
            devices.extend(Device::new(model.clone(), &spec));
        }
        let ascii = ascii(&devices).filter(|_| !tcp && draws.one_in(2));
        let settings = ascii.map(|mode| mode.settings);
        let strict = draws.one_in(3);
        let port = if tcp { PortSpec::Tcp(String::new()) } else { PortSpec::Pty(None) };
        let builder = LineBuilder::new("soak", devices)
            .port(port)
            .settings(settings)
            .ascii(Some(ascii.is_some()))
            .strict(strict);
        let (mut line, mismatches) = builder.build();
        for mismatch in mismatches.iter().rev() {
            line.devices.remove(mismatch.device);
        }
        Self { line, seed }
    }

    /// The unit address of the first station of device number `at`, as the line begins.
    pub fn unit(&self, at: usize) -> u8 {
        1 + 2 * at as u8
    }

    /// Does it carry Modbus TCP?
    pub fn is_tcp(&self) -> bool {
        !self.line.is_serial()
    }

    /// How frames are told apart on a line that is set to `wire`.
    pub fn framing(&self, wire: WireSpec) -> Framing {
        if self.is_tcp() { Framing::Mbap } else { wire.framing(1.0) }
    }

    /// The drives, just switched on.
    pub fn bus(&self) -> Bus {
        self.line.bus(self.seed)
    }
}

/// A mode in ASCII that the first drive knows, if there is one.
fn ascii(devices: &[Device]) -> Option<Mode> {
    let line = &devices.first()?.model.line;
    let format = line.format.codes.values().find(|it| it.ascii)?.format;
    let baud = *line.baud.codes.values().next()?;
    Some(Mode { ascii: true, settings: crate::serial::Settings { baud, format } })
}

fn machine(draws: &mut Draws) -> Machine {
    let mut maybe = |low: i64, high: i64| (!draws.one_in(3)).then(|| draws.signed(low, high));
    let home = maybe(-20_000, 20_000).map(|from| Zone { from, to: from + 700 });
    let negative_limit = maybe(-40_000, -1_000);
    let positive_limit = maybe(1_000, 40_000);
    let hard_stop = maybe(500, 50_000).map(|room| [-room, room]);
    let index = maybe(50, 10_000).map(|every| Index { every, offset: 17 });
    Machine { home, negative_limit, positive_limit, hard_stop, index }
}

/// One stream of numbers.
#[derive(Debug, Clone)]
pub struct Draws(pub Rng);

impl Draws {
    /// A number from `low` to `high`, both included.
    pub fn between(&mut self, low: u64, high: u64) -> u64 {
        self.0.between(low, high)
    }

    /// A whole number of `low` to `high`, both included.
    pub fn signed(&mut self, low: i64, high: i64) -> i64 {
        low.saturating_add(self.between(0, high.saturating_sub(low).max(0) as u64) as i64)
    }

    /// Did it happen, one time of `n`?
    pub fn one_in(&mut self, n: u64) -> bool {
        self.between(1, n) == 1
    }

    /// One of `from`, if there is any.
    pub fn pick<'a, T>(&mut self, from: &'a [T]) -> Option<&'a T> {
        let last = from.len().checked_sub(1)?;
        from.get(self.between(0, last as u64) as usize)
    }

    /// Any word.
    pub fn word(&mut self) -> u16 {
        self.between(0, 0xFFFF) as u16
    }

    /// Any byte.
    pub fn byte(&mut self) -> u8 {
        self.between(0, 0xFF) as u8
    }

    /// Up to `most` bytes, and one at least.
    pub fn bytes(&mut self, most: u64) -> Vec<u8> {
        let len = self.between(1, most);
        (0..len).map(|_| self.byte()).collect()
    }

    /// A pause: none, within a frame, or up to `most`.
    pub fn pause(&mut self, most: Duration) -> Duration {
        match self.between(0, 3) {
            0 => Duration::ZERO,
            1 => Duration::from_micros(self.between(1, 30_000)),
            _ => Duration::from_micros(self.between(0, most.as_micros() as u64)),
        }
    }
}
