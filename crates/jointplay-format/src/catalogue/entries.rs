//! The robot and mechanism files that come with the program.

use crate::mechanism;

/// A file of the catalogue.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Entry {
    /// Name of the file, without its extension.
    pub name: &'static str,
    /// The whole file (TOML).
    pub text: &'static str,
}

/// One entry of the table from the name of a file.
macro_rules! entry {
    ($name:literal) => {
        Entry { name: $name, text: include_str!(concat!("../../robots/", $name, ".toml")) }
    };
}

/// All files of the folder `robots`, by name; a test compares the table with the folder.
const ENTRIES: &[Entry] = &[
    entry!("3-crr"),
    entry!("3-prs"),
    entry!("3-rps"),
    entry!("3-upu-snu"),
    entry!("3-upu-tsai"),
    entry!("bennett"),
    entry!("bennett-network"),
    entry!("bricard-orthogonal"),
    entry!("bricard-trihedral"),
    entry!("delta"),
    entry!("double-parallelogram"),
    entry!("dual-arm"),
    entry!("four-bar"),
    entry!("goldberg-5r"),
    entry!("gpr"),
    entry!("gpr-mechanism"),
    entry!("griffis-duffy"),
    entry!("hexapod"),
    entry!("myard"),
    entry!("orthoglide"),
    entry!("parallelogram"),
    entry!("radial-arm"),
    entry!("sarrus"),
    entry!("scara-3r"),
    entry!("scara-4r"),
    entry!("schatz"),
    entry!("scissor-lift"),
    entry!("slider-crank"),
    entry!("spherical-4r"),
    entry!("tripteron"),
    entry!("wunderlich-12-bar"),
];

/// All files that come with the program, by name.
#[must_use]
pub fn entries() -> &'static [Entry] {
    ENTRIES
}

/// The file with this name.
#[must_use]
pub fn find(name: &str) -> Option<&'static Entry> {
    ENTRIES.iter().find(|entry| entry.name == name)
}

impl Entry {
    /// The value of its key `kind`: `mechanism`, `gpr` or `hybrid`.
    #[must_use]
    pub fn kind(&self) -> Option<String> {
        mechanism::kind_of(self.text)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_table_lists_every_file_of_the_folder() {
        let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/robots");
        let mut names: Vec<String> = std::fs::read_dir(folder)
            .unwrap()
            .map(|entry| entry.unwrap().file_name().into_string().unwrap())
            .filter_map(|name| name.strip_suffix(".toml").map(str::to_owned))
            .collect();
        names.sort();
        let known: Vec<&str> = entries().iter().map(|entry| entry.name).collect();
        assert_eq!(known, names, "every file of robots/ has a line in ENTRIES, in order");
    }
}
