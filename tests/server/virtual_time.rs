//! A master library against a drive in this process, under a paused clock: seconds pass in no time.

use crate::kit::rig;
use drivemu::bench::DeviceSpec;
use drivemu::testkit::live;
use std::time::Duration;
use tokio_modbus::client::rtu;
use tokio_modbus::prelude::*;

/// The bit of the status word that says "enabled", as the master of a PLC would look at it.
async fn servo_is_on(master: &mut client::Context) -> bool {
    let read =
        master.read_holding_registers(0x3607, 1).await.expect("an answer").expect("no exception");
    read[0] == 2
}

#[tokio::test(start_paused = true)]
async fn a_five_second_watchdog() {
    let drive = rig("hcfa-x", &[], &DeviceSpec::default());
    let (stream, serve) = live::stream(drive);
    let serving = tokio::spawn(serve);
    let mut master = rtu::attach_slave(stream, Slave(1));
    wait(Duration::from_secs(1)).await;
    master.write_single_register(0x0905, 2).await.expect("an answer").expect("no exception");
    master.write_single_register(0x3607, 2).await.expect("an answer").expect("no exception");
    wait(Duration::from_millis(4900)).await;
    assert!(servo_is_on(&mut master).await);
    wait(Duration::from_millis(200)).await;
    assert!(!servo_is_on(&mut master).await);
    drop(master);
    serving.await.expect("no panic").expect("a clean end");
}

#[allow(clippy::disallowed_methods)] // The clock is paused: nothing waits.
async fn wait(time: Duration) {
    tokio::time::sleep(time).await;
}
