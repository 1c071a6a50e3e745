//! Starts the program as a user does and stops it again, whatever happens to the test.

use serde_json::Value;
use std::io::Read;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Output, Stdio};
use std::time::{Duration, Instant};
use tempfile::TempDir;

/// How long anything may take before a test gives up. Machines are small and noisy.
const PATIENCE: Duration = Duration::from_secs(20);

/// A running `drivemu run`.
pub struct Program {
    child: Child,
    /// Everything that this run writes lies in here, and goes with it.
    folder: TempDir,
    ready: Value,
}

/// The signals that end a run. Where these tests run under `nohup`, what they start ignores a hang-up as well.
pub fn ending_signals() -> impl Iterator<Item = &'static str> {
    let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    let ignored = status.lines().find_map(|line| line.strip_prefix("SigIgn:"));
    let ignored = ignored.and_then(|mask| u64::from_str_radix(mask.trim(), 16).ok()).unwrap_or(0);
    ["INT", "TERM", "HUP"].into_iter().filter(move |signal| *signal != "HUP" || ignored & 1 == 0)
}

impl Program {
    /// Starts `drivemu run` with `args` and waits until every port is open.
    pub fn run(args: &[&str]) -> Self {
        let folder = tempfile::tempdir().expect("a folder");
        let ready_file = folder.path().join("ready.json");
        let mut child = drivemu()
            .current_dir(folder.path())
            .arg("run")
            .args(args)
            .args(["--ready-file", "ready.json"])
            .stdout(Stdio::piped())
            .stderr(Stdio::piped())
            .spawn()
            .expect("the program starts");
        wait_for("the ready file", || {
            assert!(child.try_wait().expect("asked").is_none(), "ended: {}", rest(&mut child));
            ready_file.exists()
        });
        let ready = std::fs::read_to_string(&ready_file).expect("the ready file");
        let ready = serde_json::from_str(&ready).expect("JSON, whole");
        Self { child, folder, ready }
    }

    /// The ready file.
    pub fn ready(&self) -> &Value {
        &self.ready
    }

    /// Path of the first endpoint.
    pub fn path(&self) -> String {
        self.ready["endpoints"][0]["path"].as_str().expect("a path").to_owned()
    }

    /// Address of the first endpoint.
    pub fn addr(&self) -> std::net::SocketAddr {
        let addr = self.ready["endpoints"][0]["addr"].as_str().expect("an address");
        addr.parse().expect("host and port")
    }

    /// Where it runs, and what it writes there.
    pub fn folder(&self) -> &Path {
        self.folder.path()
    }

    /// The number of its process.
    pub fn id(&self) -> u32 {
        self.child.id()
    }

    /// Sends it a signal.
    pub fn signal(&self, signal: &str) {
        let pid = self.child.id().to_string();
        let sent = Command::new("kill").args([&format!("-{signal}"), &pid]).status();
        assert!(sent.expect("kill runs").success());
    }

    /// Ends the run with `signal` and gives back how it ended and what it printed.
    pub fn stop(self, signal: &str) -> (Option<i32>, String, String) {
        self.signal(signal);
        self.ended()
    }

    /// Waits until the run ends by itself, and gives back how it ended and what it printed.
    pub fn ended(mut self) -> (Option<i32>, String, String) {
        wait_for("the end", || self.child.try_wait().expect("asked").is_some());
        let code = self.child.wait().expect("ended").code();
        let (stdout, stderr) = printed(&mut self.child);
        (code, stdout, stderr)
    }

    /// The most memory that it has used so far, in KiB; 0 where the system does not say.
    pub fn memory(&self) -> u64 {
        let status = std::fs::read_to_string(format!("/proc/{}/status", self.child.id()));
        let status = status.unwrap_or_default();
        let most = status.lines().find_map(|line| line.strip_prefix("VmHWM:"));
        most.and_then(|it| it.trim().trim_end_matches(" kB").parse().ok()).unwrap_or(0)
    }

    /// Ends the run as a power failure does.
    pub fn kill(mut self) {
        self.child.kill().expect("killed");
        self.child.wait().expect("ended");
    }

    /// Waits until stderr has said `text`. Reads it in a thread of its own from then on.
    pub fn wait_until_said(&mut self, said: &Said, text: &str) {
        let running = &mut self.child;
        wait_for(&format!("`{text}`"), || {
            assert!(running.try_wait().expect("asked").is_none(), "ended: {}", said.all());
            said.all().contains(text)
        });
    }

    /// Listens to stderr from now on.
    pub fn listen(&mut self) -> Said {
        let mut stderr = self.child.stderr.take().expect("stderr");
        let said = Said::default();
        let into = said.0.clone();
        std::thread::spawn(move || {
            let mut buffer = [0; 1024];
            while let Ok(len @ 1..) = stderr.read(&mut buffer) {
                let text = String::from_utf8_lossy(&buffer[..len]).into_owned();
                into.lock().expect("not poisoned").push_str(&text);
            }
        });
        said
    }
}

/// What a run said on stderr so far.
#[derive(Default, Clone)]
pub struct Said(std::sync::Arc<std::sync::Mutex<String>>);

impl Said {
    /// All of it.
    pub fn all(&self) -> String {
        self.0.lock().expect("not poisoned").clone()
    }
}

impl Drop for Program {
    fn drop(&mut self) {
        // It may have ended already.
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

/// Runs the program to its end.
pub fn once(folder: &Path, args: &[&str]) -> (Option<i32>, String, String) {
    let mut command = drivemu();
    command.current_dir(folder).args(args).stdin(Stdio::null());
    let child = command.stdout(Stdio::piped()).stderr(Stdio::piped()).spawn();
    let child = child.expect("the program starts");
    // One that was to refuse something and runs instead must not wait for ever.
    let pid = child.id().to_string();
    let (done, waits) = std::sync::mpsc::channel::<()>();
    let guard = std::thread::spawn(move || {
        if waits.recv_timeout(PATIENCE) == Err(std::sync::mpsc::RecvTimeoutError::Timeout) {
            let _ = Command::new("kill").args(["-KILL", &pid]).status();
        }
    });
    let Output { status, stdout, stderr } = child.wait_with_output().expect("it ends");
    drop(done);
    guard.join().expect("no panic");
    let text = |bytes: Vec<u8>| String::from_utf8(bytes).expect("text");
    (status.code(), text(stdout), text(stderr))
}

/// A file in `folder`.
pub fn file(folder: &TempDir, name: &str, text: &str) -> PathBuf {
    let path = folder.path().join(name);
    std::fs::write(&path, text).expect("written");
    path
}

/// Waits for something that another process does.
#[allow(clippy::disallowed_methods)] // Another process can only be waited for on the wall.
pub fn wait_for(what: &str, mut done: impl FnMut() -> bool) {
    let start = Instant::now();
    while !done() {
        assert!(start.elapsed() < PATIENCE, "waited too long for {what}");
        std::thread::sleep(Duration::from_millis(5));
    }
}

fn drivemu() -> Command {
    Command::new(env!("CARGO_BIN_EXE_drivemu"))
}

fn printed(child: &mut Child) -> (String, String) {
    let (mut stdout, mut stderr) = (String::new(), String::new());
    if let Some(pipe) = &mut child.stdout {
        pipe.read_to_string(&mut stdout).expect("text");
    }
    if let Some(pipe) = &mut child.stderr {
        pipe.read_to_string(&mut stderr).expect("text");
    }
    (stdout, stderr)
}

fn rest(child: &mut Child) -> String {
    printed(child).1
}
