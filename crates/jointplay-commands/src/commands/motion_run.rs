//! Running a motion: to the start of its path, then along it.

use std::ops::ControlFlow;

use jointplay::mechanism::{Drive, DrivePath, DrivenMotion, drive_from, held_actuators};
use jointplay::nalgebra::DVector;
use jointplay::report;

use super::motion_course::{Course, STEPS};
use crate::failure::Failure;
use crate::mechanism_input::Input;
use crate::progress::Progress;

/// The configuration at the start of a path.
pub(super) fn at_start(
    input: &Input,
    from: DVector<f64>,
    course: &Course,
    held: &[usize],
) -> Result<DVector<f64>, Failure> {
    let to: Vec<(usize, f64)> = course.path.values_at(0.0).collect();
    if to.iter().all(|&(k, value)| value == from[k]) {
        return Ok(from);
    }
    driven_to(input, &from, &to, held, "FROM")
}

/// The configuration with commanded coordinates driven to their values, and other actuators held as in `jointplay move`.
pub(super) fn driven(
    input: &Input,
    from: &DVector<f64>,
    commands: &[(usize, f64)],
    place: &str,
) -> Result<DVector<f64>, Failure> {
    let driven: Vec<usize> = commands.iter().map(|&(k, _)| k).collect();
    driven_to(input, from, commands, &held_actuators(&input.file.mechanism, &driven), place)
}

/// The configuration with coordinates driven to their values; `place` is its name in messages.
fn driven_to(
    input: &Input,
    from: &DVector<f64>,
    to: &[(usize, f64)],
    held: &[usize],
    place: &str,
) -> Result<DVector<f64>, Failure> {
    let drives: Vec<Drive> = to.iter().map(|&(coordinate, to)| Drive { coordinate, to }).collect();
    let path = DrivePath::line(from, &drives)?;
    let course = Course { path, steps: STEPS, parameter: None };
    let moved = follow(input, from, &course, held, &format!("to {place}"))?;
    let driven = course.path.coordinates();
    match (report::motion(&input.file, driven, held, None, &moved).message, moved.waypoints.last())
    {
        (Some(message), _) => Err(Failure::Stopped(format!("before {place}: {message}"))),
        (None, Some(last)) => Ok(last.coordinates.clone()),
        (None, None) => Ok(from.clone()),
    }
}

/// Drives along a path with a progress bar: by dense algebra with virtual joints, or by sparse algebra if there are many loops.
pub(super) fn follow(
    input: &Input,
    from: &DVector<f64>,
    course: &Course,
    held: &[usize],
    stage: &str,
) -> Result<DrivenMotion, Failure> {
    let (mechanism, path, steps) = (&input.file.mechanism, &course.path, course.steps);
    let mut progress = Progress::new(steps);
    progress.stage(stage);
    let mut progress = |done| {
        progress.at(done);
        ControlFlow::Continue(())
    };
    drive_from(mechanism, from, path, held, steps, input.tolerance, &mut progress)
        .map_err(|error| input.unassembled(error))
}
