//! An answer costs no heap: frames, requests and events lie in place.

use crate::kit::{MODELS, line_of, text_of};
use drivemu::bench::{Device, DeviceSpec, WireSpec};
use drivemu::bus::{Bus, LineCommand, LinkId};
use drivemu::model::Choices;
use drivemu::model::builtin::Builtin;
use drivemu::time::{Duration, Instant};
use drivemu::wire::rtu;

#[test]
fn a_transaction_in_the_steady_state_allocates_nothing() {
    for name in MODELS {
        let model = Builtin::find(name).expect("embedded").load(&Choices::new()).expect("valid");
        let device = Device::new(model.into(), &DeviceSpec::default()).expect("no settings");
        let wire = WireSpec::of(std::slice::from_ref(&device), None, None, false);
        let mut bus = Bus::new();
        let drive = bus.add(device.model.clone(), &device.setups[0], 0);
        let link = bus.open(wire.framing(1.0));
        let (unit, row) = (bus.drive(drive).unit(), device.model.showcase().expect("a row"));
        let [high, low] = row.at.to_be_bytes();
        let read = rtu::encode(unit, &[3, high, low, 0, row.kind.words() as u8]);
        let refused = rtu::encode(unit, &[3, 0xFF, 0xF0, 0, 1]);
        // A rule that looks at each request and never has its turn.
        let mut line = line_of(text_of(name), &[], &DeviceSpec::default());
        line.add_fault("late:register=0-0xFFFF,skip=1000000").expect("a good rule");
        let rule = line.faults.remove(0);
        bus.command(bus.now(), LineCommand::AddFault(rule).into()).expect("a free name");
        let mut now = Instant::from_millis(2000);
        bus.advance_to(now);
        while bus.poll_output().is_some() {}
        let mut rounds = |bus: &mut Bus| {
            for _ in 0..100 {
                now += Duration::from_millis(1);
                transact(bus, link, now, &read);
                transact(bus, link, now, &refused);
            }
        };
        // Until every buffer has its size.
        rounds(&mut bus);
        let counted = allocation_counter::measure(|| rounds(&mut bus));
        assert_eq!(counted.count_total, 0, "{name}");
    }
}

/// What a drive stores costs the row's place in the account of the minute, once.
#[test]
fn what_is_stored_allocates_nothing_where_nobody_keeps_it() {
    let rig = crate::kit::rig("k-series", &[], &DeviceSpec::default());
    let mut bus = rig.fresh_bus();
    let link = bus.open(rig.wire().framing(1.0));
    bus.advance_to(Instant::from_millis(2000));
    let write = rtu::encode(1, &[6, 0x01, 0x30, 0, 5]);
    let rounds = |bus: &mut Bus| {
        for _ in 0..200 {
            while bus.poll_output().is_some() {}
            bus.receive(bus.now(), link, &write);
        }
    };
    rounds(&mut bus);
    let counted = allocation_counter::measure(|| rounds(&mut bus));
    assert_eq!(counted.count_total, 0);
}

/// A master that refreshes words of which some bits do nothing, and reads a word that is not enabled.
#[test]
fn orders_without_effect_allocate_nothing() {
    let rig = crate::kit::rig("hcfa-x", &[], &DeviceSpec::default());
    let mut bus = rig.fresh_bus();
    let link = bus.open(rig.wire().framing(1.0));
    bus.advance_to(Instant::from_millis(2000));
    let requests = [
        rtu::encode(1, &[6, 0x09, 0x06, 0xFF, 0xFF]),
        rtu::encode(1, &[6, 0x36, 0x07, 0xFF, 0xFF]),
        rtu::encode(1, &[6, 0x36, 0x08, 0xFF, 0xFF]),
        rtu::encode(1, &[6, 0x36, 0x08, 0, 0]),
        rtu::encode(1, &[6, 0x14, 0x0C, 0, 1]),
        rtu::encode(1, &[3, 0x36, 0x88, 0, 2]),
    ];
    let rounds = |bus: &mut Bus| {
        for _ in 0..100 {
            for request in &requests {
                bus.receive(bus.now(), link, request);
                while bus.poll_output().is_some() {}
            }
        }
    };
    rounds(&mut bus);
    let counted = allocation_counter::measure(|| rounds(&mut bus));
    assert_eq!(counted.count_total, 0);
}

/// A log costs whoever serves a line no heap for each event: text is made by the thread that writes it. Its queue
/// grows, if at all, by doubling.
#[cfg(feature = "cli")]
#[test]
fn a_log_allocates_nothing_for_an_event() {
    let mut rig = crate::kit::rig("hcfa-x", &[], &DeviceSpec::default());
    rig.send(&rtu::encode(1, &[3, 3, 4, 0, 1]));
    let event = rig.events().last().expect("a transaction").clone();
    let mut logger = drivemu::server::Logger::to_file("/dev/null".as_ref()).expect("a device");
    let mut rounds = || (0..5000).for_each(|_| logger.log(&event, "line"));
    rounds();
    let counted = allocation_counter::measure(rounds);
    assert!(counted.count_total < 16, "{}", counted.count_total);
}

/// Where nobody looks at events there are none.
#[test]
fn events_that_nobody_wants_are_not_there() {
    let rig = crate::kit::rig("hcfa-x", &[], &DeviceSpec::default());
    let mut bus = rig.fresh_bus();
    while bus.poll_output().is_some() {}
    bus.observe(false);
    let link = bus.open(rig.wire().framing(1.0));
    bus.receive(Instant::from_millis(2000), link, &rtu::encode(1, &[3, 3, 4, 0, 1]));
    let outputs: Vec<_> = std::iter::from_fn(|| bus.poll_output()).collect();
    assert!(matches!(outputs[..], [drivemu::bus::Output::Transmit { .. }]), "{outputs:?}");
}

fn transact(bus: &mut Bus, link: LinkId, now: Instant, frame: &[u8]) {
    bus.receive(now, link, frame);
    let mut outputs = 0;
    while bus.poll_output().is_some() {
        outputs += 1;
    }
    assert_eq!(outputs, 2, "an answer and an event");
}
