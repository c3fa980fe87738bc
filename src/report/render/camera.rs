//! Camera of a picture, chosen from the garment or set by azimuth and elevation.
//!
//! A lying garment is seen from 35 degrees above with its lower end towards the camera, an upright one from the front. The
//! perspective is weak, so that sizes can be compared.

use crease_geometry::math::{Vec2, Vec3};

/// Camera; angles that are `None` are chosen from the garment.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Camera {
    /// Azimuth around the vertical [degrees]: 0 is at +z, 90 at +x.
    pub azimuth_deg: Option<f64>,
    /// Elevation above the horizon [degrees], -90 to 90.
    pub elevation_deg: Option<f64>,
    /// Distance of the camera in radii of the garment, at least 1.5; infinite without perspective.
    pub distance: f64,
    /// Part of the garment that fills the picture; the whole of it if `None`.
    pub focus: Option<Focus>,
}

/// A ball around a part of the garment.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Focus {
    /// Its middle [m].
    pub centre: Vec3,
    /// Its radius [m].
    pub radius: f64,
}

/// Direction of the camera by name.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum CameraView {
    /// In front of the garment.
    Front,
    /// Behind it.
    Back,
    /// On the garment's left side.
    Left,
    /// On its right side.
    Right,
    /// Above it.
    Top,
}

impl CameraView {
    /// Returns azimuth and elevation \[degrees\].
    pub fn angles_deg(self) -> [f64; 2] {
        match self {
            Self::Front => [0.0, UPRIGHT_ELEVATION_DEG],
            Self::Back => [180.0, UPRIGHT_ELEVATION_DEG],
            Self::Left => [90.0, UPRIGHT_ELEVATION_DEG],
            Self::Right => [-90.0, UPRIGHT_ELEVATION_DEG],
            Self::Top => [0.0, 90.0],
        }
    }
}

impl Default for Camera {
    fn default() -> Self {
        Self { azimuth_deg: None, elevation_deg: None, distance: 6.0, focus: None }
    }
}

/// Elevation for a lying garment [degrees].
const LYING_ELEVATION_DEG: f64 = 35.0;
/// Elevation for an upright garment [degrees].
const UPRIGHT_ELEVATION_DEG: f64 = 8.0;
/// Maximum height of what is viewed from above as a fraction of the longer side of its footprint [-].
const MAX_HEIGHT_FRACTION_FROM_ABOVE: f64 = 0.35;
/// Margin around the garment as a fraction of the picture [-].
const MARGIN_FRACTION: f64 = 0.06;

/// Whether a worn garment whose bounding box has the sides `size` [m] is viewed from above: one that is spread out, a stack of
/// folds or a roll, whereas what stands or hangs is viewed from the side.
pub(in crate::report) fn is_viewed_from_above(size: &Vec3) -> bool {
    size.y < MAX_HEIGHT_FRACTION_FROM_ABOVE * size.x.max(size.z)
}

/// Projection from the world to pixels.
#[derive(Debug, Clone)]
pub(super) struct Projection {
    /// Unit vector to the right of the picture.
    pub right: Vec3,
    /// Unit vector to the top of the picture.
    pub up: Vec3,
    /// Unit vector towards the camera.
    pub toward: Vec3,
    /// Centre of the garment [m].
    centre: Vec3,
    /// Height of the ground: the lowest point of the garment [m].
    pub ground: f64,
    /// Whether the ground is in the picture: a close view is of the garment alone.
    has_ground: bool,
    /// Radius of the garment [m].
    pub radius: f64,
    /// Inverse distance of the camera from the centre [1/m]; 0 without perspective.
    inverse_distance: f64,
    /// Pixels per metre at the centre.
    pub scale: f64,
    /// Position of the centre [pixels].
    origin: Vec2,
}

/// A visible point of the ground.
#[derive(Debug, Clone, Copy)]
pub(super) struct GroundPoint {
    /// Position [m].
    pub point: Vec3,
    /// Distance from the centre of the garment towards the camera [m].
    pub depth: f64,
}

impl Camera {
    /// Returns azimuth and elevation for a garment of these bounds [degrees].
    fn angles(&self, low: Vec3, high: Vec3) -> [f64; 2] {
        let size = high - low;
        let lying = is_viewed_from_above(&size);
        let elevation = if lying { LYING_ELEVATION_DEG } else { UPRIGHT_ELEVATION_DEG };
        let given = |angle: Option<f64>, own: f64| angle.filter(|a| a.is_finite()).unwrap_or(own);
        [given(self.azimuth_deg, 0.0), given(self.elevation_deg, elevation).clamp(-90.0, 90.0)]
    }

    /// Returns the projection with which `points` fill a picture of `size` pixels.
    pub(super) fn aim(&self, points: &[Vec3], size: [usize; 2]) -> Projection {
        let mut low = points.first().copied().unwrap_or_else(Vec3::zeros);
        let mut high = low;
        for p in points {
            (low, high) = (low.inf(p), high.sup(p));
        }
        let [azimuth, elevation] = self.angles(low, high).map(f64::to_radians);
        let toward = direction(azimuth, elevation);
        let right = Vec3::new(azimuth.cos(), 0.0, -azimuth.sin());
        let radius = (0.5 * (high - low).norm()).max(1e-9);
        let distance = if self.distance >= 1.5 { self.distance } else { 1.5 };
        let mut projection = Projection {
            right,
            up: toward.cross(&right),
            toward,
            centre: low + 0.5 * (high - low),
            ground: low.y,
            has_ground: self.focus.is_none(),
            radius,
            inverse_distance: 1.0 / (distance * radius),
            scale: 1.0,
            origin: Vec2::zeros(),
        };
        let near = |focus: Focus| -> Vec<Vec3> {
            points.iter().filter(|p| (*p - focus.centre).norm() <= focus.radius).copied().collect()
        };
        let focus = self.focus.map(near).filter(|near| !near.is_empty());
        projection.fit(focus.as_deref().unwrap_or(points), size);
        projection
    }

    /// Returns the unit vector towards the camera that looks at `points`.
    pub fn toward(&self, points: &[Vec3]) -> Vec3 {
        let first = points.first().copied().unwrap_or_else(Vec3::zeros);
        let (low, high) = points.iter().fold((first, first), |(low, high), p| (low.inf(p), high.sup(p)));
        let [azimuth, elevation] = self.angles(low, high).map(f64::to_radians);
        direction(azimuth, elevation)
    }
}

/// Returns the unit vector at these angles [rad].
fn direction(azimuth: f64, elevation: f64) -> Vec3 {
    Vec3::new(azimuth.sin() * elevation.cos(), elevation.sin(), azimuth.cos() * elevation.cos())
}

impl Projection {
    /// Sets scale and origin so that all `points` are in the picture.
    fn fit(&mut self, points: &[Vec3], size: [usize; 2]) {
        let mut low = Vec2::repeat(f64::INFINITY);
        let mut high = -low;
        for p in points {
            let s = self.project(*p);
            (low, high) = (low.inf(&s.xy()), high.sup(&s.xy()));
        }
        let size = Vec2::new(size[0] as f64, size[1] as f64);
        if points.is_empty() {
            (low, high) = (Vec2::zeros(), Vec2::zeros());
        }
        let extent = (high - low).sup(&Vec2::repeat(1e-6 * self.radius));
        let available = size * (1.0 - 2.0 * MARGIN_FRACTION);
        self.scale = (available.x / extent.x).min(available.y / extent.y);
        self.origin = 0.5 * size - self.scale * 0.5 * (low + high);
    }

    /// Returns the pixel position (x to the right, y down) and the nearness, which increases towards the camera and is linear
    /// across a triangle on screen.
    pub fn project(&self, p: Vec3) -> Vec3 {
        let d = p - self.centre;
        let z = d.dot(&self.toward);
        let nearness = 1.0 / (1.0 - z * self.inverse_distance);
        let on_screen = self.scale * nearness * Vec2::new(d.dot(&self.right), -d.dot(&self.up)) + self.origin;
        // Without perspective nearness is constant and depth is used instead, as in first-order perspective.
        let order = if self.inverse_distance > 0.0 { nearness } else { 1.0 + z / self.radius };
        Vec3::new(on_screen.x, on_screen.y, order)
    }

    /// Returns the distance from the centre towards the camera for this nearness [m].
    pub fn depth(&self, nearness: f64) -> f64 {
        if self.inverse_distance > 0.0 {
            (1.0 - 1.0 / nearness) / self.inverse_distance
        } else {
            (nearness - 1.0) * self.radius
        }
    }

    /// Returns the weight of a corner with this nearness in perspective-correct interpolation.
    pub fn perspective_weight(&self, nearness: f64) -> f64 {
        if self.inverse_distance > 0.0 { nearness } else { 1.0 }
    }

    /// Returns the point of the ground seen at `pixel`; `None` above the horizon.
    pub fn ground_at(&self, pixel: Vec2) -> Option<GroundPoint> {
        if !self.has_ground {
            return None;
        }
        let flat = (pixel - self.origin) / self.scale;
        let across = flat.x * self.right - flat.y * self.up;
        // Points on the ray: centre + across + depth * (toward - across / distance).
        let slope = self.toward - across * self.inverse_distance;
        let start = self.centre + across;
        if slope.y < 0.05 {
            return None;
        }
        let depth = (self.ground - start.y) / slope.y;
        Some(GroundPoint { point: start + depth * slope, depth })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn box_corners(x: f64, y: f64, z: f64) -> Vec<Vec3> {
        (0..8).map(|i| Vec3::new((i & 1) as f64 * x, (i >> 1 & 1) as f64 * y, (i >> 2) as f64 * z)).collect()
    }

    #[test]
    fn lying_garments_are_seen_from_above_and_upright_ones_from_the_front() {
        let lying = Camera::default().aim(&box_corners(0.9, 0.01, 0.7), [100, 100]);
        assert!((lying.toward.y - 35f64.to_radians().sin()).abs() < 1e-12);
        let upright = Camera::default().aim(&box_corners(0.9, 0.7, 0.2), [100, 100]);
        assert!(upright.toward.z > 0.98 && upright.toward.y > 0.0);
    }

    #[test]
    fn all_points_are_in_the_picture_and_touch_its_margin() {
        for distance in [6.0, f64::INFINITY] {
            let points = box_corners(0.9, 0.3, 0.7);
            let camera = Camera { azimuth_deg: Some(30.0), elevation_deg: Some(20.0), distance, focus: None };
            let projection = camera.aim(&points, [400, 300]);
            let seen: Vec<Vec3> = points.iter().map(|&p| projection.project(p)).collect();
            assert!(seen.iter().all(|s| s.x > 0.0 && s.x < 400.0 && s.y > 0.0 && s.y < 300.0));
            let low = seen.iter().map(|s| s.x).fold(f64::MAX, f64::min);
            let top = seen.iter().map(|s| s.y).fold(f64::MAX, f64::min);
            assert!((low - 24.0).abs() < 1e-9 || (top - 18.0).abs() < 1e-9, "{low} {top}");
        }
    }

    /// A mirrored picture would still look like a garment.
    #[test]
    fn axes_are_not_mirrored() {
        for distance in [6.0, f64::INFINITY] {
            let camera = Camera { azimuth_deg: Some(0.0), elevation_deg: Some(35.0), distance, focus: None };
            let projection = camera.aim(&box_corners(1.0, 1.0, 1.0), [100, 100]);
            let [o, x, y, z] =
                [Vec3::zeros(), Vec3::x(), Vec3::y(), Vec3::z()].map(|p| projection.project(p));
            assert!(x.x > o.x && y.y < o.y && z.y > o.y && z.z > o.z && y.z > o.z);
        }
    }

    #[test]
    fn ground_and_projection_agree() {
        for distance in [6.0, f64::INFINITY] {
            let camera = Camera { azimuth_deg: Some(25.0), elevation_deg: Some(35.0), distance, focus: None };
            let projection = camera.aim(&box_corners(1.0, 0.5, 1.0), [200, 200]);
            let p = Vec3::new(0.3, 0.0, 0.8);
            let s = projection.project(p);
            let GroundPoint { point, depth } = projection.ground_at(s.xy()).unwrap();
            assert!((p - point).norm() < 1e-9, "{point}");
            assert!((projection.depth(s.z) - depth).abs() < 1e-9);
        }
    }
}
