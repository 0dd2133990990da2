//! All axes so that a wafer's centre runs along a straight line, its plane turning evenly.

use jointplay_core::spatial::{Pose, tilt_rotation};
use nalgebra::{DMatrix, DVector, Vector3};

use super::spline::Spline;
use crate::robot::{AxisKind, EffectorJacobian, HybridRobot};

/// Where the line leads, and which axes may follow it.
pub(crate) struct Task<'a> {
    /// Positions of all axes at its start.
    pub(crate) from: &'a [f64],
    /// Positions of all axes at its end.
    pub(crate) to: &'a [f64],
    /// Axes that move the effector.
    pub(crate) variables: Vec<usize>,
    /// Turn of the effector against the platform from start to end by the arm's joints, where its motors leave it free to turn [rad].
    pub(crate) turn: Option<f64>,
    /// Pose of the wafer in the base frame for positions of all axes.
    pub(crate) pose: &'a dyn Fn(&[f64]) -> Result<Pose, String>,
    /// How fast the wafer goes by each axis, about.
    pub(crate) jacobian: &'a dyn Fn(&[f64]) -> Result<EffectorJacobian, String>,
    /// Largest distance of the wafer's centre from the straight line [m].
    pub(crate) deviation: f64,
}

/// Positions of all axes along a line.
#[derive(Debug, Clone)]
pub(crate) struct Line {
    /// Over the share of the way.
    pub(crate) spline: Spline,
    /// Its length [m].
    pub(crate) length: f64,
    /// Largest distance found of the wafer's centre from the straight line [m].
    pub(crate) deviation: f64,
    /// Largest angle found between the wafer's plane and the one that turns evenly [rad].
    pub(crate) plane: f64,
}

/// Why a line cannot be followed.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Stuck {
    /// Share of the way.
    pub(crate) at: f64,
    /// Place of the wafer's centre there by the line, in the base frame; `None` where the line has none [m].
    pub(crate) place: Option<Vector3<f64>>,
    /// What is the matter.
    pub(crate) why: Obstacle,
}

/// What keeps the axes from following a line.
#[derive(Debug, Clone, PartialEq)]
pub(crate) enum Obstacle {
    /// The robot cannot be computed there, for a reason in words.
    Robot(String),
    /// The effector cannot move in all directions.
    Singular,
    /// No positions of the axes hold the wafer there.
    NotReached {
        /// Distance that is missing [m].
        distance: f64,
        /// Angle of the plane that is missing [rad].
        tilt: f64,
        /// Turn about the normal that is missing, where the line asks for one [rad].
        heading: Option<f64>,
    },
    /// The line leads to other positions than those of its end.
    OtherBranch {
        /// Axis that is off most, by index.
        axis: usize,
        /// By how much [m or rad].
        off: f64,
    },
    /// The axes jump from one branch to another.
    Jump,
    /// The axes leave the line, however closely they are computed.
    Leaves {
        /// How far [m].
        deviation: f64,
        /// At how many points they were computed.
        points: usize,
    },
}

impl Stuck {
    /// What is missing, where, and what can be changed.
    pub(crate) fn told(&self, robot: &HybridRobot) -> String {
        let share = 100.0 * self.at;
        let place = self.place.map_or_else(String::new, |place| {
            let [x, y, z] = [place.x, place.y, place.z].map(|value| value * 1e3);
            format!(", at x {x:.1}, y {y:.1}, z {z:.1} mm")
        });
        let change = "change the radius of the station, `retract_mm`, the heading (`yaw_deg`, `approach`) or the posture in which the line starts, or move the axes instead";
        let why = match &self.why {
            Obstacle::Robot(why) => why.clone(),
            Obstacle::Singular => format!(
                "the arm is in a singular position, in which the effector cannot follow the line in all directions; {change}"
            ),
            Obstacle::NotReached { distance, tilt, heading } => {
                let heading = heading.map_or_else(String::new, |heading| {
                    format!(", {:.2}° of heading", heading.to_degrees())
                });
                format!(
                    "the effector does not reach the line: {:.3} mm, {:.3} mrad of tilt{heading} are missing; {change}",
                    distance * 1e3,
                    tilt * 1e3
                )
            }
            Obstacle::OtherBranch { axis, off } => {
                let axis = &robot.axes[*axis];
                let off = match axis.kind {
                    AxisKind::Rotary => format!("{:.3}°", off.to_degrees()),
                    AxisKind::Linear => format!("{:.3} mm", off * 1e3),
                };
                format!(
                    "the line leads to another posture than that of its end, axis {} is off by {off}: both ends are on different branches of the arm; {change}",
                    axis.name
                )
            }
            Obstacle::Jump => {
                format!("the axes jump from one branch of the arm to another; {change}")
            }
            Obstacle::Leaves { deviation, points } => format!(
                "the wafer is {:.3} mm off the line after {points} points: it passes too near a singular position; {change}",
                deviation * 1e3
            ),
        };
        format!("{share:.1} % along the line{place}: {why}")
    }
}

/// Intervals that a line starts with; it is divided further where the spline strays.
const FIRST_INTERVALS: usize = 12;
/// Intervals beyond which a line counts as one that cannot be followed: a smooth one takes some dozens.
const MOST_INTERVALS: usize = 1024;
/// Share of the way below which an interval is not divided: what still strays there jumps.
const NARROWEST: f64 = 1e-7;
/// How often an interval may be halved to reach the next point from the one before.
const MOST_HALVINGS: usize = 10;
/// Residual at which a point counts as found [m and rad]: a thousandth of what inverse kinematics is held to.
const FOUND: f64 = 1e-12;
/// Steps of Newton's method before a point counts as out of reach.
const MOST_ITERATIONS: usize = 30;
/// Turns and lengths by which the ends of a line may miss what its axes come to, as round-off of a target that was reached.
const SAME: f64 = 1e-9;

impl Task<'_> {
    /// Positions of all axes along the line.
    ///
    /// At each point they are the ones nearest to the even way of each axis among those that hold the wafer in place:
    ///
    /// ```text
    ///    min |q − q_even(s)|²   so that   center(q) = c(s),  normal(q) = n(s),  heading(q) = h(s)
    /// ```
    /// Both ends are met exactly, and an arm with more axes than it needs moves all of them gently.
    /// Between the points runs a cubic spline, refined until it keeps to the line.
    ///
    /// # Errors
    /// Where a point cannot be reached from the one before, by share of the way.
    pub(crate) fn follow(&self) -> Result<Line, Stuck> {
        let nowhere = |at: f64| move |why| Stuck { at, place: None, why: Obstacle::Robot(why) };
        let start = (self.pose)(self.from).map_err(nowhere(0.0))?;
        let end = (self.pose)(self.to).map_err(nowhere(1.0))?;
        let target = Target::new(&start, &end, self.turn);
        let mut points = vec![(0.0, self.from.to_vec())];
        for interval in 1..FIRST_INTERVALS {
            let s = interval as f64 / FIRST_INTERVALS as f64;
            self.march(&target, &mut points, s, MOST_HALVINGS)?;
        }
        points.push((1.0, self.to.to_vec()));
        let before = &points[points.len() - 2];
        self.arrived(&target, before)?;
        loop {
            let (knots, values): (Vec<f64>, Vec<Vec<f64>>) = points.iter().cloned().unzip();
            let spline = Spline::through(&knots, &values);
            let mut finer: Vec<(f64, Vec<f64>)> = Vec::new();
            let (mut deviation, mut plane) = (0.0_f64, 0.0_f64);
            for pair in knots.windows(2) {
                let mut strays = false;
                for share in [0.25, 0.5, 0.75] {
                    let s = pair[0] + share * (pair[1] - pair[0]);
                    let pose = (self.pose)(&spline.positions(s))
                        .map_err(|why| target.stuck(s, Obstacle::Robot(why)))?;
                    let (off, turned) = target.strays(&pose, s);
                    deviation = deviation.max(off);
                    plane = plane.max(turned);
                    strays |= off > self.deviation;
                }
                if strays && pair[1] - pair[0] < NARROWEST {
                    return Err(target.stuck(pair[0], Obstacle::Jump));
                }
                if strays {
                    let s = (pair[0] + pair[1]) / 2.0;
                    finer.push((s, self.solve(&target, s, spline.positions(s))?));
                }
            }
            if finer.is_empty() {
                return Ok(Line { spline, length: target.way.norm(), deviation, plane });
            }
            if points.len() + finer.len() > MOST_INTERVALS {
                let why = Obstacle::Leaves { deviation, points: points.len() };
                return Err(target.stuck(finer[0].0, why));
            }
            points.extend(finer);
            points.sort_by(|a, b| a.0.total_cmp(&b.0));
        }
    }

    /// From the last of the points to `s`, by halves where that is too far.
    fn march(
        &self,
        target: &Target,
        points: &mut Vec<(f64, Vec<f64>)>,
        s: f64,
        halvings: usize,
    ) -> Result<(), Stuck> {
        let (last, positions) = points.last().expect("the start is there");
        let guess: Vec<f64> = positions
            .iter()
            .zip(self.from.iter().zip(self.to))
            .map(|(position, (from, to))| position + (s - last) * (to - from))
            .collect();
        let near = points.len() >= 2;
        let guess = if near {
            let (earlier, older) = &points[points.len() - 2];
            let ratio = (s - last) / (last - earlier);
            positions.iter().zip(older).map(|(new, old)| new + ratio * (new - old)).collect()
        } else {
            guess
        };
        match self.solve(target, s, guess) {
            Ok(found) => {
                points.push((s, found));
                Ok(())
            }
            Err(stuck) if halvings == 0 => Err(stuck),
            Err(_) => {
                let middle = (last + s) / 2.0;
                self.march(target, points, middle, halvings - 1)?;
                self.march(target, points, s, halvings - 1)
            }
        }
    }

    /// Whether the end is where the points lead to, and not another branch.
    fn arrived(&self, target: &Target, before: &(f64, Vec<f64>)) -> Result<(), Stuck> {
        let guess: Vec<f64> = before.1.clone();
        let found = self.solve(target, 1.0, guess)?;
        let off = self.variables.iter().map(|&axis| (axis, (found[axis] - self.to[axis]).abs()));
        match off.max_by(|a, b| a.1.total_cmp(&b.1)) {
            Some((axis, off)) if off > 1e3 * SAME => {
                Err(target.stuck(1.0, Obstacle::OtherBranch { axis, off }))
            }
            _ => Ok(()),
        }
    }

    fn even(&self, s: f64) -> impl Iterator<Item = f64> + '_ {
        self.from.iter().zip(self.to).map(move |(from, to)| from + s * (to - from))
    }

    /// The positions nearest to the even way that hold the wafer at `s`, from a guess.
    fn solve(&self, target: &Target, s: f64, guess: Vec<f64>) -> Result<Vec<f64>, Stuck> {
        let stuck = |why: String| target.stuck(s, Obstacle::Robot(why));
        let even: Vec<f64> = self.even(s).collect();
        let mut q = even.clone();
        for &axis in &self.variables {
            q[axis] = guess[axis];
        }
        let (n, m) = (self.variables.len(), target.rows());
        let mut residual = target.residual(&(self.pose)(&q).map_err(stuck)?, s);
        let mut off = f64::INFINITY;
        for iteration in 0..MOST_ITERATIONS {
            // Newton on the conditions of the constrained minimum; curvature of the constraints, change of the droop and the turning of the heading by the tilt are left out, so that it converges by about their size.
            let jacobian = (self.jacobian)(&q).map_err(stuck)?;
            let upright = target.normal(s);
            let mut system = DMatrix::zeros(n + m, n + m);
            for (column, &axis) in self.variables.iter().enumerate() {
                let (linear, angular) = (jacobian.linear[axis], jacobian.angular[axis]);
                let tilting = angular.cross(&upright);
                let slopes =
                    [linear.x, linear.y, linear.z, tilting.x, tilting.y, angular.dot(&upright)];
                system[(column, column)] = 1.0;
                for (row, &slope) in slopes[..m].iter().enumerate() {
                    system[(n + row, column)] = slope;
                    system[(column, n + row)] = slope;
                }
            }
            let factors = system.lu();
            // The same matrix serves as long as it halves the error each time.
            loop {
                let mut right = DVector::zeros(n + m);
                for (row, &axis) in self.variables.iter().enumerate() {
                    right[row] = even[axis] - q[axis];
                }
                for row in 0..m {
                    right[n + row] = -residual[row];
                }
                let Some(step) = factors.solve(&right) else {
                    return Err(target.stuck(s, Obstacle::Singular));
                };
                let mut far = 0.0_f64;
                for (row, &axis) in self.variables.iter().enumerate() {
                    q[axis] += step[row];
                    far = far.max(step[row].abs());
                }
                if !far.is_finite() || far > 1e3 {
                    return Err(target.stuck(s, target.missing(&residual)));
                }
                residual = target.residual(&(self.pose)(&q).map_err(stuck)?, s);
                let now = residual[..m].iter().fold(far, |most, value| most.max(value.abs()));
                let slow = now > 0.5 * off;
                off = now;
                if now < FOUND || (slow && now < 10.0 * FOUND && iteration > 0) {
                    return Ok(q);
                }
                if slow {
                    break;
                }
            }
        }
        if off < SAME {
            return Ok(q);
        }
        Err(target.stuck(s, target.missing(&residual)))
    }
}

/// Where the wafer is to be along the line.
struct Target {
    start: Vector3<f64>,
    way: Vector3<f64>,
    from_normal: Vector3<f64>,
    /// Unit vector across the normals in their plane, and the angle between them.
    across: Vector3<f64>,
    angle: f64,
    /// Heading at the start, and its change.
    heading: Option<(f64, f64)>,
}

impl Target {
    fn new(start: &Pose, end: &Pose, turn: Option<f64>) -> Self {
        let from_normal = normal(start);
        let to_normal = normal(end);
        let rest = to_normal - from_normal * from_normal.dot(&to_normal);
        let sine = rest.norm();
        let across = if sine > 0.0 { rest / sine } else { Vector3::zeros() };
        let heading = turn.map(|turn| {
            let (first, last) = (heading(start), heading(end));
            (first, turn + wrapped(last - first - turn))
        });
        Self {
            start: start.translation.vector,
            way: end.translation.vector - start.translation.vector,
            from_normal,
            across,
            angle: sine.atan2(from_normal.dot(&to_normal)),
            heading,
        }
    }

    /// Why the axes do not follow the line at a share of the way.
    fn stuck(&self, at: f64, why: Obstacle) -> Stuck {
        Stuck { at, place: Some(self.start + self.way * at), why }
    }

    /// What a residual leaves missing.
    fn missing(&self, residual: &[f64; 6]) -> Obstacle {
        let [x, y, z, along, across, turn] = *residual;
        Obstacle::NotReached {
            distance: x.hypot(y).hypot(z),
            tilt: along.hypot(across),
            heading: self.heading.map(|_| turn.abs()),
        }
    }

    fn rows(&self) -> usize {
        5 + usize::from(self.heading.is_some())
    }

    fn normal(&self, s: f64) -> Vector3<f64> {
        let (sin, cos) = (s * self.angle).sin_cos();
        self.from_normal * cos + self.across * sin
    }

    fn residual(&self, pose: &Pose, s: f64) -> [f64; 6] {
        let off = pose.translation.vector - (self.start + self.way * s);
        // Both in the base frame: an upright plane has its normal's x and y small.
        let tilt = normal(pose) - self.normal(s);
        let turned =
            self.heading.map_or(0.0, |(first, change)| wrapped(heading(pose) - first - change * s));
        [off.x, off.y, off.z, tilt.x, tilt.y, turned]
    }

    /// Distance from the straight line, and angle from the plane that turns evenly.
    fn strays(&self, pose: &Pose, s: f64) -> (f64, f64) {
        let from_start = pose.translation.vector - self.start;
        let squared = self.way.norm_squared();
        let along =
            if squared > 0.0 { (from_start.dot(&self.way) / squared).clamp(0.0, 1.0) } else { 0.0 };
        let aside = (from_start - self.way * along).norm();
        (aside, normal(pose).cross(&self.normal(s)).norm().asin())
    }
}

fn normal(pose: &Pose) -> Vector3<f64> {
    pose.rotation.matrix().column(2).into_owned()
}

/// Turn about the normal, beyond the shortest rotation to it.
fn heading(pose: &Pose) -> f64 {
    let turned = tilt_rotation(&normal(pose)).inverse() * pose.rotation;
    turned.matrix()[(1, 0)].atan2(turned.matrix()[(0, 0)])
}

fn wrapped(angle: f64) -> f64 {
    use std::f64::consts::{PI, TAU};
    (angle + PI).rem_euclid(TAU) - PI
}
