//! Shape-preserving cubic interpolation of measured values.

/// A value measured at a position.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Measured {
    pub(super) position: f64,
    pub(super) value: f64,
}

/// The cubic between two measured values: monotone where the values around it are, so that it never exceeds them.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct CubicPiece {
    ends: [Measured; 2],
    /// First derivatives at both ends.
    slopes: [f64; 2],
}

impl CubicPiece {
    /// The piece between two values, given the values before and after them where there are any.
    ///
    /// Slopes are weighted harmonic means of the neighbouring secants, zero where these differ in sign; at the ends of all values, those of the parabola through three, limited so that the shape is kept.
    ///
    /// # Source
    /// \[FritschButland\]
    pub(super) fn new(
        before: Option<Measured>,
        ends: [Measured; 2],
        after: Option<Measured>,
    ) -> Self {
        let [from, to] = ends;
        let own = Secant::of(from, to);
        let slopes = [
            match (before, after) {
                (Some(before), _) => Secant::of(before, from).mean(own),
                (None, Some(after)) => own.at_end(Secant::of(to, after)),
                (None, None) => own.slope,
            },
            match (after, before) {
                (Some(after), _) => own.mean(Secant::of(to, after)),
                (None, Some(before)) => own.at_end(Secant::of(before, from)),
                (None, None) => own.slope,
            },
        ];
        Self { ends, slopes }
    }

    /// Value with its first and second derivative at a position between the ends.
    pub(super) fn value_and_derivatives(&self, position: f64) -> [f64; 3] {
        let [from, to] = self.ends;
        let width = to.position - from.position;
        let t = ((position - from.position) / width).clamp(0.0, 1.0);
        let [m0, m1] = self.slopes;
        let secant = (to.value - from.value) / width;
        // value = y₀ + w t (m₀ + t (c₂ + t c₃))
        let (c2, c3) = (3.0 * secant - 2.0 * m0 - m1, m0 + m1 - 2.0 * secant);
        [
            from.value + width * t * (m0 + t * (c2 + t * c3)),
            m0 + t * (2.0 * c2 + 3.0 * t * c3),
            (2.0 * c2 + 6.0 * t * c3) / width,
        ]
    }

    /// Largest magnitudes of the first and of the second derivative.
    pub(super) fn largest_derivatives(&self) -> [f64; 2] {
        let [from, to] = self.ends;
        let [start, end] =
            [self.value_and_derivatives(from.position), self.value_and_derivatives(to.position)];
        // The first derivative is a parabola: it is largest at an end, or where the second is zero.
        let turning = start[2] / (start[2] - end[2]);
        let turning = if turning > 0.0 && turning < 1.0 {
            self.value_and_derivatives(from.position + turning * (to.position - from.position))[1]
                .abs()
        } else {
            0.0
        };
        [start[1].abs().max(end[1].abs()).max(turning), start[2].abs().max(end[2].abs())]
    }
}

/// Mean slope between two values.
#[derive(Debug, Clone, Copy)]
struct Secant {
    width: f64,
    slope: f64,
}

impl Secant {
    fn of(from: Measured, to: Measured) -> Self {
        let width = to.position - from.position;
        Self { width, slope: (to.value - from.value) / width }
    }

    /// Slope between this secant and the next.
    fn mean(self, next: Self) -> f64 {
        if self.slope * next.slope <= 0.0 {
            return 0.0;
        }
        let [before, after] = [2.0 * next.width + self.width, next.width + 2.0 * self.width];
        (before + after) / (before / self.slope + after / next.slope)
    }

    /// Slope at the outer end of this secant, the next one inward known.
    fn at_end(self, inner: Self) -> f64 {
        let (w, v) = (self.width, inner.width);
        let slope = ((2.0 * w + v) * self.slope - w * inner.slope) / (w + v);
        if slope * self.slope <= 0.0 {
            0.0
        } else if self.slope * inner.slope <= 0.0 && slope.abs() > 3.0 * self.slope.abs() {
            3.0 * self.slope
        } else {
            slope
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const POSITIONS: [f64; 6] = [0.1, 0.25, 0.3, 0.5, 0.62, 0.8];
    const VALUES: [f64; 6] = [0.0, 1e-3, 1.5e-3, 1.2e-3, 4e-3, 9e-3];

    fn piece(k: usize) -> CubicPiece {
        let measured = |k: usize| Measured { position: POSITIONS[k], value: VALUES[k] };
        let before = k.checked_sub(1).map(measured);
        let after = (k + 2 < POSITIONS.len()).then(|| measured(k + 2));
        CubicPiece::new(before, [measured(k), measured(k + 1)], after)
    }

    #[test]
    fn values_equal_those_of_another_program() {
        // scipy.interpolate.PchipInterpolator(POSITIONS, VALUES), scipy 1.15.3: value and first two derivatives.
        const EXPECTED: [(usize, f64, [f64; 3]); 8] = [
            (0, 0.13, [0.0001442758620689655, 0.005416091954022988, 0.03808429118773947]),
            (0, 0.22, [0.0007571034482758621, 0.0078816091954023, 0.016704980842911884]),
            (1, 0.27, [0.001235586206896552, 0.013406896551724142, -0.02482758620689718]),
            (2, 0.35, [0.001453125, -0.0016875, -0.0225]),
            (2, 0.48, [0.0012084, -0.00081, 0.036]),
            (3, 0.55, [0.0019467946152204093, 0.0261477345501121, 0.2995116874799869]),
            (4, 0.63, [0.004253529409439325, 0.02549006771741321, 0.02749018631183211]),
            (4, 0.79, [0.008697092143910371, 0.030137450931559142, 0.030602103864991983]),
        ];
        for (k, position, expected) in EXPECTED {
            for (found, expected) in
                piece(k).value_and_derivatives(position).into_iter().zip(expected)
            {
                assert!(
                    (found - expected).abs() < 1e-11 * expected.abs().max(1e-3),
                    "{k} {found} {expected}"
                );
            }
        }
    }

    #[test]
    fn pieces_meet_with_equal_slopes_and_stay_between_their_values() {
        for k in 0..5 {
            let [low, high] = [VALUES[k].min(VALUES[k + 1]), VALUES[k].max(VALUES[k + 1])];
            let [mut rate, mut bend] = [0.0_f64; 2];
            for step in 0..=1000 {
                let position =
                    POSITIONS[k] + (POSITIONS[k + 1] - POSITIONS[k]) * f64::from(step) / 1000.0;
                let [value, first, second] = piece(k).value_and_derivatives(position);
                assert!((low - 1e-18..=high + 1e-18).contains(&value), "{k} {value}");
                (rate, bend) = (rate.max(first.abs()), bend.max(second.abs()));
            }
            let [most_rate, most_bend] = piece(k).largest_derivatives();
            assert!(rate <= most_rate * (1.0 + 1e-12) && most_rate <= rate * 1.0001);
            assert!(bend <= most_bend * (1.0 + 1e-12) && most_bend <= bend * 1.0001);
            if k > 0 {
                let [before, after] =
                    [piece(k - 1), piece(k)].map(|it| it.value_and_derivatives(POSITIONS[k])[1]);
                assert!((before - after).abs() < 1e-15, "{k}");
            }
        }
    }
}
