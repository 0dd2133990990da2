//! Axes, tilt and play against their limits.

use jointplay_core::gpr::Forward;
use jointplay_core::virtualization::{Kernel, Offset, Planar, Polar, Radial};

use super::found::{Found, Hit, When};
use super::report::{InstructionRow, Kind, Share, Unit};
use crate::cell::Cell;
use crate::motion::{Sample, limits_of};
use crate::robot::{Dynamics, MotionKind};

/// Relative slack of limits, so that a motion planned to lie on one is not beyond it by round-off.
const SLACK: f64 = 1e-6;
/// The same for positions [m and rad].
const POSITION_SLACK: f64 = 1e-9;

/// What all axes may do in the present step.
pub(super) struct Use {
    step: Option<usize>,
    limits: Vec<Dynamics>,
}

/// Keeps the largest share.
pub(super) fn raise(most: &mut Option<Share>, of: usize, share: f64, time: f64) {
    if most.is_none_or(|most| share > most.share) {
        *most = Some(Share { of, share, time });
    }
}

impl Use {
    pub(super) fn new(cell: &Cell) -> Self {
        let limits = cell.robot.axes.iter().map(|axis| axis.empty).collect();
        Self { step: None, limits }
    }

    /// Every axis at a sample.
    pub(super) fn axes(
        &mut self,
        cell: &Cell,
        sample: &Sample,
        when: When<'_>,
        row: &mut InstructionRow,
        found: &mut Found,
    ) {
        if self.step != Some(when.index) {
            self.step = Some(when.index);
            for (axis, limits) in self.limits.iter_mut().enumerate() {
                *limits = limits_of(&cell.robot, axis, when.step);
            }
        }
        for (index, axis) in cell.robot.axes.iter().enumerate() {
            let unit = match axis.kind {
                MotionKind::Turn => Unit::Angle,
                MotionKind::Slide => Unit::Length,
            };
            let mut broken = |kind: Kind, severity: f64, value: f64, limit: f64| {
                let hit = Hit { about: (kind, index, 0), kind, severity, value, limit, unit };
                found.add(when, &hit, || (vec![axis.name.clone()], String::new()));
            };
            let position = sample.positions[index];
            if position > axis.max + POSITION_SLACK {
                broken(Kind::Position, position - axis.max, position, axis.max);
            } else if position < axis.min - POSITION_SLACK {
                broken(Kind::Position, axis.min - position, position, axis.min);
            }
            let limits = &self.limits[index];
            for (kind, value, limit, most) in [
                (Kind::Velocity, sample.velocities[index], limits.velocity, &mut row.velocity),
                (
                    Kind::Acceleration,
                    sample.accelerations[index],
                    limits.acceleration,
                    &mut row.acceleration,
                ),
                (Kind::Jerk, sample.jerks[index], limits.jerk, &mut row.jerk),
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

    /// The platform at a sample.
    pub(super) fn platform(
        &self,
        cell: &Cell,
        platform: &Forward,
        when: When<'_>,
        row: &mut InstructionRow,
        found: &mut Found,
    ) {
        let gpr = &cell.robot.gpr;
        let (tilt, most) = (platform.tilt().pitch, gpr.limits().tilt_max);
        row.tilt = row.tilt.max(tilt / most);
        let mut broken = |kind: Kind, value: f64, limit: f64, unit: Unit| {
            let hit = Hit { about: (kind, 0, 0), kind, severity: value, value, limit, unit };
            found.add(when, &hit, || (Vec::new(), String::new()));
        };
        if tilt > most + POSITION_SLACK {
            broken(Kind::Tilt, tilt, most, Unit::Angle);
        }
        let play = match cell.robot.model.virtualization {
            Kernel::Radial => gpr.displacement(platform, &Radial),
            Kernel::Polar => gpr.displacement(platform, &Polar),
            Kernel::Offset => gpr.displacement(platform, &Offset),
            Kernel::Planar => gpr.displacement(platform, &Planar),
        };
        let share = if cell.play_budget > 0.0 { play / cell.play_budget } else { f64::INFINITY };
        row.play = row.play.max(share);
        if play > cell.play_budget * (1.0 + SLACK) {
            broken(Kind::Play, play, cell.play_budget, Unit::Length);
        }
    }
}
