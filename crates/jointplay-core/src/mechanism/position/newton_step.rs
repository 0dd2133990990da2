//! Parts of Newton's iteration for positions: where the loops are open, by how much joints change that, and a step.

use nalgebra::{Matrix3, Rotation3, Vector3};

use super::elimination::larger;
use super::opening::{Meeting, SideUnknown, TreeEdge};
use super::solver::{LONGEST_STEP, PositionSolver};
use super::unknown::CoupledRow;
use super::walk::Turned;
use crate::mechanism::ReliefSolver;
use crate::mechanism::ball::cayley;
use crate::mechanism::kinematics::skew_part;
use crate::spatial::{nearest_angle, rotation_vector};

impl PositionSolver {
    /// Turns all balls to their coordinates, and forgets earlier turns.
    pub(super) fn orient(&mut self, coordinates: &[f64]) {
        self.turns.iter_mut().for_each(Turned::refresh);
        for (turn, ball) in self.orientations.iter_mut().zip(&self.balls) {
            // That of an opened ball follows when its loop is closed.
            if ball.opened {
                continue;
            }
            let k = ball.coordinate;
            let vector = Vector3::new(coordinates[k], coordinates[k + 1], coordinates[k + 2]);
            *turn = if vector == Vector3::zeros() {
                Matrix3::identity()
            } else {
                Rotation3::new(vector).into_inner()
            };
        }
    }

    /// Walks all joints; the largest mismatch of a loop or coupling, in radians and characteristic lengths.
    pub(super) fn mismatch(&mut self, coordinates: &[f64]) -> f64 {
        for TreeEdge { start, to, walk, .. } in &self.tree {
            self.frames[*to] = walk.follow(
                &self.frames[*start],
                coordinates,
                &self.orientations,
                &mut self.turns,
                &mut self.screws,
            );
        }
        let per_length = self.length.recip();
        let mut squares = 0.0_f64;
        for closing in &mut self.closings {
            for side in 0..2 {
                closing.frames[side] = closing.sides[side].follow(
                    &self.frames[closing.starts[side]],
                    coordinates,
                    &self.orientations,
                    &mut self.turns,
                    &mut self.screws,
                );
            }
            let [first, second] = &closing.frames;
            let apart = (first.origin() - second.origin()) * per_length;
            let entries = &mut self.elimination.right[closing.row..];
            entries[..3].copy_from_slice((-apart).as_slice());
            squares = larger(squares, apart.norm_squared());
            // Half turns leave no antisymmetric part behind, but are no closure: distances see them.
            let off = match closing.meeting {
                Meeting::Points(_) => continue,
                Meeting::Axes(_) => {
                    let z = first.axis(2);
                    entries[3] = -second.axis(0).dot(&z);
                    entries[4] = -second.axis(1).dot(&z);
                    (z - second.axis(2)).norm_squared()
                }
                Meeting::Frames => {
                    let (first, second) = (first.rotation(), second.rotation());
                    let turned = skew_part(&(first * second.transpose()));
                    entries[3..6].copy_from_slice((-turned).as_slice());
                    (first - second).norm_squared() * 0.5
                }
            };
            squares = larger(squares, off);
        }
        let mut largest = squares.sqrt();
        for CoupledRow { equation, row, .. } in &self.couplings {
            let violation = equation.residual(|k| coordinates[k]);
            self.elimination.right[*row] = -violation;
            largest = larger(largest, violation.abs());
        }
        largest
    }

    /// Factors the equations where [`Self::mismatch`] was.
    pub(super) fn linearize(&mut self) {
        let per_length = self.length.recip();
        for (l, closing) in self.closings.iter().enumerate() {
            let [first_side, second_side] = &closing.frames;
            let z = first_side.axis(2);
            // How the components of the first z along the second x and y change with a turn.
            let across = [0, 1].map(|axis| z.cross(&second_side.axis(axis)));
            let columns = self.elimination.columns_mut(l);
            for (entries, moved) in columns.zip(&closing.moved_by) {
                let &SideUnknown { column, sense, side } = moved;
                let screw = &self.screws[column];
                let scale = sense * self.unknowns[column].unit;
                let linear =
                    screw.velocity_of(&closing.frames[side].origin()) * (scale * per_length);
                entries[..3].copy_from_slice(linear.as_slice());
                let angular = screw.angular * scale;
                match closing.meeting {
                    Meeting::Points(_) => {}
                    Meeting::Axes(_) => {
                        entries[3] = across[0].dot(&angular);
                        entries[4] = across[1].dot(&angular);
                    }
                    Meeting::Frames => entries[3..6].copy_from_slice(angular.as_slice()),
                }
            }
        }
        let unknowns = &self.unknowns;
        self.elimination.factor(|column| unknowns[column].unit);
    }

    /// One step from where [`Self::mismatch`] was, by the last factor; returns how far virtual joints moved in their metric.
    pub(super) fn step(&mut self, coordinates: &mut [f64], solver: ReliefSolver) -> f64 {
        for (value, unknown) in self.relieved.iter_mut().zip(&self.unknowns[self.passive..]) {
            *value = coordinates[unknown.coordinate] / unknown.unit;
        }
        self.elimination.solve(&self.relieved, solver);
        let step = &mut self.elimination.step;
        let size = step[..self.passive].iter().map(|value| value * value).sum::<f64>().sqrt();
        if size > LONGEST_STEP {
            step.iter_mut().for_each(|value| *value *= LONGEST_STEP / size);
        }
        for (unknown, value) in self.unknowns.iter().zip(step.iter()) {
            coordinates[unknown.coordinate] += value * unknown.unit;
        }
        for (turn, ball) in self.orientations.iter_mut().zip(&self.balls) {
            if let Some(column) = ball.column {
                let by = Vector3::from_column_slice(&step[column..column + 3]);
                *turn *= cayley(&by).matrix();
            }
        }
        step[self.passive..].iter().map(|value| value * value).sum::<f64>().sqrt()
    }

    /// Coordinates of the hinges at which loops are open, and of all balls that move.
    pub(super) fn close_openings(&mut self, coordinates: &mut [f64]) {
        for closing in &self.closings {
            let [first, second] = &closing.frames;
            match closing.meeting {
                Meeting::Points(ball) => {
                    self.orientations[ball] = first.rotation().tr_mul(&second.rotation());
                }
                Meeting::Axes(hinge) => {
                    let x = second.axis(0);
                    let angle = first.axis(1).dot(&x).atan2(first.axis(0).dot(&x));
                    // As many full turns as the start had.
                    coordinates[hinge] = nearest_angle(angle, coordinates[hinge]);
                }
                Meeting::Frames => {}
            }
        }
        let balls = self.orientations.iter().zip(&self.balls);
        for (turn, ball) in balls.filter(|(_, ball)| !ball.is_commanded()) {
            let vector = rotation_vector(&Rotation3::from_matrix_unchecked(*turn));
            coordinates[ball.coordinate..ball.coordinate + 3].copy_from_slice(vector.as_slice());
        }
    }
}
