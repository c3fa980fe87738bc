//! The stretch of a plane piece of cloth, as a symmetric matrix over its own axes.

use crate::math::{Vec2, Vec3};
use serde::{Deserialize, Serialize};

/// Symmetric stretch of a plane: the right stretch tensor of its polar decomposition.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct PlaneStretch {
    /// Components along the first axis, mixed, and along the second [-].
    components: [f64; 3],
}

impl PlaneStretch {
    /// The stretch of the map that takes the unit vectors along the axes of a plane to `u` and `v` [-], its principal values limited to
    /// 1 - `max_strain` .. 1 + `max_strain`.
    pub fn of_axes(u: &Vec3, v: &Vec3, max_strain: f64) -> Self {
        let [uu, uv, vv] = [u.norm_squared(), u.dot(v), v.norm_squared()];
        let (mean, half) = (0.5 * (uu + vv), (0.5 * (uu - vv)).hypot(uv));
        let squares = [mean + half, mean - half];
        let [first, second] =
            squares.map(|square| square.max(0.0).sqrt().clamp(1.0 - max_strain, 1.0 + max_strain));
        // The matrix with the same axes and these values: factor * C + rest * identity.
        let factor = if half > 0.0 { (first - second) / (2.0 * half) } else { 0.0 };
        let rest = first - factor * squares[0];
        Self { components: [factor * uu + rest, factor * uv, factor * vv + rest] }
    }

    /// Ratio of an area after the stretch to the one before [-].
    pub fn area_ratio(&self) -> f64 {
        let [uu, uv, vv] = self.components;
        uu * vv - uv * uv
    }

    /// Root mean square of the two principal strains [-].
    pub fn rms_strain(&self) -> f64 {
        let [uu, uv, vv] = self.components;
        (0.5 * ((uu - 1.0).powi(2) + (vv - 1.0).powi(2)) + uv * uv).sqrt()
    }

    /// Returns the product of its inverse with `vector`.
    pub fn unstretched(&self, vector: Vec2) -> Vec2 {
        let [uu, uv, vv] = self.components;
        Vec2::new(vv * vector.x - uv * vector.y, uu * vector.y - uv * vector.x) / self.area_ratio()
    }

    /// Whether all principal values are positive.
    pub fn is_positive(&self) -> bool {
        self.area_ratio() > 0.0 && self.components[0] > 0.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_rotated_stretch_is_found_and_limited() {
        // 1.1 along (0.6, 0.8) and 0.7 across it, then a rotation in space.
        let (along, across) = (Vec2::new(0.6, 0.8), Vec2::new(-0.8, 0.6));
        let rotation = nalgebra::Rotation3::from_euler_angles(0.3, -1.1, 2.0);
        let image = |axis: Vec2| {
            let stretched = along * (1.1 * along.dot(&axis)) + across * (0.7 * across.dot(&axis));
            rotation * Vec3::new(stretched.x, stretched.y, 0.0)
        };
        let (u, v) = (image(Vec2::x()), image(Vec2::y()));
        let free = PlaneStretch::of_axes(&u, &v, 0.5);
        assert!((free.area_ratio() - 0.77).abs() < 1e-12 && free.is_positive());
        assert!((free.unstretched(along) - along / 1.1).norm() < 1e-12);
        assert!((free.unstretched(across) - across / 0.7).norm() < 1e-12);
        let limited = PlaneStretch::of_axes(&u, &v, 0.2);
        assert!((limited.unstretched(across) - across / 0.8).norm() < 1e-12);
        assert!((limited.area_ratio() - 0.88).abs() < 1e-12);
        assert!((free.rms_strain() - (0.05f64).sqrt()).abs() < 1e-12, "0.1 and -0.3");
        assert_eq!(PlaneStretch::of_axes(&Vec3::x(), &Vec3::y(), 0.2).area_ratio(), 1.0);
        assert!(
            (PlaneStretch::of_axes(&Vec3::zeros(), &Vec3::zeros(), 0.2).area_ratio() - 0.64).abs() < 1e-12
        );
    }
}
