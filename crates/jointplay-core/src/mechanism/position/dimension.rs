//! Derivatives of all coordinates and frames by a dimension of the mechanism.

use nalgebra::{DVector, SVector, Vector3, Vector6};

use super::closing_geometry::{ClosingGeometry, power};
use super::differential::{DifferentialKinematics, Known, Order, largest_of};
use super::opening::SideUnknown;
use super::solver::PositionSolver;
use super::unknown::CoupledRow;
use crate::Error;
use crate::mechanism::joint::Twist;
use crate::mechanism::kinematics::{Kinematics, minus, plus};
use crate::mechanism::{FrameId, Mechanism, MechanismSystem, virtual_weights};
use crate::spatial::FrameTwist;
use crate::spatial::{Pose, rotation_vector};

/// Share of a change by which it may differ between steps of one and of two sizes.
const SMOOTH: f64 = 1e-4;
/// Changes below this are round-off, in radians and characteristic lengths.
const ROUND_OFF: f64 = 1e-11;

/// A mechanism with four values of a dimension near its own: one and two steps less, one and two steps more.
///
/// A dimension is any number that joint frames, axes, leads, couplings, attached frames or stiffnesses depend on.
#[derive(Debug, Clone, PartialEq)]
pub struct ChangedDimension {
    /// The mechanism with the dimension changed by −2, −1, 1 and 2 steps.
    pub mechanisms: [Mechanism; 4],
    /// Size of a step, in the unit of the dimension.
    pub step: f64,
}

/// Derivatives by a dimension, with the commanded coordinates held and the loops closed.
#[derive(Debug, Clone, PartialEq)]
pub struct DimensionDerivatives {
    /// (f + M) derivatives of all coordinates ((m), (rad) per unit of the dimension); of a ball, its angular velocity in the turned frame.
    pub coordinates: DVector<f64>,
    /// Derivatives of the frames in the order of [`Mechanism::moving_frames`]: rotation and displacement of the origin in the base frame ((rad), (m) per unit of the dimension).
    pub frames: Vec<FrameTwist>,
}

/// Poses that change with the dimension while all coordinates keep their values.
struct Placed {
    /// Frames of the two sides of each opened loop.
    sides: Vec<[Pose; 2]>,
    frames: Vec<Pose>,
    /// Violation of each coupling.
    couplings: Vec<f64>,
    /// (unknowns) W u + Aᵀ f for the forces f of the least displacement.
    load: Vec<f64>,
}

impl DifferentialKinematics {
    /// Derivatives of all coordinates and frames by a dimension, at the configuration of [`linearize`](Self::linearize).
    ///
    /// ```text
    ///    A ∂u/∂p + ∂Φ/∂p = 0                          u: passive and virtual coordinates, Φ: loop closure
    ///    W ∂u/∂p + ∂(Aᵀ)/∂p f + Aᵀ ∂f/∂p = 0          the displacement of the virtual joints stays the least
    /// ```
    /// Velocities computed before are forgotten.
    ///
    /// # Arguments
    /// * `coordinates` – (f + M) the configuration (m, rad)
    /// * `changed` – the mechanism with other values of the dimension; its links and joints are the same
    ///
    /// # Errors
    /// [`Error::DimensionOpensLoops`] for loops that close for one value of the dimension only, [`Error::NotSmooth`] where the mechanism has no derivative by the dimension, [`Error::OtherMechanism`];
    /// [`Error::Undetermined`], [`Error::NotLinearized`], [`Error::LengthMismatch`], [`Error::NotFinite`].
    ///
    /// # Numerics
    /// Only the geometry is differentiated numerically, at fixed coordinates, by central differences of fourth order; the loops are solved by their derivatives.
    ///
    /// # Source
    /// Own derivation, `docs/explanation/mechanisms.md`
    pub fn dimension_derivatives(
        &mut self,
        coordinates: &[f64],
        changed: &ChangedDimension,
    ) -> Result<DimensionDerivatives, Error> {
        self.require_determined()?;
        self.loops.check(coordinates)?;
        self.state.known = Known::Loops;
        let mut placed = Vec::with_capacity(4);
        for mechanism in &changed.mechanisms {
            placed.push(self.placed(mechanism, coordinates)?);
        }
        let [far_less, less, more, far_more] = &placed[..] else {
            unreachable!("a dimension has four changed values");
        };
        let around = Around { places: [far_less, less, more, far_more], step: changed.step };
        let length = self.loops.length;

        let mut sides = Vec::with_capacity(self.loops.closings.len());
        for (l, closing) in self.loops.closings.iter().enumerate() {
            let mut twists = [super::closing_geometry::STILL; 2];
            for (side, twist) in twists.iter_mut().enumerate() {
                let here = closing.frames[side].pose();
                let found = around.twist(&here, length, |place| &place.sides[l][side])?;
                let arm = here.translation.vector - self.reference;
                *twist = (found.angular, found.linear - found.angular.cross(&arm));
            }
            sides.push(twists);
        }

        self.right.fill(0.0);
        let largest = sides.iter().map(|sides| largest_of(sides, length)).fold(0.0, f64::max);
        for (l, closing) in self.loops.closings.iter().enumerate() {
            let last = closing.row + closing.meeting.equations();
            let entries = &mut self.right[closing.row..last];
            self.geometry[l].add(&minus(&sides[l][0], &sides[l][1]), length, -1.0, entries);
        }
        for (c, coupling) in self.loops.couplings.iter().enumerate() {
            let change = |place: &Placed| SVector::<f64, 1>::new(place.couplings[c]);
            self.right[coupling.row] = -around.rate(change)?.x;
        }
        self.elimination.reflect_right(&mut self.right);
        let held = vec![0.0; self.commanded().len()];
        self.solve(&held, Order::First, largest).map_err(|error| match error {
            Error::DependentCommands { share, allowed } => {
                Error::DimensionOpensLoops { share, allowed }
            }
            other => other,
        })?;
        if self.state.free > 0 {
            let here = self.equilibrium(&self.loops, &self.weights, coordinates);
            self.spread_velocities();
            self.load_of_velocities();
            for (k, here) in here.iter().enumerate() {
                let change = |place: &Placed| SVector::<f64, 1>::new(place.load[k] - here);
                self.load[k] += around.rate(change)?.x;
            }
            self.correct(Order::First);
        }
        self.spread_velocities();

        let mut frames = Vec::new();
        let links = (1..self.loops.link_count()).map(FrameId::Link);
        let attached = (0..self.attached.len()).map(FrameId::Attached);
        for (k, frame) in links.chain(attached).enumerate() {
            let here = self.frame_pose(frame)?;
            let own = around.twist(&here, length, |place| &place.frames[k])?;
            let (link, arm) = self.arm(frame)?;
            let (angular, linear) = self.velocity.links[link];
            frames.push(FrameTwist {
                angular: own.angular + angular,
                linear: own.linear + linear + angular.cross(&arm),
            });
        }
        // Coordinates at which loops are opened follow from the whole motion of both sides.
        for (total, own) in self.velocity.sides.iter_mut().zip(&sides) {
            for side in 0..2 {
                total[side] = plus(&total[side], &own[side]);
            }
        }
        let mut all = DVector::zeros(coordinates.len());
        self.write(Order::First, all.as_mut_slice());
        Ok(DimensionDerivatives { coordinates: all, frames })
    }

    /// A changed mechanism at the same coordinates.
    fn placed(&self, mechanism: &Mechanism, coordinates: &[f64]) -> Result<Placed, Error> {
        let at = DVector::from_column_slice(coordinates);
        let length = mechanism.characteristic_length().unwrap_or(self.loops.length);
        let system =
            MechanismSystem::new(mechanism, at.clone())?.with_characteristic_length(length)?;
        let unknowns = self.weights.len();
        let recorded = &self.coordinates[unknowns..];
        let mut loops = PositionSolver::lay_out(&system, recorded, recorded)?;
        if !same_layout(&loops, &self.loops) || mechanism.frames().len() != self.attached.len() {
            return Err(Error::OtherMechanism);
        }
        loops.orient(coordinates);
        loops.mismatch(coordinates);
        let kinematics = Kinematics::new(mechanism);
        let links: Vec<Pose> = (0..loops.link_count()).map(|link| loops.link_pose(link)).collect();
        let frames = mechanism.moving_frames().map(|frame| kinematics.frame_pose(frame, &links));
        let sides = loops.closings.iter().map(|one| one.frames.each_ref().map(|f| f.pose()));
        let violation = |one: &CoupledRow| one.equation.residual(|k| coordinates[k]);
        let couplings = loops.couplings.iter().map(violation).collect();
        let load = if self.state.free > 0 {
            let metric = virtual_weights(&system);
            let freedoms = coordinates.len() - metric.len();
            let weight = |(&coordinate, &unit): (&usize, &f64)| {
                let metric = coordinate.checked_sub(freedoms).map_or(0.0, |m| metric[m]);
                metric * unit * unit / self.largest_weight
            };
            let columns = self.coordinates[..unknowns].iter().zip(&self.units);
            self.equilibrium(&loops, &columns.map(weight).collect::<Vec<_>>(), coordinates)
        } else {
            Vec::new()
        };
        Ok(Placed { sides: sides.collect(), frames: frames.collect(), couplings, load })
    }

    /// (unknowns) W u + Aᵀ f for opened loops as placed, and the forces f of this mechanism.
    fn equilibrium(
        &self,
        loops: &PositionSolver,
        weights: &[f64],
        coordinates: &[f64],
    ) -> Vec<f64> {
        let unknowns = weights.len();
        let of = |k: usize| weights[k] * coordinates[self.coordinates[k]] / self.units[k];
        let mut load: Vec<f64> = (0..unknowns).map(of).collect();
        for closing in &loops.closings {
            let geometry = ClosingGeometry::of(closing, &self.reference);
            let wrench = geometry.wrench(&self.multipliers[closing.row..], self.loops.length);
            for &SideUnknown { column, sense, .. } in &closing.moved_by {
                if column < unknowns {
                    let screw = &loops.screws[column];
                    let screw: Twist = (screw.angular, screw.velocity_of(&self.reference));
                    load[column] += sense * self.units[column] * power(&wrench, &screw);
                }
            }
        }
        for coupling in &loops.couplings {
            let of_unknowns = coupling.columns.iter().filter(|(column, _)| *column < unknowns);
            for &(column, factor) in of_unknowns {
                load[column] += factor * self.units[column] * self.multipliers[coupling.row];
            }
        }
        load
    }
}

/// Whether loops are opened at the same joints, with the same unknowns.
fn same_layout(one: &PositionSolver, other: &PositionSolver) -> bool {
    let unknowns = |loops: &PositionSolver| -> Vec<usize> {
        loops.unknowns.iter().map(|unknown| unknown.coordinate).collect()
    };
    let closings = |loops: &PositionSolver| -> Vec<([usize; 2], usize)> {
        loops.closings.iter().map(|closing| (closing.links, closing.row)).collect()
    };
    one.link_count() == other.link_count()
        && one.coordinate_count() == other.coordinate_count()
        && one.elimination.rows() == other.elimination.rows()
        && unknowns(one) == unknowns(other)
        && closings(one) == closings(other)
}

/// Four changed mechanisms, from which derivatives are differences.
struct Around<'a> {
    places: [&'a Placed; 4],
    step: f64,
}

impl Around<'_> {
    /// Derivative of numbers that are zero where the dimension is not changed, in radians or characteristic lengths.
    fn rate<const N: usize>(
        &self,
        value: impl Fn(&Placed) -> SVector<f64, N>,
    ) -> Result<SVector<f64, N>, Error> {
        let [far_less, less, more, far_more] = self.places.map(value);
        let (near, far) = ((more - less) / 2.0, (far_more - far_less) / 4.0);
        // Four times as much for two steps as for one; only twice as much at a kink.
        let curved = (far_more + far_less) - (more + less) * 4.0;
        let off = (near - far).amax().max(curved.amax());
        let allowed = SMOOTH * near.amax() + ROUND_OFF;
        if off.is_nan() || allowed.is_nan() || off > allowed {
            return Err(Error::NotSmooth { share: off / near.amax().max(ROUND_OFF) });
        }
        Ok((near * 4.0 - far) / (3.0 * self.step))
    }

    /// Motion of a frame with the dimension, its origin in metres.
    fn twist(
        &self,
        here: &Pose,
        length: f64,
        frame: impl Fn(&Placed) -> &Pose,
    ) -> Result<FrameTwist, Error> {
        let rate: Vector6<f64> = self.rate(|place| {
            let there = frame(place);
            let turn = rotation_vector(&(there.rotation * here.rotation.inverse()));
            let shift = (there.translation.vector - here.translation.vector) / length;
            Vector6::new(turn.x, turn.y, turn.z, shift.x, shift.y, shift.z)
        })?;
        let part = |first: usize| -> Vector3<f64> { rate.fixed_rows::<3>(first).into_owned() };
        Ok(FrameTwist { angular: part(0), linear: part(3) * length })
    }
}
