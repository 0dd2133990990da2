//! Mechanisms from model files of other programs: MJCF, SDF and URDF, told apart by their root element.
//!
//! What has no place in a mechanism, such as shapes and masses, is listed as ignored.
//! What would change the mechanism if it were passed over is an error with its place.
//!
//! ```
//! let model = jointplay_interop::import::parse(r#"
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
//! # Ok::<(), jointplay_interop::import::Error>(())
//! ```

mod draft;
mod mjcf;
mod problem;
mod sdf;
mod urdf;
mod xml;

use jointplay_core::mechanism::Mechanism;

pub use problem::{Error, Problem};

use draft::Draft;
use jointplay_format::mechanism::{
    AngleUnit, Expected, LengthUnit, MAX_BYTES, MechanismFile, Units,
};
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
///
/// # Source
/// [MJCF], [SDFormat], [URDF]
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
mod testing {
    use super::{Imported, parse};

    #[track_caller]
    pub(super) fn read(text: &str) -> Imported {
        parse(text).map_err(|error| error.with_excerpt("model")).unwrap_or_else(|m| panic!("{m}"))
    }

    /// Replaces a piece of a model, and reads the message and what stands above the carets.
    #[track_caller]
    pub(super) fn refuse(model: &str, from: &str, to: &str, blamed: &str, message: &str) {
        assert!(model.contains(from), "{from:?} is not in the model");
        let error = parse(&model.replacen(from, to, 1)).unwrap_err();
        let shown = error.with_excerpt("model");
        assert!(error.to_string().contains(message), "{shown}");
        let place = &error.place;
        let found: String = place.text.chars().skip(place.column - 1).take(place.width).collect();
        assert_eq!(found, blamed, "{shown}");
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    const MODELS: [&str; 4] = [
        include_str!("../../../../validation/golden/models/frames.sdf"),
        include_str!("../../../../validation/golden/models/defaults.mjcf.xml"),
        include_str!("../../../../validation/golden/models/orientations.mjcf.xml"),
        include_str!("../../../../validation/golden/models/tree.urdf"),
    ];

    #[test]
    fn the_root_element_tells_the_dialect() {
        let dialects = MODELS.map(|model| testing::read(model).dialect);
        assert_eq!(dialects.map(Dialect::name), ["SDF", "MJCF", "MJCF", "URDF"]);
        testing::refuse("<robots/>", "<robots/>", "<svg/>", "<svg/>", "<robot> (URDF)");
        testing::refuse("<sdf><a></sdf>", "", "", "", "not well-formed XML: expected 'a' tag");
        assert!(is_model("\u{feff}\n <robot/>") && !is_model("kind = \"mechanism\""));
    }

    #[test]
    fn deep_trees_do_not_overflow_the_stack() {
        let deep = |open: &str, close: &str, count: usize| {
            format!("{}{}", open.repeat(count), close.repeat(count))
        };
        let mjcf = |inner: String| format!("<mujoco><worldbody>{inner}</worldbody></mujoco>");
        let tree = parse(&mjcf(deep("<body>", "</body>", 900))).unwrap();
        assert_eq!(tree.mechanism.joints().len(), 900);
        let refuse = |text: String, message: &str| {
            let error = parse(&text).unwrap_err();
            assert!(error.to_string().contains(message), "{error}");
        };
        for (open, close) in [("<body>", "</body>"), ("<frame>", "</frame>")] {
            refuse(mjcf(deep(open, close, 100_000)), "more than 1000 deep");
        }
        let models = |count| deep("<model name=\"m\">", "</model>", count);
        let sdf = |inner: String| format!("<sdf version=\"1.9\">{inner}</sdf>");
        refuse(sdf(models(100_000)), "more than 1000 deep");
        refuse(sdf(models(900)), "at most 1000 bytes long, together");
    }

    #[test]
    fn places_are_right_beside_entities_and_other_line_ends() {
        let sdf = "<sdf version=\"1.9\"><model name=\"m\">\r\n<link name=\"l\"><pose>&#32;\u{2003}\u{2003}1 &lt; 3\r\n</pose></link></model></sdf>";
        testing::refuse(sdf, "", "", "&#32;\u{2003}\u{2003}1 &lt; 3", "`pose` is \"1 < 3\"");
    }

    #[test]
    fn endless_names_are_refused() {
        let name = "n".repeat(1001);
        let text = format!("<robot name=\"{name}\"><link name=\"a\"/></robot>");
        assert!(parse(&text).unwrap_err().to_string().contains("at most 1000 bytes"));
    }

    #[test]
    fn endless_models_are_refused() {
        let text = format!("<robot name=\"r\">{}</robot>", " ".repeat(MAX_BYTES));
        assert!(parse(&text).unwrap_err().to_string().contains("at most 4000000 are allowed"));
    }

    #[test]
    fn no_cut_text_panics() {
        for model in MODELS {
            for cut in (0..model.len()).filter(|cut| model.is_char_boundary(*cut)) {
                for text in [&model[..cut], &model[cut..]] {
                    if let Err(error) = parse(text) {
                        let _ = error.with_excerpt("x");
                    }
                }
            }
        }
    }

    proptest! {
        #[test]
        fn no_mutated_text_panics(
            model in 0..MODELS.len(),
            cuts in prop::collection::vec(
                (0.0..1.0, 0..30_usize, "[-<>/\"=.0-9a-z\n ]{0,4}|nan|1e999|world|::"), 1..4
            ),
        ) {
            let mut text = MODELS[model].to_owned();
            for (part, length, replacement) in cuts {
                let start = (part * text.len() as f64) as usize;
                let end = (start + length).min(text.len());
                if text.is_char_boundary(start) && text.is_char_boundary(end) {
                    text.replace_range(start..end, &replacement);
                }
            }
            match parse(&text) {
                Ok(model) => {
                    let written = jointplay_format::mechanism::write(&model.mechanism, None);
                    let read = jointplay_format::mechanism::parse(&written);
                    prop_assert!(read.is_ok(), "{}", read.unwrap_err().with_excerpt("written"));
                }
                Err(error) => {
                    let _ = error.with_excerpt("x");
                }
            }
        }
    }
}
