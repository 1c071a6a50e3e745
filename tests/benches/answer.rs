//! What an answer costs, as ratios against a named baseline in the same run.
//!
//! `cargo bench --bench answer`. In process: a read of two registers against the CRC of its request, which is the
//! least that any Modbus slave must do. Through a pseudo-terminal: the same read against a bare echo of eight
//! bytes with the same client.

#![allow(clippy::disallowed_methods, clippy::print_stdout, missing_docs)] // A benchmark measures the wall.

use drivemu::bus::{Bus, Output};
use drivemu::line::Framing;
use drivemu::model::builtin::Builtin;
use drivemu::testkit::hex;
use drivemu::time::{Duration, Instant};
use drivemu::wire::crc16;
use std::hint::black_box;
use std::time::Instant as Wall;

fn main() {
    in_process();
    #[cfg(feature = "cli")]
    pseudo_terminal::compare();
}

fn in_process() {
    let model = Builtin::find(Builtin::default_name()).expect("the default model");
    let model = model.load(&Default::default()).expect("a valid model");
    let mut bus = Bus::new();
    bus.add(model.into(), &Default::default(), 0);
    let link = bus.open(Framing::Rtu {
        silence: Duration::from_millis(4),
        patience: Some(Duration::from_millis(20)),
    });
    let request = hex("01 03 00 0A 00 02 E4 09").expect("hex");
    let mut now = Instant::ZERO;
    let answer = median(200_000, || {
        now += Duration::from_millis(1);
        bus.receive(now, link, black_box(&request));
        while let Some(output) = bus.poll_output() {
            black_box(matches!(output, Output::Transmit { .. }));
        }
    });
    let crc = median(200_000, || {
        black_box(crc16(black_box(&request)));
    });
    println!(
        "in process   answer {answer:6.0} ns   crc of the request {crc:6.1} ns   ratio {:.1}",
        answer / crc
    );
}

/// Median of the nanoseconds that one call takes, over 21 rounds.
fn median(calls: u32, mut call: impl FnMut()) -> f64 {
    let mut rounds: Vec<f64> = (0..21)
        .map(|_| {
            let start = Wall::now();
            (0..calls / 21).for_each(|_| call());
            start.elapsed().as_nanos() as f64 / f64::from(calls / 21)
        })
        .collect();
    rounds.sort_by(f64::total_cmp);
    rounds[10]
}

#[cfg(feature = "cli")]
mod pseudo_terminal {
    use super::*;
    use drivemu::server::port::pty::Pty;
    use std::future::poll_fn;
    use std::io::{Read, Write};
    use std::path::PathBuf;
    use std::sync::mpsc::Sender;

    /// Both servers run in threads of their own; the two are asked in turn, so that a machine whose speed
    /// drifts drifts for both.
    pub fn compare() {
        let (echo, drive) = (serve_echo(), serve_drive());
        let (mut echo, mut drive) = (Client::open(&echo, 8), Client::open(&drive, 9));
        let (mut echoes, mut answers) = (Vec::new(), Vec::new());
        for _ in 0..40 {
            echoes.push(echo.round_trip_us(100));
            answers.push(drive.round_trip_us(100));
        }
        [&mut echoes, &mut answers].into_iter().for_each(|it| it.sort_by(f64::total_cmp));
        let (echo, answer) = (echoes[20], answers[20]);
        println!(
            "pty          answer {answer:6.1} us   bare echo {echo:6.1} us   ratio {:.2}",
            answer / echo
        );
    }

    struct Client {
        port: std::fs::File,
        answer: usize,
    }

    impl Client {
        fn open(path: &PathBuf, answer: usize) -> Self {
            let port = std::fs::OpenOptions::new().read(true).write(true).open(path);
            Self { port: port.expect("the terminal"), answer }
        }

        fn round_trip_us(&mut self, times: u32) -> f64 {
            let request = hex("01 03 00 0A 00 02 E4 09").expect("hex");
            let mut answer = vec![0; self.answer];
            let start = Wall::now();
            for _ in 0..times {
                self.port.write_all(&request).expect("written");
                self.port.read_exact(&mut answer).expect("an answer");
            }
            start.elapsed().as_nanos() as f64 / 1e3 / f64::from(times)
        }
    }

    fn serve_echo() -> PathBuf {
        serve(|path| async move {
            let mut pty = Pty::open(None).expect("a pseudo-terminal");
            path.send(pty.path().to_owned()).expect("somebody waits");
            let mut buffer = [0; 256];
            loop {
                let read = poll_fn(|cx| pty.poll_read(cx, &mut buffer));
                let input = read.await.expect("bytes");
                pty.write_now(&buffer[..input.len]).expect("sent");
            }
        })
    }

    fn serve_drive() -> PathBuf {
        use drivemu::bench::{Device, WireSpec};
        use drivemu::bus::Carrier;
        use drivemu::server::port::TtyPort;
        use drivemu::server::{Clock, LineHandle, LineServer};
        serve(|path| async move {
            let model = Builtin::find(Builtin::default_name()).expect("the default model");
            let model = model.load(&Default::default()).expect("a valid model");
            let device = Device::new(model.into(), &Default::default()).expect("no settings");
            let mut bus = Bus::new();
            bus.add(device.model.clone(), &device.setups[0], 0);
            let wire = WireSpec::of(std::slice::from_ref(&device), None, None, false);
            let port = TtyPort::pty("line".into(), None, wire.mode.settings);
            let port = port.expect("a pseudo-terminal");
            let opened = port.paths().0.expect("it is open");
            path.send(opened.into()).expect("somebody waits");
            let (_handle, inbox) = LineHandle::new();
            let mut line = LineServer::new("line".into(), bus, wire, Clock::start(1.0), inbox);
            line.open(Box::new(port), Carrier::Serial);
            line.serve().await.expect("it does not end");
        })
    }

    fn serve<F: Future<Output = ()>>(
        serve: impl FnOnce(Sender<PathBuf>) -> F + Send + 'static,
    ) -> PathBuf {
        let (path, opened) = std::sync::mpsc::channel();
        std::thread::spawn(move || {
            let runtime = tokio::runtime::Builder::new_current_thread().enable_all().build();
            runtime.expect("a runtime").block_on(serve(path));
        });
        opened.recv().expect("a path")
    }
}
