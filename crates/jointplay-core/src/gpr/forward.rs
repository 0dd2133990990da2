//! Forward kinematics: from the rods to the pose of the platform.

use nalgebra::{Vector2, Vector3};

use super::{AxisHeight, Gpr, ball_sides};
use crate::Error;
use crate::error::{LARGEST_LENGTH, length};
use crate::float::sqrt;
#[cfg(feature = "std")]
use crate::kernel::{self, Model, Single, SingleJoints, SinglePose, Task};
use crate::spatial::{Pose, Tilt, fit_in_plane};
#[cfg(feature = "std")]
use crate::virtualization::{BuiltIn, Offset, Planar, Polar, Radial};
use crate::virtualization::{
    Sides, Solution, SolveOptions, VirtualJoints, Virtualization, signed_area, solve,
};

/// A pose of the platform, with the rods, sides and virtual joints that determine it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PlatformPose {
    /// Rod lengths q_1, q_2, q_3 (m).
    pub rods: [f64; 3],
    /// Sides L_12, L_23, L_31 (m).
    pub sides: Sides,
    /// Virtual joints, with iterations and residual.
    pub solution: Solution,
    /// Pose of the platform frame in the base frame.
    pub base_from_platform: Pose,
}

impl Gpr {
    /// Forward kinematics: pose of the platform for given rods.
    ///
    /// ```text
    ///    q  →  P_k = B_k + q_k e_b3  →  L_ij = |P_j − P_i|  →  X  →  the pose that carries p_k(X) onto P_k
    /// ```
    /// Plane and sides are geometry; where the platform sits over the triangle is the virtualization's model.
    ///
    /// # Arguments
    /// * `rods` – (3) lengths q_k (m)
    ///
    /// # Errors
    /// [`Error::NotFinite`], [`Error::TooLong`] for a rod beyond 10⁵⁰ m, and those of [`solve`]; [`Error::TurnedOver`] for a solution that mirrors the platform.
    /// [`Error::BeyondLimits`] for rods or a tilt of the plane through the balls, unless the robot is one [without limit checks](Self::without_limit_checks).
    ///
    /// # Numerics
    /// Does not allocate.
    ///
    /// # Source
    /// \[Virtualization\], IV.B; the placement is own derivation, `docs/explanation/kinematics.md`
    #[inline]
    pub fn forward<V: Virtualization + ?Sized>(
        &self,
        rods: [f64; 3],
        virtualization: &V,
        options: &SolveOptions,
    ) -> Result<PlatformPose, Error> {
        self.check_rods(&rods)?;
        self.pose(rods, virtualization, options)
    }

    /// Virtual joints for given rods, without the pose of the platform; those of [`Self::forward`].
    ///
    /// # Arguments
    /// * `rods` – (3) lengths q_k (m)
    ///
    /// # Errors
    /// Those of [`Self::forward`].
    ///
    /// # Numerics
    /// Does not allocate.
    ///
    /// # Example
    /// ```
    /// use jointplay_core::gpr::Gpr;
    /// use jointplay_core::virtualization::{Polar, SolveOptions};
    ///
    /// let gpr = Gpr::paper();
    /// let (rods, options) = ([0.5, 0.501, 0.499], SolveOptions::default());
    /// let solution = gpr.virtual_joints(rods, &Polar, &options)?;
    /// assert_eq!(solution, gpr.forward(rods, &Polar, &options)?.solution);
    /// # Ok::<(), jointplay_core::Error>(())
    /// ```
    #[inline]
    pub fn virtual_joints<V: Virtualization + ?Sized>(
        &self,
        rods: [f64; 3],
        virtualization: &V,
        options: &SolveOptions,
    ) -> Result<Solution, Error> {
        self.check_rods(&rods)?;
        #[cfg(not(feature = "std"))]
        return Ok(self.general_pose(rods, virtualization, options)?.solution);
        #[cfg(feature = "std")]
        match virtualization.as_built_in() {
            Some(built_in) => self.built_in_joints(built_in, &rods, options),
            None => Ok(self.general_pose(rods, virtualization, options)?.solution),
        }
    }

    /// Whether rods are numbers, and within the limits of a robot that checks them.
    #[inline]
    pub(crate) fn check_rods(&self, rods: &[f64; 3]) -> Result<(), Error> {
        let moderate = rods.iter().all(|rod| rod.abs() < LARGEST_LENGTH);
        if moderate && (!self.checks_limits() || self.clearly_within_limits(rods)) {
            return Ok(());
        }
        self.check_doubtful_rods(rods)
    }

    #[cold]
    fn check_doubtful_rods(&self, rods: &[f64; 3]) -> Result<(), Error> {
        for &rod in rods {
            length("a rod length", rod)?;
        }
        if self.checks_limits() && !self.clearly_within_limits(rods) {
            let broken = self.limits().broken(rods, self.plane_tilt(rods));
            if !broken.is_empty() {
                return Err(Error::BeyondLimits(broken));
            }
        }
        Ok(())
    }

    /// Whether rods are within the limits, without an arc tangent; `false` leaves the limits themselves to [`Limits::broken`](super::Limits::broken).
    #[inline]
    fn clearly_within_limits(&self, rods: &[f64; 3]) -> bool {
        let limits = self.limits();
        let balls = self.ball_centers(rods);
        let normal = (balls[1] - balls[0]).cross(&(balls[2] - balls[0]));
        let horizontal = normal.z * self.steepest();
        rods.iter().all(|length| (limits.rod_min..=limits.rod_max).contains(length))
            && normal.x * normal.x + normal.y * normal.y <= horizontal * horizontal
    }

    /// The pose of [`Self::forward`], limits not checked.
    #[inline]
    pub(super) fn pose<V: Virtualization + ?Sized>(
        &self,
        rods: [f64; 3],
        virtualization: &V,
        options: &SolveOptions,
    ) -> Result<PlatformPose, Error> {
        // The closed equations are written for wide registers; without them there is less code.
        #[cfg(not(feature = "std"))]
        return self.general_pose(rods, virtualization, options);
        #[cfg(feature = "std")]
        match virtualization.as_built_in() {
            Some(built_in) => self.built_in_pose(built_in, &rods, options),
            None => self.general_pose(rods, virtualization, options),
        }
    }

    /// A pose of any virtualization, by [`solve`].
    pub(crate) fn general_pose<V: Virtualization + ?Sized>(
        &self,
        rods: [f64; 3],
        virtualization: &V,
        options: &SolveOptions,
    ) -> Result<PlatformPose, Error> {
        let balls = self.ball_centers(&rods);
        let sides = ball_sides(&balls);
        let solution = solve(virtualization, self.platform(), &sides, options)?;
        let sockets = virtualization.sockets(self.platform(), &solution.virtual_joints);
        let sense = signed_area(self.platform().sockets());
        if signed_area(&sockets) * sense <= 0.0 {
            return Err(Error::TurnedOver { virtual_joints: solution.virtual_joints });
        }
        let upward = (balls[1] - balls[0]).cross(&(balls[2] - balls[0])) * sense.signum();
        let normal = upward / upward.norm();
        let base_from_platform = fit_in_plane(&sockets, &balls, &normal);
        Ok(PlatformPose { rods, sides, solution, base_from_platform })
    }

    /// A pose of a built-in virtualization.
    ///
    /// No type parameter, so that its kernels are compiled once and not by every user.
    #[cfg(feature = "std")]
    fn built_in_pose(
        &self,
        built_in: BuiltIn,
        rods: &[f64; 3],
        options: &SolveOptions,
    ) -> Result<PlatformPose, Error> {
        match built_in {
            BuiltIn::Radial => self.kernel_pose::<kernel::Radial>(&Radial, rods, options),
            BuiltIn::Polar => self.kernel_pose::<kernel::Polar>(&Polar, rods, options),
            BuiltIn::Offset => self.kernel_pose::<kernel::Offset>(&Offset, rods, options),
            BuiltIn::Planar => self.kernel_pose::<kernel::Planar>(&Planar, rods, options),
        }
    }

    /// Virtual joints of a built-in virtualization; see [`Self::built_in_pose`].
    #[cfg(feature = "std")]
    fn built_in_joints(
        &self,
        built_in: BuiltIn,
        rods: &[f64; 3],
        options: &SolveOptions,
    ) -> Result<Solution, Error> {
        match built_in {
            BuiltIn::Radial => self.kernel_joints::<kernel::Radial>(&Radial, rods, options),
            BuiltIn::Polar => self.kernel_joints::<kernel::Polar>(&Polar, rods, options),
            BuiltIn::Offset => self.kernel_joints::<kernel::Offset>(&Offset, rods, options),
            BuiltIn::Planar => self.kernel_joints::<kernel::Planar>(&Planar, rods, options),
        }
    }

    /// A pose by the closed equations of a built-in virtualization, or by [`solve`] where they leave a doubt.
    #[cfg(feature = "std")]
    #[inline]
    fn kernel_pose<M: Model>(
        &self,
        virtualization: &dyn Virtualization,
        rods: &[f64; 3],
        options: &SolveOptions,
    ) -> Result<PlatformPose, Error> {
        let characteristic_length = options.metric.characteristic_length(self.platform())?;
        let dimensions = self.dimensions();
        dimensions.processor.run(
            #[inline(always)]
            || {
                let task = Task::new::<M>(dimensions, options, characteristic_length);
                match Single::new::<M>(&task, rods) {
                    Some(found) => {
                        let found = found.pose::<M>(dimensions);
                        Ok(self.found_pose(*rods, &task, characteristic_length, found))
                    }
                    None => self.general_pose(*rods, virtualization, options),
                }
            },
        )
    }

    /// Virtual joints by the closed equations of a built-in virtualization, or by [`solve`] where they leave a doubt.
    #[cfg(feature = "std")]
    #[inline]
    fn kernel_joints<M: Model>(
        &self,
        virtualization: &dyn Virtualization,
        rods: &[f64; 3],
        options: &SolveOptions,
    ) -> Result<Solution, Error> {
        let characteristic_length = options.metric.characteristic_length(self.platform())?;
        let dimensions = self.dimensions();
        dimensions.processor.run(
            #[inline(always)]
            || {
                let task = Task::new::<M>(dimensions, options, characteristic_length);
                match Single::new::<M>(&task, rods) {
                    Some(found) => {
                        Ok(solution(&task, characteristic_length, found.joints::<M>(dimensions)))
                    }
                    None => Ok(self.general_pose(*rods, virtualization, options)?.solution),
                }
            },
        )
    }

    /// A pose by the closed equations, with all that belongs to it.
    #[cfg(feature = "std")]
    #[inline(always)]
    pub(crate) fn found_pose(
        &self,
        rods: [f64; 3],
        task: &Task<'_>,
        characteristic_length: f64,
        found: SinglePose,
    ) -> PlatformPose {
        let SinglePose { sides, base_from_platform, .. } = found;
        let solution = solution(task, characteristic_length, found.joints);
        PlatformPose { rods, sides, solution, base_from_platform }
    }
}

/// Solution of the closed equations, with the method.
#[cfg(feature = "std")]
#[inline(always)]
pub(crate) fn solution(
    task: &Task<'_>,
    characteristic_length: f64,
    found: SingleJoints,
) -> Solution {
    Solution {
        virtual_joints: found.virtual_joints,
        solver: task.solver,
        characteristic_length,
        iterations: found.iterations,
        residual: found.residual,
    }
}

impl Gpr {
    /// Tilt of the plane through the ball centres: geometry alone, the same for every virtualization.
    ///
    /// # Arguments
    /// * `rods` – (3) lengths q_k (m)
    #[must_use]
    pub fn plane_tilt(&self, rods: &[f64; 3]) -> Tilt {
        let balls = self.ball_centers(rods);
        let normal = (balls[1] - balls[0]).cross(&(balls[2] - balls[0]));
        Tilt::from_normal(&(normal * normal.z.signum()))
    }

    /// Height at which the plane through the ball centres crosses the base axis (m).
    ///
    /// # Arguments
    /// * `rods` – (3) lengths q_k (m)
    #[must_use]
    pub fn plane_height(&self, rods: &[f64; 3]) -> AxisHeight {
        let balls = self.ball_centers(rods);
        let normal = (balls[1] - balls[0]).cross(&(balls[2] - balls[0]));
        AxisHeight(normal.dot(&balls[0]) / normal.z)
    }

    /// Displacements of the virtual joints of a pose from nominal ((m), (rad)).
    #[must_use]
    #[inline]
    pub fn virtual_displacements<V: Virtualization + ?Sized>(
        &self,
        pose: &PlatformPose,
        virtualization: &V,
    ) -> VirtualJoints {
        let x = &pose.solution.virtual_joints;
        let mut moved = VirtualJoints::zeros(x.len());
        virtualization.nominal(self.platform(), &mut moved);
        moved.iter_mut().zip(x.iter()).for_each(|(nominal, x)| *nominal = x - *nominal);
        moved
    }

    /// Displacement of the virtual joints of a pose from nominal, in the metric: √(Σ linear² + ρ² Σ angular²) (m).
    #[must_use]
    pub fn displacement<V: Virtualization + ?Sized>(
        &self,
        pose: &PlatformPose,
        virtualization: &V,
    ) -> f64 {
        let rho = pose.solution.characteristic_length;
        let moved = self.virtual_displacements(pose, virtualization);
        let weighted = moved.iter().zip(virtualization.joints());
        let weighted = weighted.map(|(x, joint)| x * joint.motion.weight(rho));
        sqrt(weighted.map(|length| length * length).sum())
    }
}

impl PlatformPose {
    /// Platform normal e_p3 in the base frame.
    #[must_use]
    pub fn normal(&self) -> Vector3<f64> {
        self.base_from_platform.rotation.matrix().column(2).into_owned()
    }

    /// Tilt of the platform, with tilt angle ≥ 0.
    #[must_use]
    pub fn tilt(&self) -> Tilt {
        Tilt::from_normal(&self.normal())
    }

    /// Torsion: rotation of the platform about its own normal, beyond the shortest rotation to it (rad).
    ///
    /// ```text
    ///    R  =  Rz(γ) Ry(α) Rz(−γ) Rz(τ)
    /// ```
    #[must_use]
    pub fn torsion(&self) -> f64 {
        // R Rz(−τ) is symmetric but for signs: the upper left block of R is the symmetric block of the tilt times a turn.
        let r = self.base_from_platform.rotation.matrix();
        libm::atan2(r[(1, 0)] - r[(0, 1)], r[(0, 0)] + r[(1, 1)])
    }

    /// Height at which the platform plane crosses the base axis (m).
    #[must_use]
    pub fn axis_height(&self) -> AxisHeight {
        let (normal, origin) = (self.normal(), self.base_from_platform.translation.vector);
        AxisHeight(origin.z + (normal.x * origin.x + normal.y * origin.y) / normal.z)
    }

    /// Offset of O_p from the base axis: its e_b1 and e_b2 coordinates (m).
    #[must_use]
    pub fn center_shift(&self) -> Vector2<f64> {
        self.base_from_platform.translation.vector.xy()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::virtualization::{Solver, built_in};

    fn kernel_answers<M: Model>(gpr: &Gpr, rods: &[f64; 3], options: &SolveOptions) -> bool {
        let length = options.metric.characteristic_length(gpr.platform()).unwrap();
        Single::new::<M>(&Task::new::<M>(gpr.dimensions(), options, length), rods).is_some()
    }

    /// The closed equations answer for all usual poses, and what they answer is what the general solver finds.
    #[test]
    fn closed_equations_and_the_general_solver_agree() {
        let gpr = Gpr::paper().without_limit_checks();
        for i in 0..200 {
            let tilt = Tilt { azimuth: 0.7 * f64::from(i), angle: 2e-4 * f64::from(i) };
            let rods = gpr.inverse(tilt, AxisHeight(0.5)).unwrap();
            for solver in [Solver::Newton, Solver::LeastNorm, Solver::ClosedForm] {
                let options = SolveOptions { solver, ..SolveOptions::default() };
                for model in built_in() {
                    let found = gpr.forward(rods, model, &options).unwrap();
                    let expected = gpr.general_pose(rods, model, &options).unwrap();
                    assert_eq!(found.solution.solver, expected.solution.solver);
                    let (a, b) = (found.base_from_platform, expected.base_from_platform);
                    let off = (a.to_homogeneous() - b.to_homogeneous()).amax();
                    assert!(off < 1e-13, "{} {solver} {i}: {off}", model.name());
                    let answers = match model.as_built_in().unwrap() {
                        BuiltIn::Radial => kernel_answers::<kernel::Radial>(&gpr, &rods, &options),
                        BuiltIn::Polar => kernel_answers::<kernel::Polar>(&gpr, &rods, &options),
                        BuiltIn::Offset => kernel_answers::<kernel::Offset>(&gpr, &rods, &options),
                        BuiltIn::Planar => kernel_answers::<kernel::Planar>(&gpr, &rods, &options),
                    };
                    assert!(answers, "{} {solver} {i}", model.name());
                }
            }
        }
    }

    #[test]
    fn a_rod_that_is_no_number() {
        for value in [f64::NAN, f64::INFINITY] {
            let rods = [0.5, value, 0.5];
            let error = Gpr::paper()
                .without_limit_checks()
                .forward(rods, &Planar, &SolveOptions::default())
                .unwrap_err();
            let message = format!("a rod length is {value}, but has to be a finite number");
            assert_eq!(error.to_string(), message);
        }
    }

    #[test]
    fn torsion_is_measured_beyond_the_shortest_rotation() {
        use nalgebra::{Rotation3, Vector3};
        let mut pose = Gpr::paper()
            .without_limit_checks()
            .forward([0.5; 3], &Planar, &SolveOptions::default())
            .unwrap();
        for (azimuth, tilt_angle, torsion) in
            [(0.3, 0.4, 0.1), (2.0, 1.0, -3.0), (-1.0, 0.02, 1e-9)]
        {
            let tilted = tilted_by(azimuth, tilt_angle);
            pose.base_from_platform.rotation =
                tilted * Rotation3::from_axis_angle(&Vector3::z_axis(), torsion);
            assert!((pose.torsion() - torsion).abs() < 1e-15);
        }
    }

    #[test]
    fn the_plane_of_the_rods_is_the_platform_s() {
        let gpr = Gpr::paper().without_limit_checks();
        for (azimuth, tilt_angle, height) in [(0.0, 0.0, 0.5), (0.3, 0.02, 0.4), (-2.0, 1.0, 0.3)] {
            let tilt = Tilt { azimuth, angle: tilt_angle };
            let rods = gpr.inverse(tilt, AxisHeight(height)).unwrap();
            let pose = gpr.forward(rods, &Planar, &SolveOptions::default()).unwrap();
            assert!((gpr.plane_height(&rods).0 - height).abs() < 1e-15);
            assert!((gpr.plane_height(&rods).0 - pose.axis_height().0).abs() < 1e-15);
            assert!((gpr.plane_tilt(&rods).normal() - pose.normal()).norm() < 1e-15);
        }
    }

    fn tilted_by(azimuth: f64, tilt_angle: f64) -> nalgebra::Rotation3<f64> {
        crate::spatial::tilt_rotation(&Tilt { azimuth, angle: tilt_angle }.normal())
    }
}
