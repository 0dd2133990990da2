//! Quantities of many poses, by their names in Python.

use jointplay::bulk::Quantity;
use pyo3::prelude::*;

use crate::errors;

/// A quantity of one or several columns.
pub(crate) struct Named {
    pub(crate) name: &'static str,
    columns: Columns,
}

enum Columns {
    One(Quantity),
    Three(fn(usize) -> Quantity),
    VirtualJoints,
}

/// All of them, in the order in which results list them.
const ALL: [Named; 13] = [
    Named { name: "azimuth_rad", columns: Columns::One(Quantity::Azimuth) },
    Named { name: "tilt_rad", columns: Columns::One(Quantity::TiltAngle) },
    Named { name: "torsion_rad", columns: Columns::One(Quantity::Torsion) },
    Named { name: "axis_height_m", columns: Columns::One(Quantity::AxisHeight) },
    Named { name: "origin_m", columns: Columns::Three(Quantity::Origin) },
    Named { name: "normal", columns: Columns::Three(Quantity::Normal) },
    Named { name: "sides_m", columns: Columns::Three(Quantity::Side) },
    Named { name: "virtual_joints", columns: Columns::VirtualJoints },
    Named { name: "displacement_m", columns: Columns::One(Quantity::Displacement) },
    Named { name: "ball_displacement_m", columns: Columns::Three(Quantity::BallDisplacement) },
    Named { name: "sensitivity", columns: Columns::Three(Quantity::Sensitivity) },
    Named { name: "residual_m", columns: Columns::One(Quantity::Residual) },
    Named { name: "iterations", columns: Columns::One(Quantity::Iterations) },
];

/// Computed only on request: it takes longer than all the others together.
const ONLY_IF_ASKED: &str = "sensitivity";

impl Named {
    /// Those of some names; without names all but the slow one.
    pub(crate) fn of(py: Python<'_>, names: Option<&[String]>) -> PyResult<Vec<&'static Self>> {
        let Some(names) = names else {
            return Ok(ALL.iter().filter(|one| one.name != ONLY_IF_ASKED).collect());
        };
        let find = |name: &String| {
            ALL.iter().find(|one| one.name == name).ok_or_else(|| {
                errors::unknown_name(py, "quantity", name, &ALL.map(|one| one.name.to_owned()))
            })
        };
        for name in names {
            find(name)?;
        }
        Ok(ALL.iter().filter(|one| names.iter().any(|name| name == one.name)).collect())
    }

    /// The quantities of its columns.
    pub(crate) fn quantities(&self, virtual_joints: usize) -> Vec<Quantity> {
        match self.columns {
            Columns::One(quantity) => vec![quantity],
            Columns::Three(quantity) => (0..3).map(quantity).collect(),
            Columns::VirtualJoints => (0..virtual_joints).map(Quantity::VirtualJoint).collect(),
        }
    }

    /// Number of columns; `None` for a single one without an index.
    pub(crate) fn width(&self, virtual_joints: usize) -> Option<usize> {
        match self.columns {
            Columns::One(_) => None,
            Columns::Three(_) => Some(3),
            Columns::VirtualJoints => Some(virtual_joints),
        }
    }
}
