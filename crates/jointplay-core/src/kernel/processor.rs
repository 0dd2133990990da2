//! The instructions of the processor.

use pulp::{Arch, Simd, WithSimd};

/// The widest instructions of this processor, found once: asking the processor takes as long as a pose.
#[derive(Clone, Copy)]
pub(crate) struct Processor(Arch);

impl Processor {
    pub(crate) fn new() -> Self {
        Self(Arch::new())
    }

    /// Compiles a function for the instructions of the processor, and calls it.
    ///
    /// What it calls has to be inlined, always.
    #[inline]
    pub(crate) fn run<T>(self, function: impl FnOnce() -> T) -> T {
        self.0.dispatch(Run(function))
    }

    /// Compiles work in the registers of the processor, and does it; see [`Self::run`].
    #[inline]
    pub(crate) fn run_wide<W: WithSimd>(self, work: W) -> W::Output {
        self.0.dispatch(work)
    }
}

/// All processors compute the same bits.
impl PartialEq for Processor {
    fn eq(&self, _: &Self) -> bool {
        true
    }
}

/// The same text on all processors.
impl std::fmt::Debug for Processor {
    fn fmt(&self, formatter: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        formatter.write_str("Processor")
    }
}

struct Run<F>(F);

impl<T, F: FnOnce() -> T> WithSimd for Run<F> {
    type Output = T;

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) -> T {
        (self.0)()
    }
}
