//! Joint coordinates of a mechanism along a motion.

use crate::{Axis, Curve, Figure, Panel, rod_style};

/// Curves of one panel: as many as there are distinct styles.
const MOST_CURVES: usize = 6;

/// One coordinate along the motion.
#[derive(Debug, Clone, PartialEq)]
pub struct Follower {
    /// Its name.
    pub name: String,
    /// Its unit; empty for a number without one.
    pub unit: &'static str,
    /// Whether it is the displacement of a virtual joint: these have panels of their own.
    pub is_virtual: bool,
    /// One value for each value of the drive, in `unit`.
    pub values: Vec<f64>,
}

impl Follower {
    fn title(&self) -> String {
        if self.unit.is_empty() {
            self.name.clone()
        } else {
            format!("{} ({})", self.name, self.unit)
        }
    }
}

/// Coordinates over the driven one or over the parameter of a curve, those of one kind and unit together, a few in each panel.
///
/// # Arguments
/// * `drive` – the driven coordinate or the parameter, for the horizontal axis
/// * `singular` – its values at singular configurations, in its unit
#[must_use]
pub fn motion(title: &str, drive: &Follower, followers: &[Follower], singular: &[f64]) -> Figure {
    let mut figure = Figure::new(title);
    let mut groups: Vec<(bool, &str)> = Vec::new();
    for follower in followers {
        let group = (follower.is_virtual, follower.unit);
        if !groups.contains(&group) {
            groups.push(group);
        }
    }
    for (is_virtual, unit) in groups {
        let of_group: Vec<&Follower> = followers
            .iter()
            .filter(|one| one.is_virtual == is_virtual && one.unit == unit)
            .collect();
        let quantity = if is_virtual { "virtual joint" } else { "joint coordinate" };
        // Panels with about the same number of curves.
        let panels = of_group.len().div_ceil(MOST_CURVES);
        for curves in of_group.chunks(of_group.len().div_ceil(panels)) {
            let mut panel = Panel::new(
                Axis::linear(drive.title()),
                Axis::linear(format!("{quantity} ({unit})")),
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
