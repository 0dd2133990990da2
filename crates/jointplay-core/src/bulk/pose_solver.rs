//! Forward kinematics prepared for many calls.

use std::marker::PhantomData;

use pulp::{Simd, WithSimd};

use super::forward::Work;
use super::{Column, Quantity, Status, StatusCounts};
use crate::Error;
use crate::gpr::{Gpr, PlatformPose, solution};
use crate::kernel::{self, FirstStep, JointPolynomials, Model, Sample, Single, Task};
use crate::virtualization::{BuiltIn, Solution, SolveOptions};

/// Relative threshold of the interpolated poses: some ten times round-off.
const SAMPLE_THRESHOLD: f64 = 4e-15;
/// Largest slope of the polynomials, as a multiple of that at the largest tilt: analyses look a little beyond.
const SLOPE_MARGIN: f64 = 1.4;

/// Forward kinematics of one robot under one virtualization, prepared for many calls.
///
/// The virtual joints, and the place of the platform in the plane through the balls, are smooth functions of the slopes of this plane near level: they are interpolated by polynomials, to 10⁻¹³ of the longest side.
/// Single poses use them with every solver; many poses where they reach the largest tilt of the robot, and no closed form is asked for, which takes less time.
/// The first step of Newton's method is prepared for many poses.
/// The sides of each pose are checked: where they are not met, or the tilt is larger, or there are no polynomials, it is computed as by [`Gpr::forward`].
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
    pub(super) polynomials: Option<JointPolynomials>,
}

impl PoseSolver {
    /// Prepares a robot: some hundred poses are computed.
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
        let settles = match virtualization {
            BuiltIn::Radial => kernel::Radial::SETTLES,
            BuiltIn::Polar => kernel::Polar::SETTLES,
            BuiltIn::Offset => kernel::Offset::SETTLES,
            BuiltIn::Planar => kernel::Planar::SETTLES,
        };
        if settles {
            solver.polynomials = solver.interpolated();
        }
        Ok(solver)
    }

    /// The virtual joints as polynomials.
    fn interpolated(&self) -> Option<JointPolynomials> {
        let (gpr, model) = (&self.gpr, self.virtualization.model());
        let tight = SolveOptions { relative_threshold: SAMPLE_THRESHOLD, ..self.options };
        let sample = |slope: [f64; 2]| -> Option<Sample> {
            let rods = gpr.base_points().map(|point| point.x * slope[0] + point.y * slope[1]);
            let pose = gpr.general_pose(rods, model, &tight).ok()?;
            let virtual_joints = pose.solution.virtual_joints;
            let [a, b, c] = model.sockets(gpr.platform(), &virtual_joints);
            let center = ((a + b + c) / 3.0).into();
            Some(Sample { virtual_joints, torsion: pose.torsion(), center })
        };
        let radius = gpr.platform().mean_radius();
        let weights: Vec<f64> =
            model.joints().iter().map(|joint| joint.motion.weight(radius)).collect();
        JointPolynomials::new(
            &gpr.dimensions().base_edges,
            SLOPE_MARGIN * gpr.steepest(),
            &weights,
            radius,
            sample,
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
            first_step: self.first_step.as_ref(),
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
        Task { first_step, ..task }
    }

    #[inline]
    fn pose<M: Model>(&self, rods: [f64; 3]) -> Result<PlatformPose, Error> {
        let call = PoseCall::<M> { solver: self, rods, model: PhantomData };
        self.gpr.dimensions().processor.run_wide(call)
    }

    #[inline]
    fn joints<M: Model>(&self, rods: [f64; 3]) -> Result<Solution, Error> {
        let call = JointsCall::<M> { solver: self, rods, model: PhantomData };
        self.gpr.dimensions().processor.run_wide(call)
    }

    /// By the polynomials, or by the solver where a model never has any.
    #[inline(always)]
    fn single<S: Simd, M: Model, const POSE: bool>(
        &self,
        simd: S,
        task: &Task<'_>,
        rods: &[f64; 3],
    ) -> Option<Single> {
        if M::SETTLES {
            let polynomials = self.polynomials.as_ref()?;
            Single::by_polynomials::<S, M, POSE>(simd, task, polynomials, rods)
        } else {
            Single::new::<M>(task, rods)
        }
    }
}

/// One pose of a prepared solver.
struct PoseCall<'s, M> {
    solver: &'s PoseSolver,
    rods: [f64; 3],
    model: PhantomData<M>,
}

impl<M: Model> WithSimd for PoseCall<'_, M> {
    type Output = Result<PlatformPose, Error>;

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) -> Self::Output {
        let Self { solver, rods, .. } = self;
        let task = solver.task::<M>();
        match solver.single::<S, M, true>(simd, &task, &rods) {
            Some(found) => {
                let found = found.pose::<M>(task.geometry);
                Ok(solver.gpr.found_pose(rods, &task, solver.characteristic_length, found))
            }
            None => solver.gpr.forward(rods, solver.virtualization.model(), &solver.options),
        }
    }
}

/// The virtual joints of one pose of a prepared solver.
struct JointsCall<'s, M> {
    solver: &'s PoseSolver,
    rods: [f64; 3],
    model: PhantomData<M>,
}

impl<M: Model> WithSimd for JointsCall<'_, M> {
    type Output = Result<Solution, Error>;

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) -> Self::Output {
        let Self { solver, rods, .. } = self;
        let task = solver.task::<M>();
        match solver.single::<S, M, false>(simd, &task, &rods) {
            Some(found) => {
                let found = found.joints::<M>(task.geometry);
                Ok(solution(&task, solver.characteristic_length, found))
            }
            None => solver.gpr.virtual_joints(rods, solver.virtualization.model(), &solver.options),
        }
    }
}
