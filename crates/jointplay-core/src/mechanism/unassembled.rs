//! Loops that could not be closed, as facts.

use super::closure::Closure;

/// A mismatch up to this one may be the rounding of dimensions, and the message states so.
const NEARLY_CLOSED: f64 = 1e-3;

/// Loops that could not be closed from the guess.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[error("{}", self.message())]
pub struct Unassembled {
    /// The least mismatch found.
    pub best: Closure,
    /// The least mismatch near the guess.
    pub near_guess: Closure,
    /// Mismatch of each loop there, in radians and characteristic lengths, by the name of the joint that closes it; largest first.
    pub loops: Vec<(String, f64)>,
    /// Closed configurations found from other starts; where there are any, the guess was the cause.
    pub branches: Vec<Closure>,
    /// Number of other starts tried.
    pub starts: usize,
    /// Whether the correction that led to `best` did not converge while links moved apart.
    pub best_drifts: bool,
    /// Whether the correction from the guess did not converge while links moved apart.
    pub near_guess_drifts: bool,
}

impl Unassembled {
    /// The closure to accept within a tolerance of the dimensions: the one near the guess, or the best one if no start closes exactly; `None` if every mismatch is larger.
    ///
    /// A closure that drifts is never accepted: its mismatch falls below any tolerance because links move apart without limit.
    ///
    /// # Arguments
    /// * `tolerance` – largest accepted mismatch, in radians and characteristic lengths
    #[must_use]
    pub fn within(&self, tolerance: f64) -> Option<&Closure> {
        // Where other starts close exactly, the guess was the cause, and the closures may be far from the intended one.
        let other = self.branches.is_empty().then_some(&self.best);
        let near_guess = (!self.near_guess_drifts).then_some(&self.near_guess);
        let closures = [near_guess, other.filter(|_| !self.best_drifts)];
        closures.into_iter().flatten().find(|closure| closure.residual <= tolerance)
    }

    /// The closure that misses by so little that dimensions may only be rounded.
    #[must_use]
    pub fn near_miss(&self) -> Option<&Closure> {
        self.within(NEARLY_CLOSED)
    }

    fn message(&self) -> String {
        let near_miss = self.near_miss().map_or(String::new(), |closure| {
            format!(
                "; they close to {:.1e} (radians and characteristic lengths), which may be the rounding of the dimensions: a larger tolerance takes them as closed",
                closure.residual
            )
        });
        let worst = self.loops.first().map_or(String::new(), |(joint, size)| {
            format!("; the loop closed by joint {joint:?} stays open by {size:.3e}")
        });
        let drifts = if self.near_guess_drifts {
            format!(
                "; from the guess the correction did not converge in {} iterations, and the links moved apart",
                self.near_guess.iterations
            )
        } else {
            String::new()
        };
        if self.branches.is_empty() {
            format!(
                "the loops cannot be closed: best mismatch {:.3e} (radians and characteristic lengths) from the guess and {} other starts{worst}{near_miss}{drifts}",
                self.best.residual, self.starts
            )
        } else {
            format!(
                "the loops do not close from this guess, but {} other closed configurations were found from {} starts; give one of them as the guess{near_miss}",
                self.branches.len(),
                self.starts
            )
        }
    }
}
