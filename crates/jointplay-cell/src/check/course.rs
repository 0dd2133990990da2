//! One step, sample by sample.

use std::ops::Range;

use jointplay_core::spatial::Pose;
use nalgebra::Vector3;

use super::scene::{Places, Scene};
use super::solid::{Placed, Span};
use super::travel::{Gearing, Levers, Moved};
use crate::motion::{Motion, Sample};

/// Samples from one place that a box around a way is made of to the next.
const STRIDE: usize = 32;

/// The samples of a step, and how far what moves has come by each.
///
/// It is used for one step after the other, so that its room is taken once.
#[derive(Default)]
pub(super) struct Course {
    /// Which, while it is looked at.
    step: Option<usize>,
    samples: Vec<Sample>,
    /// Axes that do anything in it, as indices.
    moving: Vec<usize>,
    count: usize,
    /// What all axes did since the start, at most, by sample.
    moved: Vec<Moved>,
    /// Where everything is, as far as that was asked for; `None` within where it is not known.
    places: Vec<Option<Option<Places>>>,
    /// Room of places that are no longer needed.
    rooms: Vec<Vec<Pose>>,
}

impl Course {
    /// Takes up a step: its start, `rate` times a second, and its end.
    pub(super) fn take(&mut self, motion: &Motion, step: usize, rate: f64, gearing: &Gearing) {
        self.step = Some(step);
        self.moving = motion.moving(step);
        let length = motion.length(step);
        // A last even time within a thousandth of the end is the end; nothing changes while all stand still.
        let whole = if motion.stands(step) {
            usize::from(length > 0.0)
        } else {
            (length * rate - 1e-3).ceil().max(0.0) as usize
        };
        self.count = whole + 1;
        if self.samples.len() < self.count {
            self.samples.resize_with(self.count, Sample::default);
        }
        for (k, sample) in self.samples[..self.count].iter_mut().enumerate() {
            let since = if k < whole { k as f64 / rate } else { length };
            motion.fill_since(step, since, sample);
        }
        let left = self.places.drain(..).flatten().flatten();
        self.rooms.extend(left.map(Places::into_room));
        self.places.resize_with(self.count, || None);
        let mut moved = Moved::default();
        self.moved.clear();
        self.moved.push(moved);
        for pair in self.samples[..self.count].windows(2) {
            gearing.add(&mut moved, [&pair[0], &pair[1]], &self.moving);
            self.moved.push(moved);
        }
    }

    /// Whether it has taken up a step.
    pub(super) fn is_of(&self, step: usize) -> bool {
        self.step == Some(step)
    }

    /// Done with its step, for the next who needs the room.
    pub(super) fn leave(&mut self) {
        self.step = None;
    }

    pub(super) fn samples(&self) -> &[Sample] {
        &self.samples[..self.count]
    }

    pub(super) fn moving(&self) -> &[usize] {
        &self.moving
    }

    /// What all axes did between two samples, at most.
    pub(super) fn moved(&self, between: &Range<usize>) -> Moved {
        self.moved[between.end].beyond(&self.moved[between.start])
    }

    /// Finds where everything is at a sample.
    pub(super) fn place(&mut self, scene: &Scene<'_>, sample: usize) {
        let (positions, rooms) = (&self.samples[sample].positions, &mut self.rooms);
        self.places[sample]
            .get_or_insert_with(|| scene.places(positions, rooms.pop().unwrap_or_default()).ok());
    }

    /// Where everything is at a sample that was placed; `None` where that is not known.
    pub(super) fn placed(&self, sample: usize) -> Option<&Places> {
        self.places[sample].as_ref()?.as_ref()
    }

    /// The room that an item takes during runs of samples; `None` where it comes to no place.
    pub(super) fn around(
        &mut self,
        scene: &Scene<'_>,
        item: usize,
        (gearing, levers): (&Gearing, &Levers),
        runs: &[Range<usize>],
    ) -> Option<Around> {
        let mut parts: Vec<[Span; 3]> = Vec::new();
        for run in runs {
            let ends = run.clone().step_by(STRIDE).skip(1).chain([run.end - 1]);
            let mut from = run.start;
            for to in ends {
                let [first, second] = [from, to].map(|sample| {
                    self.place(scene, sample);
                    Some(bounds(scene.placed(item, self.placed(sample)?)))
                });
                let (first, second) = (first?, second?);
                // Between two places it is nearer to one of them than half of the way.
                let slack = 0.5 * gearing.travel(levers, &self.moved(&(from..to))).total();
                parts.push(std::array::from_fn(|k| first[k].with(second[k]).wider(slack)));
                from = to;
            }
        }
        let with =
            |one: [Span; 3], other: [Span; 3]| std::array::from_fn(|k| one[k].with(other[k]));
        Some(Around { whole: parts.iter().copied().reduce(with)?, parts })
    }
}

/// The room around a way: boxes one after the other, axes those of the base.
#[derive(Debug)]
pub(super) struct Around {
    whole: [Span; 3],
    parts: Vec<[Span; 3]>,
}

impl Around {
    /// Whether it may come as near to a box as that.
    pub(super) fn comes_near(&self, other: &[Span; 3], reach: f64) -> bool {
        let near = |part: &[Span; 3]| (0..3).all(|k| part[k].gap(other[k]) <= reach);
        near(&self.whole) && self.parts.iter().any(near)
    }
}

/// A box around a solid, axes those of the base.
pub(super) fn bounds(placed: Placed<'_>) -> [Span; 3] {
    [Vector3::x(), Vector3::y(), Vector3::z()].map(|direction| placed.span(&direction))
}
