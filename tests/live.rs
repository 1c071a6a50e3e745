//! `testkit::live` serves the rig that it is given, and nothing else: what was done to it, what is under way, what is
//! to come.

use crate::kit::{bench_line, rig};
use drivemu::bench::DeviceSpec;
use drivemu::bus::{Command, CommandError, DriveOrder, Reply};
use drivemu::event::{DeviceFault, DriveId};
use drivemu::testkit::{Rig, hex, live, to_hex};
use drivemu::vocabulary::AlarmCause;
use drivemu::wire::{crc16, rtu};
use std::time::Duration;
use tokio::io::{AsyncReadExt, AsyncWriteExt};

const FIRST: DriveId = DriveId(0);
/// Relative move by 10000 counts at 60 rpm, 1000 counts/s.
const TARGET: &str = "01 10 0023 0003 06 003C 0000 2710";
const MOVE: &str = "01 06 0027 0001";
const POSITION: &str = "01 03 000A 0002";
const STATUS: &str = "01 03 0006 0002";

/// A stepper at unit 1, closed loop.
fn stepper() -> Rig {
    rig("yako-closed-loop", &[], &DeviceSpec::default())
}

/// The answers of `rig` behind a stream to requests at these times, in milliseconds after it is served; each without
/// its CRC, or empty where none comes within a second.
async fn answers(rig: Rig, requests: &[(u64, &str)]) -> Vec<String> {
    let (mut master, serve) = live::stream(rig);
    let serving = tokio::spawn(serve);
    let (mut answers, start) = (Vec::new(), tokio::time::Instant::now());
    for (at, request) in requests {
        tokio::time::sleep_until(start + Duration::from_millis(*at)).await;
        let mut frame = hex(request).expect("hex");
        frame.extend(crc16(&frame).to_le_bytes());
        master.write_all(&frame).await.expect("somebody reads");
        let mut answer = vec![0; 256];
        let read = tokio::time::timeout(Duration::from_secs(1), master.read(&mut answer)).await;
        answer.truncate(read.map_or(0, |read| read.expect("bytes")));
        if !answer.is_empty() {
            rtu::decode(&answer).expect("a frame");
        }
        answers.push(to_hex(&answer[..answer.len().saturating_sub(2)]));
    }
    drop(master);
    serving.await.expect("no panic").expect("a clean end");
    answers
}

async fn answer(rig: Rig, request: &str) -> String {
    answers(rig, &[(0, request)]).await.remove(0)
}

/// Is `position` (the answer to [`POSITION`]) within 5 counts of `want`? The clock of the runtime has steps of 1 ms.
fn is_near(position: &str, want: i64) -> bool {
    let bytes = hex(position).expect("hex");
    let position = i32::from_be_bytes(bytes[3..7].try_into().expect("a pair"));
    (i64::from(position) - want).abs() <= 5
}

#[tokio::test(start_paused = true)]
async fn values_and_what_was_set_up() {
    let mut drive = stepper();
    drive.ask("01 06 001D 0123");
    assert_eq!(answer(drive, "01 03 001D 0001").await, "01 03 02 01 23");
    let spec = DeviceSpec { unit: Some(7), ..DeviceSpec::default() };
    let other = rig("yako-closed-loop", &[], &spec);
    assert_eq!(answer(other, "07 03 0002 0001").await, "07 03 02 00 07");
}

#[tokio::test(start_paused = true)]
async fn an_alarm_and_what_is_wrong_with_the_device() {
    let mut drive = stepper();
    drive
        .command(Command::Drive(FIRST, DriveOrder::Raise(AlarmCause::OverVoltage)))
        .expect("it can");
    let device_fault = DeviceFault::Cause(AlarmCause::OverVoltage);
    drive
        .command(Command::Drive(FIRST, DriveOrder::DeviceFault { device_fault, on: true }))
        .expect("it can");
    let before = drive.ask(STATUS);
    let seen = answers(drive, &[(0, STATUS), (10, "01 06 002D 0021"), (20, STATUS)]).await;
    assert_ne!(before, stepper().ask(STATUS), "an alarm shows");
    assert_eq!((&seen[0], &seen[2]), (&before, &before), "no reset helps while its cause stands");
}

#[tokio::test(start_paused = true)]
async fn a_drive_without_power_and_a_terminal() {
    let mut drive = stepper();
    drive.command(Command::Drive(FIRST, DriveOrder::Power(false))).expect("it can");
    assert_eq!(answer(drive, STATUS).await, "");
    let mut drive = stepper();
    drive
        .command(Command::Drive(FIRST, DriveOrder::Terminal { index: 0, signal: true }))
        .expect("it can");
    let seen = drive.ask("01 03 0008 0001");
    assert_ne!(seen, stepper().ask("01 03 0008 0001"));
    assert_eq!(answer(drive, "01 03 0008 0001").await, seen);
}

/// The time goes on: a move that was under way for a second is where it is after two.
#[tokio::test(start_paused = true)]
async fn a_motion_under_way_and_the_time() {
    let (mut served, mut same) = (stepper(), stepper());
    for rig in [&mut served, &mut same] {
        rig.ask(TARGET);
        rig.ask(MOVE);
        rig.advance(Duration::from_secs(1));
    }
    let began = same.ask(POSITION);
    same.advance(Duration::from_secs(1));
    let later = same.ask(POSITION);
    assert!(began != later && !is_near(&later, 10_000));
    let seen = answers(served, &[(0, POSITION), (1000, POSITION), (20_000, POSITION)]).await;
    let whole = |text: &str| {
        let bytes = hex(text).expect("hex");
        i64::from(i32::from_be_bytes(bytes[3..7].try_into().expect("a pair")))
    };
    assert!(is_near(&seen[0], whole(&began)), "{seen:?} {began}");
    assert!(is_near(&seen[1], whole(&later)), "{seen:?} {later}");
    assert!(is_near(&seen[2], 10_000), "{seen:?}");
}

/// A watchdog that had a second left has it still.
#[tokio::test(start_paused = true)]
async fn a_watchdog_that_runs() {
    let mut drive = rig("hcfa-x", &[], &DeviceSpec::default());
    drive.ask("01 06 0905 0002");
    drive.ask("01 06 3607 0002");
    drive.advance(Duration::from_secs(4));
    let word = "01 03 3607 0001";
    let seen = answers(drive, &[(900, word), (1100, word)]).await;
    assert_eq!(seen, ["01 03 02 00 02", "01 03 02 00 00"]);
}

/// A rule that was added is there, and has acted as often as it has.
#[tokio::test(start_paused = true)]
async fn fault_rules_and_how_often_they_have_acted() {
    let mut drive = stepper();
    drive.add_fault("busy:count=2").expect("a good rule");
    let busy = drive.ask(POSITION);
    assert_eq!(busy, "01 83 06");
    let seen = answers(drive, &[(0, POSITION), (10, POSITION)]).await;
    assert_eq!(seen, [busy, "01 03 04 00 00 00 00".into()]);
}

/// While it is served, a line takes commands; one that it refuses says why.
#[tokio::test(start_paused = true)]
async fn commands_to_a_line_that_is_served() {
    let healthy = stepper().ask(STATUS);
    let (mut master, line, serve) = live::commanded(stepper());
    let serving = tokio::spawn(serve);
    let raise = |drive| Command::Drive(drive, DriveOrder::Raise(AlarmCause::OverVoltage));
    assert_eq!(line.command(raise(FIRST)).await, Ok(Reply::Done));
    let refused = line.command(raise(DriveId(7))).await.expect_err("there is one drive");
    assert_eq!(refused, live::InboxError::Refused(CommandError::NoDrive(7)));
    let request = rtu::encode(1, &hex(STATUS).expect("hex")[1..]);
    master.write_all(&request).await.expect("somebody reads");
    let mut answer = vec![0; healthy.split(' ').count() + 2];
    master.read_exact(&mut answer).await.expect("an answer");
    assert_ne!(to_hex(&answer[..answer.len() - 2]), healthy);
    line.stop().await;
    serving.await.expect("no panic").expect("a clean end");
    assert_eq!(master.read(&mut [0; 8]).await.expect("an end"), 0);
    assert_eq!(line.command(raise(FIRST)).await, Err(live::InboxError::Ended));
}

/// A reply that was held back for the next request leaves with it, on the stream.
#[tokio::test(start_paused = true)]
async fn a_reply_that_is_late() {
    let mut drive = stepper();
    drive.add_fault("late:count=1").expect("a good rule");
    assert_eq!(drive.ask("01 03 0002 0001"), "");
    let (mut master, serve) = live::stream(drive);
    let serving = tokio::spawn(serve);
    let request = rtu::encode(1, &[3, 0, 0x06, 0, 1]);
    master.write_all(&request).await.expect("somebody reads");
    let mut both = [0; 14];
    master.read_exact(&mut both).await.expect("two answers");
    assert_eq!(both[..7], *rtu::encode(1, &[3, 2, 0, 1]));
    drop(master);
    serving.await.expect("no panic").expect("a clean end");
}

/// What a rule draws goes by the rig's seed, and goes on from the request that it has come to.
#[tokio::test(start_paused = true)]
async fn the_seed() {
    let spec = "lose_reply:probability=0.5";
    for seed in [1, 2] {
        let rig = || stepper().with_seed(seed).with_fault(spec).expect("a good rule");
        let (mut whole, mut served) = (rig(), rig());
        let want: Vec<_> = (0..24).map(|_| whole.ask(POSITION)).collect();
        let first: Vec<_> = (0..8).map(|_| served.ask(POSITION)).collect();
        let requests: Vec<_> = (0..16).map(|i| (2000 * i, POSITION)).collect();
        assert_eq!([first, answers(served, &requests).await].concat(), want, "seed {seed}");
    }
}

/// The steps of a scenario that have come have come, the others come at their time.
#[tokio::test(start_paused = true)]
async fn a_scenario() {
    let steps = "steps:
        - {name: trip, at: 1s, do: [raise over_voltage]}
        - {name: off and on, at: 3s, do: [power_cycle]}";
    let mut drive = stepper().with_scenario(steps).expect("a good scenario");
    drive.advance(Duration::from_secs(2));
    let alarm = drive.ask(STATUS);
    let healthy = stepper().ask(STATUS);
    assert_ne!(alarm, healthy);
    let seen = answers(drive, &[(0, STATUS), (900, STATUS), (1100, STATUS)]).await;
    assert_eq!(seen, [alarm.clone(), alarm, healthy]);
}

#[tokio::test(start_paused = true)]
async fn what_was_kept() {
    let mut before = rig("hcfa-x", &[], &DeviceSpec::default());
    before.ask("01 06 E304 00FA");
    let after = rig("hcfa-x", &[], &DeviceSpec::default()).with_state(&before.state());
    let after = after.unwrap_or_else(|problems| panic!("{}", problems[0]));
    assert_eq!(answer(after, "01 03 0304 0001").await, "01 03 02 00 FA");
}

/// A line goes on at the speed that its drives have taken it to, and in the framing that it was given.
#[tokio::test(start_paused = true)]
async fn the_line_as_it_is() {
    let gap = Duration::from_millis(100);
    let drive = rig("k-series", &[], &DeviceSpec::default());
    let drive = drive.with_framing(drivemu::line::Framing::Ascii { gap });
    let (mut master, serve) = live::stream(drive);
    let serving = tokio::spawn(serve);
    let request = drivemu::wire::ascii::encode(1, &[3, 0x04, 0x57, 0, 1]);
    master.write_all(&request).await.expect("somebody reads");
    let mut head = [0; 5];
    master.read_exact(&mut head).await.expect("an answer");
    assert_eq!(&head, b":0103");
    drop(master);
    serving.await.expect("no panic").expect("a clean end");
}

/// The log of what is served begins with the rig's time and names its line.
#[tokio::test(start_paused = true)]
async fn the_log_is_that_of_the_rig() {
    let line = bench_line("lines: [{name: axis, pty: auto, drives: [{model: yako-closed-loop}]}]");
    let mut drive = Rig::line(line);
    drive.ask("01 06 001D 0123");
    drive.advance(Duration::from_secs(5));
    let folder = tempfile::tempdir().expect("a folder");
    let file = folder.path().join("log");
    let (mut master, serve) = live::logged(drive, &file).expect("a file");
    let serving = tokio::spawn(serve);
    let mut answer = [0; 7];
    master.write_all(&rtu::encode(1, &[3, 0, 0x1D, 0, 1])).await.expect("somebody reads");
    master.read_exact(&mut answer).await.expect("an answer");
    drop(master);
    serving.await.expect("no panic").expect("a clean end");
    let log = std::fs::read_to_string(file).expect("the log");
    let entries: Vec<serde_json::Value> =
        log.lines().map(|line| serde_json::from_str(line).expect("JSON")).collect();
    assert!(entries.iter().all(|entry| entry["line"] == "axis"), "{log}");
    assert_eq!(entries[0]["event"], "power_on");
    let write = entries.iter().find(|entry| entry["event"] == "write").expect("the first request");
    let read = entries.last().expect("the last request");
    assert!(write["t"].as_f64() < Some(1.0) && read["t"].as_f64() >= Some(5.0), "{log}");
}

/// A rig in use is not switched on anew behind the back of its test.
#[test]
fn a_rig_in_use_is_set_up_no_more() {
    let uses: [fn(&mut Rig); 3] = [
        |rig| drop(rig.ask(POSITION)),
        |rig| drop(rig.advance(Duration::from_millis(1))),
        |rig| rig.add_fault("lose_reply").expect("a good rule"),
    ];
    let sets_up: [fn(Rig); 6] = [
        |rig| drop(rig.with_seed(1)),
        |rig| drop(rig.with_fault("late")),
        |rig| drop(rig.with_line_behaviour(drivemu::medium::LineBehaviour::default())),
        |rig| drop(rig.with_scenario("steps: []")),
        |rig| drop(rig.with_framing(drivemu::line::Framing::Mbap)),
        |rig| drop(rig.with_state("")),
    ];
    for (i, act) in uses.iter().enumerate() {
        for (j, set_up) in sets_up.iter().enumerate() {
            let mut rig = stepper();
            act(&mut rig);
            let caught = std::panic::catch_unwind(std::panic::AssertUnwindSafe(|| set_up(rig)));
            let why = caught.err().and_then(|why| why.downcast::<String>().ok());
            let told = why.is_some_and(|why| why.contains("must be called before the first use"));
            assert!(told, "use {i}, set up {j}");
        }
    }
}

/// Each thing that a rig is set up with outlasts the next.
#[test]
fn all_that_a_rig_is_set_up_with_counts() {
    let steps = "steps: [{name: trip, at: 500ms, do: [raise over_voltage]}]";
    let mut before = stepper();
    before.ask("01 06 001D 0123");
    before.ask("01 06 002D 0042");
    let rig = stepper().with_scenario(steps).and_then(|rig| rig.with_fault("busy:count=1"));
    let rig = rig.and_then(|rig| rig.with_state(&before.state()));
    let mut rig = rig.unwrap_or_else(|problems| panic!("{}", problems[0])).with_seed(3);
    assert_eq!(rig.ask("01 03 001D 0001"), "01 83 06");
    assert_eq!(rig.ask("01 03 001D 0001"), "01 03 02 01 23");
    rig.advance(Duration::from_secs(1));
    assert_ne!(rig.ask(STATUS), stepper().ask(STATUS));
}
