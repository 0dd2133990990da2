//! Assemblies of FreeCAD (*Export ASMT*), in the text format of its solver: parts with markers, and joints between markers.
//!
//! A line is a label; its values and parts follow, indented by one tab more.
//! Joints start as drawn; the joint of a motion is actuated.

use std::collections::BTreeMap;
use std::ops::Range;

use jointplay_core::mechanism::{Joint, JointKind, Mechanism, MechanismError};
use jointplay_core::spatial::{Pose, rotation_vector};
use jointplay_format::mechanism::LengthUnit;
use jointplay_format::mechanism::frame::pose;
use jointplay_format::place::nearest;
use nalgebra::{Matrix3, Rotation3, Translation3, Unit, Vector3};

use super::draft::bare;
use super::model::{Dialect, Imported};
use super::problem::{Error, Problem};
use super::xml::LONGEST_NAME;

/// First line of a file.
pub(super) const FIRST_LINE: &str = "OndselSolver";
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

    fn name(self) -> Result<&'a str, Error> {
        let value = self.value("Name")?;
        let name = value.head.text;
        if name.chars().any(char::is_control) || name.len() > LONGEST_NAME {
            return Err(value.value_error("Name", "a name of at most 1000 bytes"));
        }
        Ok(name)
    }

    fn vector(self, what: &str) -> Result<Vector3<f64>, Error> {
        let numbers: Result<Vec<f64>, _> =
            self.head.text.split_whitespace().map(str::parse).collect();
        let numbers = numbers.ok().filter(|numbers| numbers.iter().all(|n| n.is_finite()));
        let numbers: Option<[f64; 3]> = numbers.and_then(|numbers| numbers.try_into().ok());
        numbers.map(Vector3::from).ok_or_else(|| self.value_error(what, "3 numbers"))
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

/// A marker: its link, and its pose there and in the assembly as drawn.
struct Marker {
    link: usize,
    in_link: Pose,
    drawn: Pose,
}

/// Reads an assembly.
///
/// # Arguments
/// * `unit` – unit of lengths in the file
pub(super) fn read(text: &str, unit: LengthUnit) -> Result<Imported, Error> {
    let lines = lines(text);
    let Some(at) = lines.iter().position(|line| line.indent == 0 && line.text == "Assembly") else {
        let problem = Problem::Missing { whose: FIRST_LINE.to_owned(), what: "Assembly" };
        return Err(Error::at(text, 0..0, problem));
    };
    let below = &lines[at + 1..];
    let count = below.iter().take_while(|line| line.indent > 0).count();
    let assembly = Block { source: text, head: &lines[at], below: &below[..count] };
    let name = assembly.name()?;

    // The base is the assembly itself.
    let mut links = vec![(name.to_owned(), assembly)];
    let mut markers = BTreeMap::new();
    let ground = Marker { link: 0, in_link: Pose::identity(), drawn: Pose::identity() };
    add_markers(&mut markers, assembly, &format!("/{name}"), &ground, unit)?;
    let mut ignored: BTreeMap<String, usize> = BTreeMap::new();
    let mut ignore = |what: String| *ignored.entry(what).or_default() += 1;
    for part in assembly.list("Parts") {
        let (part_name, drawn) = (part.name()?, part.pose(unit)?);
        let owner = Marker { link: links.len(), in_link: Pose::identity(), drawn };
        add_markers(&mut markers, part, &format!("/{name}/{part_name}"), &owner, unit)?;
        links.push((part_name.to_owned(), part));
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
    sets("Limits").for_each(|limit| ignore(limit.head.text.to_owned()));
    assembly.list("ForceTorques").for_each(|force| ignore(force.head.text.to_owned()));

    let mut joints: Vec<Joint> = Vec::new();
    let mut blocks = Vec::new();
    for block in sets("Joints") {
        joints.push(joint(block, &markers, &mut ignore)?);
        blocks.push(block);
    }
    let path = |(number, joint): (usize, &Joint)| (format!("/{name}/{}", joint.name), number);
    let numbers: BTreeMap<String, usize> = joints.iter().enumerate().map(path).collect();
    for motion in sets("Motions") {
        let driven = match motion.head.text {
            "RotationalMotion" => JointKind::Revolute,
            "TranslationalMotion" => JointKind::Prismatic,
            other => {
                let advice = "imported are RotationalMotion and TranslationalMotion";
                return Err(motion.unsupported(format!("motion {other:?}"), advice));
            }
        };
        let path = motion.value("MotionJoint")?;
        let Some(&number) = numbers.get(path.head.text) else {
            return Err(unknown("joint", path, numbers.keys().cloned().collect()));
        };
        let moved = &mut joints[number];
        if moved.kind == driven {
            moved.actuated = true;
        } else {
            ignore(format!("{} of joint {:?}", motion.head.text, moved.name));
        }
    }

    // An assembly that nothing is joined to is no link; its first part is the base.
    if joints.iter().all(|joint| !joint.links.contains(&0)) && links.len() > 1 {
        links.remove(0);
        for joint in &mut joints {
            joint.links = joint.links.map(|link| link - 1);
        }
    }
    let names = links.iter().map(|(name, _)| name.clone()).collect();
    let mechanism = Mechanism::new(name, names, joints).map_err(|error| {
        use MechanismError as E;
        let about = match &error {
            E::Dangling { link: name, .. } => links.iter().find(|(link, _)| link == name),
            _ => None,
        };
        let joint = match &error {
            E::NameTwice { name } | E::JoinedToItself { joint: name, .. } => {
                blocks.iter().rev().find(|block| block.name().is_ok_and(|found| found == name))
            }
            _ => None,
        };
        about.map(|(_, block)| block).or(joint).unwrap_or(&assembly).error(error)
    })?;
    let ignored = ignored.into_iter().map(|(what, count)| format!("{count} × {what}")).collect();
    Ok(Imported { mechanism, dialect: Dialect::Asmt, ignored })
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
    markers: &mut BTreeMap<String, Marker>,
    owner: Block,
    path: &str,
    at: &Marker,
    unit: LengthUnit,
) -> Result<(), Error> {
    for point in owner.list("RefPoints") {
        let link_from_point = point.pose(unit)?;
        for marker in point.list("Markers") {
            let in_link = link_from_point * marker.pose(unit)?;
            let found = Marker { link: at.link, in_link, drawn: at.drawn * in_link };
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

/// A joint between two markers, as drawn.
fn joint(
    block: Block,
    markers: &BTreeMap<String, Marker>,
    ignore: &mut impl FnMut(String),
) -> Result<Joint, Error> {
    let kind = match block.head.text {
        "FixedJoint" => JointKind::Fixed,
        "RevoluteJoint" => JointKind::Revolute,
        "CylindricalJoint" => JointKind::Cylindrical,
        "TranslationalJoint" => JointKind::Prismatic,
        "SphericalJoint" => JointKind::Spherical,
        "UniversalJoint" => JointKind::Universal,
        "PlanarJoint" if block.find("Offset").is_none() => JointKind::Planar,
        other => {
            let advice = "imported are FixedJoint, RevoluteJoint, CylindricalJoint, TranslationalJoint, SphericalJoint, UniversalJoint, and PlanarJoint without Offset";
            return Err(block.unsupported(format!("joint {other:?}"), advice));
        }
    };
    let end = |label| {
        let path = block.value(label)?;
        let known = || markers.keys().cloned().collect();
        markers.get(path.head.text).ok_or_else(|| unknown("marker", path, known()))
    };
    let (first, second) = (end("MarkerI")?, end("MarkerJ")?);
    let first_from_second = first.drawn.inverse() * second.drawn;
    // The solver also accepts frames that differ by half a turn about one of their axes.
    let turn = half_turn(kind, first_from_second.rotation);
    let turn = if kind == JointKind::Universal {
        // The second axis is z of the second marker, and x of our joint frame.
        Rotation3::from_matrix_unchecked(Matrix3::new(0., 0., 1., 0., -1., 0., 1., 0., 0.))
    } else {
        if turn != Rotation3::identity() {
            ignore("opposite direction of an axis".to_owned());
        }
        turn
    };
    let turn = Pose::from_parts(Translation3::identity(), turn);
    let (drawn, in_second) = (first_from_second * turn, second.in_link * turn);
    let mut joint =
        bare(block.name()?.to_owned(), kind, [first.link, second.link], [first.in_link, in_second]);
    let (rotation, shift) = (drawn.rotation, drawn.translation.vector);
    let angle = rotation[(1, 0)].atan2(rotation[(0, 0)]);
    joint.guess = match kind {
        JointKind::Revolute => vec![angle],
        JointKind::Prismatic => vec![shift.z],
        JointKind::Cylindrical => vec![shift.z, angle],
        JointKind::Spherical => rotation_vector(&rotation).iter().copied().collect(),
        JointKind::Planar => vec![shift.x, shift.y, angle],
        JointKind::Universal => vec![angle, rotation[(2, 1)].atan2(rotation[(2, 2)])],
        _ => Vec::new(),
    };
    Ok(joint)
}

/// The half turn of the second frame that brings its axes next to those of the first.
fn half_turn(kind: JointKind, first_from_second: Rotation3<f64>) -> Rotation3<f64> {
    let about = |axis| Rotation3::from_axis_angle(&axis, std::f64::consts::PI);
    let exact = |axis: Unit<Vector3<f64>>| {
        // Entries are 0 and ±1 exactly.
        Rotation3::from_matrix_unchecked(about(axis).matrix().map(f64::round))
    };
    let by_x = exact(Vector3::x_axis());
    match kind {
        JointKind::Spherical | JointKind::Universal => Rotation3::identity(),
        JointKind::Fixed | JointKind::Prismatic => {
            let (by_y, by_z) = (exact(Vector3::y_axis()), exact(Vector3::z_axis()));
            let turns = [by_z, by_y, by_x, Rotation3::identity()];
            let nearness = |turn: &Rotation3<f64>| (first_from_second * turn).matrix().trace();
            // Of equals the last.
            let best = turns.into_iter().max_by(|a, b| nearness(a).total_cmp(&nearness(b)));
            best.unwrap_or_default()
        }
        _ if first_from_second[(2, 2)] < 0.0 => by_x,
        _ => Rotation3::identity(),
    }
}

#[cfg(test)]
mod tests {
    use jointplay_core::mechanism::{Kinematics, assemble, guess};

    use super::*;
    use crate::import::{parse_with_unit, testing};

    const SLIDER_CRANK: &str =
        include_str!("../../../../validation/golden/models/slider-crank.asmt");
    const FLIPPED: &str =
        include_str!("../../../../validation/golden/models/flipped-four-bar.asmt");

    const CARDAN: &str = include_str!("../../../../validation/golden/models/cardan.asmt");

    #[test]
    fn assemblies_close_as_drawn() {
        for (text, joints, actuated, links) in
            [(SLIDER_CRANK, 4, 1, 4), (FLIPPED, 4, 1, 4), (CARDAN, 3, 1, 3)]
        {
            let model = testing::read(text);
            let mechanism = &model.mechanism;
            assert_eq!((model.dialect, mechanism.joints().len()), (Dialect::Asmt, joints));
            assert_eq!(mechanism.links().len(), links);
            assert_eq!(mechanism.joints().iter().filter(|j| j.actuated).count(), actuated);
            let start = guess(mechanism);
            let closed = assemble(mechanism, &start, &[], 0).unwrap();
            assert!((closed.coordinates - start).amax() < 1e-9);
        }
    }

    /// Poses that the solver of FreeCAD finds along the motion, see `asmt_reference.py`.
    #[test]
    fn parts_move_as_in_the_solver_of_freecad() {
        let rows = include_str!("../../../../validation/golden/asmt-poses.csv");
        let models =
            [("slider-crank", SLIDER_CRANK), ("flipped-four-bar", FLIPPED), ("cardan", CARDAN)];
        let mut compared = 0;
        for row in rows.lines().skip(1) {
            let cells: Vec<&str> = row.split(',').collect();
            let [model, angle, part, x, y, z] = cells[..] else { panic!("{row}") };
            let text = models.iter().find(|(name, _)| *name == model).unwrap().1;
            let mechanism = testing::read(text).mechanism;
            let kinematics = Kinematics::new(&mechanism);
            let crank = mechanism.joints().iter().position(|j| j.actuated).unwrap();
            let k = kinematics.coordinates_of(crank).start;
            let mut start = guess(&mechanism);
            let target = start[k] + angle.parse::<f64>().unwrap();
            // In small steps, which stay on the branch.
            let steps = 40;
            let first = start[k];
            for step in 1..=steps {
                start[k] = first + (target - first) * f64::from(step) / f64::from(steps);
                start = assemble(&mechanism, &start, &[k], 0).unwrap().coordinates;
            }
            let poses = kinematics.link_poses(&start).unwrap();
            let link = mechanism.links().iter().position(|link| link == part).unwrap();
            let expected = [x, y, z].map(|text| text.parse::<f64>().unwrap());
            let difference = poses[link].translation.vector - Vector3::from(expected);
            assert!(difference.amax() < 1e-6, "{row}: {difference}");
            compared += 1;
        }
        assert!(compared >= 12);
    }

    #[test]
    fn lengths_are_in_the_unit_asked_for() {
        let length = |text: Result<Imported, Error>| {
            let model = text.unwrap();
            model.mechanism.joints().iter().map(|j| j.frames[0].translation.vector.norm()).sum()
        };
        let m: f64 = length(parse_with_unit(SLIDER_CRANK, LengthUnit::Meter));
        let mm: f64 = length(parse_with_unit(SLIDER_CRANK, LengthUnit::Millimeter));
        assert!((m / mm - 1000.0).abs() < 1e-9);
    }

    #[test]
    fn what_would_change_the_mechanism_is_refused() {
        let refuse = |from: &str, to: &str, blamed: &str, message: &str| {
            testing::refuse(SLIDER_CRANK, from, to, blamed, message);
        };
        refuse("RevoluteJoint", "GearJoint", "GearJoint", "imported are FixedJoint");
        refuse(
            "/slider-crank/crank/tip",
            "/slider-crank/crank/tap",
            "/slider-crank/crank/tap",
            "did you mean",
        );
        refuse("RotationalMotion", "GeneralMotion", "GeneralMotion", "motion \"GeneralMotion\"");
        refuse("0.1\t0.0\t0.0", "0.1\tx\t0.0", "0.1\tx\t0.0", "3 numbers");
    }

    #[test]
    fn truncated_assemblies_do_not_panic() {
        for cut in (0..SLIDER_CRANK.len()).step_by(7) {
            for text in [&SLIDER_CRANK[..cut], &SLIDER_CRANK[cut..]] {
                let text = format!("{FIRST_LINE}\n{text}");
                if let Err(error) = parse_with_unit(&text, LengthUnit::Meter) {
                    let _ = error.with_excerpt("x");
                }
            }
        }
    }
}
