//! Forward kinematics prepared for many calls.

use super::forward::Work;
use super::{Column, Quantity, Status, StatusCounts};
use crate::Error;
use crate::gpr::{Gpr, PlatformPose, ball_sides, solution};
use crate::kernel::{self, FirstStep, JointPolynomials, Model, SingleJoints, SinglePose, Task};
use crate::virtualization::{BuiltIn, Solution, SolveOptions, Solver, VirtualJoints, solve};

/// Relative threshold of the interpolated poses: some ten times round-off.
const SAMPLE_THRESHOLD: f64 = 4e-15;
/// Largest slope of the polynomials, as a multiple of that at the largest tilt: analyses look a little beyond.
const SLOPE_MARGIN: f64 = 1.4;

/// Forward kinematics of one robot under one virtualization, prepared for many calls.
///
/// Newton's method has its first step from nominal prepared, which is the same for all poses.
/// The least displacement is a smooth function of the slopes of the plane through the balls near level: it is interpolated by polynomials, to 10⁻¹³ of the longest side; Newton's method takes as long as they do.
/// Each pose is checked: where its sides are not met, or the tilt is larger, it is computed as by [`Gpr::forward`].
///
/// ```
/// use jointplay_core::bulk::PoseSolver;
/// use jointplay_core::gpr::Gpr;
/// use jointplay_core::virtualization::{BuiltIn, SolveOptions};
///
/// let solver = PoseSolver::new(&Gpr::paper(), BuiltIn::Polar, &SolveOptions::default())?;
/// let pose = solver.forward([0.5, 0.501, 0.499])?;
/// assert!(pose.tilt().angle > 0.0);
/// # Ok::<(), jointplay_core::Error>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct PoseSolver {
    gpr: Gpr,
    virtualization: BuiltIn,
    options: SolveOptions,
    characteristic_length: f64,
    first_step: Option<FirstStep>,
    polynomials: Option<JointPolynomials>,
}

impl PoseSolver {
    /// Prepares a robot: for least displacements, some hundred poses are computed.
    ///
    /// # Errors
    /// [`Error::NotFinite`], [`Error::OutOfRange`] for the metric.
    pub fn new(gpr: &Gpr, virtualization: BuiltIn, options: &SolveOptions) -> Result<Self, Error> {
        let characteristic_length = options.metric.characteristic_length(gpr.platform())?;
        let model = virtualization.model();
        let mut solver = Self {
            gpr: gpr.clone(),
            virtualization,
            options: *options,
            characteristic_length,
            first_step: FirstStep::new(gpr.platform(), model, characteristic_length),
            polynomials: None,
        };
        let smooth = match virtualization {
            BuiltIn::Radial => solver.has_polynomials::<kernel::Radial>(),
            BuiltIn::Polar => solver.has_polynomials::<kernel::Polar>(),
            BuiltIn::Offset => solver.has_polynomials::<kernel::Offset>(),
            BuiltIn::Planar => solver.has_polynomials::<kernel::Planar>(),
        };
        if smooth {
            solver.polynomials = solver.interpolated();
        }
        Ok(solver)
    }

    /// Whether the virtual joints are least displacements that polynomials can replace.
    fn has_polynomials<M: Model>(&self) -> bool {
        M::SETTLES && self.task::<M>().solver == Solver::LeastNorm
    }

    /// The virtual joints as polynomials.
    fn interpolated(&self) -> Option<JointPolynomials> {
        let (gpr, model) = (&self.gpr, self.virtualization.model());
        let tight = SolveOptions { relative_threshold: SAMPLE_THRESHOLD, ..self.options };
        let joints = |slope: [f64; 2]| -> Option<VirtualJoints> {
            let rods = gpr.base_points().map(|point| point.x * slope[0] + point.y * slope[1]);
            let sides = ball_sides(&gpr.ball_centers(&rods));
            Some(solve(model, gpr.platform(), &sides, &tight).ok()?.virtual_joints)
        };
        let radius = gpr.platform().mean_radius();
        let weights: Vec<f64> =
            model.joints().iter().map(|joint| joint.motion.weight(radius)).collect();
        JointPolynomials::new(
            &gpr.dimensions().base_edges,
            SLOPE_MARGIN * gpr.steepest(),
            &weights,
            joints,
        )
    }

    /// Pose of the platform for given rods; see [`Gpr::forward`].
    ///
    /// # Errors
    /// Those of [`Gpr::forward`].
    pub fn forward(&self, rods: [f64; 3]) -> Result<PlatformPose, Error> {
        self.gpr.check_rods(&rods)?;
        match self.virtualization {
            BuiltIn::Radial => self.pose::<kernel::Radial>(rods),
            BuiltIn::Polar => self.pose::<kernel::Polar>(rods),
            BuiltIn::Offset => self.pose::<kernel::Offset>(rods),
            BuiltIn::Planar => self.pose::<kernel::Planar>(rods),
        }
    }

    /// Virtual joints for given rods; see [`Gpr::virtual_joints`].
    ///
    /// # Errors
    /// Those of [`Gpr::forward`].
    pub fn virtual_joints(&self, rods: [f64; 3]) -> Result<Solution, Error> {
        self.gpr.check_rods(&rods)?;
        match self.virtualization {
            BuiltIn::Radial => self.joints::<kernel::Radial>(rods),
            BuiltIn::Polar => self.joints::<kernel::Polar>(rods),
            BuiltIn::Offset => self.joints::<kernel::Offset>(rods),
            BuiltIn::Planar => self.joints::<kernel::Planar>(rods),
        }
    }

    /// Platform poses for many sets of rods; see [`Gpr::forward_many`].
    ///
    /// # Errors
    /// Those of [`Gpr::forward_many`].
    pub fn forward_many(
        &self,
        rods: [Column<'_>; 3],
        status: &mut [Status],
        wanted: &mut [(Quantity, &mut [f64])],
    ) -> Result<StatusCounts, Error> {
        Work {
            gpr: &self.gpr,
            rods,
            virtualization: self.virtualization.model(),
            options: &self.options,
            polynomials: self.polynomials.as_ref(),
            status,
            wanted,
        }
        .compute()
    }

    #[inline(always)]
    fn task<M: Model>(&self) -> Task<'_> {
        let task = Task::new::<M>(self.gpr.dimensions(), &self.options, self.characteristic_length);
        let first_step = self.first_step.as_ref();
        Task { first_step, polynomials: self.polynomials.as_ref(), ..task }
    }

    #[inline]
    fn pose<M: Model>(&self, rods: [f64; 3]) -> Result<PlatformPose, Error> {
        self.gpr.dimensions().processor.run(
            #[inline(always)]
            || {
                let task = self.task::<M>();
                match SinglePose::new::<M>(&task, &rods) {
                    Some(found) => {
                        Ok(self.gpr.found_pose(rods, &task, self.characteristic_length, found))
                    }
                    None => self.gpr.forward(rods, self.virtualization.model(), &self.options),
                }
            },
        )
    }

    #[inline]
    fn joints<M: Model>(&self, rods: [f64; 3]) -> Result<Solution, Error> {
        self.gpr.dimensions().processor.run(
            #[inline(always)]
            || {
                let task = self.task::<M>();
                match SingleJoints::new::<M>(&task, &rods) {
                    Some(found) => Ok(solution(&task, self.characteristic_length, found)),
                    None => {
                        self.gpr.virtual_joints(rods, self.virtualization.model(), &self.options)
                    }
                }
            },
        )
    }
}
