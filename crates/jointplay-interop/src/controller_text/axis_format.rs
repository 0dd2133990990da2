//! Values of axes in a text.

use jointplay_cell::robot::{AxisKind, HybridRobot};
use jointplay_format::mechanism::{AngleUnit, LengthUnit};
use jointplay_format::place::Error;

use super::format_spec::{Kind, Value};
use super::problem::Problem;
use super::template::{Names, Template};
use super::template_table::{TemplateTable, unit};

/// Names of the template of an axis.
const AXIS: [(&str, Kind); 3] =
    [("name", Kind::Text), ("value", Kind::Real), ("number", Kind::Integer)];

/// Form of a value for each axis: the keys `length`, `angle`, `axis` and `between`.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct AxisFormat {
    pub(crate) length: LengthUnit,
    pub(crate) angle: AngleUnit,
    axis: Template,
    pub(crate) between: String,
}

impl AxisFormat {
    pub(crate) fn read(file: &TemplateTable<'_, '_, '_>) -> Option<Self> {
        let length = unit(file.top, "length", &LengthUnit::ALL);
        let angle = unit(file.top, "angle", &AngleUnit::ALL);
        let axis = file.required("axis", &Names::new(&AXIS));
        let between = file.top.needed("between")?.text(file.top.reader).map(str::to_owned);
        Some(Self { length: length?, angle: angle?, axis: axis?, between: between? })
    }

    /// A value for each axis (m or rad, or their derivatives).
    pub(crate) fn values(
        &self,
        robot: &HybridRobot,
        values: &[f64],
    ) -> Result<String, Error<Problem>> {
        let axes = robot.axes.iter().zip(values).enumerate();
        let values = axes.map(|(k, (axis, &value))| {
            let value = match axis.kind {
                AxisKind::Linear => self.length.from_meters(value),
                AxisKind::Rotary => self.angle.from_radians(value),
            };
            self.axis.fill(|name| match name {
                "name" => Value::Text(axis.name.clone()),
                "value" => Value::Real(value),
                _ => count(k + 1),
            })
        });
        Ok(values.collect::<Result<Vec<_>, _>>()?.join(&self.between))
    }
}

/// A count as the value of a template.
pub(crate) fn count(value: usize) -> Value {
    Value::Integer(i64::try_from(value).unwrap_or(i64::MAX))
}

/// A text in one line.
pub(crate) fn one_line(text: &str) -> String {
    text.chars().map(|letter| if letter.is_control() { ' ' } else { letter }).collect()
}
