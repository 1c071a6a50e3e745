//! Flags, exit codes, and the sentences that go with them.

use super::program::{Program, file, once};

/// Arguments, exit code, and what stderr must say.
const REFUSED: &[(&[&str], i32, &str)] = &[
    (&["run", "foo"], 2, "unknown model or product `foo`"),
    (&["run", "hcfa"], 2, "did you mean `hcfa-x`?"),
    (&["run", "nowhere.yaml"], 2, "cannot read nowhere.yaml: no such file or directory"),
    (&["run", "hcfa-x", "--set", "P09.11"], 2, "expected KEY=VALUE"),
    (&["run", "hcfa-x", "--set", "P09.11=99"], 2, "accepts 0..60"),
    (&["run", "hcfa-x", "--set", "P09.11=x"], 2, "`x` is not an integer"),
    (&["run", "hcfa-x", "--set", "P03.04=1.5"], 2, "--set P03.04=1.5: `1.5` is not an integer"),
    (&["run", "hcfa-x", "--set", "P03.04=NaN"], 2, "`NaN` is not an integer"),
    (&["run", "hcfa-x", "--set", "P03.04=9223372036854775808"], 2, "is not an integer"),
    (&["run", "hcfa-x", "--set", "P03.04="], 2, "--set P03.04=: `` is not an integer"),
    (&["run", "hcfa-x", "--set", "P03.04=0x-5"], 2, "`0x-5` is not an integer"),
    (&["run", "hcfa-x", "--set", "P03.04=-1"], 2, "--set P03.04=-1: P03.04 Jog speed accepts 0.."),
    (
        &["run", "hcfa-x", "--set", "P03.04=99999"],
        2,
        "--set P03.04=99999: P03.04 Jog speed accepts 0..",
    ),
    (&["run", "hcfa-x", "--set", "P08.06=4294967296"], 2, "accepts -2147483648..2147483647"),
    (&["run", "k-series", "--set", "0x0130=65541"], 2, "not 65541"),
    (&["run", "hcfa-x", "--set", "P03.04=1", "--set", "P03.04=2"], 2, "P03.04 is given twice"),
    (&["run", "hcfa-x", "--set", "run_lock=none", "--set", "run_lock=none"], 2, "is given twice"),
    (&["run", "hcfa-x", "--set", "P21.07=5"], 2, "shows a computed value"),
    (&["run", "hcfa-x", "--set", "bogus=1"], 2, "unknown register or option `bogus`"),
    (&["run", "hcfa-x", "--set", "run_lock=maybe"], 2, "run_lock accepts at_stop_rows, none"),
    (&["run", "k-series", "--unit", "200"], 2, "accepts 1..127, not 200"),
    (&["run", "hcfa-x", "--unit", "0"], 2, "1..=247"),
    (&["run", "hcfa-x", "--switches", "3"], 2, "this drive has no DIP switches (use `unit`)"),
    (&["run", "yako-open-loop", "--switches", "32"], 2, "5 switches give 0..31, not 32"),
    (
        &[
            "run",
            "yako-open-loop",
            "--set",
            "baud_switches=sw6_sw7",
            "--switches",
            "65",
            "-b",
            "9600",
        ],
        2,
        "its switches set 19200 baud, but the line is at 9600-8N1 RTU",
    ),
    (&["run", "bench.yaml", "--switches", "3"], 2, "--switches applies to a model only"),
    (&["run", "hcfa-x", "--ascii"], 2, "does not support ASCII"),
    (&["run", "hcfa-x", "-b", "12345"], 2, "does not support 12345 baud"),
    (&["run", "hcfa-x", "--rate", "0"], 2, "--rate must be from 0.001"),
    (&["run", "hcfa-x", "--tcp", "127.0.0.1:0", "-b", "19200"], 2, "no serial settings"),
    (&["run", "--pty", "hcfa-x"], 2, "write `run hcfa-x --pty`"),
    (&["run", "--tcp", "hcfa-x"], 2, "write `run hcfa-x --tcp`"),
    (&["run", "--pty", "a", "--serial", "b"], 2, "cannot be used with"),
    (&["run", "hcfa-x", "--serial", "/dev/nowhere"], 3, "cannot open /dev/nowhere: no such device"),
    (&["run", "hcfa-x", "--pty", "no/such/link"], 3, "there is no directory"),
    (&["run", "hcfa-x", "--pty", "occupied"], 3, "exists and is not a symlink"),
    (&["run", "hcfa-x", "--tcp", "nonsense"], 3, "expected HOST:PORT"),
    (&["run", "hcfa-x", "--log-file", "no/such/log"], 1, "cannot write no/such/log"),
    (&["run", "broken.yaml"], 2, "broken.yaml:1:9"),
    (&["run", "binary.yaml"], 2, "this is not UTF-8 text"),
    (&["run", "/dev/zero"], 2, "cannot read /dev/zero: a file may have at most 16777216 bytes"),
    (&["run", "./"], 2, "cannot read ./: this is a directory"),
    (
        &["run", "hcfa-x", "--scenario", "/dev/zero"],
        2,
        "cannot read /dev/zero: a file may have at most",
    ),
    (&["run", "hcfa-x", "--state", "/dev/zero"], 2, "cannot use /dev/zero: not a regular file"),
    (&["show", "/dev/zero"], 2, "cannot read /dev/zero: a file may have at most"),
    (&["check", "/dev/zero"], 2, "/dev/zero: a file may have at most"),
    (&["check", "."], 2, ".: this is a directory"),
    (&["run", "endless.yaml"], 2, "cannot read /dev/zero: a file may have at most"),
    (&["run", "bench.yaml", "--unit", "3"], 2, "--unit applies to a model only"),
    (&["run", "bench.yaml", "--pacing", "line"], 2, "--pacing applies to a model only"),
    (&["run", "hcfa-x", "--tcp", "127.0.0.1:0", "--pacing", "line"], 2, "no character times"),
    (&["run", "hcfa-x", "--fault", "lose_reply:evry=2"], 2, "did you mean `every`?"),
    (&["run", "hcfa-x", "--fault", "late", "--fault", "late:name=late"], 2, "--fault:1:11"),
    (&["run", "bench.yaml", "--fault", "bad_crc"], 2, "Modbus TCP frames have no checksum"),
    (&["show", "hcfa-x", "P09.1"], 2, "did you mean `P09.01`?"),
    (&["check", "nowhere.yaml"], 2, "no such file or directory"),
    (&["check", "broken.yaml", "bench.yaml"], 2, "1 of 2 file(s) invalid"),
    (&["schema", "nonsense"], 2, "possible values: model, bench, scenario"),
    (&["nonsense"], 2, "unrecognized subcommand"),
];

const BENCH: &str = "\
lines:
  - {name: cell, pty: ./cell.tty, drives: [{model: k-series}]}
  - {name: hall, tcp: '127.0.0.1:0', drives: [{model: yako-open-loop, switches: 9}]}
";

#[test]
fn refusals_and_their_exit_codes() {
    let folder = tempfile::tempdir().expect("a folder");
    file(&folder, "occupied", "precious");
    file(&folder, "broken.yaml", "format: x\n");
    file(&folder, "bench.yaml", BENCH);
    file(&folder, "endless.yaml", "lines: [{pty: auto, drives: [{model: /dev/zero}]}]");
    std::fs::write(folder.path().join("binary.yaml"), [0xFF, 0xFE, 0x00]).expect("written");
    for (args, code, says) in REFUSED {
        let (got, stdout, stderr) = once(folder.path(), args);
        assert_eq!(got, Some(*code), "{args:?}\n{stderr}");
        assert!(stderr.contains(says) || stdout.contains(says), "{args:?}\n{stdout}{stderr}");
    }
    let occupied = std::fs::read_to_string(folder.path().join("occupied")).expect("still there");
    assert_eq!(occupied, "precious");
}

#[test]
fn a_busy_port_is_refused() {
    let taken = std::net::TcpListener::bind("127.0.0.1:0").expect("a port");
    let addr = taken.local_addr().expect("an address").to_string();
    let folder = tempfile::tempdir().expect("a folder");
    let (code, _, stderr) = once(folder.path(), &["run", "--tcp", &addr]);
    assert_eq!(code, Some(3), "{stderr}");
    assert!(stderr.contains(&addr), "{stderr}");
}

#[test]
fn what_there_is() {
    let folder = tempfile::tempdir().expect("a folder");
    for (args, says) in [
        (&["models"][..], "yako-closed-loop (default)"),
        (&["show", "hcfa-x"], "0x090B"),
        (&["show", "hcfa-x", "0x090B"], "P09.11"),
        (&["show", "X3EA", "090BH", "--format", "markdown"], "通信设定命令值维持时间"),
        (&["schema", "model"], "\"$schema\""),
        (&["schema", "bench"], "rtu_over_tcp"),
        (&["--version"], env!("CARGO_PKG_VERSION")),
    ] {
        let (code, stdout, stderr) = once(folder.path(), args);
        assert_eq!((code, stderr.as_str()), (Some(0), ""), "{args:?}");
        assert!(stdout.contains(says), "{args:?}\n{stdout}");
    }
    let (_, stdout, _) = once(folder.path(), &["show", "hcfa-x", "P09.11", "--format", "json"]);
    let rows: serde_json::Value = serde_json::from_str(&stdout).expect("JSON");
    assert_eq!(rows[0]["address"], 0x090B);
}

#[test]
fn a_bench_of_two_lines_is_ready_logs_and_cleans_up() {
    let program = {
        let folder = tempfile::tempdir().expect("a folder");
        let bench = file(&folder, "bench.yaml", BENCH);
        let program =
            Program::run(&[bench.to_str().expect("text"), "--seed", "42", "--format", "json"]);
        let link = folder.path().join("cell.tty");
        let ready = program.ready();
        assert_eq!(ready["seed"], 42);
        assert_eq!(ready["endpoints"][0]["kind"], "pty");
        assert_eq!(ready["endpoints"][0]["line"], "9600-8E1");
        assert_eq!(ready["endpoints"][0]["units"][1]["unit"], 2);
        assert_eq!(ready["endpoints"][1]["kind"], "tcp");
        assert_eq!(ready["endpoints"][1]["units"][0]["unit"], 9);
        let target = std::fs::read_link(&link).expect("a symlink");
        assert_eq!(target.to_str(), ready["endpoints"][0]["path"].as_str());
        let (code, stdout, stderr) = program.stop("INT");
        assert_eq!(code, Some(0), "{stderr}");
        assert!(std::fs::symlink_metadata(&link).is_err(), "the link is left behind");
        stdout
    };
    let events: Vec<serde_json::Value> =
        program.lines().map(|line| serde_json::from_str(line).expect("JSON")).collect();
    assert!(events.iter().any(|event| event["line"] == "hall" && event["event"] == "power_on"));
}
