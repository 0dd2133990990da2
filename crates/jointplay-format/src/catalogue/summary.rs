//! Title and expected results of a catalogue file.

use super::entries::Entry;
use crate::mechanism::{self, Expected};
use crate::{cell, robot};

impl Entry {
    /// The value of the file's key `name`.
    #[must_use]
    pub fn title(&self) -> String {
        let name = match self.kind().as_deref() {
            Some("gpr") => robot::parse(self.text).ok().map(|robot| robot.name),
            Some(cell::robot::KIND) => cell::robot::parse(self.text).ok().map(|robot| robot.name),
            _ => mechanism::parse(self.text).ok().map(|file| file.mechanism.name().to_owned()),
        };
        name.unwrap_or_default()
    }

    /// Expected results of an analysis; empty for a file that is not of kind `mechanism`.
    #[must_use]
    pub fn expected(&self) -> Expected {
        mechanism::parse(self.text).map(|file| file.expected).unwrap_or_default()
    }
}

#[cfg(test)]
mod tests {
    use super::super::entries::entries;
    use crate::cell;

    #[test]
    fn every_file_can_be_read() {
        for entry in entries() {
            assert_ne!(entry.title(), "", "{}", entry.name);
        }
        let hybrid: Vec<&str> = cell::robot::names().collect();
        assert_eq!(hybrid, ["dual-arm", "radial-arm", "scara-3r", "scara-4r"]);
    }
}
