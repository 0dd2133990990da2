//! The example cell, and motions in cells.

use jointplay_cell::program::expand;
use jointplay_cell::trajectory::{Trajectory, TrajectoryOptions, plan_trajectory};
use jointplay_cell::workcell::Cell;
use jointplay_format::{cell, program};

pub(crate) fn example() -> Cell {
    cell::read(cell::EXAMPLE, &mut |_| Err("no files".to_owned())).unwrap()
}

/// The motion of a program.
pub(crate) fn planned(cell: &Cell, program: &str) -> Trajectory {
    let steps = expand(cell, &program::parse(program).unwrap()).unwrap();
    plan_trajectory(cell, steps, &TrajectoryOptions::default()).unwrap()
}
