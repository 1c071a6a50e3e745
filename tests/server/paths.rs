//! Paths that a run reads and writes: one that is both, or that two outputs share, is refused before anything is touched,
//! however it is spelled.

use super::program::{Program, ending_signals, file, once};
use std::collections::BTreeMap;
use std::fs;
use std::os::unix::fs::symlink;
use std::path::Path;
use tempfile::TempDir;

const BENCH: &str = "\
lines:
  - {name: cell, pty: cell.tty, drives: [{model: small.yaml}, {model: hcfa-x, unit: 7}]}
";
const SCENARIO: &str = "steps: [{name: s, do: [power_cycle]}]\n";
const STATE: &str = "format: 1\ndrives: {}\n";

/// The flags that name an output.
const OUTPUTS: [&str; 4] = ["--log-file", "--ready-file", "--junit", "--state"];
/// What a run reads, and the pseudo-terminal's link, which it makes.
const INPUTS: [&str; 5] = ["bench.yaml", "small.yaml", "day.yaml", "state.yaml", "cell.tty"];
/// Other names for `PATH` that each test file has.
const SPELLINGS: [&str; 5] = ["PATH", "./PATH", "sub/../PATH", "to-PATH", "also-PATH"];

fn folder() -> TempDir {
    let folder = tempfile::tempdir().expect("a folder");
    let model = fs::read_to_string("tests/models/acme-s1.yaml").expect("a model");
    for (name, text) in [
        ("bench.yaml", BENCH),
        ("small.yaml", &model),
        ("day.yaml", SCENARIO),
        ("state.yaml", STATE),
        ("out", "precious"),
    ] {
        let path = file(&folder, name, text);
        fs::hard_link(path, folder.path().join(format!("also-{name}"))).expect("a hard link");
    }
    fs::create_dir(folder.path().join("sub")).expect("a folder");
    for name in INPUTS.into_iter().chain(["out"]) {
        symlink(name, folder.path().join(format!("to-{name}"))).expect("a link");
    }
    folder
}

/// Every file of the folder and what is in it, and where every link leads.
fn contents(folder: &Path) -> BTreeMap<String, String> {
    let entries = fs::read_dir(folder).expect("a folder").map(|it| it.expect("an entry"));
    let entry = |it: fs::DirEntry| {
        let text = match fs::read_link(it.path()) {
            Ok(link) => link.display().to_string(),
            Err(_) if it.path().is_dir() => String::new(),
            Err(_) => fs::read_to_string(it.path()).expect("text"),
        };
        (it.file_name().to_string_lossy().into_owned(), text)
    };
    entries.map(entry).collect()
}

fn refused(folder: &TempDir, args: &[&str], says: &str) {
    let before = contents(folder.path());
    let (code, log, stderr) = once(folder.path(), args);
    assert_eq!(code, Some(2), "{args:?}: {log}{stderr}");
    assert!(stderr.contains(says), "{args:?}: {stderr}");
    assert_eq!(contents(folder.path()), before, "{args:?}");
}

#[test]
fn no_output_is_an_input() {
    let folder = folder();
    for output in OUTPUTS {
        for input in INPUTS {
            // All spellings for one of them, as all are compared in one place.
            let spellings = if output == "--log-file" { &SPELLINGS[..] } else { &SPELLINGS[2..4] };
            for spelling in spellings.iter().map(|it| it.replace("PATH", input)) {
                if output == "--state" && input == "state.yaml" || spelling == "also-cell.tty" {
                    continue;
                }
                let mut args = vec!["run", "bench.yaml", "--scenario", "day.yaml"];
                if input == "state.yaml" {
                    args.extend(["--state", "state.yaml"]);
                }
                args.extend([output, &spelling]);
                // A file that is no state file is found out before the files of the bench are known.
                let says = match (output, input) {
                    ("--state", "small.yaml") => "",
                    _ => " are the same file; nothing was changed",
                };
                refused(&folder, &args, says);
            }
        }
    }
}

#[test]
fn no_two_outputs_are_one() {
    let folder = folder();
    for (i, first) in OUTPUTS.into_iter().enumerate() {
        for second in OUTPUTS.into_iter().skip(i + 1) {
            for (path, spellings) in [("out", &SPELLINGS[3..]), ("new", &SPELLINGS[1..3])] {
                for spelling in spellings.iter().map(|it| it.replace("PATH", path)) {
                    let args = ["run", "hcfa-x", "--scenario", "day.yaml"];
                    let more = [first, path, second, &spelling];
                    refused(&folder, &[&args[..], &more].concat(), " are the same file");
                }
            }
        }
    }
}

#[test]
fn links_of_terminals_are_outputs_too() {
    let folder = folder();
    for output in OUTPUTS {
        for spelling in ["a.tty", "./a.tty", "sub/../a.tty"] {
            let args = ["run", "hcfa-x", "--scenario", "day.yaml", "--pty", "a.tty", output];
            refused(&folder, &[&args[..], &[spelling]].concat(), " are the same file");
        }
    }
}

/// `>>` and `>` open a file before the program can refuse it, but it writes nothing more.
#[test]
fn stdout_is_an_output_too() {
    let folder = folder();
    for (args, stdout) in [
        (&["run", "bench.yaml"][..], "bench.yaml"),
        (&["run", "hcfa-x", "--log-file", "out"], "out"),
        (&["run", "hcfa-x", "--scenario", "day.yaml"], "to-day.yaml"),
        (&["run", "hcfa-x", "--state", "state.yaml"], "also-state.yaml"),
    ] {
        let before = contents(folder.path());
        let append = fs::OpenOptions::new().append(true).open(folder.path().join(stdout));
        let mut command = std::process::Command::new(env!("CARGO_BIN_EXE_drivemu"));
        command.current_dir(folder.path()).args(args).stdout(append.expect("a file"));
        let output = command.output().expect("it starts");
        let said = String::from_utf8_lossy(&output.stderr);
        assert_eq!(output.status.code(), Some(2), "{args:?}: {said}");
        assert!(said.contains(" and stdout are the same file"), "{args:?}: {said}");
        assert_eq!(contents(folder.path()), before, "{args:?}");
    }
}

/// Different files are no matter, nor is what is nobody's.
#[test]
fn what_may_be_shared() {
    let folder = folder();
    file(&folder, "passes.yaml", "steps: [{name: s, expect: [{signal: alarm, is: off}]}]");
    let args = ["run", "hcfa-x", "--scenario", "passes.yaml"];
    for more in [
        &["--log-file", "/dev/null", "--junit", "/dev/null", "--ready-file", "/dev/null"][..],
        &["--log-file", "/dev/stdout", "--junit", "/dev/stdout"],
        &["--log-file", "a", "--junit", "b", "--ready-file", "c", "--state", "d", "--pty", "e"],
    ] {
        let (code, _, stderr) = once(folder.path(), &[&args[..], more].concat());
        assert_eq!(code, Some(0), "{stderr}");
    }
    let left = contents(folder.path());
    for (name, is_left) in [("a", true), ("b", true), ("c", false), ("d", true), ("e", false)] {
        assert_eq!(left.contains_key(name), is_left, "{name}");
    }
}

/// A link stays a link, and where it leads the file is written.
#[test]
fn outputs_through_links() {
    let folder = folder();
    file(&folder, "passes.yaml", "steps: [{name: s, expect: [{signal: alarm, is: off}]}]");
    for (flag, begins) in [("--log-file", "{"), ("--junit", "<?xml"), ("--state", "#")] {
        for link in ["to-new", "to-there"] {
            let _ = fs::remove_file(folder.path().join("new"));
            let _ = fs::remove_file(folder.path().join(link));
            symlink(if link == "to-new" { "new" } else { "there" }, folder.path().join(link))
                .expect("a link");
            let there = folder.path().join(if link == "to-new" { "new" } else { "there" });
            if link == "to-there" && flag != "--state" {
                fs::write(&there, "old").expect("written");
            }
            let args = ["run", "hcfa-x", "--scenario", "passes.yaml", flag, link];
            let (code, _, stderr) = once(folder.path(), &args);
            assert_eq!(code, Some(0), "{stderr}");
            let link = folder.path().join(link);
            assert!(fs::symlink_metadata(&link).expect("there").is_symlink(), "{flag}");
            assert!(fs::read_to_string(&there).expect("there").starts_with(begins), "{flag}");
            fs::remove_file(there).expect("there");
        }
    }
}

/// The report of an earlier run must not pass for that of a run that failed to begin, and each step has failed.
#[test]
fn the_report_is_there_whatever_ends_the_run() {
    let folder = folder();
    let taken = std::net::TcpListener::bind("127.0.0.1:0").expect("a port");
    let addr = taken.local_addr().expect("an address").to_string();
    file(
        &folder,
        "t.yaml",
        "steps: [{name: s, wait: 1h, expect: [{signal: alarm, is: off}]}]"
            .replace("1h", "60min")
            .as_str(),
    );
    for (args, code, why) in [
        (["--tcp", &addr], 3, "address in use"),
        (["--pty", "no/such/link"], 3, "there is no directory"),
        (["--serial", "/dev/nowhere"], 3, "no such device"),
        (["--log-file", "sub"], 1, ""),
        (["--state", "sub/no/such"], 1, "no such file or directory"),
        (["--ready-file", "sub/no/such"], 1, ""),
    ] {
        file(&folder, "report.xml", "of an earlier run");
        let more = ["run", "hcfa-x", "--scenario", "t.yaml", "--junit", "report.xml"];
        let (got, _, stderr) = once(folder.path(), &[&more[..], &args].concat());
        assert_eq!(got, Some(code), "{args:?}: {stderr}");
        let report = fs::read_to_string(folder.path().join("report.xml")).expect("the report");
        if why.is_empty() {
            // Refused like a mistake on the command line: nothing was touched.
            assert_eq!(report, "of an earlier run");
            continue;
        }
        assert!(stderr.contains(why), "{args:?}: {stderr}");
        assert!(report.contains("tests=\"1\" failures=\"1\""), "{args:?}: {report}");
        assert!(report.contains("the run has ended before this step: "), "{args:?}: {report}");
        assert!(report.contains(why), "{args:?}: {report}");
    }
    let report = folder.path().join("report.xml");
    for signal in ending_signals() {
        let path = folder.path().join("t.yaml");
        let (path, out) = (path.to_str().expect("text"), report.to_str().expect("text"));
        let program = Program::run(&["hcfa-x", "--scenario", path, "--junit", out]);
        assert!(!report.exists(), "it speaks of an earlier run");
        assert_eq!(program.stop(signal).0, Some(1));
        let text = fs::read_to_string(&report).expect("the report");
        assert!(text.contains(&format!("before this step: SIG{signal}")), "{text}");
    }
}
