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
    /// How many other starts were tried.
    pub starts: usize,
}

impl Unassembled {
    /// The closure to use if dimensions are true only to a tolerance: that near the guess, or the best where nothing closes exactly; `None` if it misses by more.
    ///
    /// # Arguments
    /// * `tolerance` – largest mismatch that is taken as closed, in radians and characteristic lengths
    #[must_use]
    pub fn within(&self, tolerance: f64) -> Option<&Closure> {
        // Where other starts close exactly, the guess was the cause, and the closures may be far from the intended one.
        let other = self.branches.is_empty().then_some(&self.best);
        let closures = [Some(&self.near_guess), other];
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
        if self.branches.is_empty() {
            format!(
                "the loops cannot be closed: best mismatch {:.3e} (radians and characteristic lengths) from the guess and {} other starts{worst}{near_miss}",
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
