//! Paths of all axes on which a wafer's centre moves along a straight line and its plane rotates uniformly.

use jointplay_core::spatial::{Pose, heading, wrap_angle};
use nalgebra::{DMatrix, DVector, Vector3};

use super::posture_spline::PostureSpline;
use super::quintic_interpolation::resampled_spline;
use super::spline::Spline;
use crate::CellError;
use crate::robot::EffectorJacobian;
use crate::wafer::Unreachable;

/// A straight line of a wafer, and the axes that follow it.
pub(crate) struct CartesianLine<'a> {
    /// Positions of all axes at the start of the line (m or rad).
    pub(crate) from: &'a [f64],
    /// Positions of all axes at the end of the line (m or rad).
    pub(crate) to: &'a [f64],
    /// Indices of the axes that move the effector.
    pub(crate) variables: Vec<usize>,
    /// Rotation of the effector relative to the platform from start to end, summed over the arm's joints; `None` where the motors determine the heading (rad).
    pub(crate) turn: Option<f64>,
    /// Pose of the wafer in the base frame for positions of all axes.
    pub(crate) pose: &'a dyn Fn(&[f64]) -> Result<Pose, Unreachable>,
    /// Approximate Jacobian of the wafer's pose by all axes.
    pub(crate) jacobian: &'a dyn Fn(&[f64]) -> Result<EffectorJacobian, CellError>,
    /// Largest allowed distance of the wafer's centre from the straight line (m).
    pub(crate) max_deviation: f64,
    /// Postures that the axes stay near, if other than those of the joint-space line.
    pub(crate) postures: Option<&'a PostureSpline>,
}

/// Positions of all axes along a Cartesian line, or along a joint-space line, whose length and deviations are 0.
#[derive(Debug, Clone)]
pub(crate) struct CartesianPath {
    /// Positions of all axes over the path parameter, the fraction of the line from 0 to 1.
    pub(crate) spline: Spline,
    /// Length of the line (m).
    pub(crate) length: f64,
    /// Largest distance found of the wafer's centre from the straight line (m).
    pub(crate) deviation: f64,
    /// Largest angle found between the wafer's plane and the plane that rotates uniformly (rad).
    pub(crate) plane_deviation: f64,
}

impl CartesianPath {
    /// The joint-space line between two positions of all axes.
    pub(crate) fn joint_space_line(from: &[f64], to: &[f64]) -> Self {
        let spline = Spline::straight(from, to);
        Self { spline, length: 0.0, deviation: 0.0, plane_deviation: 0.0 }
    }
}

/// A Cartesian line that the axes cannot follow.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[error("at {:.1} % of the line{}: {kind}", 100.0 * fraction, position_text(position.as_ref()))]
pub struct PathError {
    /// Fraction of the line at which the axes stop, from 0 to 1.
    pub fraction: f64,
    /// Position of the wafer's centre there on the line, in the base frame; `None` where the line is not known (m).
    pub position: Option<Vector3<f64>>,
    /// The cause.
    pub kind: PathErrorKind,
}

fn position_text(position: Option<&Vector3<f64>>) -> String {
    position.map_or_else(String::new, |p| format!(" (x {}, y {}, z {} m)", p.x, p.y, p.z))
}

/// Cause for which a Cartesian line cannot be followed.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum PathErrorKind {
    /// The pose of the wafer cannot be computed.
    #[error(transparent)]
    Pose(Box<Unreachable>),
    /// The arm is in a singular position: the effector cannot move in all directions.
    #[error("the arm is in a singular position")]
    Singular,
    /// No positions of the axes hold the wafer on the line.
    #[error(
        "the effector does not reach the line: position error {distance:.3e} m, tilt error {tilt:.3e} rad"
    )]
    NotReached {
        /// Position error of the wafer's centre (m).
        distance: f64,
        /// Angle between the planes (rad).
        tilt: f64,
        /// Heading error, where the line prescribes a heading (rad).
        heading: Option<f64>,
    },
    /// The line ends on another branch of inverse kinematics than the end positions.
    #[error(
        "the line ends on another branch of inverse kinematics than the target: axis {axis} differs by {difference:.3e} (m or rad)"
    )]
    GoalOnOtherBranch {
        /// Index of the axis with the largest difference.
        axis: usize,
        /// Difference of its position (m or rad).
        difference: f64,
    },
    /// Axis positions are discontinuous: they change to another branch of inverse kinematics.
    #[error(
        "axis positions are discontinuous: they change to another branch of inverse kinematics"
    )]
    Discontinuity,
    /// The spline does not converge to the line.
    #[error(
        "the interpolation does not converge: the wafer deviates from the line by {deviation:.3e} m with {points} points"
    )]
    NotConverged {
        /// Remaining distance from the line (m).
        deviation: f64,
        /// Number of points of the spline.
        points: usize,
    },
}

/// Number of intervals that the spline of a line starts with; intervals are divided where the spline deviates.
const INITIAL_INTERVALS: usize = 12;
/// Fractions of each interval at which the spline is verified: between the knots of the resampled spline.
const VERIFIED_FRACTIONS: [f64; 4] = [0.125, 0.375, 0.625, 0.875];
/// Largest number of intervals of the spline: a smooth line needs some dozens.
const MAX_INTERVALS: usize = 1024;
/// Width of the narrowest interval that is divided, relative to the line: a deviation within less is a discontinuity.
const MIN_INTERVAL: f64 = 1e-7;
/// Largest number of halvings of the distance to the next point.
const MAX_HALVINGS: usize = 10;
/// Residual at which a point counts as found (m or rad): a thousandth of the tolerance of inverse kinematics.
const POINT_TOLERANCE: f64 = 1e-12;
/// Number of Newton steps after which a point counts as out of reach.
const MAX_ITERATIONS: usize = 30;
/// Largest error of the stationarity conditions of a redundant arm by a Jacobian of other positions: distance of these positions times that from the reference (m² or rad²).
const STATIONARITY_TOLERANCE: f64 = 1e-10;
/// Largest Newton step of an axis: beyond it the step leads to another branch (m or rad).
const MAX_STEP: f64 = std::f64::consts::PI;
/// Residual up to which a point is accepted that does not converge further (m or rad): round-off near singular positions.
const ACCEPTED_RESIDUAL: f64 = 1e-9;
/// Largest difference of the end positions from those that the line leads to (m or rad).
const SAME_BRANCH: f64 = 1e3 * ACCEPTED_RESIDUAL;

/// A point of a path: path parameter and positions of all axes.
type PathPoint = (f64, Vec<f64>);

impl CartesianLine<'_> {
    /// Positions of all axes along the line.
    ///
    /// Where the arm is redundant, the positions at each point of the line are those nearest to a reference q_reference(s): linear interpolation of the axes between both ends, or given postures:
    ///
    /// ```text
    ///    min |q − q_reference(s)|²   subject to   center(q) = c(s),  normal(q) = n(s),  heading(q) = h(s)
    /// ```
    /// Both ends are met exactly, and the motion of an arm with redundant axes is distributed over all of them.
    /// The points are interpolated by a quintic spline, refined until it is within the allowed deviation, and resampled to a cubic one.
    ///
    /// # Errors
    /// [`PathError`]: a point cannot be reached from the one before.
    pub(crate) fn follow(&self) -> Result<CartesianPath, PathError> {
        let unknown = |fraction: f64| {
            move |error| PathError {
                fraction,
                position: None,
                kind: PathErrorKind::Pose(Box::new(error)),
            }
        };
        let start = (self.pose)(self.from).map_err(unknown(0.0))?;
        let end = (self.pose)(self.to).map_err(unknown(1.0))?;
        let target = LineTarget::new(&start, &end, self.turn);
        let mut points = vec![(0.0, self.from.to_vec())];
        for interval in 1..INITIAL_INTERVALS {
            let s = interval as f64 / INITIAL_INTERVALS as f64;
            self.continue_branch(&target, &mut points, s, MAX_HALVINGS)?;
        }
        points.push((1.0, self.to.to_vec()));
        self.check_goal(&target, &points[points.len() - 2])?;
        let mut positions = self.from.to_vec();
        loop {
            let knots: Vec<f64> = points.iter().map(|(s, _)| *s).collect();
            let values = points.iter().flat_map(|(_, positions)| positions).copied();
            let mut values = DMatrix::from_iterator(self.from.len(), points.len(), values);
            for axis in 0..self.from.len() {
                if self.is_at_rest(axis, &points) {
                    values.row_mut(axis).fill(self.from[axis]);
                }
            }
            let spline = resampled_spline(&knots, values);
            let mut added: Vec<PathPoint> = Vec::new();
            let (mut deviation, mut plane_deviation) = (0.0_f64, 0.0_f64);
            for pair in knots.windows(2) {
                let mut deviates = false;
                for fraction in VERIFIED_FRACTIONS {
                    let s = pair[0] + fraction * (pair[1] - pair[0]);
                    positions.splice(.., spline.positions(s));
                    let pose =
                        (self.pose)(&positions).map_err(|error| target.pose_error(s, error))?;
                    let (distance, angle) = target.deviation(&pose, s);
                    deviation = deviation.max(distance);
                    plane_deviation = plane_deviation.max(angle);
                    deviates |= distance > self.max_deviation;
                }
                if deviates && pair[1] - pair[0] < MIN_INTERVAL {
                    return Err(target.error(pair[0], PathErrorKind::Discontinuity));
                }
                if deviates {
                    let s = (pair[0] + pair[1]) / 2.0;
                    positions.splice(.., spline.positions(s));
                    added.push((s, self.solve(&target, s, &positions)?));
                }
            }
            if added.is_empty() {
                let length = target.displacement.norm();
                return Ok(CartesianPath { spline, length, deviation, plane_deviation });
            }
            if points.len() + added.len() > MAX_INTERVALS {
                let kind = PathErrorKind::NotConverged { deviation, points: points.len() };
                return Err(target.error(added[0].0, kind));
            }
            points.extend(added);
            points.sort_by(|a, b| a.0.total_cmp(&b.0));
        }
    }

    /// Whether an axis ends where it starts, and leaves that position between them by no more than the accuracy of the points.
    fn is_at_rest(&self, axis: usize, points: &[PathPoint]) -> bool {
        let start = self.from[axis];
        let stays = |(_, positions): &PathPoint| (positions[axis] - start).abs() < POINT_TOLERANCE;
        self.to[axis] == start && points.iter().all(stays)
    }

    /// Continues the branch from the last point to `s`, in halves where the step is too long for Newton's method.
    fn continue_branch(
        &self,
        target: &LineTarget,
        points: &mut Vec<PathPoint>,
        s: f64,
        halvings: usize,
    ) -> Result<(), PathError> {
        let (last, positions) = points.last().expect("a path starts with its first point");
        // Extrapolation from the last two points; from the first alone, along the joint-space line.
        let guess: Vec<f64> = if points.len() >= 2 {
            let (earlier, older) = &points[points.len() - 2];
            let ratio = (s - last) / (last - earlier);
            positions.iter().zip(older).map(|(new, old)| new + ratio * (new - old)).collect()
        } else {
            let mut guess: Vec<f64> = positions
                .iter()
                .zip(self.from.iter().zip(self.to))
                .map(|(position, (from, to))| position + (s - last) * (to - from))
                .collect();
            if let Some(postures) = self.postures {
                postures.apply(s, &mut guess);
            }
            guess
        };
        match self.solve(target, s, &guess) {
            Ok(found) => {
                points.push((s, found));
                Ok(())
            }
            Err(error) if halvings == 0 => Err(error),
            Err(_) => {
                let middle = (last + s) / 2.0;
                self.continue_branch(target, points, middle, halvings - 1)?;
                self.continue_branch(target, points, s, halvings - 1)
            }
        }
    }

    /// Checks that the branch continued from the last point before the end leads to the end, and not to another branch.
    fn check_goal(&self, target: &LineTarget, before: &PathPoint) -> Result<(), PathError> {
        let found = self.solve(target, 1.0, &before.1)?;
        let difference = |&axis: &usize| (axis, (found[axis] - self.to[axis]).abs());
        let differences = self.variables.iter().map(difference);
        match differences.max_by(|a, b| a.1.total_cmp(&b.1)) {
            Some((axis, difference)) if difference > SAME_BRANCH => {
                Err(target.error(1.0, PathErrorKind::GoalOnOtherBranch { axis, difference }))
            }
            _ => Ok(()),
        }
    }

    /// Positions of all axes at `s` that those on the line are nearest to: on the joint-space line, or the given postures (m or rad).
    fn reference(&self, s: f64) -> Vec<f64> {
        let ends = self.from.iter().zip(self.to);
        let mut reference: Vec<f64> = ends.map(|(from, to)| from + s * (to - from)).collect();
        if let Some(postures) = self.postures {
            postures.apply(s, &mut reference);
        }
        reference
    }

    /// The positions nearest to the reference that hold the wafer at `s`, from an initial guess.
    ///
    /// Newton's method on the stationarity conditions of the constrained minimum:
    ///
    /// ```text
    ///    [ 1  Jᵀ ] [ Δq ]     [ q_reference − q ]
    ///    [ J  0  ] [ λ  ]  =  [ −residual      ]
    /// ```
    fn solve(&self, target: &LineTarget, s: f64, guess: &[f64]) -> Result<Vec<f64>, PathError> {
        let reference = self.reference(s);
        let mut q = reference.clone();
        for &axis in &self.variables {
            q[axis] = guess[axis];
        }
        let (n, m) = (self.variables.len(), target.rows());
        let pose = |q: &[f64]| (self.pose)(q).map_err(|error| target.pose_error(s, error));
        let mut residual = target.residual(&pose(&q)?, s);
        let mut right = DVector::zeros(n + m);
        let (mut error, mut error_before) = (f64::INFINITY, f64::INFINITY);
        for iteration in 0..MAX_ITERATIONS {
            // The matrix neglects the curvature of the constraints, the change of the droop and the rotation of the heading by the tilt: they change the rate of convergence and not the solution.
            let jacobian =
                (self.jacobian)(&q).map_err(|error| target.pose_error(s, error.into()))?;
            let normal = target.normal(s);
            let mut system = DMatrix::zeros(n + m, n + m);
            for (column, &axis) in self.variables.iter().enumerate() {
                let (linear, angular) = (jacobian.linear[axis], jacobian.angular[axis]);
                let tilting = angular.cross(&normal);
                let slopes =
                    [linear.x, linear.y, linear.z, tilting.x, tilting.y, angular.dot(&normal)];
                system[(column, column)] = 1.0;
                for (row, &slope) in slopes[..m].iter().enumerate() {
                    system[(n + row, column)] = slope;
                    system[(column, n + row)] = slope;
                }
            }
            let factors = system.lu();
            // A factorization is reused while each step halves the error: poses are cheaper than factorizations.
            // The steps converge to positions that are stationary by the Jacobian of the factorization, which is that of the positions before.
            let mut moved = 0.0;
            loop {
                for (row, &axis) in self.variables.iter().enumerate() {
                    right[row] = reference[axis] - q[axis];
                }
                for row in 0..m {
                    right[n + row] = -residual[row];
                }
                if !factors.solve_mut(&mut right) {
                    return Err(target.error(s, PathErrorKind::Singular));
                }
                let mut step_size = 0.0_f64;
                for (row, &axis) in self.variables.iter().enumerate() {
                    q[axis] += right[row];
                    step_size = step_size.max(right[row].abs());
                }
                if !step_size.is_finite() || step_size > MAX_STEP {
                    return Err(target.error(s, target.not_reached(&residual)));
                }
                residual = target.residual(&pose(&q)?, s);
                let now = residual[..m].iter().fold(step_size, |most, value| most.max(value.abs()));
                let is_slow = now > 0.5 * error_before;
                (error, error_before) = (now, now);
                moved += step_size;
                let from_reference = |&axis: &usize| (reference[axis] - q[axis]).abs();
                let distance = self.variables.iter().map(from_reference).fold(0.0, f64::max);
                let is_stationary = n == m || moved * distance <= STATIONARITY_TOLERANCE;
                if !is_stationary && now < 0.01 * moved && iteration + 1 < MAX_ITERATIONS {
                    error_before = f64::INFINITY;
                    break;
                }
                if now < POINT_TOLERANCE
                    || (is_slow && now < 10.0 * POINT_TOLERANCE && iteration > 0)
                {
                    return Ok(q);
                }
                if is_slow {
                    break;
                }
            }
        }
        if error < ACCEPTED_RESIDUAL {
            return Ok(q);
        }
        Err(target.error(s, target.not_reached(&residual)))
    }
}

/// Target pose of the wafer over the fraction of a line.
struct LineTarget {
    /// Centre of the wafer at the start, in the base frame (m).
    start: Vector3<f64>,
    /// Displacement of the centre from start to end (m).
    displacement: Vector3<f64>,
    /// Normal of the wafer at the start.
    from_normal: Vector3<f64>,
    /// Unit vector perpendicular to `from_normal`, in the plane of both normals.
    across: Vector3<f64>,
    /// Angle between the normals at start and end (rad).
    angle: f64,
    /// Heading along the line, where the line prescribes one.
    heading: Option<HeadingTarget>,
}

/// Heading of the wafer along a line.
#[derive(Clone, Copy)]
struct HeadingTarget {
    /// Heading at the start (rad).
    start: f64,
    /// Change of the heading from start to end (rad).
    change: f64,
}

impl LineTarget {
    fn new(start: &Pose, end: &Pose, turn: Option<f64>) -> Self {
        let from_normal = normal(start);
        let to_normal = normal(end);
        let rest = to_normal - from_normal * from_normal.dot(&to_normal);
        let sine = rest.norm();
        let across = if sine > 0.0 { rest / sine } else { Vector3::zeros() };
        let heading = turn.map(|turn| {
            let (first, last) = (heading(start), heading(end));
            // The joints determine the number of revolutions, the poses the rest.
            HeadingTarget { start: first, change: turn + wrap_angle(last - first - turn) }
        });
        Self {
            start: start.translation.vector,
            displacement: end.translation.vector - start.translation.vector,
            from_normal,
            across,
            angle: sine.atan2(from_normal.dot(&to_normal)),
            heading,
        }
    }

    /// An error at a fraction of the line.
    fn error(&self, fraction: f64, kind: PathErrorKind) -> PathError {
        PathError { fraction, position: Some(self.start + self.displacement * fraction), kind }
    }

    /// The error of a pose that cannot be computed at a fraction of the line.
    fn pose_error(&self, fraction: f64, error: Unreachable) -> PathError {
        self.error(fraction, PathErrorKind::Pose(Box::new(error)))
    }

    /// The residual of a point that is not reached.
    fn not_reached(&self, residual: &[f64; 6]) -> PathErrorKind {
        let [x, y, z, along, across, turn] = *residual;
        PathErrorKind::NotReached {
            distance: x.hypot(y).hypot(z),
            tilt: along.hypot(across),
            heading: self.heading.map(|_| turn.abs()),
        }
    }

    /// Number of constraints: centre, normal, and the heading where it is prescribed.
    fn rows(&self) -> usize {
        5 + usize::from(self.heading.is_some())
    }

    /// Normal of the wafer at a fraction of the line.
    fn normal(&self, s: f64) -> Vector3<f64> {
        let (sin, cos) = (s * self.angle).sin_cos();
        self.from_normal * cos + self.across * sin
    }

    /// Centre (m), x and y of the normal, and heading (rad) of a pose, less those of the line.
    fn residual(&self, pose: &Pose, s: f64) -> [f64; 6] {
        let center = pose.translation.vector - (self.start + self.displacement * s);
        // Both normals are near the base z axis: x and y determine the difference of two unit vectors.
        let tilt = normal(pose) - self.normal(s);
        let turned = self
            .heading
            .map_or(0.0, |target| wrap_angle(heading(pose) - target.start - target.change * s));
        [center.x, center.y, center.z, tilt.x, tilt.y, turned]
    }

    /// Distance of a pose from the straight line (m), and angle of its plane to the plane that rotates uniformly (rad).
    fn deviation(&self, pose: &Pose, s: f64) -> (f64, f64) {
        let from_start = pose.translation.vector - self.start;
        let squared = self.displacement.norm_squared();
        let along = if squared > 0.0 {
            (from_start.dot(&self.displacement) / squared).clamp(0.0, 1.0)
        } else {
            0.0
        };
        let distance = (from_start - self.displacement * along).norm();
        (distance, normal(pose).cross(&self.normal(s)).norm().asin())
    }
}

/// Normal of a wafer in the base frame.
fn normal(pose: &Pose) -> Vector3<f64> {
    pose.rotation.matrix().column(2).into_owned()
}
