//! `--state` from outside: runs that are killed, disks that fail, files that are not for this run.

use super::program::{Program, file, once, wait_for};
use drivemu::wire::{Frame, mbap, rtu};
use std::fs::{self, OpenOptions};
use std::io::{Read, Write};
use std::net::TcpStream;
use std::path::Path;
use std::sync::Arc;
use std::sync::atomic::{AtomicU16, Ordering};
use tempfile::TempDir;

/// The row that the master here stores, and where a write of it is for good.
const ROW: &str = "P08.11";
const AT: u16 = 0xE80B;

fn folder() -> TempDir {
    tempfile::tempdir().expect("a folder")
}

/// What the file says of the row: value and count.
fn kept(file: &Path) -> (u16, u64) {
    let text = fs::read_to_string(file).expect("the file is there");
    let state: serde_yaml::Value = serde_yaml::from_str(&text).expect("the file is whole");
    let row = &state["drives"]["line/1"]["rows"][ROW];
    let number = |key: &str| row.get(key).and_then(serde_yaml::Value::as_u64).unwrap_or(0);
    (number("value") as u16, number("writes"))
}

/// A master that stores one number after the other as fast as it gets answers, until nobody answers.
struct Master {
    confirmed: Arc<AtomicU16>,
    thread: std::thread::JoinHandle<()>,
}

impl Master {
    fn start(
        first: u16,
        mut port: impl Read + Write + Send + 'static,
        frame: fn(&[u8]) -> Frame,
    ) -> Self {
        let confirmed = Arc::new(AtomicU16::new(first - 1));
        let told = confirmed.clone();
        let thread = std::thread::spawn(move || {
            for value in first.. {
                let [[a, b], [c, d]] = [AT, value].map(u16::to_be_bytes);
                let request = frame(&[6, a, b, c, d]);
                let mut answer = vec![0; request.len()];
                if port.write_all(&request).and_then(|()| port.read_exact(&mut answer)).is_err() {
                    return;
                }
                assert_eq!(answer, *request, "an echo confirms it");
                told.store(value, Ordering::SeqCst);
            }
        });
        Self { confirmed, thread }
    }

    fn confirmed(&self) -> u16 {
        self.confirmed.load(Ordering::SeqCst)
    }

    /// The last number that was confirmed, when nobody answers any more.
    fn end(self) -> u16 {
        self.thread.join().expect("no wrong answer");
        self.confirmed.load(Ordering::SeqCst)
    }
}

/// Kills a run `rounds` times while a master stores, each time after another number of answers, and looks for what
/// was confirmed.
fn killed_again_and_again(rounds: u16, port: &str, connect: fn(&Program, u16) -> Master) {
    let folder = folder();
    let file = folder.path().join("state.yaml");
    let state = file.to_str().expect("text");
    let args: Vec<&str> =
        ["hcfa-x", "--quiet", "--state", state].into_iter().chain(port.split(' ')).collect();
    let mut last = 0;
    for round in 0..rounds {
        let program = Program::run(&args);
        assert_eq!(kept(&file).0, last, "round {round}: another value after the start");
        let master = connect(&program, last + 1);
        wait_for("answers", || master.confirmed() > last + round % 8);
        program.kill();
        let confirmed = master.end();
        let (value, writes) = kept(&file);
        // One more may have been stored whose answer nobody has read.
        assert!(
            value == confirmed || value == confirmed + 1,
            "round {round}: {value}, not {confirmed}"
        );
        assert_eq!(writes, u64::from(value), "round {round}: each value was stored once");
        last = value;
    }
    let names = fs::read_dir(folder.path()).expect("a folder");
    assert!(names.count() <= 2, "the file, and at most one that was not finished");
}

#[test]
fn what_was_confirmed_survives_kill_9_over_tcp() {
    killed_again_and_again(20, "--tcp 127.0.0.1:0", |program, first| {
        let stream = TcpStream::connect(program.addr()).expect("connects");
        stream.set_nodelay(true).expect("no delay");
        Master::start(first, stream, |pdu| mbap::encode(0, 1, pdu))
    });
}

#[test]
fn what_was_confirmed_survives_kill_9_over_a_pseudo_terminal() {
    killed_again_and_again(6, "--pty", |program, first| {
        let port = OpenOptions::new().read(true).write(true).open(program.path());
        Master::start(first, port.expect("the terminal opens"), |pdu| rtu::encode(1, pdu))
    });
}

/// Asks the drive of a Modbus TCP port, once.
fn ask(program: &Program, pdu: &[u8]) -> Vec<u8> {
    let mut stream = TcpStream::connect(program.addr()).expect("connects");
    stream.write_all(&mbap::encode(0, 1, pdu)).expect("written");
    let mut head = [0; 7];
    stream.read_exact(&mut head).expect("an answer");
    let mut answer = vec![0; usize::from(head[5]) - 1];
    stream.read_exact(&mut answer).expect("all of it");
    answer
}

#[test]
fn drives_of_several_lines_share_a_file() {
    let folder = folder();
    let bench = file(
        &folder,
        "bench.yaml",
        "lines: [{name: a, tcp: '127.0.0.1:0', drives: [{model: k-series}]}, {name: b, tcp: '127.0.0.1:0', drives: [{model: hcfa-x}]}]",
    );
    let state = folder.path().join("state.yaml");
    let args = [bench.to_str().expect("text"), "--state", state.to_str().expect("text")];
    let program = Program::run(&args);
    ask(&program, &[6, 0x01, 0x30, 0, 77]);
    assert_eq!(program.stop("TERM").0, Some(0));
    let program = Program::run(&args);
    assert_eq!(ask(&program, &[3, 0x01, 0x30, 0, 1]), [3, 2, 0, 77]);
    let text = fs::read_to_string(&state).expect("the file");
    assert!(
        text.contains("  a/1/A:") && text.contains("  a/1/b:") && text.contains("  b/1:"),
        "{text}"
    );
}

/// An explicit speed wins over a kept one, and a kept one over the model's: the port opens with it.
#[test]
fn a_port_opens_at_the_speed_that_was_kept() {
    let folder = folder();
    let state = folder.path().join("state.yaml");
    let state = state.to_str().expect("text");
    for (more, line) in [
        (&[][..], "9600-8N2"),
        (&["--set", "P09.01=3"], "19200-8N2"),
        (&[], "19200-8N2"),
        (&["-b", "38400"], "38400-8N2"),
        (&[], "38400-8N2"),
    ] {
        let args = [&["hcfa-x", "--state", state][..], more].concat();
        let program = Program::run(&args);
        assert_eq!(program.ready()["endpoints"][0]["line"], line, "{more:?}");
    }
}

#[test]
fn files_that_are_not_for_this_run_stay_as_they_are() {
    let folder = folder();
    let empty = "drives: {line/1: {model: hcfa-x, rows: {}}}";
    for (name, text, says) in [
        (
            "other.yaml",
            "format: 1\ndrives: {line/1: {model: other, rows: {}}}\n",
            "drives[line/1].model: line/1 is other in this file and hcfa-x in this run\n --> other.yaml:2:26",
        ),
        ("later.yaml", "format: 7\n", "a later version wrote this file"),
        ("broken.yaml", "format: 1\ndrives: {", "broken.yaml:2:"),
        ("empty.yaml", "", "the file is empty"),
        (
            "row.yaml",
            &format!("format: 1\n{}\n", empty.replace("{}", "{P03.04: {value: 70000}}")),
            "P03.04 Jog speed accepts",
        ),
    ] {
        let path = file(&folder, name, text);
        let (code, _, stderr) = once(folder.path(), &["run", "hcfa-x", "--state", name]);
        assert_eq!(code, Some(2), "{stderr}");
        assert!(stderr.contains(says), "{stderr}");
        assert!(
            stderr.ends_with(&format!(
                "{name} was not changed: correct it, move it away, or give another --state\n"
            )),
            "{stderr}"
        );
        assert_eq!(fs::read_to_string(path).expect("still there"), text);
    }
    for (state, code, says) in [
        (".", 2, "cannot use .: "),
        (
            "no/such/folder/state.yaml",
            1,
            "cannot write no/such/folder/state.yaml: no such file or directory",
        ),
    ] {
        let run = once(folder.path(), &["run", "hcfa-x", "--state", state]);
        assert_eq!(run.0, Some(code), "{}", run.2);
        assert!(run.2.contains(says), "{}", run.2);
    }
    fs::write(folder.path().join("binary"), [0xFF, 0xFE, 0x00]).expect("written");
    let (code, _, stderr) = once(folder.path(), &["run", "hcfa-x", "--state", "binary"]);
    assert_eq!(code, Some(2));
    assert!(stderr.contains("cannot use binary: this is not UTF-8 text"), "{stderr}");
}

#[test]
fn one_run_at_a_time() {
    let folder = folder();
    let state = folder.path().join("state.yaml");
    let state = state.to_str().expect("text");
    let first = Program::run(&["hcfa-x", "--state", state, "--tcp", "127.0.0.1:0"]);
    let refused = |says: &str| {
        let (code, _, stderr) = once(folder.path(), &["run", "hcfa-x", "--state", state]);
        assert_eq!(code, Some(2), "{stderr}");
        assert!(stderr.contains(says), "{stderr}");
    };
    refused("in use by another run");
    // The file that it has written since is its own as well.
    ask(&first, &[6, 0xE8, 0x0B, 0, 1]);
    refused("in use by another run");
    assert_eq!(first.stop("TERM").0, Some(0));
}

/// What somebody removes during a run is there again with the next write. If another run has begun a new file
/// meanwhile, that is the other's.
#[test]
fn a_file_that_was_removed_has_one_owner() {
    let folder = folder();
    let state = folder.path().join("state.yaml");
    let args = ["hcfa-x", "--state", state.to_str().expect("text"), "--tcp", "127.0.0.1:0"];
    let mut first = Program::run(&args);
    let said = first.listen();
    let store = |program: &Program, value| {
        let [hi, lo] = u16::to_be_bytes(value);
        assert_eq!(ask(program, &[6, 0xE8, 0x0B, hi, lo]).len(), 5, "the drive goes on");
    };
    fs::remove_file(&state).expect("removed");
    store(&first, 1);
    assert_eq!(kept(&state), (1, 1));
    fs::remove_file(&state).expect("removed");
    let second = Program::run(&args);
    store(&second, 22);
    store(&first, 2);
    store(&first, 3);
    first.wait_until_said(&said, "in use by another run");
    store(&second, 23);
    assert_eq!(kept(&state), (23, 2), "untouched by the first");
    assert_eq!(first.stop("TERM").0, Some(1), "what it has stored is nowhere");
    assert_eq!(
        said.all().matches("cannot write").count(),
        2,
        "once, and at the end: {}",
        said.all()
    );
    assert_eq!(second.stop("TERM").0, Some(0));
    assert_eq!(kept(&state), (23, 2));
}

#[test]
fn a_link_to_the_file_stays_a_link() {
    let folder = folder();
    let (real, link) = (folder.path().join("real.yaml"), folder.path().join("link.yaml"));
    let args = ["hcfa-x", "--tcp", "127.0.0.1:0", "--state"];
    let run = |path: &Path| Program::run(&[&args[..], &[path.to_str().expect("text")]].concat());
    drop(run(&real));
    std::os::unix::fs::symlink(&real, &link).expect("a link");
    ask(&run(&link), &[6, 0xE8, 0x0B, 0, 5]);
    assert!(fs::symlink_metadata(&link).expect("there").is_symlink());
    assert_eq!(kept(&real), (5, 1));
}

/// The folder goes away during the run and comes back: told once each, and what was stored meanwhile is not lost.
#[test]
fn a_disk_that_fails_stops_no_drive() {
    let folder = folder();
    let inner = folder.path().join("inner");
    fs::create_dir(&inner).expect("a folder");
    let state = inner.join("state.yaml");
    let args = ["hcfa-x", "--tcp", "127.0.0.1:0", "--state", state.to_str().expect("text")];
    let mut program = Program::run(&args);
    let said = program.listen();
    fs::remove_dir_all(&inner).expect("gone");
    for value in 1..=3 {
        assert_eq!(ask(&program, &[6, 0xE8, 0x0B, 0, value]), [6, 0xE8, 0x0B, 0, value]);
    }
    program.wait_until_said(&said, "error: cannot write");
    fs::create_dir(&inner).expect("back");
    ask(&program, &[6, 0xE3, 0x04, 0, 9]);
    program.wait_until_said(&said, "is written again");
    assert_eq!(kept(&state), (3, 3));
    assert_eq!(said.all().matches("cannot write").count(), 1, "{}", said.all());
    fs::remove_dir_all(&inner).expect("gone again");
    ask(&program, &[6, 0xE8, 0x0B, 0, 4]);
    // Somebody who only looks at the end learns of it too.
    assert_eq!(program.stop("TERM").0, Some(1));
}
