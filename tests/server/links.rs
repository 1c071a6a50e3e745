//! Links and ready files of runs that are alive, and of such as are not.

use super::program::{Program, once};
use std::fs::read_link;
use std::os::unix::fs::symlink;

fn text(path: &std::path::Path) -> &str {
    path.to_str().expect("text")
}

#[test]
fn the_link_of_a_living_run_is_not_taken() {
    let folder = tempfile::tempdir().expect("a folder");
    let link = folder.path().join("drive.tty");
    let program = Program::run(&["--pty", text(&link)]);
    let target = read_link(&link).expect("a link");
    let bench = format!("lines: [{{pty: {}, drives: [{{model: hcfa-x}}]}}]", text(&link));
    std::fs::write(folder.path().join("bench.yaml"), bench).expect("written");
    for args in [
        &["run", "--pty", text(&link)][..],
        &["run", "hcfa-x", "--pty", "./drive.tty"],
        &["run", "bench.yaml"],
    ] {
        let (code, stdout, stderr) = once(folder.path(), args);
        assert_eq!((code, stdout.as_str()), (Some(3), ""), "{stderr}");
        assert!(stderr.contains("drive.tty: used by a running drivemu"), "{stderr}");
        assert_eq!(read_link(&link).expect("a link"), target);
    }
    assert_eq!(program.stop("TERM").0, Some(0));
    assert!(!link.is_symlink());
}

#[test]
fn the_link_of_a_killed_run_is_taken() {
    let folder = tempfile::tempdir().expect("a folder");
    let link = folder.path().join("drive.tty");
    Program::run(&["--pty", text(&link)]).kill();
    assert!(link.is_symlink());
    let program = Program::run(&["--pty", text(&link)]);
    assert_eq!(text(&read_link(&link).expect("a link")), program.path());
}

#[test]
fn a_link_to_something_that_is_there_is_not_taken() {
    let folder = tempfile::tempdir().expect("a folder");
    let link = folder.path().join("drive.tty");
    // Another program's terminal, and a device that somebody has a short name for.
    let other = Program::run(&[]);
    for there in [other.path().as_str(), "/dev/null"] {
        symlink(there, &link).expect("linked");
        let (code, _, stderr) = once(folder.path(), &["run", "--pty", text(&link)]);
        assert_eq!(code, Some(3), "{stderr}");
        assert!(stderr.contains("not replaced"), "{stderr}");
        assert_eq!(text(&read_link(&link).expect("a link")), there);
        std::fs::remove_file(&link).expect("removed");
    }
}

/// Nobody knows what else stands at the path by the end of the run.
#[test]
fn a_link_that_is_no_longer_ours_stays() {
    let folder = tempfile::tempdir().expect("a folder");
    let link = folder.path().join("drive.tty");
    let program = Program::run(&["--pty", text(&link)]);
    std::fs::remove_file(&link).expect("removed");
    std::fs::write(&link, "precious").expect("written");
    assert_eq!(program.stop("TERM").0, Some(0));
    assert_eq!(std::fs::read_to_string(&link).expect("a file"), "precious");
}

#[test]
fn two_lines_of_a_bench_do_not_share_a_link() {
    let folder = tempfile::tempdir().expect("a folder");
    let line = |link: &str| format!("{{pty: {link}, drives: [{{model: hcfa-x}}]}}");
    for second in ["./a.tty", "sub/../a.tty"] {
        std::fs::create_dir_all(folder.path().join("sub")).expect("made");
        let bench = format!("lines: [{}, {}]", line("a.tty"), line(second));
        std::fs::write(folder.path().join("bench.yaml"), bench).expect("written");
        let (got, _, stderr) = once(folder.path(), &["run", "bench.yaml"]);
        assert_eq!(got, Some(2), "{stderr}");
        assert!(!folder.path().join("a.tty").is_symlink());
    }
}

#[test]
fn the_ready_file_of_a_living_run_is_not_taken() {
    let program = Program::run(&[]);
    let ready = program.folder().join("ready.json");
    let told = std::fs::read_to_string(&ready).expect("a file");
    let (code, _, stderr) = once(program.folder(), &["run", "--ready-file", "./ready.json"]);
    assert_eq!(code, Some(1), "{stderr}");
    assert!(stderr.contains("ready.json: used by a running drivemu"), "{stderr}");
    assert_eq!(std::fs::read_to_string(&ready).expect("a file"), told);
}
