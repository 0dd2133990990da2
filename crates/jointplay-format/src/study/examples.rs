//! The study files that come with the program.

/// A study file that comes with the program.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Example {
    /// Its name: that of the file, without its ending.
    pub name: &'static str,
    /// The whole file (TOML).
    pub text: &'static str,
}

macro_rules! entry {
    ($name:literal) => {
        Example { name: $name, text: include_str!(concat!("../../studies/", $name, ".toml")) }
    };
}

/// All files of the folder `studies`, the first one first; a test holds the table to the folder.
const EXAMPLES: &[Example] = &[
    entry!("center-shift"),
    entry!("play-over-the-workspace"),
    entry!("slider-crank"),
    entry!("station-positions"),
    entry!("tolerances"),
];

/// All study files that come with the program, the one to begin with first.
#[must_use]
pub fn examples() -> &'static [Example] {
    EXAMPLES
}

/// The file of a name.
#[must_use]
pub fn example(name: &str) -> Option<&'static Example> {
    EXAMPLES.iter().find(|example| example.name == name)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_table_is_the_folder() {
        let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/studies");
        let mut names: Vec<String> = std::fs::read_dir(folder)
            .unwrap()
            .map(|entry| entry.unwrap().file_name().into_string().unwrap())
            .filter_map(|name| name.strip_suffix(".toml").map(str::to_owned))
            .collect();
        names.sort();
        let known: Vec<&str> = examples().iter().map(|example| example.name).collect();
        assert_eq!(known, names, "every file of studies/ has a line in EXAMPLES, in order");
    }

    #[test]
    fn every_file_can_be_read() {
        for example in examples() {
            if let Err(error) = super::super::parse(example.text, &mut super::super::included) {
                panic!("{}", error.with_excerpt(example.name));
            }
        }
    }
}
