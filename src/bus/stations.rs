//! The drives of a line: which there are, who answers to which unit, and who shares power with whom.

use super::RequestCounts;
use crate::drive::Drive;
use crate::event::{DriveId, Here};
use crate::line::Units;
use crate::serial::Mode;
use crate::wire::BROADCAST;

/// The drives of a line. A device with several axes is several of them.
#[derive(Debug)]
pub(super) struct Stations {
    drives: Vec<Drive>,
    /// Device that each drive belongs to: the stations of one device share their power.
    devices: Vec<u16>,
    counts: Vec<RequestCounts>,
    units: Units,
    by_unit: [Option<DriveId>; 256],
}

impl Default for Stations {
    fn default() -> Self {
        Self {
            drives: Vec::new(),
            devices: Vec::new(),
            counts: Vec::new(),
            units: Units::new(),
            by_unit: [None; 256],
        }
    }
}

impl Stations {
    /// Puts `drive` behind the others, as a station of `device`. It is found once they are addressed anew.
    pub fn add(&mut self, drive: Drive, device: u16) -> DriveId {
        let id = DriveId(self.drives.len() as u16);
        self.drives.push(drive);
        self.devices.push(device);
        self.counts.push(RequestCounts::default());
        id
    }

    /// All of them, in the order in which they were added.
    pub fn iter(&self) -> impl ExactSizeIterator<Item = (DriveId, &Drive)> {
        self.drives.iter().enumerate().map(|(i, drive)| (DriveId(i as u16), drive))
    }

    /// Their numbers, in order.
    pub fn ids(&self) -> impl Iterator<Item = DriveId> + use<> {
        (0..self.drives.len() as u16).map(DriveId)
    }

    /// The drive `id`, which is there.
    pub fn drive(&self, id: DriveId) -> &Drive {
        &self.drives[usize::from(id.0)]
    }

    /// The drive `id`, which is there, to be changed.
    pub fn drive_mut(&mut self, id: DriveId) -> &mut Drive {
        &mut self.drives[usize::from(id.0)]
    }

    /// The drive `id`, if it is there.
    pub fn get_mut(&mut self, id: DriveId) -> Option<&mut Drive> {
        self.drives.get_mut(usize::from(id.0))
    }

    /// The device that `id` is a station of.
    pub fn device(&self, id: DriveId) -> u16 {
        self.devices[usize::from(id.0)]
    }

    /// Requests that `id` has executed.
    pub fn counts(&self, id: DriveId) -> RequestCounts {
        self.counts[usize::from(id.0)]
    }

    /// `id` has executed a request with `function`.
    pub fn count(&mut self, id: DriveId, function: u8) {
        self.counts[usize::from(id.0)].count(function);
    }

    /// The units that somebody here answers to.
    pub fn units(&self) -> &Units {
        &self.units
    }

    /// The drive that answers to `unit`.
    pub fn find(&self, unit: u8) -> Option<DriveId> {
        self.by_unit[usize::from(unit)]
    }

    /// The only drive of the line, if there is one alone and it has power.
    pub fn sole(&self) -> Option<DriveId> {
        match self.drives.as_slice() {
            [sole] if sole.is_powered() => Some(DriveId(0)),
            _ => None,
        }
    }

    /// The mode of a serial `line` once it has followed its drives: theirs, if they agree on one.
    pub fn agreed_mode(&self, line: Option<Mode>) -> Option<Mode> {
        let mut modes = self.drives.iter().map(Drive::mode);
        let first = modes.next().flatten();
        let agreed = first.filter(|_| modes.all(|mode| mode == first));
        line.map(|line| agreed.unwrap_or(line))
    }

    /// Why nothing replies to a request to `unit`.
    pub fn here(&self, unit: u8) -> Here {
        match self.iter().find(|(_, drive)| drive.unit() == unit) {
            Some((_, drive)) if !drive.is_powered() => Here::NoPower,
            Some((_, drive)) => Here::SetTo(drive.mode()),
            None => {
                let mut units = Units::new();
                self.iter().for_each(|(_, drive)| units.insert(drive.unit()));
                Here::Units(units)
            }
        }
    }

    /// Does `id` receive what is said on a line in `mode`? Modbus TCP has none.
    pub fn receives(&self, id: DriveId, mode: Option<Mode>) -> bool {
        receives(self.drive(id), mode)
    }

    /// Finds out again who answers to what on a line in `mode`. Of two drives with one address the first answers.
    pub fn readdress(&mut self, mode: Option<Mode>) {
        self.units = Units::new();
        self.by_unit = [None; 256];
        for (i, drive) in self.drives.iter().enumerate().rev() {
            if drive.unit() != BROADCAST && receives(drive, mode) {
                self.units.insert(drive.unit());
                self.by_unit[usize::from(drive.unit())] = Some(DriveId(i as u16));
            }
        }
    }
}

fn receives(drive: &Drive, mode: Option<Mode>) -> bool {
    drive.is_powered() && (mode.is_none() || drive.mode() == mode)
}
