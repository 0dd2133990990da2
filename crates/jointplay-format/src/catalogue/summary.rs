//! What a file of the catalogue holds.

use super::entries::Entry;
use crate::mechanism::{self, Expected};
use crate::{cell, robot};

impl Entry {
    /// What it is: the name that it gives itself.
    #[must_use]
    pub fn title(&self) -> String {
        let name = match self.kind().as_deref() {
            Some("gpr") => robot::parse(self.text).ok().map(|robot| robot.name),
            Some(cell::robot::KIND) => cell::robot::parse(self.text).ok().map(|robot| robot.name),
            _ => mechanism::parse(self.text).ok().map(|file| file.mechanism.name().to_owned()),
        };
        name.unwrap_or_default()
    }

    /// What an analysis should find; nothing for a file that is not of the kind `mechanism`.
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
