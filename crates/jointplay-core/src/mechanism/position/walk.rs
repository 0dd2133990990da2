//! Chains of joints laid out for walking fast: every turn about the z of a frame, every fixed displacement folded into the next.

use nalgebra::{Matrix3, Rotation3, Translation3, Vector3};

use crate::mechanism::joint::Factor;
use crate::mechanism::kinematics::{Chain, Element};
use crate::spatial::{Pose, leaning};

/// Displacements that differ from none by less than this are none: round-off of their making.
const NOTHING: f64 = 1e-15;

/// Where a frame is.
#[derive(Debug, Clone, Copy)]
pub(super) struct Frame {
    pub(super) rotation: Matrix3<f64>,
    pub(super) origin: Vector3<f64>,
}

impl Frame {
    pub(super) const BASE: Self = Self {
        rotation: Matrix3::new(1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0),
        origin: Vector3::new(0.0, 0.0, 0.0),
    };

    #[inline]
    fn displace(&mut self, by: Option<&Frame>) {
        if let Some(by) = by {
            self.origin += self.rotation * by.origin;
            self.rotation *= by.rotation;
        }
    }
}

/// How a link moves with one coordinate, in the base frame.
#[derive(Debug, Clone, Copy)]
pub(super) struct Screw {
    pub(super) angular: Vector3<f64>,
    /// Velocity of the point `at`.
    pub(super) linear: Vector3<f64>,
    pub(super) at: Vector3<f64>,
}

impl Screw {
    pub(super) const STILL: Self = Self {
        angular: Vector3::new(0.0, 0.0, 0.0),
        linear: Vector3::new(0.0, 0.0, 0.0),
        at: Vector3::new(0.0, 0.0, 0.0),
    };

    /// Velocity of a point that moves with it.
    #[inline]
    pub(super) fn velocity_of(&self, point: &Vector3<f64>) -> Vector3<f64> {
        self.linear + self.angular.cross(&(point - self.at))
    }
}

#[derive(Debug, Clone, Copy)]
enum Motion {
    /// About z.
    Turn,
    /// Along a direction.
    Slide(Vector3<f64>),
    /// About z, with an advance along it for one radian [m/rad].
    Screw(f64),
    /// Any rotation: which of the balls.
    Ball(usize),
}

/// A fixed displacement, then an elementary motion.
#[derive(Debug, Clone, Copy)]
struct Step {
    lead: Option<Frame>,
    motion: Motion,
    coordinate: usize,
    /// −1 where walked against the sense of the coordinate.
    sign: f64,
    /// Its first column among the unknowns, if it is one.
    column: Option<usize>,
}

/// Elementary motions one after the other, and a fixed displacement at the end.
#[derive(Debug, Clone)]
pub(super) struct Walk {
    steps: Vec<Step>,
    tail: Option<Frame>,
}

/// Which elements of a joint are walked, and which way.
#[derive(Debug, Clone, Copy)]
pub(super) enum Part {
    /// All, to the second link.
    Forward,
    /// All, to the first link.
    Backward,
    /// Those before an element, from the first link.
    Before(usize),
    /// Those from an element on, from the second link.
    From(usize),
}

impl Walk {
    /// Lays out a part of a chain; `column` and `ball` tell the place of a coordinate among unknowns and balls.
    pub(super) fn new(
        chain: &Chain,
        part: Part,
        column: impl Fn(usize) -> Option<usize>,
        ball: impl Fn(usize) -> usize,
    ) -> Self {
        let count = chain.elements.len();
        let (elements, against): (&[Element], bool) = match part {
            Part::Forward => (&chain.elements, false),
            Part::Backward => (&chain.elements, true),
            Part::Before(end) => (&chain.elements[..end], false),
            Part::From(first) => (&chain.elements[first..], true),
        };
        let (mut steps, mut pending) = (Vec::new(), Pose::identity());
        let mut push = |pending: &mut Pose, element: &Element| {
            let (to_z, motion) = match element.factor {
                Factor::Turn { axis, point } => (along_z(&axis, &point), Motion::Turn),
                Factor::Slide { axis } => (Pose::identity(), Motion::Slide(axis.into_inner())),
                Factor::Screw { lead } => (Pose::identity(), Motion::Screw(lead)),
                Factor::Ball => (Pose::identity(), Motion::Ball(ball(element.coordinate))),
            };
            steps.push(Step {
                lead: frame(&(*pending * to_z)),
                motion,
                coordinate: element.coordinate,
                sign: if against { -element.sign } else { element.sign },
                column: column(element.coordinate),
            });
            *pending = to_z.inverse();
        };
        if against {
            pending *= chain.end.inverse();
            for element in elements.iter().rev() {
                push(&mut pending, element);
                pending *= element.before.inverse();
            }
        } else {
            for element in elements {
                pending *= element.before;
                push(&mut pending, element);
            }
            pending *= match part {
                Part::Before(end) if end < count => chain.elements[end].before,
                Part::Before(_) => Pose::identity(),
                _ => chain.end,
            };
        }
        Self { steps, tail: frame(&pending) }
    }

    /// Columns of the unknowns on the way.
    pub(super) fn columns(&self) -> impl Iterator<Item = usize> + '_ {
        self.steps.iter().flat_map(|step| {
            let count = if matches!(step.motion, Motion::Ball(_)) { 3 } else { 1 };
            step.column.into_iter().flat_map(move |first| first..first + count)
        })
    }

    /// Moves a frame along, and notes the screws of unknowns on the way.
    #[inline]
    pub(super) fn follow(
        &self,
        frame: &mut Frame,
        coordinates: &[f64],
        turns: &[Matrix3<f64>],
        screws: &mut [Screw],
    ) {
        for step in &self.steps {
            frame.displace(step.lead.as_ref());
            match step.motion {
                Motion::Turn | Motion::Screw(_) => {
                    let angle = step.sign * coordinates[step.coordinate];
                    let z: Vector3<f64> = frame.rotation.column(2).into_owned();
                    let advance = match step.motion {
                        Motion::Screw(lead) => z * lead,
                        _ => Vector3::zeros(),
                    };
                    if let Some(column) = step.column {
                        let (angular, linear) = (z * step.sign, advance * step.sign);
                        screws[column] = Screw { angular, linear, at: frame.origin };
                    }
                    frame.origin += advance * angle;
                    turn_about_z(&mut frame.rotation, angle);
                }
                Motion::Slide(axis) => {
                    let direction = frame.rotation * axis * step.sign;
                    if let Some(column) = step.column {
                        screws[column] = Screw { linear: direction, ..Screw::STILL };
                    }
                    frame.origin += direction * coordinates[step.coordinate];
                }
                Motion::Ball(ball) => {
                    let forward = step.sign > 0.0;
                    let before = frame.rotation;
                    let turn = &turns[ball];
                    frame.rotation =
                        if forward { before * turn } else { before * turn.transpose() };
                    if let Some(column) = step.column {
                        // The axes of the side that the ball's coordinates turn.
                        let axes = if forward { &frame.rotation } else { &before };
                        for (k, axis) in axes.column_iter().enumerate() {
                            let angular = axis * step.sign;
                            screws[column + k] =
                                Screw { angular, linear: Vector3::zeros(), at: frame.origin };
                        }
                    }
                }
            }
        }
        frame.displace(self.tail.as_ref());
    }
}

#[inline]
fn turn_about_z(rotation: &mut Matrix3<f64>, angle: f64) {
    if angle == 0.0 {
        return;
    }
    let (sine, cosine) = angle.sin_cos();
    for row in 0..3 {
        let (x, y) = (rotation[(row, 0)], rotation[(row, 1)]);
        rotation[(row, 0)] = cosine * x + sine * y;
        rotation[(row, 1)] = cosine * y - sine * x;
    }
}

/// A frame at a point with its z along an axis.
fn along_z(axis: &Vector3<f64>, point: &Vector3<f64>) -> Pose {
    let rotation = if axis.z > -0.5 {
        leaning(axis)
    } else {
        // Seen upside down: leaning by a half turn has no direction.
        let flip = Rotation3::from_axis_angle(&Vector3::x_axis(), std::f64::consts::PI);
        flip * leaning(&(flip.inverse() * axis))
    };
    Pose::from_parts(Translation3::from(*point), rotation)
}

fn frame(pose: &Pose) -> Option<Frame> {
    let rotation = *pose.rotation.matrix();
    let origin = pose.translation.vector;
    let still = (rotation - Matrix3::identity()).amax() <= NOTHING && origin.amax() == 0.0;
    (!still).then_some(Frame { rotation, origin })
}
