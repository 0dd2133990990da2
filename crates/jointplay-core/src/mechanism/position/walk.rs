//! Chains of joints laid out for fast evaluation: every turn about the z of a frame, every fixed displacement merged into the next.

use nalgebra::{Matrix3, Rotation3, Translation3, Vector3};

use super::frame::Frame;
use crate::mechanism::joint::Factor;
use crate::mechanism::kinematics::{Chain, Element};
use crate::spatial::{Pose, tilt_rotation};

/// Displacements that differ from none by less than this are none: round-off of their making.
const NOTHING: f64 = 1e-15;

/// A fixed displacement, as simple as it is.
#[derive(Debug, Clone, Copy)]
pub(super) enum Lead {
    Nothing,
    Shift(Vector3<f64>),
    Frame(Frame),
}

impl Lead {
    #[inline(always)]
    fn displace(&self, frame: &mut Frame) {
        match self {
            Self::Nothing => {}
            Self::Shift(shift) => frame.shift(shift),
            Self::Frame(by) => *frame = frame.displaced(by),
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

/// An elementary motion.
#[derive(Debug, Clone, Copy)]
pub(super) enum Motion {
    /// About z: which of the turns.
    Turn(usize),
    /// Along a direction.
    Slide(Vector3<f64>),
    /// About z: which of the turns, and the advance along it for one radian (m/rad).
    Screw(usize, f64),
    /// Any rotation: which of the balls.
    Ball(usize),
}

/// A fixed displacement, then an elementary motion.
#[derive(Debug, Clone, Copy)]
pub(super) struct Step {
    pub(super) lead: Lead,
    pub(super) motion: Motion,
    pub(super) coordinate: usize,
    /// −1 where walked against the sense of the coordinate.
    pub(super) sign: f64,
    /// Its first column among the unknowns, if it is one.
    pub(super) column: Option<usize>,
}

/// Elementary motions one after the other, and a fixed displacement at the end.
#[derive(Debug, Clone)]
pub(super) struct Walk {
    pub(super) steps: Vec<Step>,
    pub(super) tail: Lead,
}

/// The screws of an elementary motion.
#[derive(Debug, Clone)]
pub(super) struct Recorded {
    pub(super) columns: std::ops::Range<usize>,
    /// Whether they move with the frame behind the motion, not with the one before it.
    pub(super) behind: bool,
}

/// Which elements of a joint are evaluated, and in which sense.
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
    /// Lays out a part of a chain up to its last motion; returns what follows as a pose behind it.
    ///
    /// # Arguments
    /// * `start` – the frame of the first link, in the one from which it is walked
    /// * `column`, `ball` – index of a coordinate among unknowns and balls
    /// * `turns` – number of turns so far
    pub(super) fn new(
        chain: &Chain,
        part: Part,
        start: &Pose,
        column: impl Fn(usize) -> Option<usize>,
        ball: impl Fn(usize) -> usize,
        turns: &mut usize,
    ) -> (Self, Pose) {
        let count = chain.elements.len();
        let (elements, against): (&[Element], bool) = match part {
            Part::Forward => (&chain.elements, false),
            Part::Backward => (&chain.elements, true),
            Part::Before(end) => (&chain.elements[..end], false),
            Part::From(first) => (&chain.elements[first..], true),
        };
        let (mut steps, mut pending) = (Vec::new(), *start);
        let mut turn = || std::mem::replace(turns, *turns + 1);
        let mut push = |pending: &mut Pose, element: &Element| {
            let (to_z, motion) = match element.factor {
                Factor::Turn { axis, point } => (along_z(&axis, &point), Motion::Turn(turn())),
                Factor::Slide { axis } => (Pose::identity(), Motion::Slide(axis.into_inner())),
                Factor::Screw { lead } => (Pose::identity(), Motion::Screw(turn(), lead)),
                Factor::Ball => (Pose::identity(), Motion::Ball(ball(element.coordinate))),
            };
            steps.push(Step {
                lead: lead(&(*pending * to_z)),
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
        (Self { steps, tail: Lead::Nothing }, pending)
    }

    /// The same, with a displacement behind the last motion.
    pub(super) fn with_tail(self, pose: &Pose) -> Self {
        Self { tail: lead(pose), ..self }
    }

    /// Takes the displacement before the first motion off the chain; the frame that it leads to from the base.
    pub(super) fn begin(&mut self) -> Frame {
        let lead = self.steps.first_mut().map_or(&mut self.tail, |step| &mut step.lead);
        let mut frame = Frame::BASE;
        std::mem::replace(lead, Lead::Nothing).displace(&mut frame);
        frame
    }

    /// Columns of the unknowns in the chain.
    pub(super) fn columns(&self) -> impl Iterator<Item = usize> + '_ {
        self.steps.iter().flat_map(|step| {
            let count = if matches!(step.motion, Motion::Ball(_)) { 3 } else { 1 };
            step.column.into_iter().flat_map(move |first| first..first + count)
        })
    }

    /// The recorded screws in the order of the chain: of each motion its columns, and whether they turn with the frame behind it.
    pub(super) fn recorded(&self) -> impl Iterator<Item = Recorded> + '_ {
        self.steps.iter().filter_map(|step| {
            let first = step.column?;
            let is_ball = matches!(step.motion, Motion::Ball(_));
            let columns = first..first + if is_ball { 3 } else { 1 };
            Some(Recorded { columns, behind: is_ball && step.sign > 0.0 })
        })
    }

    /// The frame behind the chain, from the one before it; records the screws of the unknowns.
    #[inline]
    pub(super) fn follow(
        &self,
        start: &Frame,
        coordinates: &[f64],
        balls: &[Matrix3<f64>],
        turns: &mut [Turned],
        screws: &mut [Screw],
    ) -> Frame {
        let mut frame = *start;
        for step in &self.steps {
            step.lead.displace(&mut frame);
            match step.motion {
                Motion::Turn(turn) | Motion::Screw(turn, _) => {
                    let angle = step.sign * coordinates[step.coordinate];
                    let lead = match step.motion {
                        Motion::Screw(_, lead) => lead,
                        _ => 0.0,
                    };
                    if let Some(column) = step.column {
                        let angular = frame.axis(2) * step.sign;
                        screws[column] =
                            Screw { angular, linear: angular * lead, at: frame.origin() };
                    }
                    frame.advance_along_z(lead * angle);
                    let turned = &mut turns[turn];
                    turned.to(angle);
                    frame.turn_about_z(turned.sine, turned.cosine);
                }
                Motion::Slide(axis) => {
                    if let Some(column) = step.column {
                        let linear = frame.direction(&axis) * step.sign;
                        screws[column] = Screw { linear, ..Screw::STILL };
                    }
                    frame.advance(&axis, step.sign * coordinates[step.coordinate]);
                }
                Motion::Ball(ball) => {
                    let forward = step.sign > 0.0;
                    let before = frame;
                    let turn = &balls[ball];
                    frame.turn(&if forward { *turn } else { turn.transpose() });
                    if let Some(column) = step.column {
                        // The axes of the side that the ball's coordinates turn.
                        let turning = if forward { &frame } else { &before };
                        for (k, screw) in screws[column..column + 3].iter_mut().enumerate() {
                            let angular = turning.axis(k) * step.sign;
                            *screw =
                                Screw { angular, linear: Vector3::zeros(), at: frame.origin() };
                        }
                    }
                }
            }
        }
        self.tail.displace(&mut frame);
        frame
    }
}

/// Angles below this have sine and cosine to round-off by a few terms of their series.
const SMALL: f64 = 0.05;

/// A turn, and its sine and cosine.
#[derive(Debug, Clone, Copy)]
pub(super) struct Turned {
    angle: f64,
    sine: f64,
    cosine: f64,
    /// Whether by trigonometry, not by small steps since.
    exact: bool,
    /// Whether nothing before may count: the next angle is turned to by trigonometry.
    afresh: bool,
}

impl Turned {
    pub(super) const NONE: Self =
        Self { angle: 0.0, sine: 0.0, cosine: 1.0, exact: true, afresh: true };

    /// Forgets all that round-off of small steps is in, or would be: it neither adds up, nor do answers depend on what was asked before.
    pub(super) fn refresh(&mut self) {
        self.afresh = true;
        if !self.exact {
            self.angle = f64::NAN;
        }
    }

    /// Turns to another angle; small steps take no trigonometry.
    #[inline(always)]
    fn to(&mut self, angle: f64) {
        let step = angle - self.angle;
        let afresh = std::mem::replace(&mut self.afresh, false);
        if step == 0.0 {
            return;
        }
        self.exact = afresh || step.abs().partial_cmp(&SMALL) != Some(std::cmp::Ordering::Less);
        if self.exact {
            (self.sine, self.cosine) = angle.sin_cos();
        } else {
            let square = step * step;
            let less = |share: f64, rest: f64| 1.0 - square * share * rest;
            let sine =
                step * less(1.0 / 6.0, less(1.0 / 20.0, less(1.0 / 42.0, less(1.0 / 72.0, 1.0))));
            let versine = 0.5 * square * less(1.0 / 12.0, less(1.0 / 30.0, less(1.0 / 56.0, 1.0)));
            (self.sine, self.cosine) = (
                self.sine - self.sine * versine + self.cosine * sine,
                self.cosine - self.cosine * versine - self.sine * sine,
            );
        }
        self.angle = angle;
    }
}

/// A frame at a point with its z along an axis.
fn along_z(axis: &Vector3<f64>, point: &Vector3<f64>) -> Pose {
    let rotation = if axis.z > -0.5 {
        tilt_rotation(axis)
    } else {
        // Seen upside down: a half turn has no direction.
        let flip = Rotation3::from_axis_angle(&Vector3::x_axis(), std::f64::consts::PI);
        flip * tilt_rotation(&(flip.inverse() * axis))
    };
    Pose::from_parts(Translation3::from(*point), rotation)
}

fn lead(pose: &Pose) -> Lead {
    let rotation = *pose.rotation.matrix();
    let origin = pose.translation.vector;
    if (rotation - Matrix3::identity()).amax() > NOTHING {
        Lead::Frame(Frame::new(&rotation, &origin))
    } else if origin.amax() > 0.0 {
        Lead::Shift(origin)
    } else {
        Lead::Nothing
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn small_steps_of_a_turn_lead_where_trigonometry_does() {
        let mut turned = Turned::NONE;
        let mut angle = 0.0;
        for step in [0.3, 0.049, -0.02, 1e-3, -1e-9, 0.05, -2.0, 0.0499] {
            angle += step;
            turned.to(angle);
            assert!((turned.sine - angle.sin()).abs() < 1e-15, "{angle}");
            assert!((turned.cosine - angle.cos()).abs() < 1e-15, "{angle}");
        }
        assert!(!turned.exact);
        turned.refresh();
        turned.to(angle);
        assert!(turned.exact && turned.sine == angle.sin());
    }
}
