//! Indistinguishable curves, drawn once and named together.

use crate::Curve;

/// Distance below which two curves are drawn on top of each other (px).
const INDISTINGUISHABLE: f64 = 0.5;

/// The curves, with those that are nowhere farther apart than half a pixel merged into the first of them.
///
/// A merged curve is named after all of its members, with the largest difference between them.
///
/// # Arguments
/// * `curves` – curves of one panel, over the same abscissae
/// * `unit` – unit of the ordinates
/// * `height` – height of the panel (px)
pub(super) fn merged(curves: Vec<Curve>, unit: &str, height: f64) -> Vec<Curve> {
    let ordinates = || curves.iter().flat_map(|curve| &curve.y).copied().filter(|y| y.is_finite());
    let range =
        ordinates().fold(f64::NEG_INFINITY, f64::max) - ordinates().fold(f64::INFINITY, f64::min);
    let threshold = INDISTINGUISHABLE * range / height;
    let mut groups: Vec<(Curve, Vec<String>, f64)> = Vec::new();
    for curve in curves {
        let found = groups.iter_mut().find_map(|group| {
            let difference = largest_difference(&group.0, &curve)?;
            (difference <= threshold).then_some((group, difference))
        });
        match found {
            Some((group, difference)) => {
                group.1.push(curve.name);
                group.2 = group.2.max(difference);
            }
            None => {
                let names = vec![curve.name.clone()];
                groups.push((curve, names, 0.0));
            }
        }
    }
    let named = |(mut curve, names, difference): (Curve, Vec<String>, f64)| {
        if names.len() > 1 {
            let last = format!(" (equal within {} {unit})", rounded_up(difference));
            curve.name = names.join(", ") + &last;
        }
        curve
    };
    groups.into_iter().map(named).collect()
}

/// The largest difference of the ordinates; `None` if the abscissae differ or one curve has a gap that the other lacks.
fn largest_difference(a: &Curve, b: &Curve) -> Option<f64> {
    if a.x != b.x || a.y.len() != b.y.len() {
        return None;
    }
    a.y.iter().zip(&b.y).try_fold(0.0, |largest: f64, (a, b)| match (a.is_nan(), b.is_nan()) {
        (false, false) => Some(largest.max((a - b).abs())),
        (true, true) => Some(largest),
        _ => None,
    })
}

/// The next power of ten above a difference, not below 1e-9: finer than anything that a figure is about.
fn rounded_up(difference: f64) -> String {
    let exponent = difference.max(1e-9).log10().ceil();
    let (power, decimals) = (10_f64.powf(exponent), (-exponent).max(0.0));
    if decimals > 4.0 {
        return format!("1e{exponent}");
    }
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "0 to 4")]
    let decimals = decimals as usize;
    format!("{power:.decimals$}")
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rod_style;

    fn curve(name: &str, y: &[f64]) -> Curve {
        let x = (0..y.len()).map(|i| f64::from(u32::try_from(i).unwrap())).collect();
        Curve::new(name, x, y.to_vec(), rod_style(0))
    }

    fn check(curves: &[Curve], expected: &[&str]) {
        let names: Vec<String> =
            merged(curves.to_vec(), "mm", 100.0).into_iter().map(|curve| curve.name).collect();
        assert_eq!(names, expected);
    }

    #[test]
    fn coincident_curves_are_drawn_once_and_named_together() {
        let (a, b) = (curve("a", &[0.0, 1.0]), curve("b", &[0.001, 1.0]));
        let (c, gap) = (curve("c", &[0.0, 0.9]), curve("gap", &[f64::NAN, 1.0]));
        check(&[a.clone(), b.clone(), c.clone()], &["a, b (equal within 0.001 mm)", "c"]);
        check(&[a.clone(), c, b], &["a, b (equal within 0.001 mm)", "c"]);
        check(&[a.clone(), gap], &["a", "gap"]);
        check(&[a.clone(), a], &["a, a (equal within 1e-9 mm)"]);
        check(&[], &[]);
    }
}
