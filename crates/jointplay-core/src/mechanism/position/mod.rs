//! Positions, fast: what passive and virtual joints do for commanded ones, without allocation.

mod elimination;
mod opening;
mod solver;
mod walk;

pub use solver::{Position, PositionSolver};
