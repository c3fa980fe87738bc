//! Aliases of vectors and matrices, and the bounding box of points.

/// Point or vector in space [m].
pub type Vec3 = nalgebra::Vector3<f64>;
/// Point or vector in the material plane [m], or a texture coordinate [-].
pub type Vec2 = nalgebra::Vector2<f64>;
/// 3 x 3 matrix.
pub type Mat3 = nalgebra::Matrix3<f64>;
/// 4 x 4 affine transform (column vectors).
pub type Mat4 = nalgebra::Matrix4<f64>;

/// Returns the scalar product of two lists of vectors, one entry per point.
pub fn dot(a: &[Vec3], b: &[Vec3]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a.dot(b)).sum()
}

/// Returns the lowest and highest corner of the bounding box of points [m]; infinite for none.
pub fn bounds(x: &[Vec3]) -> (Vec3, Vec3) {
    x.iter().fold((Vec3::repeat(f64::INFINITY), Vec3::repeat(f64::NEG_INFINITY)), |(low, high), p| {
        (low.inf(p), high.sup(p))
    })
}
