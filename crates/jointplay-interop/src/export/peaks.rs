//! The times at which a motion has to be told for lines between them to be the motion.

use jointplay_cell::trajectory::Sample;

use super::motion_export::MotionExport;

/// How far lines between samples may stray from speeds and accelerations, as a share of the limits: less than a pixel of a plot.
const PEAK_TOLERANCE: f64 = 2.5e-3;
/// Samples need not be nearer to each other than this [s].
const NEAREST: f64 = 1e-3;

/// In a stretch of time: even times, the ends of all steps, and between them wherever an acceleration bends or a speed is at its peak.
///
/// ```text
///    one bend between two samples, h apart:   d = a₁ − a₀ − j₀ h = (j₁ − j₀) r         r: from the bend to the second
///                                             w = v₁ − v₀ − a₀ h − j₀ h² / 2 = (j₁ − j₀) r² / 2,   so that r = 2 w / d
/// ```
/// Where the jerk is constant from bend to bend, as in all motions but straight lines, nothing is lost between the samples;
/// elsewhere intervals are halved until lines stray no farther than they may.
///
/// # Source
/// Own derivation.
pub(super) fn times(motion_export: &MotionExport<'_>, rate: f64, [from, to]: [f64; 2]) -> Vec<f64> {
    let motion = motion_export.motion;
    let duration = motion.duration();
    // As even samples are: a last one within a thousandth of the end is the end.
    let whole = (duration * rate - 1e-3).ceil().max(0.0);
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "checked before")]
    let even = (0..whole as u64).map(|k| {
        #[expect(clippy::cast_precision_loss, reason = "a number of samples")]
        let time = k as f64 / rate;
        time
    });
    let mut base: Vec<f64> = even.chain(motion.times.iter().copied()).chain([duration]).collect();
    base.retain(|time| (from..=to).contains(time));
    base.sort_by(f64::total_cmp);
    base.dedup_by(|later, earlier| *later - *earlier < 1e-9);
    let limits = motion_export.cell.robot.axes.iter().map(|axis| &axis.empty);
    let strays: Vec<[f64; 2]> = limits
        .map(|limit| [PEAK_TOLERANCE * limit.velocity, PEAK_TOLERANCE * limit.acceleration])
        .collect();
    let mut times = Vec::with_capacity(2 * base.len());
    let mut last = Sample::default();
    for &time in &base {
        let to = motion.sample_at(time);
        if !times.is_empty() {
            between(&|time| motion.sample_at(time), &last, &to, &strays, &mut times);
        }
        times.push(time);
        last = to;
    }
    times
}

/// Adds the times between two samples that are needed.
fn between(
    at: &dyn Fn(f64) -> Sample,
    from: &Sample,
    to: &Sample,
    strays: &[[f64; 2]],
    times: &mut Vec<f64>,
) {
    if to.time - from.time < 2.0 * NEAREST {
        return;
    }
    let Some(time) = cut(from, to, strays) else { return };
    let middle = at(time);
    between(at, from, &middle, strays, times);
    times.push(time);
    between(at, &middle, to, strays, times);
}

/// Where the interval has to be cut; `None` where lines are near enough.
fn cut(from: &Sample, to: &Sample, strays: &[[f64; 2]]) -> Option<f64> {
    let width = to.time - from.time;
    for (axis, &[stray_speed, stray]) in strays.iter().enumerate() {
        let [v0, v1] = [from.velocities[axis], to.velocities[axis]];
        let [a0, a1] = [from.accelerations[axis], to.accelerations[axis]];
        let jerk = from.jerks[axis];
        let bent = a1 - a0 - jerk * width;
        let gained = v1 - v0 - width * (a0 + 0.5 * jerk * width);
        if bent.abs() > stray || gained.abs() > 0.5 * stray * width {
            let time = to.time - 2.0 * gained / bent;
            let inside = from.time + NEAREST..to.time - NEAREST;
            return Some(if inside.contains(&time) { time } else { from.time + 0.5 * width });
        }
        // A speed that turns back between the samples.
        let over = (a1 - a0).abs() * width / 8.0;
        if a0 * a1 < 0.0 && over > stray_speed {
            let time = from.time + width * a0 / (a0 - a1);
            if time > from.time + NEAREST && time < to.time - NEAREST {
                return Some(time);
            }
        }
    }
    None
}
