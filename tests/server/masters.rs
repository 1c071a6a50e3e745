//! A master that nobody here wrote, over real ports: tokio-modbus.

use super::program::Program;
use std::time::Duration;
use tokio_modbus::client::{Context, rtu, tcp};
use tokio_modbus::prelude::*;
use tokio_serial::SerialStream;

/// A master on a terminal.
fn rtu_master(path: &str, baud: u32, unit: u8) -> Context {
    let port = SerialStream::open(&tokio_serial::new(path, baud)).expect("the terminal opens");
    rtu::attach_slave(port, Slave(unit))
}

/// What a call gave, with a limit on how long it may take.
async fn soon<T>(call: impl Future<Output = T>) -> T {
    tokio::time::timeout(Duration::from_secs(10), call).await.expect("an answer in time")
}

#[tokio::test]
async fn rtu_over_a_pseudo_terminal() {
    let program = Program::run(&["hcfa-x"]);
    let mut master = rtu_master(&program.path(), 9600, 1);
    assert_eq!(soon(master.read_holding_registers(0x0304, 1)).await.map_err(no), Ok(Ok(vec![100])));
    assert_eq!(soon(master.write_single_register(0x0304, 250)).await.map_err(no), Ok(Ok(())));
    assert_eq!(soon(master.read_holding_registers(0x0304, 1)).await.map_err(no), Ok(Ok(vec![250])));
    // A pair goes whole: low word first.
    let pair = [0x2710, 0];
    assert_eq!(soon(master.write_multiple_registers(0x0806, &pair)).await.map_err(no), Ok(Ok(())));
    let half = soon(master.read_holding_registers(0x0806, 1)).await.map_err(no);
    assert_eq!(half, Ok(Err(ExceptionCode::IllegalDataAddress)));
    let range = soon(master.write_single_register(0x0858, 9)).await.map_err(no);
    assert_eq!(range, Ok(Err(ExceptionCode::IllegalDataValue)));
    let function = soon(master.read_coils(0, 1)).await.map_err(no);
    assert_eq!(function, Ok(Err(ExceptionCode::IllegalFunction)));
    let (code, log, _) = program.stop("TERM");
    assert_eq!(code, Some(0));
    assert!(
        log.contains("unit 1 write P08.88 homing start = 9: refused, range 0..4 -> exception 03"),
        "{log}"
    );
}

#[tokio::test]
async fn two_stations_on_one_terminal_and_a_master_that_comes_back() {
    let program = Program::run(&["k-series"]);
    for round in 0..2 {
        let mut master = rtu_master(&program.path(), 9600, 1);
        assert_eq!(
            soon(master.write_single_register(0x0130, 100 + round)).await.map_err(no),
            Ok(Ok(()))
        );
        master.set_slave(Slave(2));
        assert_eq!(
            soon(master.write_single_register(0x0130, 200 + round)).await.map_err(no),
            Ok(Ok(()))
        );
        master.set_slave(Slave(1));
        let read = soon(master.read_holding_registers(0x0130, 1)).await.map_err(no);
        assert_eq!(read, Ok(Ok(vec![100 + round])));
    }
}

#[tokio::test]
async fn many_clients_on_tcp() {
    let program = Program::run(&["yako-closed-loop", "--unit", "7", "--tcp", "127.0.0.1:0"]);
    let mut masters = Vec::new();
    for _ in 0..5 {
        masters.push(tcp::connect_slave(program.addr(), Slave(7)).await.expect("connects"));
    }
    for (i, master) in masters.iter_mut().enumerate() {
        let speed = 100 + i as u16;
        assert_eq!(soon(master.write_single_register(0x0023, speed)).await.map_err(no), Ok(Ok(())));
    }
    // All talk to one drive: the last one won.
    let read = soon(masters[0].read_holding_registers(0x0023, 1)).await.map_err(no);
    assert_eq!(read, Ok(Ok(vec![104])));
    // The vendor's own numbers: 6 is a write to a read-only row.
    let refused = soon(masters[1].write_single_register(0, 1)).await.map_err(no);
    assert_eq!(refused, Ok(Err(ExceptionCode::ServerDeviceBusy)));
    // 255 is whoever is there.
    masters[2].set_slave(Slave(255));
    let read = soon(masters[2].read_holding_registers(0x0002, 1)).await.map_err(no);
    assert_eq!(read, Ok(Ok(vec![7])));
}

#[tokio::test]
async fn serial_frames_over_tcp() {
    let program = Program::run(&["hcfa-x", "--rtu-over-tcp", "127.0.0.1:0"]);
    let stream = tokio::net::TcpStream::connect(program.addr()).await.expect("connects");
    let mut master = rtu::attach_slave(stream, Slave(1));
    let read = soon(master.read_holding_registers(0x0304, 1)).await.map_err(no);
    assert_eq!(read, Ok(Ok(vec![100])));
}

/// Transport errors have no equality; any of them fails the test with its words.
fn no(error: tokio_modbus::Error) -> String {
    error.to_string()
}
