//! Solvers of a robot, prepared for many poses.

use std::sync::{Arc, Mutex, PoisonError};

use jointplay::Error;
use jointplay::bulk::PoseSolver;
use jointplay::gpr::Gpr;
use jointplay::virtualization::{BuiltIn, SolveOptions};

/// Most solvers that a robot keeps: more than there are virtualizations, for a few metrics.
const MOST: usize = 8;

/// Solvers of a robot, each prepared at its first use and kept for later calls, the latest last.
///
/// A preparation takes as long as some ten thousand poses.
#[derive(Debug, Default)]
pub(crate) struct PreparedSolvers(Mutex<Vec<Prepared>>);

#[derive(Debug)]
struct Prepared {
    virtualization: BuiltIn,
    options: SolveOptions,
    solver: Arc<PoseSolver>,
}

impl PreparedSolvers {
    /// The solver of `gpr`, which has to be the same robot in each call.
    pub(crate) fn of(
        &self,
        gpr: &Gpr,
        virtualization: BuiltIn,
        options: &SolveOptions,
    ) -> Result<Arc<PoseSolver>, Error> {
        let mut all = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        let is_it =
            |one: &Prepared| (one.virtualization, one.options) == (virtualization, *options);
        if let Some(known) = all.iter().find(|one| is_it(one)) {
            return Ok(Arc::clone(&known.solver));
        }
        let solver = Arc::new(PoseSolver::new(gpr, virtualization, options)?);
        if all.len() == MOST {
            all.remove(0);
        }
        all.push(Prepared { virtualization, options: *options, solver: Arc::clone(&solver) });
        Ok(solver)
    }
}

#[cfg(test)]
mod tests {
    use jointplay::virtualization::Metric;

    use super::*;

    #[test]
    fn a_solver_is_prepared_once_and_few_are_kept() {
        let (gpr, solvers) = (Gpr::paper(), PreparedSolvers::default());
        let of = |virtualization, length| {
            let options =
                SolveOptions { metric: Metric::Length(length), ..SolveOptions::default() };
            let solver = solvers.of(&gpr, virtualization, &options).unwrap();
            assert_eq!(*solver, PoseSolver::new(&gpr, virtualization, &options).unwrap());
            solver
        };
        let first = of(BuiltIn::Polar, 0.1);
        assert!(Arc::ptr_eq(&first, &of(BuiltIn::Polar, 0.1)));
        assert!(!Arc::ptr_eq(&first, &of(BuiltIn::Planar, 0.1)));
        for i in 1..=MOST {
            of(BuiltIn::Polar, 0.1 + i as f64);
        }
        assert_eq!(solvers.0.lock().unwrap().len(), MOST);
        assert!(!Arc::ptr_eq(&first, &of(BuiltIn::Polar, 0.1)));
        let options = SolveOptions { metric: Metric::Length(-1.0), ..SolveOptions::default() };
        assert!(solvers.of(&gpr, BuiltIn::Polar, &options).is_err());
    }
}
