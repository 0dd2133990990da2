//! Inverse kinematics of the whole chain: rods from the plane, height from the arm's plane, motors from the point within it.

use jointplay_core::gpr::PlatformPose;
use jointplay_core::spatial::{Pose, Tilt, wrap_angle};
use nalgebra::{Translation3, Vector2, Vector3};

use super::closed_form::PairSolutions;
use super::decomposition::{Decomposition, Pair};
use super::newton::solutions;
use super::redundant::Redundant;
use super::revolutions::{Ranges, Revolutions};
use super::solution::{
    Branch, BranchSelection, Configuration, Elbow, Inverse, LimitViolation, OutOfReach,
    ReachDirection, Redundancy, WaferTarget,
};
use crate::CellError;
use crate::robot::arm_chain::turned;
use crate::robot::arm_chain::{ArmChain, ArmVector};
use crate::robot::hybrid_robot::{EffectorId, HybridRobot, RODS};
use crate::robot::positions::Positions;

/// Largest distance of a branch from its target (m).
const RESIDUAL: f64 = 1e-12;

/// Tolerance of limits as a fraction of the range: positions computed to lie on a limit do not violate it by round-off.
const LIMIT_TOLERANCE: f64 = 1e-12;

impl HybridRobot {
    /// All positions of the axes that bring the wafer of an effector to a target.
    ///
    /// ```text
    ///    normal → rods with their ends in the plane of this normal through O_b → pose of the platform → common lift of the rods,
    ///    which brings the arm's plane to the wafer's centre → centre in the platform frame → motors
    /// ```
    /// Raising all rods by the same amount raises the platform by that amount, so that each of these steps is exact, including the shift of the platform's centre by a tilt, and the change of height that a tilt causes at the reach of the wafer.
    /// Arms of two links with or without further joints at their ends, radial arms with a belt and radial arms with a prismatic joint are solved in closed form with all their branches;
    /// redundant arms by staying away from limits and from the stretched arm: a local minimum of Σ 1/(1 − u²) + 1/sin² β from the present positions, u from −1 to 1 between the limits of an axis, β the elbow angle of the two links that place the wafer's centre;
    /// all others by Newton's method from several starts.
    /// Positions that differ by whole revolutions are branches of their own where limits admit several.
    ///
    /// # Arguments
    /// * `seed` – present positions of all axes; motors of other effectors keep them
    ///
    /// # Errors
    /// [`CellError::NormalNotUp`], [`CellError::NoSuchEffector`], [`CellError::LengthMismatch`], [`CellError::NotFinite`], and those of the platform model.
    ///
    /// # Numerics
    /// In closed form, only the list of branches is allocated. A branch farther than 10⁻¹³ m from the target is corrected by Newton's method on all axes, and rejected if it stays farther than 10⁻¹² m.
    ///
    /// # Source
    /// Own derivation, `docs/explanation/arms.md`
    pub fn inverse(
        &self,
        id: EffectorId,
        target: &WaferTarget,
        seed: &[f64],
    ) -> Result<Inverse, CellError> {
        self.inverse_by(id, target, seed, Redundancy::AwayFromLimits)
    }

    /// As [`Self::inverse`], with the positions chosen where the arm is redundant.
    ///
    /// # Errors
    /// As [`Self::inverse`].
    pub fn inverse_by(
        &self,
        id: EffectorId,
        target: &WaferTarget,
        seed: &[f64],
        redundancy: Redundancy,
    ) -> Result<Inverse, CellError> {
        self.check_effector(id)?;
        self.check_positions(seed)?;
        let normal = upward(target)?;
        let chain = ArmChain::new(self, id);
        let slope = normal.xy() / normal.z;
        let level = self.gpr.base_points().map(|point| -slope.dot(&point));
        let below = self.model.forward(&self.gpr, level)?;
        let pose = &below.base_from_platform;
        let over = target.center - pose.translation.vector;
        let height = (normal.dot(&over) - chain.height) / normal.z;
        let mut start = Positions::new(seed);
        for (rod, level) in start.iter_mut().zip(level) {
            *rod = level + height;
        }
        let raised = Translation3::new(0.0, 0.0, height) * pose;
        let (point, heading) = within(&raised, &below, target);
        self.finished(id, &chain, target, &normal, point, heading, start, seed, redundancy)
    }

    /// All motor positions that bring the wafer of an effector over a point, the rods keeping their positions in `seed`.
    ///
    /// # Arguments
    /// * `point` – the wafer's centre in the platform plane (m)
    /// * `heading` – its heading from the platform's x axis (rad)
    ///
    /// # Errors
    /// As [`Self::inverse`].
    pub fn arm_inverse(
        &self,
        id: EffectorId,
        point: Vector2<f64>,
        heading: Option<f64>,
        seed: &[f64],
    ) -> Result<Inverse, CellError> {
        self.check_effector(id)?;
        self.check_positions(seed)?;
        let platform = self.platform(seed)?;
        let chain = ArmChain::new(self, id);
        let pose = platform.base_from_platform;
        let normal = platform.normal();
        let center = pose.rotation * point.push(chain.height) + pose.translation.vector;
        if !center.iter().all(|number| number.is_finite()) {
            return Err(not_finite("the point", center.sum()));
        }
        let turned = heading.map(|heading| heading + platform.torsion());
        let target = WaferTarget { center, normal, heading: turned };
        upward(&target)?;
        let start = Positions::new(seed);
        self.finished(
            id,
            &chain,
            &target,
            &normal,
            point,
            heading,
            start,
            seed,
            Redundancy::AwayFromLimits,
        )
    }

    #[expect(
        clippy::too_many_arguments,
        reason = "one call's half-solution results, used here alone"
    )]
    fn finished(
        &self,
        id: EffectorId,
        chain: &ArmChain,
        target: &WaferTarget,
        normal: &Vector3<f64>,
        point: Vector2<f64>,
        heading: Option<f64>,
        start: Positions,
        seed: &[f64],
        redundancy: Redundancy,
    ) -> Result<Inverse, CellError> {
        let ranges = self.ranges(chain);
        let arm_seed = chain.arm_positions(seed);
        let decomposition = Decomposition::new(chain);
        let is_free = heading_is_free(chain);
        let with_heading = target.heading.is_some() && is_free;
        let heading = heading.filter(|_| is_free);
        let mut branches: Vec<Branch> = Vec::new();
        let mut failure = None;
        let tilt = Tilt::from_normal(normal);
        // The rods have their start positions in all branches.
        let base_from_platform = self.platform(&start)?.base_from_platform;
        let mut add = |arm_positions: &ArmVector, configuration: Configuration| {
            let mut positions = start;
            for (&axis, &position) in chain.axes().iter().zip(arm_positions) {
                positions[axis] = position;
            }
            let pose = base_from_platform * chain.wafer(&positions);
            let polished = self.polish(id, &pose, target, normal, with_heading, &mut positions);
            let (corrections, missing) = match polished {
                Ok(found) => found,
                Err(error) => {
                    failure = Some(error);
                    return;
                }
            };
            let residual = missing.center.norm();
            if residual > RESIDUAL {
                return;
            }
            let mut violations = Vec::new();
            for axis in (0..RODS).chain(chain.axes().iter().copied()) {
                self.check_axis(axis, positions[axis], &mut violations);
            }
            self.check_tilt(tilt, &mut violations);
            branches.push(Branch {
                travel_time: self.time_between(seed, &positions),
                positions,
                configuration,
                selection: if violations.is_empty() {
                    BranchSelection::NotNearest
                } else {
                    BranchSelection::BreaksLimits
                },
                violations,
                residual,
                normal_residual: missing.tilt.norm(),
                corrections,
                heading: missing.heading,
                heading_difference: if with_heading { 0.0 } else { missing.turn },
            });
        };
        let mut out_of_reach = None;
        let mut configuration = Configuration::default();
        match &decomposition {
            Some(decomposition) if decomposition.is_closed(heading.is_some()) => {
                configuration = decomposition.configuration(chain, &arm_seed);
                let seed = &arm_seed;
                let solver = Solver { chain, decomposition, ranges: &ranges, seed, redundancy };
                out_of_reach = solver.solve(point, heading, &mut add);
            }
            decomposition => {
                let found = solutions(chain, &ranges, &point, heading, &arm_seed);
                let found = match decomposition {
                    Some(decomposition) => {
                        Revolutions::of(decomposition).all_within(&found, &ranges)
                    }
                    None => found,
                };
                for arm_positions in found {
                    add(&arm_positions, Configuration::default());
                }
            }
        }
        if let Some(error) = failure {
            return Err(error);
        }
        if branches.is_empty() && out_of_reach.is_none() {
            out_of_reach = beyond_all_links(chain, &point);
        }
        let mut plane_violations = Vec::new();
        for rod in 0..RODS {
            self.check_axis(rod, start[rod], &mut plane_violations);
        }
        self.check_tilt(tilt, &mut plane_violations);
        let chosen = choose(&mut branches, configuration);
        Ok(Inverse { branches, chosen, out_of_reach, plane_violations })
    }

    /// Whether the motors of an effector determine its heading independently of its wafer's centre and plane.
    ///
    /// # Errors
    /// [`CellError::NoSuchEffector`]
    pub fn heading_is_free(&self, id: EffectorId) -> Result<bool, CellError> {
        self.check_effector(id)?;
        Ok(heading_is_free(&ArmChain::new(self, id)))
    }

    pub(super) fn ranges(&self, chain: &ArmChain) -> Ranges {
        let mut ranges = Ranges { min: [0.0; 4], max: [0.0; 4], count: chain.axes().len() };
        for (a, &axis) in chain.axes().iter().enumerate() {
            (ranges.min[a], ranges.max[a]) = (self.axes[axis].min, self.axes[axis].max);
        }
        ranges
    }

    /// Limits that positions violate, that of the tilt last.
    ///
    /// # Errors
    /// [`CellError::LengthMismatch`], [`CellError::NotFinite`]
    pub fn limit_violations(&self, positions: &[f64]) -> Result<Vec<LimitViolation>, CellError> {
        self.check_positions(positions)?;
        let mut violations = Vec::new();
        for (axis, &position) in positions.iter().enumerate() {
            self.check_axis(axis, position, &mut violations);
        }
        let rods = [positions[0], positions[1], positions[2]];
        self.check_tilt(self.gpr.plane_tilt(&rods), &mut violations);
        Ok(violations)
    }

    fn check_axis(&self, axis: usize, position: f64, violations: &mut Vec<LimitViolation>) {
        let (min, max) = (self.axes[axis].min, self.axes[axis].max);
        let tolerance = LIMIT_TOLERANCE * (max - min);
        if position < min - tolerance || position > max + tolerance {
            violations.push(LimitViolation::Axis { axis, position, min, max });
        }
    }

    fn check_tilt(&self, tilt: Tilt, violations: &mut Vec<LimitViolation>) {
        let max = self.gpr.limits().tilt_max;
        let angle = tilt.angle.abs();
        if angle > max * (1.0 + LIMIT_TOLERANCE) + LIMIT_TOLERANCE {
            violations.push(LimitViolation::Tilt { angle, max });
        }
    }

    /// Duration of the slowest axis from one set of positions to another, at its velocity limit without a wafer (s).
    fn time_between(&self, from: &[f64], to: &[f64]) -> f64 {
        let axes = self.axes.iter().zip(from.iter().zip(to));
        axes.map(|(axis, (from, to))| (to - from).abs() / axis.empty.velocity).fold(0.0, f64::max)
    }
}

/// A target that is farther from the first joint than all links of an arm together reach; an arm that extends has no such distance.
///
/// Nearer targets may be out of reach too, by the ratios of the motors or by their ranges.
fn beyond_all_links(chain: &ArmChain, point: &Vector2<f64>) -> Option<OutOfReach> {
    let lengths = || chain.link_vectors().iter().map(|link_vector| link_vector.vector.norm());
    let (distance, max) = ((point - chain.origin).norm(), lengths().sum::<f64>());
    let longest = lengths().fold(0.0, f64::max);
    let min = (2.0 * longest - max).max(0.0);
    let extends = !chain.prismatic_joints().is_empty();
    (!extends && distance > max).then_some(OutOfReach { distance, min, max })
}

/// Whether motors are left over for the heading.
fn heading_is_free(chain: &ArmChain) -> bool {
    chain.axes().len() > 2
}

struct Solver<'a> {
    chain: &'a ArmChain,
    decomposition: &'a Decomposition,
    ranges: &'a Ranges,
    seed: &'a ArmVector,
    redundancy: Redundancy,
}

impl Solver<'_> {
    fn solve(
        &self,
        point: Vector2<f64>,
        heading: Option<f64>,
        add: &mut impl FnMut(&ArmVector, Configuration),
    ) -> Option<OutOfReach> {
        let (chain, decomposition) = (self.chain, self.decomposition);
        let revolutions = Revolutions::of(decomposition);
        let mut point = point - chain.origin;
        let last = heading.map(|heading| heading - chain.heading.0);
        if decomposition.is_redundant(last.is_some()) {
            let redundant = Redundant::new(
                chain,
                decomposition,
                &revolutions,
                self.ranges,
                point,
                last,
                self.seed,
            );
            for configuration in bends(decomposition) {
                let found = match self.redundancy {
                    Redundancy::AwayFromLimits => redundant.away_from_limits(configuration),
                    Redundancy::KeepRedundantAngles => {
                        redundant.keeping_redundant_angles(configuration)
                    }
                    Redundancy::NearestToPresent => redundant
                        .nearest(configuration)
                        .filter(|found| self.ranges.contain(found))
                        .or_else(|| redundant.away_from_limits(configuration)),
                };
                if let Some(arm_positions) = found {
                    revolutions.within(&arm_positions, self.ranges, |arm_positions| {
                        add(arm_positions, configuration)
                    });
                }
            }
            return None;
        }
        let mut unknown = [0.0; 4];
        if let (Some(k), Some(turn)) = (decomposition.last, last) {
            unknown[2] = turn;
            point -= turned(&chain.link_vectors()[k].vector, turn);
        }
        let now = decomposition.unknown(self.seed);
        let solutions: PairSolutions = match decomposition.solve_links(
            chain,
            &point,
            Configuration::default(),
            [now[0], now[1]],
            0.0,
        ) {
            Ok(solutions) => solutions,
            Err(out_of_reach) => return Some(out_of_reach),
        };
        for solution in solutions.into_iter().flatten() {
            (unknown[0], unknown[1]) = (solution.pair[0], solution.pair[1]);
            let arm_positions = decomposition.positions(&unknown);
            revolutions.within(&arm_positions, self.ranges, |arm_positions| {
                add(arm_positions, solution.configuration)
            });
        }
        None
    }
}

/// All configurations of a pair.
fn bends(decomposition: &Decomposition) -> impl Iterator<Item = Configuration> {
    const ELBOWS: [Option<Elbow>; 2] = [Some(Elbow::Left), Some(Elbow::Right)];
    const REACHES: [Option<ReachDirection>; 2] =
        [Some(ReachDirection::Forward), Some(ReachDirection::Backward)];
    let (elbows, reaches): (&[_], &[_]) = match decomposition.pair {
        Pair::Links(_) => (&ELBOWS, &[None]),
        Pair::Prismatic(_) => (&[None], &REACHES),
        Pair::Belt(..) => (&ELBOWS, &REACHES),
    };
    reaches
        .iter()
        .flat_map(|&reaching| elbows.iter().map(move |&elbow| Configuration { elbow, reaching }))
}

/// Chooses among the branches within limits: one with the present configuration if there is one, and of those the nearest.
fn choose(branches: &mut [Branch], configuration: Configuration) -> Option<usize> {
    let within = |branch: &Branch| branch.violations.is_empty();
    let stays = branches.iter().any(|b| within(b) && b.configuration.agrees_with(configuration));
    let mut chosen: Option<usize> = None;
    for k in 0..branches.len() {
        let branch = &branches[k];
        if !within(branch) {
            continue;
        }
        if stays && !branch.configuration.agrees_with(configuration) {
            branches[k].selection = BranchSelection::OtherConfiguration;
        } else if chosen.is_none_or(|best| branch.travel_time < branches[best].travel_time) {
            chosen = Some(k);
        }
    }
    if let Some(chosen) = chosen {
        branches[chosen].selection = BranchSelection::Chosen;
    }
    chosen
}

/// Centre and heading of a target in the platform frame.
fn within(
    base_from_platform: &Pose,
    platform: &PlatformPose,
    target: &WaferTarget,
) -> (Vector2<f64>, Option<f64>) {
    let center = base_from_platform.rotation.inverse()
        * (target.center - base_from_platform.translation.vector);
    let heading = target.heading.map(|heading| wrap_angle(heading - platform.torsion()));
    (center.xy(), heading)
}

/// Unit normal of a target.
fn upward(target: &WaferTarget) -> Result<Vector3<f64>, CellError> {
    for (what, vector) in [("the wafer's centre", &target.center), ("its normal", &target.normal)] {
        if let Some(&value) = vector.iter().find(|number| !number.is_finite()) {
            return Err(not_finite(what, value));
        }
    }
    if let Some(value) = target.heading.filter(|heading| !heading.is_finite()) {
        return Err(not_finite("the heading", value));
    }
    let largest = target.normal.amax();
    let normal = (target.normal / largest).normalize();
    if largest == 0.0 || normal.z <= 0.0 {
        return Err(CellError::NormalNotUp { normal: target.normal.into() });
    }
    Ok(normal)
}

fn not_finite(what: &str, value: f64) -> CellError {
    CellError::NotFinite { what: what.to_owned(), value }
}
