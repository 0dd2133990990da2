//! The method that a task and a preparation choose.

use pulp::Simd;

use super::by_polynomials::ByPolynomials;
use super::found::{Ahead, Found};
use super::geometry::{Geometry, Task};
use super::joint_polynomials::{JointPolynomials, Order};
use super::model::Model;
use super::pose::PlatformPoses;
use super::shape::Balls;
use super::solve::{ClosedForm, Method, least_norm, newton, placed};
use crate::virtualization::Solver;

/// The polynomials where there are any, else the solver of the task: known when the program runs.
///
/// Each is a function of its own: a loop over poses is compiled once for all of them, and none takes registers of another.
#[derive(Clone, Copy)]
pub(crate) struct Chosen<'p>(pub(crate) Option<&'p JointPolynomials>);

impl Method for Chosen<'_> {
    #[inline(always)]
    fn found<S: Simd, M: Model>(
        &self,
        task: &Task<'_>,
        balls: &Balls<S>,
        ahead: Ahead<S>,
    ) -> Found<S> {
        let any = balls.mean;
        // What a model never asks for is not compiled for it.
        match (self.0, task.solver) {
            (Some(polynomials), _) if M::SETTLES => match polynomials.order() {
                Order::Three => any.outlined(
                    #[inline(always)]
                    || ByPolynomials::<3>(polynomials).found::<S, M>(task, balls, ahead),
                ),
                Order::Four => any.outlined(
                    #[inline(always)]
                    || ByPolynomials::<4>(polynomials).found::<S, M>(task, balls, ahead),
                ),
            },
            (_, Solver::ClosedForm) if M::CLOSED_FORM => any.outlined(
                #[inline(always)]
                || {
                    let ahead = ClosedForm.ahead::<S, M>(task, balls);
                    ClosedForm.found::<S, M>(task, balls, ahead)
                },
            ),
            (_, Solver::Newton) => any.outlined(
                #[inline(always)]
                || newton::<S, M>(task, balls),
            ),
            _ => any.outlined(
                #[inline(always)]
                || least_norm::<S, M>(task, balls),
            ),
        }
    }

    #[inline(always)]
    fn placed<S: Simd, M: Model>(
        &self,
        geometry: &Geometry,
        balls: &Balls<S>,
        found: &Found<S>,
    ) -> PlatformPoses<S> {
        let any = balls.mean;
        any.outlined(
            #[inline(always)]
            || match self.0 {
                Some(polynomials) if M::SETTLES => match polynomials.order() {
                    Order::Three => {
                        ByPolynomials::<3>(polynomials).placed::<S, M>(geometry, balls, found)
                    }
                    Order::Four => {
                        ByPolynomials::<4>(polynomials).placed::<S, M>(geometry, balls, found)
                    }
                },
                _ => placed::<S, M>(geometry, balls, found),
            },
        )
    }
}
