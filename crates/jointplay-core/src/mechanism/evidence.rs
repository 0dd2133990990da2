//! Evidence of mobility: joints that carry a self-stress, motion of a link, class of the mechanism.

use nalgebra::{DMatrix, DVector, Vector3};

use super::MechanismSystem;
use crate::Error;
use crate::linalg::svd;
use crate::mobility::{FiniteMobility, InstantaneousMobility};

/// Wrenches and twists below this share of the largest count as zero.
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

/// A wrench that the mechanism carries in itself, without an external load.
#[derive(Debug, Clone, PartialEq)]
pub struct SelfStress {
    /// The joints that carry it, with their wrenches; the largest entry of all is ±1.
    pub wrenches: Vec<JointWrench>,
    /// Description of its largest wrench: "moment about x", "force along y".
    pub words: String,
}

/// Wrench that a joint carries in a self-stress, in the base frame about [`MechanismSystem::reference`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct JointWrench {
    /// Index of the joint.
    pub joint: usize,
    /// Moment.
    pub moment: Vector3<f64>,
    /// Force times the characteristic length.
    pub force: Vector3<f64>,
}

impl JointWrench {
    fn largest(&self) -> f64 {
        self.moment.amax().max(self.force.amax())
    }
}

/// Self-stresses of as few joints as elimination finds, with the joints that take part.
///
/// # Errors
/// [`Error::Linalg`] (never seen).
pub fn self_stresses(
    system: &MechanismSystem<'_>,
    first: &InstantaneousMobility,
) -> Result<Vec<SelfStress>, Error> {
    let cycles = system.cycles();
    let joints = cycles.ncols();
    // (6·joints, redundancy): what each basis stress does in each joint.
    let mut all = DMatrix::zeros(6 * joints, first.redundancy);
    for s in 0..first.redundancy {
        for j in 0..joints {
            for row in 0..6 {
                all[(6 * j + row, s)] = (0..cycles.nrows())
                    .map(|l| cycles[(l, j)] * first.self_stress[(6 * l + row, s)])
                    .sum();
            }
        }
    }
    let mut stresses = Vec::with_capacity(first.redundancy);
    for column in eliminated(all).column_iter() {
        let wrenches: Vec<JointWrench> = (0..joints)
            .map(|joint| {
                let part = |from: usize| column.fixed_rows::<3>(6 * joint + from).into_owned();
                JointWrench { joint, moment: part(0), force: part(3) }
            })
            .filter(|wrench| wrench.largest() > NOTHING)
            .collect();
        let main = wrenches.iter().max_by(|a, b| a.largest().total_cmp(&b.largest()));
        let words =
            main.map_or_else(String::new, |wrench| wrench_words(&wrench.moment, &wrench.force));
        stresses.push(SelfStress { wrenches, words });
    }
    Ok(stresses)
}

/// The same columns, combined so that each has a one where the others have zeros.
fn eliminated(mut columns: DMatrix<f64>) -> DMatrix<f64> {
    let count = columns.ncols();
    for pivot in 0..count {
        // The largest entry that is left; of nearly equal ones the first, so that round-off does not choose.
        let rest = columns.columns(pivot, count - pivot);
        let largest = rest.amax();
        let found = rest
            .column_iter()
            .enumerate()
            .flat_map(|(c, column)| {
                column.iter().enumerate().map(move |(r, &v)| (r, c, v)).collect::<Vec<_>>()
            })
            .filter(|(_, _, value)| value.abs() > 0.999 * largest)
            .min_by_key(|&(row, column, _)| (row, column));
        let Some((row, column, value)) = found else { break };
        columns.swap_columns(pivot, pivot + column);
        let scaled = columns.column(pivot) / value;
        columns.set_column(pivot, &scaled);
        for other in (0..count).filter(|&other| other != pivot) {
            let factor = columns[(row, other)];
            let reduced = columns.column(other) - &scaled * factor;
            columns.set_column(other, &reduced);
        }
    }
    for mut column in columns.column_iter_mut() {
        let largest = column.amax();
        if largest > 0.0 {
            column /= largest;
        }
    }
    columns.map(|value| if value.abs() < NOTHING { 0.0 } else { value })
}

fn wrench_words(moment: &Vector3<f64>, force: &Vector3<f64>) -> String {
    let parts = [("force along", force), ("moment about", moment)];
    let words: Vec<String> = parts
        .into_iter()
        .filter(|(_, part)| part.amax() > 1e-6)
        .map(|(what, part)| format!("{what} {}", direction_words(part)))
        .collect();
    words.join(" with a ")
}

/// "x", "y", "z", or the unit vector.
fn direction_words(direction: &Vector3<f64>) -> String {
    let unit = direction.normalize();
    match (0..3).find(|&axis| unit[axis].abs() > 1.0 - 1e-9) {
        Some(axis) => ["x", "y", "z"][axis].to_owned(),
        None => format!("({:.3}, {:.3}, {:.3})", unit.x, unit.y, unit.z),
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

/// The instantaneous motions of a link: dimension, translations among them, the screw of a single freedom.
///
/// # Errors
/// [`Error::Linalg`] (never seen).
pub fn link_motion(
    system: &MechanismSystem<'_>,
    first: &InstantaneousMobility,
    link: usize,
) -> Result<LinkMotion, Error> {
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
