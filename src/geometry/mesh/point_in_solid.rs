//! Depth of points inside a closed surface, and normals and areas of its points.
//!
//! Depth is the distance to the surface. The side is decided in two stages: the normal at the nearest position, cheap
//! and wrong near sharp edges and holes, selects the points that may be inside; the winding number (the solid angle of all triangles
//! seen from the point over 4 pi; Jacobson et al., "Robust Inside-Outside Segmentation using Generalized Winding
//! Numbers", 2013) decides. It needs no closed mesh: eyes and mouths of bodies are open. Triangles face outwards.

use crate::math::Vec3;
use crate::mesh::triangle_bvh::TriangleBvh;
use crate::mesh::tuning::TUNING;
use crate::mesh::{PointIndex, triangle};
use rayon::prelude::*;

/// A closed surface.
pub struct Solid<'a> {
    points: &'a [Vec3],
    triangles: &'a [[PointIndex; 3]],
    bvh: TriangleBvh,
    normals: Vec<Vec3>,
}

impl<'a> Solid<'a> {
    /// A surface of `triangles` between `points` [m].
    pub fn new(points: &'a [Vec3], triangles: &'a [[PointIndex; 3]]) -> Self {
        let bvh = TriangleBvh::new(points, triangles, 0.0);
        Self { points, triangles, bvh, normals: point_normals(points, triangles) }
    }

    /// Outward unit normals, one per point.
    pub fn normals(&self) -> &[Vec3] {
        &self.normals
    }

    /// Returns the depth of each of `positions` [m]; 0 for those outside, and for those deeper than `max_depth` [m].
    pub fn depths(&self, positions: &[Vec3], max_depth: f64) -> Vec<f64> {
        positions.par_iter().map(|position| self.depth(position, max_depth)).collect()
    }

    fn depth(&self, position: &Vec3, max_depth: f64) -> f64 {
        let Some(nearest) = self.bvh.nearest(self.points, *position, max_depth) else { return 0.0 };
        let corners = self.triangles[nearest.triangle as usize].map(PointIndex::at);
        let weights = nearest.weights();
        let (mut at, mut normal) = (Vec3::zeros(), Vec3::zeros());
        for (corner, weight) in corners.iter().zip(weights) {
            at += self.points[*corner] * weight;
            normal += self.normals[*corner] * weight;
        }
        let behind = (position - at).dot(&normal) < 0.0;
        if behind && self.winding(position) > TUNING.min_inside_winding {
            nearest.closest.distance
        } else {
            0.0
        }
    }

    /// Returns the winding number at `position` [m]: Van Oosterom, Strackee, "The Solid Angle of a Plane Triangle" (1983).
    pub fn winding(&self, position: &Vec3) -> f64 {
        let angle = |t: &[PointIndex; 3]| {
            let [a, b, c] = t.map(|p| self.points[p.at()] - position);
            let (la, lb, lc) = (a.norm(), b.norm(), c.norm());
            let above = a.dot(&b.cross(&c));
            let below = la * lb * lc + a.dot(&b) * lc + b.dot(&c) * la + c.dot(&a) * lb;
            2.0 * above.atan2(below)
        };
        self.triangles.iter().map(angle).sum::<f64>() / (4.0 * std::f64::consts::PI)
    }
}

/// Returns unit normals of points, weighted by the areas of the triangles around; up where there is none.
pub fn point_normals(points: &[Vec3], triangles: &[[PointIndex; 3]]) -> Vec<Vec3> {
    let mut normals = vec![Vec3::zeros(); points.len()];
    for t in triangles {
        let area = triangle::area_vector(&triangle::corners(points, t));
        t.iter().for_each(|p| normals[p.at()] += area);
    }
    normals.iter().map(|n| n.try_normalize(0.0).unwrap_or_else(Vec3::y)).collect()
}

/// Returns the area of each point: a third of the triangles around it [m²].
pub fn point_areas(points: &[Vec3], triangles: &[[PointIndex; 3]]) -> Vec<f64> {
    let mut areas = vec![0.0; points.len()];
    for t in triangles {
        let area = triangle::area_vector(&triangle::corners(points, t)).norm() / 6.0;
        t.iter().for_each(|p| areas[p.at()] += area);
    }
    areas
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A tetrahedron with its corners on the axes and at the origin, faces outwards.
    #[test]
    fn inside_and_outside_of_a_corner() {
        let points = [Vec3::zeros(), Vec3::x(), Vec3::y(), Vec3::z()];
        let faces = [[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]].map(|t| t.map(PointIndex));
        let solid = Solid::new(&points, &faces);
        let positions = [Vec3::repeat(0.1), Vec3::repeat(-0.1), Vec3::repeat(0.4), Vec3::new(0.2, 0.3, 0.25)];
        let depths = solid.depths(&positions, 1.0);
        assert!((depths[0] - 0.1).abs() < 1e-15, "{depths:?}");
        assert_eq!(depths[1..3], [0.0, 0.0]);
        assert!((depths[3] - 0.25 / 3f64.sqrt()).abs() < 1e-15, "to the slanting face: {depths:?}");
        assert_eq!(solid.depths(&positions, 0.05)[0], 0.0, "deeper than asked for");
        assert!((solid.winding(&positions[0]) - 1.0).abs() < 1e-12);
        assert!(solid.winding(&positions[1]).abs() < 1e-12);
    }
}
