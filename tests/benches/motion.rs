//! What an hour of motion costs: a master jogs and homes for an hour of emulated time, on every embedded model.
//!
//! `cargo bench --bench motion`. The baseline is the same hour of the same requests to a drive that has tripped, so that each of them is read, answered and told, and nothing moves.

#![allow(clippy::disallowed_methods, clippy::print_stdout, missing_docs)] // A benchmark measures the wall.

use drivemu::bench::{Device, DeviceSpec, machine, raw::RawMachine};
use drivemu::bus::{Bus, Command, DriveOrder, Output};
use drivemu::event::{DriveEvent, DriveId, EventKind};
use drivemu::line::Framing;
use drivemu::model::builtin::Builtin;
use drivemu::testkit::hex;
use drivemu::time::{Duration, Instant};
use drivemu::vocabulary::AlarmCause;
use drivemu::wire::rtu;
use std::time::Instant as Wall;

/// An hour on one model: how it is set up, what a master says every twenty seconds.
struct Hour {
    model: &'static str,
    set: &'static [(&'static str, i64)],
    terminals: &'static [&'static str],
    /// Milliseconds from the start of a round, and a request.
    round: &'static [(u64, &'static str)],
}

const HOURS: [Hour; 4] = [
    Hour {
        model: "hcfa-x",
        set: &[("P04.02", 28), ("P04.03", 14), ("P04.04", 15), ("P08.88", 3), ("P09.06", 0x000C)],
        terminals: &["DI1"],
        round: &[
            (0, "06 3608 0004"),
            (1000, "06 3608 0004"),
            (2000, "06 3608 0008"),
            (3000, "06 3608 0000"),
            (6000, "06 140C 0001"),
            (19000, "03 1507 0002"),
        ],
    },
    Hour {
        model: "k-series",
        set: &[],
        terminals: &[],
        round: &[
            (0, "06 0528 8001"),
            (2000, "06 0528 8002"),
            (3000, "06 0528 8000"),
            (6000, "06 0451 8001"),
            (18000, "06 0451 0001"),
            (19000, "03 0457 0001"),
        ],
    },
    YAKO_CLOSED,
    Hour { model: "yako-open-loop", ..YAKO_CLOSED },
];

const YAKO_CLOSED: Hour = Hour {
    model: "yako-closed-loop",
    set: &[("home_speed", 600)],
    terminals: &[],
    round: &[
        (0, "06 0027 0002"),
        (3000, "06 0027 0100"),
        (6000, "06 0027 0010"),
        (19000, "03 000A 0002"),
    ],
};

fn main() {
    for hour in HOURS {
        let (moving, homed) = median(&hour, true);
        let (standing, none) = median(&hour, false);
        assert!(homed == 180 && none == 0, "{}: {homed} and {none} homings", hour.model);
        println!(
            "{:17} an hour {moving:7.2} ms   the same requests to a drive that has tripped {standing:7.2} ms   ratio {:.1}",
            hour.model,
            moving / standing
        );
    }
}

/// Median of the milliseconds over 7 runs, and how often it homed in one.
fn median(hour: &Hour, powered: bool) -> (f64, usize) {
    let mut runs: Vec<_> = (0..7)
        .map(|_| {
            let start = Wall::now();
            let homed = run(hour, powered);
            (start.elapsed().as_secs_f64() * 1e3, homed)
        })
        .collect();
    runs.sort_by(|a, b| a.0.total_cmp(&b.0));
    runs[3]
}

fn run(hour: &Hour, powered: bool) -> usize {
    let (mut bus, unit) = bus(hour);
    let link = bus.open(Framing::Rtu {
        silence: Duration::from_millis(4),
        patience: Some(Duration::from_millis(20)),
    });
    if !powered {
        let trip = Command::Drive(DriveId(0), DriveOrder::Raise(AlarmCause::OverVoltage));
        bus.command(Instant::ZERO, trip).expect("an alarm of the model");
    }
    let mut homed = 0;
    let mut send = |now: Instant, request: &str| {
        let pdu = hex(request).expect("hex");
        bus.receive(now, link, &rtu::encode(unit, &pdu));
        while let Some(output) = bus.poll_output() {
            if let Output::Event(event) = output
                && matches!(
                    event.kind,
                    EventKind::Drive { event: DriveEvent::HomingComplete { .. }, .. }
                )
            {
                homed += 1;
            }
        }
    };
    for round in 0..180 {
        for (ms, request) in hour.round {
            send(Instant::from_millis(2000 + round * 20_000 + ms), request);
        }
    }
    homed
}

/// A machine with a switch that every homing finds, and limits on both sides of it.
fn bus(hour: &Hour) -> (Bus, u8) {
    let model = Builtin::find(hour.model).expect("an embedded model");
    let model = model.load(&Default::default()).expect("a valid model");
    let raw = RawMachine {
        start: 1000,
        home: Some([5000, 6000]),
        negative_limit: Some(-20_000),
        positive_limit: Some(30_000),
        hard_stop: Some([-25_000, 35_000]),
        ..RawMachine::default()
    };
    let spec = DeviceSpec {
        set: hour.set.iter().map(|(row, value)| ((*row).into(), *value)).collect(),
        terminals: hour.terminals.iter().map(|it| (*it).into()).collect(),
        machine: machine(&raw, &model.wiring).expect("a machine"),
        start: raw.start.into(),
        ..DeviceSpec::default()
    };
    let device = Device::new(model.into(), &spec).expect("a device");
    let mut bus = Bus::new();
    let id = bus.add(device.model.clone(), &device.setups[0], 0);
    let unit = bus.drive(id).unit();
    (bus, unit)
}
