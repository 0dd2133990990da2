//! Play that a tilt requires, and its first-order bounds.

use nalgebra::DVector;

use super::{AxisHeight, Gpr, GprSystem, PlatformPose};
use crate::Error;
use crate::constraint::{Configuration, System};
use crate::mobility::RANK_THRESHOLD;
use crate::sensitivity::{Bounds, Sensitivity, sensitivity};
use crate::spatial::Tilt;
use crate::virtualization::{SolveOptions, Virtualization};

/// The virtual displacement of a finite motion, and its first-order bounds.
///
/// Displacements are norms in the metric: √(Σ linear² + ρ² Σ angular²).
/// The bounds depend on where the derivatives are taken.
/// At the level start they are zero, since a tilt lies in the null space there; at the end they are about twice those at the midpoint, since the displacement grows with the square of the tilt; midway they are those of the chord.
#[derive(Debug, Clone, PartialEq)]
pub struct TiltPlay {
    /// The pose that the motion starts from: level.
    pub start: PlatformPose,
    /// The pose that it ends in.
    pub end: PlatformPose,
    /// ‖ΔX‖ from the kinematics, nothing neglected (m).
    pub displacement: f64,
    /// ‖ΔP‖ of the motion (m).
    pub motion: f64,
    /// Bounds with derivatives at the start.
    pub at_start: EvaluatedBounds,
    /// Bounds with derivatives midway.
    pub at_midpoint: EvaluatedBounds,
    /// Bounds with derivatives at the end.
    pub at_end: EvaluatedBounds,
    /// Share of each limb in the chord's dX; `None` where nothing moves.
    pub limb_shares: Option<Vec<f64>>,
    /// Share of each side (12, 23, 31) in the chord's dX; `None` where nothing moves.
    pub side_shares: Option<Vec<f64>>,
}

/// First-order bounds, and whether the true displacement satisfies them.
#[derive(Debug, Clone, PartialEq)]
pub struct EvaluatedBounds {
    /// ∂X/∂P where the bounds were taken.
    pub sensitivity: Sensitivity,
    /// The bounds.
    pub bounds: Bounds,
    /// Whether the true displacement lies within (5).
    pub held: bool,
}

/// Slack of "held", as a share: the chord is exact only to the curvature of the virtual joints, of relative size 10⁻⁴ at 2°.
const SLACK: f64 = 1e-3;

impl Gpr {
    /// Displacement of the virtual joints from level to a tilt at the same axis height, with the first-order bounds.
    ///
    /// # Errors
    /// As [`Self::inverse`] and [`Self::forward`].
    ///
    /// # Source
    /// \[Virtualization\], eq. (3)–(5); the chord is own derivation, `docs/explanation/kinematics.md`
    pub fn tilt_play<V: Virtualization + ?Sized>(
        &self,
        tilt: Tilt,
        height: AxisHeight,
        virtualization: &V,
        options: &SolveOptions,
    ) -> Result<TiltPlay, Error> {
        let start = self.forward(self.inverse(Tilt::LEVEL, height)?, virtualization, options)?;
        let end = self.forward(self.inverse(tilt, height)?, virtualization, options)?;
        self.play_between(start, end, virtualization)
    }

    /// Displacement of the virtual joints between two poses, with the first-order bounds.
    ///
    /// # Errors
    /// [`Error::NotFinite`].
    pub fn play_between<V: Virtualization + ?Sized>(
        &self,
        start: PlatformPose,
        end: PlatformPose,
        virtualization: &V,
    ) -> Result<TiltPlay, Error> {
        let system = self.system(virtualization);
        let (from, to) = (system.configuration(&start), system.configuration(&end));
        let middle = system.midpoint(&from, &to)?;
        let characteristic_length = end.solution.characteristic_length;
        let step = &to.coordinates - &from.coordinates;
        let moved = &to.virtual_joints - &from.virtual_joints;
        let displacement = moved
            .iter()
            .zip(virtualization.joints())
            .map(|(x, joint)| (x * joint.motion.weight(characteristic_length)).powi(2))
            .sum::<f64>()
            .sqrt();
        let at_midpoint = bounded(&system, &middle, &step, displacement, characteristic_length)?;
        let limbs = [0, 1, 2].map(GprSystem::<V>::limb_coordinates);
        let limbs = limbs.each_ref().map(|limb| &limb[..]);
        let sides = [0, 1, 2].map(GprSystem::<V>::side_constraint);
        Ok(TiltPlay {
            start,
            end,
            displacement,
            motion: step.norm(),
            limb_shares: at_midpoint.sensitivity.shares_by_coordinates(&step, &limbs)?,
            side_shares: at_midpoint.sensitivity.shares_by_constraints(&step, &sides)?,
            at_start: bounded(&system, &from, &step, displacement, characteristic_length)?,
            at_midpoint,
            at_end: bounded(&system, &to, &step, displacement, characteristic_length)?,
        })
    }
}

fn bounded<S: System>(
    system: &S,
    at: &Configuration,
    step: &DVector<f64>,
    displacement: f64,
    characteristic_length: f64,
) -> Result<EvaluatedBounds, Error> {
    let sensitivity = sensitivity(system, at, characteristic_length, RANK_THRESHOLD)?;
    let bounds = sensitivity.bounds(step)?;
    Ok(EvaluatedBounds { held: bounds.hold(displacement, SLACK), sensitivity, bounds })
}
