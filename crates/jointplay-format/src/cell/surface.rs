//! Surfaces of triangles.

/// Largest number of triangles of a shape; a check evaluates distances about a thousand times per second of motion.
pub const MAX_TRIANGLES: usize = 500_000;

/// A surface in the unit of its file.
pub(super) struct Mesh {
    pub(super) vertices: Vec<[f64; 3]>,
    pub(super) triangles: Vec<[u32; 3]>,
}

/// The reason why a file with too many triangles is refused.
pub(super) fn too_many() -> String {
    format!("it has more than {MAX_TRIANGLES} triangles; simplify the shape")
}
