//! Random traffic: good frames to anybody, broken and cut ones, noise, and pauses between them.

use drivemu::time::Duration;
use drivemu::wire::rtu::encode;
use proptest::collection::vec;
use proptest::prelude::*;
use std::ops::Range;

/// Bytes in one read, and the silence behind them.
#[derive(Debug, Clone)]
pub struct Piece {
    pub bytes: Vec<u8>,
    pub pause: Duration,
}

/// Registers where something happens, on one model or another.
const INTERESTING: [u16; 40] = [
    0x0304, 0x0401, 0x0415, 0x0806, 0x0807, 0x0857, 0x0858, 0x0860, 0x0861, 0x0900, 0x0905, 0x0906,
    0x090B, 0x140C, 0x1501, 0x1507, 0x1515, 0x3607, 0x3608, 0x360A, 0x3688, 0xE304, 0xE806, 0xF40C,
    0x0000, 0x000A, 0x0013, 0x0019, 0x0020, 0x0024, 0x0027, 0x002D, 0x0035, 0x0060, 0x0064, 0x0119,
    0x0451, 0x0521, 0x0600, 0x05F2,
];

/// A write of one register.
pub fn request(unit: u8, address: u16, value: u16) -> Vec<u8> {
    let ([a, b], [c, d]) = (address.to_be_bytes(), value.to_be_bytes());
    encode(unit, &[6, a, b, c, d]).to_vec()
}

/// Some bytes.
pub fn bytes(len: Range<usize>) -> impl Strategy<Value = Vec<u8>> {
    vec(any::<u8>(), len)
}

/// Traffic.
pub fn pieces(len: Range<usize>) -> impl Strategy<Value = Vec<Piece>> {
    let micros = prop_oneof![Just(0u64), 0..30_000u64];
    let piece = (piece(), micros);
    let piece =
        piece.prop_map(|(bytes, micros)| Piece { bytes, pause: Duration::from_micros(micros) });
    vec(piece, len)
}

fn piece() -> impl Strategy<Value = Vec<u8>> {
    let cut = (frame(), any::<prop::sample::Index>()).prop_map(|(mut frame, at)| {
        frame.truncate(at.index(frame.len()) + 1);
        frame
    });
    let broken =
        (frame(), any::<prop::sample::Index>(), 0..8u8).prop_map(|(mut frame, at, bit)| {
            let at = at.index(frame.len());
            frame[at] ^= 1 << bit;
            frame
        });
    prop_oneof![4 => frame(), 2 => cut, 2 => broken, 2 => bytes(1..40), 1 => bytes(200..700)]
}

/// A good frame to one of ours, to all, or to a stranger.
fn frame() -> impl Strategy<Value = Vec<u8>> {
    let unit = prop_oneof![5 => 0..6u8, 1 => any::<u8>()];
    (unit, pdu()).prop_map(|(unit, pdu)| encode(unit, &pdu).to_vec())
}

/// A read, a write, or something else.
pub fn pdu() -> impl Strategy<Value = Vec<u8>> {
    let value = prop_oneof![3 => 0..10u16, 2 => any::<u16>()];
    let one = (address(), value.clone()).prop_map(|(address, value)| {
        [&[6][..], &address.to_be_bytes(), &value.to_be_bytes()].concat()
    });
    let count = prop_oneof![8 => 0..20u16, 1 => any::<u16>()];
    let read = (address(), count).prop_map(|(address, count)| {
        [&[3][..], &address.to_be_bytes(), &count.to_be_bytes()].concat()
    });
    let many = (address(), vec(value, 1..18), any::<bool>()).prop_map(|(address, values, lie)| {
        let count = values.len() as u16 + u16::from(lie);
        let head = [&[0x10][..], &address.to_be_bytes(), &count.to_be_bytes()].concat();
        let data = values.iter().flat_map(|value| value.to_be_bytes());
        head.into_iter().chain([values.len() as u8 * 2]).chain(data).collect()
    });
    prop_oneof![4 => one, 3 => read, 4 => many, 1 => bytes(1..20)]
}

fn address() -> impl Strategy<Value = u16> {
    prop_oneof![
        6 => prop::sample::select(&INTERESTING[..]),
        2 => 0..0x0640u16,
        1 => any::<u16>(),
    ]
}
