//! What the parts of a drive share at one instant.

use super::device_faults::DeviceFaults;
use super::effects::EffectQueue;
use super::registers::Registers;
use crate::behaviour::PowerStage;
use crate::event::{DriveEvent, Ignored, NoEffect, Ordered};
use crate::model::Model;
use crate::time::Instant;
use crate::vocabulary::{Input, Inputs};

/// What a part sees of the others.
#[derive(Debug, Clone, Copy)]
pub(super) struct DriveContext<'a> {
    pub(super) now: Instant,
    pub(super) registers: &'a Registers,
    /// The input signals that are active.
    pub(super) inputs: Inputs,
    pub(super) power: &'a PowerStage,
    pub(super) faults: &'a DeviceFaults,
}

impl<'a> DriveContext<'a> {
    pub(super) fn model(self) -> &'a Model {
        self.registers.model()
    }

    /// Is the input signal active?
    pub(super) fn has(self, input: Input) -> bool {
        self.inputs.has(input)
    }

    /// The reason behind `why`: what keeps the power stage off, what an alarm stops.
    pub(super) fn root_of(self, why: Ignored) -> Ignored {
        match why {
            Ignored::PowerOff => self.power.why_off(),
            Ignored::Held if self.power.is_braking() => Ignored::Alarm,
            why => why,
        }
    }

    /// An order has no effect. What the axis says of the power stage is traced to what keeps that off.
    pub(super) fn ignore(self, out: &mut EffectQueue, order: Ordered, why: Ignored) {
        let (decoder, why) = (self.registers.decoder(), self.root_of(why));
        out.change(DriveEvent::NoEffect(NoEffect { decoder, order, why }));
    }
}
