//! Shapes of collision objects.

/// Shape for collision checks, in its own frame.
#[derive(Debug, Clone, PartialEq)]
pub enum Shape {
    /// Box about its centre.
    Box {
        /// Half of each edge length (m).
        half: [f64; 3],
    },
    /// Union of boxes, such as a box with openings, see [`box_with_openings`](super::box_with_openings).
    Boxes {
        /// The boxes.
        boxes: Vec<AxisAlignedBox>,
    },
    /// Cylinder about its centre, axis along z.
    Cylinder {
        /// Radius (m).
        radius: f64,
        /// Half of its height (m).
        half_height: f64,
    },
    /// All points within a radius of a line segment.
    Capsule {
        /// Ends of the segment (m).
        ends: [[f64; 3]; 2],
        /// Radius (m).
        radius: f64,
    },
    /// Convex hull of points.
    Convex {
        /// Points (m).
        points: Vec<[f64; 3]>,
    },
    /// Triangle mesh.
    Mesh {
        /// Vertices (m).
        vertices: Vec<[f64; 3]>,
        /// Vertices of each triangle, by index.
        triangles: Vec<[u32; 3]>,
    },
}

/// Box with edges along the axes of its frame.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct AxisAlignedBox {
    /// Minimum corner (m).
    pub min: [f64; 3],
    /// Maximum corner (m).
    pub max: [f64; 3],
}

impl AxisAlignedBox {
    /// Centre (m).
    #[must_use]
    pub fn center(&self) -> [f64; 3] {
        std::array::from_fn(|k| 0.5 * (self.min[k] + self.max[k]))
    }

    /// Half of each edge length (m).
    #[must_use]
    pub fn half(&self) -> [f64; 3] {
        std::array::from_fn(|k| 0.5 * (self.max[k] - self.min[k]))
    }

    /// Volume (m³).
    #[must_use]
    pub fn volume(&self) -> f64 {
        (0..3).map(|k| self.max[k] - self.min[k]).product()
    }
}
