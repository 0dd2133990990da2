//! The plane through the balls of many poses.

use pulp::Simd;

use super::geometry::Geometry;
use super::lanes::Lanes;

/// The plane through the balls of many poses.
#[derive(Clone, Copy)]
pub(crate) struct Plane<S: Simd> {
    /// Its upward normal times twice the area of the triangle (m²).
    pub(super) across: [Lanes<S>; 3],
    /// Twice the area of the triangle (m²).
    pub(crate) area: Lanes<S>,
}

impl<S: Simd> Plane<S> {
    /// # Arguments
    /// * `rises` – differences of rods, q_j − q_i (m)
    #[inline(always)]
    pub(super) fn new(geometry: &Geometry, rises: &[Lanes<S>; 3]) -> Self {
        let [[x_1, y_1], [x_3, y_3]] = geometry.first_edges;
        let [z_1, _, z_3] = *rises;
        // (P_2 − P_1) × (P_3 − P_1), whose third entry is that of the base.
        let x = z_3.times_from(z_3.like(y_1), z_1 * y_3);
        let y = z_1.times_from(z_1.like(x_3), z_3 * x_1);
        let z = x.like(geometry.base_area.abs());
        let area = x.times_plus(x, y.times_plus(y, z.like(geometry.base_area_squared))).sqrt();
        Self { across: [x, y, z], area }
    }

    /// Factors from the upward normal to the unit normal n, and to n/(1 + n_z) (1/m²).
    #[inline(always)]
    pub(super) fn factors(&self) -> [Lanes<S>; 2] {
        let ([_, _, z], area) = (self.across, self.area);
        // Both with one division.
        let both = z.times_plus(area, area * area).inverse();
        [(area + z) * both, area * both]
    }

    /// Square of the horizontal part of the normal times twice the area (m⁴).
    #[inline(always)]
    pub(crate) fn horizontal_squared(&self) -> Lanes<S> {
        let [x, y, _] = self.across;
        x.times_plus(x, y * y)
    }
}
