//! Shapes of collision objects.

/// Shape for collision checks, in its own frame.
#[derive(Debug, Clone, PartialEq)]
pub enum Shape {
    /// Box about its centre.
    Box {
        /// Half of each edge length (m).
        half: [f64; 3],
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
