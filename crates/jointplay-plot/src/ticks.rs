//! Placement of the ticks of an axis: as many as fit, with distinct labels.

use crate::Scale;
use crate::linear_ticks::linear_ticks;
use crate::log_ticks::log_ticks;
use crate::span::Span;
use crate::text::{TICK, width};
use crate::tick::Ticks;

/// Ticks for `span` drawn over `length` (px), at least about `spacing` (px) apart.
fn at_spacing(span: &Span, length: f64, spacing: f64) -> Ticks {
    match span.scale {
        Scale::Linear => linear_ticks(span.lo, span.hi, spacing / length),
        Scale::Log10 => log_ticks(span.lo, span.hi, spacing / length),
    }
}

/// Ticks for `span` drawn over `length` (px), about `spacing` (px) apart, closer only if fewer than two would fit.
pub(crate) fn upright_ticks(span: &Span, length: f64, mut spacing: f64) -> Ticks {
    loop {
        let ticks = at_spacing(span, length, spacing);
        if ticks.major.len() >= 2 || spacing < 15.0 {
            return ticks;
        }
        spacing *= 0.7;
    }
}

/// As [`upright_ticks`], but far enough apart that labels do not overlap.
pub(crate) fn level_ticks(span: &Span, length: f64, mut spacing: f64) -> Ticks {
    let mut ticks = upright_ticks(span, length, spacing);
    while spacing < length && crowded(&ticks, span, length) {
        spacing *= 1.2;
        let fewer = at_spacing(span, length, spacing);
        if fewer.major.len() < 2 {
            break;
        }
        ticks = fewer;
    }
    // On a frame too narrow for even two labels, ticks go without rather than be unreadable.
    let mut free = f64::NEG_INFINITY;
    for tick in &mut ticks.major {
        let middle = span.place(tick.value) * length;
        let half = 0.5 * width(&tick.label, TICK);
        if middle - half < free {
            tick.label.clear();
        } else {
            free = middle + half + 4.0;
        }
    }
    ticks
}

/// Whether two labels side by side come closer than the width of a wide letter.
fn crowded(ticks: &Ticks, span: &Span, length: f64) -> bool {
    ticks.major.windows(2).any(|pair| {
        let between = (span.place(pair[1].value) - span.place(pair[0].value)) * length;
        0.5 * (width(&pair[0].label, TICK) + width(&pair[1].label, TICK)) + 12.0 > between
    })
}
