//! What one program leaves behind at a pseudo-terminal is nothing to the next.

use super::program::{Program, file, wait_for};
use drivemu::testkit::hex;
use rustix::io::ioctl_fionread;
use std::fs::{File, OpenOptions, read_to_string};
use std::io::{Read, Write};
use std::time::Duration;

/// Two reads with different answers.
const OLD: (&str, &str) = ("01 03 00 23 00 01 75 C0", "01 03 02 00 3C B8 55");
const NEW: (&str, &str) = ("01 03 00 21 00 01 D4 00", "01 03 02 00 64 B9 AF");

fn open(program: &Program) -> File {
    OpenOptions::new().read(true).write(true).open(program.path()).expect("the terminal opens")
}

/// Opens it once what the last program left is gone. Opens it anew each time: a child that another test has just
/// started keeps our files open for a moment, and so long the last program has not left.
fn open_clean(program: &Program) -> File {
    let mut clean = None;
    wait_for("a clean terminal", || {
        clean = Some(open(program)).filter(|port| waiting(port) == 0);
        clean.is_some()
    });
    clean.expect("just opened")
}

fn send(port: &mut File, (request, _): (&str, &str)) {
    port.write_all(&hex(request).expect("hex")).expect("written");
}

fn asks(port: &mut File, (request, answer): (&str, &str)) {
    send(port, (request, answer));
    let mut got = [0; 7];
    port.read_exact(&mut got).expect("an answer");
    assert_eq!(got[..], hex(answer).expect("hex"));
}

fn waiting(port: &File) -> u64 {
    ioctl_fionread(port).expect("a terminal")
}

/// Nothing comes for as long as what was held back would take.
#[allow(clippy::disallowed_methods)] // That nothing comes can only be waited for.
fn stays_silent(port: &File) {
    std::thread::sleep(Duration::from_millis(400));
    assert_eq!(waiting(port), 0);
}

#[test]
fn an_unread_answer_goes_with_the_program_that_asked() {
    let program = Program::run(&[]);
    for _ in 0..5 {
        let mut first = open(&program);
        send(&mut first, OLD);
        wait_for("the answer", || waiting(&first) == 7);
        drop(first);
        let mut second = open_clean(&program);
        asks(&mut second, NEW);
        assert_eq!(waiting(&second), 0);
    }
}

#[test]
fn a_program_that_stays_keeps_its_answer() {
    let program = Program::run(&[]);
    let mut stays = open(&program);
    drop(open(&program));
    send(&mut stays, OLD);
    wait_for("the answer", || waiting(&stays) == 7);
    drop(open(&program));
    stays_still(&stays);
    let mut got = [0; 7];
    stays.read_exact(&mut got).expect("an answer");
    assert_eq!(got[..], hex(OLD.1).expect("hex"));
}

#[allow(clippy::disallowed_methods)] // That nothing happens can only be waited for.
fn stays_still(port: &File) {
    std::thread::sleep(Duration::from_millis(100));
    assert_eq!(waiting(port), 7);
}

/// Delayed, late, in chunks, at the pace of the line: what is held back for a program that has left is dropped.
#[test]
fn what_is_held_back_goes_too() {
    let folder = tempfile::tempdir().expect("a folder");
    for (i, how) in [
        "faults: [{do: delay, ms: 200, count: 1}]",
        "faults: [{do: late, count: 1}]",
        "faults: [{do: split, at: 3, gap_ms: 200, count: 1}]",
        "chunk: 200ms",
    ]
    .iter()
    .enumerate()
    {
        let text = format!("lines: [{{pty: auto, {how}, drives: [{{model: yako-closed-loop}}]}}]");
        let bench = file(&folder, &format!("{i}.yaml"), &text);
        let log = folder.path().join(format!("{i}.log"));
        let [bench, log] = [&bench, &log].map(|path| path.to_str().expect("text"));
        let program = Program::run(&[bench, "--log-file", log]);
        let mut first = open(&program);
        send(&mut first, OLD);
        wait_for("the request", || read_to_string(log).expect("a log").contains("0x0023"));
        drop(first);
        let mut second = open_clean(&program);
        asks(&mut second, NEW);
        stays_silent(&second);
    }
}

/// What a program said last is over when it leaves: half a frame is noise, and not the beginning of the next one.
#[test]
fn half_a_request_does_not_spoil_the_next() {
    let folder = tempfile::tempdir().expect("a folder");
    let log = folder.path().join("log");
    let log = log.to_str().expect("text");
    let program = Program::run(&["--log-file", log]);
    let mut first = open(&program);
    first.write_all(&hex("01 03 00").expect("hex")).expect("written");
    drop(first);
    wait_for("the noise", || read_to_string(log).expect("a log").contains("too short"));
    asks(&mut open(&program), NEW);
}
