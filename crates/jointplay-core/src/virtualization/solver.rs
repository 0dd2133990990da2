//! Choice among the solutions of the side equations.

/// Choice among the displacements that produce the sides.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Solver {
    /// The paper's iteration from the nominal X: a solution near, not at, the least displacement; two or three steps.
    Newton,
    /// The least displacement in the metric near the nominal X, by iteration; a few steps more.
    ///
    /// For socket displacements of millimetres, a distant solution may have a smaller displacement.
    LeastNorm,
    /// The least displacement of all in closed form; where the virtualization has none, [`Self::LeastNorm`].
    #[default]
    ClosedForm,
}

impl core::fmt::Display for Solver {
    fn fmt(&self, formatter: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        formatter.pad(match self {
            Self::Newton => "newton",
            Self::LeastNorm => "least-norm",
            Self::ClosedForm => "closed-form",
        })
    }
}
