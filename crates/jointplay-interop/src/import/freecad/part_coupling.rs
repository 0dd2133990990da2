//! Gears, belts, racks and screws between parts of an assembly, as couplings of the joints that carry the parts.
//!
//! FreeCAD constrains the angle or the distance of one part relative to the other.
//! Where both move on joints of one carrier, that is a linear relation between the coordinates of these joints.

use std::f64::consts::TAU;

use jointplay_core::mechanism::{Coupling, Joint, JointCoordinate, JointKind};
use jointplay_core::spatial::Pose;
use nalgebra::{Matrix3, Point3, Rotation3, UnitVector3, Vector3};

use super::placed_joint::PlacedFrame;

/// Largest deviation of a direction from parallel or perpendicular, and of an axis from a point as a share of its distance: files have rounded numbers.
const ALIGNED: f64 = 1e-5;

/// A constraint between the motions of two parts.
#[derive(Debug, Clone, Copy)]
pub(super) enum PartCoupling {
    /// Angles about z of either frame: `radius 1 · angle 1 + radius 2 · angle 2` stays; one radius is negative for a belt.
    Gears([f64; 2]),
    /// The first part slides along x of its frame by the radius (m) for each radian of the second about z of the first frame.
    Rack(f64),
    /// The second part advances along z of the first frame by the lead (m) for each turn.
    Screw(f64),
}

/// A part that a joint carries.
struct Carried<'j> {
    number: usize,
    joint: &'j Joint,
    carrier: usize,
    /// 1 where the joint leads from the carrier to the part, otherwise −1.
    sense: f64,
}

/// A motion of a carried part against its carrier, for a unit of one coordinate.
struct CarriedMotion {
    coordinate: JointCoordinate,
    /// Value of the coordinate as drawn (m, rad).
    drawn: f64,
    /// Unit vector along which the part moves, or about which it turns, in the assembly.
    axis: Vector3<f64>,
    /// A point of the axis of a turn, in the assembly (m).
    turns_about: Option<Point3<f64>>,
}

/// The joints of an assembly, as drawn.
pub(super) struct DrawnJoints<'j> {
    joints: &'j [Joint],
    /// Pose of each link in the assembly.
    poses: &'j [Pose],
    /// For each link the first of those that are fixed to each other.
    rigid: Vec<usize>,
}

impl<'j> DrawnJoints<'j> {
    pub(super) fn new(joints: &'j [Joint], poses: &'j [Pose]) -> Self {
        let mut rigid: Vec<usize> = (0..poses.len()).collect();
        let fixed = joints.iter().filter(|joint| joint.kind == JointKind::Fixed);
        for joint in fixed {
            let [kept, merged] = joint.links.map(|link| rigid[link]);
            rigid.iter_mut().filter(|body| **body == merged).for_each(|body| *body = kept);
        }
        Self { joints, poses, rigid }
    }

    /// The coupling that a constraint between two frames is.
    ///
    /// # Errors
    /// Advice for a constraint that is incomplete.
    pub(super) fn coupling(
        &self,
        name: String,
        part_coupling: PartCoupling,
        ends: [&PlacedFrame; 2],
    ) -> Result<Coupling, &'static str> {
        let terms = match part_coupling {
            PartCoupling::Gears(radii) => self.gears(radii, ends)?,
            PartCoupling::Rack(radius) => self.rack(radius, ends)?,
            PartCoupling::Screw(lead) => self.screw(lead, ends)?,
        };
        coupled(name, &terms).ok_or("its radius or pitch must be a number other than 0")
    }

    /// Joints that carry a part.
    fn carriers(&self, link: usize) -> impl Iterator<Item = Carried<'j>> + '_ {
        let body = self.rigid[link];
        self.joints.iter().enumerate().filter_map(move |(number, joint)| {
            let [first, second] = joint.links.map(|link| self.rigid[link]);
            if first == second {
                None
            } else if second == body {
                Some(Carried { number, joint, carrier: first, sense: 1.0 })
            } else if first == body {
                Some(Carried { number, joint, carrier: second, sense: -1.0 })
            } else {
                None
            }
        })
    }

    /// Motions that a joint gives a part, of those joints that turn about one axis and slide along it.
    fn motions(&self, carried: &Carried) -> Option<Vec<CarriedMotion>> {
        let Carried { number, joint, sense, .. } = *carried;
        let frame = self.poses[joint.links[0]] * joint.frames[0];
        let axis = frame.rotation * Vector3::z() * sense;
        let point = Point3::from(frame.translation.vector);
        let turns: &[bool] = match joint.kind {
            JointKind::Revolute => &[true],
            JointKind::Prismatic => &[false],
            JointKind::Cylindrical => &[false, true],
            _ => return None,
        };
        let motion = |(freedom, &turns): (usize, &bool)| CarriedMotion {
            coordinate: JointCoordinate { joint: number, freedom },
            drawn: joint.guess.get(freedom).copied().unwrap_or(0.0),
            axis,
            turns_about: turns.then_some(point),
        };
        Some(turns.iter().enumerate().map(motion).collect())
    }

    /// Pairs of joints that carry two parts on one carrier.
    fn pairs(
        &self,
        links: [usize; 2],
    ) -> impl Iterator<Item = [Vec<CarriedMotion>; 2]> + use<'_, 'j> {
        let second: Vec<Carried> = self.carriers(links[1]).collect();
        self.carriers(links[0])
            .flat_map(move |first| {
                let same = second.iter().filter(|other| other.carrier == first.carrier);
                same.map(|other| Some([self.motions(&first)?, self.motions(other)?]))
                    .collect::<Vec<_>>()
            })
            .flatten()
    }

    /// Both gears turn about z of their frames, against one carrier.
    fn gears(&self, radii: [f64; 2], ends: [&PlacedFrame; 2]) -> Result<Vec<Term>, &'static str> {
        let centers = ends.map(center);
        let axes = ends.map(z);
        let turn = |side: usize, motions: &[CarriedMotion]| {
            let axis = axes[side];
            // A center that slides across the other gear would turn the line of the centers.
            let stays = |one: &CarriedMotion| {
                one.turns_about.is_some() || axes.iter().all(|&axis| parallel(one.axis, axis))
            };
            if !motions.iter().all(stays) {
                return None;
            }
            let is_about = |one: &&CarriedMotion| {
                one.turns_about.is_some() && one.leaves(centers[side]) && parallel(one.axis, axis)
            };
            let found = motions.iter().find(is_about)?;
            Some(found.term(radii[side] * found.axis.dot(&axis)))
        };
        let mut found = self
            .pairs(ends.map(|end| end.link))
            .filter_map(|[first, second]| Some(vec![turn(0, &first)?, turn(1, &second)?]));
        let terms = found.next().ok_or(
            "its two parts must turn about z of its frames, on revolute or cylindrical joints of one other part",
        )?;
        // The angles are those between the line of the centers and the parts.
        let apart = centers[1] - centers[0];
        if axes.iter().any(|axis| apart.cross(axis).norm() <= ALIGNED * apart.norm()) {
            return Err("the axes of its two parts must be apart");
        }
        Ok(terms)
    }

    /// The rack slides, and the pinion turns about its own axis.
    fn rack(&self, radius: f64, ends: [&PlacedFrame; 2]) -> Result<Vec<Term>, &'static str> {
        let along = ends[0].drawn.rotation * Vector3::x();
        let (axis, pinion) = (z(ends[0]), center(ends[1]));
        let terms = |[rack, motions]: [Vec<CarriedMotion>; 2]| {
            let [slide] = rack.as_slice() else { return None };
            let turn = motions.iter().find(|one| one.turns_about.is_some())?;
            // The pinion may slide along its axis.
            let fits = slide.turns_about.is_none()
                && parallel(slide.axis, along)
                && parallel(turn.axis, axis)
                && turn.leaves(pinion);
            // What moves is the frame of the rack, against which the pinion is measured.
            let slid = slide.term(-slide.axis.dot(&along));
            fits.then(|| vec![slid, turn.term(radius * turn.axis.dot(&axis))])
        };
        let mut found = self.pairs(ends.map(|end| end.link)).filter_map(terms);
        found.next().ok_or(
            "one of its parts must slide on a slider joint, and the other turn about its own axis, on a joint of the same third part",
        )
    }

    /// Turns and slides along the axis, of either part against one carrier or of one against the other.
    fn screw(&self, lead: f64, ends: [&PlacedFrame; 2]) -> Result<Vec<Term>, &'static str> {
        let axis = z(ends[0]);
        let terms = |motions: &[CarriedMotion], sense: f64| {
            let fits = motions.iter().all(|one| parallel(one.axis, axis));
            let term = |one: &CarriedMotion| {
                let share = if one.turns_about.is_some() { -lead } else { TAU };
                one.term(sense * share * one.axis.dot(&axis))
            };
            fits.then(|| motions.iter().map(term).collect::<Vec<_>>())
        };
        let links = ends.map(|end| end.link);
        let between = self
            .carriers(links[1])
            .filter(|one| one.carrier == self.rigid[links[0]])
            .filter_map(|one| terms(&self.motions(&one)?, 1.0));
        let apart = self.pairs(links).filter_map(|[first, second]| {
            Some([terms(&first, -1.0)?, terms(&second, 1.0)?].concat())
        });
        let mut found = between.chain(apart).filter(|terms| terms.len() == 2);
        found.next().ok_or(
            "its parts need one cylindrical joint between them, or a slider and a revolute joint on one other part, along z of its frames",
        )
    }
}

/// A coordinate with its value as drawn, and its factor in a sum that stays.
#[derive(Clone, Copy)]
struct Term {
    coordinate: JointCoordinate,
    drawn: f64,
    factor: f64,
}

impl CarriedMotion {
    fn term(&self, factor: f64) -> Term {
        Term { coordinate: self.coordinate, drawn: self.drawn, factor }
    }

    /// Whether the axis of a turn passes through a point.
    fn leaves(&self, point: Point3<f64>) -> bool {
        self.turns_about.is_some_and(|on_axis| {
            let apart = point - on_axis;
            let scale = point.coords.norm().max(on_axis.coords.norm());
            apart.cross(&self.axis).norm() <= ALIGNED * scale.max(f64::MIN_POSITIVE)
        })
    }
}

/// The last coordinate follows the others, such that the sum stays as drawn.
fn coupled(name: String, terms: &[Term]) -> Option<Coupling> {
    let (last, others) = terms.split_last()?;
    let ratios = others.iter().map(|one| (one.coordinate, -one.factor / last.factor));
    let ratios: Vec<_> = ratios.collect();
    let sum: f64 = others.iter().zip(&ratios).map(|(one, (_, ratio))| one.drawn * ratio).sum();
    let is_usable = ratios.iter().all(|(_, ratio)| ratio.is_finite() && *ratio != 0.0);
    let follower = last.coordinate;
    is_usable.then_some(Coupling { name, follower, terms: ratios, offset: last.drawn - sum })
}

/// The frame of a rack: x is along z of the frame of its joint, z is that of the pinion.
pub(super) fn rack_frame(rack: &PlacedFrame, pinion: &PlacedFrame) -> PlacedFrame {
    let axes = [rack, pinion].map(|frame| frame.drawn.rotation * Vector3::z());
    let along = axes[0] - axes[1] * axes[0].dot(&axes[1]);
    let across = UnitVector3::try_new(along, 1e-9);
    let turned = across.map_or_else(Rotation3::identity, |x| {
        let z = UnitVector3::new_normalize(axes[1]);
        let matrix = Matrix3::from_columns(&[x.into_inner(), z.cross(&x), z.into_inner()]);
        rack.drawn.rotation.inverse() * Rotation3::from_matrix_unchecked(matrix)
    });
    rack.turned(turned)
}

fn center(frame: &PlacedFrame) -> Point3<f64> {
    frame.drawn.translation.vector.into()
}

fn z(frame: &PlacedFrame) -> Vector3<f64> {
    frame.drawn.rotation * Vector3::z()
}

fn parallel(a: Vector3<f64>, b: Vector3<f64>) -> bool {
    a.cross(&b).norm() <= ALIGNED
}
