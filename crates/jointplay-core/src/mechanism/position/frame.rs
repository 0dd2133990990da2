//! Frames laid out for wide instructions.

use nalgebra::{Matrix3, Rotation3, Translation3, Vector3, Vector4};

use crate::spatial::Pose;

/// Position and orientation of a frame in the base frame.
///
/// Each axis has a fourth number, zero: four are two pairs, or one wide number, of the processor, and are read as they were written.
#[derive(Debug, Clone, Copy)]
pub(super) struct Frame {
    axes: [Vector4<f64>; 3],
    origin: Vector4<f64>,
}

impl Frame {
    pub(super) const BASE: Self = Self {
        axes: [
            Vector4::new(1.0, 0.0, 0.0, 0.0),
            Vector4::new(0.0, 1.0, 0.0, 0.0),
            Vector4::new(0.0, 0.0, 1.0, 0.0),
        ],
        origin: Vector4::new(0.0, 0.0, 0.0, 0.0),
    };

    pub(super) fn new(rotation: &Matrix3<f64>, origin: &Vector3<f64>) -> Self {
        Self { axes: [0, 1, 2].map(|k| rotation.column(k).push(0.0)), origin: origin.push(0.0) }
    }

    /// One of its axes.
    #[inline(always)]
    pub(super) fn axis(&self, k: usize) -> Vector3<f64> {
        self.axes[k].xyz()
    }

    #[inline(always)]
    pub(super) fn origin(&self) -> Vector3<f64> {
        self.origin.xyz()
    }

    pub(super) fn rotation(&self) -> Matrix3<f64> {
        Matrix3::from_columns(&[self.axis(0), self.axis(1), self.axis(2)])
    }

    pub(super) fn pose(&self) -> Pose {
        let rotation = Rotation3::from_matrix_unchecked(self.rotation());
        Pose::from_parts(Translation3::from(self.origin()), rotation)
    }

    /// A vector of the frame, in the base frame.
    #[inline(always)]
    fn along(&self, x: f64, y: f64, z: f64) -> Vector4<f64> {
        self.axes[0] * x + self.axes[1] * y + self.axes[2] * z
    }

    /// A direction of the frame, in the base frame.
    #[inline(always)]
    pub(super) fn direction(&self, by: &Vector3<f64>) -> Vector3<f64> {
        self.along(by.x, by.y, by.z).xyz()
    }

    /// Moves the origin by a vector of the frame.
    #[inline(always)]
    pub(super) fn shift(&mut self, by: &Vector3<f64>) {
        self.origin += self.along(by.x, by.y, by.z);
    }

    /// The frame that is placed at `by` in this one.
    #[inline(always)]
    pub(super) fn displaced(&self, by: &Self) -> Self {
        // Closures are not always inlined.
        let [x, y, z, origin] = [&by.axes[0], &by.axes[1], &by.axes[2], &by.origin];
        Self {
            axes: [self.along(x.x, x.y, x.z), self.along(y.x, y.y, y.z), self.along(z.x, z.y, z.z)],
            origin: self.origin + self.along(origin.x, origin.y, origin.z),
        }
    }

    /// Turns the axes by a rotation of the frame.
    #[inline(always)]
    pub(super) fn turn(&mut self, by: &Matrix3<f64>) {
        self.axes = [
            self.along(by.m11, by.m21, by.m31),
            self.along(by.m12, by.m22, by.m32),
            self.along(by.m13, by.m23, by.m33),
        ];
    }

    /// Turns the axes about its z.
    #[inline(always)]
    pub(super) fn turn_about_z(&mut self, sine: f64, cosine: f64) {
        let [x, y, _] = self.axes;
        self.axes[0] = x * cosine + y * sine;
        self.axes[1] = y * cosine - x * sine;
    }

    /// Moves the origin along its z.
    #[inline(always)]
    pub(super) fn advance_along_z(&mut self, by: f64) {
        self.origin += self.axes[2] * by;
    }

    /// Moves the origin along a direction of the frame.
    #[inline(always)]
    pub(super) fn advance(&mut self, direction: &Vector3<f64>, by: f64) {
        self.origin += self.along(direction.x, direction.y, direction.z) * by;
    }
}
