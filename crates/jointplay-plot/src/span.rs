//! The part of an axis that is drawn, and where a value falls in it.

use crate::Scale;

/// Relative width below which a range of values is round-off, not a variation worth a scale.
///
/// Some thousand units in the last place of an `f64`: sums of a few products differ by less.
pub(crate) const FINEST: f64 = 1e-12;

/// Width below which a range of values on a logarithmic axis is drawn as one value.
const FEWEST_DECADES: f64 = 1e-9;

/// Least and greatest of some values.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Extent {
    /// Least value (unit of the axis).
    pub(crate) min: f64,
    /// Greatest value (unit of the axis).
    pub(crate) max: f64,
}

impl Extent {
    /// The extent of `values`, or `None` of no values.
    pub(crate) fn of(values: impl IntoIterator<Item = f64>) -> Option<Self> {
        values.into_iter().fold(None, |extent, value| match extent {
            None => Some(Self { min: value, max: value }),
            Some(Self { min, max }) => Some(Self { min: min.min(value), max: max.max(value) }),
        })
    }
}

/// From where to where an axis is drawn: `lo < hi`, and on a logarithmic axis `0 < lo`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Span {
    /// Lower end (unit of the axis).
    pub(crate) lo: f64,
    /// Upper end (unit of the axis).
    pub(crate) hi: f64,
    /// How values are placed between the ends.
    pub(crate) scale: Scale,
}

impl Span {
    /// The span from exactly `lo` to `hi`, if it can be drawn.
    pub(crate) fn exact(lo: f64, hi: f64, scale: Scale) -> Option<Self> {
        if scale == Scale::Log10 {
            let decades = hi.log10() - lo.log10();
            let drawable = lo > 0.0 && decades.is_finite() && decades >= FEWEST_DECADES;
            return drawable.then_some(Self { lo, hi, scale });
        }
        let width = hi - lo;
        let drawable = width.is_finite() && width > FINEST * lo.abs().max(hi.abs());
        (drawable && width > 1e-290).then_some(Self { lo, hi, scale })
    }

    /// The span that shows `extent` with a `margin` (a fraction of its width) at both ends, if it can be drawn.
    pub(crate) fn around(extent: Extent, margin: f64, scale: Scale) -> Option<Self> {
        let Extent { min, max } = extent;
        if scale == Scale::Log10 {
            // A flat series gets half a decade on either side.
            let decades = max.log10() - min.log10();
            let factor = 10f64.powf(if decades < FEWEST_DECADES { 0.5 } else { margin * decades });
            // At the ends of what a number can hold there is no room to add.
            let lo = if min / factor > 0.0 { min / factor } else { min };
            return Self::exact(lo, (max * factor).min(f64::MAX), scale);
        }
        let greatest = min.abs().max(max.abs());
        let width = max - min;
        let pad = if width > FINEST * greatest && width > 1e-280 {
            margin * width
        } else if greatest > 1e-280 {
            0.01 * greatest
        } else {
            1.0
        };
        Self::exact(min - pad, max + pad, scale)
    }

    /// Where `value` falls: 0 at the lower end, 1 at the upper.
    pub(crate) fn place(&self, value: f64) -> f64 {
        let fraction = match self.scale {
            Scale::Linear => (value - self.lo) / (self.hi - self.lo),
            Scale::Log10 => {
                let start = self.lo.log10();
                (value.log10() - start) / (self.hi.log10() - start)
            }
        };
        // Far outside, only the direction matters; infinities would spoil the clipping.
        fraction.clamp(-1e6, 1e6)
    }

    /// Whether `value` lies between the ends.
    pub(crate) fn contains(&self, value: f64) -> bool {
        (self.lo..=self.hi).contains(&value)
    }

    /// The same middle, `factor` times as wide; linear spans only.
    pub(crate) fn widened(&self, factor: f64) -> Self {
        let middle = self.lo + 0.5 * (self.hi - self.lo);
        let half = 0.5 * (self.hi - self.lo) * factor;
        Self { lo: middle - half, hi: middle + half, scale: self.scale }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn flat_and_nearly_flat_series_get_a_width() {
        for value in [0.0, 5.0, -93.218, 1e-300, 1e300] {
            for max in [value, value * (1.0 + 1e-15)] {
                let extent = Extent::of([value, max]).expect("two values");
                let span = Span::around(extent, 0.05, Scale::Linear).expect("drawable");
                assert!(span.lo < value && value < span.hi, "{value}");
            }
        }
        let one = Extent { min: 1e-14, max: 1e-14 };
        let span = Span::around(one, 0.05, Scale::Log10).expect("drawable");
        assert!((span.place(1e-14) - 0.5).abs() < 1e-9);
    }

    #[test]
    fn what_cannot_be_drawn() {
        for (lo, hi) in [(1.0, 1.0), (2.0, 1.0), (f64::NAN, 1.0), (-1e308, 1e308)] {
            assert_eq!(Span::exact(lo, hi, Scale::Linear), None);
        }
    }

    #[test]
    fn places() {
        let linear = Span { lo: -1.0, hi: 3.0, scale: Scale::Linear };
        assert_eq!(linear.place(0.0), 0.25);
        let log = Span { lo: 1e-200, hi: 1e-100, scale: Scale::Log10 };
        assert!((log.place(1e-150) - 0.5).abs() < 1e-12);
    }
}
