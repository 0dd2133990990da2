//! Report on redundant constraints.

use jointplay_core::mechanism::{Mechanism, SelfStress, SelfStresses, StressScrew};
use nalgebra::{Unit, Vector3};

use jointplay_format::mechanism::LengthUnit;
use jointplay_format::number::fixed;
use jointplay_format::units::mm;

/// Forces below this share of the largest count as none.
const NO_FORCE: f64 = 1e-6;

/// A redundant constraint as a self-stress: forces and moments of joints in equilibrium without an external load.
#[derive(Debug, Clone, PartialEq, serde::Serialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema))]
pub struct RedundantConstraintReport {
    /// Description such as `ball 1 against ball 2 along their line` or `moment about x`.
    pub what: String,
    /// Names of the joints that transmit it.
    pub joints: Vec<String>,
    /// Names of the couplings that transmit it.
    pub couplings: Vec<String>,
    /// Number of its group, from 1; symmetries of the mechanism map the members of a group onto each other.
    pub group: usize,
    /// Whether it is a member of the basis; the others depend on the basis.
    pub independent: bool,
    /// Constraints of which the removal of any one removes this self-stress: its joints, in the direction of their forces and moments; any one of `couplings` does, too.
    pub remove_any_one_of: Vec<CarriedReport>,
}

/// Load of a joint in a self-stress, on the second link of the joint.
#[derive(Debug, Clone, PartialEq, serde::Serialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema))]
pub struct CarriedReport {
    /// Name of the joint.
    pub joint: String,
    /// Place of the joint, in the base frame (mm).
    pub place_mm: [f64; 3],
    /// Force in the base frame; the largest of the self-stress has 1 N.
    pub force_n: [f64; 3],
    /// Moment about the place, in the base frame (N mm); the largest has 1 N mm where no joint carries a force.
    pub moment_nmm: [f64; 3],
}

/// Quality of a basis of self-stresses.
#[derive(Debug, Clone, PartialEq, serde::Serialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema))]
pub struct RedundancyBasisReport {
    /// Whether no basis has fewer joints in total; otherwise it is the best one found.
    pub sparsest: bool,
    /// Names of the joints that take part in all self-stresses.
    pub joints_in_all: Vec<String>,
    /// Names of the couplings that take part in all self-stresses.
    pub couplings_in_all: Vec<String>,
    /// Largest share of a self-stress that counts as zero.
    pub largest_zero: f64,
    /// Smallest share of a self-stress that counts.
    pub smallest_nonzero: f64,
}

impl RedundancyBasisReport {
    pub(crate) fn of(mechanism: &Mechanism, found: &SelfStresses) -> Self {
        Self {
            sparsest: found.sparsest,
            joints_in_all: found.in_all.iter().map(|&j| name(mechanism, j)).collect(),
            couplings_in_all: couplings(mechanism, found.couplings_in_all.iter().copied()),
            largest_zero: found.largest_zero,
            smallest_nonzero: found.smallest_nonzero,
        }
    }
}

fn name(mechanism: &Mechanism, joint: usize) -> String {
    mechanism.joints()[joint].name.clone()
}

fn couplings(mechanism: &Mechanism, indices: impl Iterator<Item = usize>) -> Vec<String> {
    indices.map(|k| mechanism.couplings()[k].name.clone()).collect()
}

/// Reports redundant constraints.
///
/// # Arguments
/// * `length_mm` – characteristic length, in which moments are scaled
/// * `unit` – of the lengths in the descriptions
#[must_use]
pub fn redundant_constraints(
    mechanism: &Mechanism,
    found: &SelfStresses,
    length_mm: f64,
    unit: LengthUnit,
) -> Vec<RedundantConstraintReport> {
    let one = |stress: &SelfStress| RedundantConstraintReport {
        what: description(mechanism, stress, unit),
        joints: stress.wrenches.iter().map(|wrench| name(mechanism, wrench.joint)).collect(),
        couplings: couplings(mechanism, stress.couplings.iter().map(|one| one.coupling)),
        group: stress.group + 1,
        independent: stress.independent,
        remove_any_one_of: carried(mechanism, stress, length_mm),
    };
    found.stresses.iter().map(one).collect()
}

fn carried(mechanism: &Mechanism, stress: &SelfStress, length_mm: f64) -> Vec<CarriedReport> {
    let largest = |part: fn(&jointplay_core::mechanism::JointWrench) -> f64| {
        stress.wrenches.iter().map(part).fold(0.0, f64::max)
    };
    let (force, moment) =
        (largest(|wrench| wrench.force.norm()), largest(|wrench| wrench.moment_at_place.norm()));
    // Forces of 1 N with their moments, or moments of 1 N mm alone.
    let (per_force, per_moment) =
        if force > NO_FORCE { (1.0 / force, length_mm / force) } else { (0.0, 1.0 / moment) };
    let one = |wrench: &jointplay_core::mechanism::JointWrench| CarriedReport {
        joint: name(mechanism, wrench.joint),
        place_mm: wrench.place.map(mm).into(),
        force_n: (wrench.force * per_force).into(),
        moment_nmm: (wrench.moment_at_place * per_moment).into(),
    };
    stress.wrenches.iter().map(one).collect()
}

/// The self-stress in words.
fn description(mechanism: &Mechanism, stress: &SelfStress, unit: LengthUnit) -> String {
    let list = |joints: &mut dyn Iterator<Item = usize>| {
        joints.map(|joint| name(mechanism, joint)).collect::<Vec<_>>().join(", ")
    };
    let joints = || stress.wrenches.iter().map(|wrench| wrench.joint);
    let coupled = couplings(mechanism, stress.couplings.iter().map(|one| one.coupling));
    let coupled = coupled.join(", ");
    let within = match (stress.wrenches.is_empty(), coupled.is_empty()) {
        (_, true) => format!("transmitted by {}", list(&mut joints())),
        (true, false) => format!("transmitted by couplings {coupled}"),
        (false, false) => {
            format!("transmitted by {} and couplings {coupled}", list(&mut joints()))
        }
    };
    let what = match &stress.screw {
        StressScrew::Force { centers, .. }
            if stress.single_loop && coupled.is_empty() && centers.len() == 2 =>
        {
            let rest = list(&mut joints().filter(|joint| !centers.contains(joint)));
            let [one, other] = [0, 1].map(|k| name(mechanism, centers[k]));
            return format!("{one} against {other} along their line, through {rest}");
        }
        StressScrew::Couplings => return format!("forces of couplings alone, {within}"),
        StressScrew::Moment { direction } => format!("moment about {}", axis(direction)),
        StressScrew::Force { direction, point, pitch, .. } => {
            let along = format!("force along {}", axis(direction));
            let in_unit = |meters: f64| fixed(unit.from_meters(meters), decimals(unit));
            let place = format!(
                " through ({}) {}",
                [point.x, point.y, point.z].map(in_unit).join(", "),
                unit.name()
            );
            let place = if stress.single_loop { place } else { String::new() };
            match (*pitch == 0.0, stress.single_loop) {
                (true, _) => format!("{along}{place}"),
                (false, true) => {
                    let (pitch, unit) = (in_unit(*pitch), unit.name());
                    format!("{along}{place} with a moment of {pitch} N {unit} per N")
                }
                (false, false) => format!("{along} with a moment"),
            }
        }
    };
    if stress.single_loop {
        format!("{what}, {within}")
    } else {
        format!("{what} and its reactions, {within}")
    }
}

/// Decimals of a length that is printed in a description, about a micrometre.
fn decimals(unit: LengthUnit) -> usize {
    unit.decimals().saturating_sub(3)
}

/// "x", "y", "z", or the unit vector.
fn axis(direction: &Unit<Vector3<f64>>) -> String {
    match (0..3).find(|&axis| direction[axis].abs() > 1.0 - 1e-9) {
        Some(axis) => ["x", "y", "z"][axis].to_owned(),
        None => {
            format!("({})", [direction.x, direction.y, direction.z].map(|x| fixed(x, 3)).join(", "))
        }
    }
}
