//! Motions of all links for rates of the coordinates.

use super::closing_geometry::STILL;
use super::solver::PositionSolver;
use super::walk::{Recorded, Walk};
use crate::mechanism::joint::Twist;
use crate::mechanism::kinematics::plus;

/// Rates of all coordinates, and the motions that they make, linear parts at the reference point.
#[derive(Debug, Clone)]
pub(super) struct Field {
    /// (columns) first or second derivatives of the coordinates (m, rad).
    pub(super) rates: Vec<f64>,
    /// (columns) motion of the frame that carries each screw.
    pub(super) carriers: Vec<Twist>,
    /// (links) motion of each link.
    pub(super) links: Vec<Twist>,
    /// (closings) motions of the two sides of each opened loop.
    pub(super) sides: Vec<[Twist; 2]>,
}

impl Field {
    pub(super) fn new(loops: &PositionSolver) -> Self {
        let columns = loops.screws.len();
        Self {
            rates: vec![0.0; columns],
            carriers: vec![STILL; columns],
            links: vec![STILL; loops.link_count()],
            sides: vec![[STILL; 2]; loops.closings.len()],
        }
    }

    /// Adds up, from the base to every link and to both sides of every opened loop, what each coordinate contributes.
    ///
    /// # Arguments
    /// * `own` – contribution of a column
    #[inline]
    pub(super) fn spread(&mut self, loops: &PositionSolver, own: impl Fn(&Self, usize) -> Twist) {
        self.links[0] = STILL;
        for edge in &loops.tree {
            self.links[edge.to] = self.along(&edge.walk, self.links[edge.from], &own);
        }
        for (l, closing) in loops.closings.iter().enumerate() {
            for side in 0..2 {
                let from = self.links[closing.links[side]];
                self.sides[l][side] = self.along(&closing.sides[side], from, &own);
            }
        }
    }

    #[inline]
    fn along(
        &mut self,
        walk: &Walk,
        mut motion: Twist,
        own: impl Fn(&Self, usize) -> Twist,
    ) -> Twist {
        for Recorded { columns, behind } in walk.recorded() {
            let before = motion;
            for k in columns.clone() {
                motion = plus(&motion, &own(self, k));
            }
            let carrier = if behind { motion } else { before };
            self.carriers[columns].fill(carrier);
        }
        motion
    }
}
