//! The figures by which programs are compared.

use jointplay_format::number::fixed;
use serde::Serialize;

use crate::cell::{CellReport, InstructionReport, ShareReport};

/// A figure by which programs are compared.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema))]
pub struct KeyFigure {
    /// Name of the quantity.
    pub name: &'static str,
    /// Its value in `unit`; none where the program has none.
    pub value: Option<f64>,
    /// Unit; empty for a count.
    pub unit: &'static str,
    /// Number of shown decimals.
    #[serde(skip)]
    pub decimals: usize,
}

impl KeyFigure {
    /// The value without its unit; a dash for none.
    #[must_use]
    pub fn number(&self) -> String {
        self.value.map_or("–".to_owned(), |value| fixed(value, self.decimals))
    }

    /// The value with its unit; a dash for none.
    #[must_use]
    pub fn to_text(&self) -> String {
        let unit = if self.value.is_some() { self.unit } else { "" };
        format!("{} {unit}", self.number()).trim_end().to_owned()
    }

    /// The difference to the figure of another program, with sign, unit and percentage; a dash where one has no value.
    #[must_use]
    pub fn difference(&self, before: &Self) -> String {
        let (Some(after), Some(before)) = (self.value, before.value) else {
            return "–".to_owned();
        };
        let signed = |value: f64, decimals: usize| {
            let text = fixed(value.abs(), decimals);
            // Without a sign where it rounds to zero.
            let is_zero = text.chars().all(|letter| matches!(letter, '0' | '.'));
            let sign = if is_zero {
                ""
            } else if value > 0.0 {
                "+"
            } else {
                "−"
            };
            format!("{sign}{text}")
        };
        let difference = signed(after - before, self.decimals);
        let unit = if self.unit.is_empty() { "" } else { " " };
        let ratio = 100.0 * (after - before) / before.abs();
        let is_share = matches!(self.unit, "" | "%");
        let relative = if is_share || !ratio.is_finite() {
            String::new()
        } else {
            format!(" ({} %)", signed(ratio, 1))
        };
        format!("{difference}{unit}{}{relative}", self.unit)
    }
}

/// Times, throughput, smallest distance, and the largest shares of limits of a program.
#[must_use]
pub fn key_figures(report: &CellReport) -> Vec<KeyFigure> {
    let figure =
        |name, value: Option<f64>, unit, decimals| KeyFigure { name, value, unit, decimals };
    let most = |of: &dyn Fn(&InstructionReport) -> Option<f64>| {
        report.instructions.iter().filter_map(of).reduce(f64::max).map(|share| 100.0 * share)
    };
    let share = |share: &Option<ShareReport>| share.as_ref().map(|one| one.share);
    #[expect(clippy::cast_precision_loss, reason = "a count")]
    let violations = report.violations.len() as f64;
    vec![
        figure("duration", Some(report.duration_s), "s", 2),
        figure("throughput if repeated", report.wafers_per_hour, "wafers/h", 1),
        figure("throughput in steady state", report.schedule.steady_wafers_per_hour, "wafers/h", 1),
        figure("robot in motion", Some(100.0 * report.schedule.robot.busy_share), "%", 1),
        figure("smallest distance", report.nearest.first().map(|one| one.distance_mm), "mm", 3),
        figure("slip, share of the friction limit", most(&|one| share(&one.slip)), "%", 1),
        figure("tilt, share of the limit", most(&|one| Some(one.tilt)), "%", 1),
        figure("play, share of the budget", most(&|one| Some(one.play)), "%", 1),
        figure("violations", Some(violations), "", 0),
    ]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn differences_have_a_sign_a_unit_and_a_percentage() {
        let figure = |value, unit| KeyFigure { name: "any", value, unit, decimals: 1 };
        for (before, after, unit, shown) in [
            (Some(100.0), Some(80.0), "s", "−20.0 s (−20.0 %)"),
            (Some(100.0), Some(125.0), "wafers/h", "+25.0 wafers/h (+25.0 %)"),
            (Some(100.0), Some(100.01), "s", "0.0 s (0.0 %)"),
            (Some(-2.0), Some(1.0), "mm", "+3.0 mm (+150.0 %)"),
            (Some(0.0), Some(1.0), "mm", "+1.0 mm"),
            (Some(40.0), Some(50.0), "%", "+10.0 %"),
            (Some(3.0), Some(0.0), "", "−3.0"),
            (None, Some(1.0), "s", "–"),
            (Some(1.0), None, "s", "–"),
        ] {
            let difference = figure(after, unit).difference(&figure(before, unit));
            assert_eq!(difference, shown);
        }
    }
}
