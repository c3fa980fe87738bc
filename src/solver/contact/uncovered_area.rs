//! Uncovered area: the part of the cloth that nothing covers from above, projected onto the ground.

use crate::contact::tuning::TUNING;
use crease_geometry::math::Vec3;
use crease_geometry::mesh::PointIndex;
use crease_geometry::mesh::triangle_bvh::TriangleBvh;
use rayon::prelude::*;

/// Computes uncovered areas; the last result is kept, because steps of a hold ask for the same positions again.
pub(super) struct UncoveredArea {
    triangles: Vec<[PointIndex; 3]>,
    bvh: TriangleBvh,
    last: Option<CachedArea>,
}

/// Areas [m²], one per point, and the positions [m] they belong to.
struct CachedArea {
    x: Vec<Vec3>,
    area: Vec<f64>,
}

impl UncoveredArea {
    /// Uncovered areas of a mesh of `triangles`, at first at `x` [m].
    pub fn new(x: &[Vec3], triangles: &[[PointIndex; 3]]) -> Self {
        Self { triangles: triangles.to_vec(), bvh: TriangleBvh::new(x, triangles, 0.0), last: None }
    }

    /// Returns the uncovered area of each point at `x` [m²].
    pub fn at(&mut self, x: &[Vec3]) -> Vec<f64> {
        if let Some(last) = self.last.as_ref().filter(|last| last.x == x) {
            return last.area.clone();
        }
        let area = self.compute(x);
        self.last = Some(CachedArea { x: x.to_vec(), area: area.clone() });
        area
    }

    fn compute(&mut self, x: &[Vec3]) -> Vec<f64> {
        self.bvh.refit(x, x, 0.0);
        let (offset, height) = (TUNING.search.upward_ray_offset, TUNING.search.max_cover_height);
        let projected: Vec<f64> = self
            .triangles
            .par_iter()
            .map(|t| {
                let [a, b, c] = t.map(|p| x[p.at()]);
                let origin = (a + b + c) / 3.0 + Vec3::y() * offset;
                let projected = 0.5 * ((b - a).cross(&(c - a))).y.abs();
                if self.bvh.any_hit(x, origin, Vec3::y(), height) { 0.0 } else { projected }
            })
            .collect();
        let mut area = vec![0.0; x.len()];
        for (t, projected) in self.triangles.iter().zip(projected) {
            t.iter().for_each(|p| area[p.at()] += projected / 3.0);
        }
        area
    }
}
