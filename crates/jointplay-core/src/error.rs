//! Errors of the core, as facts.

use crate::gpr::BrokenLimits;
#[cfg(feature = "std")]
use crate::linalg::LinalgError;
use crate::virtualization::{Solver, VirtualJoints};

/// The fault of limits whose least value is not below the greatest, for messages: "an empty range" where both are equal, "reversed" otherwise.
#[must_use]
pub fn range_fault(min: f64, max: f64) -> &'static str {
    if min == max { "an empty range" } else { "reversed" }
}

/// Why a computation has no result. Lengths are in m, angles in rad.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// A number is NaN or infinite.
    #[error("{what} is {value}, but has to be a finite number")]
    NotFinite {
        /// Which number.
        what: &'static str,
        /// What was found.
        value: f64,
    },
    /// A length whose products with others would overflow.
    #[error("{what} is {value:e} m, but has to lie within ±{max:e} m")]
    TooLong {
        /// Which length.
        what: &'static str,
        /// What was found (m).
        value: f64,
        /// Greatest allowed magnitude (m).
        max: f64,
    },
    /// A length that has to be positive is not.
    #[error("{what} of limb {limb} is {value} m, but has to be positive")]
    NotPositive {
        /// Which length.
        what: &'static str,
        /// Limb, counted from 1.
        limb: usize,
        /// What was found (m).
        value: f64,
    },
    /// Three points lie on one line, or so near that they fix no plane.
    #[error(
        "the three {what} lie on one line: their triangle is {height_to_base} times as high as it is long, at least {allowed} is needed"
    )]
    Collinear {
        /// Which points.
        what: &'static str,
        /// Height of the triangle over its longest side, as a share of that side.
        height_to_base: f64,
        /// The least share allowed.
        allowed: f64,
    },
    /// Base points and sockets run round in opposite senses, so that no upright platform fits.
    #[error(
        "base points and sockets run round in opposite senses: number the sockets in the order of the base points"
    )]
    OppositeSenses,
    /// A lower limit is not below its upper limit.
    #[error("the {what} limits are {}: least {min} m, most {max} m", range_fault(*.min, *.max))]
    LimitsReversed {
        /// Which limits.
        what: &'static str,
        /// Lower limit (m).
        min: f64,
        /// Upper limit (m).
        max: f64,
    },
    /// A number that has to lie within limits does not.
    #[error("the {what} is {value} {unit}, but has to lie from {min} to {max} {unit}")]
    OutOfRange {
        /// Which number.
        what: &'static str,
        /// What was found, in `unit`.
        value: f64,
        /// Least allowed value, in `unit`.
        min: f64,
        /// Greatest allowed value, in `unit`.
        max: f64,
        /// `m` or `rad`.
        unit: &'static str,
    },
    /// A pose beyond the robot's limits.
    #[error("the pose is beyond the robot's limits: {0}; lengths are in m and angles in rad")]
    BeyondLimits(BrokenLimits),
    /// A tilt at which the rods no longer meet the platform plane.
    #[error("the tilt angle is {tilt_angle} rad, but has to stay within ±π/2")]
    TiltTooLarge {
        /// Tilt angle asked for (rad).
        tilt_angle: f64,
    },
    /// A vector with too many or too few entries.
    #[error("{what} has {found} entries, but {expected} are needed")]
    LengthMismatch {
        /// Which vector.
        what: &'static str,
        /// How many entries it has.
        found: usize,
        /// How many it needs.
        expected: usize,
    },
    /// A quantity that a pose does not have.
    #[error("there is no {what} {index}: they are counted from 0, and there are {count}")]
    NoSuchQuantity {
        /// Requested quantity.
        what: &'static str,
        /// Which of them, counted from 0.
        index: usize,
        /// How many there are.
        count: usize,
    },
    /// A virtualization with too few or too many virtual joints.
    #[error("the virtualization has {found} virtual joints, but needs {min} to {max}")]
    VirtualJointCount {
        /// How many it has.
        found: usize,
        /// Least number: one for each side.
        min: usize,
        /// Greatest number that the solvers hold without allocating.
        max: usize,
    },
    /// A configuration that breaks the constraints it should satisfy.
    #[error(
        "the configuration breaks the constraints: scaled residual {residual}, at most {allowed} is allowed; close the loops first"
    )]
    NotClosed {
        /// Largest constraint residual, in units of the characteristic length.
        residual: f64,
        /// Largest that is taken as closed.
        allowed: f64,
    },
    /// A tolerance of the dimensions too small to be distinguished from round-off, or too large to be one.
    #[error(
        "the tolerance is {found:e}, but has to lie from {min:e} to {max:e} (radians and characteristic lengths)"
    )]
    Tolerance {
        /// What was found.
        found: f64,
        /// Least that is taken.
        min: f64,
        /// Greatest that is taken.
        max: f64,
    },
    /// Virtual joints that produce the sides, but mirror the triangle of the sockets.
    #[error(
        "the virtual joints found for these sides turn the platform over; the pose is too far from the nominal one"
    )]
    TurnedOver {
        /// The virtual joints found ((m), (rad)).
        virtual_joints: VirtualJoints,
    },
    /// Virtual joints that cannot change the three sides independently, at least as the metric weighs them.
    #[error(
        "the virtual joints cannot change the three sides independently after {iterations} iterations; a characteristic length of {characteristic_length} m may weigh angles too lightly or too heavily"
    )]
    DependentSides {
        /// ρ of the metric (m).
        characteristic_length: f64,
        /// Iterations done.
        iterations: usize,
    },
    /// Derivatives by closed forms of a virtualization that has none.
    #[error(
        "derivatives of the pose exist for the virtualizations radial, polar, offset and planar only; for another one, take differences of poses"
    )]
    OwnVirtualization,
    /// Derivatives of virtual joints that depend on the iteration that found them.
    #[error(
        "the newton solver chooses one of many solutions for {virtual_joints} virtual joints by its iteration, so that its derivatives follow from no equation; solve by closed-form or least-norm first"
    )]
    NewtonSolution {
        /// How many virtual joints there are, for three sides.
        virtual_joints: usize,
    },
    /// The iteration for the virtual joints did not converge.
    #[cfg(feature = "std")]
    #[error(transparent)]
    NotConverged(Box<Unconverged>),
    /// The iteration for the virtual joints did not converge; held here where there is no heap.
    #[cfg(not(feature = "std"))]
    #[error(transparent)]
    NotConverged(#[from] Unconverged),
    /// A mechanism that dense algebra would work on for hours.
    #[error(
        "the mechanism has {found} {what}, but at most {allowed} are taken here: these matrices are dense, and their cost grows with the cube; mobility, instantaneous motions, closing and driving have sparse algebra for more; for the others, use a mechanism with fewer loops, such as one of its stages"
    )]
    TooLarge {
        /// Name of the parts that are too many.
        what: &'static str,
        /// How many there are.
        found: usize,
        /// How many may be.
        allowed: usize,
    },
    /// A mechanism for which sparse algebra would need too much memory or time.
    #[error(
        "loops and couplings connect too many parts of the mechanism: at least {found} {what}, but at most {allowed} are computed"
    )]
    TooConnected {
        /// Name of the parts that are too many.
        what: &'static str,
        /// How many were found; there may be more.
        found: usize,
        /// How many may be.
        allowed: usize,
    },
    /// The loops of a mechanism could not be closed.
    #[cfg(feature = "std")]
    #[error(transparent)]
    NotAssembled(#[from] Box<crate::mechanism::Unassembled>),
    /// Virtual joints that do not make a commanded motion possible.
    #[cfg(feature = "std")]
    #[error("{}", not_relieved(*residual, *allowed, couplings))]
    NotRelieved {
        /// Largest mismatch that is left.
        residual: f64,
        /// Largest that counts as closed.
        allowed: f64,
        /// Names of the couplings that the commanded values contradict, the most violated first; play at joints does not relieve them.
        couplings: Vec<String>,
    },
    /// Virtual joints that close the loops for a command, but whose least displacement was not found.
    #[error(
        "the virtual joints can close the loops for this command, but their least displacement was not found in {iterations} steps; command a smaller motion"
    )]
    NotLeast {
        /// Steps done.
        iterations: usize,
    },
    /// A joint without a stiffness that a rank by stiffness needs.
    #[cfg(feature = "std")]
    #[error(
        "joint {joint:?} has no {direction} stiffness, which a rank by stiffness needs: add `stiffness = {{ {direction} = … }}` in {unit} to the joint, or give a stiffness for all joints without one"
    )]
    NoStiffness {
        /// The joint.
        joint: String,
        /// `linear` or `angular`.
        direction: &'static str,
        /// `N/m` or `N m/rad`.
        unit: &'static str,
    },
    /// Newton's method did not close the loops; the coordinates given hold its best iterate.
    #[error(
        "the loops stay open by {residual:.3e} (radians and characteristic lengths) after {iterations} steps, {allowed:.0e} is asked for; start nearer to a closed configuration"
    )]
    NotReached {
        /// Largest mismatch that is left.
        residual: f64,
        /// Largest that counts as closed.
        allowed: f64,
        /// Steps done.
        iterations: usize,
    },
    /// Commanded values that no motion leads to: it ends at a dead point, or leaves its branch.
    #[error(
        "the motion toward the commanded values ends after a share of {share:.6} of the path; command values nearer to the start"
    )]
    NotFollowed {
        /// Share of the path that is possible, from 0 to 1.
        share: f64,
    },
    /// The caller ended the computation.
    #[error("the computation was ended before it was done")]
    Interrupted,
    /// One or two of the three coordinates of a ball are commanded.
    #[error(
        "some coordinates of the ball at coordinate {coordinate} are commanded, but a rotation vector is commanded whole or not at all"
    )]
    PartlyCommanded {
        /// First coordinate of the ball.
        coordinate: usize,
    },
    /// Commanded coordinates that do not determine the motion.
    #[cfg(feature = "std")]
    #[error(transparent)]
    Undetermined(#[from] Box<crate::mechanism::Undetermined>),
    /// Rates of commanded coordinates that the loops do not allow together.
    #[error(
        "the loops do not allow these rates of the commanded coordinates: a share of {share:.3e} of them opens the loops, allowed is {allowed:.0e}; command fewer coordinates, or add virtual joints"
    )]
    DependentCommands {
        /// Share of the commanded rates that opens the loops.
        share: f64,
        /// Largest share that counts as round-off.
        allowed: f64,
    },
    /// A dimension that the loops do not allow to change alone.
    #[error(
        "changing this dimension opens the loops: a share of {share:.3e} of the change is followed by no coordinate, allowed is {allowed:.0e}; the loops close for its value only, so change others with it, or add virtual joints"
    )]
    DimensionOpensLoops {
        /// Share of the change that opens the loops.
        share: f64,
        /// Largest share that counts as round-off.
        allowed: f64,
    },
    /// A dimension with which the mechanism does not change smoothly.
    #[error(
        "the mechanism has no derivative by this dimension here: changes by steps of different sizes disagree by a share of {share:.3e}; the value is at a jump, a kink or the end of its range"
    )]
    NotSmooth {
        /// Share of the change by which steps disagree.
        share: f64,
    },
    /// A changed mechanism that is another one.
    #[error("the changed mechanism has other links, joints or frames; only dimensions may change")]
    OtherMechanism,
    /// A configuration in which virtual joints close the loops, but not with the least displacement.
    #[error(
        "the virtual joints are not at their least displacement: it is missed by {excess:.3e} (radians and characteristic lengths), allowed is {allowed:.3e}; solve for the configuration by least norm first"
    )]
    NotLeastDisplacement {
        /// Gradient of the size of the displacement along the motions that the loops leave.
        excess: f64,
        /// Largest gradient that is taken as none.
        allowed: f64,
    },
    /// Derivatives asked for before what they depend on.
    #[error(
        "there is no configuration yet: linearize at a closed one first, then compute velocities, then accelerations"
    )]
    NotLinearized,
    /// A matrix without a decomposition.
    #[cfg(feature = "std")]
    #[error(transparent)]
    Linalg(#[from] LinalgError),
}

impl Error {
    /// Whether the input is valid and has no solution, as opposed to invalid input.
    #[must_use]
    pub fn is_infeasible(&self) -> bool {
        #[cfg(feature = "std")]
        if matches!(self, Self::NotAssembled(_) | Self::Undetermined(_) | Self::NotRelieved { .. })
        {
            return true;
        }
        matches!(
            self,
            Self::NotConverged(_)
                | Self::DependentSides { .. }
                | Self::TurnedOver { .. }
                | Self::BeyondLimits(_)
                | Self::NotLeast { .. }
                | Self::NotReached { .. }
                | Self::NotFollowed { .. }
                | Self::DependentCommands { .. }
        )
    }
}

#[cfg(feature = "std")]
impl From<Unconverged> for Error {
    fn from(found: Unconverged) -> Self {
        // A pointer, so that errors that occur more often stay small.
        Self::NotConverged(Box::new(found))
    }
}

/// The best that an iteration for the virtual joints found before it gave up.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[error(
    "the {solver} iteration did not converge in {iterations} steps: the sides are {residual} m off at best, {threshold} m is asked for; the pose is too far from the nominal one, or the virtual joints cannot produce these sides"
)]
pub struct Unconverged {
    /// Which iteration.
    pub solver: Solver,
    /// Virtual joints with the least residual found, in their own units ((m), (rad)).
    pub best: VirtualJoints,
    /// Largest difference between a side and its virtual length at `best` (m).
    pub residual: f64,
    /// Residual asked for (m).
    pub threshold: f64,
    /// Iterations done.
    pub iterations: usize,
}

/// The largest length that is computed with (m), so that no product of lengths overflows.
pub(crate) const LARGEST_LENGTH: f64 = 1e50;

/// `value` if it is a finite length of at most [`LARGEST_LENGTH`].
pub(crate) fn length(what: &'static str, value: f64) -> Result<f64, Error> {
    if finite(what, value)?.abs() <= LARGEST_LENGTH {
        return Ok(value);
    }
    Err(Error::TooLong { what, value, max: LARGEST_LENGTH })
}

/// Whether all indices are of things that there are.
pub(crate) fn indices(what: &'static str, indices: &[usize], count: usize) -> Result<(), Error> {
    match indices.iter().find(|&&index| index >= count) {
        Some(&index) => Err(Error::NoSuchQuantity { what, index, count }),
        None => Ok(()),
    }
}

/// `value` if finite.
pub(crate) fn finite(what: &'static str, value: f64) -> Result<f64, Error> {
    if value.is_finite() { Ok(value) } else { Err(Error::NotFinite { what, value }) }
}

#[cfg(feature = "std")]
fn not_relieved(residual: f64, allowed: f64, couplings: &[String]) -> String {
    let found = format!(
        "the smallest mismatch found is {residual:.3e} (radians and characteristic lengths), allowed is {allowed:.0e}"
    );
    let names: Vec<String> = couplings.iter().map(|name| format!("{name:?}")).collect();
    match names.len() {
        0 => format!(
            "the virtual joints do not close the loops for this command: {found}; command a smaller motion, or add virtual joints"
        ),
        1 => format!(
            "the commanded values contradict coupling {}, which play at joints does not relieve: {found}; command values that satisfy it",
            names[0]
        ),
        _ => format!(
            "the commanded values contradict couplings {}, which play at joints does not relieve: {found}; command values that satisfy them",
            names.join(", ")
        ),
    }
}
