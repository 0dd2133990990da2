//! Assemblies in documents of FreeCAD: parts that are placed, and joints between frames of them.
//!
//! The placements that a joint stores include the offsets that the user gave.

use std::collections::{BTreeMap, BTreeSet};

use jointplay_core::mechanism::JointKind;
use jointplay_core::spatial::Pose;
use roxmltree::Node;

use super::document::{ASSEMBLY, Document, Object, Reference, SUB_ASSEMBLY, UNIT};
use super::joint_limits::{self, FrameLimit, FrameMotion, RangeEnd};
use super::joint_series::{SeriesKind, joint_series};
use super::part_coupling::{DrawnJoints, PartCoupling, rack_frame};
use super::path_end::{PathEnd, end_of, is_group};
use super::placed_joint::{PlacedFrame, placed_joint};
use crate::import::draft::Draft;
use crate::import::model::{Dialect, Imported};
use crate::import::problem::Error;
use crate::import::xml::{Advice, place};

/// Kinds of joints, in the order of their numbers in files without their names.
const JOINT_TYPES: [&str; 13] = [
    "Fixed",
    "Revolute",
    "Cylindrical",
    "Slider",
    "Ball",
    "Distance",
    "Parallel",
    "Perpendicular",
    "Angle",
    "RackPinion",
    "Screw",
    "Gears",
    "Belt",
];
const SUPPORTED: Advice = Advice(
    "imported are the joints Fixed, Revolute, Cylindrical, Slider, Ball, Distance between two vertices, Parallel, Perpendicular, Angle, RackPinion, Screw, Gears and Belt",
);
/// The kind of a distance depends on shapes.
const SHAPES: Advice = Advice(
    "only distances between two vertices are read from documents, because those of other elements depend on their shapes; export the assembly from FreeCAD as ASMT",
);

/// Reads the assembly of a document.
pub(in crate::import) fn read<'a>(draft: Draft<'a>, root: Node<'a, 'a>) -> Result<Imported, Error> {
    let document = Document::new(draft.xml, root)?;
    let assembly = only_assembly(&document, root)?;
    let name = document.label(assembly)?;
    let (parts, joints) = (BTreeMap::new(), BTreeMap::new());
    let (poses, series) = (Vec::new(), Vec::new());
    let mut reader = Reader { draft, document: &document, assembly, parts, poses, joints, series };
    let members = reader.members()?;
    // The base is the assembly itself; without a grounded part it is no link.
    let (grounds, joints): (Vec<_>, Vec<_>) =
        members.joints.iter().partition(|joint| joint.has("ObjectToGround"));
    if !grounds.is_empty() {
        reader.draft.add_link(name.clone(), place(assembly.node))?;
        reader.poses.push(Pose::identity());
    }
    for ground in grounds {
        reader.add_ground(ground)?;
    }
    // The joints that carry parts are complete before those that relate their motions.
    let mut part_couplings = Vec::new();
    for joint in joints {
        match reader.part_coupling(joint)? {
            Some(part_coupling) => part_couplings.push((joint, part_coupling)),
            None => reader.add_joint(joint)?,
        }
    }
    for (joint, part_coupling) in part_couplings {
        reader.add_part_coupling(joint, part_coupling)?;
    }
    reader.finish_series()?;
    for motion in members.motions {
        reader.add_motion(motion)?;
    }
    for part in members.parts {
        if !reader.parts.contains_key(part.name) {
            let what = format!("part {:?}, which has no joints", document.label(part)?);
            reader.draft.ignore(what);
        }
    }
    reader.draft.finish(&name, Dialect::FcStd)
}

/// The assembly of a document that is in no other.
fn only_assembly<'d, 'a>(
    document: &'d Document<'a>,
    root: Node<'a, 'a>,
) -> Result<&'d Object<'a>, Error> {
    let assemblies: Vec<&Object> =
        document.objects().filter(|object| object.kind == ASSEMBLY).collect();
    let mut inner: BTreeSet<&str> = BTreeSet::new();
    for assembly in &assemblies {
        let mut open = document.group(assembly)?;
        while let Some(object) = open.pop() {
            if inner.insert(object.name) && object.kind != ASSEMBLY {
                open.extend(document.group(object)?);
            }
        }
    }
    let outer: Vec<&Object> =
        assemblies.iter().copied().filter(|one| !inner.contains(one.name)).collect();
    match outer[..] {
        [assembly] => Ok(assembly),
        [] => {
            let what = "a document without an assembly of FreeCAD 1.0 or later";
            let advice = Advice("joints of other assembly workbenches are not read");
            Err(document.xml.unsupported(root, what, advice))
        }
        [first, second, ..] => {
            let what =
                format!("a document with the assemblies {:?} and {:?}", first.name, second.name);
            let advice = Advice("save one assembly per file");
            Err(document.xml.unsupported(second.node, what, advice))
        }
    }
}

/// The objects of an assembly.
#[derive(Default)]
struct Members<'d, 'a> {
    joints: Vec<&'d Object<'a>>,
    motions: Vec<&'d Object<'a>>,
    parts: Vec<&'d Object<'a>>,
}

/// The part with a place of a reference, and the pose of the place's object in it (m).
struct Resolved<'d, 'a> {
    part: &'d Object<'a>,
    part_from_object: Pose,
}

struct Reader<'d, 'a> {
    draft: Draft<'a>,
    document: &'d Document<'a>,
    assembly: &'d Object<'a>,
    /// Links by the names of their parts.
    parts: BTreeMap<&'a str, usize>,
    /// Pose of each link in the assembly.
    poses: Vec<Pose>,
    /// Joints by their names in the file.
    joints: BTreeMap<&'a str, usize>,
    /// Constraints that become several joints.
    series: Vec<(&'d Object<'a>, String, SeriesKind, [PlacedFrame; 2])>,
}

impl<'d, 'a> Reader<'d, 'a> {
    /// The objects of the assembly, also those in groups.
    fn members(&mut self) -> Result<Members<'d, 'a>, Error> {
        let mut members = Members::default();
        let mut seen = BTreeSet::from([self.assembly.name]);
        let mut open = self.document.group(self.assembly)?;
        open.reverse();
        while let Some(object) = open.pop() {
            if !seen.insert(object.name) {
                continue;
            }
            if object.has("ObjectToGround") || object.has("JointType") {
                let joint = self.document.label(object)?;
                let is_suppressed = self.document.flag(object, "Suppressed")? == Some(true)
                    || self.document.flag(object, "Activated")? == Some(false);
                if is_suppressed {
                    self.draft.ignore(format!("suppressed joint {joint:?}"));
                } else {
                    members.joints.push(object);
                }
            } else if object.has("MotionType") {
                members.motions.push(object);
            } else if is_group(object) || object.kind == "App::FeaturePython" {
                let inside = self.document.group(object)?;
                open.extend(inside.into_iter().rev());
            } else if object.has("Placement") && object.kind != "App::Origin" {
                members.parts.push(object);
            }
        }
        Ok(members)
    }

    /// A grounded part: a fixed joint to the base, where the part is drawn.
    fn add_ground(&mut self, ground: &'d Object<'a>) -> Result<(), Error> {
        let linked = self.document.link(ground, "ObjectToGround")?;
        let part = linked.ok_or_else(|| self.document.missing(ground, "ObjectToGround"))?;
        let drawn = self.document.placement(part, "Placement")?;
        let link = self.add_part(part)?;
        let base = PlacedFrame { link: 0, in_link: drawn, drawn };
        let fixed = PlacedFrame { link, in_link: Pose::identity(), drawn };
        self.add(ground, JointKind::Fixed, [&base, &fixed], &[])
    }

    fn add_joint(&mut self, joint: &'d Object<'a>) -> Result<(), Error> {
        let xml = self.document.xml;
        if let Some(kind) = self.series_kind(joint)? {
            return self.add_series(joint, kind);
        }
        let kind = match self.document.choice(joint, "JointType", &JOINT_TYPES)? {
            "Fixed" => JointKind::Fixed,
            "Revolute" => JointKind::Revolute,
            "Cylindrical" => JointKind::Cylindrical,
            "Slider" => JointKind::Prismatic,
            // Of a distance of zero.
            "Ball" | "Distance" => JointKind::Spherical,
            other => {
                let what = format!("joint {:?} of type {other:?}", self.document.label(joint)?);
                return Err(xml.unsupported(joint.node, what, SUPPORTED));
            }
        };
        let first = self.frame(joint, "Reference1", "Placement1")?;
        let second = self.frame(joint, "Reference2", "Placement2")?;
        let limits = self.limits(joint, kind)?;
        self.add(joint, kind, [&first, &second], &limits)
    }

    /// The kind of a joint that is several joints here.
    fn series_kind(&self, joint: &'d Object<'a>) -> Result<Option<SeriesKind>, Error> {
        let document = self.document;
        Ok(match document.choice(joint, "JointType", &JOINT_TYPES)? {
            "Parallel" => Some(SeriesKind::ParallelAxes),
            "Perpendicular" => Some(SeriesKind::Perpendicular),
            "Angle" => Some(SeriesKind::Angle(document.number(joint, "Distance")?.to_radians())),
            "Distance" => {
                for name in ["Reference1", "Reference2"] {
                    let reference = document.reference(joint, name)?;
                    let element = reference.as_ref().map_or("", |one| one.element);
                    if !element.starts_with("Vertex") {
                        let label = document.label(joint)?;
                        let what = format!("joint {label:?} of type \"Distance\" to {element:?}");
                        return Err(document.xml.unsupported(joint.node, what, SHAPES));
                    }
                }
                let distance = UNIT.to_meters(document.number(joint, "Distance")?);
                (distance != 0.0).then_some(SeriesKind::PointAtDistance(distance))
            }
            _ => None,
        })
    }

    fn add_series(&mut self, joint: &'d Object<'a>, kind: SeriesKind) -> Result<(), Error> {
        let first = self.frame(joint, "Reference1", "Placement1")?;
        let second = self.frame(joint, "Reference2", "Placement2")?;
        let name = unique(self.document, joint, |name| self.draft.joint(name).is_some())?;
        self.series.push((joint, name, kind, [first, second]));
        Ok(())
    }

    /// Adds the joints in series, whose links follow those of the parts.
    fn finish_series(&mut self) -> Result<(), Error> {
        for (joint, name, kind, [first, second]) in std::mem::take(&mut self.series) {
            let next = self.draft.links();
            let mut ignore = |what| self.draft.ignore(what);
            let series = joint_series(&name, kind, [&first, &second], next, &mut ignore);
            for (link, pose) in series.links {
                let link = self.draft.fresh(link);
                self.draft.add_link(link, place(joint.node))?;
                self.poses.push(pose);
            }
            for mut one in series.joints {
                one.name = self.draft.fresh(one.name);
                self.draft.add_joint(one, place(joint.node))?;
            }
        }
        Ok(())
    }

    /// The relation of a joint between the motions of two parts.
    fn part_coupling(&self, joint: &'d Object<'a>) -> Result<Option<PartCoupling>, Error> {
        let number = |name| self.document.number(joint, name);
        let length = |name| Ok::<f64, Error>(UNIT.to_meters(number(name)?));
        Ok(match self.document.choice(joint, "JointType", &JOINT_TYPES)? {
            "Gears" => Some(PartCoupling::Gears([number("Distance")?, number("Distance2")?])),
            "Belt" => Some(PartCoupling::Gears([number("Distance")?, -number("Distance2")?])),
            "RackPinion" => Some(PartCoupling::Rack(length("Distance")?)),
            "Screw" => Some(PartCoupling::Screw(length("Distance")?)),
            _ => None,
        })
    }

    fn add_part_coupling(
        &mut self,
        joint: &'d Object<'a>,
        part_coupling: PartCoupling,
    ) -> Result<(), Error> {
        let first = self.frame(joint, "Reference1", "Placement1")?;
        let second = self.frame(joint, "Reference2", "Placement2")?;
        let is_taken =
            |name: &str| self.draft.joint(name).is_some() || self.draft.is_coupling(name);
        let name = unique(self.document, joint, is_taken)?;
        let drawn = DrawnJoints::new(&self.draft.descriptions, &self.poses);
        let coupling =
            |a: &PlacedFrame, b: &PlacedFrame| drawn.coupling(name.clone(), part_coupling, [a, b]);
        let found = match part_coupling {
            // Either part may be the rack, which slides along z of its frame.
            PartCoupling::Rack(_) => coupling(&rack_frame(&first, &second), &second)
                .or_else(|_| coupling(&rack_frame(&second, &first), &first)),
            _ => coupling(&first, &second),
        };
        let coupling = found.map_err(|advice| {
            let what = format!("joint {name:?}");
            self.document.xml.unsupported(joint.node, what, Advice(advice))
        })?;
        self.draft.add_coupling(coupling, place(joint.node));
        Ok(())
    }

    fn add(
        &mut self,
        object: &'d Object<'a>,
        kind: JointKind,
        frames: [&PlacedFrame; 2],
        limits: &[FrameLimit],
    ) -> Result<(), Error> {
        let name = unique(self.document, object, |name| self.draft.joint(name).is_some())?;
        self.joints.insert(object.name, self.draft.descriptions.len());
        let mut ignore = |what| self.draft.ignore(what);
        let mut joint = placed_joint(name, kind, frames, &mut ignore);
        joint_limits::apply(&mut joint, limits, &mut ignore);
        self.draft.add_joint(joint, place(object.node))
    }

    /// A simulated motion makes the motor of its joint.
    fn add_motion(&mut self, motion: &'d Object<'a>) -> Result<(), Error> {
        let label = self.document.label(motion)?;
        let Some(joint) = self.document.link(motion, "Joint")? else {
            self.draft.ignore(format!("motion {label:?}, which has no joint"));
            return Ok(());
        };
        let driven = match self.document.choice(motion, "MotionType", &["Angular", "Linear"])? {
            "Angular" => JointKind::Revolute,
            _ => JointKind::Prismatic,
        };
        let found = self.joints.get(joint.name).copied();
        match found.map(|number| &mut self.draft.descriptions[number]) {
            Some(joint) if joint.kind == driven => joint.actuated = true,
            _ => self.draft.ignore(format!("motion {label:?}")),
        }
        Ok(())
    }

    /// The frame of a joint in the part that it moves.
    fn frame(
        &mut self,
        joint: &'d Object<'a>,
        reference: &'static str,
        placement: &'static str,
    ) -> Result<PlacedFrame, Error> {
        let found = self.document.reference(joint, reference)?;
        let found = found.ok_or_else(|| self.document.missing(joint, reference))?;
        let Resolved { part, part_from_object } = self.resolve(&found)?;
        let in_link = part_from_object * self.document.placement(joint, placement)?;
        let drawn = self.document.placement(part, "Placement")? * in_link;
        Ok(PlacedFrame { link: self.add_part(part)?, in_link, drawn })
    }

    /// Finds the part that a reference moves, and the object in whose frame it is.
    fn resolve(&self, reference: &Reference<'a>) -> Result<Resolved<'d, 'a>, Error> {
        let document = self.document;
        let refuse = |what: String, advice| {
            Err(document.xml.unsupported(reference.node, what, Advice(advice)))
        };
        let names = || [&[reference.object], &reference.path[..]].concat().join(".");
        if !reference.file.is_empty() {
            let advice = "joints refer to the assembly of the same file";
            return refuse(format!("a reference to the file {:?}", reference.file), advice);
        }
        let (mut is_inside, mut is_external) = (false, false);
        let mut found: Option<Resolved> = None;
        let mut path = std::iter::once(&reference.object).chain(&reference.path).peekable();
        while let Some(name) = path.next() {
            if is_external {
                let advice = "parts inside of parts are read from the same file only; export the assembly from FreeCAD as ASMT";
                return refuse(format!("the place {} in a part of another file", names()), advice);
            }
            let Some(object) = document.object(name) else {
                let advice = "links to several elements are not read; export the assembly from FreeCAD as ASMT";
                return refuse(format!("the place {}, without object {name:?},", names()), advice);
            };
            if object.name == self.assembly.name {
                is_inside = true;
                continue;
            }
            if !is_inside || is_group(object) {
                continue;
            }
            match &mut found {
                None => {
                    if object.kind == SUB_ASSEMBLY && document.flag(object, "Rigid")? == Some(false)
                    {
                        let advice = "make the sub-assembly rigid, or export the assembly from FreeCAD as ASMT";
                        return refuse(format!("the flexible sub-assembly {name:?}"), advice);
                    }
                    let part_from_object = Pose::identity();
                    found = Some(Resolved { part: object, part_from_object });
                }
                Some(resolved) => {
                    resolved.part_from_object *= document.placement(object, "Placement")?;
                }
            }
            match end_of(document, object, path.peek().copied())? {
                PathEnd::Here => break,
                PathEnd::Inside => {}
                PathEnd::OtherFile => is_external = true,
            }
        }
        let Some(found) = found else {
            let advice = "the parts of joints are in the assembly";
            return refuse(format!("the place {}", names()), advice);
        };
        Ok(found)
    }

    fn add_part(&mut self, part: &'d Object<'a>) -> Result<usize, Error> {
        if let Some(&link) = self.parts.get(part.name) {
            return Ok(link);
        }
        let name = unique(self.document, part, |name| self.draft.link(name).is_some())?;
        let link = self.draft.add_link(name, place(part.node))?;
        self.parts.insert(part.name, link);
        self.poses.push(self.document.placement(part, "Placement")?);
        Ok(link)
    }

    /// Limits of a joint that are switched on.
    fn limits(&self, joint: &'d Object<'a>, kind: JointKind) -> Result<Vec<FrameLimit>, Error> {
        use FrameMotion::{Slide, Turn};
        let mut limits = Vec::new();
        let kinds: &[_] = match kind {
            JointKind::Revolute => &[Turn],
            JointKind::Prismatic => &[Slide],
            JointKind::Cylindrical => &[Slide, Turn],
            _ => &[],
        };
        for &motion in kinds {
            let (least, greatest, enabled) = match motion {
                Slide => ("LengthMin", "LengthMax", ["EnableLengthMin", "EnableLengthMax"]),
                Turn => ("AngleMin", "AngleMax", ["EnableAngleMin", "EnableAngleMax"]),
            };
            let value = |name| {
                let value = self.document.number(joint, name)?;
                let si = match motion {
                    Slide => UNIT.to_meters(value),
                    Turn => value.to_radians(),
                };
                Ok::<f64, Error>(si)
            };
            let is_on = |name| Ok::<_, Error>(self.document.flag(joint, name)? == Some(true));
            let ends = match [is_on(enabled[0])?, is_on(enabled[1])?] {
                // FreeCAD exchanges reversed limits.
                [true, true] => {
                    let (a, b) = (value(least)?, value(greatest)?);
                    vec![(RangeEnd::Least, a.min(b)), (RangeEnd::Greatest, a.max(b))]
                }
                [true, false] => vec![(RangeEnd::Least, value(least)?)],
                [false, true] => vec![(RangeEnd::Greatest, value(greatest)?)],
                [false, false] => Vec::new(),
            };
            limits.extend(ends.into_iter().map(|(end, value)| FrameLimit { motion, end, value }));
        }
        Ok(limits)
    }
}

/// The label of an object, with the name in the file where the label is taken.
fn unique(
    document: &Document,
    object: &Object,
    is_taken: impl Fn(&str) -> bool,
) -> Result<String, Error> {
    let label = document.label(object)?;
    if !is_taken(&label) {
        return Ok(label);
    }
    let name = format!("{label} ({})", object.name);
    let numbered = (2..).map(|number| format!("{name} ({number})"));
    let mut names = std::iter::once(name.clone()).chain(numbered);
    Ok(names.find(|name| !is_taken(name)).expect("names are finitely many"))
}
