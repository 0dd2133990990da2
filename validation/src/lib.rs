//! Golden tables, the paper's print as code, and independent geometry, for the comparisons.
//!
//! | module | holds |
//! | --- | --- |
//! | this one | reading the golden data: tables of an independent program, with their provenance in comments |
//! | [`cases`] | poses of the paper's robot, by degrees |
//! | [`printed`] | equations of the paper, as printed and put right, and its iteration |
//! | [`centers`] | centroid, circumcentre and Fermat point of a triangle in space |
//! | [`paths`] | what happens to a solver that starts at the last pose |
//! | [`gallery`] | the page of all mechanisms of the catalogue, with their pictures |
//! | [`elastic`] | a rigid platform on bending rods |

#[doc = include_str!("../../docs/how-to/rust.md")]
#[cfg(doctest)]
struct GuideCompiles;

use std::collections::BTreeMap;
use std::path::Path;

use jointplay::gpr::{Gpr, Limb, Limits};
use jointplay::virtualization::{Metric, Offset, Planar, Polar, Radial, Solver, Virtualization};

pub mod cases;
pub mod centers;
pub mod elastic;
pub mod gallery;
pub mod paths;
pub mod printed;

/// One row of a golden table, by column name.
pub struct Row(BTreeMap<String, String>);

impl Row {
    /// The text in a column.
    ///
    /// # Panics
    /// If there is no such column.
    #[must_use]
    pub fn text(&self, column: &str) -> &str {
        self.0.get(column).unwrap_or_else(|| panic!("no column {column:?}"))
    }

    /// The number in a column, `None` where it is empty [unit of the column].
    ///
    /// # Panics
    /// If the text is no number.
    #[must_use]
    pub fn number(&self, column: &str) -> Option<f64> {
        let text = self.text(column);
        (!text.is_empty())
            .then(|| text.parse().unwrap_or_else(|_| panic!("{column}: {text:?} is no number")))
    }

    /// Numbers in columns, as far as they are filled [unit of the columns].
    #[must_use]
    pub fn numbers(&self, columns: &[&str]) -> Vec<f64> {
        columns.iter().map_while(|column| self.number(column)).collect()
    }

    /// Three lengths, from mm in the table (m).
    #[must_use]
    pub fn lengths(&self, columns: [&str; 3]) -> [f64; 3] {
        columns.map(|column| self.number(column).expect("a length in every row") * 1e-3)
    }

    /// The virtualization that the row speaks of.
    #[must_use]
    pub fn virtualization(&self) -> &'static dyn Virtualization {
        match self.text("model") {
            "radial" => &Radial,
            "polar" => &Polar,
            "offset" => &Offset,
            "planar" => &Planar,
            other => panic!("unknown model {other:?}"),
        }
    }

    /// The solver that the row speaks of.
    #[must_use]
    pub fn solver(&self) -> Solver {
        match self.text("solver") {
            "newton" => Solver::Newton,
            "least-norm" => Solver::LeastNorm,
            other => panic!("unknown solver {other:?}"),
        }
    }

    /// The metric that the row speaks of.
    #[must_use]
    pub fn metric(&self) -> Metric {
        self.number("rho_mm").map_or(Metric::Paper, |rho| Metric::Length(rho * 1e-3))
    }
}

/// All rows of a table in `validation/golden/`.
///
/// # Panics
/// If the file is missing or ragged.
#[must_use]
pub fn golden(name: &str) -> Vec<Row> {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("golden").join(name);
    let text = std::fs::read_to_string(&path)
        .unwrap_or_else(|error| panic!("{}: {error}", path.display()));
    let mut lines = text.lines().filter(|line| !line.starts_with('#'));
    let names: Vec<&str> = lines.next().expect("a header").split(',').collect();
    lines
        .map(|line| {
            let values: Vec<&str> = line.split(',').collect();
            assert_eq!(values.len(), names.len(), "{name}: {line}");
            Row(names.iter().zip(values).map(|(n, v)| ((*n).to_owned(), v.to_owned())).collect())
        })
        .collect()
}

/// The robots of the golden data, by name; limits wide enough for every row.
///
/// # Panics
/// If the table is not as expected.
#[must_use]
pub fn golden_robots() -> BTreeMap<String, Gpr> {
    let limits = Limits { rod_min: 0.2, rod_max: 0.8, tilt_max: 0.2 };
    golden("gpr-robots.csv")
        .into_iter()
        .map(|row| {
            let number = |column: String| row.number(&column).expect("a number in every column");
            let limbs = [1, 2, 3].map(|k| Limb {
                base_point: [
                    number(format!("B{k}x_mm")) * 1e-3,
                    number(format!("B{k}y_mm")) * 1e-3,
                ]
                .into(),
                socket_radius: number(format!("r{k}_mm")) * 1e-3,
                socket_angle: number(format!("beta{k}_deg")).to_radians(),
            });
            let gpr = Gpr::new(limbs, limits, 0.5).expect("a valid robot").without_limit_checks();
            (row.text("robot").to_owned(), gpr)
        })
        .collect()
}
