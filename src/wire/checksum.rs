//! The two checksums of Modbus over serial line.

use crc::{CRC_16_MODBUS, Crc, Table};

const CRC16: Crc<u16, Table<16>> = Crc::<u16, Table<16>>::new(&CRC_16_MODBUS);

/// CRC-16 of RTU frames (serial line, 6.2.2). It travels low byte first.
pub fn crc16(bytes: &[u8]) -> u16 {
    CRC16.checksum(bytes)
}

/// The lengths at which the last two bytes of the beginning of `bytes` are the CRC of what stands before them.
pub(super) fn crc_fits(bytes: &[u8]) -> impl Iterator<Item = usize> {
    let mut digest = CRC16.digest();
    // Over its own CRC this CRC is 0.
    let residues = bytes.iter().map(move |byte| {
        digest.update(&[*byte]);
        digest.clone().finalize()
    });
    residues.enumerate().filter(|(_, residue)| *residue == 0).map(|(i, _)| i + 1)
}

/// LRC of ASCII frames (serial line, 6.2.1): two's complement of the sum of the bytes.
pub fn lrc(bytes: &[u8]) -> u8 {
    bytes.iter().fold(0u8, |sum, byte| sum.wrapping_add(*byte)).wrapping_neg()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn known_values() {
        // Printed in two manuals of the field and in the serial line specification's own example.
        assert_eq!(crc16(&[0x01, 0x03, 0x15, 0x07, 0x00, 0x02]).to_le_bytes(), [0x71, 0xC6]);
        assert_eq!(crc16(&[0x02, 0x07]), 0x1241);
        assert_eq!(lrc(&[0x01, 0x03, 0x02, 0x01, 0x00, 0x01]), 0xF8);
    }
}
