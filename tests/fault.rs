//! Faults: what each kind of fault does to the bytes, whom it hits, and that a seed says it all.

mod bytes;
#[cfg(feature = "cli")]
mod keys;
#[cfg(feature = "cli")]
mod log;
#[cfg(feature = "cli")]
mod master;
mod page;
mod repeated;
mod streams;
mod turns;

use crate::kit::{rig, rig_of};
use drivemu::bench::DeviceSpec;
use drivemu::event::EventKind;
use drivemu::testkit::Rig;
use drivemu::wire::rtu;

/// Reads the jog speed, which is 100, of unit 1.
const READ: &[u8] = &[0x03, 0x03, 0x04, 0x00, 0x01];
const SILENCE: &[u8] = &[];
const ANSWER: &[u8] = &[0x03, 0x02, 0x00, 0x64];
/// Sets it to 7.
const WRITE: &[u8] = &[0x06, 0x03, 0x04, 0x00, 0x07];

/// A servo at unit 1 of an RTU line, with these rules.
fn drive(specs: &[&str]) -> Rig {
    drive_of("hcfa-x", specs, 0)
}

fn drive_of(model: &str, specs: &[&str], seed: u64) -> Rig {
    let rig = rig(model, &[], &DeviceSpec::default()).with_seed(seed);
    specs.iter().fold(rig, |rig, spec| {
        rig.with_fault(spec).unwrap_or_else(|problems| panic!("{spec}: {}", problems[0]))
    })
}

/// Asks unit 1 and gives back what comes at once.
fn ask(rig: &mut Rig, pdu: &[u8]) -> Vec<u8> {
    rig.send(&rtu::encode(1, pdu))
}

fn frame(pdu: &[u8]) -> Vec<u8> {
    rtu::encode(1, pdu).to_vec()
}

/// What rules did, in order.
fn effects(rig: &Rig) -> Vec<&'static str> {
    let effect = |event: &drivemu::event::Event| match &event.kind {
        EventKind::Fault(hit) => Some(hit.effect.name()),
        _ => None,
    };
    rig.events().iter().filter_map(effect).collect()
}

fn hits(rig: &Rig, name: &str) -> u64 {
    rig.bus().faults().hits(name).expect("a rule of that name")
}

/// The value of the jog speed.
fn jog_speed(rig: &mut Rig) -> u32 {
    let map = &rig.drive().model().map;
    let row = map.find("P03.04").expect("a row");
    rig.drive().bank().raw(row)
}

/// The made-up drive, at unit 1.
fn acme(specs: &[&str]) -> Rig {
    let spec = DeviceSpec { switches: Some(1), ..DeviceSpec::default() };
    let rig = rig_of(include_str!("models/acme-s1.yaml"), &[], &spec);
    specs.iter().fold(rig, |rig, spec| rig.with_fault(spec).expect("a good rule"))
}
