//! Assemblies of FreeCAD (*Export ASMT*), in the text format of its solver: parts with markers, and joints between markers.
//!
//! A line is a label; its values and parts follow, indented by one tab more.
//! Joints start as drawn; the joint of a motion is actuated.

use std::collections::BTreeMap;
use std::ops::Range;

use jointplay_core::mechanism::{Joint, JointKind, Mechanism, MechanismError};
use jointplay_core::spatial::Pose;
use jointplay_format::expression::{AngleUnit, Formula};
use jointplay_format::mechanism::LengthUnit;
use jointplay_format::mechanism::frame::pose;
use jointplay_format::place::nearest;
use nalgebra::{Matrix3, Unit, Vector3};

use super::joint_limits::{self, FrameLimit, FrameMotion, RangeEnd};
use super::joint_series::{JointSeries, SeriesKind, joint_series};
use super::part_coupling::{DrawnJoints, PartCoupling};
use super::placed_joint::{PlacedFrame, placed_joint};
use super::solver_kind::solver_kind;
use crate::import::model::{Dialect, Imported};
use crate::import::problem::{Error, Problem};
use crate::import::xml::LONGEST_NAME;

/// First lines of files: of the solver, and of the program that it comes from.
pub(in crate::import) const FIRST_LINES: [&str; 2] =
    ["OndselSolver", "freeCAD: 3D CAD with Motion Simulation  by  askoh.com"];
/// Largest deviation of a rotation matrix from orthonormal; files have rounded numbers.
const ROTATION_TOLERANCE: f64 = 1e-5;

/// A line with its indentation and its place.
#[derive(Clone)]
struct Line<'a> {
    indent: usize,
    text: &'a str,
    span: Range<usize>,
}

/// A label with the lines below it.
#[derive(Clone, Copy)]
struct Block<'l, 'a> {
    source: &'a str,
    head: &'l Line<'a>,
    below: &'l [Line<'a>],
}

impl<'l, 'a> Block<'l, 'a> {
    fn error(&self, problem: impl Into<Problem>) -> Error {
        Error::at(self.source, self.head.span.clone(), problem.into())
    }

    fn unsupported(&self, what: String, advice: &str) -> Error {
        self.error(Problem::Unsupported { what, advice: advice.to_owned() })
    }

    fn value_error(&self, what: &str, expected: &'static str) -> Error {
        let found = self.head.text.chars().take(60).collect();
        self.error(Problem::Value { what: what.to_owned(), found, expected })
    }

    /// The blocks one level below.
    fn blocks(self) -> impl Iterator<Item = Block<'l, 'a>> {
        let level = self.head.indent + 1;
        let starts = self.below.iter().enumerate().filter(move |(_, line)| line.indent == level);
        starts.map(move |(at, head)| {
            let rest = &self.below[at + 1..];
            let count = rest.iter().take_while(|line| line.indent > level).count();
            Block { source: self.source, head, below: &rest[..count] }
        })
    }

    fn find(self, label: &str) -> Option<Block<'l, 'a>> {
        self.blocks().find(|block| block.head.text == label)
    }

    fn needed(self, label: &'static str) -> Result<Block<'l, 'a>, Error> {
        self.find(label).ok_or_else(|| {
            self.error(Problem::Missing { whose: self.head.text.to_owned(), what: label })
        })
    }

    /// The blocks of a list, which may be absent.
    fn list(self, label: &str) -> impl Iterator<Item = Block<'l, 'a>> {
        self.find(label).into_iter().flat_map(Self::blocks)
    }

    /// The value of a label that is needed.
    fn value(self, label: &'static str) -> Result<Block<'l, 'a>, Error> {
        let block = self.needed(label)?;
        block.blocks().next().ok_or_else(|| block.value_error(label, "followed by a value"))
    }

    /// The value of a label, unless it is absent or empty.
    fn optional(self, label: &str) -> Option<Block<'l, 'a>> {
        self.find(label)?.blocks().next()
    }

    fn name(self) -> Result<&'a str, Error> {
        let value = self.value("Name")?;
        let name = value.head.text;
        if name.chars().any(char::is_control) || name.len() > LONGEST_NAME {
            return Err(value.value_error("Name", "a name of at most 1000 bytes"));
        }
        Ok(name)
    }

    /// The kind of a joint.
    fn kind(self) -> Result<&'a str, Error> {
        solver_kind(self.head.text).map_err(|kinds| {
            let what = format!(
                "joint {:?}, a name that FreeCAD cut: {}",
                self.head.text,
                kinds.join(" or ")
            );
            self.unsupported(what, "import the document (.FCStd) in place of its export")
        })
    }

    /// The name of a joint; those that FreeCAD left without one are named by their kind and number.
    fn joint_name(self, number: usize) -> Result<String, Error> {
        match self.find("Name").is_some() && self.optional("Name").is_none() {
            true => Ok(format!("{} {number}", self.kind()?)),
            false => Ok(self.name()?.to_owned()),
        }
    }

    fn vector(self, what: &str) -> Result<Vector3<f64>, Error> {
        let numbers: Result<Vec<f64>, _> =
            self.head.text.split_whitespace().map(str::parse).collect();
        let numbers = numbers.ok().filter(|numbers| numbers.iter().all(|n| n.is_finite()));
        let numbers: Option<[f64; 3]> = numbers.and_then(|numbers| numbers.try_into().ok());
        numbers.map(Vector3::from).ok_or_else(|| self.value_error(what, "3 numbers"))
    }

    fn number(self, what: &str) -> Result<f64, Error> {
        let number = self.head.text.parse().ok().filter(|number: &f64| number.is_finite());
        number.ok_or_else(|| self.value_error(what, "a number"))
    }

    /// The pose of a part, a reference point or a marker (m).
    fn pose(self, unit: LengthUnit) -> Result<Pose, Error> {
        let point = self.value("Position3D")?.vector("Position3D")?.map(|x| unit.to_meters(x));
        let matrix = self.needed("RotationMatrix")?;
        let rows = matrix.blocks().map(|row| row.vector("RotationMatrix"));
        let rows: Vec<Vector3<f64>> = rows.collect::<Result<_, _>>()?;
        let invalid = || matrix.value_error("RotationMatrix", "a rotation of 3 rows");
        let &[a, b, c] = rows.as_slice() else { return Err(invalid()) };
        let rotation = Matrix3::from_columns(&[a, b, c]).transpose();
        let deviation = (rotation * rotation.transpose() - Matrix3::identity()).amax();
        let is_rotation = deviation <= ROTATION_TOLERANCE && rotation.determinant() > 0.0;
        if !point.iter().all(|x| x.is_finite()) || !is_rotation {
            return Err(invalid());
        }
        let axis = |k: usize| Unit::new_normalize(rotation.column(k).into_owned());
        Ok(pose(point, axis(0), axis(2)))
    }
}

/// Reads an assembly.
///
/// # Arguments
/// * `unit` – unit of lengths in the file
pub(in crate::import) fn read(text: &str, unit: LengthUnit) -> Result<Imported, Error> {
    let lines = lines(text);
    let Some(at) = lines.iter().position(|line| line.indent == 0 && line.text == "Assembly") else {
        let problem = Problem::Missing { whose: FIRST_LINES[0].to_owned(), what: "Assembly" };
        return Err(Error::at(text, 0..0, problem));
    };
    let below = &lines[at + 1..];
    let count = below.iter().take_while(|line| line.indent > 0).count();
    let assembly = Block { source: text, head: &lines[at], below: &below[..count] };
    let name = assembly.name()?;

    // The base is the assembly itself.
    let mut links = vec![(name.to_owned(), assembly)];
    let mut poses = vec![Pose::identity()];
    let mut markers = BTreeMap::new();
    let ground = PlacedFrame { link: 0, in_link: Pose::identity(), drawn: Pose::identity() };
    add_markers(&mut markers, assembly, &format!("/{name}"), &ground, unit)?;
    let mut ignored: BTreeMap<String, usize> = BTreeMap::new();
    let mut ignore = |what: String| *ignored.entry(what).or_default() += 1;
    for part in assembly.list("Parts") {
        let (part_name, drawn) = (part.name()?, part.pose(unit)?);
        let owner = PlacedFrame { link: links.len(), in_link: Pose::identity(), drawn };
        add_markers(&mut markers, part, &format!("/{name}/{part_name}"), &owner, unit)?;
        links.push((part_name.to_owned(), part));
        poses.push(drawn);
        if part.find("PrincipalMassMarker").is_some() {
            ignore("PrincipalMassMarker".to_owned());
        }
    }
    let constraints = assembly.find("ConstraintSets");
    let sets = |label: &'static str| constraints.into_iter().flat_map(move |all| all.list(label));
    if let Some(block) = sets("GeneralConstraintSets").next() {
        let what = format!("constraint {:?}", block.head.text);
        return Err(block.unsupported(what, "only joints are imported"));
    }
    assembly.list("ForceTorques").for_each(|force| ignore(force.head.text.to_owned()));

    let mut joints: Vec<Joint> = Vec::new();
    let (mut blocks, mut part_couplings) = (Vec::new(), Vec::new());
    let mut joints_in_series = Vec::new();
    for block in sets("Joints") {
        // A joint of another kind is refused for this reason, whatever its markers are.
        let kind = assembled_kind(block, unit)?;
        let frames = frames(block, &markers)?;
        if let AssembledKind::Coupling(part_coupling) = kind {
            part_couplings.push((block, part_coupling, frames));
            continue;
        }
        let name = block.joint_name(joints.len() + 1)?;
        if frames[0].link == frames[1].link {
            ignore(format!("joint {name:?} of a part with itself"));
            continue;
        }
        match kind {
            AssembledKind::Joint { kind, offset } => {
                // The second frame moves in a plane at this distance from the first.
                let first = frames[0].shifted(Vector3::new(0.0, 0.0, offset));
                joints.push(placed_joint(name, kind, [&first, frames[1]], &mut ignore));
                blocks.push(block);
            }
            AssembledKind::Series(kind) => joints_in_series.push((block, name, kind, frames)),
            AssembledKind::Coupling(_) => {}
        }
    }
    let moved = MovedJoints::new(name, &blocks, &joints)?;
    for motion in sets("Motions") {
        let driven = match motion.head.text {
            "RotationalMotion" => JointKind::Revolute,
            "TranslationalMotion" => JointKind::Prismatic,
            // It moves markers and leaves the joints as they are.
            "GeneralMotion" => {
                ignore("GeneralMotion".to_owned());
                continue;
            }
            other => {
                let advice = "imported are RotationalMotion, TranslationalMotion and GeneralMotion";
                return Err(motion.unsupported(format!("motion {other:?}"), advice));
            }
        };
        let Some(number) = moved.joint(motion)? else {
            let what = format!("{} of two markers without a joint", motion.head.text);
            return Err(motion.unsupported(what, "only motions of joints are imported"));
        };
        let moved = &mut joints[number];
        if moved.kind == driven {
            moved.actuated = true;
        } else {
            ignore(format!("{} of joint {:?}", motion.head.text, moved.name));
        }
    }
    let mut limits: Vec<Vec<FrameLimit>> = joints.iter().map(|_| Vec::new()).collect();
    for block in sets("Limits") {
        match (limit(block, unit)?, moved.joint(block)?) {
            (Some(limit), Some(number)) => limits[number].push(limit),
            (None, _) => ignore(format!("{} that is not a number", block.head.text)),
            (_, None) => ignore(format!("{} of two markers without a joint", block.head.text)),
        }
    }
    for (joint, limits) in joints.iter_mut().zip(&limits) {
        joint_limits::apply(joint, limits, &mut ignore);
    }

    let drawn = DrawnJoints::new(&joints, &poses);
    let mut couplings = Vec::new();
    for (block, part_coupling, frames) in part_couplings {
        let name = block.joint_name(joints.len() + couplings.len() + 1)?;
        let coupling = drawn.coupling(name, part_coupling, frames);
        let coupling = coupling.map_err(|advice| {
            let kind = block.kind().unwrap_or(block.head.text);
            block.unsupported(format!("this {kind}"), advice)
        });
        couplings.push(coupling?);
        blocks.push(block);
    }

    // Their links follow those of the parts.
    for (block, name, kind, frames) in joints_in_series {
        let series = joint_series(&name, kind, frames, links.len(), &mut ignore);
        let JointSeries { joints: in_series, links: between } = series;
        links.extend(between.into_iter().map(|(link, _)| (link, block)));
        joints.extend(in_series);
    }

    // An assembly that nothing is joined to is no link; its first part is the base.
    if joints.iter().all(|joint| !joint.links.contains(&0)) && links.len() > 1 {
        links.remove(0);
        for joint in &mut joints {
            joint.links = joint.links.map(|link| link - 1);
        }
    }
    let names = links.iter().map(|(name, _)| name.clone()).collect();
    let mechanism = Mechanism::new(name, names, joints)
        .and_then(|mechanism| mechanism.with_couplings(couplings));
    let mechanism = mechanism.map_err(|error| {
        use MechanismError as E;
        let about = match &error {
            E::Dangling { link: name, .. } => links.iter().find(|(link, _)| link == name),
            _ => None,
        };
        let joint = match &error {
            E::NameTwice { name }
            | E::JoinedToItself { joint: name, .. }
            | E::LimitsReversed { name, .. } => {
                blocks.iter().rev().find(|block| block.name().is_ok_and(|found| found == name))
            }
            _ => None,
        };
        about.map(|(_, block)| block).or(joint).unwrap_or(&assembly).error(error)
    })?;
    let ignored = ignored.into_iter().map(|(what, count)| format!("{count} × {what}")).collect();
    let imported = Imported { mechanism, dialect: Dialect::Asmt, ignored };
    imported.check_numbers().map_err(|problem| {
        let about = match &problem {
            Problem::TooLarge { whose, .. } => {
                blocks.iter().find(|block| block.name().is_ok_and(|found| found == whose))
            }
            _ => None,
        };
        about.unwrap_or(&assembly).error(problem)
    })?;
    Ok(imported)
}

/// Joints by what motions and limits name: their paths, or their two markers.
struct MovedJoints<'a> {
    paths: BTreeMap<String, usize>,
    markers: BTreeMap<[&'a str; 2], usize>,
}

impl<'a> MovedJoints<'a> {
    fn new(assembly: &str, blocks: &[Block<'_, 'a>], joints: &[Joint]) -> Result<Self, Error> {
        let mut found = Self { paths: BTreeMap::new(), markers: BTreeMap::new() };
        for (number, (block, joint)) in blocks.iter().zip(joints).enumerate() {
            found.paths.insert(format!("/{assembly}/{}", joint.name), number);
            found.markers.entry(ends(*block)?).or_insert(number);
        }
        Ok(found)
    }

    /// The joint of a motion or limit; `None` where it names two markers that no joint has.
    fn joint(&self, block: Block<'_, 'a>) -> Result<Option<usize>, Error> {
        let Some(path) = block.optional("MotionJoint") else {
            return Ok(self.markers.get(&ends(block)?).copied());
        };
        match self.paths.get(path.head.text) {
            Some(&number) => Ok(Some(number)),
            None => Err(unknown("joint", path, self.paths.keys().cloned().collect())),
        }
    }
}

/// The paths of the two markers.
fn ends<'a>(block: Block<'_, 'a>) -> Result<[&'a str; 2], Error> {
    Ok([block.value("MarkerI")?.head.text, block.value("MarkerJ")?.head.text])
}

/// A limit of the angle or distance between two markers (rad, m); `None` where its value is not a number.
fn limit(block: Block<'_, '_>, unit: LengthUnit) -> Result<Option<FrameLimit>, Error> {
    let motion = match block.head.text {
        "RotationLimit" => FrameMotion::Turn,
        "TranslationLimit" => FrameMotion::Slide,
        other => {
            let advice = "imported are RotationLimit and TranslationLimit";
            return Err(block.unsupported(format!("limit {other:?}"), advice));
        }
    };
    let kind = block.value("Type")?;
    let end = match kind.head.text {
        "=>" => RangeEnd::Least,
        "=<" => RangeEnd::Greatest,
        _ => return Err(kind.value_error("Type", "\"=>\" or \"=<\"")),
    };
    // The solver accepts expressions: FreeCAD writes degrees as `90.000000*pi/180.0`.
    let text = block.value("Limit")?.head.text;
    let value = Formula::parse(text, AngleUnit::Radian)
        .and_then(|formula| formula.evaluate_with(&|_| None))
        .ok();
    Ok(value.map(|value| {
        let value = if motion == FrameMotion::Slide { unit.to_meters(value) } else { value };
        FrameLimit { motion, end, value }
    }))
}

fn lines(text: &str) -> Vec<Line<'_>> {
    let mut start = 0;
    let mut lines = Vec::new();
    for whole in text.split_inclusive('\n') {
        let inner = whole.trim();
        if !inner.is_empty() {
            let before = whole.len() - whole.trim_start().len();
            let span = start + before..start + before + inner.len();
            let indent = whole.chars().take_while(|&character| character == '\t').count();
            lines.push(Line { indent, text: inner, span });
        }
        start += whole.len();
    }
    lines
}

/// Adds the markers of a part or the assembly by their paths.
fn add_markers(
    markers: &mut BTreeMap<String, PlacedFrame>,
    owner: Block,
    path: &str,
    at: &PlacedFrame,
    unit: LengthUnit,
) -> Result<(), Error> {
    for point in owner.list("RefPoints") {
        let link_from_point = point.pose(unit)?;
        for marker in point.list("Markers") {
            let in_link = link_from_point * marker.pose(unit)?;
            let found = PlacedFrame { link: at.link, in_link, drawn: at.drawn * in_link };
            let path = format!("{path}/{}", marker.name()?);
            if markers.insert(path.clone(), found).is_some() {
                let what = format!("a second marker {path:?}");
                return Err(marker.unsupported(what, "joints could mean either of them"));
            }
        }
    }
    Ok(())
}

fn unknown(what: &'static str, value: Block, known: Vec<String>) -> Error {
    let found: String = value.head.text.chars().take(60).collect();
    let nearest = nearest(value.head.text, known.iter().map(String::as_str));
    value.error(Problem::Unknown { what, found, nearest, known })
}

/// Equivalent of a joint of a file.
enum AssembledKind {
    /// A joint; `offset` is the distance of a plane (m).
    Joint { kind: JointKind, offset: f64 },
    /// Joints in series.
    Series(SeriesKind),
    /// A constraint between the motions of two parts, by gears, a rack or a thread.
    Coupling(PartCoupling),
}

fn assembled_kind(block: Block, unit: LengthUnit) -> Result<AssembledKind, Error> {
    use AssembledKind::{Coupling, Joint, Series};
    let number = |label| block.value(label)?.number(label);
    let length = |label| Ok::<f64, Error>(unit.to_meters(number(label)?));
    let offset = || match block.optional("offset") {
        Some(value) => Ok::<f64, Error>(unit.to_meters(value.number("offset")?)),
        None => Ok(0.0),
    };
    let plain = |kind| Joint { kind, offset: 0.0 };
    Ok(match block.kind()? {
        "FixedJoint" => plain(JointKind::Fixed),
        "RevoluteJoint" => plain(JointKind::Revolute),
        "CylindricalJoint" => plain(JointKind::Cylindrical),
        "TranslationalJoint" => plain(JointKind::Prismatic),
        "SphericalJoint" => plain(JointKind::Spherical),
        "UniversalJoint" => plain(JointKind::Universal),
        "PlanarJoint" => Joint { kind: JointKind::Planar, offset: offset()? },
        "PointInPlaneJoint" => Series(SeriesKind::PointInPlane(offset()?)),
        "LineInPlaneJoint" => Series(SeriesKind::LineInPlane(offset()?)),
        "SphSphJoint" => match length("distanceIJ")? {
            0.0 => plain(JointKind::Spherical),
            distance => Series(SeriesKind::PointAtDistance(distance)),
        },
        "CylSphJoint" => Series(SeriesKind::PointNearLine(length("distanceIJ")?)),
        "RevCylJoint" => match length("distanceIJ")? {
            0.0 => plain(JointKind::Cylindrical),
            distance => Series(SeriesKind::ParallelLines(distance)),
        },
        "ParallelAxesJoint" => Series(SeriesKind::ParallelAxes),
        "PerpendicularJoint" => Series(SeriesKind::Perpendicular),
        "AngleJoint" => Series(SeriesKind::Angle(number("theIzJz")?)),
        "GearJoint" => Coupling(PartCoupling::Gears([number("radiusI")?, number("radiusJ")?])),
        "RackPinionJoint" => Coupling(PartCoupling::Rack(length("pitchRadius")?)),
        "ScrewJoint" => Coupling(PartCoupling::Screw(length("pitch")?)),
        other => {
            let advice = "imported are Angle, Cylindrical, CylSph, Fixed, Gear, LineInPlane, ParallelAxes, Perpendicular, Planar, PointInPlane, RackPinion, RevCyl, Revolute, Screw, Spherical, SphSph, Translational and UniversalJoint";
            return Err(block.unsupported(format!("joint {other:?}"), advice));
        }
    })
}

/// The frames at the two markers of a joint.
fn frames<'m>(
    block: Block,
    markers: &'m BTreeMap<String, PlacedFrame>,
) -> Result<[&'m PlacedFrame; 2], Error> {
    let end = |label| {
        let path = block.value(label)?;
        let known = || markers.keys().cloned().collect();
        markers.get(path.head.text).ok_or_else(|| unknown("marker", path, known()))
    };
    Ok([end("MarkerI")?, end("MarkerJ")?])
}
