//! A master that nobody here wrote lives with each line behaviour, or notices it: tokio-modbus, under a paused clock.

use super::line;
use drivemu::testkit::{Rig, live};
use std::time::Duration;
use tokio_modbus::client::rtu;
use tokio_modbus::prelude::*;

/// What each of some reads gives, and how long the first took.
async fn reads(line_behaviour: &str, pause: Duration) -> (Vec<Option<u16>>, Duration) {
    let rig = Rig::line(line(&format!("pty: auto, {line_behaviour}, drives: [{{model: hcfa-x}}]")));
    let (stream, serve) = live::stream(rig);
    let serving = tokio::spawn(serve);
    let mut master = rtu::attach_slave(stream, Slave(1));
    let (mut seen, mut first) = (Vec::new(), None);
    for _ in 0..40 {
        let asked = tokio::time::Instant::now();
        let read = master.read_holding_registers(0x0304, 1);
        let read = tokio::time::timeout(Duration::from_secs(1), read).await;
        seen.push(read.ok().and_then(Result::ok).and_then(Result::ok).map(|words| words[0]));
        first.get_or_insert(asked.elapsed());
        wait(pause).await;
    }
    drop(master);
    serving.await.expect("no panic").expect("a clean end");
    (seen, first.unwrap_or_default())
}

#[tokio::test(start_paused = true)]
async fn a_master_waits_for_a_paced_reply() {
    let (seen, took) = reads("pacing: line", Duration::ZERO).await;
    assert_eq!(seen, [Some(100); 40]);
    // The timer of the runtime has steps of a millisecond.
    let late = took.saturating_sub(Duration::from_nanos(14_031_250));
    assert!(took >= Duration::from_millis(14) && late <= Duration::from_millis(2), "{took:?}");
}

#[tokio::test(start_paused = true)]
async fn a_master_puts_lumps_together() {
    let (seen, took) = reads("chunk: 16ms", Duration::ZERO).await;
    assert_eq!(seen, [Some(100); 40]);
    // Whatever is left of the period, and the timer of the runtime.
    assert!(took > Duration::ZERO && took <= Duration::from_millis(17), "{took:?}");
    let (seen, _) = reads("chunk: 4ms, pacing: line", Duration::ZERO).await;
    assert_eq!(seen, [Some(100); 40]);
}

/// It has no option for an echo, and takes it for a bad reply.
#[tokio::test(start_paused = true)]
async fn a_master_notices_an_echo() {
    let (seen, _) = reads("echo: true", Duration::ZERO).await;
    assert!(seen.contains(&None));
}

/// What others said before it asked lies before the reply: an error, never another drive's value.
#[tokio::test(start_paused = true)]
async fn a_master_among_others() {
    let pause = Duration::from_millis(30);
    let (seen, _) = reads("chatter: {units: [7]}", pause).await;
    assert!(seen.contains(&None) && seen.iter().flatten().all(|value| *value == 100), "{seen:?}");
}

#[allow(clippy::disallowed_methods)] // The clock is paused: nothing waits.
async fn wait(time: Duration) {
    tokio::time::sleep(time).await;
}
