//! The scale of a picture: a bar with its length.

use crate::decimal::{order, plain, short, value};
use crate::svg::{Anchor, INK, Svg, px};
use crate::text::TICK;

/// Draws a bar with a round length.
///
/// # Arguments
/// * `meters` – length of one pixel (m)
/// * `room` – greatest length of the bar (px)
pub(crate) fn scale_bar(svg: &mut Svg, meters: f64, (right, y): (f64, f64), room: f64) {
    let longest = meters * room;
    if !longest.is_normal() {
        return;
    }
    let exponent = order(longest);
    let n = [5, 2, 1].into_iter().find(|&n| value(n, exponent) <= longest).unwrap_or(1);
    let length = value(n, exponent) / meters;
    let left = right - length;
    let data = format!("M{} {}v6m0 -3H{}m0 -3v6", px(left), px(y - 3.0), px(right));
    svg.path(&data, &format!(" stroke=\"{INK}\" stroke-width=\"1.4\""));
    svg.text((0.5 * (left + right), y - 8.0), TICK, Anchor::Middle, &measure(n, exponent), "");
}

/// A length of `n` · 10^`exponent` m in the unit that suits it.
fn measure(n: i64, exponent: i32) -> String {
    match exponent {
        0..4 => format!("{} m", plain(n, exponent)),
        -3..0 => format!("{} mm", plain(n, exponent + 3)),
        -6..-3 => format!("{} µm", plain(n, exponent + 6)),
        _ => format!("{} m", short(n, exponent)),
    }
}
