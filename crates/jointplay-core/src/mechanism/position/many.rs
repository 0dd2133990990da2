//! Positions for many configurations of one mechanism, side by side in the registers of the processor.
#![allow(
    clippy::needless_range_loop,
    reason = "closures would not be inlined, and be compiled without wide instructions"
)]

use std::f64::consts::TAU;

use pulp::{Arch, Simd, WithSimd};

use super::bordered::EliminationPlan;
use super::frame::Frame;
use super::lane_elimination::{LaneElimination, sum_of_squares};
use super::lane_frame::{
    LaneFrame, LaneScrew, Three, cross, dot, minus, rotation_of, rotation_vector_of, three, times,
    turned_by,
};
use super::opening::{Closing, Meeting, TreeEdge};
use super::solver::{LONGEST_STEP, PositionSolver, ROUND_OFF};
use crate::Error;
use crate::bulk::{Status, StatusCounts};
use crate::constraint::CLOSURE_TOLERANCE;
use crate::kernel::{Lanes, MOST, Mask};
use crate::mechanism::ReliefSolver;

/// Steps after which a configuration is left to the solver for single ones: Newton's method takes three to five.
const STEPS: usize = 12;

impl PositionSolver {
    /// Closes the loops for many configurations, which are independent of each other.
    ///
    /// Rows without a solution are NaN, and have their reason in `status`.
    ///
    /// # Arguments
    /// * `coordinates` – (configurations, f + M) by rows; of each row the commanded coordinates at their values, the others near; takes the solutions (m, rad)
    /// * `solver` – as for [`PositionSolver::solve`]
    /// * `residuals` – (configurations) takes the largest mismatches, in radians and characteristic lengths
    /// * `status` – (configurations) whether each is solved, or the reason why not
    ///
    /// # Errors
    /// [`Error::LengthMismatch`] unless all have the same number of configurations.
    ///
    /// # Numerics
    /// Several configurations at a time, in the order of elimination of the configuration that the solver was laid out at; where that order does not serve, where Newton's method does not converge at once, and where virtual joints are displaced, by [`PositionSolver::solve`].
    /// Both iterations end at 10⁻¹³, or where no step gains anything.
    /// A row has the same bits at any place among any others, on every processor; it differs from that of [`PositionSolver::solve`] by round-off, except in motions that commands leave undetermined.
    pub fn solve_many(
        &mut self,
        coordinates: &mut [f64],
        solver: ReliefSolver,
        residuals: &mut [f64],
        status: &mut [Status],
    ) -> Result<StatusCounts, Error> {
        let width = self.coordinate_count();
        let expected = width * status.len();
        if coordinates.len() != expected {
            let (what, found) = ("the rows of coordinates", coordinates.len());
            return Err(Error::LengthMismatch { what, found, expected });
        }
        if residuals.len() != status.len() {
            let (what, found) = ("the column of residuals", residuals.len());
            return Err(Error::LengthMismatch { what, found, expected: status.len() });
        }
        let mut rows = Rows { width, coordinates, residuals, status };
        match self.plan.take() {
            Some(plan) => {
                Arch::new().dispatch(Block {
                    solver: self,
                    plan: &plan,
                    rows: &mut rows,
                    relief: solver,
                });
                self.plan = Some(plan);
            }
            None => (0..rows.status.len()).for_each(|row| self.solve_row(&mut rows, row, solver)),
        }
        Ok(StatusCounts::of(status))
    }

    /// One row by itself.
    fn solve_row(&mut self, rows: &mut Rows<'_>, row: usize, solver: ReliefSolver) {
        let coordinates = &mut rows.coordinates[row * rows.width..(row + 1) * rows.width];
        let (residual, status) = match self.solve(coordinates, solver) {
            Ok(position) => (position.residual, Status::Solved),
            Err(error) => {
                coordinates.fill(f64::NAN);
                (f64::NAN, Status::from_error(&error).unwrap_or(Status::NotConverged))
            }
        };
        (rows.residuals[row], rows.status[row]) = (residual, status);
    }
}

/// Configurations with their results.
struct Rows<'a> {
    width: usize,
    coordinates: &'a mut [f64],
    residuals: &'a mut [f64],
    status: &'a mut [Status],
}

/// All rows, in blocks of as many as there are lanes.
struct Block<'a, 'b> {
    solver: &'a mut PositionSolver,
    plan: &'a EliminationPlan,
    rows: &'a mut Rows<'b>,
    relief: ReliefSolver,
}

impl WithSimd for Block<'_, '_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let Self { solver, plan, rows, relief } = self;
        let mut room = Room::new(simd, solver, plan);
        let count = Lanes::<S>::COUNT;
        let mut first = 0;
        while first < rows.status.len() {
            let last = (first + count).min(rows.status.len());
            room.load(rows, first);
            let solved = room.iterate(solver).answers();
            room.close_openings(solver);
            let residuals = room.residual.numbers();
            for (lane, row) in (first..last).enumerate() {
                if solved[lane] {
                    room.numbers(
                        lane,
                        &mut rows.coordinates[row * rows.width..(row + 1) * rows.width],
                    );
                    (rows.residuals[row], rows.status[row]) = (residuals[lane], Status::Solved);
                } else {
                    solver.solve_row(rows, row, relief);
                }
            }
            first = last;
        }
    }
}

/// One block of configurations.
struct Room<'a, S: Simd> {
    simd: S,
    coordinates: Vec<Lanes<S>>,
    orientations: Vec<[Three<S>; 3]>,
    frames: Vec<LaneFrame<S>>,
    sides: Vec<[LaneFrame<S>; 2]>,
    screws: Vec<LaneScrew<S>>,
    elimination: LaneElimination<'a, S>,
    residual: Lanes<S>,
}

impl<'a, S: Simd> Room<'a, S> {
    fn new(simd: S, solver: &PositionSolver, plan: &'a EliminationPlan) -> Self {
        let zero = Lanes::splat(simd, 0.0);
        let base = LaneFrame::splat(simd, &Frame::BASE);
        Self {
            simd,
            coordinates: vec![zero; solver.coordinate_count()],
            orientations: vec![base.axes; solver.balls.len()],
            frames: solver.frames.iter().map(|frame| LaneFrame::splat(simd, frame)).collect(),
            sides: vec![[base; 2]; solver.closings.len()],
            screws: vec![LaneScrew::still(simd); solver.screws.len()],
            elimination: LaneElimination::new(simd, plan, solver.passive),
            residual: zero,
        }
    }

    /// Takes rows from `first` on; lanes beyond the last row repeat it.
    #[inline(always)]
    fn load(&mut self, rows: &Rows<'_>, first: usize) {
        let last = rows.status.len() - 1;
        let mut numbers = [0.0; MOST];
        for (k, coordinate) in self.coordinates.iter_mut().enumerate() {
            for (lane, number) in numbers[..Lanes::<S>::COUNT].iter_mut().enumerate() {
                *number = rows.coordinates[(first + lane).min(last) * rows.width + k];
            }
            *coordinate = Lanes::of(self.simd, &numbers[..Lanes::<S>::COUNT]);
        }
    }

    /// The coordinates of a lane.
    #[inline(always)]
    fn numbers(&self, lane: usize, row: &mut [f64]) {
        for (number, coordinate) in row.iter_mut().zip(&self.coordinates) {
            *number = coordinate.numbers()[lane];
        }
    }

    /// Newton's method; where it has converged.
    #[inline(always)]
    fn iterate(&mut self, solver: &PositionSolver) -> Mask<S> {
        let zero = Lanes::splat(self.simd, 0.0);
        for (turn, ball) in self.orientations.iter_mut().zip(&solver.balls) {
            let k = ball.coordinate;
            *turn = rotation_of(&three!(axis => self.coordinates[k + axis]));
        }
        let mut before = zero.like(f64::INFINITY);
        let mut serves = zero.at_most(zero);
        let mut done = !serves;
        let mut steps = 0;
        loop {
            let residual = self.mismatch(solver);
            self.residual = residual;
            let closed = residual.at_most(zero.like(CLOSURE_TOLERANCE));
            let stalled = (before * 0.5).below(residual);
            done = done | residual.at_most(zero.like(ROUND_OFF)) | (closed & stalled);
            if (done | !serves).all() || steps == STEPS {
                return done & serves;
            }
            self.linearize(solver);
            serves =
                serves & (done | self.elimination.solve(|column| solver.unknowns[column].unit));
            self.step(solver, done);
            before = residual;
            steps += 1;
        }
    }

    /// Walks all joints; the largest mismatch of a loop or coupling, in radians and characteristic lengths.
    #[inline(always)]
    fn mismatch(&mut self, solver: &PositionSolver) -> Lanes<S> {
        let zero = Lanes::splat(self.simd, 0.0);
        let (coordinates, balls) = (&self.coordinates, &self.orientations);
        for TreeEdge { start, to, walk, .. } in &solver.tree {
            let mut frame = self.frames[*start];
            frame.follow(walk, coordinates, balls, &mut self.screws);
            self.frames[*to] = frame;
        }
        let per_length = zero.like(1.0 / solver.length);
        // The largest square, and the largest violation of a coupling.
        let (mut largest, mut violated) = (zero, zero);
        for (closing, frames) in solver.closings.iter().zip(&mut self.sides) {
            for side in 0..2 {
                let mut frame = self.frames[closing.starts[side]];
                frame.follow(&closing.sides[side], coordinates, balls, &mut self.screws);
                frames[side] = frame;
            }
            let [first, second] = &*frames;
            let apart = times(&minus(&second.origin, &first.origin), per_length);
            let right = &mut self.elimination.right[closing.row..];
            right[..3].copy_from_slice(&apart);
            largest = larger(largest, dot(&apart, &apart));
            // Half turns leave no antisymmetric part behind, but are no closure: distances see them.
            let off = match closing.meeting {
                Meeting::Points(_) => continue,
                Meeting::Axes(_) => {
                    let z = &first.axes[2];
                    right[3] = -dot(&second.axes[0], z);
                    right[4] = -dot(&second.axes[1], z);
                    let off = minus(z, &second.axes[2]);
                    dot(&off, &off)
                }
                Meeting::Frames => {
                    let mut turned = [zero; 3];
                    let mut square = zero;
                    for k in 0..3 {
                        let (a, b) = (&first.axes[k], &second.axes[k]);
                        // Σ_k (b_k × a_k) / 2 is the vector of the antisymmetric part of A Bᵀ.
                        let product = cross(b, a);
                        turned = three!(axis => turned[axis] + product[axis]);
                        let off = minus(a, b);
                        square = square + dot(&off, &off);
                    }
                    right[3..6].copy_from_slice(&times(&turned, zero.like(-0.5)));
                    square * 0.5
                }
            };
            largest = larger(largest, off);
        }
        for row in &solver.couplings {
            let mut sum = zero.like(-row.equation.constant);
            for &(k, factor) in &row.equation.entries {
                sum = coordinates[k].times_plus(zero.like(factor), sum);
            }
            self.elimination.right[row.row] = -sum;
            violated = larger(violated, sum.abs());
        }
        larger(largest.sqrt(), violated)
    }

    #[inline(always)]
    fn linearize(&mut self, solver: &PositionSolver) {
        let zero = Lanes::splat(self.simd, 0.0);
        for (l, (closing, frames)) in solver.closings.iter().zip(&self.sides).enumerate() {
            let z = frames[0].axes[2];
            let across = [cross(&z, &frames[1].axes[0]), cross(&z, &frames[1].axes[1])];
            for (position, moved) in closing.moved_by.iter().enumerate() {
                let screw = &self.screws[moved.column];
                let scale = moved.sense * solver.unknowns[moved.column].unit;
                let linear = screw.velocity_of(&frames[moved.side].origin);
                let entries = self.elimination.column_mut(l, position);
                entries[..3].copy_from_slice(&times(&linear, zero.like(scale / solver.length)));
                match closing.meeting {
                    Meeting::Points(_) => {}
                    Meeting::Axes(_) => {
                        entries[3] = dot(&across[0], &screw.angular) * scale;
                        entries[4] = dot(&across[1], &screw.angular) * scale;
                    }
                    Meeting::Frames => {
                        entries[3..6].copy_from_slice(&times(&screw.angular, zero.like(scale)));
                    }
                }
            }
        }
    }

    /// Moves those that are not done.
    #[inline(always)]
    fn step(&mut self, solver: &PositionSolver, done: Mask<S>) {
        let zero = Lanes::splat(self.simd, 0.0);
        let step = &mut self.elimination.step;
        let size = sum_of_squares(zero, step).sqrt();
        let longest = zero.like(LONGEST_STEP);
        let share = size.at_most(longest).select(zero.like(1.0), longest / size);
        let share = done.select(zero, share);
        for (value, unknown) in step.iter_mut().zip(&solver.unknowns) {
            *value = *value * share;
            let coordinate = &mut self.coordinates[unknown.coordinate];
            *coordinate = value.times_plus(zero.like(unknown.unit), *coordinate);
        }
        for (turn, ball) in self.orientations.iter_mut().zip(&solver.balls) {
            if let Some(column) = ball.column {
                *turn = turned_by(turn, &[step[column], step[column + 1], step[column + 2]]);
            }
        }
    }

    /// Coordinates of the hinges at which loops are open, and of all balls that move.
    #[inline(always)]
    fn close_openings(&mut self, solver: &PositionSolver) {
        for (Closing { meeting, .. }, [first, second]) in solver.closings.iter().zip(&self.sides) {
            match *meeting {
                Meeting::Points(ball) => {
                    // Rᵀ S, by columns.
                    self.orientations[ball] =
                        three!(c => three!(r => dot(&first.axes[r], &second.axes[c])));
                }
                Meeting::Axes(hinge) => {
                    let x = &second.axes[0];
                    let angle =
                        crate::kernel::angle_of(dot(&first.axes[1], x), dot(&first.axes[0], x));
                    // As many full turns as the start had.
                    let turns = ((self.coordinates[hinge] - angle) / TAU).each(f64::round);
                    self.coordinates[hinge] = turns.times_plus(turns.like(TAU), angle);
                }
                Meeting::Frames => {}
            }
        }
        for (turn, ball) in self.orientations.iter().zip(&solver.balls) {
            if ball.is_commanded() {
                continue;
            }
            let vector = rotation_vector_of(self.simd, turn);
            self.coordinates[ball.coordinate..ball.coordinate + 3].copy_from_slice(&vector);
        }
    }
}

/// The larger of two numbers, NaN if one is.
#[inline(always)]
fn larger<S: Simd>(a: Lanes<S>, b: Lanes<S>) -> Lanes<S> {
    b.at_most(a).select(a, a.below(b).select(b, a + b))
}
