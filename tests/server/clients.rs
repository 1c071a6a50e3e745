//! Many TCP clients at once: those that say nothing lock nobody out, and stderr tells of the crowd, not of each.

use super::program::{Program, once, wait_for};
use drivemu::server::port::tcp::MAX_CLIENTS;
use drivemu::wire::{mbap, rtu};
use std::io::{Read, Write};
use std::net::TcpStream;

/// Asks and waits for an answer of `len` bytes.
fn ask(stream: &mut TcpStream, request: &[u8], len: usize) {
    stream.write_all(request).expect("written");
    let mut answer = vec![0; len];
    stream.read_exact(&mut answer).expect("an answer");
}

#[test]
fn silent_clients_lock_nobody_out() {
    let read = [3, 0, 0, 0, 1];
    for (port, request, len) in
        [("--tcp", mbap::encode(0, 1, &read), 11), ("--rtu-over-tcp", rtu::encode(1, &read), 7)]
    {
        let mut program = Program::run(&["yako-closed-loop", port, "127.0.0.1:0"]);
        let said = program.listen();
        let connect = || TcpStream::connect(program.addr()).expect("connects");
        let mut busy = connect();
        ask(&mut busy, &request, len);
        let silent: Vec<_> = (0..2 * MAX_CLIENTS).map(|_| connect()).collect();
        let mut late = connect();
        ask(&mut late, &request, len);
        // One that says something stays.
        ask(&mut busy, &request, len);
        drop((silent, late));
        program.wait_until_said(&said, "fewer than 64 clients again; ");
        drop(busy);
        wait_for("the last to leave", || said.all().matches("client disconnected").count() >= 2);
        let said = said.all();
        assert_eq!(said.matches("which is the limit").count(), 1, "{said}");
        let displaced = 2 + 2 * MAX_CLIENTS - MAX_CLIENTS;
        assert!(said.contains(&format!("again; {displaced} were disconnected")), "{said}");
        // None of those that were displaced has a line, and none of those that displaced them.
        assert!(said.matches(" connected\n").count() <= MAX_CLIENTS, "{said}");
        assert_eq!(program.stop("TERM").0, Some(0));
    }
}

#[test]
fn the_limit_is_in_the_help() {
    let folder = tempfile::tempdir().expect("a folder");
    let (code, help, _) = once(folder.path(), &["run", "--help"]);
    assert_eq!(code, Some(0));
    assert!(help.contains(&format!("At most {MAX_CLIENTS} clients at once")), "{help}");
}
