//! Selection of a model: virtualization, solver, metric.

use jointplay::virtualization::{
    BuiltIn, Metric, Offset, Planar, Polar, Radial, SolveOptions, Solver, Virtualization,
};
use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

use crate::problem::Problem;

/// Virtualization: the virtual joints that represent the joint play.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize, ToSchema)]
#[serde(rename_all = "kebab-case")]
pub(crate) enum VirtualizationName {
    /// Radial displacement of each socket.
    Radial,
    /// Radial displacement of each socket and its rotation about the platform centre.
    Polar,
    /// A displacement of each socket in polar coordinates.
    Offset,
    /// A displacement of each socket in Cartesian coordinates.
    #[default]
    Planar,
}

impl VirtualizationName {
    /// All names.
    pub(crate) const ALL: [Self; 4] = [Self::Radial, Self::Polar, Self::Offset, Self::Planar];

    pub(crate) fn of(virtualization: BuiltIn) -> Self {
        match virtualization {
            BuiltIn::Radial => Self::Radial,
            BuiltIn::Polar => Self::Polar,
            BuiltIn::Offset => Self::Offset,
            BuiltIn::Planar => Self::Planar,
        }
    }

    pub(crate) fn model(self) -> &'static (dyn Virtualization + Sync) {
        match self {
            Self::Radial => &Radial,
            Self::Polar => &Polar,
            Self::Offset => &Offset,
            Self::Planar => &Planar,
        }
    }
}

/// Solver of the virtual displacements.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize, ToSchema)]
#[serde(rename_all = "kebab-case")]
pub(crate) enum SolverName {
    /// Iteration of the paper, close to the minimum displacement.
    Newton,
    /// Exact minimum displacement, by iteration.
    LeastNorm,
    /// Exact minimum displacement in closed form; `least-norm` if there is none.
    #[default]
    ClosedForm,
}

impl From<SolverName> for Solver {
    fn from(name: SolverName) -> Self {
        match name {
            SolverName::Newton => Self::Newton,
            SolverName::LeastNorm => Self::LeastNorm,
            SolverName::ClosedForm => Self::ClosedForm,
        }
    }
}

impl From<Solver> for SolverName {
    fn from(solver: Solver) -> Self {
        match solver {
            Solver::Newton => Self::Newton,
            Solver::LeastNorm => Self::LeastNorm,
            Solver::ClosedForm => Self::ClosedForm,
        }
    }
}

/// Weight of angles relative to lengths.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize, ToSchema)]
#[serde(rename_all = "kebab-case")]
pub(crate) enum MetricName {
    /// A characteristic length of 1 mm, as in the paper.
    #[default]
    Paper,
    /// The mean socket radius.
    Radius,
}

/// A model.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize, ToSchema)]
#[serde(deny_unknown_fields, default)]
pub(crate) struct ModelChoice {
    /// Virtualization: the virtual joints that represent the joint play.
    #[schema(required = false)]
    pub(crate) virtualization: VirtualizationName,
    /// Solver of the virtual displacements.
    #[schema(required = false)]
    pub(crate) solver: SolverName,
    /// Weight of angles relative to lengths.
    #[schema(required = false)]
    pub(crate) metric: MetricName,
    /// Characteristic length instead of that of the metric (m).
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schema(minimum = 1e-12, maximum = 1e6)]
    pub(crate) characteristic_length_m: Option<f64>,
}

impl ModelChoice {
    /// The model with a virtualization and the given options of its solver.
    pub(crate) fn of(virtualization: VirtualizationName, options: &SolveOptions) -> Self {
        let (metric, characteristic_length_m) = match options.metric {
            Metric::PlatformRadius => (MetricName::Radius, None),
            Metric::Length(length) => (MetricName::Paper, Some(length)),
            Metric::Paper => (MetricName::Paper, None),
        };
        let solver = options.solver.into();
        Self { virtualization, solver, metric, characteristic_length_m }
    }

    pub(crate) fn model(&self) -> &'static (dyn Virtualization + Sync) {
        self.virtualization.model()
    }

    /// Solver and metric of the selection at `field`.
    pub(crate) fn options(&self, field: &str) -> Result<SolveOptions, Problem> {
        let metric = match (self.characteristic_length_m, self.metric) {
            (None, MetricName::Paper) => Metric::Paper,
            (None, MetricName::Radius) => Metric::PlatformRadius,
            (Some(length), _) if (1e-12..=1e6).contains(&length) => Metric::Length(length),
            (Some(length), _) => {
                let detail = format!(
                    "the characteristic length must be within 1e-12 to 1e6 m, got {length:e} m"
                );
                let field = match field {
                    "" => "characteristic_length_m".to_owned(),
                    field => format!("{field}.characteristic_length_m"),
                };
                return Err(Problem::field(field, detail));
            }
        };
        Ok(SolveOptions { solver: self.solver.into(), metric, ..SolveOptions::default() })
    }
}
