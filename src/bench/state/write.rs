//! From drives to the text of a state file, one section a drive.

use super::{FORMAT, name};
use crate::bus::Bus;
use crate::drive::Drive;
use crate::event::DriveId;
use serde_yaml::Value;
use std::collections::BTreeMap;

/// The state file of a run. A drive that has stored something gets its section anew; the others keep theirs.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct StateFile {
    sections: BTreeMap<String, String>,
}

impl StateFile {
    /// Takes what all drives of `line` keep.
    pub fn keep_all(&mut self, line: &str, bus: &Bus) {
        bus.drives().for_each(|(id, _)| self.keep(line, bus, id));
    }

    /// Takes what one drive of `line` keeps.
    pub fn keep(&mut self, line: &str, bus: &Bus, id: DriveId) {
        let drive = bus.drive(id);
        let station = &drive.model().stations[drive.station()];
        let name = name(line, usize::from(bus.device(id)), station);
        let section = section(&name, drive);
        self.sections.insert(name, section);
    }

    /// The whole file.
    pub fn text(&self) -> String {
        let mut text =
            String::from("# Non-volatile memory of the drives. Do not edit during a run.\n");
        text += &entry(0, "format", &FORMAT.to_string());
        text += &entry(0, "drives", "");
        self.sections.values().for_each(|section| text += section);
        text
    }
}

fn section(name: &str, drive: &Drive) -> String {
    let (model, kept) = (drive.model(), drive.kept());
    let mut text = entry(1, &quoted(name), "");
    text += &entry(2, "model", &quoted(&model.name));
    text += &entry(2, "saves", &kept.saves.to_string());
    text += &entry(2, "rows", if kept.rows.is_empty() { "{}" } else { "" });
    for it in &kept.rows {
        let row = model.map.row(it.row);
        let (value, writes) = (row.kind.value(it.raw).to_string(), it.writes.to_string());
        let about = row.name.split_whitespace().collect::<Vec<_>>().join(" ");
        let value = ["{value: ", &value, ", writes: ", &writes, "}  # ", &about].concat();
        text += &entry(3, &quoted(&row.id), &value);
    }
    text
}

/// A line of the file: nothing behind the key where more lines follow.
fn entry(depth: usize, key: &str, value: &str) -> String {
    let gap = if value.is_empty() { "" } else { " " };
    ["  ".repeat(depth).as_str(), key, ":", gap, value, "\n"].concat()
}

/// A text as YAML reads it back: bare where it can be.
fn quoted(text: &str) -> String {
    let plain = |c: char| c.is_ascii_alphanumeric() || "_-./".contains(c);
    let bare = text.starts_with(|c: char| c.is_ascii_alphabetic()) && text.chars().all(plain);
    // `null` and `true` are words of YAML's own.
    if bare && serde_yaml::from_str(text).is_ok_and(|it: Value| it.is_string()) {
        return text.to_owned();
    }
    let character = |c: char| match c {
        '"' | '\\' => format!("\\{c}"),
        _ if c.is_alphanumeric() || c == ' ' || c.is_ascii_graphic() => c.to_string(),
        _ => format!("\\U{:08X}", u32::from(c)),
    };
    format!("\"{}\"", text.chars().map(character).collect::<String>())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn any_text_is_read_back() {
        for (text, want) in [
            ("acme-s1", "acme-s1"),
            ("line/1", "line/1"),
            ("true", "\"true\""),
            ("1/2", "\"1/2\""),
            ("", "\"\""),
            ("Halle 2: \"links\"\\", "\"Halle 2: \\\"links\\\"\\\\\""),
            ("伺服", "\"伺服\""),
            ("a\nb\u{7f}\u{2028}", "\"a\\U0000000Ab\\U0000007F\\U00002028\""),
        ] {
            assert_eq!(quoted(text), want);
            assert_eq!(serde_yaml::from_str::<Value>(&quoted(text)).unwrap(), text);
        }
    }
}
