//! One step, sample by sample, a window at a time.

use std::ops::Range;

use jointplay_core::bulk::Column;
use jointplay_core::spatial::Pose;

use super::axis_states::Axes;
use super::link_poses::{Places, Unplaced};
use super::motion_bound::{Gearing, Moved, Odometer};
use super::motion_bound_coefficients::Levers;
use super::sample_times::Samples;
use super::scene::Scene;
use super::swept_aabb::{Around, with};
use super::unknown_pose::Lost;
use crate::geometry::Span;
use crate::robot::{Positions, RODS};
use crate::trajectory::{AxisSampler, AxisState, Trajectory};
use crate::violation::{Kind, When};

/// Samples from one place that a box around a way is made of to the next.
const STRIDE: usize = 16;

/// Boxes around the way of one thing in a step, about, at most: those of long steps are made of more samples each.
const MOST_BOXES: usize = 4096;

/// The samples of a window of a step, and how far what moves has come by each.
///
/// It is used for one window after the other, so that its room is taken once.
#[derive(Default)]
pub(crate) struct Course {
    /// Which step and window, while it is looked at.
    window: Option<(usize, usize)>,
    /// Number of the window's first sample in the step.
    first: usize,
    /// Samples from one box around a way to the next.
    stride: usize,
    /// Of the samples, since its start [s].
    times: Vec<f64>,
    /// Where all axes start.
    from: Vec<f64>,
    track: AxisSampler,
    odometer: Odometer,
    /// Poses of all that moves by sample, or why they are unknown, as far as that was asked for.
    places: Vec<Option<Result<Places, Unplaced>>>,
    /// Room of places that are no longer needed.
    rooms: Vec<Vec<Pose>>,
}

impl Course {
    /// Takes up a window of a step.
    pub(crate) fn take(
        &mut self,
        motion: &Trajectory,
        (step, window): (usize, usize),
        samples: &Samples,
        gearing: &Gearing,
    ) {
        self.window = Some((step, window));
        self.from.clone_from(&motion.steps[step].from);
        let range = samples.window(window);
        self.first = range.start;
        self.stride = STRIDE.max(samples.count / MOST_BOXES);
        self.times.clear();
        self.times.extend(range.map(|sample| samples.time(sample)));
        self.track.sample_step(motion, step, &self.times);
        self.odometer.take(gearing, (&self.times, &self.from), &self.track);
        let left = self.places.drain(..).flatten().filter_map(Result::ok);
        self.rooms.extend(left.map(Places::into_room));
        self.places.resize_with(self.times.len(), || None);
    }

    /// Whether it has taken up a window of a step.
    pub(crate) fn is_of(&self, step: usize, window: usize) -> bool {
        self.window == Some((step, window))
    }

    /// Done with its step, for the next who needs the room.
    pub(crate) fn leave(&mut self) {
        self.window = None;
    }

    /// Number of the window's first sample in the step.
    pub(crate) fn first(&self) -> usize {
        self.first
    }

    /// Of the samples, since the start of the step [s].
    pub(crate) fn times(&self) -> &[f64] {
        &self.times
    }

    /// What the axes do that do anything.
    pub(crate) fn track(&self) -> &AxisSampler {
        &self.track
    }

    /// Where all axes are at the start.
    pub(crate) fn from(&self) -> &[f64] {
        &self.from
    }

    /// Some axes, by their indices; as far as there are fewer, the rest stand at zero.
    pub(crate) fn axes<const N: usize>(&self, indices: &[usize]) -> Axes<'_, N> {
        let mut axes = Axes { moving: [None; N], standing: [0.0; N] };
        for (place, &axis) in indices.iter().enumerate() {
            axes.moving[place] = self.states(axis);
            axes.standing[place] = self.from[axis];
        }
        axes
    }

    /// Lengths of the rods by sample [m]; one alone where none of them moves.
    pub(crate) fn rods(&self) -> [Column<'_>; RODS] {
        let states: [_; RODS] = std::array::from_fn(|rod| self.states(rod));
        let move_at_all = states.iter().any(Option::is_some);
        let len = if move_at_all { self.times.len() } else { 1 };
        std::array::from_fn(|rod| match states[rod] {
            Some(states) => Column::strided(states.as_flattened(), states[0].len(), len)
                .expect("there is a state for each sample"),
            None => Column::constant(&self.from[rod], len),
        })
    }

    /// What an axis does by sample, if it does anything.
    fn states(&self, axis: usize) -> Option<&[AxisState]> {
        let place = self.track.moving().binary_search(&axis).ok()?;
        Some(&self.track.states()[place])
    }

    /// Where all axes are at a sample.
    pub(crate) fn positions(&self, sample: usize) -> Positions {
        let mut positions = Positions::new(&self.from);
        for (&axis, states) in self.track.moving().iter().zip(self.track.states()) {
            positions[axis] = states[sample][0];
        }
        positions
    }

    /// What all axes did between two samples, at most.
    pub(crate) fn moved(&self, between: &Range<usize>) -> Moved {
        self.odometer.moved(&self.track, between)
    }

    /// Finds the poses of all that moves at a sample.
    ///
    /// # Errors
    /// [`Lost`], where they are unknown.
    pub(crate) fn place(&mut self, scene: &Scene<'_>, sample: usize) -> Result<(), Lost> {
        if self.places[sample].is_none() {
            let room = self.rooms.pop().unwrap_or_default();
            self.places[sample] = Some(scene.places(&self.positions(sample), room));
        }
        self.placed(sample).map(|_| ())
    }

    /// Poses of all that moves at a sample that was placed.
    ///
    /// # Errors
    /// [`Lost`], where they are unknown.
    pub(crate) fn placed(&self, sample: usize) -> Result<&Places, Lost> {
        let lost = |why: Unplaced| Lost { when: When { time: self.times[sample], sample }, why };
        match &self.places[sample] {
            Some(Ok(places)) => Ok(places),
            Some(Err(why)) => Err(lost(why.clone())),
            None => {
                let why = "this sample was not placed before it was asked for".to_owned();
                Err(lost(Unplaced { kind: Kind::Platform, why }))
            }
        }
    }

    /// The room that an item takes during runs of samples; `None` where there are none.
    ///
    /// # Errors
    /// [`Lost`], where a pose is unknown.
    pub(crate) fn around(
        &mut self,
        scene: &Scene<'_>,
        item: usize,
        (gearing, levers): (&Gearing, &Levers),
        runs: &[Range<usize>],
    ) -> Result<Option<Around>, Lost> {
        let count = runs.iter().map(|run| run.len().div_ceil(self.stride)).sum();
        let mut parts: Vec<[Span; 3]> = Vec::with_capacity(count);
        for run in runs {
            let ends = run.clone().step_by(self.stride).skip(1).chain([run.end - 1]);
            let mut from = run.start;
            for to in ends {
                let mut at = |sample: usize| -> Result<[Span; 3], Lost> {
                    self.place(scene, sample)?;
                    Ok(scene.placed(item, self.placed(sample)?).around())
                };
                let (first, second) = (at(from)?, at(to)?);
                // Between two places it is nearer to one of them than half of the way.
                let slack = 0.5 * gearing.travel(levers, &self.moved(&(from..to))).total();
                parts.push(std::array::from_fn(|k| first[k].with(second[k]).wider(slack)));
                from = to;
            }
        }
        Ok(parts.iter().copied().reduce(with).map(|whole| Around { whole, parts }))
    }
}
