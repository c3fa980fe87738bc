//! The rotation nearest to a matrix, for fits of one set of points to another (Kabsch 1976, Umeyama 1991).

use crate::math::Mat3;

/// Rotation nearest to a matrix.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct NearestRotation {
    /// The rotation; never a reflection.
    pub rotation: Mat3,
    /// Sum of the singular values, the smallest one negative where a reflection would be nearer.
    pub signed_sum: f64,
}

/// Returns the rotation nearest to `mixed`, a sum of b a^T over points a and their images b; `None` if it is not finite.
pub fn nearest_rotation(mixed: Mat3) -> Option<NearestRotation> {
    let svd = mixed.try_svd(true, true, f64::EPSILON, 0)?;
    let (u, v_t) = (svd.u?, svd.v_t?);
    let mut signs = [1.0; 3];
    if (u * v_t).determinant() < 0.0 {
        signs[svd.singular_values.imin()] = -1.0;
    }
    let signs = signs.into();
    let rotation = u * Mat3::from_diagonal(&signs) * v_t;
    rotation
        .iter()
        .all(|x| x.is_finite())
        .then(|| NearestRotation { rotation, signed_sum: svd.singular_values.dot(&signs) })
}
