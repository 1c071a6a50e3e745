//! A master that nobody here wrote notices each kind, under a paused clock: tokio-modbus.

use super::{drive, drive_of};
use drivemu::medium::FaultKind;
use drivemu::testkit::live;
use std::time::Duration;
use tokio_modbus::client::{Context, rtu};
use tokio_modbus::prelude::*;

/// What a master makes of a read.
#[derive(Debug, PartialEq, Eq)]
enum Seen {
    /// The value, 100.
    Value,
    /// The value, but only after 150 ms.
    Slowly,
    /// That exception.
    Exception(ExceptionCode),
    /// Nothing within a second.
    Silence,
    /// A frame that is none, or not the one that was asked for.
    Bad,
}

async fn look(master: &mut Context) -> Seen {
    let asked = tokio::time::Instant::now();
    let read = master.read_holding_registers(0x0304, 1);
    match tokio::time::timeout(Duration::from_secs(1), read).await {
        Err(_) => Seen::Silence,
        Ok(Err(_)) => Seen::Bad,
        Ok(Ok(Err(code))) => Seen::Exception(code),
        Ok(Ok(Ok(words))) if words != [100] => Seen::Bad,
        Ok(Ok(Ok(_))) if asked.elapsed() > Duration::from_millis(150) => Seen::Slowly,
        Ok(Ok(Ok(_))) => Seen::Value,
    }
}

/// What it sees twice in a row.
async fn two_looks(spec: &str) -> [Seen; 2] {
    let (stream, serve) = live::stream(drive(&[spec]));
    let serving = tokio::spawn(serve);
    let mut master = rtu::attach_slave(stream, Slave(1));
    let seen = [look(&mut master).await, look(&mut master).await];
    drop(master);
    serving.await.expect("no panic").expect("a clean end");
    seen
}

/// Where a stepper stands after a relative move by 1000 counts, given by a master that simply tries again, and
/// the orders that the log says came again.
async fn moved_by_a_stubborn_master(spec: &str) -> (u16, usize) {
    let folder = tempfile::tempdir().expect("a folder");
    let file = folder.path().join("log");
    let rig = drive_of("yako-closed-loop", &[spec], 0);
    let (stream, serve) = live::logged(rig, &file).expect("a file");
    let serving = tokio::spawn(serve);
    let mut master = rtu::attach_slave(stream, Slave(1));
    let distance = master.write_multiple_registers(0x0024, &[0, 1000]).await;
    distance.expect("an answer").expect("no exception");
    for _ in 0..3 {
        let order = master.write_single_register(0x0027, 1);
        if tokio::time::timeout(Duration::from_secs(5), order).await.is_ok() {
            break;
        }
    }
    let end = tokio::time::timeout(Duration::from_secs(5), std::future::pending::<()>());
    end.await.expect_err("five seconds");
    let position = master.read_holding_registers(0x000A, 2).await;
    let position = position.expect("an answer").expect("no exception");
    drop(master);
    serving.await.expect("no panic").expect("a clean end");
    let log = std::fs::read_to_string(file).expect("the log");
    (position[1], log.matches("\"event\":\"repeated_command\"").count())
}

#[tokio::test(start_paused = true)]
async fn a_stubborn_master_moves_twice_and_is_told_on() {
    let moved = moved_by_a_stubborn_master("lose_reply:register=0x0027,count=1").await;
    assert_eq!(moved, (2000, 1));
    let moved = moved_by_a_stubborn_master("lose_request:register=0x0027,count=1").await;
    assert_eq!(moved, (1000, 0));
}

#[tokio::test(start_paused = true)]
async fn a_master_notices_each_kind() {
    for kind in FaultKind::ALL {
        let busy = Seen::Exception(ExceptionCode::ServerDeviceBusy);
        let (spec, want) = match kind.name {
            "lose_request" => ("lose_request:count=1", [Seen::Silence, Seen::Value]),
            "lose_reply" => ("lose_reply:count=1", [Seen::Silence, Seen::Value]),
            "bad_crc" => ("bad_crc:count=1", [Seen::Silence, Seen::Value]),
            "flip_bits" => ("flip_bits:count=1", [Seen::Silence, Seen::Value]),
            "truncate" => ("truncate:count=1", [Seen::Silence, Seen::Value]),
            "extra" => ("extra:count=1,bytes=9", [Seen::Value, Seen::Value]),
            "garbage" => ("garbage:count=1", [Seen::Value, Seen::Value]),
            "delay" => ("delay:count=1,ms=200", [Seen::Slowly, Seen::Value]),
            "late" => ("late:count=1", [Seen::Silence, Seen::Value]),
            "reorder" => ("reorder:count=1", [Seen::Silence, Seen::Value]),
            "duplicate" => ("duplicate:count=1", [Seen::Value, Seen::Value]),
            "split" => ("split:count=1,gap_ms=200", [Seen::Slowly, Seen::Value]),
            "wrong_unit" => ("wrong_unit:count=1", [Seen::Bad, Seen::Value]),
            "wrong_function" => ("wrong_function:count=1", [Seen::Bad, Seen::Value]),
            "exception" => {
                let device = Seen::Exception(ExceptionCode::ServerDeviceFailure);
                ("exception:code=4,count=1", [device, Seen::Value])
            }
            "busy" => ("busy:count=1", [busy, Seen::Value]),
            // What is left over of the first spoils the second.
            "echo" => ("echo:count=1", [Seen::Bad, Seen::Bad]),
            _ => panic!("nobody tests `{kind}`"),
        };
        assert_eq!(two_looks(spec).await, want, "{spec}");
    }
}
