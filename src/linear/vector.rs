//! Aliases of vectors and blocks.

/// Unknowns of one point.
pub(crate) type Vec3 = nalgebra::Vector3<f64>;
/// Block of a matrix: rows of one point, columns of another.
pub(crate) type Mat3 = nalgebra::Matrix3<f64>;

/// Returns the scalar product of two lists of vectors, one entry per point.
pub(crate) fn dot(a: &[Vec3], b: &[Vec3]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a.dot(b)).sum()
}
