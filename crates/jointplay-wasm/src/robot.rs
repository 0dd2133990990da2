//! Calls of one robot, with numbers in and out of one array.

use core::fmt::Display;

use jointplay_core::Error;
use jointplay_core::gpr::{AxisHeight, CenterHeight, Gpr, Limb, Limits, PlatformPose};
use jointplay_core::nalgebra::Vector2;
use jointplay_core::spatial::{Pose, Tilt};
use jointplay_core::virtualization::{
    MAX_VIRTUAL_JOINTS, Metric, SolveOptions, Solver, VirtualJoints, Virtualization, built_in,
};

use crate::Message;

/// How a call ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[repr(u32)]
pub enum Kind {
    /// With numbers.
    Done = 0,
    /// The input is valid and has no solution.
    Infeasible = 1,
    /// The input is invalid.
    Invalid = 2,
}

/// Numbers of a call: as many as a pose has.
const NUMBERS: usize = 96;

/// A robot, the numbers of the last call, and its message.
#[derive(Debug)]
pub struct Robot {
    robot: Option<Gpr>,
    numbers: [f64; NUMBERS],
    message: Message,
}

impl Default for Robot {
    fn default() -> Self {
        Self::NONE
    }
}

impl Robot {
    /// No robot yet.
    pub const NONE: Self = Self { robot: None, numbers: [0.0; NUMBERS], message: Message::EMPTY };

    /// Numbers, in and out.
    pub fn numbers(&mut self) -> &mut [f64] {
        &mut self.numbers
    }

    /// Message of the last call that did not end with numbers.
    #[must_use]
    pub fn message(&self) -> &[u8] {
        self.message.bytes()
    }

    /// Takes the dimensions of a robot.
    ///
    /// In: base point x and y, socket radius (m) and angle (rad) of each limb; shortest and longest rod (m), largest tilt (rad); working height (m); 1 to check the limits, else 0; clearance of the balls (m), or NaN.
    pub fn set(&mut self) -> Kind {
        let [rod_min, rod_max, tilt_max, height, checks, clearance] = self.take(12);
        let limbs = [0, 1, 2].map(|k| {
            let [x, y, socket_radius, socket_angle] = self.take(4 * k);
            Limb { base_point: Vector2::new(x, y), socket_radius, socket_angle }
        });
        let limits = Limits { rod_min, rod_max, tilt_max };
        let robot = Gpr::new(limbs, limits, height).and_then(|robot| {
            let robot = if checks == 0.0 { robot.without_limit_checks() } else { robot };
            if clearance.is_nan() { Ok(robot) } else { robot.with_ball_clearance(clearance) }
        });
        match robot {
            Ok(robot) => {
                self.robot = Some(robot);
                Kind::Done
            }
            Err(error) => self.refused(&error),
        }
    }

    /// Rods for a tilt at an axis height.
    ///
    /// In: azimuth, tilt angle (rad), height (m). Out: rods (m).
    pub fn inverse(&mut self) -> Kind {
        let [azimuth, angle, height] = self.take(0);
        self.call(|robot, numbers| {
            let rods = robot.inverse(Tilt { azimuth, angle }, AxisHeight(height))?;
            numbers.put(&rods);
            Ok(())
        })
    }

    /// Limits that rods break.
    ///
    /// In: rods (m). Out: azimuth and angle of the tilt (rad); axis height (m); for each rod and for the tilt 1 if its limit is broken, else 0.
    pub fn broken_limits(&mut self) -> Kind {
        let rods = self.take(0);
        self.call(|robot, numbers| {
            let tilt = robot.plane_tilt(&rods);
            let broken = robot.limits().broken(&rods, tilt);
            numbers.put(&[tilt.azimuth, tilt.angle, robot.plane_height(&rods).0]);
            numbers.put(&broken.rods().map(f64::from));
            numbers.put(&[f64::from(broken.tilt())]);
            Ok(())
        })
    }

    /// The last rods within the limits on a straight motion of the rods.
    ///
    /// In: rods within the limits, wanted rods (m). Out: rods (m).
    pub fn clamp(&mut self) -> Kind {
        let (from, to) = (self.take(0), self.take(3));
        self.call(|robot, numbers| {
            numbers.put(&robot.clamp_to_limits(&from, &to));
            Ok(())
        })
    }

    /// Pose of the platform for given rods, or for a tilt at a height of its centre.
    ///
    /// In: rods (m), or azimuth, tilt angle (rad) and height (m) if `by_center` is 1; length of the metric (m), 0 for the mean socket radius; greatest number of iterations.
    ///
    /// # Arguments
    /// * `model` – virtualization: radial, polar, offset or planar, from 0
    /// * `solver` – Newton, least norm or closed form, from 0
    pub fn forward(&mut self, model: u32, solver: u32, by_center: u32) -> Kind {
        let [a, b, c, length, iterations] = self.take(0);
        let Some(&virtualization) = built_in().get(model as usize) else {
            return self.refused(&"there are four virtualizations");
        };
        #[expect(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "numbers out of range become the nearest, and NaN zero"
        )]
        let options = SolveOptions {
            solver: match solver {
                0 => Solver::Newton,
                1 => Solver::LeastNorm,
                _ => Solver::ClosedForm,
            },
            metric: if length == 0.0 { Metric::PlatformRadius } else { Metric::Length(length) },
            max_iterations: iterations.min(1e4) as usize,
            ..SolveOptions::default()
        };
        self.call(|robot, numbers| {
            let pose = if by_center == 1 {
                let tilt = Tilt { azimuth: a, angle: b };
                robot.inverse_for_center(tilt, CenterHeight(c), virtualization, &options)?
            } else {
                robot.forward([a, b, c], virtualization, &options)?
            };
            write_pose(robot, &pose, virtualization, numbers);
            Ok(())
        })
    }

    /// The approximate model, whose platform turns about its centre.
    ///
    /// In: azimuth, tilt angle (rad), height (m). Out: rods (m), pose, gaps of the balls (m).
    pub fn approximate(&mut self) -> Kind {
        let [azimuth, angle, height] = self.take(0);
        self.call(|robot, numbers| {
            let found = robot.approximate(Tilt { azimuth, angle }, AxisHeight(height))?;
            numbers.put(&found.rods);
            numbers.put_pose(&found.base_from_platform);
            found.gaps.iter().for_each(|gap| numbers.put(gap.as_slice()));
            Ok(())
        })
    }

    /// Numbers of a call from a place on.
    fn take<const N: usize>(&self, first: usize) -> [f64; N] {
        core::array::from_fn(|k| self.numbers[first + k])
    }

    fn call(&mut self, compute: impl FnOnce(&Gpr, &mut Output<'_>) -> Result<(), Error>) -> Kind {
        let Some(robot) = &self.robot else {
            return self.refused(&"there is no robot yet: give its dimensions first");
        };
        let mut output = Output { numbers: &mut self.numbers, next: 0 };
        match compute(robot, &mut output) {
            Ok(()) => Kind::Done,
            Err(error) if error.is_infeasible() => {
                self.message.set(&error);
                Kind::Infeasible
            }
            Err(error) => self.refused(&error),
        }
    }

    fn refused(&mut self, error: &dyn Display) -> Kind {
        self.message.set(error);
        Kind::Invalid
    }
}

/// Writes rods, tilt, axis height, centre shift, torsion, pose, balls, sockets, clearance, solution and virtual joints.
fn write_pose(
    robot: &Gpr,
    pose: &PlatformPose,
    virtualization: &dyn Virtualization,
    output: &mut Output<'_>,
) {
    let (tilt, shift, solution) = (pose.tilt(), pose.center_shift(), &pose.solution);
    output.put(&pose.rods);
    output.put(&pose.sides);
    output.put(&[tilt.azimuth, tilt.angle, pose.axis_height().0, shift.x, shift.y, pose.torsion()]);
    output.put_pose(&pose.base_from_platform);
    robot.ball_centers(&pose.rods).iter().for_each(|ball| output.put(ball.as_slice()));
    let sockets = virtualization.sockets(robot.platform(), &solution.virtual_joints);
    sockets.iter().for_each(|socket| output.put(socket.as_slice()));
    let clearance = robot.needed_clearance(pose, virtualization);
    output.put(&clearance.displacements);
    output.put(&[clearance.lower_bound, clearance.upper_bound()]);
    output.put(&[clearance.is_sufficient().map_or(f64::NAN, f64::from)]);
    #[expect(clippy::cast_precision_loss, reason = "at most ten thousand")]
    let iterations = solution.iterations as f64;
    let solver = match solution.solver {
        Solver::Newton => 0.0,
        Solver::LeastNorm => 1.0,
        Solver::ClosedForm => 2.0,
    };
    output.put(&[robot.displacement(pose, virtualization), solution.characteristic_length]);
    output.put(&[solver, iterations, solution.residual]);
    output.put(&[f64::from(u8::try_from(solution.virtual_joints.len()).unwrap_or(0))]);
    output.put_joints(&solution.virtual_joints);
    output.put_joints(&robot.virtual_displacements(pose, virtualization));
}

/// Writes numbers one after the other.
struct Output<'a> {
    numbers: &'a mut [f64; NUMBERS],
    next: usize,
}

impl Output<'_> {
    fn put(&mut self, values: &[f64]) {
        let end = self.next + values.len();
        self.numbers[self.next..end].copy_from_slice(values);
        self.next = end;
    }

    /// Origin, then rows of the rotation.
    fn put_pose(&mut self, pose: &Pose) {
        self.put(pose.translation.vector.as_slice());
        let rotation = pose.rotation.matrix().transpose();
        self.put(rotation.as_slice());
    }

    /// As many numbers as virtual joints there can be, the rest zero.
    fn put_joints(&mut self, joints: &VirtualJoints) {
        let mut all = [0.0; MAX_VIRTUAL_JOINTS];
        all[..joints.len()].copy_from_slice(joints);
        self.put(&all);
    }
}
