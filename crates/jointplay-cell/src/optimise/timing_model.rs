//! Times between hand-offs, measured in trajectories.

use std::collections::BTreeMap;

use crate::program::{Handoff, Path};
use crate::robot::EffectorId;
use crate::trajectory::Trajectory;

/// A hand-off without its slot.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Signature {
    /// Whether the effector picks.
    pub picks: bool,
    /// The effector.
    pub effector: EffectorId,
    /// Index of the station.
    pub station: usize,
}

impl Signature {
    /// Signature of a hand-off.
    #[must_use]
    pub fn of(handoff: Handoff) -> Self {
        let picks = matches!(handoff, Handoff::Picked(..));
        let (Handoff::Picked(effector, slot) | Handoff::Placed(effector, slot)) = handoff;
        Self { picks, effector, station: slot.station }
    }
}

/// A hand-off with the one before it; `None` from the start of the program.
type Pair = (Option<Signature>, Signature);

/// Mean times of one kind of hand-off after another.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TimingSample {
    /// Hand-off before; `None` from the start of the program.
    pub previous: Option<Signature>,
    /// The hand-off.
    pub signature: Signature,
    /// Time of all motions from the hand-off before (s).
    pub travel: f64,
    /// Part of it in the station, after the robot has waited for the process (s).
    pub in_station: f64,
}

/// Times between hand-offs by their signatures, the last measured ones.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct TimingModel {
    travel: BTreeMap<Pair, [f64; 2]>,
}

impl TimingModel {
    /// Mean times between hand-offs in a trajectory.
    #[must_use]
    pub fn measure(trajectory: &Trajectory) -> Vec<TimingSample> {
        let mut sums: BTreeMap<Pair, ([f64; 2], f64)> = BTreeMap::new();
        let (mut previous, mut travel, mut in_station) = (None, 0.0, 0.0);
        for (index, step) in trajectory.steps.iter().enumerate() {
            if !matches!(step.path, Path::Dwell(_) | Path::ProcessDwell { .. }) {
                let duration = trajectory.step_duration(index);
                travel += duration;
                in_station = if step.slot.is_some() { in_station + duration } else { 0.0 };
            }
            let Some(handoff) = step.handoff else { continue };
            let signature = Signature::of(handoff);
            let (sum, count) = sums.entry((previous, signature)).or_default();
            *sum = [sum[0] + travel, sum[1] + in_station];
            *count += 1.0;
            (previous, travel, in_station) = (Some(signature), 0.0, 0.0);
        }
        let sample = |((previous, signature), (sum, count)): ((_, _), ([f64; 2], f64))| {
            TimingSample { previous, signature, travel: sum[0] / count, in_station: sum[1] / count }
        };
        sums.into_iter().map(sample).collect()
    }

    /// Adds measured times, which replace earlier ones.
    pub fn learn(&mut self, samples: &[TimingSample]) {
        for one in samples {
            let times = [one.travel, one.in_station];
            self.travel.insert((one.previous, one.signature), times);
        }
    }

    /// Time of the motions to a hand-off and its part in the station: measured, or the mean of the most similar ones (s).
    pub(super) fn times(&self, previous: Option<Signature>, signature: Signature) -> [f64; 2] {
        if let Some(&times) = self.travel.get(&(previous, signature)) {
            return times;
        }
        let from = previous.map(|previous| previous.station);
        // Within a station the robot does not turn: too short a time is corrected once the order was evaluated.
        if from == Some(signature.station) {
            let alike =
                |(_, one): &Pair| (one.picks, one.station) == (signature.picks, signature.station);
            if let Some([_, in_station]) = self.mean(&alike) {
                return [in_station; 2];
            }
        }
        let similar: [&dyn Fn(&Pair) -> bool; 5] = [
            &|(before, one)| {
                before.map(|before| before.station) == from
                    && (one.picks, one.station) == (signature.picks, signature.station)
            },
            &|(_, one)| *one == signature,
            &|(_, one)| (one.picks, one.station) == (signature.picks, signature.station),
            &|(_, one)| one.station == signature.station,
            &|_| true,
        ];
        similar.iter().find_map(|is_similar| self.mean(is_similar)).unwrap_or_default()
    }

    fn mean(&self, is_similar: &dyn Fn(&Pair) -> bool) -> Option<[f64; 2]> {
        let found: Vec<&[f64; 2]> =
            self.travel.iter().filter(|(key, _)| is_similar(key)).map(|(_, times)| times).collect();
        #[expect(clippy::cast_precision_loss, reason = "a count of samples")]
        let count = found.len() as f64;
        let sum = |k: usize| found.iter().map(|times| times[k]).sum::<f64>() / count;
        (!found.is_empty()).then(|| [sum(0), sum(1)])
    }

    /// Mean time of the motions to a hand-off (s).
    pub(super) fn mean_travel(&self) -> f64 {
        self.mean(&|_| true).map_or(0.0, |times| times[0])
    }
}
