//! Positions, and orientations in their five notations.

use jointplay_core::spatial::Pose;
use nalgebra::{Rotation3, Translation3, Unit, Vector3};
use roxmltree::Node;

use crate::import::problem::Error;
use crate::import::xml::{Value, Xml, attribute};

/// Attributes of the pose of a body, frame or site.
pub(super) const PLACING: [&str; 6] = ["pos", "quat", "axisangle", "euler", "xyaxes", "zaxis"];

/// Notations of an orientation.
const ORIENTATIONS: [&str; 5] = ["quat", "axisangle", "euler", "xyaxes", "zaxis"];

/// Angle conventions of a model.
pub(super) struct Angles {
    pub(super) in_degrees: bool,
    /// Axes of the three Euler angles, and whether they rotate with the body.
    sequence: [(usize, bool); 3],
}

impl Default for Angles {
    fn default() -> Self {
        Self { in_degrees: true, sequence: [(0, true), (1, true), (2, true)] }
    }
}

impl Angles {
    /// Sets the sequence of Euler angles: small letters are intrinsic axes, capitals extrinsic ones.
    pub(super) fn set_sequence(&mut self, xml: Xml, value: &Value) -> Result<(), Error> {
        let letters = value.text.chars().map(|letter| {
            let axis = "xyz".find(letter.to_ascii_lowercase())?;
            Some((axis, letter.is_ascii_lowercase()))
        });
        let letters = letters.collect::<Option<Vec<_>>>().and_then(|axes| axes.try_into().ok());
        let expected = "3 letters of x, y, z, X, Y, Z";
        self.sequence = letters.ok_or_else(|| xml.unusable(value, expected))?;
        Ok(())
    }

    pub(super) fn radians(&self, angle: f64) -> f64 {
        if self.in_degrees { angle.to_radians() } else { angle }
    }

    /// Pose of an element in the frame around it.
    ///
    /// # Arguments
    /// * `default` – returns the value of an absent attribute
    pub(super) fn pose<'a>(
        &self,
        xml: Xml<'a>,
        node: Node<'a, 'a>,
        default: impl Fn(&'static str) -> Option<Value<'a>>,
    ) -> Result<Pose, Error> {
        let point = attribute(node, "pos").or_else(|| default("pos"));
        let point = point.map(|pos| xml.vector(&pos)).transpose()?.unwrap_or_default();
        let mut given: Vec<Value> =
            ORIENTATIONS.iter().filter_map(|name| attribute(node, name)).collect();
        if given.is_empty() {
            given = ORIENTATIONS.iter().filter_map(|name| default(name)).collect();
        }
        let rotation = match given.as_slice() {
            [] => Rotation3::identity(),
            [value] => self.rotation(xml, value)?,
            [_, second, ..] => {
                return Err(xml.unusable(second, "absent: the element has another orientation"));
            }
        };
        Ok(Pose::from_parts(Translation3::from(point), rotation))
    }

    fn rotation(&self, xml: Xml, value: &Value) -> Result<Rotation3<f64>, Error> {
        match value.what {
            "quat" => xml.quaternion(value, xml.numbers(value, "4 numbers")?),
            "axisangle" => {
                let [x, y, z, angle] = xml.numbers(value, "4 numbers")?;
                let axis = xml.unit(value, Vector3::new(x, y, z))?;
                Ok(Rotation3::from_axis_angle(&axis, self.radians(angle)))
            }
            "euler" => Ok(self.euler(xml.numbers(value, "3 numbers")?)),
            "xyaxes" => {
                let [a, b, c, d, e, f] = xml.numbers(value, "6 numbers")?;
                let x = xml.unit(value, Vector3::new(a, b, c))?;
                let y = xml.unit(value, Vector3::new(d, e, f))?.into_inner();
                let y = y - x.scale(x.dot(&y));
                let y = Unit::try_new(y, 1e-9)
                    .ok_or_else(|| xml.unusable(value, "two directions that are not parallel"))?;
                let columns = [x.into_inner(), y.into_inner(), x.cross(&y)];
                let matrix = nalgebra::Matrix3::from_columns(&columns);
                Ok(Rotation3::from_matrix_unchecked(matrix))
            }
            _ => {
                let z = xml.direction(value)?;
                // The shortest rotation, from its sine and cosine; half a revolution is about x.
                let across = Vector3::z().cross(&z);
                let axis = Unit::try_new(across, 0.0).unwrap_or(Vector3::x_axis());
                Ok(Rotation3::from_axis_angle(&axis, across.norm().atan2(z.z)))
            }
        }
    }

    /// Consecutive rotations.
    fn euler(&self, angles: [f64; 3]) -> Rotation3<f64> {
        let axes = [Vector3::x_axis(), Vector3::y_axis(), Vector3::z_axis()];
        let turns = self.sequence.into_iter().zip(angles);
        turns.fold(Rotation3::identity(), |rotation, ((axis, turns_along), angle)| {
            let turn = Rotation3::from_axis_angle(&axes[axis], self.radians(angle));
            if turns_along { rotation * turn } else { turn * rotation }
        })
    }
}

/// A translation.
pub(super) fn shift(by: Vector3<f64>) -> Pose {
    Pose::from_parts(Translation3::from(by), nalgebra::Rotation3::identity())
}
