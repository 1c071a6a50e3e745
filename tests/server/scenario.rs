//! `--scenario` and `--junit` from outside: exit codes, the report, several lines.

use super::program::{Program, file, once, wait_for};
use std::fs;
use std::path::Path;
use std::time::Duration;
use tempfile::TempDir;
use tokio_modbus::client::{Context, tcp};
use tokio_modbus::prelude::*;

const STEPS: &str = "steps:
  - {name: runs, after: {n: 2, kind: write}, expect: [{signal: moving, is: on}]}
  - {name: trips, do: [raise over_voltage], expect: [{signal: alarm, is: off}]}
  - {name: rests, when: {signal: moving, is: off}, expect: [{signal: enabled, is: off}]}
";

fn folder() -> TempDir {
    tempfile::tempdir().expect("a folder")
}

fn text(path: &Path) -> &str {
    path.to_str().expect("text")
}

/// A master that starts a run.
async fn start(program: &Program) -> Context {
    let mut master = tcp::connect_slave(program.addr(), Slave(1)).await.expect("connects");
    for _ in 0..2 {
        let written = master.write_single_register(0x27, 2);
        let written = tokio::time::timeout(Duration::from_secs(10), written).await;
        written.expect("in time").expect("an answer").expect("no exception");
    }
    master
}

#[tokio::test]
async fn a_run_is_a_test() {
    let folder = folder();
    let (steps, report) = (file(&folder, "day.yaml", STEPS), folder.path().join("report.xml"));
    let args = ["yako-closed-loop", "--tcp", "127.0.0.1:0", "--quiet"];
    let more = ["--scenario", text(&steps), "--junit", text(&report)];
    let program = Program::run(&[&args[..], &more].concat());
    let _master = start(&program).await;
    let (code, log, stderr) = program.ended();
    assert_eq!(code, Some(1), "{stderr}");
    assert!(stderr.starts_with("line: step trips failed at "), "{stderr}");
    assert!(stderr.ends_with(" s: alarm of unit 1 is on, not off\n"), "{stderr}");
    assert_eq!(stderr.lines().count(), 1, "{stderr}");
    assert!(log.contains(" step rests passed\n"), "{log}");
    let report = fs::read_to_string(report).expect("the report");
    assert!(report.contains("name=\"line\" tests=\"3\" failures=\"1\""), "{report}");
    assert!(report.contains("<failure message=\"alarm of unit 1 is on, not off\"/>"), "{report}");
    assert!(report.ends_with("</testsuites>\n"), "{report}");
}

/// Steps of two lines, each in its own time; the run ends with the last of both.
#[tokio::test]
async fn each_line_has_its_steps() {
    let folder = folder();
    let bench = file(
        &folder,
        "bench.yaml",
        "lines: [{name: a, tcp: '127.0.0.1:0', drives: [{model: yako-closed-loop}]}, {name: b, tcp: '127.0.0.1:0', drives: [{model: hcfa-x}]}]",
    );
    let steps = file(
        &folder,
        "day.yaml",
        "steps:
  - {name: b trips, line: b, do: [raise overload], expect: [{signal: alarm, is: on}]}
  - {name: a runs, line: a, when: {quantity: position.actual, above: 99}, expect: [{quantity: position.actual, is: 100}]}
",
    );
    let report = folder.path().join("report.xml");
    let args = [text(&bench), "--scenario", text(&steps), "--junit", text(&report)];
    let program = Program::run(&args);
    let _master = start(&program).await;
    let (code, _, stderr) = program.ended();
    assert_eq!(code, Some(0), "{stderr}");
    let report = fs::read_to_string(report).expect("the report");
    for line in ["a", "b"] {
        let suite = format!("<testsuite name=\"{line}\" tests=\"1\" failures=\"0\"");
        assert!(report.contains(&suite), "{report}");
    }
}

#[test]
fn a_signal_ends_it_and_the_report_is_there() {
    let folder = folder();
    let (steps, report) = (file(&folder, "day.yaml", STEPS), folder.path().join("report.xml"));
    let args = ["yako-closed-loop", "--scenario", text(&steps), "--junit", text(&report)];
    let (code, _, stderr) = Program::run(&args).stop("TERM");
    assert_eq!(code, Some(1), "{stderr}");
    assert!(stderr.contains("step runs failed at"), "{stderr}");
    let report = fs::read_to_string(report).expect("the report");
    assert_eq!(report.matches("the run has ended before this step").count(), 3, "{report}");
    // One that expects nothing is no test.
    let steps = file(&folder, "play.yaml", "steps: [{name: s, do: [block on]}]");
    let log = folder.path().join("log");
    let more = ["--scenario", text(&steps), "--log-file", text(&log)];
    let program = Program::run(&[&["yako-closed-loop"], &more[..]].concat());
    // Ready are the ports; the first step comes when they are served.
    let step = "\"text\":\"step s\"";
    wait_for("the step", || fs::read_to_string(&log).is_ok_and(|log| log.contains(step)));
    assert_eq!(program.stop("TERM").0, Some(0));
}

#[test]
fn a_bad_scenario_is_refused() {
    let folder = folder();
    let bad = "steps: [{name: s, do: [terminal X9 on]}]";
    file(&folder, "bad.yaml", bad);
    file(&folder, "good.yaml", STEPS);
    for (args, code, says) in [
        (
            &["run", "yako-closed-loop", "--scenario", "bad.yaml"][..],
            2,
            "steps[0].do[0]: unknown input terminal `X9`\n --> bad.yaml:1:24",
        ),
        (
            &["run", "yako-closed-loop", "--scenario", "none.yaml"],
            2,
            "cannot read none.yaml: no such file",
        ),
        (
            &["run", "good.yaml"],
            2,
            "good.yaml is a scenario; write `run MODEL --scenario good.yaml`",
        ),
        (&["run", "hcfa-x", "--junit", "r.xml"], 2, "--scenario"),
        (&["check", "good.yaml", "bad.yaml"], 0, ""),
        (&["schema", "scenario"], 0, ""),
    ] {
        let (got, out, stderr) = once(folder.path(), args);
        assert_eq!(got, Some(code), "{args:?}: {stderr}");
        assert!(stderr.contains(says), "{args:?}: {stderr}");
        assert!(code != 0 || out.contains("valid scenario") || out.contains("\"steps\""), "{out}");
    }
}

/// More to do than any machine can: emulated time lags behind, masters are served, and a signal ends it.
#[test]
fn a_run_that_can_not_keep_up_is_still_served() {
    use drivemu::wire::mbap;
    use std::io::{Read, Write};
    let folder = folder();
    let steps = file(
        &folder,
        "busy.yaml",
        "steps: [{name: s, do: [power on], repeat: {every: 1ms, times: 4000000000}}]",
    );
    let args = ["hcfa-x", "--tcp", "127.0.0.1:0", "--rate", "1000000"];
    let mut program = Program::run(&[&args[..], &["--scenario", text(&steps)]].concat());
    let said = program.listen();
    program.wait_until_said(&said, "emulated time lags behind");
    for _ in 0..5 {
        let mut stream = std::net::TcpStream::connect(program.addr()).expect("connects");
        stream.write_all(&mbap::encode(0, 1, &[3, 0x03, 0x04, 0, 1])).expect("written");
        stream.read_exact(&mut [0; 11]).expect("an answer");
    }
    // Nobody reads stdout here: what it does not take is lost and counted, not kept.
    let most = program.memory();
    assert!(most < 300 << 10, "{most} KiB");
    assert_eq!(program.stop("TERM").0, Some(0));
}
