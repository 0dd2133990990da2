//! The projection from the mechanism's space onto the page.

use nalgebra::Vector3;

use super::view::View;

/// An orthographic projection onto the page.
pub(super) struct Camera {
    frame: [Vector3<f64>; 3],
    /// Length of one size (px).
    pub(super) scale: f64,
    /// Position of the mechanism's centre (px).
    middle: (f64, f64),
}

impl Camera {
    /// A projection along a view.
    ///
    /// # Arguments
    /// * `scale` – length of one size of the mechanism (px)
    /// * `middle` – position of the mechanism's centre (px)
    pub(super) fn new(view: View, scale: f64, middle: (f64, f64)) -> Self {
        Self { frame: view.frame(), scale, middle }
    }

    /// Position of a point on the page (px).
    pub(super) fn spot(&self, point: &Vector3<f64>) -> (f64, f64) {
        let [right, up, _] = &self.frame;
        (self.middle.0 + point.dot(right) * self.scale, self.middle.1 - point.dot(up) * self.scale)
    }

    /// Depth of a point: larger is nearer to the eye.
    pub(super) fn depth(&self, point: &Vector3<f64>) -> f64 {
        point.dot(&self.frame[2])
    }

    /// Component of a direction toward the eye.
    pub(super) fn toward(&self, direction: &Vector3<f64>) -> f64 {
        direction.dot(&self.frame[2])
    }

    /// Unit vector on the page square to the image of a direction: a quarter turn, such that bulging ends need one sense only.
    pub(super) fn across(&self, direction: &Vector3<f64>) -> (f64, f64) {
        let (x, y) = (direction.dot(&self.frame[0]), -direction.dot(&self.frame[1]));
        let length = x.hypot(y);
        if length < 1e-9 { (1.0, 0.0) } else { (-y / length, x / length) }
    }
}
