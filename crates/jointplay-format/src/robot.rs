//! Robot files: TOML that an engineer can read, read strictly.

use jointplay_core::gpr::{Gpr, Limb, Limits};
use nalgebra::Vector2;
use serde::Deserialize;
use toml::Spanned;

use crate::explain::explain;
use crate::mechanism;
use crate::number::{counted, number};
use crate::place::{Form, Place};
use crate::units::m_from_mm;

/// The file of the paper's robot.
pub const PAPER: &str = include_str!("../../../robots/gpr.toml");

/// A robot as read.
#[derive(Debug, Clone, PartialEq)]
pub struct Robot {
    /// What the file calls it.
    pub name: String,
    /// The robot.
    pub gpr: Gpr,
    /// What its base looks like, in the base frame.
    pub base_mesh: Option<Mesh>,
    /// What its platform looks like, in the platform frame.
    pub platform_mesh: Option<Mesh>,
}

/// A file of a shape, named in a robot file.
#[derive(Debug, Clone, PartialEq)]
pub struct Mesh {
    /// Its path, relative to the robot file's folder and within it.
    pub path: String,
    /// Which of the formats it is in.
    pub format: MeshFormat,
    /// Where it is named.
    pub place: Place,
}

/// Formats of shapes: STL and OBJ in mm, glTF in m.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum MeshFormat {
    /// `.stl`
    Stl,
    /// `.obj`
    Obj,
    /// `.gltf`, everything within one file
    Gltf,
    /// `.glb`
    Glb,
}

impl MeshFormat {
    /// By the ending of a name.
    fn of(name: &str) -> Option<Self> {
        match name.rsplit_once('.')?.1.to_ascii_lowercase().as_str() {
            "stl" => Some(Self::Stl),
            "obj" => Some(Self::Obj),
            "gltf" => Some(Self::Gltf),
            "glb" => Some(Self::Glb),
            _ => None,
        }
    }
}

impl Mesh {
    /// That the file cannot be had, and why.
    #[must_use]
    pub fn unreadable(&self, why: impl Into<String>) -> Error {
        let problem = Problem::MeshUnreadable { path: self.path.clone(), why: why.into() };
        Error { place: self.place.clone(), problem: Box::new(problem) }
    }
}

/// Why a text is no robot, and where.
pub type Error = crate::place::Error<Problem>;

/// What can be wrong in a robot file.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum Problem {
    /// Not TOML, an unknown or missing key, or a value of the wrong type.
    #[error(transparent)]
    Form(#[from] Form),
    /// A number that is NaN or infinite.
    #[error("`{key}` is {}, but has to be a finite number", number(*.value))]
    NotFinite {
        /// Which key.
        key: &'static str,
        /// What was found.
        value: f64,
    },
    /// A number that no robot has.
    #[error("`{key}` is {}, but has to lie within ±{}", number(*.value), number(*.most))]
    Beyond {
        /// Which key.
        key: &'static str,
        /// What was found.
        value: f64,
        /// Its largest size allowed.
        most: f64,
    },
    /// A kind of robot that is not known.
    #[error("kind {found:?} is not known; known: \"gpr\"")]
    Kind {
        /// What was found.
        found: String,
    },
    /// A pair of numbers with too few or too many.
    #[error("`{key}` has {}, but needs 2", counted(*.found, "number"))]
    PairCount {
        /// Which key.
        key: &'static str,
        /// How many were found.
        found: usize,
    },
    /// A name with characters that would upset a terminal.
    #[error("the name has control characters in it: {found:?}")]
    Name {
        /// What was found.
        found: String,
    },
    /// A shape in a format that is not known.
    #[error("the mesh {path:?} ends neither in .stl, .obj, .gltf nor .glb")]
    MeshFormat {
        /// What was found.
        path: String,
    },
    /// A shape that may lie outside.
    #[error(
        "the mesh {path:?} has to be a path within the robot file's folder, with / between names and without `..`"
    )]
    MeshPath {
        /// What was found.
        path: String,
    },
    /// A shape that cannot be had.
    #[error("the mesh {path:?} cannot be read: {why}")]
    MeshUnreadable {
        /// What was found.
        path: String,
        /// Why.
        why: String,
    },
    /// Not three limbs.
    #[error("a GPR has 3 limbs, but {found} {} given", if *.found == 1 { "is" } else { "are" })]
    LimbCount {
        /// How many were found.
        found: usize,
    },
    /// Numbers that make no robot.
    #[error("{}", explain(.0))]
    Geometry(jointplay_core::Error),
}

/// Lengths of robot files lie within this: a kilometre [mm].
const LARGEST_MM: f64 = 1e6;
/// Angles of robot files lie within this: a hundred turns [deg].
const LARGEST_DEG: f64 = 36_000.0;

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct File {
    kind: Spanned<String>,
    name: Option<Spanned<String>>,
    base_mesh: Option<Spanned<String>>,
    platform_mesh: Option<Spanned<String>>,
    limb: Vec<Spanned<LimbTable>>,
    limits: LimitsTable,
    working: WorkingTable,
}

/// The kind alone, whatever else there is.
#[derive(Deserialize)]
struct Kind {
    kind: Spanned<String>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct LimbTable {
    socket_radius_mm: Spanned<f64>,
    socket_angle_deg: Spanned<f64>,
    base_point_mm: Option<Spanned<Vec<f64>>>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct LimitsTable {
    rod_mm: Spanned<Vec<f64>>,
    tilt_deg: Spanned<f64>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct WorkingTable {
    height_mm: Spanned<f64>,
}

/// The paper's robot, from its file.
#[must_use]
pub fn paper() -> Robot {
    parse(PAPER).expect("the robot file of the paper is valid, a test says so")
}

/// Reads a robot file.
///
/// # Errors
/// [`Error`] with the place: TOML that is malformed, keys that are missing or unknown, numbers that are not finite or make no robot.
pub fn parse(text: &str) -> Result<Robot, Error> {
    let wrong = |span, problem| Error::at(text, span, problem);
    // The kind comes first: a file of another kind is not blamed for its keys.
    if mechanism::kind_of(text).is_some_and(|kind| kind != "gpr") {
        let Kind { kind } = crate::place::read(text)?;
        return Err(wrong(kind.span(), Problem::Kind { found: kind.into_inner() }));
    }
    let file: File = crate::place::read(text)?;
    if file.kind.get_ref() != "gpr" {
        return Err(wrong(file.kind.span(), Problem::Kind { found: file.kind.into_inner() }));
    }
    let number = |key: &'static str, span: std::ops::Range<usize>, value: f64| {
        let most = if key.ends_with("_deg") { LARGEST_DEG } else { LARGEST_MM };
        if !value.is_finite() {
            Err(wrong(span, Problem::NotFinite { key, value }))
        } else if value.abs() > most {
            Err(wrong(span, Problem::Beyond { key, value, most }))
        } else {
            Ok(value)
        }
    };
    let scalar = |key, value: &Spanned<f64>| number(key, value.span(), *value.get_ref());
    let pair = |key, numbers: &Spanned<Vec<f64>>| -> Result<[f64; 2], Error> {
        let (span, numbers) = (numbers.span(), numbers.get_ref());
        let Ok(pair) = <[f64; 2]>::try_from(numbers.as_slice()) else {
            return Err(wrong(span, Problem::PairCount { key, found: numbers.len() }));
        };
        Ok([number(key, span.clone(), pair[0])?, number(key, span, pair[1])?])
    };
    let name = match file.name.as_ref() {
        Some(name) if name.get_ref().chars().any(char::is_control) => {
            return Err(wrong(name.span(), Problem::Name { found: name.get_ref().clone() }));
        }
        name => name.map_or("GPR", |name| name.get_ref()).to_owned(),
    };
    let mesh = |named: &Option<Spanned<String>>| {
        named.as_ref().map(|named| read_mesh(text, named.get_ref(), named.span())).transpose()
    };
    let (base_mesh, platform_mesh) = (mesh(&file.base_mesh)?, mesh(&file.platform_mesh)?);
    let mut limbs = Vec::with_capacity(3);
    for limb in &file.limb {
        let limb = limb.get_ref();
        let socket_radius = m_from_mm(scalar("socket_radius_mm", &limb.socket_radius_mm)?);
        let socket_angle = scalar("socket_angle_deg", &limb.socket_angle_deg)?.to_radians();
        let mut read = Limb::under_socket(socket_radius, socket_angle);
        if let Some(point) = &limb.base_point_mm {
            let [x, y] = pair("base_point_mm", point)?;
            read.base_point = Vector2::new(m_from_mm(x), m_from_mm(y));
        }
        limbs.push(read);
    }
    let limbs: [Limb; 3] = limbs.try_into().map_err(|limbs: Vec<Limb>| {
        let span = file.limb.get(3).or(file.limb.last()).map_or(0..0, Spanned::span);
        wrong(span, Problem::LimbCount { found: limbs.len() })
    })?;
    let [rod_min, rod_max] = pair("rod_mm", &file.limits.rod_mm)?.map(m_from_mm);
    let limits = Limits {
        rod_min,
        rod_max,
        tilt_max: scalar("tilt_deg", &file.limits.tilt_deg)?.to_radians(),
    };
    let working_height = m_from_mm(scalar("height_mm", &file.working.height_mm)?);
    let gpr = Gpr::new(limbs, limits, working_height)
        .map_err(|error| wrong(blame(&file, &error), Problem::Geometry(error)))?;
    Ok(Robot { name, gpr, base_mesh, platform_mesh })
}

fn read_mesh(text: &str, path: &str, span: std::ops::Range<usize>) -> Result<Mesh, Error> {
    let within = stays_within(path);
    let path = path.to_owned();
    if !within {
        return Err(Error::at(text, span, Problem::MeshPath { path }));
    }
    match MeshFormat::of(&path) {
        Some(format) => Ok(Mesh { path, format, place: Place::of(text, span) }),
        None => Err(Error::at(text, span, Problem::MeshFormat { path })),
    }
}

/// Whether a path stays within the folder that it counts from, on every system.
pub(crate) fn stays_within(path: &str) -> bool {
    let strange = |letter: char| letter.is_control() || matches!(letter, '\\' | ':');
    path.split('/').all(|name| !matches!(name, "" | "." | "..")) && !path.contains(strange)
}

/// The part of the file that a geometry error is about.
fn blame(file: &File, error: &jointplay_core::Error) -> std::ops::Range<usize> {
    use jointplay_core::Error as E;
    match error {
        E::NotPositive { limb, .. } => file.limb[limb - 1].get_ref().socket_radius_mm.span(),
        E::LimitsReversed { .. } => file.limits.rod_mm.span(),
        E::OutOfRange { unit: "rad", .. } => file.limits.tilt_deg.span(),
        E::OutOfRange { .. } => file.working.height_mm.span(),
        E::Collinear { what: "base points", .. } => {
            let point = file.limb.iter().find_map(|limb| limb.get_ref().base_point_mm.as_ref());
            point.map_or_else(|| file.limb[0].get_ref().socket_angle_deg.span(), Spanned::span)
        }
        _ => file.limb[0].get_ref().socket_angle_deg.span(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_paper_s_file_is_the_paper_s_robot() {
        assert_eq!(parse(PAPER).unwrap().gpr, Gpr::paper());
    }

    #[test]
    fn a_rod_may_stand_beside_its_socket() {
        let text = PAPER.replacen(
            "socket_angle_deg = 0.0",
            "socket_angle_deg = 0.0\nbase_point_mm = [95, -1.5]",
            1,
        );
        let robot = parse(&text).unwrap();
        assert_eq!(robot.gpr.base_points()[0], Vector2::new(0.095, -0.0015));
    }

    #[test]
    fn meshes_are_named_within_the_folder() {
        let with = |line: &str| parse(&PAPER.replacen("kind = \"gpr\"", line, 1));
        let robot = with("kind = \"gpr\"\nbase_mesh = \"shapes/base.STL\"").unwrap();
        let mesh = robot.base_mesh.unwrap();
        assert_eq!((mesh.path.as_str(), mesh.format), ("shapes/base.STL", MeshFormat::Stl));
        assert_eq!((mesh.place.line, robot.platform_mesh), (7, None));
        for path in
            ["../base.stl", "/etc/base.stl", "a/../b.obj", "", "C:/base.stl", "./b.glb", "a//b.glb"]
        {
            let error = with(&format!("kind = \"gpr\"\nplatform_mesh = \"{path}\"")).unwrap_err();
            assert!(error.to_string().contains("within the robot file's folder"), "{error}");
            assert_eq!(error.place.line, 7);
        }
        for path in ["base.step", "base", "stl"] {
            let error = with(&format!("kind = \"gpr\"\nbase_mesh = \"{path}\"")).unwrap_err();
            assert!(error.to_string().contains("ends neither in .stl"), "{error}");
        }
    }

    /// Replaces a piece of the paper's file and reads the message.
    #[track_caller]
    fn refuse(from: &str, to: &str, line: usize, message: &str) {
        assert!(PAPER.contains(from), "{from:?} is not in the file");
        let error = parse(&PAPER.replacen(from, to, 1)).unwrap_err();
        assert!(error.to_string().contains(message), "{error}");
        assert_eq!(error.place.line, line, "{}", error.with_excerpt("x.toml"));
    }

    #[test]
    fn bad_files_are_refused_with_their_place() {
        let radius = "socket_radius_mm = 93.218";
        refuse(radius, "socket_radius_mm = nan", 13, "`socket_radius_mm` is not a number");
        refuse(radius, "socket_radius_mm = inf", 13, "`socket_radius_mm` is infinite");
        refuse(
            radius,
            "socket_radius_mm = 1e308",
            13,
            "`socket_radius_mm` is 1e308, but has to lie within ±1000000",
        );
        refuse(
            "= 120.0",
            "= 1e308",
            18,
            "`socket_angle_deg` is 1e308, but has to lie within ±36000",
        );
        refuse("[246.0, 754.0]", "[-1e308, 754]", 26, "`rod_mm` is -1e308");
        refuse(radius, "socket_radius_mm = 0", 13, "the socket radius of limb 1 is 0 mm");
        refuse(radius, "socket_radius_mm = -5.5", 13, "is -5.5 mm, but has to be positive");
        refuse(radius, "socket_radius_mm = \"93\"", 13, "expected a number, found the text \"93\"");
        refuse(
            "kind = \"gpr\"",
            "kind = \"frobnicate\"\n[[limb]]",
            6,
            "kind \"frobnicate\" is not",
        );
        refuse(radius, "socket_radious_mm = 93.218", 13, "did you mean `socket_radius_mm`?");
        refuse(
            radius,
            "colour = 3",
            13,
            "known here: socket_radius_mm, socket_angle_deg, base_point_mm",
        );
        refuse(radius, "", 12, "missing key `socket_radius_mm`");
        refuse(radius, "socket_radius_mm = = 3", 13, "");
        refuse("= 120.0", "= 0.0", 14, "lie on one line");
        refuse("= 120.0", "= 240.0", 14, "lie on one line");
        refuse("[246.0, 754.0]", "[754.0, 246.0]", 26, "reversed: least 754 mm, most 246 mm");
        refuse("[246.0, 754.0]", "[246.0]", 26, "has 1 number,");
        refuse(
            "[246.0, 754.0]",
            "[246.0, 500.0, 754.0]",
            26,
            "`rod_mm` has 3 numbers, but needs 2",
        );
        refuse("GPR of the paper\"", "a\\u001b[31m\"", 7, "control characters");
        refuse("[246.0, 754.0]", "[246.0, inf]", 26, "`rod_mm` is infinite");
        refuse("tilt_deg = 1.5", "tilt_deg = 90", 28, "the largest tilt is 90°");
        refuse("tilt_deg = 1.5", "tilt_deg = -1.5", 28, "the largest tilt is -1.5°");
        refuse("height_mm = 500.0", "height_mm = 800", 32, "has to lie from 246 to 754 mm");
        refuse("kind = \"gpr\"", "kind = \"delta\"", 6, "kind \"delta\" is not known");
        refuse("[[limb]]", "[[limbs]]", 12, "did you mean `limb`?");
        refuse(
            "[limits]",
            "[[limb]]\nsocket_radius_mm = 1\nsocket_angle_deg = 7\n[limits]",
            24,
            "3 limbs, but 4",
        );
    }

    #[test]
    fn sockets_numbered_against_the_base_points_are_refused() {
        let points = ["[93.0, 0.0]", "[-46.0, -80.0]", "[-46.0, 80.0]"];
        let mut text = PAPER.to_owned();
        for (angle, point) in ["0.0", "120.0", "240.0"].iter().zip(points) {
            let key = format!("socket_angle_deg = {angle}\n");
            text = text.replacen(&key, &format!("{key}base_point_mm = {point}\n"), 1);
        }
        assert!(parse(&text).unwrap_err().to_string().contains("opposite senses"));
    }

    #[test]
    fn an_error_shows_the_line() {
        let error = parse(&PAPER.replacen("tilt_deg = 1.5", "tilt_deg = nan", 1)).unwrap_err();
        let shown = error.with_excerpt("my.toml");
        assert_eq!(
            shown,
            "my.toml:28:12: `tilt_deg` is not a number, but has to be a finite number\n   |\n28 | tilt_deg = nan\n   |            ^^^"
        );
    }

    #[test]
    fn nothing_panics() {
        for cut in 0..PAPER.len() {
            if PAPER.is_char_boundary(cut) {
                let _ = parse(&PAPER[..cut]);
                let _ = parse(&PAPER[cut..]);
                if let Err(error) = parse(&PAPER[..cut]) {
                    let _ = error.with_excerpt("x");
                }
            }
        }
        for text in ["", "\u{0}", "é = [", "kind = \"gpr\"", "limb = 3", "[limb]"] {
            let _ = parse(text).unwrap_err().with_excerpt("x");
        }
    }
}
