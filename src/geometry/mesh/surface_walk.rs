//! Search along a surface: from triangle to neighbour, so that layers in one place are never taken for one another.

use crate::math::Vec3;
use crate::mesh::PointIndex;
use crate::mesh::distance::point_triangle_squared;
use crate::mesh::triangle::corners;

/// Neighbours of the triangles of a surface.
#[derive(Debug)]
pub struct SurfaceWalk {
    /// Per triangle: itself and all that have a point in common with it, sorted.
    rings: Vec<Vec<u32>>,
}

impl SurfaceWalk {
    /// The neighbours of `triangles` over `point_count` points.
    pub fn new(point_count: usize, triangles: &[[PointIndex; 3]]) -> Self {
        let mut around = vec![Vec::new(); point_count];
        for (f, t) in triangles.iter().enumerate() {
            t.iter().for_each(|p| around[p.at()].push(f as u32));
        }
        let ring = |t: &[PointIndex; 3]| {
            let mut near: Vec<u32> = t.iter().flat_map(|p| around[p.at()].iter().copied()).collect();
            near.sort_unstable();
            near.dedup();
            near
        };
        Self { rings: triangles.iter().map(ring).collect() }
    }

    /// Triangle `f` and all that have a point in common with it, sorted.
    pub fn around(&self, f: u32) -> &[u32] {
        &self.rings[f as usize]
    }

    /// The triangle closest to `x` [m] that is reached from `start` over ever closer neighbours; `points` and `triangles` are those of
    /// the surface.
    pub fn closest(&self, points: &[Vec3], triangles: &[[PointIndex; 3]], start: u32, x: &Vec3) -> u32 {
        let [a, b, c] = corners(points, &triangles[start as usize]);
        let mut best = (point_triangle_squared(x, &a, &b, &c), start);
        while best.0 > 0.0 {
            match self.nearest_around(points, triangles, &[best.1], x) {
                Some(next) if next.0 < best.0 => best = next,
                _ => break,
            }
        }
        best.1
    }

    /// Of the triangles `faces` and their neighbours the one closest to `x` [m], with its squared distance [m²].
    pub fn nearest_around(
        &self,
        points: &[Vec3],
        triangles: &[[PointIndex; 3]],
        faces: &[u32],
        x: &Vec3,
    ) -> Option<(f64, u32)> {
        let near = faces.iter().flat_map(|f| &self.rings[*f as usize]).map(|&g| {
            let [a, b, c] = corners(points, &triangles[g as usize]);
            (point_triangle_squared(x, &a, &b, &c), g)
        });
        near.min_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)))
    }
}
