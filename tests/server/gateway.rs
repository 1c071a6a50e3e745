//! Drives behind a serial line and a TCP gateway at once: several ports of one line.

use super::ports::plug_in;
use super::program::{Program, file};
use drivemu::wire::{mbap, rtu};
use std::fs::{File, OpenOptions};
use std::io::{Read, Write};
use std::net::TcpStream;

/// A run of a line with `ports` and one stepper, in a folder that outlives it.
fn run(line: &str) -> (tempfile::TempDir, Program) {
    let folder = tempfile::tempdir().expect("a folder");
    let text = format!("lines: [{{name: cell, {line}, drives: [{{model: yako-closed-loop}}]}}]");
    let bench = file(&folder, "cell.yaml", &text);
    let program = Program::run(&[bench.to_str().expect("text"), "--seed", "1"]);
    (folder, program)
}

fn serial(program: &Program, endpoint: usize) -> File {
    let path = program.ready()["endpoints"][endpoint]["path"].as_str().expect("a path");
    OpenOptions::new().read(true).write(true).open(path).expect("the terminal opens")
}

fn tcp(program: &Program, endpoint: usize) -> TcpStream {
    let addr = program.ready()["endpoints"][endpoint]["addr"].as_str().expect("an address");
    TcpStream::connect(addr).expect("connects")
}

/// The answer as it came, which is to have as many bytes as one with `len` bytes behind the unit.
fn ask(mut port: impl Read + Write, is_tcp: bool, pdu: &[u8], len: usize) -> Vec<u8> {
    let request = if is_tcp { mbap::encode(7, 1, pdu) } else { rtu::encode(1, pdu) };
    port.write_all(&request).expect("written");
    let mut answer = vec![0; len + if is_tcp { 7 } else { 3 }];
    port.read_exact(&mut answer).expect("an answer");
    answer
}

#[test]
fn what_one_master_writes_the_other_reads() {
    let (_folder, program) =
        run(r#"ports: [{pty: auto}, {tcp: "127.0.0.1:0"}, {rtu_over_tcp: "127.0.0.1:0"}]"#);
    let endpoints = program.ready()["endpoints"].as_array().expect("a list");
    let said = |key: &str| -> Vec<_> { endpoints.iter().map(|it| it[key].clone()).collect() };
    assert_eq!(said("kind"), ["pty", "tcp", "rtu-over-tcp"]);
    assert_eq!(said("framing"), ["rtu", "mbap", "rtu"]);
    assert_eq!(said("name"), ["cell"; 3]);
    assert!(endpoints.iter().all(|it| it["units"][0]["unit"] == 1));

    let (serial, gateway, server) = (serial(&program, 0), tcp(&program, 1), tcp(&program, 2));
    let write = |value| [6, 0, 0x1D, 1, value];
    let read = [3, 0, 0x1D, 0, 1];
    let value = |value| [3, 2, 1, value];
    assert_eq!(ask(&serial, false, &write(0x23), 5), *rtu::encode(1, &write(0x23)));
    assert_eq!(ask(&gateway, true, &read, 4), *mbap::encode(7, 1, &value(0x23)));
    assert_eq!(ask(&gateway, true, &write(0x2A), 5), *mbap::encode(7, 1, &write(0x2A)));
    assert_eq!(ask(&server, false, &read, 4), *rtu::encode(1, &value(0x2A)));
    assert_eq!(ask(&serial, false, &read, 4), *rtu::encode(1, &value(0x2A)));
}

/// A rule counts the requests of all masters, unless what it does is impossible on Modbus TCP.
#[test]
fn a_fault_hits_whoever_asks() {
    let (_folder, program) = run(r#"ports: [{pty: auto}, {tcp: "127.0.0.1:0"}], faults: [
        {do: busy, function: 6, every: 2}, {do: bad_crc, function: 3, every: 2}]"#);
    let (serial, gateway) = (serial(&program, 0), tcp(&program, 1));
    let write = [6, 0, 0x1D, 0, 9];
    for _ in 0..3 {
        assert_eq!(ask(&serial, false, &write, 5), *rtu::encode(1, &write));
        assert_eq!(ask(&gateway, true, &write, 2), *mbap::encode(7, 1, &[0x86, 6]));
    }
    let (read, value) = ([3, 0, 0x1D, 0, 1], [3, 2, 0, 9]);
    for i in 1..=6 {
        assert_eq!(ask(&gateway, true, &read, 4), *mbap::encode(7, 1, &value));
        let is_good = ask(&serial, false, &read, 4) == *rtu::encode(1, &value);
        assert_eq!(is_good, i % 2 == 1, "serial read {i}");
    }
}

/// While one port is away the others go on; diagnostics say which it is.
#[test]
fn a_port_that_is_lost_takes_no_other_along() {
    let folder = tempfile::tempdir().expect("a folder");
    let device = folder.path().join("ttyUSB0");
    let cable = plug_in(&device);
    let ports = format!("ports: [{{serial: {}}}, {{tcp: \"127.0.0.1:0\"}}]", device.display());
    let (_bench, mut program) = run(&ports);
    let said = program.listen();
    let gateway = tcp(&program, 1);
    let (read, value) = ([3, 0, 0x23, 0, 1], [3, 2, 0, 0x3C]);
    assert_eq!(ask(&cable, false, &read, 4), *rtu::encode(1, &value));
    drop(cable);
    program.wait_until_said(&said, "cell serial: the port disappeared");
    assert_eq!(ask(&gateway, true, &read, 4), *mbap::encode(7, 1, &value));
    std::fs::remove_file(&device).expect("unplugged");
    let cable = plug_in(&device);
    program.wait_until_said(&said, "cell serial: the port is back");
    assert_eq!(ask(&cable, false, &read, 4), *rtu::encode(1, &value));
    assert_eq!(ask(&gateway, true, &read, 4), *mbap::encode(7, 1, &value));
}

/// What keeps replies waiting is a matter of the line; what an adapter or a receiver does, of a serial port.
#[test]
fn behaviour_of_the_line_at_each_port() {
    let (_folder, program) =
        run(r#"ports: [{pty: auto}, {tcp: "127.0.0.1:0"}], echo: true, chunk: 1ms"#);
    let (mut serial, gateway) = (serial(&program, 0), tcp(&program, 1));
    let (read, value) = ([3, 0, 0x23, 0, 1], [3, 2, 0, 0x3C]);
    assert_eq!(ask(&gateway, true, &read, 4), *mbap::encode(7, 1, &value));
    let request = rtu::encode(1, &read);
    serial.write_all(&request).expect("written");
    let mut got = vec![0; request.len() + 7];
    serial.read_exact(&mut got).expect("an echo and an answer");
    assert_eq!(got, [&*request, &*rtu::encode(1, &value)].concat());
}
