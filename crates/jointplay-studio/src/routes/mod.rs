//! The endpoints, one file each, and functions that several of them share.

pub(crate) mod cell;
pub(crate) mod cell_entry;
pub(crate) mod cell_export;
pub(crate) mod cell_jog;
pub(crate) mod cell_parts;
pub(crate) mod cell_plan;
pub(crate) mod cell_samples;
pub(crate) mod cell_station;
pub(crate) mod compare;
pub(crate) mod controller;
pub(crate) mod forward;
pub(crate) mod inverse;
mod lookup;
pub(crate) mod mechanism;
pub(crate) mod mechanism_export;
pub(crate) mod mechanism_file;
pub(crate) mod mechanism_mobility;
pub(crate) mod mechanism_motions;
pub(crate) mod mechanism_open;
pub(crate) mod mechanism_reach;
pub(crate) mod mechanism_suggest;
pub(crate) mod mesh;
pub(crate) mod mobility;
pub(crate) mod pose;
pub(crate) mod quantity;
pub(crate) mod robot;
pub(crate) mod robot_file;
pub(crate) mod sensitivity;
pub(crate) mod study;

use jointplay::gpr::{AxisHeight, BrokenLimit, CenterHeight, Gpr};
use jointplay::spatial::Tilt;
use jointplay::virtualization::{SolveOptions, Virtualization};

use crate::problem::Problem;
use crate::wire::{HeightKind, Target};

/// The rod lengths of a command, and the tilt to compare with the limits.
fn solve_command(
    gpr: &Gpr,
    target: Target,
    model: &(dyn Virtualization + Sync),
    options: &SolveOptions,
) -> Result<([f64; 3], Tilt), Problem> {
    match target {
        Target::Rods(rods) => Ok((rods, gpr.plane_tilt(&rods))),
        Target::Tilt { tilt, height } => {
            let rods = match height.kind {
                HeightKind::Axis => gpr.inverse(tilt, AxisHeight(height.value_m))?,
                HeightKind::Center => {
                    let height = CenterHeight(height.value_m);
                    gpr.inverse_for_center(tilt, height, model, options)?.rods
                }
            };
            Ok((rods, tilt))
        }
    }
}

/// The limits that a pose violates.
///
/// # Errors
/// A violated limit, unless limits are ignored.
fn check_limits(
    gpr: &Gpr,
    rods: &[f64; 3],
    tilt: Tilt,
    ignore: bool,
) -> Result<Vec<BrokenLimit>, Problem> {
    accepted_limits(gpr.limits().broken(rods, tilt).iter().collect(), ignore)
}

/// Exceeded limits; an error if there are any, unless they are to be ignored.
fn accepted_limits(broken: Vec<BrokenLimit>, ignore: bool) -> Result<Vec<BrokenLimit>, Problem> {
    if broken.is_empty() || ignore { Ok(broken) } else { Err(Problem::limits(&broken)) }
}
