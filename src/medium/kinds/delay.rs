//! A reply that leaves later.

use super::*;
use serde::Serializer;
use serde::ser::SerializeStruct;

/// Delays the reply by a time between two, drawn in microseconds; once it is drawn, both are that.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Delay {
    least: Duration,
    most: Duration,
}

impl Fault for Delay {
    const NAME: &'static str = "delay";
    const ABOUT: &'static str = "The reply is delayed.";
    const KEYS: &'static [FaultKey] = &[FaultKey::milliseconds(
        "ms",
        "how long, in milliseconds; `50-200` draws it anew each time",
    )
    .required()];

    fn read(keys: &FaultKeys) -> Result<Self, KeyRefusal> {
        let [least, most] = keys.range("ms").unwrap_or_default().map(Duration::from_millis);
        Ok(Self { least, most })
    }

    fn draw(self, _: u8, _: u8, rng: &mut Rng) -> Self {
        let [least, most] = [self.least, self.most].map(|it| it.as_micros() as u64);
        let drawn = Duration::from_micros(rng.between(least, most));
        Self { least: drawn, most: drawn }
    }

    fn on_reply(&mut self, reply: &DriveReply<'_>, out: &mut Outgoing<'_>) -> Option<Duration> {
        out.send_after(self.least, &reply.frame());
        Some(self.least)
    }

    fn leaves(&self) -> Leaves {
        Leaves::LATER
    }

    fn describe(&self, unit: u8) -> String {
        format!("reply from unit {unit} delayed by {} ms", self.milliseconds())
    }
}

impl Delay {
    fn milliseconds(self) -> f64 {
        self.least.as_secs_f64() * 1000.0
    }
}

impl Serialize for Delay {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let mut fields = serializer.serialize_struct("Delay", 1)?;
        fields.serialize_field("ms", &self.milliseconds())?;
        fields.end()
    }
}
