//! The closed equations of the three-rod robot under the virtualizations of this crate, for one pose or for many side by side.
//!
//! A kernel answers where the answer is beyond doubt; all else, errors included, is left to [`solve`](crate::virtualization::solve).

mod by_polynomials;
mod chosen;
mod found;
mod geometry;
mod joint_polynomials;
mod lanes;
mod model;
mod plane;
mod polar;
mod pose;
mod processor;
mod shape;
mod single;
mod solve;
mod symmetric;
mod trigonometry;

pub(crate) use by_polynomials::ByPolynomials;
pub(crate) use chosen::Chosen;
pub(crate) use found::{Ahead, Found, squared};
pub(crate) use geometry::{FirstStep, Geometry, Task};
pub(crate) use joint_polynomials::{JointPolynomials, Order, Sample};
pub(crate) use lanes::{Lanes, MOST, Mask};
pub(crate) use model::{Model, Offset, Planar, Polar, Radial};
pub(crate) use pose::PlatformPoses;
pub(crate) use shape::{Balls, Shape, Three};
pub(crate) use single::{Single, SingleJoints, SinglePose};
pub(crate) use solve::{ClosedForm, Method};
pub(crate) use trigonometry::{angle_of, gradient, sin_cos};
