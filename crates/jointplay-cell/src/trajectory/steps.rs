//! The steps of a motion one at a time: times since their own start, and hashes of their content.

use std::collections::BTreeMap;
use std::hash::{DefaultHasher, Hasher};
use std::sync::Arc;

use super::profile::put;
use super::{Sample, Segment, Trajectory};

impl Segment {
    /// Adds all that it is made of to a hash.
    fn hash(&self, to: &mut impl Hasher) {
        match self {
            Self::Dwell { duration } => {
                to.write_u8(0);
                put(to, &[*duration]);
            }
            Self::PointToPoint(together) => {
                to.write_u8(1);
                together.curves.iter().for_each(|curve| curve.hash(to));
            }
            Self::Line { line, pace } => {
                to.write_u8(2);
                line.spline.hash(to);
                pace.hash(to);
            }
        }
    }
}

impl Trajectory {
    /// Time between the start of a step and that of the next; half of an overlap with a neighbour belongs to each of the two [s].
    #[must_use]
    pub fn intrinsic_step_duration(&self, step: usize) -> f64 {
        self.length(step)
    }

    /// All axes a time after the start of a step, which is the time of the sample [s].
    #[must_use]
    pub fn sample_in_step(&self, step: usize, since: f64) -> Sample {
        let mut sample = Sample::default();
        self.fill_in_step(step, since, &mut sample);
        sample
    }

    /// Indices of the axes that move in a step, in growing order.
    #[must_use]
    pub fn moving_axes(&self, step: usize) -> Vec<usize> {
        self.moving(step)
    }

    /// Times since the start of a step at which the jerk of an axis jumps, in growing order; both its ends are included [s].
    #[must_use]
    pub fn jerk_discontinuities(&self, step: usize) -> Vec<f64> {
        let [lead, tail] = self.overlaps(step);
        let (way, length) = (&self.ways[step], self.length(step));
        let mut breaks = vec![0.0, length];
        breaks.extend(way.breaks().into_iter().map(|time| time - lead));
        if lead > 0.0 {
            let before = &self.ways[step - 1];
            let end = before.duration();
            breaks.extend(before.breaks().into_iter().map(|time| time - end + lead));
        }
        if tail > 0.0 && step + 1 < self.steps.len() {
            let start = way.duration() - 2.0 * tail - lead;
            breaks.extend(self.ways[step + 1].breaks().into_iter().map(|time| time + start));
        }
        breaks.retain(|time| (0.0..=length).contains(time));
        breaks.sort_by(f64::total_cmp);
        // Times that are the same but for round-off; the end stays the end.
        breaks.dedup_by(|later, earlier| *later - *earlier < SAME);
        if let Some(last) = breaks.last_mut() {
            *last = length;
        }
        breaks
    }

    /// A hash of the motion of all axes in each step; steps with the same motion have the same hash.
    ///
    /// It depends on the step and on neighbours that overlap with it, and not on when the step starts.
    #[must_use]
    pub fn fingerprints(&self) -> Vec<u64> {
        let mut known: BTreeMap<*const Segment, u64> = BTreeMap::new();
        let mut of_way = |way: &Arc<Segment>| {
            *known.entry(Arc::as_ptr(way)).or_insert_with(|| {
                let mut hasher = DefaultHasher::new();
                way.hash(&mut hasher);
                hasher.finish()
            })
        };
        let of_step = |index: usize| {
            let mut hasher = DefaultHasher::new();
            let overlaps = self.overlaps(index);
            let ways = self.segments_of(index);
            for (way, overlap) in ways.iter().zip([0.0, overlaps[0], overlaps[1]]) {
                hasher.write_u64(way.as_ref().map_or(0, &mut of_way));
                put(&mut hasher, &[overlap]);
            }
            put(&mut hasher, &self.steps[index].from);
            put(&mut hasher, &self.steps[index].to);
            hasher.finish()
        };
        (0..self.steps.len()).map(of_step).collect()
    }
}

/// Times nearer to each other than this are one [s].
const SAME: f64 = 1e-9;
