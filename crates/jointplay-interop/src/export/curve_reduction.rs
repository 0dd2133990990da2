//! Points of a curve that linear interpolation needs.

/// Samples of a curve, reduced to those between which linear interpolation deviates from no sample by more than a tolerance; the first and the last one remain.
///
/// ```text
///    a ●───────────●  s        slopes from a to (tᵢ, yᵢ ± τ) bound a cone for each sample i after a;
///      ╲ cone  ⋰               a sample s whose slope is in all cones since a ends a segment that is
///        ╲  ⋰                  within τ of all samples between
/// ```
///
/// # Arguments
/// * `samples` – values over increasing times
/// * `tolerance` – not negative
///
/// # Numerics
/// One pass, and memory for two samples; to round-off of the slopes.
///
/// # Source
/// \[Williams\], own derivation of the bound: a chord within the cone of each sample passes within τ of it
pub(super) fn reduced(
    samples: impl IntoIterator<Item = (f64, f64)>,
    tolerance: f64,
) -> impl Iterator<Item = (f64, f64)> {
    let mut samples = samples.into_iter();
    let mut state = State { anchor: None, last: None, cone: EVERY, tolerance };
    let mut is_done = false;
    std::iter::from_fn(move || {
        if is_done {
            return None;
        }
        for sample in samples.by_ref() {
            if let Some(kept) = state.next(sample) {
                return Some(kept);
            }
        }
        is_done = true;
        state.last.take()
    })
}

/// Slopes of all lines.
const EVERY: [f64; 2] = [f64::NEG_INFINITY, f64::INFINITY];

struct State {
    /// Start of the segment, which is kept.
    anchor: Option<(f64, f64)>,
    /// Latest sample after it: a line from the anchor to it is within the tolerance of all samples between.
    last: Option<(f64, f64)>,
    /// Least and greatest slope of lines from the anchor within the tolerance of all samples since.
    cone: [f64; 2],
    tolerance: f64,
}

impl State {
    /// Takes a sample; returns the one that is kept, if any.
    fn next(&mut self, sample: (f64, f64)) -> Option<(f64, f64)> {
        let Some(anchor) = self.anchor else {
            self.anchor = Some(sample);
            return Some(sample);
        };
        let [least, greatest] = self.cone;
        let is_within = (least..=greatest).contains(&slope(anchor, sample, 0.0));
        let (start, kept) = match self.last {
            Some(last) if !is_within => {
                self.cone = EVERY;
                (last, Some(last))
            }
            _ => (anchor, None),
        };
        let [least, greatest] = self.cone;
        let low = slope(start, sample, -self.tolerance);
        let high = slope(start, sample, self.tolerance);
        self.cone = [least.max(low), greatest.min(high)];
        self.anchor = Some(start);
        self.last = Some(sample);
        kept
    }
}

/// Slope from a point to a sample that is raised.
fn slope((from, at): (f64, f64), (to, value): (f64, f64), raised: f64) -> f64 {
    (value + raised - at) / (to - from)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn interpolated(points: &[(f64, f64)], at: f64) -> f64 {
        let after = points.iter().position(|&(time, _)| time >= at).expect("within the points");
        let (t, y) = points[after];
        match after.checked_sub(1).map(|before| points[before]) {
            Some((s, x)) if t > at => x + (y - x) * (at - s) / (t - s),
            _ => y,
        }
    }

    proptest! {
        #[test]
        fn reduced_curves_deviate_from_no_sample_by_more_than_the_tolerance(
            steps in prop::collection::vec((1e-3..1.0_f64, -1.0..1.0_f64), 0..300),
            smooth in any::<bool>(),
            tolerance in prop_oneof![Just(0.0), 1e-6..0.5_f64],
        ) {
            let (mut time, mut value) = (0.0, 0.0);
            let samples: Vec<(f64, f64)> = steps
                .into_iter()
                .map(|(dt, dy)| {
                    time += dt;
                    value = if smooth { (0.3 * time).sin() } else { value + dy };
                    (time, value)
                })
                .collect();
            let kept: Vec<(f64, f64)> = reduced(samples.iter().copied(), tolerance).collect();
            prop_assert_eq!(kept.first(), samples.first());
            prop_assert_eq!(kept.last(), samples.last());
            prop_assert!(kept.iter().all(|point| samples.contains(point)));
            prop_assert!(kept.windows(2).all(|pair| pair[0].0 < pair[1].0));
            for &(at, value) in &samples {
                let off = (interpolated(&kept, at) - value).abs();
                prop_assert!(off <= tolerance + 1e-12 * (1.0 + value.abs()), "{off} at {at}");
            }
        }
    }

    #[test]
    fn rest_and_steady_motion_need_their_ends_only() {
        let ramp = |k: i32| (f64::from(k) * 0.25, f64::from((k - 4).clamp(0, 8)) * 0.5);
        let kept: Vec<_> = reduced((0..20).map(ramp), 1e-9).collect();
        assert_eq!(kept, [(0.0, 0.0), (1.0, 0.0), (3.0, 4.0), (4.75, 4.0)]);
        assert_eq!(reduced([(0.0, 1.0)], 0.1).collect::<Vec<_>>(), [(0.0, 1.0)]);
        assert_eq!(reduced([], 0.1).count(), 0);
    }
}
