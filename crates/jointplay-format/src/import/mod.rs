//! Mechanisms from model files of other programs: MJCF, SDF and URDF, told apart by their root element.
//!
//! What has no place in a mechanism, such as shapes and masses, is listed as ignored.
//! What would change the mechanism if it were passed over is an error with its place.
//!
//! ```
//! let model = jointplay_format::import::parse(r#"
//!     <robot name="door">
//!       <link name="wall"/>
//!       <link name="door"><visual/></link>
//!       <joint name="hinge" type="continuous">
//!         <parent link="wall"/>
//!         <child link="door"/>
//!         <axis xyz="0 0 1"/>
//!       </joint>
//!     </robot>"#)?;
//! assert_eq!(model.mechanism.links(), ["wall", "door"]);
//! assert_eq!(model.ignored, ["1 × visual"]);
//! # Ok::<(), jointplay_format::import::Error>(())
//! ```

mod draft;
mod mjcf;
mod problem;
mod sdf;
mod urdf;
mod xml;

use jointplay_core::mechanism::Mechanism;

pub use problem::{Error, Problem};

use crate::mechanism::{AngleUnit, Expected, LengthUnit, MAX_BYTES, MechanismFile, Units};
use draft::Draft;
use xml::{Advice, Xml};

/// A model as taken over.
#[derive(Debug, Clone, PartialEq)]
pub struct Imported {
    /// The mechanism [m, rad].
    pub mechanism: Mechanism,
    /// Which kind of file it was.
    pub dialect: Dialect,
    /// What has no place in a mechanism, with how often it was there.
    pub ignored: Vec<String>,
}

/// Kinds of model files.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Dialect {
    /// Models of MuJoCo.
    Mjcf,
    /// The Simulation Description Format of Gazebo.
    Sdf,
    /// The Unified Robot Description Format of ROS.
    Urdf,
}

impl Dialect {
    /// Its name, as people write it.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Mjcf => "MJCF",
            Self::Sdf => "SDF",
            Self::Urdf => "URDF",
        }
    }
}

impl Imported {
    /// The same as a mechanism file, in m and rad.
    #[must_use]
    pub fn into_file(self) -> MechanismFile {
        MechanismFile {
            mechanism: self.mechanism,
            source: None,
            units: Units { length: LengthUnit::Meter, angle: AngleUnit::Radian },
            parameters: Vec::new(),
            expected: Expected::default(),
        }
    }
}

/// Whether a text is XML, as every model file is, and no mechanism file.
#[must_use]
pub fn is_model(text: &str) -> bool {
    text.trim_start_matches('\u{feff}').trim_start().starts_with('<')
}

/// Takes over a model; which kind it is, its root element tells.
///
/// # Errors
/// [`Error`] with the place: text that is no XML, unusable values, or what would change the mechanism if it were ignored.
pub fn parse(text: &str) -> Result<Imported, Error> {
    if text.len() > MAX_BYTES {
        let problem = Problem::TooLong { found: text.len(), allowed: MAX_BYTES };
        return Err(Error::at(text, 0..0, problem));
    }
    let document = xml::document(text)?;
    let root = document.root_element();
    let draft = Draft::new(Xml { text }, root);
    match root.tag_name().name() {
        "mujoco" => mjcf::read(draft, root),
        "sdf" => sdf::read(draft, root),
        "robot" => urdf::read(draft, root),
        other => Err(draft.xml.unsupported(
            root,
            format!("a file of <{other}>"),
            Advice("models are <mujoco> (MJCF), <sdf> (SDF) and <robot> (URDF)"),
        )),
    }
}

#[cfg(test)]
mod tests;
