//! Velocities and accelerations of all coordinates for those of commanded ones.

use nalgebra::{DMatrix, DVector, Vector3};

use super::closing_geometry::{ClosingGeometry, STILL};
use super::elimination::Elimination;
use super::field::Field;
use super::opening::{Meeting, SideUnknown};
use super::solver::PositionSolver;
use crate::Error;
use crate::constraint::{CLOSURE_TOLERANCE, Dimension};
use crate::linalg::svd;
use crate::mechanism::joint::Twist;
use crate::mechanism::kinematics::{bracket, minus, plus, scaled};
use crate::mechanism::{MechanismSystem, Undetermined, virtual_weights};
use crate::spatial::Pose;

/// Share of the effect of the commands that may be left where they cannot be followed: round-off.
const FOLLOWED: f64 = 1e-9;
/// Largest commanded rate: squares of rates, times lengths, are numbers.
const LARGEST_RATE: f64 = 1e100;

/// Velocities and accelerations of a mechanism for those of its commanded coordinates, loops closed.
///
/// ```text
///    A u̇ + B ȧ = 0                     u: passive and virtual coordinates, a: commanded ones; loops, then couplings
///    W u + Aᵀ f = 0                     least displacement: virtual joints are springs, all others transmit no force
/// ```
/// Both hold along the motion, and so do their derivatives.
/// The second decides where virtual joints have more freedoms than the loops need: velocities are derivatives of the least displacement, by the curvature of the constraints (Ȧᵀ f), and not by a pseudo-inverse of A.
///
/// Everything that does not depend on the coordinates is laid out once; [`linearize`](Self::linearize), [`velocities`](Self::velocities) and [`accelerations`](Self::accelerations) allocate nothing, unless they fail.
///
/// Rates of a ball are its angular velocity in the turned frame, and the derivative of its components; all other rates are derivatives of the coordinates.
///
/// # Numerics
/// Householder triangulation of the opened loops, as in [`PositionSolver`]; columns of which it leaves less than 10⁻⁹ count as dependent.
///
/// # Source
/// Own derivation, `docs/explanation/mechanisms.md`; constrained accelerations: \[Featherstone\], chapter 8
#[derive(Debug, Clone)]
pub struct DifferentialKinematics {
    pub(super) loops: PositionSolver,
    /// Commanded coordinates in the order of the caller.
    commanded: Vec<usize>,
    /// Column of each commanded coordinate.
    columns_of_commanded: Vec<usize>,
    /// (columns) coordinate of each column.
    pub(super) coordinates: Vec<usize>,
    /// (columns) one unit of each column: radians, or characteristic lengths (m).
    pub(super) units: Vec<f64>,
    /// (unknowns) weight of each column in the size of the virtual displacement, the largest being 1.
    pub(super) weights: Vec<f64>,
    /// The largest weight before that, 1 without virtual joints.
    pub(super) largest_weight: f64,
    /// Pose of each attached frame on its link.
    pub(super) attached: Vec<(usize, Pose)>,
    pub(super) reference: Vector3<f64>,
    pub(super) state: State,
    // Room to work in.
    pub(super) elimination: Elimination,
    pub(super) geometry: Vec<ClosingGeometry>,
    /// (columns) screws at the reference point.
    pub(super) screws: Vec<Twist>,
    /// (columns) rates of change of the screws along the velocities.
    pub(super) screw_rates: Vec<Twist>,
    /// (d, unknowns) motions that commands leave to the least displacement, by rows.
    pub(super) free: Vec<f64>,
    /// (d, d) factored curvature of the size of the displacement along them.
    pub(super) curvature: Vec<f64>,
    /// (rows) f and its rate.
    pub(super) multipliers: Vec<f64>,
    pub(super) multiplier_rates: Vec<f64>,
    pub(super) right: Vec<f64>,
    pub(super) step: Vec<f64>,
    pub(super) load: Vec<f64>,
    pub(super) along_free: Vec<f64>,
    pub(super) velocity: Field,
    pub(super) acceleration: Field,
}

/// Freedoms at a configuration, and the results that belong to it.
#[derive(Debug, Clone, Copy)]
pub(super) struct State {
    /// (unknowns − rank) motions that the loops leave, with the commanded coordinates held.
    pub(super) free: usize,
    /// How many of them the least displacement does not determine either.
    pub(super) undetermined: usize,
    /// Which results belong to the configuration.
    pub(super) known: Known,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Known {
    Nothing,
    Loops,
    Velocities,
    Accelerations,
}

impl DifferentialKinematics {
    /// Lays out the equations for given commanded coordinates.
    ///
    /// # Arguments
    /// * `system` – gives the mechanism, the characteristic length and the metric of the virtual joints
    /// * `commanded` – indices of the coordinates whose rates are given, usually the actuated ones
    ///
    /// # Errors
    /// [`Error::PartlyCommanded`] for one or two coordinates of a ball, [`Error::NoSuchQuantity`] for an index of no coordinate.
    pub fn new(system: &MechanismSystem<'_>, commanded: &[usize]) -> Result<Self, Error> {
        let mut recorded = commanded.to_vec();
        recorded.sort_unstable();
        recorded.dedup();
        let loops = PositionSolver::lay_out(system, &recorded, &recorded)?;
        let kinematics = system.kinematics();
        let mechanism = kinematics.mechanism();
        let unknowns = loops.unknowns.len();
        let coordinates: Vec<usize> =
            loops.unknowns.iter().map(|one| one.coordinate).chain(recorded.clone()).collect();
        let length = loops.length;
        let unit = |&k: &usize| match kinematics.dimensions()[k] {
            Dimension::Angle => 1.0,
            Dimension::Length | Dimension::SquaredLength => length,
        };
        let units: Vec<f64> = coordinates.iter().map(unit).collect();
        let freedoms = mechanism.joint_freedoms();
        let metric = virtual_weights(system);
        let weight = |(&k, &unit): (&usize, &f64)| {
            k.checked_sub(freedoms).map_or(0.0, |m| metric[m] * unit * unit)
        };
        let mut weights: Vec<f64> =
            coordinates[..unknowns].iter().zip(&units).map(weight).collect();
        let largest = weights.iter().copied().fold(0.0, f64::max);
        let largest_weight = if largest > 0.0 { largest } else { 1.0 };
        weights.iter_mut().for_each(|weight| *weight /= largest_weight);
        let column = |k: &usize| {
            let found = recorded.binary_search(k).expect("all commanded coordinates are recorded");
            unknowns + found
        };
        let rows = loops.elimination.rows();
        let most_free = unknowns - loops.passive;
        Ok(Self {
            commanded: commanded.to_vec(),
            columns_of_commanded: commanded.iter().map(column).collect(),
            attached: mechanism.frames().iter().map(|f| (f.link, f.link_from_frame)).collect(),
            reference: system.reference(),
            state: State { free: 0, undetermined: 0, known: Known::Nothing },
            elimination: Elimination::new(rows, unknowns, recorded.len()),
            geometry: Vec::with_capacity(loops.closings.len()),
            screws: vec![STILL; coordinates.len()],
            screw_rates: vec![STILL; coordinates.len()],
            free: vec![0.0; most_free * unknowns],
            curvature: vec![0.0; most_free * most_free],
            multipliers: vec![0.0; rows],
            multiplier_rates: vec![0.0; rows],
            right: vec![0.0; rows],
            step: vec![0.0; unknowns],
            load: vec![0.0; unknowns],
            along_free: vec![0.0; most_free],
            velocity: Field::new(&loops),
            acceleration: Field::new(&loops),
            coordinates,
            units,
            weights,
            largest_weight,
            loops,
        })
    }

    /// The commanded coordinates, in the order of their rates.
    #[must_use]
    pub fn commanded(&self) -> &[usize] {
        &self.commanded
    }

    /// Unit of a coordinate among the commanded and the eliminated ones: 1 for a turn, the characteristic length for a slide.
    pub(crate) fn unit_of(&self, coordinate: usize) -> f64 {
        let place = self.coordinates.iter().position(|&k| k == coordinate);
        place.map_or(1.0, |place| self.units[place])
    }

    /// (f + M) number of all coordinates.
    #[must_use]
    pub fn coordinate_count(&self) -> usize {
        self.loops.coordinate_count()
    }

    /// The places of the three coordinates of each commanded ball among the commanded coordinates.
    pub(super) fn commanded_balls(&self) -> impl Iterator<Item = [usize; 3]> + '_ {
        let place = |k: usize| self.commanded.iter().position(|&one| one == k);
        self.loops
            .ball_coordinates()
            .filter_map(move |k| Some([place(k)?, place(k + 1)?, place(k + 2)?]))
    }

    /// Factors the equations at a closed configuration.
    ///
    /// # Arguments
    /// * `coordinates` – (f + M) all coordinates; virtual joints at their least displacement, as [`PositionSolver::solve`] and [`crate::mechanism::relieve`] return it (m, rad)
    ///
    /// # Errors
    /// [`Error::LengthMismatch`], [`Error::NotFinite`], [`Error::NotClosed`], [`Error::NotLeastDisplacement`].
    pub fn linearize(&mut self, coordinates: &[f64]) -> Result<(), Error> {
        self.state.known = Known::Nothing;
        self.loops.check(coordinates)?;
        self.loops.orient(coordinates);
        let residual = self.loops.mismatch(coordinates);
        if residual.is_nan() || residual > CLOSURE_TOLERANCE {
            return Err(Error::NotClosed { residual, allowed: CLOSURE_TOLERANCE });
        }
        self.place();
        self.fill();
        let unknowns = self.weights.len();
        let free = unknowns - self.elimination.reflect_columns();
        self.state = State { free, undetermined: free, known: Known::Loops };
        if free > 0 && free <= unknowns - self.loops.passive {
            self.least(coordinates)?;
        }
        Ok(())
    }

    /// Screws and meeting points where [`PositionSolver::mismatch`] was.
    fn place(&mut self) {
        for (screw, found) in self.screws.iter_mut().zip(&self.loops.screws) {
            *screw = (found.angular, found.velocity_of(&self.reference));
        }
        self.geometry.clear();
        let of = |closing| ClosingGeometry::of(closing, &self.reference);
        self.geometry.extend(self.loops.closings.iter().map(of));
    }

    /// The equations of all columns.
    fn fill(&mut self) {
        let rows = self.elimination.rows();
        self.elimination.matrix.fill(0.0);
        for (closing, geometry) in self.loops.closings.iter().zip(&self.geometry) {
            for &SideUnknown { column, sense, .. } in &closing.moved_by {
                let first = column * rows + closing.row;
                let last = first + closing.meeting.equations();
                let entries = &mut self.elimination.matrix[first..last];
                let factor = sense * self.units[column];
                geometry.add(&self.screws[column], self.loops.length, factor, entries);
            }
        }
        for coupling in &self.loops.couplings {
            for &(column, factor) in &coupling.columns {
                self.elimination.matrix[column * rows + coupling.row] = factor * self.units[column];
            }
        }
    }

    /// Motions of all links for the rates in `velocity`.
    pub(super) fn spread_velocities(&mut self) {
        let screws = &self.screws;
        self.velocity.spread(&self.loops, |field, k| scaled(&screws[k], field.rates[k]));
    }

    /// Motions of all links for the rates in `acceleration`, on top of those that velocities cause by themselves.
    fn spread_accelerations(&mut self) {
        let (screws, screw_rates, velocities) =
            (&self.screws, &self.screw_rates, &self.velocity.rates);
        self.acceleration.spread(&self.loops, |field, k| {
            plus(&scaled(&screws[k], field.rates[k]), &scaled(&screw_rates[k], velocities[k]))
        });
    }

    /// Velocities of all coordinates for those of the commanded ones.
    ///
    /// # Arguments
    /// * `commanded` – one for each commanded coordinate (m/s, rad/s)
    /// * `velocities` – (f + M) takes the result (m/s, rad/s)
    ///
    /// # Errors
    /// [`Error::Undetermined`] where commanded coordinates do not determine the motion, [`Error::DependentCommands`] where the loops do not allow it; [`Error::NotLinearized`] before [`linearize`](Self::linearize), [`Error::LengthMismatch`], [`Error::NotFinite`].
    pub fn velocities(&mut self, commanded: &[f64], velocities: &mut [f64]) -> Result<(), Error> {
        self.known(Known::Loops)?;
        self.check_rates(commanded, "the commanded velocities", velocities)?;
        self.state.known = Known::Loops;
        self.require_determined()?;
        self.right.fill(0.0);
        self.solve(commanded, Order::First, 0.0)?;
        if self.state.free > 0 {
            self.spread_velocities();
            self.load_of_velocities();
            self.correct(Order::First);
        }
        self.spread_velocities();
        for (k, rate) in self.screw_rates.iter_mut().enumerate() {
            *rate = bracket(&self.velocity.carriers[k], &self.screws[k]);
        }
        if self.state.free > 0 {
            self.load_of_velocities();
            self.load.iter_mut().for_each(|load| *load = -*load);
            self.elimination.multipliers(&self.load, &mut self.multiplier_rates);
        }
        self.write(Order::First, velocities);
        self.state.known = Known::Velocities;
        Ok(())
    }

    /// Accelerations of all coordinates for those of the commanded ones, at the velocities computed last.
    ///
    /// # Arguments
    /// * `commanded` – one for each commanded coordinate (m/s², rad/s²)
    /// * `accelerations` – (f + M) takes the result (m/s², rad/s²)
    ///
    /// # Errors
    /// Those of [`velocities`](Self::velocities); [`Error::NotLinearized`] before it.
    pub fn accelerations(
        &mut self,
        commanded: &[f64],
        accelerations: &mut [f64],
    ) -> Result<(), Error> {
        self.known(Known::Velocities)?;
        self.check_rates(commanded, "the commanded accelerations", accelerations)?;
        // What the loops would open by at these velocities, without any acceleration of a coordinate.
        self.acceleration.rates.fill(0.0);
        self.spread_accelerations();
        self.right.fill(0.0);
        let mut largest = 0.0_f64;
        for (l, closing) in self.loops.closings.iter().enumerate() {
            let last = closing.row + closing.meeting.equations();
            let entries = &mut self.right[closing.row..last];
            let relative = |[first, second]: &[Twist; 2]| minus(first, second);
            let (velocities, length) = (&self.velocity.sides[l], self.loops.length);
            largest = largest.max(largest_of(&self.acceleration.sides[l], length));
            let acceleration = relative(&self.acceleration.sides[l]);
            self.geometry[l].add(&acceleration, length, -1.0, entries);
            let rate = self.geometry[l].rate(velocities);
            rate.add(&relative(velocities), length, -1.0, entries);
        }
        self.elimination.reflect_right(&mut self.right);
        self.solve(commanded, Order::Second, largest)?;
        if self.state.free > 0 {
            self.spread_accelerations();
            self.load_of_accelerations();
            self.correct(Order::Second);
        }
        self.spread_accelerations();
        self.write(Order::Second, accelerations);
        self.state.known = Known::Accelerations;
        Ok(())
    }

    /// Rates of the unknowns for those of the commanded coordinates and the reflected right-hand side, dependent ones at zero.
    ///
    /// # Arguments
    /// * `largest` – of the motions whose differences are the right-hand side: where they cancel, round-off of this size is left
    pub(super) fn solve(
        &mut self,
        commanded: &[f64],
        order: Order,
        largest: f64,
    ) -> Result<(), Error> {
        let (rows, unknowns) = (self.elimination.rows(), self.weights.len());
        let field = match order {
            Order::First => &mut self.velocity,
            Order::Second => &mut self.acceleration,
        };
        let mut asked = self.right.iter().map(|value| value.abs()).fold(largest, f64::max);
        for (&column, &rate) in self.columns_of_commanded.iter().zip(commanded) {
            field.rates[column] = rate;
            let scaled = rate / self.units[column];
            let entries = &self.elimination.matrix[column * rows..(column + 1) * rows];
            for (right, entry) in self.right.iter_mut().zip(entries) {
                *right -= entry * scaled;
                asked = asked.max((entry * scaled).abs());
            }
        }
        let rank = unknowns - self.state.free;
        let left = self.right[rank..].iter().map(|value| value.abs()).fold(0.0, f64::max);
        if left > FOLLOWED * asked {
            return Err(Error::DependentCommands { share: left / asked, allowed: FOLLOWED });
        }
        self.elimination.substitute(&mut self.right, &mut self.step);
        for (k, step) in self.step.iter().enumerate() {
            field.rates[k] = step * self.units[k];
        }
        Ok(())
    }

    /// Rates of all coordinates, those at which loops are opened by the motions of the two sides.
    pub(super) fn write(&self, order: Order, out: &mut [f64]) {
        let field = match order {
            Order::First => &self.velocity,
            Order::Second => &self.acceleration,
        };
        for (&coordinate, rate) in self.coordinates.iter().zip(&field.rates) {
            out[coordinate] = *rate;
        }
        for (l, closing) in self.loops.closings.iter().enumerate() {
            let [first, second] = &closing.frames;
            let between = |sides: &[Twist; 2]| sides[1].0 - sides[0].0;
            let relative = between(&field.sides[l]);
            match closing.meeting {
                Meeting::Points(ball) => {
                    let turn = match order {
                        Order::First => Vector3::zeros(),
                        Order::Second => {
                            let sides = &self.velocity.sides[l];
                            sides[1].0.cross(&between(sides))
                        }
                    };
                    let rates = second.rotation().tr_mul(&(relative - turn));
                    let k = self.loops.ball_coordinate(ball);
                    out[k..k + 3].copy_from_slice(rates.as_slice());
                }
                Meeting::Axes(hinge) => out[hinge] = first.axis(2).dot(&relative),
                Meeting::Frames => {}
            }
        }
    }

    /// Whether the commanded coordinates determine the motion, at the configuration of [`linearize`](Self::linearize).
    ///
    /// # Errors
    /// [`Error::Undetermined`], [`Error::NotLinearized`].
    pub fn require_determined(&mut self) -> Result<(), Error> {
        self.known(Known::Loops)?;
        if self.state.undetermined == 0 {
            return Ok(());
        }
        let singular_values = self.singular_values()?;
        Err(Error::Undetermined(Box::new(Undetermined {
            motions: self.state.undetermined,
            singular_values,
        })))
    }

    /// Singular values of the equations of the opened loops, one for each passive and virtual coordinate, in radians and characteristic lengths, largest first.
    ///
    /// Zeros are freedoms that loops and commands leave; virtual joints can have some, which the least displacement determines.
    ///
    /// # Errors
    /// [`Error::NotLinearized`]; [`Error::Linalg`] (never seen).
    ///
    /// # Numerics
    /// One singular value decomposition, with allocation.
    pub fn singular_values(&self) -> Result<DVector<f64>, Error> {
        self.known(Known::Loops)?;
        let (rows, unknowns) = (self.elimination.rows(), self.weights.len());
        let mut equations = DMatrix::zeros(rows.max(unknowns), unknowns);
        for (closing, geometry) in self.loops.closings.iter().zip(&self.geometry) {
            let last = closing.row + closing.meeting.equations();
            for &SideUnknown { column, sense, .. } in &closing.moved_by {
                if column < unknowns {
                    let mut entries = equations.column_mut(column);
                    let entries = &mut entries.as_mut_slice()[closing.row..last];
                    let factor = sense * self.units[column];
                    geometry.add(&self.screws[column], self.loops.length, factor, entries);
                }
            }
        }
        for coupling in &self.loops.couplings {
            let of_unknowns = coupling.columns.iter().filter(|(column, _)| *column < unknowns);
            for &(column, factor) in of_unknowns {
                equations[(coupling.row, column)] = factor * self.units[column];
            }
        }
        Ok(svd(&equations)?.singular_values)
    }

    pub(super) fn known(&self, least: Known) -> Result<(), Error> {
        if self.state.known >= least { Ok(()) } else { Err(Error::NotLinearized) }
    }

    fn check_rates(&self, commanded: &[f64], what: &'static str, out: &[f64]) -> Result<(), Error> {
        let expected = self.commanded.len();
        if commanded.len() != expected {
            return Err(Error::LengthMismatch { what, found: commanded.len(), expected });
        }
        let expected = self.loops.coordinate_count();
        if out.len() != expected {
            let (what, found) = ("the vector of all rates", out.len());
            return Err(Error::LengthMismatch { what, found, expected });
        }
        commanded.iter().try_for_each(|&value| {
            crate::error::finite(what, value)?;
            if value.abs() <= LARGEST_RATE {
                return Ok(());
            }
            let (min, max) = (-LARGEST_RATE, LARGEST_RATE);
            let (what, unit) = ("commanded rate", "m/s or rad/s");
            Err(Error::OutOfRange { what, value, min, max, unit })
        })
    }
}

/// Order of a derivative with respect to time.
#[derive(Debug, Clone, Copy)]
pub(super) enum Order {
    First,
    Second,
}

/// Largest component of the motions of the two sides of a loop, in radians and characteristic lengths.
pub(super) fn largest_of(sides: &[Twist; 2], length: f64) -> f64 {
    let of_side = |side: &Twist| side.0.amax().max(side.1.amax() / length);
    of_side(&sides[0]).max(of_side(&sides[1]))
}
