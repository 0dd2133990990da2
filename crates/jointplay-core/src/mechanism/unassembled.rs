//! Loops that could not be closed, as facts.

use super::closure::Closure;
use crate::constraint::CLOSURE_TOLERANCE;

/// A mismatch up to this one may be the rounding of dimensions, and the message states so.
pub(super) const NEARLY_CLOSED: f64 = 1e-3;

/// Loops that could not be closed from the guess.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[error("{}", self.message(|distance, angle| format!("{distance:.3e} m and {angle:.3e} rad")))]
pub struct Unassembled {
    /// The least mismatch found.
    pub best: Closure,
    /// The least mismatch near the guess.
    pub near_guess: Closure,
    /// The loops there, the most open first.
    pub loops: Vec<OpenLoop>,
    /// The couplings that do not hold there, the most violated first.
    pub couplings: Vec<OpenCoupling>,
    /// Closed configurations found from other starts; where there are any, the guess was the cause.
    pub branches: Vec<Closure>,
    /// The closed configuration within the limits that is nearest the guess, if one was found.
    pub nearest: Option<Closure>,
    /// Number of other starts tried.
    pub starts: usize,
    /// Whether the correction that led to `best` did not converge while links moved apart.
    pub best_drifts: bool,
    /// Whether the correction from the guess did not converge while links moved apart.
    pub near_guess_drifts: bool,
}

/// A loop that is not closed.
#[derive(Debug, Clone, PartialEq)]
pub struct OpenLoop {
    /// Name of the joint that closes it.
    pub joint: String,
    /// The links of this joint, whose frames do not meet.
    pub links: [String; 2],
    /// Mismatch, in radians and characteristic lengths.
    pub mismatch: f64,
    /// Distance between the origins of the two frames of the joint (m).
    pub distance: f64,
    /// Angle between the two frames (rad).
    pub angle: f64,
}

/// A coupling that does not hold.
#[derive(Debug, Clone, PartialEq)]
pub struct OpenCoupling {
    /// Name of the coupling.
    pub name: String,
    /// Violation, in radians and characteristic lengths.
    pub mismatch: f64,
}

impl Unassembled {
    /// The closure to accept in place of one from the guess: within a tolerance of the dimensions, or the nearest closed configuration.
    ///
    /// A near miss is no reason to move far: where one is not within the tolerance, nothing is accepted.
    ///
    /// # Arguments
    /// * `tolerance` – as for [`Unassembled::within`]; `None` for loops that close exactly
    #[must_use]
    pub fn accepted(&self, tolerance: Option<f64>) -> Option<&Closure> {
        let within = tolerance.and_then(|tolerance| self.within(tolerance));
        let is_far = self.near_miss().is_none();
        within.or(self.nearest.as_ref().filter(|_| is_far))
    }

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

    /// The message, with the gap of the most open loop in units of the caller.
    ///
    /// # Arguments
    /// * `gap` – the text of a distance and an angle (m, rad)
    #[must_use]
    pub fn message(&self, gap: impl Fn(f64, f64) -> String) -> String {
        let near_miss = self.near_miss().map_or(String::new(), |closure| {
            format!(
                "; they close to {:.1e} (radians and characteristic lengths), which may be the rounding of the dimensions: a larger tolerance takes them as closed",
                closure.residual
            )
        });
        let open = self.loops.first().filter(|open| open.mismatch > CLOSURE_TOLERANCE);
        let violated = self.couplings.first();
        let most = open.map_or(0.0, |open| open.mismatch);
        let worst = match (open, violated.filter(|violated| violated.mismatch > most)) {
            (_, Some(OpenCoupling { name, mismatch })) => {
                format!("; coupling {name:?} is violated by {mismatch:.3e}")
            }
            (Some(open), None) => {
                let OpenLoop { joint, links: [first, second], mismatch, distance, angle } = open;
                format!(
                    "; the loop closed by joint {joint:?} stays open by {mismatch:.3e}: its frames on links {first:?} and {second:?} are {} apart",
                    gap(*distance, *angle)
                )
            }
            (None, None) => String::new(),
        };
        let what = match open {
            None if violated.is_some() => "the couplings contradict each other",
            _ => "the loops cannot be closed",
        };
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
                "{what}: best mismatch {:.3e} (radians and characteristic lengths) from the guess and {} other starts{worst}{near_miss}{drifts}",
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
