//! Robot files: readable TOML with a strict schema, with parameters and expressions like mechanism files.

mod edit;

use crate::display_units::DisplayUnits;
use jointplay_core::gpr::{Gpr, Limb, Limits};
use nalgebra::Vector2;
use toml::de::DeValue;

use crate::explain::explain;
use crate::expression::AngleUnit;
use crate::file_problem::FileProblem;
use crate::place::Place;
use crate::toml_reader::parameters::{self, Parameters};
use crate::toml_reader::{self, AllowedRange, Entry};
use crate::units::{deg, m_from_mm, m_from_um, mm, um};

pub use edit::{Dimension, Dimensions, dimensions, with_dimensions};

/// The file of the paper's robot.
pub const PAPER: &str = include_str!("../robots/gpr.toml");

/// The content of a robot file.
#[derive(Debug, Clone, PartialEq)]
pub struct Robot {
    /// Value of the file's key `name`.
    pub name: String,
    /// The robot.
    pub gpr: Gpr,
    /// Shape of the base for display, in the base frame.
    pub base_mesh: Option<Mesh>,
    /// Shape of the platform for display, in the platform frame.
    pub platform_mesh: Option<Mesh>,
}

/// A file of a shape, named in a robot file.
#[derive(Debug, Clone, PartialEq)]
pub struct Mesh {
    /// Path relative to the robot file's folder, and within it.
    pub path: String,
    /// File format of the shape.
    pub format: MeshFormat,
    /// Place in the robot file.
    pub place: Place,
}

/// Formats of shapes: STL and OBJ in mm, glTF in m.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum MeshFormat {
    /// `.stl`
    Stl,
    /// `.obj`
    Obj,
    /// `.gltf`, with all data embedded
    Gltf,
    /// `.glb`
    Glb,
}

impl MeshFormat {
    /// The format that belongs to the extension of a file name.
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
    /// The error that the file of a mesh cannot be read.
    #[must_use]
    pub fn unreadable(&self, why: impl Into<String>) -> Error {
        let problem = Problem::MeshUnreadable { path: self.path.clone(), why: why.into() };
        Error { place: self.place.clone(), problem: Box::new(problem) }
    }
}

/// An error of a robot file with its place.
pub type Error = crate::place::Error<Problem>;

/// All errors of a robot file.
pub type Errors = crate::place::Errors<Problem>;

/// Errors of robot files.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum Problem {
    /// An error that any TOML file can have.
    #[error(transparent)]
    Common(#[from] FileProblem),
    /// An unknown kind of robot.
    #[error("kind {found:?} is not known; known: gpr")]
    Kind {
        /// The kind found.
        found: String,
    },
    /// A name with control characters.
    #[error("the name contains control characters: {found:?}")]
    Name {
        /// The name found.
        found: String,
    },
    /// A shape in an unknown format.
    #[error("the mesh {path:?} ends neither in .stl, .obj, .gltf nor .glb")]
    MeshFormat {
        /// The path found.
        path: String,
    },
    /// The path of a shape that may lead out of the folder.
    #[error(
        "the mesh {path:?} has to be a path within the robot file's folder, with / between names and without `..`"
    )]
    MeshPath {
        /// The path found.
        path: String,
    },
    /// A shape that cannot be read.
    #[error("the mesh {path:?} cannot be read: {why}")]
    MeshUnreadable {
        /// The path found.
        path: String,
        /// Reason.
        why: String,
    },
    /// A number of limbs other than three.
    #[error("a GPR has 3 limbs, but {found} {} given", if *.found == 1 { "is" } else { "are" })]
    LimbCount {
        /// Number of limbs found.
        found: usize,
    },
    /// An expression in place of a number that is to change.
    #[error("`{key}` is the expression {expression:?}: change its parameters, or the text")]
    Expression {
        /// Key of the number.
        key: String,
        /// The expression.
        expression: String,
    },
    /// Values that define no robot.
    #[error("{}", explain(.0, DisplayUnits::Metric))]
    Geometry(jointplay_core::Error),
}

/// Largest absolute length in robot files, 1 km (mm).
const LARGEST_MM: f64 = 1e6;
/// Distance of a rod from its place under the nominal socket that is round-off (m).
const ROUND_OFF: f64 = 1e-15;
/// Largest clearance of a ball in robot files, 1 m (µm).
const LARGEST_CLEARANCE_UM: f64 = 1e6;
/// Largest absolute angle in robot files, a hundred revolutions (deg).
const LARGEST_DEG: f64 = 36_000.0;

/// The paper's robot, from its file.
#[must_use]
pub fn paper() -> Robot {
    parse(PAPER).expect("the included robot file is valid, as a test checks")
}

/// Reads a robot file.
///
/// # Errors
/// All errors in the order of their places, at least one: invalid TOML, missing or unknown keys, values of another type, numbers that are out of range or define no robot.
pub fn parse(text: &str) -> Result<Robot, Errors> {
    parse_with(text, &[])
}

/// Reads a robot file with other values of some of its parameters.
///
/// # Arguments
/// * `replaced` – parameters with their values, in the units of the file
///
/// # Errors
/// See [`parse`]; also for a parameter that the file does not have.
pub fn parse_with(text: &str, replaced: &[(String, f64)]) -> Result<Robot, Errors> {
    let reader = Reader::new(text);
    let document = reader.parse();
    let top = Table::new(&reader, "a robot", document.get_ref(), 0..0);
    let kind = top.needed("kind");
    let found = kind.and_then(|kind| kind.text(&reader));
    // A file of another kind has other keys.
    if let (Some(kind), Some(found)) = (kind, found.filter(|&found| found != "gpr")) {
        kind.report(&reader, Problem::Kind { found: found.to_owned() });
        return reader.done(None);
    }
    let Parameters { scope, .. } = parameters::resolve(&top, replaced, AngleUnit::Degree);
    reader.set_scope(0, scope);
    let robot = read(&top, found.is_some());
    top.finish();
    reader.done(robot)
}

/// Writes a robot file in mm and degrees; read again, it is the same robot to round-off.
///
/// A rod within 10⁻¹⁵ m of its place under the nominal socket is under it.
#[must_use]
pub fn write(robot: &Robot) -> String {
    let gpr = &robot.gpr;
    let name = toml::Value::from(robot.name.as_str());
    let mut file = format!("kind = \"gpr\"\nname = {name}\n");
    let mut line = |text: std::fmt::Arguments| {
        file.push_str(&text.to_string());
        file.push('\n');
    };
    for (key, mesh) in [("base_mesh", &robot.base_mesh), ("platform_mesh", &robot.platform_mesh)] {
        if let Some(mesh) = mesh {
            line(format_args!("{key} = {}", toml::Value::from(mesh.path.as_str())));
        }
    }
    for limb in gpr.limbs() {
        line(format_args!("\n[[limb]]"));
        line(format_args!("socket_radius_mm = {:?}", short(mm(limb.socket_radius))));
        line(format_args!("socket_angle_deg = {:?}", short(deg(limb.socket_angle))));
        let below = Limb::under_socket(limb.socket_radius, limb.socket_angle).base_point;
        if (limb.base_point - below).norm() > ROUND_OFF {
            let [x, y] = [limb.base_point.x, limb.base_point.y].map(|meters| short(mm(meters)));
            line(format_args!("base_point_mm = [{x:?}, {y:?}]"));
        }
    }
    let limits = gpr.limits();
    line(format_args!("\n[limits]"));
    line(format_args!(
        "rod_mm = [{:?}, {:?}]",
        short(mm(limits.rod_min)),
        short(mm(limits.rod_max))
    ));
    line(format_args!("tilt_deg = {:?}", short(deg(limits.tilt_max))));
    line(format_args!("\n[working]"));
    line(format_args!("height_mm = {:?}", short(mm(gpr.working_height()))));
    if let Some(radius) = gpr.ball_clearance() {
        line(format_args!("\n[ball]"));
        line(format_args!("clearance_radius_um = {:?}", short(um(radius))));
    }
    file
}

/// A number of ten decimals that differs only by round-off, if there is one.
fn short(value: f64) -> f64 {
    let rounded = (value * 1e10).round() / 1e10;
    if (rounded - value).abs() <= 4.0 * f64::EPSILON * value.abs() { rounded } else { value }
}

type Reader<'a> = toml_reader::Reader<'a, Problem>;
type Table<'r, 'a> = toml_reader::Table<'r, 'a, Problem>;

const LENGTH: AllowedRange = AllowedRange::Within(-LARGEST_MM, LARGEST_MM);
const ANGLE: AllowedRange = AllowedRange::Within(-LARGEST_DEG, LARGEST_DEG);

fn read(top: &Table, has_kind: bool) -> Option<Robot> {
    let reader = top.reader;
    let name = top.entry("name").map_or(Some("GPR".to_owned()), |entry| {
        let name = entry.text(reader)?;
        if name.chars().any(char::is_control) {
            entry.report(reader, Problem::Name { found: name.to_owned() });
            return None;
        }
        Some(name.to_owned())
    });
    let base_mesh = mesh(top, "base_mesh");
    let platform_mesh = mesh(top, "platform_mesh");
    let tables = top.tables("limb");
    let limbs: Vec<Option<Limb>> = tables.iter().map(limb).collect();
    let limits_table = table(top, "limits", "`[limits]`");
    let limits = limits_table.as_ref().and_then(limits);
    let working = table(top, "working", "`[working]`");
    let height = working.as_ref().and_then(|table| {
        let height = table.length("height_mm", LENGTH);
        table.finish();
        height
    });
    // A value of another type has its own error.
    let is_list = |entry: Entry| matches!(entry.value.get_ref(), DeValue::Array(_));
    if top.needed("limb").is_some_and(is_list) && tables.len() != 3 {
        let span = tables.get(3).or(tables.last()).map_or(0..0, |table| table.span.clone());
        reader.report(span, Problem::LimbCount { found: tables.len() });
    }
    let ball_clearance = ball_clearance(top);
    let limbs: [Limb; 3] = limbs.into_iter().collect::<Option<Vec<_>>>()?.try_into().ok()?;
    let ball_clearance = ball_clearance?;
    let (limits, height) = (limits?, height?);
    let (name, base_mesh, platform_mesh) = (name?, base_mesh?, platform_mesh?);
    if !has_kind {
        return None;
    }
    let robot = Gpr::new(limbs, limits, height).and_then(|gpr| match ball_clearance {
        Some(radius) => gpr.with_ball_clearance(radius),
        None => Ok(gpr),
    });
    match robot {
        Ok(gpr) => Some(Robot { name, gpr, base_mesh, platform_mesh }),
        Err(error) => {
            let parts = (tables.as_slice(), limits_table.as_ref()?, working.as_ref()?);
            let entry = blame(parts, &error);
            let span = entry.map_or(0..0, |entry| entry.span());
            reader.report(span, Problem::Geometry(error));
            None
        }
    }
}

/// A table that must be present.
fn table<'r, 'a>(top: &Table<'r, 'a>, key: &'static str, whose: &str) -> Option<Table<'r, 'a>> {
    top.needed(key)?.table(top.reader, whose)
}

fn limb(table: &Table) -> Option<Limb> {
    let socket_radius = table.length("socket_radius_mm", LENGTH);
    let socket_angle = table.number("socket_angle_deg", ANGLE).map(f64::to_radians);
    let base_point = table
        .entry("base_point_mm")
        .map(|entry| entry.numbers::<2, _>(table.reader, LENGTH).map(|pair| pair.map(m_from_mm)));
    table.finish();
    let mut limb = Limb::under_socket(socket_radius?, socket_angle?);
    if let Some(point) = base_point {
        let [x, y] = point?;
        limb.base_point = Vector2::new(x, y);
    }
    Some(limb)
}

fn limits(table: &Table) -> Option<Limits> {
    let rod = table
        .needed("rod_mm")
        .and_then(|entry| entry.numbers::<2, _>(table.reader, LENGTH))
        .map(|pair| pair.map(m_from_mm));
    let tilt_max = table.number("tilt_deg", ANGLE).map(f64::to_radians);
    table.finish();
    let [rod_min, rod_max] = rod?;
    Some(Limits { rod_min, rod_max, tilt_max: tilt_max? })
}

/// Clearance of the balls, as a radius (m), which may be absent; `None` for an invalid one.
fn ball_clearance(top: &Table) -> Option<Option<f64>> {
    let Some(entry) = top.entry("ball") else { return Some(None) };
    let table = entry.table(top.reader, "`[ball]`")?;
    let radius =
        table.number("clearance_radius_um", AllowedRange::Within(0.0, LARGEST_CLEARANCE_UM));
    table.finish();
    Some(Some(m_from_um(radius?)))
}

/// A mesh that may be absent; `None` for an invalid one.
fn mesh(top: &Table, key: &'static str) -> Option<Option<Mesh>> {
    let Some(entry) = top.entry(key) else { return Some(None) };
    let path = entry.text(top.reader)?.to_owned();
    if !stays_within(&path) {
        entry.report(top.reader, Problem::MeshPath { path });
        return None;
    }
    match MeshFormat::of(&path) {
        Some(format) => Some(Some(Mesh { path, format, place: top.reader.place(entry.span()) })),
        None => {
            entry.report(top.reader, Problem::MeshFormat { path });
            None
        }
    }
}

/// Whether a path stays within its folder, on every operating system.
pub(crate) fn stays_within(path: &str) -> bool {
    let strange = |letter: char| letter.is_control() || matches!(letter, '\\' | ':');
    path.split('/').all(|name| !matches!(name, "" | "." | "..")) && !path.contains(strange)
}

/// The part of the file that a geometry error refers to.
fn blame<'r, 'a>(
    (limbs, limits, working): (&[Table<'r, 'a>], &Table<'r, 'a>, &Table<'r, 'a>),
    error: &jointplay_core::Error,
) -> Option<Entry<'r, 'a>> {
    use jointplay_core::Error as E;
    let angle = || limbs.first()?.entry("socket_angle_deg");
    match error {
        E::NotPositive { limb, .. } => limbs.get(limb - 1)?.entry("socket_radius_mm"),
        E::LimitsReversed { .. } => limits.entry("rod_mm"),
        E::OutOfRange { unit: "rad", .. } => limits.entry("tilt_deg"),
        E::OutOfRange { .. } => working.entry("height_mm"),
        E::Collinear { what: "base points", .. } => {
            limbs.iter().find_map(|limb| limb.entry("base_point_mm")).or_else(angle)
        }
        _ => angle(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_included_file_is_the_paper_s_robot() {
        assert_eq!(parse(PAPER).unwrap().gpr, Gpr::paper());
    }

    #[test]
    fn a_written_file_is_the_same_robot() {
        let text = PAPER.replacen(
            "socket_angle_deg = 0.0",
            "socket_angle_deg = 0.1\nbase_point_mm = [95, -1.5]",
            1,
        ) + "[ball]\nclearance_radius_um = 12.5\n";
        for text in [PAPER, &text] {
            let robot = parse(text).unwrap();
            let written = write(&robot);
            assert_eq!(parse(&written).unwrap(), robot, "{written}");
        }
    }

    #[test]
    fn round_off_of_computed_dimensions_is_not_written() {
        for (value, expected) in [
            (119.999_999_999_999_99, 120.0),
            (-109.999_999_999_999_99, -110.0),
            (80.729_156_089_977_8, 80.729_156_089_977_8),
            (0.0, 0.0),
            (1e12 / 3.0, 1e12 / 3.0),
        ] {
            assert_eq!(short(value), expected);
        }
    }

    #[test]
    fn numbers_may_be_expressions_of_parameters() {
        let text = PAPER
            .replace("socket_radius_mm = 93.218", "socket_radius_mm = \"r\"")
            .replacen("= 240.0", "= \"360 - a\"", 1)
            .replacen("[246.0, 754.0]", "[\"height - 254\", \"height + 254\"]", 1)
            .replacen("height_mm = 500.0", "height_mm = \"height\"", 1)
            + "[parameters]\nr = 93.218\na = 120\nheight = 500\n";
        let same = |robot: &Robot, other: &Gpr| {
            let rods = |gpr: &Gpr| {
                let tilt = jointplay_core::spatial::Tilt { azimuth: 1.0, angle: 0.02 };
                gpr.inverse(tilt, jointplay_core::gpr::AxisHeight(gpr.working_height())).unwrap()
            };
            assert_eq!(rods(&robot.gpr), rods(other));
        };
        same(&parse(&text).unwrap(), &Gpr::paper());
        let wide = parse_with(&text, &[("r".to_owned(), 100.0)]).unwrap();
        assert_eq!(wide.gpr.platform().mean_radius(), 0.1);
        let unknown = parse_with(&text, &[("q".to_owned(), 1.0)]).unwrap_err();
        assert!(unknown.to_string().contains("parameter"), "{unknown}");
        refuse("= 240.0", "= \"2 * b\"", 22, "b");
    }

    #[test]
    fn base_points_may_differ_from_the_nominal_sockets() {
        let text = PAPER.replacen(
            "socket_angle_deg = 0.0",
            "socket_angle_deg = 0.0\nbase_point_mm = [95, -1.5]",
            1,
        );
        let robot = parse(&text).unwrap();
        assert_eq!(robot.gpr.base_points()[0], Vector2::new(0.095, -0.0015));
    }

    #[test]
    fn mesh_paths_must_stay_within_the_folder() {
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
            assert_eq!(error[0].place.line, 7);
        }
        for path in ["base.step", "base", "stl"] {
            let error = with(&format!("kind = \"gpr\"\nbase_mesh = \"{path}\"")).unwrap_err();
            assert!(error.to_string().contains("ends neither in .stl"), "{error}");
        }
    }

    /// Replaces a part of the paper's file and checks an error message.
    #[track_caller]
    fn refuse(from: &str, to: &str, line: usize, message: &str) {
        assert!(PAPER.contains(from), "{from:?} is not in the file");
        let errors = parse(&PAPER.replacen(from, to, 1)).unwrap_err();
        let found = errors
            .iter()
            .any(|error| error.to_string().contains(message) && error.place.line == line);
        let shown: Vec<String> = errors.iter().map(|error| error.with_excerpt("x.toml")).collect();
        assert!(found, "{}", shown.join("\n"));
    }

    #[test]
    fn all_errors_of_a_file_are_reported_in_order() {
        let text = PAPER
            .replacen("socket_radius_mm = 93.218", "socket_radius_mm = [93]\ncolor = 3", 1)
            .replacen("tilt_deg = 1.5", "tilt_deg = nan", 1);
        let errors = parse(&text).unwrap_err();
        let found: Vec<(usize, String)> =
            errors.iter().map(|error| (error.place.line, error.to_string())).collect();
        assert_eq!(found.len(), 3, "{found:?}");
        assert!(found[0].1.contains("has to be a number") && found[0].0 == 13, "{found:?}");
        assert!(found[1].1.contains("unknown key `color`") && found[1].0 == 14, "{found:?}");
        assert!(found[2].1.contains("`tilt_deg` is not a number") && found[2].0 == 29, "{found:?}");
    }

    #[test]
    fn invalid_files_are_rejected_with_the_place_of_each_error() {
        let radius = "socket_radius_mm = 93.218";
        refuse(radius, "socket_radius_mm = nan", 13, "`socket_radius_mm` is not a number");
        refuse(radius, "socket_radius_mm = inf", 13, "`socket_radius_mm` is infinite");
        refuse(
            radius,
            "socket_radius_mm = 1e308",
            13,
            "`socket_radius_mm` is 1e308, but has to be from -1000000 to 1000000",
        );
        refuse(
            "= 120.0",
            "= 1e308",
            18,
            "`socket_angle_deg` is 1e308, but has to be from -36000 to 36000",
        );
        refuse("[246.0, 754.0]", "[-1e308, 754]", 26, "`rod_mm` is -1e308");
        refuse(radius, "socket_radius_mm = 0", 13, "the socket radius of limb 1 is 0 mm");
        refuse(radius, "socket_radius_mm = -5.5", 13, "is -5.5 mm, but has to be positive");
        refuse(radius, "socket_radius_mm = [93]", 13, "has to be a number, but is");
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
        refuse(radius, "", 12, "`[[limb]]` needs `socket_radius_mm`");
        refuse(radius, "socket_radius_mm = = 3", 13, "");
        refuse("= 120.0", "= 0.0", 14, "lie on one line");
        refuse("= 120.0", "= 240.0", 14, "lie on one line");
        refuse("[246.0, 754.0]", "[754.0, 246.0]", 26, "reversed: least 754 mm, most 246 mm");
        refuse("[246.0, 754.0]", "[246.0]", 26, "has 1 entry,");
        refuse(
            "[246.0, 754.0]",
            "[246.0, 500.0, 754.0]",
            26,
            "`rod_mm` has 3 entries, but needs 2",
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
    fn sockets_in_the_opposite_order_of_the_base_points_are_rejected() {
        let points = ["[93.0, 0.0]", "[-46.0, -80.0]", "[-46.0, 80.0]"];
        let mut text = PAPER.to_owned();
        for (angle, point) in ["0.0", "120.0", "240.0"].iter().zip(points) {
            let key = format!("socket_angle_deg = {angle}\n");
            text = text.replacen(&key, &format!("{key}base_point_mm = {point}\n"), 1);
        }
        assert!(parse(&text).unwrap_err().to_string().contains("opposite senses"));
    }

    #[test]
    fn an_error_shows_its_line_with_carets() {
        let error = parse(&PAPER.replacen("tilt_deg = 1.5", "tilt_deg = nan", 1)).unwrap_err();
        let shown = error.with_excerpt("my.toml");
        assert_eq!(
            shown,
            "my.toml:28:12: `tilt_deg` is not a number, but has to be from -36000 to 36000\n   |\n28 | tilt_deg = nan\n   |            ^^^"
        );
    }

    #[test]
    fn truncated_files_do_not_panic() {
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
