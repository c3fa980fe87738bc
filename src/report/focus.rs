//! Where the memory of a garment is: the part that a close view shows.
//!
//! Every point counts by its change of rest angle times its area; with seams and hems, whose changes are few but large,
//! limited to a quantile. The ball around a point that holds most, and is seen from the camera, is the focus. A standing
//! garment without a given direction is seen from the side on which its memory is.

use crate::report::GarmentView;
use crate::report::render::{Camera, Focus, is_viewed_from_above};
use crease_geometry::math::{Vec3, bounds};
use crease_geometry::mesh::{PointIndex, triangle};

/// Radius of the focus as a fraction of the radius of the garment [-].
const FOCUS_FRACTION: f64 = 0.4;
/// Cosine of the angle between a normal and the camera from which a part is seen [-].
const MIN_FACING: f64 = 0.25;
/// Fraction of the points whose change counts in full [-].
const COUNTED_FRACTION: f64 = 0.95;
/// Number of candidates for the middle.
const MAX_CANDIDATES: usize = 400;

impl GarmentView {
    /// Returns `camera` with its focus where the memory is; unchanged for a garment without memory.
    pub fn focus_on_memory(&self, camera: &Camera) -> Camera {
        let Some(memory) = &self.memory else { return *camera };
        let mut area = vec![Vec3::zeros(); self.after.len()];
        for t in &self.triangles {
            let corners = t.map(|p| self.after.get(p.at()).copied().unwrap_or_else(Vec3::zeros));
            let vector = triangle::area_vector(&corners) / 3.0;
            t.iter().map(|p: &PointIndex| p.at()).for_each(|p| area[p] += vector);
        }
        let mut changes: Vec<f64> = memory.rest_angle_change_deg.iter().map(|c| c.abs()).collect();
        let mut sorted = changes.clone();
        sorted.sort_unstable_by(f64::total_cmp);
        let limit = sorted.get((COUNTED_FRACTION * sorted.len() as f64) as usize).copied().unwrap_or(0.0);
        if limit <= 0.0 {
            let most = sorted.last().copied().unwrap_or(0.0);
            if most <= 0.0 {
                return *camera;
            }
        } else {
            changes.iter_mut().for_each(|c| *c = c.min(limit));
        }
        let (low, high) = bounds(&self.after);
        let lying = is_viewed_from_above(&(high - low));
        let mut camera = *camera;
        if camera.azimuth_deg.is_none() && !lying {
            let side: Vec3 = area.iter().zip(&changes).map(|(n, c)| n * *c).sum();
            if side.xz().norm() > 0.0 {
                camera.azimuth_deg = Some(side.x.atan2(side.z).to_degrees());
            }
        }
        let toward = camera.toward(&self.after);
        let radius = FOCUS_FRACTION * 0.5 * (high - low).norm();
        let weights: Vec<f64> = area
            .iter()
            .zip(&changes)
            .map(|(n, c)| if n.dot(&toward) > MIN_FACING * n.norm() { c * n.norm() } else { 0.0 })
            .collect();
        camera.focus = self.heaviest_ball(&weights, radius);
        camera
    }

    /// Returns the ball of `radius` around one of the points that holds most of `weights`.
    fn heaviest_ball(&self, weights: &[f64], radius: f64) -> Option<Focus> {
        let heavy: Vec<(Vec3, f64)> =
            self.after.iter().copied().zip(weights.iter().copied()).filter(|(_, w)| *w > 0.0).collect();
        let step = heavy.len().div_ceil(MAX_CANDIDATES).max(1);
        let held = |centre: &Vec3| -> f64 {
            let within = heavy.iter().filter(|(x, _)| (x - centre).norm() < radius);
            // Points in the middle count more, so that the memory is there.
            within.map(|(x, w)| w * (1.0 - (x - centre).norm() / radius)).sum()
        };
        let balls = heavy.iter().step_by(step).map(|(x, _)| (*x, held(x)));
        let best = balls.max_by(|a, b| a.1.total_cmp(&b.1))?;
        Some(Focus { centre: best.0, radius })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::report::PointMemory;
    use crate::report::render::test_shapes::sphere;

    #[test]
    fn the_focus_is_where_the_memory_is() {
        let (points, triangles) = sphere(0.5, 24);
        let at = Vec3::new(0.4, 0.0, -0.3);
        let change = |p: &Vec3| if (p - at).norm() < 0.12 { 40.0 } else { 0.0 };
        let memory = PointMemory {
            rest_angle_change_deg: points.iter().map(change).collect(),
            stiffness_ratio: vec![1.0; points.len()],
            stretch_percent: None,
        };
        let plain = GarmentView::of_shapes("", [points.clone(), points], triangles);
        let view = GarmentView { memory: Some(memory), ..plain };
        let camera = view.focus_on_memory(&Camera::default());
        let focus = camera.focus.unwrap();
        assert!((focus.centre - at).norm() < 0.08, "{}", focus.centre);
        // Azimuth 127 degrees looks at x > 0, z < 0.
        assert!((camera.azimuth_deg.unwrap() - 127.0).abs() < 10.0, "{:?}", camera.azimuth_deg);
        let plain = GarmentView { memory: None, ..view };
        assert_eq!(plain.focus_on_memory(&Camera::default()), Camera::default());
    }
}
