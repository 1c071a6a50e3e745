//! Stdin, stdout and stderr closed, full, broken or never read: no drive stops for that, and the exit code tells what could
//! not be written.

use super::program::{Program, ending_signals, file, once, wait_for};
use drivemu::wire::mbap;
use std::fs;
use std::io::{Read, Write};
use std::net::TcpStream;
use std::path::Path;
use std::process::{Child, Command, Stdio};
use tempfile::TempDir;

/// A test that passes.
const PASSES: &str =
    "steps: [{name: s, do: [raise overload], expect: [{signal: alarm, is: on}]}]\n";
/// A test that fails.
const FAILS: &str =
    "steps: [{name: s, do: [raise overload], expect: [{signal: alarm, is: off}]}]\n";

/// What a shell makes of each stream, and whether that loses what is written there.
const WAYS: [(&str, bool); 4] =
    [("N>&-", false), ("N>/dev/full", true), ("N<&-", false), ("", false)];

fn folder() -> TempDir {
    let folder = tempfile::tempdir().expect("a folder");
    file(&folder, "passes.yaml", PASSES);
    file(&folder, "fails.yaml", FAILS);
    folder
}

/// The program with `args`, its streams redirected as a shell does.
fn redirected(folder: &Path, args: &[&str], redirections: &str) -> Command {
    let mut shell = Command::new("sh");
    shell.current_dir(folder).args(["-c", &format!("exec \"$0\" \"$@\" {redirections}")]);
    shell.arg(env!("CARGO_BIN_EXE_drivemu")).args(args);
    shell
}

/// Runs a drive on TCP that says in `ready.json` where.
const DRIVE: [&str; 6] = ["run", "hcfa-x", "--tcp", "127.0.0.1:0", "--ready-file", "ready.json"];

/// Such a drive with its streams in pipes, and its address.
fn piped(folder: &Path) -> (Running, String) {
    let mut command = Command::new(env!("CARGO_BIN_EXE_drivemu"));
    command.current_dir(folder).args(DRIVE).stdout(Stdio::piped()).stderr(Stdio::piped());
    let mut child = Running(command.spawn().expect("it starts"));
    let addr = child.addr(folder);
    (child, addr)
}

fn code(mut command: Command) -> i32 {
    let child = command.stdin(Stdio::null()).stdout(Stdio::null()).stderr(Stdio::null()).spawn();
    let mut child = child.expect("it starts");
    wait_for("the end", || child.try_wait().expect("asked").is_some());
    child.wait().expect("ended").code().expect("no signal")
}

/// Every stream in every way, and all of them at once: a scenario that passes still passes, and one that fails fails,
/// but a log that can't be written to stdout is told.
#[test]
fn whatever_streams_are_the_verdict_stands() {
    let folder = folder();
    for (way, loses) in WAYS {
        for fds in ["0", "1", "2", "12", "012"] {
            if way.contains('<') && fds.len() > 1 {
                continue;
            }
            let redirections = fds.chars().map(|fd| way.replace('N', &fd.to_string()) + " ");
            let redirections = redirections.collect::<String>();
            for (scenario, fails) in [("passes.yaml", false), ("fails.yaml", true)] {
                let args = ["run", "hcfa-x", "--scenario", scenario];
                let want = i32::from(fails || loses && fds.contains('1'));
                let got = code(redirected(folder.path(), &args, &redirections));
                assert_eq!(got, want, "{scenario} with {redirections}");
            }
        }
    }
}

/// A drive answers on, whatever becomes of its streams, and a signal ends it cleanly.
#[test]
fn drives_answer_on() {
    for redirections in ["2>/dev/full", "2>&-", ">&-", "<&- >&- 2>&-", ">/dev/full 2>/dev/full"] {
        let folder = folder();
        let mut command = redirected(folder.path(), &DRIVE, redirections);
        command.stdout(Stdio::null()).stderr(Stdio::null());
        let mut child = Running(command.spawn().expect("it starts"));
        let addr = child.addr(folder.path());
        for _ in 0..20 {
            ask(&addr);
        }
        child.signal("TERM");
        let want = i32::from(redirections.contains(">/dev/full 2"));
        assert_eq!(child.ended(), want, "{redirections}");
    }
}

/// The reader of a pipe leaves, as `head` does: nobody wants the rest, and that is no failure.
#[test]
fn a_reader_that_leaves_is_no_failure() {
    let folder = folder();
    let (mut child, addr) = piped(folder.path());
    drop((child.0.stdout.take(), child.0.stderr.take()));
    for _ in 0..20 {
        ask(&addr);
    }
    child.signal("TERM");
    assert_eq!(child.ended(), 0);
    for args in [&["show", "hcfa-x"][..], &["schema", "model"], &["models"], &["run", "--help"]] {
        let mut command = Command::new(env!("CARGO_BIN_EXE_drivemu"));
        let child = command.args(args).stdout(Stdio::piped()).stderr(Stdio::piped()).spawn();
        let mut child = Running(child.expect("it starts"));
        drop(child.0.stdout.take());
        assert_eq!(child.ended(), 0, "{args:?}");
        assert_eq!(child.said(), "", "{args:?}");
    }
}

/// A reader that never reads: more is said than a pipe takes, and the drive answers on and ends.
#[test]
fn a_reader_that_never_reads_stops_nothing() {
    let folder = folder();
    let (mut child, addr) = piped(folder.path());
    // Each client is worth some 60 bytes on stderr and as many on stdout; a pipe takes 64 KiB.
    for _ in 0..2500 {
        ask(&addr);
    }
    child.signal("TERM");
    assert_eq!(child.ended(), 0);
    assert!(!folder.path().join("ready.json").exists());
}

/// What is asked for on a full disk is not there: that is told, and is no success.
#[test]
fn a_full_disk_is_no_success() {
    let folder = folder();
    for args in [
        &["show", "hcfa-x"][..],
        &["show", "hcfa-x", "P09.11"],
        &["show", "hcfa-x", "--format", "json"],
        &["show", "hcfa-x", "--format", "markdown"],
        &["schema", "model"],
        &["models"],
        &["check", "passes.yaml"],
        &["--help"],
        &["run", "--help"],
        &["--version"],
    ] {
        let mut full = redirected(folder.path(), args, ">/dev/full");
        let output = full.output().expect("it starts");
        let said = String::from_utf8_lossy(&output.stderr).into_owned();
        assert_eq!(output.status.code(), Some(1), "{args:?}: {said}");
        assert_eq!(said, "cannot write to stdout: no space left on the device\n", "{args:?}");
        let full = redirected(folder.path(), args, ">/dev/full 2>/dev/full");
        assert_eq!(code(full), 1, "{args:?}");
        assert_eq!(code(redirected(folder.path(), args, ">&-")), 0, "{args:?}");
    }
    for (flag, says) in [
        ("--log-file", "/dev/full: no space left on the device"),
        ("--ready-file", "cannot write /dev/full: no space left on the device"),
        ("--junit", "cannot write /dev/full: no space left on the device"),
    ] {
        let args = ["run", "hcfa-x", "--scenario", "passes.yaml", flag, "/dev/full"];
        let (code, log, stderr) = once(folder.path(), &args);
        assert_eq!(code, Some(1), "{stderr}");
        assert!(stderr.contains(says), "{flag}: {stderr}");
        assert!(log.contains("step s passed"), "{flag}: the run goes on: {log}");
        let meta = fs::metadata("/dev/full").expect("still there");
        assert!(!meta.is_file(), "{flag} must not replace a device");
    }
}

/// A FIFO that nobody reads blocks neither the start nor the end, one that somebody reads gets it all, and
/// `/dev/stdout` is stdout.
#[test]
fn fifos_and_devices() {
    let folder = folder();
    let fifo = folder.path().join("fifo");
    assert!(Command::new("mkfifo").arg(&fifo).status().expect("it runs").success());
    for flag in ["--log-file", "--ready-file", "--junit"] {
        let args = ["run", "hcfa-x", "--scenario", "passes.yaml", flag, "fifo"];
        let (code, _, stderr) = once(folder.path(), &args);
        assert_eq!(code, Some(1), "{flag}: {stderr}");
        assert!(stderr.contains("cannot write fifo: not being read"), "{flag}: {stderr}");
        let path = fifo.clone();
        let reader = std::thread::spawn(move || fs::read_to_string(path).expect("text"));
        let (code, _, stderr) = once(folder.path(), &args);
        assert_eq!(code, Some(0), "{flag}: {stderr}");
        let text = reader.join().expect("read");
        assert!(text.starts_with(['{', '<']) && text.ends_with('\n'), "{flag}: {text}");
        let args = ["run", "hcfa-x", "--scenario", "passes.yaml", flag, "/dev/null", "--seed", "7"];
        assert_eq!(once(folder.path(), &args).0, Some(0), "{flag}");
        let args = ["run", "hcfa-x", "--scenario", "passes.yaml", flag, "/dev/stdout"];
        let (code, stdout, stderr) = once(folder.path(), &args);
        assert_eq!(code, Some(0), "{flag}: {stderr}");
        assert!(stdout.contains("\"unit\":") || stdout.contains("<testsuite "), "{stdout}");
    }
    assert!(!fs::metadata("/dev/null").expect("there").is_file());
    let (code, _, stderr) = once(folder.path(), &["run", "hcfa-x", "--state", "fifo"]);
    assert_eq!(code, Some(2));
    assert!(stderr.contains("cannot use fifo: not a regular file"), "{stderr}");
}

#[test]
fn a_hang_up_ends_like_a_signal_that_ends() {
    let folder = folder();
    let ready = folder.path().join("ready.json");
    for signal in ending_signals() {
        let link = folder.path().join("cell.tty");
        let program = Program::run(&["hcfa-x", "--pty", link.to_str().expect("text")]);
        let (code, _, stderr) = program.stop(signal);
        assert_eq!(code, Some(0), "{stderr}");
        assert!(stderr.ends_with(&format!("SIG{signal}: ended\n")), "{stderr}");
        assert!(fs::symlink_metadata(&link).is_err(), "the link is left behind");
    }
    // Under nohup it is somebody's wish that a hang-up ends nothing.
    let args = "run hcfa-x --tcp 127.0.0.1:0 --ready-file ready.json".split(' ');
    let mut command = Command::new("nohup");
    command.current_dir(folder.path()).arg(env!("CARGO_BIN_EXE_drivemu")).args(args);
    command.stdout(Stdio::null()).stderr(Stdio::null());
    let mut child = Running(command.spawn().expect("it starts"));
    let addr = child.addr(folder.path());
    child.signal("HUP");
    for _ in 0..20 {
        ask(&addr);
    }
    assert!(ready.exists());
    child.signal("TERM");
    assert_eq!(child.ended(), 0);
    assert!(!ready.exists(), "it speaks of ports that are closed");
}

/// Reads a row of unit 1 over a connection of its own.
fn ask(addr: &str) {
    let mut stream = TcpStream::connect(addr).expect("connects");
    stream.write_all(&mbap::encode(0, 1, &[3, 0x03, 0x04, 0, 1])).expect("written");
    stream.read_exact(&mut [0; 11]).expect("an answer");
}

/// A process that ends with its test.
struct Running(Child);

impl Running {
    /// The address in the ready file, once it is there.
    fn addr(&mut self, folder: &Path) -> String {
        let ready = folder.join("ready.json");
        wait_for("the ready file", || {
            assert!(self.0.try_wait().expect("asked").is_none(), "ended: {}", self.said());
            ready.exists()
        });
        let ready = fs::read_to_string(ready).expect("the ready file");
        let ready: serde_json::Value = serde_json::from_str(&ready).expect("JSON");
        ready["endpoints"][0]["addr"].as_str().expect("an address").to_owned()
    }

    fn signal(&self, name: &str) {
        let pid = self.0.id().to_string();
        let sent = Command::new("kill").args([&format!("-{name}"), &pid]).status();
        assert!(sent.expect("kill runs").success());
    }

    fn ended(&mut self) -> i32 {
        wait_for("the end", || self.0.try_wait().expect("asked").is_some());
        self.0.wait().expect("ended").code().expect("no signal")
    }

    fn said(&mut self) -> String {
        let mut said = String::new();
        self.0.stderr.iter_mut().for_each(|it| drop(it.read_to_string(&mut said)));
        said
    }
}

impl Drop for Running {
    fn drop(&mut self) {
        // It may have ended already.
        let _ = self.0.kill();
        let _ = self.0.wait();
    }
}
