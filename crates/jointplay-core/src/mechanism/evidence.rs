//! Evidence of mobility: motion of a link, class of the mechanism.

use nalgebra::{DMatrix, DVector, Rotation3, Translation3, Vector3};

use super::MechanismSystem;
use crate::Error;
use crate::linalg::svd;
use crate::mobility::{FiniteMobility, InstantaneousMobility};
use crate::spatial::Pose;

/// Twists below this share of the largest count as zero.
const NOTHING: f64 = 1e-9;

/// Class of a mechanism by its mobility at a configuration.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum MobilityClass {
    /// No mobility, finite or instantaneous, and no redundant constraint.
    Rigid,
    /// No mobility, and some constraints are redundant.
    OverconstrainedRigid,
    /// Infinitesimally mobile: instantaneous mobility exceeds finite mobility.
    InfinitesimallyMobile,
    /// Movable, all constraints independent.
    Movable,
    /// Movable although some constraints are redundant.
    OverconstrainedMovable,
    /// Branches of different freedom meet here, so that the mechanism can change its mobility.
    Kinematotropic,
    /// The bounds of the finite mobility differ: some motion is neither found nor excluded.
    Undecided,
}

impl MobilityClass {
    /// The class that follows from a finite mobility with its evidence.
    #[must_use]
    pub fn classify(found: &FiniteMobility) -> Self {
        Self::from_mobilities(
            found.mobility,
            found.instantaneous.mobility,
            found.instantaneous.redundancy,
        )
    }

    /// The class that follows from finite mobility, instantaneous mobility, and redundancy.
    #[must_use]
    pub fn from_mobilities(finite: Option<usize>, instantaneous: usize, redundancy: usize) -> Self {
        match (finite, redundancy) {
            (None, _) => Self::Undecided,
            (Some(finite), _) if finite < instantaneous => Self::InfinitesimallyMobile,
            (Some(0), 0) => Self::Rigid,
            (Some(0), _) => Self::OverconstrainedRigid,
            (Some(_), 0) => Self::Movable,
            (Some(_), _) => Self::OverconstrainedMovable,
        }
    }

    /// The class once the dimensions of the branches that meet are known, see [`crate::mobility::branch_dimensions`].
    #[must_use]
    pub fn with_branches(self, dimensions: &[usize]) -> Self {
        if dimensions.len() > 1 { Self::Kinematotropic } else { self }
    }

    /// The class in words.
    #[must_use]
    pub fn description(self) -> &'static str {
        match self {
            Self::Rigid => "rigid",
            Self::OverconstrainedRigid => "overconstrained and rigid",
            Self::InfinitesimallyMobile => {
                "infinitesimally mobile: some motions are only instantaneous"
            }
            Self::Movable => "movable",
            Self::OverconstrainedMovable => "overconstrained and movable",
            Self::Kinematotropic => {
                "branches of different freedom meet here: a kinematotropic candidate"
            }
            Self::Undecided => "undecided: the bounds of the finite mobility differ",
        }
    }
}

/// Instantaneous motion of a link.
#[derive(Debug, Clone, PartialEq)]
pub struct LinkMotion {
    /// Dimension of its twists.
    pub dimension: usize,
    /// How many independent pure translations are among them.
    pub translations: usize,
    /// (6, dimension) orthonormal twists (angular, linear over the characteristic length) at the reference point, in the base frame.
    pub twists: DMatrix<f64>,
    /// Screw of a single freedom; `None` for a translation or several freedoms.
    pub screw: Option<ScrewAxis>,
}

/// Axis of the screw motion of a link.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ScrewAxis {
    /// Pitch (m/rad).
    pub pitch: f64,
    /// A point of the axis, in the base frame (m).
    pub point: Vector3<f64>,
}

/// (6, mobility) twist of a link in each instantaneous motion (angular, linear over the characteristic length) at the reference point, in the base frame.
fn link_twists(
    system: &MechanismSystem<'_>,
    first: &InstantaneousMobility,
    link: usize,
) -> DMatrix<f64> {
    let kinematics = system.kinematics();
    let total = system.home().len();
    let placed =
        kinematics.placed(system.home(), &DVector::zeros(total), &system.reference(), None);
    let length = first.characteristic_length;
    let mut twists = DMatrix::zeros(6, first.mobility);
    for motion in 0..first.mobility {
        for (j, sense) in kinematics.path_to(link) {
            for k in kinematics.columns_of(j).filter(|&k| k < first.null_space.nrows()) {
                let unit = kinematics.dimensions()[k].unit(length);
                let rate = sense * first.null_space[(k, motion)] * unit;
                let (angular, linear) = placed.screws[k];
                for axis in 0..3 {
                    twists[(axis, motion)] += rate * angular[axis];
                    twists[(3 + axis, motion)] += rate * linear[axis] / length;
                }
            }
        }
    }
    twists
}

/// Largest twist of a link in a drawn motion, in radians and characteristic lengths.
const DRAWN: f64 = 0.15;

/// Poses of the links displaced along an instantaneous motion, each link as a rigid body: for pictures, in which joints open where the motion is only instantaneous.
///
/// # Arguments
/// * `motion` – index of the motion in the null space
/// * `share` – -1 to 1: at 1 the largest twist of a link is 0.15, in radians and characteristic lengths
///
/// # Errors
/// [`Error::NoSuchQuantity`] for an unknown motion; those of [`super::Kinematics::link_poses`].
pub fn poses_along_motion(
    system: &MechanismSystem<'_>,
    first: &InstantaneousMobility,
    motion: usize,
    share: f64,
) -> Result<Vec<Pose>, Error> {
    if motion >= first.mobility {
        let (what, count) = ("instantaneous motion", first.mobility);
        return Err(Error::NoSuchQuantity { what, index: motion, count });
    }
    let links = system.kinematics().link_poses(system.home())?;
    let twist = |link: usize| link_twists(system, first, link).column(motion).into_owned();
    let twists: Vec<_> = (0..links.len()).map(twist).collect();
    let size =
        |twist: &DVector<f64>| twist.fixed_rows::<3>(0).norm().max(twist.fixed_rows::<3>(3).norm());
    let largest = twists.iter().map(size).fold(0.0, f64::max);
    if largest == 0.0 {
        return Ok(links);
    }
    let (reference, length) = (system.reference(), first.characteristic_length);
    let displaced = links.iter().zip(&twists).map(|(pose, twist)| {
        let by = twist * (share * DRAWN / largest);
        let rotation = Rotation3::new(by.fixed_rows::<3>(0).into_owned());
        let shift = reference + by.fixed_rows::<3>(3) * length - rotation * reference;
        Pose::from_parts(Translation3::from(shift), rotation) * pose
    });
    Ok(displaced.collect())
}

/// The instantaneous motions of a link: dimension, translations among them, the screw of a single freedom.
///
/// # Errors
/// [`Error::Linalg`] (never seen).
pub fn link_motion(
    system: &MechanismSystem<'_>,
    first: &InstantaneousMobility,
    link: usize,
) -> Result<LinkMotion, Error> {
    let length = first.characteristic_length;
    let twists = link_twists(system, first, link);
    let decomposition = svd(&twists)?;
    let dimension = decomposition.singular_values.iter().filter(|&&s| s > NOTHING).count();
    let twists = decomposition.u.columns(0, dimension).into_owned();
    let turning = svd(&twists.rows(0, 3).into_owned())?;
    let turns = turning.singular_values.iter().filter(|&&s| s > NOTHING).count();
    let screw = (dimension == 1 && turns == 1).then(|| {
        let angular = twists.fixed_view::<3, 1>(0, 0).into_owned();
        let linear = twists.fixed_view::<3, 1>(3, 0) * length;
        let square = angular.norm_squared();
        let pitch = angular.dot(&linear) / square;
        ScrewAxis { pitch, point: system.reference() + angular.cross(&linear) / square }
    });
    Ok(LinkMotion { dimension, translations: dimension - turns, twists, screw })
}
