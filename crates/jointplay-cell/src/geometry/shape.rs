//! Shapes of collision objects.

/// A shape for collision checks, in a frame of its own.
#[derive(Debug, Clone, PartialEq)]
pub enum Shape {
    /// A box about its centre, half its sides [m].
    Box {
        /// Half of each side [m].
        half: [f64; 3],
    },
    /// An upright cylinder about its centre.
    Cylinder {
        /// Radius [m].
        radius: f64,
        /// Half of its height [m].
        half_height: f64,
    },
    /// All points no farther from a segment than a radius.
    Capsule {
        /// Ends of the segment [m].
        ends: [[f64; 3]; 2],
        /// Radius [m].
        radius: f64,
    },
    /// The least convex body about points.
    Convex {
        /// The points [m].
        points: Vec<[f64; 3]>,
    },
    /// A surface of triangles.
    Mesh {
        /// Corners [m].
        vertices: Vec<[f64; 3]>,
        /// Three corners each.
        triangles: Vec<[u32; 3]>,
    },
}
