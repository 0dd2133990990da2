//! Interruption of a computation.

/// Returns true when the computation shall stop; it is called between instructions and between moves.
pub type Stop<'s> = &'s (dyn Fn() -> bool + Sync);

/// The computation was stopped before its end.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
#[error("the computation was stopped before its end")]
pub struct Interrupted;

/// The result of a computation that nothing stops.
pub(crate) fn whole<T>(result: Result<T, Interrupted>) -> T {
    result.expect("a computation that is never asked to stop runs to its end")
}
