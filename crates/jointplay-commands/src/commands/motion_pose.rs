//! Motions that lead frames of links to commanded poses.

use jointplay::format::command::{PosePoint, frame_paths};
use jointplay::mechanism::{DrivenMotion, MechanismSystem, Stop, drive_frames};
use jointplay::nalgebra::DVector;
use jointplay::report::{self, MotionParameter};
use jointplay::spatial::Pose;

use super::motion_drives::PoseCourse;
use crate::failure::Failure;
use crate::mechanism_input::Input;
use crate::progress::Progress;

/// Steps to the start of a curve.
const APPROACH: usize = 10;

/// A motion to or along commanded poses.
pub(super) struct PoseMotion {
    pub(super) moved: DrivenMotion,
    pub(super) parameter: MotionParameter,
    /// The last poses that are possible, if the motion stopped there.
    pub(super) nearest: Option<String>,
}

/// A line of a message with the last poses that are possible.
pub(super) fn nearest_possible(nearest: Option<String>) -> String {
    nearest.map_or(String::new(), |poses| format!("\n  nearest possible: {poses}"))
}

/// Leads frames from the closed configuration to the commanded poses.
pub(super) fn pose_motion(input: &Input, course: &PoseCourse<'_>) -> Result<PoseMotion, Failure> {
    let mechanism = &input.file.mechanism;
    let home = MechanismSystem::new(mechanism, input.at_rest()?.coordinates)?;
    let links = home.kinematics().link_poses(home.home())?;
    let frame = |k: usize| home.kinematics().frame_pose(course.commands[k].frame(), &links);
    let poses: Vec<Pose> = (0..course.commands.len()).map(frame).collect();
    let along = |start: &DVector<f64>, points: &[PosePoint], stage: &str| {
        let paths = frame_paths(&course.commands, &poses, &course.names, points)
            .map_err(|error| Failure::Usage(error.to_string()))?;
        let mut progress = Progress::new(points.len());
        progress.stage(stage);
        Ok::<_, Failure>(drive_frames(&home, start, &paths, &mut |done| progress.at(done))?)
    };
    let nearest = |moved: &DrivenMotion, point: PosePoint| {
        // Where the search ended without an answer, farther poses were not examined.
        moved.stopped.filter(|stop| *stop != Stop::NotLeast)?;
        let each = course.commands.iter().zip(&poses);
        let texts = each
            .map(|(command, home)| command.at_share(home, &course.names, point.at, point.share));
        let texts: Result<Vec<String>, _> = texts.collect();
        texts.ok().map(|texts| texts.join("\n  "))
    };
    let first = course.values.first().copied().unwrap_or_default();
    let mut start = home.home().clone();
    if course.is_curve {
        #[expect(clippy::cast_precision_loss, reason = "counts of steps")]
        let share = |k: usize| k as f64 / APPROACH as f64;
        let points: Vec<PosePoint> =
            (0..=APPROACH).map(|k| PosePoint { at: first, share: share(k) }).collect();
        let moved = along(&start, &points, "to the start")?;
        if let Some(last) = moved.waypoints.last() {
            start = last.coordinates.clone();
        }
        let parameter = MotionParameter {
            name: "share of the first pose".to_owned(),
            values: points.iter().map(|point| point.share).collect(),
        };
        if let Some(message) =
            report::motion(&input.file, &[], &[], Some(&parameter), &moved).message
        {
            let share = moved.waypoints.last().map_or(0.0, |last| last.share);
            let nearest = nearest(&moved, PosePoint { at: first, share });
            return Err(Failure::Stopped(format!(
                "before the start of the curve: {message}{}",
                nearest_possible(nearest)
            )));
        }
    }
    let point = |&value: &f64| match course.is_curve {
        true => PosePoint { at: value, share: 1.0 },
        false => PosePoint { at: 0.0, share: value },
    };
    let points: Vec<PosePoint> = course.values.iter().map(point).collect();
    let moved = along(&start, &points, "moving")?;
    let name = match course.names.variable() {
        Some(variable) if course.is_curve => variable.to_owned(),
        _ => "share".to_owned(),
    };
    let parameter = MotionParameter { name, values: course.values.clone() };
    let last = moved.waypoints.last();
    let nearest = last.and_then(|last| nearest(&moved, point(&parameter.value_at(last.share))));
    Ok(PoseMotion { moved, parameter, nearest })
}
