//! Safe zones, which wafer centres must not leave while the robot turns.

use jointplay_core::spatial::Pose;

use super::segment_findings::Alone;
use crate::collision::{Course, Gearing, Levers, Lost, Scene};
use crate::geometry::{Placed, outside};
use crate::robot::EffectorId;
use crate::violation::{Found, Hit, Kind, Unit, When};

impl Alone {
    /// The centre of an effector stays in the safe zones while the robot turns: looked at where it may have come to an edge.
    pub(super) fn zones(
        &self,
        scene: &Scene<'_>,
        (course, gearing): (&Course, &Gearing),
        (place, id): (usize, EffectorId),
        found: &mut Found,
    ) {
        let kind = Kind::SafeZone;
        let levers = Levers::of_center(scene.cell, id);
        for run in &self.runs {
            let (mut sample, mut stride) = (run.start, 1);
            while sample < run.end {
                let pose = match scene.wafer(id, &course.positions(sample)) {
                    Ok(pose) => pose,
                    Err(why) => {
                        let when = When { time: course.times()[sample], sample };
                        Lost { when, why }.report(found);
                        (sample, stride) = (sample + 1, 1);
                        continue;
                    }
                };
                let mut room = f64::INFINITY;
                for (zone, solid) in &scene.safe {
                    let placed = Placed { solid, base_from_carrier: &Pose::identity() };
                    let off = outside(placed, &pose.translation.vector);
                    room = room.min(-off);
                    if off > 0.0 {
                        let (about, unit) = ((kind, place, *zone), Unit::Length);
                        let hit = Hit { about, kind, severity: off, value: off, limit: 0.0, unit };
                        let when = When { time: course.times()[sample], sample };
                        found.add(when, hit, String::new);
                    }
                }
                // The farthest sample to which the centre cannot have come out, as far as the last time at first.
                let stays = |to: usize| {
                    gearing.travel(&levers, &course.moved(&(sample..to))).total() < room
                };
                let mut near = sample;
                let mut far = (sample + stride).min(run.end);
                while far < run.end && stays(far) {
                    near = far;
                    far = (sample + 2 * (far - sample)).min(run.end);
                }
                while near + 1 < far {
                    let middle = near.midpoint(far);
                    if stays(middle) { near = middle } else { far = middle }
                }
                stride = near + 1 - sample;
                sample = near + 1;
            }
        }
    }
}
