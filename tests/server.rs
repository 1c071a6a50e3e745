//! The program and its ports, from outside: few tests and slow ones, because they wait for the wall.

mod clients;
mod command_line;
mod determinism;
mod gateway;
mod links;
mod masters;
mod paths;
mod ports;
mod program;
mod scenario;
mod sessions;
mod speed;
mod stall;
mod state;
mod streams;
mod virtual_time;
