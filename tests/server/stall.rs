//! A process that is kept from running: what arrived meanwhile comes before what fell due meanwhile.

use super::program::{Program, wait_for};
use drivemu::wire::{mbap, rtu};
use std::fs::OpenOptions;
use std::io::{Read, Write};
use std::net::TcpStream;
use std::time::Duration;

/// A port as a master has it open.
trait Port: Read + Write {}
impl<T: Read + Write> Port for T {}

fn ask(port: &mut dyn Port, tcp: bool, pdu: &[u8]) -> Vec<u8> {
    let frame = if tcp { mbap::encode(1, 1, pdu) } else { rtu::encode(1, pdu) };
    port.write_all(&frame).expect("written");
    frame.to_vec()
}

fn hears(port: &mut dyn Port, echo: &[u8]) {
    let mut got = vec![0; echo.len()];
    port.read_exact(&mut got).expect("an answer");
    assert_eq!(got, echo);
}

/// The servo's word of inputs holds for five seconds; at this rate that is one of the wall. The process stands still for
/// longer, while a refresh is waiting: the word is refreshed before it could expire, and holds for five more from there,
/// whatever a homing does by itself meanwhile.
#[allow(clippy::disallowed_methods)] // The time of the wall is what is tested.
fn a_refresh_that_waits_is_in_time(args: &[&str]) {
    let homing = ["--set", "P08.88=4", "--set", "P08.89=6"];
    let program = Program::run(&[&["hcfa-x", "--rate", "5"], &homing[..], args].concat());
    let tcp = args.first() == Some(&"--tcp");
    let mut port: Box<dyn Port> = match args {
        [] => Box::new(OpenOptions::new().read(true).write(true).open(program.path()).unwrap()),
        _ => Box::new(TcpStream::connect(program.addr()).expect("connects")),
    };
    for pdu in [[6, 0x09, 0x05, 0, 2], [6, 0x36, 0x07, 0, 2]] {
        let echo = ask(&mut *port, tcp, &pdu);
        hears(&mut *port, &echo);
    }
    program.signal("STOP");
    let stat = format!("/proc/{}/stat", program.id());
    wait_for("the process to stop", || {
        std::fs::read_to_string(&stat).is_ok_and(|stat| stat.contains(") T "))
    });
    let echo = ask(&mut *port, tcp, &[6, 0x36, 0x07, 0, 2]);
    std::thread::sleep(Duration::from_millis(1400));
    program.signal("CONT");
    hears(&mut *port, &echo);
    let (_, log, _) = program.stop("TERM");
    let lines: Vec<_> = log.lines().collect();
    let seconds = |line: &&str| line.split(' ').next().and_then(|it| it.parse::<f64>().ok());
    let writes: Vec<_> = lines.iter().filter(|line| line.contains("write VDI1")).collect();
    assert_eq!(writes.len(), 2, "{log}");
    if let Some(expired) = lines.iter().find(|line| line.contains("not refreshed")) {
        let [first, expired] = [writes[0], expired].map(|line| seconds(line).expect("a time"));
        assert!(expired - first > 9.9, "{args:?}\n{log}");
    }
}

#[cfg(target_os = "linux")]
#[test]
fn a_refresh_that_waited_comes_before_the_watchdog() {
    std::thread::scope(|scope| {
        for args in [&[][..], &["--tcp", "127.0.0.1:0"], &["--rtu-over-tcp", "127.0.0.1:0"]] {
            scope.spawn(move || a_refresh_that_waits_is_in_time(args));
        }
    });
}
