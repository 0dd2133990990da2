//! Reports on mechanisms: configurations and mobility.

use jointplay_core::Error;
use jointplay_core::constraint::System as _;
use jointplay_core::mechanism::{
    Closure, Mechanism, MechanismMobility, MechanismSystem, MobilityClass, Relief, ScrewAxis,
    SparseMobility, SparseSystem, guess, link_motion, self_stresses,
};
use jointplay_core::mobility::{NearMiss, NearMobility, near_miss};
use nalgebra::DVector;
use serde::ser::{Serialize, Serializer};

use crate::beyond::beyond_limits;
use crate::limits::LimitReport;
use crate::mobility::{FreedomsReport, columns};
use crate::redundancy::{RedundancyBasisReport, RedundantConstraintReport, redundant_constraints};
use jointplay_format::coordinates::Coordinates;
use jointplay_format::mechanism::MechanismFile;
use jointplay_format::number::fixed;
use jointplay_format::units::mm;

/// Units of the numbers of a report.
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema))]
pub struct UnitsReport {
    /// `m`, `mm`, `um` or `in`.
    pub length: &'static str,
    /// `deg` or `rad`.
    pub angle: &'static str,
}

impl UnitsReport {
    pub(crate) fn of(coordinates: &Coordinates) -> Self {
        let units = coordinates.units();
        Self { length: units.length.name(), angle: units.angle.name() }
    }
}

/// Values by name, in order; written as a map.
#[derive(Debug, Clone, PartialEq)]
pub struct ByName<T>(pub Vec<(String, T)>);

impl<T: Serialize> Serialize for ByName<T> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_map(self.0.iter().map(|(name, value)| (name, value)))
    }
}

/// A closed configuration.
#[derive(Debug, Clone, PartialEq, serde::Serialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema))]
pub struct ConfigurationReport {
    /// Coordinates by name, in the units of the file.
    #[cfg_attr(feature = "schema", schema(value_type = std::collections::BTreeMap<String, f64>))]
    pub coordinates: ByName<f64>,
    /// Largest closure residual of a loop, in radians and characteristic lengths.
    pub residual: f64,
    /// Number of iterations.
    pub iterations: usize,
}

/// Displacement of a coordinate.
#[derive(Debug, Clone, PartialEq, serde::Serialize)]
pub struct CoordinateDisplacementReport {
    /// Name of the coordinate.
    pub name: String,
    /// Displacement, in the units of the file.
    pub value: f64,
    /// Index of the coordinate.
    #[serde(skip)]
    pub coordinate: usize,
}

/// The coordinate that differs most between two configurations, in radians and characteristic lengths.
#[must_use]
pub fn largest_displacement(
    file: &MechanismFile,
    from: &DVector<f64>,
    to: &DVector<f64>,
) -> Option<CoordinateDisplacementReport> {
    let system = MechanismSystem::new(&file.mechanism, to.clone()).ok()?;
    let length = system.characteristic_length();
    let (coordinate, value) = file.mechanism.largest_displacement(from, to, length)?;
    let coordinates = Coordinates::of(file);
    let name = coordinates.all()[coordinate].name.clone();
    Some(CoordinateDisplacementReport {
        name,
        value: coordinates.from_si(coordinate, value),
        coordinate,
    })
}

/// Why the configuration in use is a searched one, and how far it is from the guess; `None` for one that corrections from the guess lead to.
///
/// # Arguments
/// * `guess` – (f) or (f + M) coordinates (m, rad)
#[must_use]
pub fn search_note(file: &MechanismFile, guess: &DVector<f64>, closed: &Closure) -> Option<String> {
    if !closed.is_searched {
        return None;
    }
    let mechanism = &file.mechanism;
    let has_limits = mechanism.limits().iter().any(Option::is_some);
    let within = if has_limits { " within the joint limits" } else { "" };
    let why = if mechanism.loops() > 0 {
        format!(
            "the loops do not close{within} from the guess: the nearest closed configuration found is used"
        )
    } else if !mechanism.couplings().is_empty() {
        format!(
            "the couplings do not hold{within} at the guess: the nearest configuration found in which they do is used"
        )
    } else {
        "the guess is beyond the joint limits: the nearest configuration within them is used"
            .to_owned()
    };
    Some(why + &farthest_from_guess(file, guess, closed))
}

/// Why a closed configuration is far from the guess: with the actuated joints there, the loops close nearly.
///
/// # Arguments
/// * `near` – the configuration with the actuated joints at their guesses
#[must_use]
pub fn near_miss_note(file: &MechanismFile, near: &Closure, closed: &Closure) -> String {
    format!(
        "with the actuated joints at their guesses the loops are open by {:.1e}, and the closed configuration is used{}; if dimensions are rounded, see --tolerance",
        near.residual,
        farthest_from_guess(file, &guess(&file.mechanism), closed)
    )
}

/// The coordinate of a configuration that is farthest from the guess, as the end of a sentence.
fn farthest_from_guess(file: &MechanismFile, guess: &DVector<f64>, closed: &Closure) -> String {
    let moved = largest_displacement(file, guess, &closed.coordinates);
    moved.map_or_else(String::new, |moved| {
        let coordinates = Coordinates::of(file);
        let k = moved.coordinate;
        let (value, unit) = (fixed(moved.value, coordinates.decimals(k)), coordinates.unit(k));
        format!("; farthest from the guess is {} by {value} {unit}", moved.name)
    })
}

/// Coordinates of the joints by name, without virtual joints.
///
/// # Arguments
/// * `values` – (f + M) (m, rad)
#[must_use]
pub fn by_name(coordinates: &Coordinates, values: &DVector<f64>) -> ByName<f64> {
    let named = coordinates.all()[..coordinates.joints()].iter().enumerate();
    ByName(named.map(|(k, one)| (one.name.clone(), coordinates.from_si(k, values[k]))).collect())
}

/// Reports a closed configuration.
#[must_use]
pub fn configuration(coordinates: &Coordinates, closed: &Closure) -> ConfigurationReport {
    ConfigurationReport {
        coordinates: by_name(coordinates, &closed.coordinates),
        residual: closed.residual,
        iterations: closed.iterations,
    }
}

/// Result of `mobility` for a mechanism.
#[derive(Debug, Clone, PartialEq, serde::Serialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema))]
pub struct MechanismMobilityReport {
    /// Name of the mechanism.
    pub name: String,
    /// Units of the coordinates.
    pub units: UnitsReport,
    /// Coordinates of the configuration by name.
    #[cfg_attr(feature = "schema", schema(value_type = std::collections::BTreeMap<String, f64>))]
    pub coordinates: ByName<f64>,
    /// Displacements of the virtual joints by name, if any were necessary for the configuration.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[cfg_attr(feature = "schema", schema(value_type = Option<std::collections::BTreeMap<String, f64>>))]
    pub virtual_joints: Option<ByName<f64>>,
    /// Coordinates beyond their limits or clearance.
    pub limits_broken: Vec<LimitReport>,
    /// Freedoms of all joints together.
    pub joint_freedoms: usize,
    /// Independent loops.
    pub loops: usize,
    /// Couplings of joints, a constraint each; absent without couplings.
    #[serde(skip_serializing_if = "is_zero")]
    #[cfg_attr(feature = "schema", schema(required = false))]
    pub couplings: usize,
    /// Mobilities, rank and redundancy.
    #[serde(flatten)]
    pub freedoms: FreedomsReport,
    /// Dimensions of the branches that meet in this configuration, if finite and instantaneous mobility differ.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub branch_dimensions: Option<Vec<usize>>,
    /// Mobility within a given tolerance of the dimensions.
    #[serde(flatten, skip_serializing_if = "Option::is_none")]
    #[cfg_attr(feature = "schema", schema(value_type = NearReport))]
    pub near: Option<NearReport>,
    /// Mobility within a tolerance of up to 1e-4, if it exceeds the exact mobility and no tolerance was given.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub near_miss: Option<NearMissReport>,
    /// Number of coordinates, if it is too large for the search for near mobility by default.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub near_miss_not_searched: Option<usize>,
    /// Mobility class in words.
    pub class: String,
    /// Redundant constraints, as self-stresses: a sparsest basis, and the symmetric images of its members.
    pub redundant_constraints: Vec<RedundantConstraintReport>,
    /// Quality of that basis.
    pub redundant_constraint_basis: RedundancyBasisReport,
    /// Instantaneous motion of each link except the base.
    #[cfg_attr(feature = "schema", schema(value_type = std::collections::BTreeMap<String, LinkMotionReport>))]
    pub link_motions: ByName<LinkMotionReport>,
    /// Singular values of the scaled constraint Jacobian, largest first.
    pub singular_values: Vec<f64>,
    /// Values at or below it count as zero.
    pub threshold: f64,
    /// Length in which the Jacobian is scaled (mm).
    pub characteristic_length_mm: f64,
    /// Orthonormal basis of the instantaneous motions, one per entry, in radians and characteristic lengths; order of the coordinates.
    pub null_space: Vec<Vec<f64>>,
    /// Orthonormal self-stresses, one per entry; for each independent loop three moments and three forces.
    pub self_stress: Vec<Vec<f64>>,
}

/// Mobility within a tolerance of the dimensions; all in radians and characteristic lengths.
#[derive(Debug, Clone, PartialEq, serde::Serialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema))]
pub struct NearReport {
    /// Tolerance that was given.
    #[cfg_attr(feature = "schema", schema(required = false))]
    pub tolerance: f64,
    /// Largest closure residual of a loop in this configuration, which is treated as closed for all other numbers; `null` if it closes exactly.
    #[cfg_attr(feature = "schema", schema(required = false))]
    pub forced_shut: Option<f64>,
    /// Freedoms within the tolerance.
    #[cfg_attr(feature = "schema", schema(required = false))]
    pub near_mobility: usize,
    /// The smallest tolerance with these freedoms.
    #[cfg_attr(feature = "schema", schema(required = false))]
    pub near_tolerance_needed: f64,
    /// Approximate tolerance for one more freedom; `null` if none is near.
    #[cfg_attr(feature = "schema", schema(required = false))]
    pub near_tolerance_for_one_more: Option<f64>,
}

/// Freedoms in addition to the exact ones, within a small tolerance; all in radians and characteristic lengths.
#[derive(Debug, Clone, PartialEq, serde::Serialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema))]
pub struct NearMissReport {
    /// Freedoms within the tolerance.
    pub near_mobility: usize,
    /// The smallest tolerance with these freedoms.
    pub near_tolerance_needed: f64,
    /// The smallest tolerance, rounded up, to be passed to `--tolerance`.
    pub tolerance_to_try: f64,
}

/// Result of `mobility` for a mechanism with too many loops for dense algebra, without the quantities that need dense matrices.
#[derive(Debug, Clone, PartialEq, serde::Serialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema))]
pub struct SparseMobilityReport {
    /// Name of the mechanism.
    pub name: String,
    /// Units of the coordinates.
    pub units: UnitsReport,
    /// Coordinates of the configuration by name.
    #[cfg_attr(feature = "schema", schema(value_type = std::collections::BTreeMap<String, f64>))]
    pub coordinates: ByName<f64>,
    /// Freedoms of all joints together.
    pub joint_freedoms: usize,
    /// Independent loops.
    pub loops: usize,
    /// Mobilities, rank and redundancy.
    #[serde(flatten)]
    pub freedoms: FreedomsReport,
    /// Mobility class in words.
    pub class: &'static str,
    /// Largest singular value of the joint closures in link twists.
    pub largest_singular_value: f64,
    /// Smallest singular value above the threshold, if there is one.
    pub smallest_counted: Option<f64>,
    /// Largest singular value that counts as zero, if there is one.
    pub largest_uncounted: Option<f64>,
    /// Values at or below it count as zero.
    pub threshold: f64,
    /// Length in which the Jacobian is scaled (mm).
    pub characteristic_length_mm: f64,
    /// Basis of the instantaneous motions, one per entry, in radians and characteristic lengths; order of the coordinates. Omitted beyond a million numbers.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub null_space: Option<Vec<Vec<f64>>>,
}

#[expect(clippy::trivially_copy_pass_by_ref, reason = "serde passes a reference")]
fn is_zero(count: &usize) -> bool {
    *count == 0
}

/// Reports the mobility of a mechanism with many loops.
#[must_use]
pub fn sparse_mobility(
    file: &MechanismFile,
    system: &SparseSystem<'_>,
    found: &SparseMobility,
) -> SparseMobilityReport {
    let (mechanism, coordinates) = (&file.mechanism, Coordinates::of(file));
    SparseMobilityReport {
        name: mechanism.name().to_owned(),
        units: UnitsReport::of(&coordinates),
        coordinates: by_name(&coordinates, system.coordinates()),
        joint_freedoms: mechanism.joint_freedoms(),
        loops: mechanism.loops(),
        freedoms: FreedomsReport {
            kutzbach_mobility: counted(mechanism),
            instantaneous_mobility: found.mobility,
            finite_mobility: found.finite,
            finite_mobility_bounds: [found.lower_bound, found.upper_bound],
            rank: found.rank,
            redundancy: found.redundancy,
        },
        class: MobilityClass::from_mobilities(found.finite, found.mobility, found.redundancy)
            .description(),
        largest_singular_value: found.largest,
        smallest_counted: found.smallest_nonzero,
        largest_uncounted: found.largest_zero,
        threshold: found.threshold,
        characteristic_length_mm: mm(found.characteristic_length),
        null_space: found.null_space().as_ref().map(columns),
    }
}

fn counted(mechanism: &Mechanism) -> i64 {
    mechanism.kutzbach_mobility()
}

/// Instantaneous motion of a link.
#[derive(Debug, Clone, PartialEq, serde::Serialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema))]
pub struct LinkMotionReport {
    /// Number of independent motions.
    pub dimension: usize,
    /// Number of independent translations.
    pub translations: usize,
    /// Pitch of the screw axis, if there is only one motion and it rotates (mm/rad).
    #[serde(skip_serializing_if = "Option::is_none")]
    pub pitch_mm_per_rad: Option<f64>,
    /// A point of the screw axis, in the base frame (mm).
    #[serde(skip_serializing_if = "Option::is_none")]
    pub axis_point_mm: Option<[f64; 3]>,
}

/// Reports the mobility of a mechanism.
///
/// # Errors
/// As [`link_motion`], [`self_stresses`] and [`near_miss`].
///
/// # Arguments
/// * `values` – (f + M) the configuration (m, rad)
/// * `relief` – displacements of the virtual joints, if any were necessary
/// * `found` – the finite mobility, block by block
/// * `near` – the mobility within a tolerance, if requested
pub fn mechanism_mobility(
    file: &MechanismFile,
    system: &MechanismSystem<'_>,
    values: &DVector<f64>,
    relief: Option<&Relief>,
    found: &MechanismMobility,
    near: Option<&NearMobility>,
) -> Result<MechanismMobilityReport, Error> {
    let (mechanism, coordinates) = (&file.mechanism, Coordinates::of(file));
    let MechanismMobility { finite, branch_dimensions } = found;
    let first = &finite.instantaneous;
    let near_miss =
        if near.is_none() { near_miss(system, &system.at_home(), finite)? } else { None };
    let (near_miss, near_miss_not_searched) = match near_miss {
        Some(NearMiss::Found { mobility, needed, tolerance }) => {
            let found = NearMissReport {
                near_mobility: mobility,
                near_tolerance_needed: needed,
                tolerance_to_try: tolerance,
            };
            (Some(found), None)
        }
        Some(NearMiss::NotSearched { coordinates, .. }) => (None, Some(coordinates)),
        None => (None, None),
    };
    let stresses = self_stresses(system, first)?;
    let mut link_motions = Vec::new();
    for (l, link) in mechanism.links().iter().enumerate().skip(1) {
        let found = link_motion(system, first, l)?;
        link_motions.push((
            link.clone(),
            LinkMotionReport {
                dimension: found.dimension,
                translations: found.translations,
                pitch_mm_per_rad: found.screw.map(|screw| mm(screw.pitch)),
                axis_point_mm: found
                    .screw
                    .map(|ScrewAxis { point, .. }| [mm(point.x), mm(point.y), mm(point.z)]),
            },
        ));
    }
    Ok(MechanismMobilityReport {
        name: mechanism.name().to_owned(),
        units: UnitsReport::of(&coordinates),
        coordinates: by_name(&coordinates, values),
        virtual_joints: relief.map(|relief| virtual_by_name(&coordinates, relief)),
        limits_broken: beyond_limits(&coordinates, &mechanism.beyond_limits(values)),
        joint_freedoms: mechanism.joint_freedoms(),
        loops: mechanism.loops(),
        couplings: mechanism.couplings().len(),
        freedoms: FreedomsReport::new(counted(mechanism), finite),
        class: class_words(found.class(), branch_dimensions.as_deref()),
        branch_dimensions: branch_dimensions.clone(),
        near: near.map(|near| NearReport {
            tolerance: near.tolerance,
            forced_shut: (!system.is_closed()).then(|| system.mismatch(&system.at_home())),
            near_mobility: near.mobility,
            near_tolerance_needed: near.needed,
            near_tolerance_for_one_more: near.next,
        }),
        near_miss,
        near_miss_not_searched,
        redundant_constraints: redundant_constraints(
            mechanism,
            &stresses,
            mm(first.characteristic_length),
            file.units.length,
        ),
        redundant_constraint_basis: RedundancyBasisReport::of(mechanism, &stresses),
        link_motions: ByName(link_motions),
        singular_values: first.singular_values.iter().copied().collect(),
        threshold: first.threshold,
        characteristic_length_mm: mm(first.characteristic_length),
        null_space: columns(&first.null_space),
        self_stress: columns(&first.self_stress),
    })
}

/// The mobility class in words, with the freedoms of the branches if they differ.
fn class_words(class: MobilityClass, branches: Option<&[usize]>) -> String {
    let dimensions = branches.unwrap_or_default();
    if class != MobilityClass::Kinematotropic {
        return class.description().to_owned();
    }
    let list: Vec<String> = dimensions.iter().map(usize::to_string).collect();
    class.description().replacen("here", &format!("here ({})", list.join(", ")), 1)
}

/// Displacements of the virtual joints by name, in the units of the file.
pub(crate) fn virtual_by_name(coordinates: &Coordinates, relief: &Relief) -> ByName<f64> {
    let named = coordinates.all().iter().enumerate().skip(coordinates.joints());
    let value = |k: usize| coordinates.from_si(k, relief.coordinates[k]);
    ByName(named.map(|(k, one)| (one.name.clone(), value(k))).collect())
}
