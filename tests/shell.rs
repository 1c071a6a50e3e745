//! The program and its ports, from outside: few tests and slow ones, because they wait for the wall.

mod clients;
mod command_line;
mod determinism;
mod masters;
mod ports;
mod program;
mod scenario;
mod state;
mod virtual_time;
