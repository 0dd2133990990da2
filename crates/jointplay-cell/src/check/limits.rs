//! Axes, tilt, play and slip against their limits.

use jointplay_core::bulk::{Quantity, Status};

use super::report::Share;
use super::segment_findings::{Alone, raise};
use super::slip::Carried;
use crate::CellError;
use crate::collision::{Course, Gearing, Lost, Scene, Unplaced};
use crate::program::{Phase, Step};
use crate::robot::{Axis, AxisKind, EffectorId, HybridRobot, KinematicLimits, Positions};
use crate::trajectory::{AxisState, axis_limits};
use crate::violation::{Found, Hit, Kind, Unit, When};
use crate::wafer::Droop;
use crate::workcell::Cell;

/// Relative slack of limits, so that a motion planned to lie on one is not beyond it by round-off.
const SLACK: f64 = 1e-6;
/// The same for positions [m and rad].
const POSITION_SLACK: f64 = 1e-9;

/// How the platform stands over its rods.
#[derive(Clone, Copy)]
struct Standing {
    /// [rad]
    tilt: f64,
    /// How far its virtual joints are from nominal [m].
    play: f64,
}

/// The same by sample, or once for all where no rod moves.
struct Standings<'a> {
    robot: &'a HybridRobot,
    status: Vec<Status>,
    tilts: Vec<f64>,
    plays: Vec<f64>,
}

impl Alone {
    /// Looks at all samples of a window.
    pub(super) fn new(
        scene: &Scene<'_>,
        step: &Step,
        (course, gearing): (&Course, &Gearing),
    ) -> Self {
        let robot = &scene.cell.robot;
        let mut alone = Self {
            velocity: None,
            acceleration: None,
            jerk: None,
            slip: None,
            tilt: 0.0,
            play: 0.0,
            moved: vec![false; robot.axes.len()],
            samples: course.times().len(),
            found: Vec::new(),
            runs: Vec::new(),
            around: Vec::new(),
        };
        let mut found = Found::default();
        let mut moving = course.track().moving().iter().zip(course.track().states()).peekable();
        for (axis, described) in robot.axes.iter().enumerate() {
            let limits = axis_limits(robot, axis, step);
            if let Some((_, states)) = moving.next_if(|(moves, _)| **moves == axis) {
                let about = (axis, described, &limits);
                alone.axis(about, course.times(), states.iter().copied(), &mut found);
            } else if beyond(described, course.from()[axis]).is_some() {
                let still = std::iter::repeat([course.from()[axis], 0.0, 0.0, 0.0]);
                alone.axis((axis, described, &limits), course.times(), still, &mut found);
            }
        }
        alone.platform(scene, course, &mut found);
        let turns = step.phase == Phase::Turn && !scene.safe.is_empty();
        for (place, id) in robot.effectors().enumerate() {
            if scene.carried_by(id).is_some() {
                alone.slips(scene, (course, gearing), (place, id), &mut found);
            }
            if turns {
                alone.zones(scene, (course, gearing), (place, id), &mut found);
            }
        }
        alone.found = found.finished();
        alone
    }

    /// Looks at an axis at all samples.
    fn axis(
        &mut self,
        (index, axis, limits): (usize, &Axis, &KinematicLimits),
        times: &[f64],
        states: impl Iterator<Item = AxisState> + Clone,
        found: &mut Found,
    ) {
        // Least and largest position, and the largest of all else, with where that is first.
        let (mut least, mut most) = (f64::INFINITY, f64::NEG_INFINITY);
        let mut peaks = [(0.0_f64, 0); 3];
        for (sample, (state, _)) in states.clone().zip(times).enumerate() {
            (least, most) = (least.min(state[0]), most.max(state[0]));
            for (peak, value) in peaks.iter_mut().zip(&state[1..]) {
                if value.abs() > peak.0 {
                    *peak = (value.abs(), sample);
                }
            }
        }
        self.moved[index] = peaks[0].0 > 0.0;
        let limits = [limits.velocity, limits.acceleration, limits.jerk];
        let shares = [&mut self.velocity, &mut self.acceleration, &mut self.jerk];
        for ((share, (value, sample)), limit) in shares.into_iter().zip(peaks).zip(limits) {
            if value > 0.0 {
                raise(share, Share { of: index, share: value / limit, time: times[sample] });
            }
        }
        let too_much = |value: f64, limit: f64| value > limit * (1.0 + SLACK);
        let is_sound = beyond(axis, least).or(beyond(axis, most)).is_none()
            && !peaks.iter().zip(limits).any(|(peak, limit)| too_much(peak.0, limit));
        if is_sound {
            return;
        }
        let unit = match axis.kind {
            AxisKind::Rotary => Unit::Angle,
            AxisKind::Linear => Unit::Length,
        };
        for (sample, (state, &time)) in states.zip(times).enumerate() {
            let mut broken = |kind: Kind, severity: f64, value: f64, limit: f64| {
                let hit = Hit { about: (kind, index, 0), kind, severity, value, limit, unit };
                found.add(When { time, sample }, hit, String::new);
            };
            let position = state[0];
            if let Some(limit) = beyond(axis, position) {
                broken(Kind::Position, (position - limit).abs(), position, limit);
            }
            let kinds = [Kind::Velocity, Kind::Acceleration, Kind::Jerk];
            for ((kind, limit), value) in kinds.into_iter().zip(limits).zip(&state[1..]) {
                if too_much(value.abs(), limit) {
                    broken(kind, value.abs(), value.abs(), limit);
                }
            }
        }
    }

    /// Looks at the platform at all samples, and finds between which it is known where everything is.
    fn platform(&mut self, scene: &Scene<'_>, course: &Course, found: &mut Found) {
        let cell = scene.cell;
        // Whether anything is known of its droop is asked of every arm that has a table of it.
        let has_table =
            |id: &EffectorId| matches!(cell.robot.arms[id.arm].droop, Droop::Table { .. });
        let tables: Vec<EffectorId> = cell.robot.effectors().filter(has_table).collect();
        let standings = Standings::new(cell, course);
        for (sample, &time) in course.times().iter().enumerate() {
            let when = When { time, sample };
            match standings.at(sample, || course.positions(sample)) {
                Ok(standing) => self.leans(cell, standing, when, found),
                Err(error) => {
                    Lost { when, why: Unplaced::from(error) }.report(found);
                    continue;
                }
            }
            let mut is_known = true;
            for &id in &tables {
                if let Err(why) = scene.wafer(id, &course.positions(sample)) {
                    Lost { when, why }.report(found);
                    is_known = false;
                }
            }
            if is_known {
                match self.runs.last_mut() {
                    Some(run) if run.end == sample => run.end += 1,
                    _ => self.runs.push(sample..sample + 1),
                }
            }
        }
    }

    fn leans(&mut self, cell: &Cell, standing: Standing, when: When, found: &mut Found) {
        let Standing { tilt, play } = standing;
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

    /// Looks at a carried wafer.
    fn slips(
        &mut self,
        scene: &Scene<'_>,
        (course, gearing): (&Course, &Gearing),
        (place, id): (usize, EffectorId),
        found: &mut Found,
    ) {
        let tilt = self.tilt * scene.cell.robot.gpr.limits().tilt_max;
        let mut carried = Carried::new(scene, course, gearing, id, tilt);
        self.runs.iter().for_each(|run| carried.run(run));
        let mut seen = carried.seen;
        seen.sort_unstable_by_key(|(sample, _)| *sample);
        for (sample, slip) in seen {
            let time = course.times()[sample];
            if slip.required > slip.available {
                let hit = Hit {
                    about: (Kind::Slip, place, 0),
                    kind: Kind::Slip,
                    severity: slip.required - slip.available,
                    value: slip.required,
                    limit: slip.available,
                    unit: Unit::Acceleration,
                };
                found.add(When { time, sample }, hit, String::new);
            }
            raise(&mut self.slip, Share { of: place, share: slip.utilization(), time });
        }
    }
}

impl<'a> Standings<'a> {
    fn new(cell: &'a Cell, course: &Course) -> Self {
        let (robot, rods) = (&cell.robot, course.rods());
        let count = rods[0].len();
        let (mut tilts, mut plays) = (vec![0.0; count], vec![0.0; count]);
        let mut status = vec![Status::Solved; count];
        let mut wanted =
            [(Quantity::Pitch, &mut tilts[..]), (Quantity::Displacement, &mut plays[..])];
        if robot.model.forward_many(&robot.gpr, rods, &mut status, &mut wanted).is_err() {
            // What concerns all of them is told of each.
            status.fill(Status::NotFinite);
        }
        Self { robot, status, tilts, plays }
    }

    /// At a sample, or why it is nowhere.
    fn at(
        &self,
        sample: usize,
        positions: impl FnOnce() -> Positions,
    ) -> Result<Standing, CellError> {
        let place = sample.min(self.status.len() - 1);
        if self.status[place] == Status::Solved {
            return Ok(Standing { tilt: self.tilts[place], play: self.plays[place] });
        }
        let platform = self.robot.platform(&positions())?;
        let play = self.robot.model.displacement(&self.robot.gpr, &platform);
        Ok(Standing { tilt: platform.tilt().pitch, play })
    }
}

/// The limit that a position is beyond.
fn beyond(axis: &Axis, position: f64) -> Option<f64> {
    if position > axis.max + POSITION_SLACK {
        Some(axis.max)
    } else if position < axis.min - POSITION_SLACK {
        Some(axis.min)
    } else {
        None
    }
}
