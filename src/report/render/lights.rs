//! Lights of a picture: a key light, a grazing light that makes wrinkles visible, and the sky.

use crate::report::render::camera::Projection;
use crease_geometry::math::Vec3;

/// Angle between the grazing light and the surface that faces the camera [degrees].
const GRAZING_DEG: f64 = 16.0;
/// Unit vectors towards the lights.
pub(super) struct Lights {
    key: Vec3,
    grazing: Vec3,
}

impl Lights {
    /// Places the lights for a surface with these `normals`. The key light is above the camera. The grazing light comes from
    /// the left, at a small angle to the surface that mostly faces the camera, which suits lying and standing garments
    /// alike. On opposite sides one light would fill the shades of the other, and small wrinkles would vanish.
    pub fn new(normals: &[Vec3], projection: &Projection) -> Self {
        let facing: Vec3 = normals.iter().map(|n| n * n.dot(&projection.toward).signum()).sum();
        let facing = facing.try_normalize(0.0).unwrap_or(projection.toward);
        let side = 0.4 * projection.up - projection.right;
        let along = (side - facing * facing.dot(&side)).try_normalize(1e-9).unwrap_or(-projection.right);
        let (sin, cos) = GRAZING_DEG.to_radians().sin_cos();
        Self {
            key: (projection.toward - 0.2 * projection.right + 0.8 * projection.up).normalize(),
            grazing: cos * along + sin * facing,
        }
    }

    /// Returns the light on a surface with this normal: about 1 where both lights reach it.
    pub fn on(&self, normal: Vec3) -> f64 {
        let sky = 0.5 + 0.5 * normal.y;
        // Light slightly beyond the terminator, as from an extended source.
        let wrap = |d: f64| ((d + 0.15) / 1.15).max(0.0);
        0.12 + 0.15 * sky + 0.38 * wrap(normal.dot(&self.key)) + 1.15 * normal.dot(&self.grazing).max(0.0)
    }
}
