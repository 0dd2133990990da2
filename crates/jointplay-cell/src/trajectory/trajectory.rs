//! The trajectory: segments and blends of all steps over time.

use std::collections::BTreeMap;
use std::hash::{DefaultHasher, Hasher};

use super::blend::Blend;
use super::profile::hash_numbers;
use super::sample::{Sample, UniformSampling};
use super::segment::Segment;
use super::segment_motion::SegmentMotion;
use crate::incremental::CacheKey;
use crate::program::{Path, Step};

/// Discontinuities of the jerk closer to each other than this are one: they differ by round-off (s).
const SAME_TIME: f64 = 1e-9;

/// The motion of all axes over time: steps, each with its segment and start time.
#[derive(Debug, Clone)]
pub struct Trajectory {
    /// Steps in the order of execution.
    pub steps: Vec<Step>,
    /// Start time of each step, and the end time of the last; where a step is blended with the next, the middle of their overlap (s).
    pub times: Vec<f64>,
    /// Motion of all axes in each step.
    pub(super) segments: Vec<Segment>,
    /// Blend of each step with the next.
    pub(super) blends: Vec<Option<Blend>>,
}

/// Deviation of a Cartesian line from straight motion at a constant rate of rotation.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LineDeviation {
    /// Length of the line (m).
    pub length: f64,
    /// Largest distance of the wafer's centre from the straight line (m).
    pub distance: f64,
    /// Largest angle between the wafer's plane and the plane that rotates uniformly from start to end (rad).
    pub angle: f64,
}

/// Halves of the overlaps of a step with its neighbours; each of two blended steps owns one half of their overlap (s).
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct HalfOverlaps {
    /// With the step before.
    pub(super) previous: f64,
    /// With the step after.
    pub(super) next: f64,
}

impl Trajectory {
    /// Duration of the whole trajectory (s).
    #[must_use]
    pub fn duration(&self) -> f64 {
        self.times.last().copied().unwrap_or(0.0)
    }

    /// Duration of a step, as the difference of its end and start times (s).
    #[must_use]
    pub fn step_duration(&self, step: usize) -> f64 {
        self.times[step + 1] - self.times[step]
    }

    /// Duration of a step, computed from its segment and overlaps alone; independent of when the step starts, to the bit (s).
    #[must_use]
    pub fn intrinsic_step_duration(&self, step: usize) -> f64 {
        let overlaps = self.half_overlaps(step);
        self.segments[step].duration() - overlaps.previous - overlaps.next
    }

    /// Index of the step that is executed at a time (s): where two steps meet the later one, after the end the last one.
    #[must_use]
    pub fn step_at(&self, time: f64) -> usize {
        let begun = self.times[..self.steps.len().max(1)].partition_point(|&start| start <= time);
        begun.saturating_sub(1)
    }

    /// Whether no axis moves in a step.
    #[must_use]
    pub fn is_dwell(&self, step: usize) -> bool {
        matches!(**self.segments[step].motion, SegmentMotion::Dwell { .. })
    }

    /// Whether an axis moves in any step.
    #[must_use]
    pub fn moves(&self) -> bool {
        (0..self.steps.len()).any(|step| !self.is_dwell(step))
    }

    /// Whether a step takes time; waiting for a station whose process is over takes none.
    #[must_use]
    pub fn has_duration(&self, step: usize) -> bool {
        self.segments[step].duration() > 0.0
    }

    /// Indices of the axes that move in a step, in growing order; axes of blended neighbours are included.
    #[must_use]
    pub fn moving_axes(&self, step: usize) -> Vec<usize> {
        let overlaps = self.half_overlaps(step);
        let any = |axis: &usize| {
            self.moves_axis(step, *axis)
                || (overlaps.previous > 0.0 && self.moves_axis(step - 1, *axis))
                || (overlaps.next > 0.0 && self.moves_axis(step + 1, *axis))
        };
        (0..self.steps[step].from.len()).filter(any).collect()
    }

    /// Whether an axis moves in a step, its blended neighbours aside.
    fn moves_axis(&self, step: usize, axis: usize) -> bool {
        self.segments[step].motion.moves(&self.steps[step], axis)
    }

    /// Time in a step in which an axis moves: all of it, or the overlaps in which only a blended neighbour moves the axis (s).
    pub(crate) fn moving_time(&self, step: usize, axis: usize) -> f64 {
        let duration = self.step_duration(step);
        if self.moves_axis(step, axis) {
            return duration;
        }
        let overlaps = self.half_overlaps(step);
        let mut time = 0.0;
        if overlaps.previous > 0.0 && self.moves_axis(step - 1, axis) {
            time += overlaps.previous;
        }
        if overlaps.next > 0.0 && self.moves_axis(step + 1, axis) {
            time += overlaps.next;
        }
        time.min(duration)
    }

    /// Deviation of a step from its Cartesian line; `None` for steps that are not lines.
    #[must_use]
    pub fn line_deviation(&self, step: usize) -> Option<LineDeviation> {
        match (&self.steps[step].path, &**self.segments[step].motion) {
            (Path::Line(_), SegmentMotion::Line { path, .. }) => Some(LineDeviation {
                length: path.length,
                distance: path.deviation,
                angle: path.plane_deviation,
            }),
            _ => None,
        }
    }

    /// Axis that determines the duration of a point-to-point step; `None` where no axis moves, where friction determines it, and for lines, whose axes are coupled.
    #[must_use]
    pub fn limiting_axis(&self, step: usize) -> Option<usize> {
        match &**self.segments[step].motion {
            SegmentMotion::PointToPoint(profile) => profile.limiting_axis,
            _ => None,
        }
    }

    /// Blend of a step with the next; `None` where all axes are at rest between them.
    #[must_use]
    pub fn blend(&self, step: usize) -> Option<Blend> {
        self.blends.get(step).copied().flatten()
    }

    /// State of all axes at a time (s); before the start and after the end, at rest in the first and last positions.
    ///
    /// At the end of a step all axes are exactly at its end positions, unless it is blended with the next.
    #[must_use]
    pub fn sample_at(&self, time: f64) -> Sample {
        let mut sample = Sample::default();
        self.write_sample_at(time, &mut sample);
        sample
    }

    /// As [`Self::sample_at`], into an existing sample, whose memory is reused.
    pub fn write_sample_at(&self, time: f64, sample: &mut Sample) {
        let step = self.step_at(time);
        let is_end = step + 1 == self.steps.len() && time >= self.duration();
        let time_in_step = self.times.get(step).map_or(0.0, |start| time - start);
        self.write_sample_in_step(step, if is_end { f64::INFINITY } else { time_in_step }, sample);
        sample.time = time;
    }

    /// State of all axes at a time since the start of a step (s), which is the time of the sample.
    #[must_use]
    pub fn sample_in_step(&self, step: usize, time_in_step: f64) -> Sample {
        let mut sample = Sample::default();
        self.write_sample_in_step(step, time_in_step, &mut sample);
        sample
    }

    /// As [`Self::sample_in_step`], into an existing sample, whose memory is reused.
    ///
    /// Where two steps overlap, their segments are superposed:
    ///
    /// ```text
    ///    q(t)  =  q_1(t) + q_2(t) − corner
    /// ```
    pub(crate) fn write_sample_in_step(
        &self,
        index: usize,
        time_in_step: f64,
        sample: &mut Sample,
    ) {
        sample.time = time_in_step;
        sample.step = index;
        let Some(step) = self.steps.get(index) else { return };
        sample.reset(step.from.len());
        let overlaps = self.half_overlaps(index);
        // The step starts in the middle of the overlap, half an overlap after its segment.
        let time = (time_in_step + overlaps.previous).max(0.0);
        self.segments[index].write_sample(step, time, sample);
        if time_in_step < overlaps.previous {
            let previous = &self.segments[index - 1];
            let time = previous.duration() + time_in_step - overlaps.previous;
            previous.superpose(&self.steps[index - 1], time, &step.from, sample);
        }
        let time_in_next = time - (self.segments[index].duration() - 2.0 * overlaps.next);
        if overlaps.next > 0.0 && time_in_next > 0.0 && index + 1 < self.steps.len() {
            let next = &self.segments[index + 1];
            next.superpose(&self.steps[index + 1], time_in_next, &step.to, sample);
        }
    }

    /// Times since the start of a step at which the jerk of an axis is discontinuous, in growing order; start and end of the step are included (s).
    #[must_use]
    pub fn jerk_discontinuities(&self, step: usize) -> Vec<f64> {
        let overlaps = self.half_overlaps(step);
        let (segment, duration) = (&self.segments[step], self.intrinsic_step_duration(step));
        let mut times = vec![0.0, duration];
        let own = segment.motion.jerk_discontinuities();
        times.extend(own.into_iter().map(|time| time - overlaps.previous));
        if overlaps.previous > 0.0 {
            let previous = &self.segments[step - 1];
            let end = previous.duration();
            let of_previous = previous.motion.jerk_discontinuities();
            times.extend(of_previous.into_iter().map(|time| time - end + overlaps.previous));
        }
        if overlaps.next > 0.0 && step + 1 < self.steps.len() {
            let start = segment.duration() - 2.0 * overlaps.next - overlaps.previous;
            let of_next = self.segments[step + 1].motion.jerk_discontinuities();
            times.extend(of_next.into_iter().map(|time| time + start));
        }
        times.retain(|time| (0.0..=duration).contains(time));
        times.sort_by(f64::total_cmp);
        times.dedup_by(|later, earlier| *later - *earlier < SAME_TIME);
        // The end is exact, also where a discontinuity just before it was kept in its place.
        if let Some(last) = times.last_mut() {
            *last = duration;
        }
        times
    }

    /// Samples at a uniform rate (Hz) from the start, and one at the end.
    pub fn samples(&self, rate: f64) -> impl Iterator<Item = Sample> + '_ {
        self.sample_times(rate).iter().map(|time| self.sample_at(time))
    }

    /// Times of [`Self::samples`].
    #[must_use]
    pub fn sample_times(&self, rate: f64) -> UniformSampling {
        UniformSampling::new(self.duration(), rate)
    }

    /// Hash of the motion of all axes in each step; steps with the same motion have the same hash.
    ///
    /// A hash depends on the step and on the neighbours that overlap with it, and not on when the step starts.
    #[must_use]
    pub fn motion_hashes(&self) -> Vec<u64> {
        let mut known: BTreeMap<u64, u64> = BTreeMap::new();
        let mut motion_hash = |segment: &Segment| {
            *known.entry(segment.motion.identity()).or_insert_with(|| {
                let mut hasher = DefaultHasher::new();
                segment.motion.hash(&mut hasher);
                hasher.finish()
            })
        };
        let step_hash = |index: usize| {
            let mut hasher = DefaultHasher::new();
            for (segment, overlap) in self.overlapping_segments(index) {
                hasher.write_u64(segment.map_or(0, &mut motion_hash));
                hash_numbers(&mut hasher, &[overlap]);
            }
            hash_numbers(&mut hasher, &self.steps[index].from);
            hash_numbers(&mut hasher, &self.steps[index].to);
            hasher.finish()
        };
        (0..self.steps.len()).map(step_hash).collect()
    }

    /// Halves of the overlaps of a step with its neighbours.
    pub(super) fn half_overlaps(&self, step: usize) -> HalfOverlaps {
        let half = |step: usize| self.blend(step).map_or(0.0, |blend| 0.5 * blend.overlap);
        HalfOverlaps { previous: step.checked_sub(1).map_or(0.0, half), next: half(step) }
    }

    /// Segment of a step, then those of the previous and the next step where they overlap with it, each with half of the overlap (s).
    fn overlapping_segments(&self, step: usize) -> [(Option<&Segment>, f64); 3] {
        let HalfOverlaps { previous, next } = self.half_overlaps(step);
        [
            (Some(&self.segments[step]), 0.0),
            (if previous > 0.0 { Some(&self.segments[step - 1]) } else { None }, previous),
            (if next > 0.0 { Some(&self.segments[step + 1]) } else { None }, next),
        ]
    }

    /// Cache key of the motion of all axes in a step.
    pub(crate) fn step_motion_key(&self, index: usize) -> CacheKey {
        let mut key = CacheKey::default();
        for (segment, overlap) in self.overlapping_segments(index) {
            key.add(&segment).add(&overlap);
        }
        key.add(&self.steps[index].from).add(&self.steps[index].to);
        key
    }
}
