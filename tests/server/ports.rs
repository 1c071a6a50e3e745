//! Ports that go and come, readers that stop reading, masters that don't say goodbye.

use super::program::{Program, wait_for};
use drivemu::testkit::hex;
use std::fs::{File, OpenOptions};
use std::io::{Read, Write};
use std::os::unix::fs::symlink;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

const READ: &str = "01 03 00 23 00 01 75 C0";
const ANSWER: &str = "01 03 02 00 3C B8 55";

fn open(path: &str) -> File {
    OpenOptions::new().read(true).write(true).open(path).expect("the terminal opens")
}

fn ask(port: &mut File) -> Vec<u8> {
    port.write_all(&hex(READ).expect("hex")).expect("written");
    let mut answer = vec![0; 7];
    port.read_exact(&mut answer).expect("an answer");
    answer
}

#[test]
fn a_master_may_close_and_reopen() {
    let program = Program::run(&[]);
    for _ in 0..3 {
        assert_eq!(ask(&mut open(&program.path())), hex(ANSWER).expect("hex"));
    }
}

/// 14.031 ms: silence and delay of the drive, and seven characters. The timer of the system may be late, and
/// on a busy machine often is; never is a reply early.
#[test]
#[allow(clippy::disallowed_methods)] // The time of the wall is what is tested.
fn a_paced_reply_takes_its_time() {
    let mut program = Program::run(&["hcfa-x", "--pacing", "line"]);
    let said = program.listen();
    let mut port = open(&program.path());
    let request = hex("01 03 03 04 00 01 C5 8F").expect("hex");
    let mut fastest = Duration::MAX;
    for _ in 0..20 {
        let asked = Instant::now();
        port.write_all(&request).expect("written");
        port.read_exact(&mut [0; 7]).expect("an answer");
        fastest = fastest.min(asked.elapsed());
    }
    let theory = Duration::from_nanos(14_031_250);
    assert!(fastest >= theory && fastest < 2 * theory, "{fastest:?}");
    program.wait_until_said(&said, "paced replies");
}

#[test]
fn a_reader_that_stops_reading_stops_nobody() {
    let mut program = Program::run(&[]);
    let said = program.listen();
    let mut port = open(&program.path());
    let request = hex(READ).expect("hex");
    // Far more answers than a terminal holds; the drive must go on taking requests.
    for _ in 0..8_000 {
        port.write_all(&request).expect("written");
    }
    program.wait_until_said(&said, "replies are not being read");
    // The master wakes up, throws away what piled up, and is served again.
    drop(port);
    let mut port = open(&program.path());
    wait_for("an answer", || {
        rustix::termios::tcflush(&port, rustix::termios::QueueSelector::IFlush).expect("flushed");
        ask(&mut port) == hex(ANSWER).expect("hex")
    });
}

#[test]
fn a_serial_port_is_unplugged_and_comes_back() {
    let folder = tempfile::tempdir().expect("a folder");
    let device = folder.path().join("ttyUSB0");
    let first = plug_in(&device);
    let mut program = Program::run(&["--serial", device.to_str().expect("text")]);
    let said = program.listen();
    let mut cable = first;
    assert_eq!(ask(&mut cable), hex(ANSWER).expect("hex"));
    drop(cable);
    program.wait_until_said(&said, "the port disappeared");
    std::fs::remove_file(&device).expect("unplugged");
    let mut cable = plug_in(&device);
    program.wait_until_said(&said, "the port is back");
    assert_eq!(ask(&mut cable), hex(ANSWER).expect("hex"));
}

#[test]
fn a_log_that_nobody_reads_stops_nobody() {
    // Stdout is a pipe that this test does not read: 64 KiB, then it is full.
    let program = Program::run(&[]);
    let mut port = open(&program.path());
    for _ in 0..3_000 {
        assert_eq!(ask(&mut port), hex(ANSWER).expect("hex"));
    }
    let (code, ..) = program.stop("TERM");
    assert_eq!(code, Some(0));
}

/// A cable whose other end is at `device`: the master of a pseudo-terminal, linked there.
pub fn plug_in(device: &Path) -> File {
    use rustix::pty::{OpenptFlags, grantpt, openpt, ptsname, unlockpt};
    // Other tests start programs at the same time; none of them may keep this end of the cable.
    let kept = OpenptFlags::from_bits_retain(rustix::fs::OFlags::CLOEXEC.bits());
    let master = openpt(OpenptFlags::RDWR | OpenptFlags::NOCTTY | kept).expect("a pseudo-terminal");
    grantpt(&master).expect("granted");
    unlockpt(&master).expect("unlocked");
    let name = ptsname(&master, Vec::new()).expect("a name").into_string().expect("text");
    let slave = open(&name);
    let mut raw = rustix::termios::tcgetattr(&slave).expect("a terminal");
    raw.make_raw();
    rustix::termios::tcsetattr(&slave, rustix::termios::OptionalActions::Now, &raw).expect("raw");
    symlink(PathBuf::from(name), device).expect("plugged in");
    File::from(master)
}
