//! A master whose port is set to another speed than the line: told, and with `--match-baud` not understood.

use super::program::{Program, once, wait_for};
use drivemu::testkit::hex;
use drivemu::wire::rtu;
use rustix::termios::{ControlModes, OptionalActions, tcgetattr, tcsetattr};
use std::fs::{File, OpenOptions, read_to_string};
use std::io::{Read, Write};

const READ: &str = "01 03 03 04 00 01 C5 8F";
const ANSWER: &str = "01 03 02 00 64 B9 AF";

fn open(program: &Program) -> File {
    OpenOptions::new().read(true).write(true).open(program.path()).expect("the terminal opens")
}

fn set(port: &File, baud: u32, stop_bits: u8) {
    let mut settings = tcgetattr(port).expect("a terminal");
    settings.set_speed(baud).expect("a speed");
    settings.control_modes.set(ControlModes::CSTOPB, stop_bits == 2);
    tcsetattr(port, OptionalActions::Now, &settings).expect("set");
}

fn ask(port: &mut File) {
    port.write_all(&hex(READ).expect("hex")).expect("written");
    let mut answer = [0; 7];
    port.read_exact(&mut answer).expect("an answer");
    assert_eq!(answer[..], hex(ANSWER).expect("hex"));
}

/// The lines of a log that speak of the master's port.
fn told(log: &str) -> Vec<String> {
    let lines = log.lines().filter_map(|line| line.split_once(" master port set to "));
    lines.map(|(_, told)| told.to_owned()).collect()
}

#[test]
fn another_speed_is_told_once_a_change() {
    let program = Program::run(&["hcfa-x"]);
    let mut port = open(&program);
    ask(&mut port);
    for (baud, stop_bits) in [(19200, 2), (19200, 2), (9600, 1), (9600, 2)] {
        set(&port, baud, stop_bits);
        (0..3).for_each(|_| ask(&mut port));
    }
    let (_, log, _) = program.stop("TERM");
    let want = [
        "19200 baud, 2 stop bits; line set to 9600-8N2: a real line would garble every byte, this pseudo-terminal does not",
        "9600 baud, 1 stop bit; line set to 9600-8N2: most receivers accept that",
        "9600 baud, 2 stop bits; line set to 9600-8N2: they match",
    ];
    assert_eq!(told(&log), want, "{log}");
}

/// The row of the speed takes effect, the line goes along, and the master stays where it was.
#[test]
fn a_master_that_stays_behind_is_told() {
    let program = Program::run(&["hcfa-x"]);
    let mut port = open(&program);
    set(&port, 9600, 2);
    let write = rtu::encode(1, &[6, 0x09, 0x01, 0, 3]);
    port.write_all(&write).expect("written");
    port.read_exact(&mut [0; 8]).expect("an answer");
    (0..2).for_each(|_| ask(&mut port));
    set(&port, 19200, 2);
    ask(&mut port);
    let (_, log, _) = program.stop("TERM");
    let want = [
        "9600 baud, 2 stop bits; line set to 19200-8N2: a real line would garble every byte, this pseudo-terminal does not",
        "19200 baud, 2 stop bits; line set to 19200-8N2: they match",
    ];
    assert_eq!(told(&log), want, "{log}");
}

/// A program that looks for the drive at every speed finds it at one.
#[test]
fn a_scan_finds_the_drive_at_its_own_speed_only() {
    let folder = tempfile::tempdir().expect("a folder");
    let log = folder.path().join("log");
    let program =
        Program::run(&["hcfa-x", "--match-baud", "--log-file", log.to_str().expect("text")]);
    let mut port = open(&program);
    let noise = |baud: u32| {
        let log = read_to_string(&log).expect("a log");
        log.lines().filter(|line| line.contains(&format!("sent at {baud} baud"))).count()
    };
    for baud in [2400, 4800, 19200, 38400, 57600, 115_200] {
        set(&port, baud, 2);
        port.write_all(&hex(READ).expect("hex")).expect("written");
        wait_for("the noise", || noise(baud) == 1);
        assert_eq!(rustix::io::ioctl_fionread(&port).expect("a terminal"), 0);
    }
    set(&port, 9600, 1);
    ask(&mut port);
    let (_, log, _) = program.stop("TERM");
    assert!(log.contains("line set to 9600-8N2: nothing passes until they match"), "{log}");
}

#[test]
fn the_switch_is_for_pseudo_terminals() {
    let folder = tempfile::tempdir().expect("a folder");
    for port in ["--tcp=127.0.0.1:0", "--rtu-over-tcp=127.0.0.1:0", "--serial=/dev/ttyS0"] {
        let (code, _, stderr) = once(folder.path(), &["run", "hcfa-x", "--match-baud", port]);
        assert_eq!(code, Some(2), "{stderr}");
        assert!(stderr.contains("applies to a pseudo-terminal only"), "{stderr}");
    }
}
