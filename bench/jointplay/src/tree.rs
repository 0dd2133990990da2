//! Mechanisms in the form that other programs read.

use std::f64::consts::FRAC_PI_2;
use std::fmt::Write as _;

use jointplay::mechanism::{JointKind, Kinematics, Mechanism};
use jointplay::nalgebra::{DVector, Rotation3, Translation3, UnitQuaternion, Vector3};
use jointplay::spatial::Pose;

/// Bodies that hang on each other by simple joints, depth first, and what closes the loops.
///
/// A body's frame is that of the joint it hangs on; joints move about or along z, balls about their centre.
/// A universal joint is two turns with a body between them; where it closes a loop, the second turn closes it.
pub(crate) struct Tree {
    bodies: Vec<Body>,
    cuts: Vec<Cut>,
}

struct Body {
    /// Index of the body it hangs on, −1 for the base.
    parent: isize,
    /// `R`, `P` or `S`.
    kind: char,
    in_parent: Pose,
    /// Its first coordinate in the mechanism.
    coordinate: usize,
    /// −1 where the tree passes the joint against its sense.
    sense: f64,
}

struct Cut {
    /// `R` or `S`.
    kind: char,
    /// Two bodies, and the joint's frame on each.
    sides: [(isize, Pose); 2],
}

/// Where a link is: the body that carries it, and the link's frame in that body's.
type Placed = Option<(isize, Pose)>;

impl Tree {
    pub(crate) fn of(mechanism: &Mechanism) -> Self {
        let kinematics = Kinematics::new(mechanism);
        let mut placed: Vec<Placed> = vec![None; mechanism.links().len()];
        placed[0] = Some((-1, Pose::identity()));
        let mut tree = Self { bodies: Vec::new(), cuts: Vec::new() };
        let mut halves = vec![None; mechanism.joints().len()];
        tree.grow(&kinematics, 0, &mut placed, &mut halves);
        for &j in kinematics.closing_joints() {
            let joint = &mechanism.joints()[j];
            let on = |side: usize| {
                let (body, link) = placed[joint.links[side]].expect("the tree reaches every link");
                (body, link * joint.frames[side])
            };
            let (kind, sides) = match (joint.kind, halves[j]) {
                (JointKind::Universal, Some(half)) => {
                    let (body, frame) = on(1);
                    ('R', [(half, to_x()), (body, frame * to_x())])
                }
                (kind, _) => (parts(kind)[0], [on(0), on(1)]),
            };
            tree.cuts.push(Cut { kind, sides });
        }
        tree
    }

    /// Adds all that hangs on a link.
    fn grow(
        &mut self,
        kinematics: &Kinematics<'_>,
        link: usize,
        placed: &mut Vec<Placed>,
        halves: &mut Vec<Option<isize>>,
    ) {
        let (body, link_in_body) = placed[link].expect("what something hangs on is placed");
        for (j, joint) in kinematics.mechanism().joints().iter().enumerate() {
            let Some(near) = joint.links.iter().position(|&other| other == link) else { continue };
            let (far, first) = (joint.links[1 - near], kinematics.coordinates_of(j).start);
            let start = link_in_body * joint.frames[near];
            if kinematics.closing_joints().contains(&j) {
                if joint.kind == JointKind::Universal && near == 0 {
                    halves[j] = Some(self.push(body, 'R', start, first, 1.0));
                }
                continue;
            }
            if placed[far].is_some() {
                continue;
            }
            let sense = if near == 1 { -1.0 } else { 1.0 };
            let kinds = parts(joint.kind);
            let mut carrier = self.push(body, kinds[0], start, first, sense);
            let mut back = Pose::identity();
            if kinds.len() == 2 {
                assert!(near == 0, "a universal joint of the tree is passed in its sense");
                carrier = self.push(carrier, kinds[1], to_x(), first + 1, sense);
                back = to_x().inverse();
            }
            placed[far] = Some((carrier, back * joint.frames[1 - near].inverse()));
            self.grow(kinematics, far, placed, halves);
        }
    }

    fn push(
        &mut self,
        parent: isize,
        kind: char,
        in_parent: Pose,
        coordinate: usize,
        sense: f64,
    ) -> isize {
        self.bodies.push(Body { parent, kind, in_parent, coordinate, sense });
        self.bodies.len() as isize - 1
    }

    /// Coordinates of the bodies in turn: a number for a turn or slide, a quaternion (w, x, y, z) for a ball.
    pub(crate) fn values(&self, coordinates: &DVector<f64>) -> Vec<f64> {
        let mut values = Vec::new();
        for &Body { kind, coordinate, sense, .. } in &self.bodies {
            if kind == 'S' {
                let vector: Vector3<f64> = coordinates.fixed_rows::<3>(coordinate) * sense;
                let q = UnitQuaternion::from_scaled_axis(vector);
                values.extend([q.w, q.i, q.j, q.k]);
            } else {
                values.push(coordinates[coordinate] * sense);
            }
        }
        values
    }

    /// Counts; a line for each body and each cut; what counts as closed; a line for each configuration.
    pub(crate) fn text(
        &self,
        driven: &[usize],
        gap: f64,
        configurations: &[DVector<f64>],
    ) -> String {
        let mut lines = vec![format!("{} {}", self.bodies.len(), self.cuts.len())];
        for Body { parent, kind, in_parent, coordinate, .. } in &self.bodies {
            let driven = u8::from(driven.contains(coordinate));
            lines.push(format!("{parent} {kind} {driven}{}", frame(in_parent)));
        }
        for Cut { kind, sides: [(first, on_first), (second, on_second)] } in &self.cuts {
            let frames = [frame(on_first), frame(on_second)].concat();
            lines.push(format!("{kind} {first} {second}{frames}"));
        }
        lines.push(format!("{gap} {}", configurations.len()));
        for configuration in configurations {
            let numbers = self.values(configuration);
            lines.push(numbers.iter().map(f64::to_string).collect::<Vec<_>>().join(" "));
        }
        lines.join("\n") + "\n"
    }
}

/// Turns z to x: where the second turn of a universal joint is about.
fn to_x() -> Pose {
    let turn = Rotation3::from_axis_angle(&Vector3::y_axis(), FRAC_PI_2);
    Pose::from_parts(Translation3::identity(), turn)
}

fn parts(kind: JointKind) -> Vec<char> {
    match kind {
        JointKind::Revolute => vec!['R'],
        JointKind::Prismatic => vec!['P'],
        JointKind::Spherical => vec!['S'],
        JointKind::Universal => vec!['R', 'R'],
        other => panic!("no mechanism here has a {} joint", other.name()),
    }
}

/// Three rows of a rotation, then the point.
fn frame(frame: &Pose) -> String {
    let rows = frame.rotation.matrix().transpose();
    let mut text = String::new();
    for number in rows.iter().chain(frame.translation.vector.iter()) {
        write!(text, " {number}").expect("text grows");
    }
    text
}
