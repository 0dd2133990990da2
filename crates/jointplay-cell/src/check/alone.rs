//! A step by itself: axes, tilt, play and slip against their limits, and safe zones.

use std::ops::Range;

use jointplay_core::gpr::Forward;
use jointplay_core::spatial::Pose;
use jointplay_core::virtualization::{Kernel, Offset, Planar, Polar, Radial};

use super::course::{Around, Course};
use super::found::{Found, Hit, Stretch, When};
use super::report::{Kind, Share, Unit};
use super::scene::Scene;
use super::slip;
use super::solid::{self, Placed};
use crate::cell::Cell;
use crate::motion::{Sample, limits_of};
use crate::program::{Phase, Step};
use crate::robot::{Dynamics, EffectorId, MotionKind, RODS};
use crate::wafer::Droop;

/// Relative slack of limits, so that a motion planned to lie on one is not beyond it by round-off.
const SLACK: f64 = 1e-6;
/// The same for positions [m and rad].
const POSITION_SLACK: f64 = 1e-9;

/// What is found of a step by itself; times are since its start.
#[derive(Debug)]
pub(super) struct Alone {
    pub(super) velocity: Option<Share>,
    pub(super) acceleration: Option<Share>,
    pub(super) jerk: Option<Share>,
    pub(super) slip: Option<Share>,
    pub(super) tilt: f64,
    pub(super) play: f64,
    /// Whether each axis moves.
    pub(super) moved: Vec<bool>,
    pub(super) samples: usize,
    pub(super) found: Vec<Stretch>,
    /// Samples between which it is known where everything is.
    pub(super) runs: Vec<Range<usize>>,
    /// The room around the way of each thing that moves.
    pub(super) around: Vec<Option<Around>>,
}

/// Keeps the largest share.
pub(super) fn raise(most: &mut Option<Share>, of: usize, share: f64, time: f64) {
    if most.is_none_or(|most| share > most.share) {
        *most = Some(Share { of, share, time });
    }
}

/// The platform over its rods.
struct Standing {
    platform: Forward,
    tilt: f64,
    play: f64,
}

impl Alone {
    /// Looks at all samples of a step.
    pub(super) fn new(scene: &Scene<'_>, step: &Step, course: &mut Course) -> Self {
        let cell = scene.cell;
        let axes = cell.robot.axes.len();
        let mut alone = Self {
            velocity: None,
            acceleration: None,
            jerk: None,
            slip: None,
            tilt: 0.0,
            play: 0.0,
            moved: vec![false; axes],
            samples: course.samples().len(),
            found: Vec::new(),
            runs: Vec::new(),
            around: Vec::new(),
        };
        let limits: Vec<Dynamics> =
            (0..axes).map(|axis| limits_of(&cell.robot, axis, step)).collect();
        let effectors: Vec<EffectorId> = cell.robot.effectors().collect();
        let mut found = Found::default();
        let mut standing: Option<Standing> = None;
        for (number, sample) in course.samples().iter().enumerate() {
            let when = When { time: sample.time, sample: number };
            alone.axes(cell, sample, &limits, when, &mut found);
            let rods = &sample.positions[..RODS];
            if standing.as_ref().is_none_or(|standing| standing.platform.rods != *rods) {
                standing = match cell.robot.platform(&sample.positions) {
                    Ok(platform) => Some(Standing::new(cell, platform)),
                    Err(error) => {
                        found.add(when, nowhere(Kind::Platform), || error.to_string());
                        None
                    }
                };
            }
            let Some(standing) = &standing else { continue };
            alone.platform(cell, standing, when, &mut found);
            let mut is_known = true;
            for (place, &id) in effectors.iter().enumerate() {
                let loaded = scene.carried_by(id).is_some();
                let turns = step.phase == Phase::Turn && !scene.safe.is_empty();
                // Whether anything is known of its droop is asked of every arm that has a table of it.
                let droop = &cell.robot.arms[id.arm].droop;
                if !(loaded || turns || matches!(droop, Droop::Table { .. })) {
                    continue;
                }
                match scene.wafer(&standing.platform, id, &sample.positions) {
                    Ok(pose) => {
                        if loaded {
                            let now = (&standing.platform, &pose);
                            alone.slips(scene, sample, (place, id), now, when, &mut found);
                        }
                        if turns {
                            zones(scene, place, &pose, when, &mut found);
                        }
                    }
                    Err(why) => {
                        found.add(when, nowhere(Kind::Droop), || why);
                        is_known = false;
                    }
                }
            }
            if is_known {
                match alone.runs.last_mut() {
                    Some(run) if run.end == number => run.end += 1,
                    _ => alone.runs.push(number..number + 1),
                }
            }
        }
        alone.found = found.finished();
        alone
    }

    fn axes(
        &mut self,
        cell: &Cell,
        sample: &Sample,
        limits: &[Dynamics],
        when: When,
        found: &mut Found,
    ) {
        for (index, (axis, limits)) in cell.robot.axes.iter().zip(limits).enumerate() {
            let unit = match axis.kind {
                MotionKind::Turn => Unit::Angle,
                MotionKind::Slide => Unit::Length,
            };
            let mut broken = |kind: Kind, severity: f64, value: f64, limit: f64| {
                let hit = Hit { about: (kind, index, 0), kind, severity, value, limit, unit };
                found.add(when, hit, String::new);
            };
            self.moved[index] |= sample.velocities[index] != 0.0;
            let position = sample.positions[index];
            if position > axis.max + POSITION_SLACK {
                broken(Kind::Position, position - axis.max, position, axis.max);
            } else if position < axis.min - POSITION_SLACK {
                broken(Kind::Position, axis.min - position, position, axis.min);
            }
            for (kind, value, limit, most) in [
                (Kind::Velocity, sample.velocities[index], limits.velocity, &mut self.velocity),
                (
                    Kind::Acceleration,
                    sample.accelerations[index],
                    limits.acceleration,
                    &mut self.acceleration,
                ),
                (Kind::Jerk, sample.jerks[index], limits.jerk, &mut self.jerk),
            ] {
                let value = value.abs();
                if value > limit * (1.0 + SLACK) {
                    broken(kind, value, value, limit);
                }
                if value > 0.0 {
                    raise(most, index, value / limit, when.time);
                }
            }
        }
    }

    fn platform(&mut self, cell: &Cell, standing: &Standing, when: When, found: &mut Found) {
        let &Standing { tilt, play, .. } = standing;
        let most = cell.robot.gpr.limits().tilt_max;
        let mut broken = |kind: Kind, value: f64, limit: f64, unit: Unit| {
            let hit = Hit { about: (kind, 0, 0), kind, severity: value, value, limit, unit };
            found.add(when, hit, String::new);
        };
        self.tilt = self.tilt.max(tilt / most);
        if tilt > most + POSITION_SLACK {
            broken(Kind::Tilt, tilt, most, Unit::Angle);
        }
        let share = if cell.play_budget > 0.0 { play / cell.play_budget } else { f64::INFINITY };
        self.play = self.play.max(share);
        if play > cell.play_budget * (1.0 + SLACK) {
            broken(Kind::Play, play, cell.play_budget, Unit::Length);
        }
    }

    fn slips(
        &mut self,
        scene: &Scene<'_>,
        sample: &Sample,
        (place, id): (usize, EffectorId),
        (platform, now): (&Forward, &Pose),
        when: When,
        found: &mut Found,
    ) {
        // What the droop does not know beside the sample is reported at the next.
        let Ok(push) = slip::push(scene, sample, id, platform, now) else { return };
        if push.needed > push.held {
            let hit = Hit {
                about: (Kind::Slip, place, 0),
                kind: Kind::Slip,
                severity: push.needed - push.held,
                value: push.needed,
                limit: push.held,
                unit: Unit::Acceleration,
            };
            found.add(when, hit, String::new);
        }
        let share = if push.held > 0.0 { push.needed / push.held } else { f64::INFINITY };
        raise(&mut self.slip, place, share, when.time);
    }
}

impl Standing {
    fn new(cell: &Cell, platform: Forward) -> Self {
        let gpr = &cell.robot.gpr;
        let play = match cell.robot.model.virtualization {
            Kernel::Radial => gpr.displacement(&platform, &Radial),
            Kernel::Polar => gpr.displacement(&platform, &Polar),
            Kernel::Offset => gpr.displacement(&platform, &Offset),
            Kernel::Planar => gpr.displacement(&platform, &Planar),
        };
        Self { tilt: platform.tilt().pitch, platform, play }
    }
}

fn nowhere(kind: Kind) -> Hit {
    Hit { about: (kind, 0, 0), kind, severity: 0.0, value: 0.0, limit: 0.0, unit: Unit::None }
}

/// Wafers' centres stay in the safe zones while the robot turns.
fn zones(scene: &Scene<'_>, place: usize, pose: &Pose, when: When, found: &mut Found) {
    let kind = Kind::SafeZone;
    for (zone, solid) in &scene.safe {
        let placed = Placed { solid, base_from_carrier: &Pose::identity() };
        let off = solid::outside(placed, &pose.translation.vector);
        if off > 0.0 {
            let (about, unit) = ((kind, place, *zone), Unit::Length);
            let hit = Hit { about, kind, severity: off, value: off, limit: 0.0, unit };
            found.add(when, hit, String::new);
        }
    }
}
