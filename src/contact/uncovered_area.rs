//! The part of the cloth that nothing covers from above, as seen from above.

use crate::math::Vec3;
use crate::mesh::PointIndex;
use crate::mesh::triangle_bvh::TriangleBvh;
use rayon::prelude::*;

/// A ray starts this far above the centre of its triangle, so that it does not meet it [m].
const RAY_OFFSET: f64 = 1e-6;
/// Cloth farther above than this does not cover [m].
const MAX_COVER_HEIGHT: f64 = 10.0;

/// Finds uncovered areas; the last answer is kept, because steps of a hold ask for the same positions again.
pub(super) struct UncoveredArea {
    triangles: Vec<[PointIndex; 3]>,
    tree: TriangleBvh,
    last: Option<Answer>,
}

/// An answer and the positions [m] it belongs to.
struct Answer {
    x: Vec<Vec3>,
    /// [m²], one per point.
    area: Vec<f64>,
}

impl UncoveredArea {
    /// For a mesh of `triangles`, at first at `x` [m].
    pub fn new(x: &[Vec3], triangles: &[[PointIndex; 3]]) -> Self {
        Self { triangles: triangles.to_vec(), tree: TriangleBvh::new(x, triangles, 0.0), last: None }
    }

    /// Per point: the uncovered part of its area at `x` [m²], projected onto the ground.
    pub fn at(&mut self, x: &[Vec3]) -> Vec<f64> {
        if let Some(last) = self.last.as_ref().filter(|last| last.x == x) {
            return last.area.clone();
        }
        let area = self.compute(x);
        self.last = Some(Answer { x: x.to_vec(), area: area.clone() });
        area
    }

    fn compute(&mut self, x: &[Vec3]) -> Vec<f64> {
        self.tree.refit(x, x, 0.0);
        let open: Vec<f64> = self
            .triangles
            .par_iter()
            .map(|t| {
                let [a, b, c] = t.map(|p| x[p.at()]);
                let centre = (a + b + c) / 3.0 + Vec3::y() * RAY_OFFSET;
                let shadow = 0.5 * ((b - a).cross(&(c - a))).y.abs();
                if self.tree.any_hit(x, centre, Vec3::y(), MAX_COVER_HEIGHT) { 0.0 } else { shadow }
            })
            .collect();
        let mut area = vec![0.0; x.len()];
        for (t, open) in self.triangles.iter().zip(open) {
            t.iter().for_each(|p| area[p.at()] += open / 3.0);
        }
        area
    }
}
