//! How far what moves can have gone between two samples, at most.

use std::ops::Range;

use nalgebra::Vector2;

use super::in_plane_motion::{Drift, Rates};
use super::motion_bound_coefficients::Levers;
use crate::robot::{HybridRobot, MAX_AXES, RODS};
use crate::trajectory::{AxisSampler, AxisState};

/// How far points of an item went, at most.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Travel {
    /// By the rods, the deflection as seen from the platform included [m].
    pub(crate) plane: f64,
    /// By the arms, parallel to the platform [m].
    pub(crate) arm: f64,
    /// By drooping otherwise than before, as the reach changed [m].
    pub(crate) droop: f64,
    /// Of that, in other directions than up and down [m].
    pub(crate) aside: f64,
    /// By the deflection as seen from the platform, which rotates [m].
    pub(crate) hang: f64,
}

impl Travel {
    pub(crate) fn total(self) -> f64 {
        self.plane + self.arm + self.droop
    }
}

/// What all axes did between two samples, at most.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Moved {
    /// Path of each axis [m or rad].
    axes: [f64; MAX_AXES],
    /// ∫|q̈| dt of each [m/s or rad/s].
    hurries: [f64; MAX_AXES],
    /// ∫q̇² dt of each [m²/s or rad²/s].
    squares: [f64; MAX_AXES],
    /// Path of the platform's origin [m].
    origin: f64,
    /// Angle that its normal turned by [rad].
    pub(crate) lean: f64,
    /// Angle that it turned by about its normal beyond the shortest rotation [rad].
    twist: f64,
}

/// How far everything has come by each sample of a step, at most.
#[derive(Default)]
pub(crate) struct Odometer {
    /// Of each axis that moves, in the order of the track: path, ∫|q̈| dt and ∫q̇² dt; there may be more than there are.
    axes: Vec<Vec<[f64; 3]>>,
    /// Of the platform, while rods move: path of its origin, angle that its normal turned by, and angle about that.
    platform: Vec<[f64; 3]>,
}

impl Odometer {
    /// Takes up a step.
    ///
    /// # Arguments
    /// * `from` – positions of all axes at its start
    pub(crate) fn take(
        &mut self,
        gearing: &Gearing,
        (times, from): (&[f64], &[f64]),
        track: &AxisSampler,
    ) {
        let (moving, states) = (track.moving(), track.states());
        if self.axes.len() < moving.len() {
            self.axes.resize_with(moving.len(), Vec::new);
        }
        self.platform.clear();
        if moving.first().is_some_and(|&axis| axis < RODS) {
            self.platform.resize(times.len(), [0.0; 3]);
        }
        for (place, (&axis, states)) in moving.iter().zip(states).enumerate() {
            let by = &mut self.axes[place];
            by.clear();
            let mut all = [0.0; 3];
            by.push(all);
            for (k, pair) in states.windows(2).enumerate() {
                let dt = times[k + 1] - times[k];
                let [speed, hurry] = gearing.most(dt, axis, [&pair[0], &pair[1]]);
                let path = dt * speed;
                for (sum, more) in all.iter_mut().zip([path, dt * hurry, path * speed]) {
                    *sum += more;
                }
                by.push(all);
                if axis < RODS {
                    let [height, ..] = &mut self.platform[k + 1];
                    *height = height.max(path);
                }
            }
        }
        if !self.platform.is_empty() {
            self.lean(gearing, (times, from), track);
        }
    }

    /// Sums up what the rods do to the platform: its height is theirs, weighted, and its normal turns as they go unevenly.
    fn lean(&mut self, gearing: &Gearing, (times, from): (&[f64], &[f64]), track: &AxisSampler) {
        let rods: [Option<&Vec<AxisState>>; RODS] = std::array::from_fn(|rod| {
            let place = track.moving().iter().position(|&axis| axis == rod)?;
            Some(&track.states()[place])
        });
        let of = |sample: usize| -> [AxisState; RODS] {
            let still = |rod: usize| [from[rod], 0.0, 0.0, 0.0];
            std::array::from_fn(|rod| rods[rod].map_or(still(rod), |states| states[sample]))
        };
        let mut first = of(0);
        let mut all = [0.0; 3];
        for k in 1..times.len() {
            let last = of(k);
            let lean = gearing.lean(times[k] - times[k - 1], [&first, &last]);
            let [before, after] = [&first, &last].map(|states| gearing.slope(states));
            let Rates { shift, twist } = gearing.drift.rates(0.5 * (before + after + lean));
            all[0] += gearing.weights * self.platform[k][0] + lean * shift;
            all[1] += lean;
            all[2] += lean * twist;
            self.platform[k] = all;
            first = last;
        }
    }

    /// What all axes did between two samples, at most.
    pub(crate) fn moved(&self, track: &AxisSampler, between: &Range<usize>) -> Moved {
        let mut moved = Moved::default();
        let (from, to) = (between.start, between.end);
        for (&axis, by) in track.moving().iter().zip(&self.axes) {
            let [path, hurry, square] = std::array::from_fn(|k| by[to][k] - by[from][k]);
            (moved.axes[axis], moved.hurries[axis], moved.squares[axis]) = (path, hurry, square);
        }
        if let (Some(last), Some(first)) = (self.platform.get(to), self.platform.get(from)) {
            [moved.origin, moved.lean, moved.twist] = std::array::from_fn(|k| last[k] - first[k]);
        }
        moved
    }
}

/// The base triangle, as far as it gears rods to the platform.
pub(crate) struct Gearing {
    /// Sum of the absolute weights by which the rods lift the platform's origin.
    weights: f64,
    /// Heights of the base triangle over each side [m], at the corner of each rod.
    heights: [f64; RODS],
    /// Slope of the base plane's height by each rod [1/m].
    slopes: [Vector2<f64>; RODS],
    drift: Drift,
    /// Largest jerk that the limits of each axis allow: samples do not show what it is between them [m/s³ or rad/s³].
    jerks: [f64; MAX_AXES],
}

impl Gearing {
    pub(crate) fn new(robot: &HybridRobot) -> Self {
        let b = robot.gpr.base_points();
        let area = |p: [f64; 2], q: [f64; 2], r: [f64; 2]| {
            (q[0] - p[0]) * (r[1] - p[1]) - (q[1] - p[1]) * (r[0] - p[0])
        };
        let corner = |k: usize| [b[k].x, b[k].y];
        let whole = area(corner(0), corner(1), corner(2));
        let origin = [0.0, 0.0];
        let weight = |k: usize| area(corner((k + 1) % 3), corner((k + 2) % 3), origin) / whole;
        let side = |k: usize| (b[(k + 1) % 3] - b[(k + 2) % 3]).norm();
        let mut jerks = [0.0; MAX_AXES];
        for (jerk, axis) in jerks.iter_mut().zip(&robot.axes) {
            *jerk = axis.empty.jerk.max(axis.loaded.jerk);
        }
        Self {
            jerks,
            weights: (0..RODS).map(|k| weight(k).abs()).sum(),
            heights: [0, 1, 2].map(|k| whole.abs() / side(k)),
            slopes: [0, 1, 2].map(|k| {
                let side = b[(k + 2) % 3] - b[(k + 1) % 3];
                Vector2::new(-side.y, side.x) / whole
            }),
            drift: Drift::new(robot),
        }
    }

    /// Distance of the platform's origin from that of the base, at most [m].
    pub(crate) fn highest(&self, robot: &HybridRobot) -> f64 {
        let rods = robot.axes[..RODS].iter().map(|rod| rod.min.abs().max(rod.max.abs()));
        // Beside the base axis it is by far less than a ball is.
        let radius = robot.gpr.base_points().map(|point| point.norm()).into_iter();
        self.weights * rods.fold(0.0, f64::max) + radius.fold(0.0, f64::max)
    }

    /// Speed [m/s or rad/s] and acceleration [m/s² or rad/s²] of an axis between two samples, at most.
    fn most(&self, dt: f64, axis: usize, [from, to]: [&AxisState; 2]) -> [f64; 2] {
        let jerk = self.jerks[axis].max(from[3].abs()).max(to[3].abs());
        let hurry = most(dt, [from[2], to[2]], jerk);
        let speed = most(dt, [from[1], to[1]], hurry);
        [speed, hurry]
    }

    /// Slope of the platform's plane: the tangent of its tilt.
    fn slope(&self, rods: &[AxisState; RODS]) -> f64 {
        let by_rod = self.slopes.iter().zip(rods).map(|(slope, state)| slope * state[0]);
        by_rod.sum::<Vector2<f64>>().norm()
    }

    /// Path of the slope of the platform's plane between two samples, and so of its normal, at most [rad].
    fn lean(&self, dt: f64, [from, to]: [&[AxisState; RODS]; 2]) -> f64 {
        let off = |states: &[AxisState; RODS], order: usize| -> [f64; RODS] {
            let mean = (states[0][order] + states[1][order] + states[2][order]) / 3.0;
            std::array::from_fn(|rod| states[rod][order] - mean)
        };
        let velocities = [from, to].map(|states| off(states, 1));
        let accelerations = [from, to].map(|states| off(states, 2));
        let jerk_of = |rod: usize| self.jerks[rod].max(from[rod][3].abs()).max(to[rod][3].abs());
        let jerk = 2.0 * (0..RODS).map(jerk_of).fold(0.0, f64::max);
        let turned = |rod: usize| {
            let hurry = most(dt, accelerations.map(|of| of[rod]), jerk);
            let speed = most(dt, velocities.map(|of| of[rod]), hurry);
            dt * speed / self.heights[rod]
        };
        (0..RODS).map(turned).sum()
    }

    /// How much the platform's normal turns as the rods go so unevenly, or how fast where these are rates, at most [rad, or that by time].
    pub(crate) fn leaning(&self, rods: &[f64; RODS]) -> f64 {
        let mean = (rods[0] + rods[1] + rods[2]) / 3.0;
        (0..RODS).map(|rod| (rods[rod] - mean).abs() / self.heights[rod]).sum::<f64>()
    }

    /// How much the platform's origin goes up or down as the rods go so, at most [m, or that by time].
    pub(crate) fn lift(&self, rods: &[f64; RODS]) -> f64 {
        self.weights * rods.iter().fold(0.0, |most: f64, rod| most.max(rod.abs()))
    }

    /// How far points of an item went, at most; see "Trajectory bounds" in `docs/explanation/collision-guarantee.md`.
    pub(crate) fn travel(&self, levers: &Levers, moved: &Moved) -> Travel {
        let turned = moved.lean + moved.twist;
        let by = |levers: &[f64; MAX_AXES]| -> f64 {
            levers.iter().zip(&moved.axes).map(|(lever, path)| lever * path).sum()
        };
        let hang = turned * levers.hang;
        let plane = moved.origin + turned * levers.far + hang;
        let [arm, droop, aside] = [&levers.arms, &levers.droops, &levers.asides].map(by);
        Travel { plane, arm, droop, aside, hang }
    }

    /// How fast the arms' part of the way of a point changed, in all [m/s].
    ///
    /// ```text
    ///    p̈  =  Σ_g |v_g| (φ̈_g e_⊥ - φ̇_g² e)         g: links from the first that moves on, φ_g: angle of each
    /// ```
    pub(crate) fn bend(&self, levers: &Levers, moved: &Moved) -> f64 {
        let each = |levers: &[f64; MAX_AXES], moved: &[f64; MAX_AXES]| -> f64 {
            levers.iter().zip(moved).map(|(lever, moved)| lever * moved).sum()
        };
        each(&levers.arms, &moved.hurries) + each(&levers.turns, &moved.squares)
    }
}

/// What lies between two values, at most, of something that changes no faster than so.
///
/// Speeds bounded so bound the way in any part of the interval by that part of it: in half of the time no more than half.
fn most(dt: f64, [first, last]: [f64; 2], rate: f64) -> f64 {
    0.5 * (first.abs() + last.abs() + dt * rate)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn half_of_the_way_is_enough_for_either_half_of_the_time() {
        // By pieces of one jerk from whatever speed and acceleration, turning back or not.
        let mut state = 3_u64;
        let mut random = move || {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
            (state >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
        };
        for round in 0..2000 {
            let (dt, jerk) = (0.01, 100.0 * random());
            // Speeding up from rest, the second half is three times the first.
            let (v, a) = if round == 0 { (0.0, 5.0) } else { (0.2 * random(), 10.0 * random()) };
            let speed = |t: f64| v + a * t + 0.5 * jerk * t * t;
            let hurry = most(dt, [a, a + jerk * dt], jerk.abs());
            let bound = dt * most(dt, [v, speed(dt)], hurry);
            let way = |from: f64| {
                let steps = 200;
                let step = 0.5 * dt / f64::from(steps);
                (0..steps)
                    .map(|k| speed(from + (f64::from(k) + 0.5) * step).abs() * step)
                    .sum::<f64>()
            };
            for from in [0.0, 0.5 * dt] {
                assert!(way(from) <= 0.5 * bound * (1.0 + 1e-4), "{round}: {} {bound}", way(from));
            }
        }
    }
}
