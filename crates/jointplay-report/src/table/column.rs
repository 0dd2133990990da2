//! Columns of a table, units in their names.

/// One column.
#[derive(Debug, Clone, PartialEq)]
pub struct Column {
    /// Name with its unit, such as `q1_mm`.
    pub name: String,
    /// The values.
    pub values: Values,
}

/// Values of a column.
#[derive(Debug, Clone, PartialEq)]
pub enum Values {
    /// Numbers, in the unit of the column's name.
    Real(Vec<f64>),
    /// Counts.
    Count(Vec<u32>),
}

impl Values {
    pub(super) fn len(&self) -> usize {
        match self {
            Self::Real(values) => values.len(),
            Self::Count(values) => values.len(),
        }
    }
}
