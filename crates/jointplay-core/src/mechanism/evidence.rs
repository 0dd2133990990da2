//! Evidence of mobility: motion of a link, class of the mechanism.

use nalgebra::{DMatrix, DVector, Rotation3, Translation3, Vector3};

use super::sparse::{SparseMobility, SparseSystem};
use super::system::middle;
use super::{Kinematics, MechanismSystem};
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

/// Motions of the coordinates at a configuration, from which the twists of links follow.
struct CoordinateMotions<'a> {
    kinematics: &'a Kinematics<'a>,
    /// Twists of all coordinates about the reference point (m).
    screws: Vec<(Vector3<f64>, Vector3<f64>)>,
    /// (f, motions) rates; lengths in characteristic lengths.
    rates: &'a DMatrix<f64>,
    /// Reference point of twists, in the base frame (m).
    reference: Vector3<f64>,
    /// Characteristic length (m).
    length: f64,
}

impl<'a> CoordinateMotions<'a> {
    fn new(
        kinematics: &'a Kinematics<'a>,
        home: &DVector<f64>,
        rates: &'a DMatrix<f64>,
        reference: Vector3<f64>,
        length: f64,
    ) -> Self {
        let at_home = DVector::zeros(home.len());
        let screws = kinematics.placed(home, &at_home, &reference, None).screws;
        Self { kinematics, screws, rates, reference, length }
    }

    fn of_dense(system: &'a MechanismSystem<'_>, first: &'a InstantaneousMobility) -> Self {
        let length = first.characteristic_length;
        let (home, reference) = (system.home(), system.reference());
        Self::new(system.kinematics(), home, &first.null_space, reference, length)
    }

    /// (6, motions) twist of a link in each motion (angular, linear over the characteristic length) at the reference point, in the base frame.
    fn link_twists(&self, link: usize) -> DMatrix<f64> {
        let Self { kinematics, rates, length, .. } = self;
        let mut twists = DMatrix::zeros(6, rates.ncols());
        for (j, sense) in kinematics.path_to(link) {
            for k in kinematics.columns_of(j).filter(|&k| k < rates.nrows()) {
                let unit = sense * kinematics.dimensions()[k].unit(*length);
                let (angular, linear) = self.screws[k];
                for motion in 0..rates.ncols() {
                    let rate = unit * rates[(k, motion)];
                    for axis in 0..3 {
                        twists[(axis, motion)] += rate * angular[axis];
                        twists[(3 + axis, motion)] += rate * linear[axis] / length;
                    }
                }
            }
        }
        twists
    }

    /// Poses of the links displaced by shares of the first motion, in which the largest twist of a link is [`DRAWN`] at 1.
    fn poses(&self, links: &[Pose], shares: &[f64]) -> Vec<Vec<Pose>> {
        let twists: Vec<_> =
            (0..links.len()).map(|link| self.link_twists(link).column(0).into_owned()).collect();
        let size = |twist: &DVector<f64>| {
            twist.fixed_rows::<3>(0).norm().max(twist.fixed_rows::<3>(3).norm())
        };
        let largest = twists.iter().map(size).fold(0.0, f64::max);
        let per_share = if largest > 0.0 { DRAWN / largest } else { 0.0 };
        let displaced = |share: f64| {
            let place = |(pose, twist): (&Pose, &DVector<f64>)| {
                let by = twist * (share * per_share);
                let rotation = Rotation3::new(by.fixed_rows::<3>(0).into_owned());
                let reference = self.reference;
                let shift = reference + by.fixed_rows::<3>(3) * self.length - rotation * reference;
                Pose::from_parts(Translation3::from(shift), rotation) * pose
            };
            links.iter().zip(&twists).map(place).collect()
        };
        shares.iter().map(|&share| displaced(share)).collect()
    }
}

/// Largest twist of a link in a drawn motion, in radians and characteristic lengths.
const DRAWN: f64 = 0.15;

/// Poses of the links displaced along an instantaneous motion, each link as a rigid body: for pictures, in which joints open where the motion is only instantaneous.
///
/// # Arguments
/// * `motion` – index of the motion in the null space
/// * `shares` – of each picture, -1 to 1: at 1 the largest twist of a link is 0.15, in radians and characteristic lengths
///
/// # Errors
/// [`Error::NoSuchQuantity`] for an unknown motion; those of [`super::Kinematics::link_poses`].
pub fn poses_along_motion(
    system: &MechanismSystem<'_>,
    first: &InstantaneousMobility,
    motion: usize,
    shares: &[f64],
) -> Result<Vec<Vec<Pose>>, Error> {
    let count = first.mobility;
    if motion >= count {
        return Err(Error::NoSuchQuantity { what: "instantaneous motion", index: motion, count });
    }
    let links = system.kinematics().link_poses(system.home())?;
    let rates = first.null_space.columns(motion, 1).into_owned();
    let (home, reference) = (system.home(), system.reference());
    let length = first.characteristic_length;
    let motions = CoordinateMotions::new(system.kinematics(), home, &rates, reference, length);
    Ok(motions.poses(&links, shares))
}

/// The poses of [`poses_along_motion`] of a mechanism with many loops.
///
/// # Errors
/// [`Error::NoSuchQuantity`] for an unknown motion.
pub fn poses_along_sparse_motion(
    system: &SparseSystem<'_>,
    found: &SparseMobility,
    motion: usize,
    shares: &[f64],
) -> Result<Vec<Vec<Pose>>, Error> {
    let count = found.motions.len();
    let Some(rates) = found.motions.get(motion) else {
        return Err(Error::NoSuchQuantity { what: "instantaneous motion", index: motion, count });
    };
    let home = system.coordinates();
    let mut column = DMatrix::zeros(home.len(), 1);
    rates.iter().for_each(|&(k, rate)| column[(k, 0)] = rate);
    let (reference, _) = middle(system.kinematics(), home);
    let length = found.characteristic_length;
    let motions = CoordinateMotions::new(system.kinematics(), home, &column, reference, length);
    Ok(motions.poses(system.link_poses(), shares))
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
    let twists = CoordinateMotions::of_dense(system, first).link_twists(link);
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
