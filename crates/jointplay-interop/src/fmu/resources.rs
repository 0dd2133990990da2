//! Files of a unit that describe its model.

use jointplay_format::mechanism::kind_of;
use serde::{Deserialize, Serialize};

use super::error::Error;

/// File of the mechanism or robot, in the folder of resources.
const MODEL: &str = "model.toml";
/// File of the choices of the user, in the folder of resources.
const SETTINGS: &str = "settings.toml";

/// Names of the files of [`Resources`], in the folder of resources.
pub const RESOURCE_FILES: [&str; 2] = [MODEL, SETTINGS];

/// The model of a unit: the text of a mechanism or robot file, and the choices of the user.
#[derive(Debug, Clone, PartialEq)]
pub struct Resources {
    /// Text of the mechanism or robot file.
    pub model: String,
    /// Values of parameters in place of those of the file, in the units of the file.
    pub parameters: Vec<(String, f64)>,
    /// Commanded coordinates of the initial configuration, by name (m, rad); of a robot, lengths of rods.
    pub start: Vec<(String, f64)>,
    /// Virtualization of a robot; `None` for a mechanism, and for the planar one.
    pub virtualization: Option<String>,
}

/// The second file.
#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct Settings {
    #[serde(default, skip_serializing_if = "Option::is_none")]
    virtualization: Option<String>,
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    parameter: Vec<NamedValue>,
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    start: Vec<NamedValue>,
}

#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct NamedValue {
    name: String,
    value: f64,
}

impl Resources {
    /// The model of a file without choices.
    #[must_use]
    pub fn for_model(model: impl Into<String>) -> Self {
        let (parameters, start) = (Vec::new(), Vec::new());
        Self { model: model.into(), parameters, start, virtualization: None }
    }

    /// Whether the file is one of a three-rod robot.
    #[must_use]
    pub fn is_robot(&self) -> bool {
        kind_of(&self.model).as_deref() == Some("gpr")
    }

    /// Names and texts of the files, in the order of [`RESOURCE_FILES`].
    #[must_use]
    pub fn files(&self) -> [(&'static str, String); 2] {
        let named = |values: &[(String, f64)]| {
            let one =
                |(name, value): &(String, f64)| NamedValue { name: name.clone(), value: *value };
            values.iter().map(one).collect()
        };
        let settings = Settings {
            virtualization: self.virtualization.clone(),
            parameter: named(&self.parameters),
            start: named(&self.start),
        };
        let settings = toml::to_string(&settings).expect("texts and numbers are TOML");
        [(MODEL, self.model.clone()), (SETTINGS, settings)]
    }

    /// The model of the texts of its files.
    ///
    /// # Arguments
    /// * `texts` – in the order of [`RESOURCE_FILES`]
    ///
    /// # Errors
    /// [`Error::Resource`].
    pub fn parse([model, settings]: [&str; 2]) -> Result<Self, Error> {
        let read: Settings = toml::from_str(settings).map_err(|error| Error::Resource {
            file: SETTINGS.to_owned(),
            message: error.to_string(),
        })?;
        let named = |values: Vec<NamedValue>| {
            values.into_iter().map(|NamedValue { name, value }| (name, value)).collect()
        };
        Ok(Self {
            model: model.to_owned(),
            parameters: named(read.parameter),
            start: named(read.start),
            virtualization: read.virtualization,
        })
    }

    /// Token by which a library recognises the files of its description: two checksums of the files and of the version.
    #[must_use]
    pub fn token(&self) -> String {
        let mut all = format!("jointplay {}\0", env!("CARGO_PKG_VERSION"));
        for (name, text) in self.files() {
            all += &format!("{name}\0{}\0{text}\0", text.len());
        }
        let first = crc::Crc::<u64>::new(&crc::CRC_64_XZ).checksum(all.as_bytes());
        let second = crc::Crc::<u64>::new(&crc::CRC_64_REDIS).checksum(all.as_bytes());
        let all = format!("{first:016x}{second:016x}");
        let parts = [&all[..8], &all[8..12], &all[12..16], &all[16..20], &all[20..]];
        format!("{{{}}}", parts.join("-"))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn files_read_again_are_the_same_to_the_bit() {
        let values = [0.1 + 0.2, 1.0 / 3.0, -5e-324, 1e300, 0.017_453_292_519_943_295];
        let named: Vec<(String, f64)> =
            values.iter().enumerate().map(|(k, &value)| (format!("\"{k}\" = ä"), value)).collect();
        let resources = Resources {
            parameters: named.clone(),
            start: named,
            virtualization: Some("polar".to_owned()),
            ..Resources::for_model("kind = \"gpr\"")
        };
        let files = resources.files();
        let read = Resources::parse([&files[0].1, &files[1].1]).unwrap();
        assert_eq!(read, resources);
        assert!(read.is_robot());
        let token = resources.token();
        assert_eq!((token.len(), token == read.token()), (38, true));
        let other = Resources { virtualization: None, ..resources };
        assert_ne!(other.token(), token);
        assert!(Resources::parse(["", "unknown = 1"]).is_err());
    }
}
