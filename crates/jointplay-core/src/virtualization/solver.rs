//! Which solution of the side equations is taken.

/// Which displacements, of all that produce the sides, are taken.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Solver {
    /// The paper's iteration from the nominal X: a solution near, not at, the least displacement; two or three steps.
    Newton,
    /// The least displacement in the metric near the nominal X, by iteration; a few steps more.
    ///
    /// Where sockets have to move by millimetres, another displacement far away may be smaller still.
    LeastNorm,
    /// The least displacement of all in closed form; where the virtualization has none, [`Self::LeastNorm`].
    #[default]
    ClosedForm,
}

impl std::fmt::Display for Solver {
    fn fmt(&self, formatter: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        formatter.pad(match self {
            Self::Newton => "newton",
            Self::LeastNorm => "least-norm",
            Self::ClosedForm => "closed-form",
        })
    }
}
