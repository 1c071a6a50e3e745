//! Bytes as people write them.

/// Bytes written in hex, in any grouping: `01 03 0023`.
///
/// # Errors
/// What is no hex.
pub fn hex(text: &str) -> Result<Vec<u8>, String> {
    let digits: String = text.chars().filter(|c| !c.is_whitespace()).collect();
    if !digits.is_ascii() || !digits.len().is_multiple_of(2) {
        return Err(format!("`{text}` does not consist of whole bytes in hex"));
    }
    let byte = |i| u8::from_str_radix(&digits[i..i + 2], 16);
    let bytes = (0..digits.len()).step_by(2).map(byte).collect::<Result<_, _>>();
    bytes.map_err(|_| format!("`{text}` is not hex"))
}

/// Bytes as hex with spaces.
pub fn to_hex(bytes: &[u8]) -> String {
    bytes.iter().map(|byte| format!("{byte:02X}")).collect::<Vec<_>>().join(" ")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn any_grouping() {
        assert_eq!(hex("01 0304 00"), Ok(vec![1, 3, 4, 0]));
        assert_eq!(to_hex(&[0x0A, 0xFF]), "0A FF");
        for bad in ["0", "xy", "0 1 2", "ä1"] {
            assert!(hex(bad).is_err(), "{bad}");
        }
    }
}
