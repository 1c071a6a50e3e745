//! What holds whatever happens: random traffic, cut anywhere, at any time.

pub mod traffic;

use crate::kit::{MODELS, drain, line_of, rig, text_of};
use drivemu::bench::DeviceSpec;
use drivemu::bus::{Bus, Command, DriveOrder, LinkId};
use drivemu::drive::View;
use drivemu::event::{DriveEvent, DriveId, Event, EventKind};
use drivemu::line::Framing;
use drivemu::model::{Access, Layer, Located};
use drivemu::testkit::Rig;
use drivemu::time::{Duration, Instant};
use drivemu::vocabulary::{AlarmCause, Named, Output, Quantity};
use drivemu::wire::{mbap, rtu};
use proptest::prelude::*;
use traffic::{Piece, bytes, pdu, pieces, request};

/// Longest gap of the lines here.
const GAP: Duration = Duration::from_millis(20);

fn modest(cases: u32) -> ProptestConfig {
    ProptestConfig { cases, failure_persistence: None, ..ProptestConfig::default() }
}

proptest! {
    #![proptest_config(modest(48))]

    /// No bytes can bring it down, and after one gap all drives answer.
    #[test]
    fn in_step_after_one_gap(strict: bool, traffic in pieces(1..24)) {
        let mut rig = crate::line::cell(strict);
        for Piece { bytes, pause } in &traffic {
            rig.push(bytes);
            rig.advance(*pause);
        }
        rig.advance(GAP);
        prop_assert!(rig.bus().poll_at().is_none_or(|wake| wake.at > rig.now()));
        for (unit, read) in heard(&rig) {
            let got = rig.send(&rtu::encode(unit, &read));
            let answer = rtu::decode(&got);
            prop_assert!(answer.is_ok_and(|adu| adu.unit == unit && adu.pdu[..2] == [3, 2]), "{}", rig.log());
        }
    }

    /// The same in ASCII, where the gap is a second.
    #[test]
    fn in_step_after_one_gap_in_ascii(traffic in pieces(1..24), glue in prop::collection::vec(any::<u8>(), 0..40)) {
        let gap = Duration::from_secs(1);
        let mut rig = rig("k-series", &[], &DeviceSpec::default()).with_framing(Framing::Ascii { gap });
        for Piece { bytes, pause } in &traffic {
            // As characters, and as they are.
            let text: String = bytes.iter().map(|byte| format!("{byte:02x}")).collect();
            rig.push(format!(":{text}\r\n").as_bytes());
            rig.push(bytes);
            rig.push(&glue);
            rig.advance(*pause);
        }
        rig.advance(gap);
        let got = rig.send(b":010300050001F6\r\n");
        prop_assert!(got.starts_with(b":010302") && got.ends_with(b"\r\n"), "{}", rig.log());
    }

    /// A TCP stream that keeps to its headers is followed to the end, whatever the headers hold.
    #[test]
    fn a_stream_is_followed(frames in prop::collection::vec((any::<u16>(), 0..4u8, bytes(1..60)), 1..20), cuts in bytes(1..40)) {
        let (mut bus, link) = bus("yako-closed-loop", Framing::Mbap);
        let sent: Vec<u8> = frames.iter().flat_map(|(id, unit, pdu)| mbap::encode(*id, *unit, pdu).to_vec()).collect();
        let mut rest = sent.as_slice();
        for cut in cuts.iter().cycle() {
            let (piece, behind) = rest.split_at(rest.len().min(usize::from(*cut) + 1));
            let now = bus.now();
            bus.receive(now, link, piece);
            rest = behind;
            if rest.is_empty() {
                break;
            }
        }
        let drained = drain(&mut bus);
        let mut got = drained.sent.as_slice();
        // 0 is the drive itself, since it is alone.
        let answered = |(_, unit, _): &&(u16, u8, Vec<u8>)| *unit <= 1;
        for (id, unit, pdu) in frames.iter().filter(answered) {
            let len = mbap::frame_len(got).expect("a good header").expect("a whole one");
            let (transaction, adu) = mbap::decode(&got[..len]);
            let function = |it: u8| it & 0x7F;
            let told = (transaction, adu.unit, function(adu.function()));
            prop_assert_eq!(told, (*id, *unit, function(pdu[0])));
            got = &got[len..];
        }
        prop_assert!(got.is_empty() && !drained.closed);
    }

    /// It makes no difference how a burst is cut into reads, as long as no time passes.
    #[test]
    fn cuts_make_no_difference(traffic in pieces(1..8), at in prop::collection::vec(any::<prop::sample::Index>(), 0..6)) {
        let all: Vec<u8> = traffic.iter().flat_map(|piece| piece.bytes.clone()).collect();
        let mut cuts: Vec<usize> = at.iter().map(|at| at.index(all.len() + 1)).collect();
        cuts.sort_unstable();
        cuts.push(all.len());
        let (mut whole, mut cut) = (crate::line::cell(false), crate::line::cell(false));
        let mut at_once = whole.push(&all);
        at_once.extend(whole.advance(GAP));
        let mut bit_by_bit = Vec::new();
        let mut from = 0;
        for to in cuts {
            bit_by_bit.extend(cut.push(&all[from..to]));
            from = to;
        }
        bit_by_bit.extend(cut.advance(GAP));
        prop_assert_eq!(at_once, bit_by_bit);
        prop_assert_eq!(whole.log(), cut.log());
    }

    /// Whoever looks more often sees the same things happen at the same instants.
    #[test]
    fn slices_of_time_make_no_difference(happenings in happenings(), slices in prop::collection::vec(0..9_000u64, 0..40)) {
        let seldom = live("hcfa-x", &happenings, &[]);
        let often = live("hcfa-x", &happenings, &slices);
        prop_assert_eq!(seldom, often);
    }

    /// The same with an axis that moves: every answer holds the same position and speed.
    #[test]
    fn slices_of_time_move_no_axis(happenings in orders(), slices in prop::collection::vec(0..9_000u64, 0..40)) {
        let seldom = live("yako-open-loop", &happenings, &[]);
        let often = live("yako-open-loop", &happenings, &slices);
        prop_assert_eq!(seldom, often);
    }

    /// The same input gives the same log.
    #[test]
    fn the_same_again(traffic in pieces(1..16)) {
        let play = || {
            let mut rig = crate::line::cell(false);
            for Piece { bytes, pause } in &traffic {
                rig.push(bytes);
                rig.advance(*pause);
            }
            rig.log()
        };
        prop_assert_eq!(play(), play());
    }
}

proptest! {
    #![proptest_config(modest(96))]

    /// What is refused changes nothing, what is only read neither, and what is written reads back.
    #[test]
    fn refused_writes_leave_all_as_it_was(model in prop::sample::select(&MODELS[..]), requests in prop::collection::vec(pdu(), 1..40)) {
        let spec = DeviceSpec { unit: Some(1), ..DeviceSpec::default() };
        let options: &[_] = match model {
            "hcfa-x" => &[("run_lock", "at_stop_rows")],
            "k-series" => &[("fc10", "on"), ("wo_read", "exception_02")],
            _ => &[],
        };
        let mut rig = rig(model, options, &spec);
        for request in requests {
            let before = (rig.drive().bank().clone(), rig.events().len());
            let unit = rig.drive().unit();
            let got = rig.send(&rtu::encode(unit, &request));
            let refused = got.get(1).is_none_or(|function| function & 0x80 != 0);
            if refused || request[0] == 3 {
                prop_assert!(rig.drive().bank() == &before.0, "{}", rig.log());
                let new = &rig.events()[before.1..];
                // A word of which nothing is enabled says so when it is read.
                let told = |event: &&Event| !matches!(event.kind, EventKind::Drive { event: DriveEvent::NoEffect { .. }, .. });
                prop_assert_eq!(new.iter().filter(told).count(), 1, "{}", rig.log());
            } else if let [6, high, low, a, b] = *request {
                let address = u16::from_be_bytes([high, low]);
                let want = plain(&rig, address).then(|| rtu::encode(unit, &[3, 2, a, b]).to_vec());
                if let Some(want) = want {
                    prop_assert_eq!(rig.send(&rtu::encode(unit, &[3, high, low, 0, 1])), want, "{}", rig.log());
                }
            }
        }
    }
}

proptest! {
    #![proptest_config(modest(48))]

    /// Whatever masters have stored, the next run takes it and keeps the same.
    #[test]
    fn a_state_is_read_back(model in prop::sample::select(&MODELS[..]), requests in prop::collection::vec(pdu(), 1..40)) {
        let spec = DeviceSpec::default();
        let mut first = rig(model, &[], &spec);
        for request in requests {
            let unit = first.drive().unit();
            first.send(&rtu::encode(unit, &request));
        }
        let second = rig(model, &[], &spec).with_state(&first.state());
        prop_assert_eq!(second.map(|rig| rig.state()), Ok(first.state()));
    }
}

/// Does the row at `address` simply hold what is written?
fn plain(rig: &Rig, address: u16) -> bool {
    let model = rig.drive().model();
    let Located::Word { row: id, layer, .. } = model.map.locate(address) else { return false };
    let row = model.map.row(id);
    let settings = [model.line.unit.row, model.line.baud.row, model.line.format.row];
    let acts = model.wiring.commands.iter().any(|it| it.row == id) || settings.contains(&id);
    let shows = model.wiring.shows(id).is_some();
    // Only the layer in force can be read.
    let readable = matches!(layer, Layer::Ram | Layer::RamAndStore) && row.access == Access::Both;
    readable && !row.clears && !acts && !shows && row.kind.words() == 1
}

/// The units that answer on a line, each with a read that it grants.
fn heard(rig: &Rig) -> Vec<(u8, Vec<u8>)> {
    let read = |(id, drive): (DriveId, &drivemu::drive::Drive)| {
        let at = match drive.model().name.as_str() {
            "hcfa-x" => [0x08, 0x5C],
            "k-series" => [0x00, 0x05],
            _ => [0x00, 0x23],
        };
        let answers = rig.bus().find(drive.unit()) == Some(id);
        answers.then(|| (drive.unit(), [&[3][..], &at, &[0, 1]].concat()))
    };
    rig.bus().drives().filter_map(read).collect()
}

/// Something that happens to a drive.
#[derive(Debug, Clone)]
enum Happening {
    Bytes(Vec<u8>),
    Do(Command),
}

/// Happenings with their times in milliseconds, in order.
fn happenings() -> impl Strategy<Value = Vec<(u64, Happening)>> {
    let drive = DriveId(0);
    let terminal = (0..9u8, any::<bool>()).prop_map(move |(index, signal)| {
        Command::Drive(drive, DriveOrder::Terminal { index, signal })
    });
    let word = (0x3607..=0x360Au16, 0..8u16).prop_map(|(at, value)| request(1, at, value));
    let hold = (0..4u16).prop_map(|value| request(1, 0x090B, value));
    let enable = (0x0905..=0x0908u16, any::<u16>()).prop_map(|(at, value)| request(1, at, value));
    let happening = prop_oneof![
        6 => word.prop_map(Happening::Bytes),
        2 => hold.prop_map(Happening::Bytes),
        2 => enable.prop_map(Happening::Bytes),
        1 => bytes(1..12).prop_map(Happening::Bytes),
        2 => terminal.prop_map(Happening::Do),
        1 => Just(Happening::Do(Command::Drive(drive, DriveOrder::PowerCycle))),
        1 => Just(Happening::Do(Command::Drive(drive, DriveOrder::Raise(AlarmCause::Overload)))),
    ];
    prop::collection::vec((0..8_000u64, happening), 1..20).prop_map(|mut all| {
        all.sort_by_key(|(at, _)| *at);
        all
    })
}

/// Orders to a stepper, its settings changed and its state read in between.
fn orders() -> impl Strategy<Value = Vec<(u64, Happening)>> {
    let drive = DriveId(0);
    let setting = (0x001D..=0x0025u16, 0..400u16).prop_map(|(at, value)| request(1, at, value));
    let order = (0..0x400u16).prop_map(|bits| request(1, 0x0027, bits));
    let other = prop::sample::select(&[0x11u16, 0x12, 0x12, 0x31][..]);
    let other = other.prop_map(|value| request(1, 0x002D, value));
    let read = Just(rtu::encode(1, &[3, 0, 7, 0, 6]).to_vec());
    let happening = prop_oneof![
        4 => order.prop_map(Happening::Bytes),
        3 => setting.prop_map(Happening::Bytes),
        3 => read.prop_map(Happening::Bytes),
        1 => other.prop_map(Happening::Bytes),
        1 => Just(Happening::Do(Command::Drive(drive, DriveOrder::PowerCycle))),
    ];
    prop::collection::vec((0..8_000u64, happening), 1..30).prop_map(|mut all| {
        all.sort_by_key(|(at, _)| *at);
        all
    })
}

/// Ten seconds of a drive, looked at in between at `slices`.
fn live(model: &str, happenings: &[(u64, Happening)], slices: &[u64]) -> (Vec<Event>, Vec<u8>) {
    let (mut bus, link) =
        bus(model, Framing::Rtu { silence: Duration::from_millis(4), patience: Some(GAP) });
    let (mut events, mut sent) = (Vec::new(), Vec::new());
    let mut looks: Vec<(u64, Option<&Happening>)> = slices.iter().map(|at| (*at, None)).collect();
    looks.extend(happenings.iter().map(|(at, happening)| (*at, Some(happening))));
    looks.sort_by_key(|(at, _)| *at);
    looks.push((10_000, None));
    for (at, happening) in looks {
        let now = Instant::from_millis(at);
        match happening {
            // Looking changes nothing that comes later.
            None => {
                bus.advance_to(now);
                bus.drives().for_each(|(id, _)| look(bus.view(id)));
            }
            Some(Happening::Bytes(bytes)) => bus.receive(now, link, bytes),
            Some(Happening::Do(command)) => {
                bus.command(now, command.clone()).expect("a drive that has it all");
            }
        }
        let drained = drain(&mut bus);
        events.extend(drained.events);
        sent.extend(drained.sent);
        assert!(bus.poll_at().is_none_or(|wake| wake.at > now), "something is overdue");
        assert_eq!(bus.now(), now);
    }
    (events, sent)
}

/// Looks at everything that a drive shows.
fn look(drive: View<'_>) {
    let numbers = Quantity::ALL.iter().map(|it| drive.quantity(*it)).sum::<i64>();
    let rows = drive.model().map.rows().map(|(row, _)| u64::from(drive.show(row))).sum::<u64>();
    let signals = Output::ALL.iter().filter(|it| drive.output(**it)).count();
    std::hint::black_box((numbers, rows, signals, drive.axis_state()));
}

fn bus(model: &str, framing: Framing) -> (Bus, LinkId) {
    let mut bus = line_of(text_of(model), &[], &DeviceSpec::default()).bus(0);
    let link = bus.open(framing);
    drain(&mut bus);
    (bus, link)
}

/// The properties above would hold for a drive that does nothing: here something happens.
#[test]
fn the_slices_have_something_to_cut() {
    let mut happenings = vec![
        (0, Happening::Bytes(request(1, 0x0401, 0))),
        (1, Happening::Bytes(request(1, 0x0905, 2))),
        (2, Happening::Bytes(request(1, 0x3607, 2))),
        (3, Happening::Bytes(vec![1, 2, 3, 4])),
    ];
    happenings.push((8_000, Happening::Do(Command::Drive(DriveId(0), DriveOrder::PowerCycle))));
    let (events, _) = live("hcfa-x", &happenings, &[]);
    let at = |ms| {
        events
            .iter()
            .filter(|it| it.at == Instant::from_millis(ms))
            .map(|it| it.kind.clone())
            .collect::<Vec<_>>()
    };
    assert!(matches!(at(23)[..], [EventKind::BadCrc { .. }]), "silence ends a frame");
    assert!(
        matches!(at(1000)[..], [EventKind::Drive { .. }, EventKind::Drive { .. }]),
        "ready, and so servo on"
    );
    assert!(
        matches!(at(5002)[..], [EventKind::Drive { .. }, EventKind::Drive { .. }]),
        "word gone, and so servo off"
    );
    assert!(matches!(at(9000)[..], [EventKind::Drive { .. }]), "ready again");
}
