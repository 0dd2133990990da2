//! Joint coordinates of a mechanism along a motion.

use crate::{Axis, Curve, Figure, Panel, rod_style};

/// Curves of one panel: as many as there are distinct styles.
const MOST_CURVES: usize = 6;

/// One coordinate along the motion.
#[derive(Debug, Clone, PartialEq)]
pub struct Follower {
    /// Its name.
    pub name: String,
    /// Its unit.
    pub unit: &'static str,
    /// One value for each value of the drive, in `unit`.
    pub values: Vec<f64>,
}

/// Coordinates over the driven one, those of one unit together, a few in each panel.
///
/// # Arguments
/// * `drive` – the driven coordinate, for the horizontal axis
/// * `singular` – its values at singular configurations, in its unit
#[must_use]
pub fn motion(title: &str, drive: &Follower, followers: &[Follower], singular: &[f64]) -> Figure {
    let mut figure = Figure::new(title);
    let mut units: Vec<&str> = Vec::new();
    for follower in followers {
        if !units.contains(&follower.unit) {
            units.push(follower.unit);
        }
    }
    for unit in units {
        let of_unit: Vec<&Follower> = followers.iter().filter(|one| one.unit == unit).collect();
        for curves in of_unit.chunks(MOST_CURVES) {
            let mut panel = Panel::new(
                Axis::linear(format!("{} ({})", drive.name, drive.unit)),
                Axis::linear(format!("joint coordinate ({unit})")),
            );
            for (k, follower) in curves.iter().enumerate() {
                let (x, y) = (drive.values.clone(), follower.values.clone());
                panel = panel.with_curve(Curve::new(follower.name.clone(), x, y, rod_style(k)));
            }
            for &at in singular {
                panel = panel.with_marker(at, "singular");
            }
            figure = figure.with_panel(panel);
        }
    }
    figure
}
