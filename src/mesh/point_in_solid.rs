//! How deep a point lies inside a closed surface.
//!
//! Depth is the distance to the surface. Which side a point is on is asked twice: the normal at the nearest place, cheap
//! and wrong near sharp edges and holes, picks out who may be inside; the winding number (the solid angle of all triangles
//! seen from the point over 4 pi; Jacobson et al., "Robust Inside-Outside Segmentation using Generalized Winding
//! Numbers", 2013) decides. It needs no closed mesh: eyes and mouths of bodies are open. Triangles face outwards.

use crate::math::Vec3;
use crate::mesh::PointIndex;
use crate::mesh::triangle_bvh::TriangleBvh;
use rayon::prelude::*;

/// A surface that has an inside.
pub struct Solid<'a> {
    points: &'a [Vec3],
    triangles: &'a [[PointIndex; 3]],
    tree: TriangleBvh,
    normals: Vec<Vec3>,
}

/// Winding number from which a point counts as inside.
const INSIDE: f64 = 0.5;

impl<'a> Solid<'a> {
    /// Of `triangles` between `points` [m].
    pub fn new(points: &'a [Vec3], triangles: &'a [[PointIndex; 3]]) -> Self {
        let tree = TriangleBvh::new(points, triangles, 0.0);
        Self { points, triangles, tree, normals: point_normals(points, triangles) }
    }

    /// Outward unit normals, one per point.
    pub fn normals(&self) -> &[Vec3] {
        &self.normals
    }

    /// Depth of each of `places` [m]; 0 for those outside, and for those deeper than `most`.
    pub fn depths(&self, places: &[Vec3], most: f64) -> Vec<f64> {
        places.par_iter().map(|place| self.depth(place, most)).collect()
    }

    fn depth(&self, place: &Vec3, most: f64) -> f64 {
        let Some(nearest) = self.tree.nearest(self.points, *place, most) else { return 0.0 };
        let corners = self.triangles[nearest.triangle as usize].map(PointIndex::at);
        let weights = nearest.gap.weights;
        let (mut at, mut normal) = (Vec3::zeros(), Vec3::zeros());
        for (corner, weight) in corners.iter().zip(&weights[1..]) {
            at -= self.points[*corner] * *weight;
            normal -= self.normals[*corner] * *weight;
        }
        let behind = (place - at).dot(&normal) < 0.0;
        if behind && self.winding(place) > INSIDE { nearest.gap.distance } else { 0.0 }
    }

    /// Winding number at `place`: Van Oosterom, Strackee, "The Solid Angle of a Plane Triangle" (1983).
    pub fn winding(&self, place: &Vec3) -> f64 {
        let angle = |t: &[PointIndex; 3]| {
            let [a, b, c] = t.map(|p| self.points[p.at()] - place);
            let (la, lb, lc) = (a.norm(), b.norm(), c.norm());
            let above = a.dot(&b.cross(&c));
            let below = la * lb * lc + a.dot(&b) * lc + b.dot(&c) * la + c.dot(&a) * lb;
            2.0 * above.atan2(below)
        };
        self.triangles.iter().map(angle).sum::<f64>() / (4.0 * std::f64::consts::PI)
    }
}

/// Unit normals of points, by the area of the triangles around; up where there is none.
pub fn point_normals(points: &[Vec3], triangles: &[[PointIndex; 3]]) -> Vec<Vec3> {
    let mut normals = vec![Vec3::zeros(); points.len()];
    for t in triangles {
        let [a, b, c] = t.map(|p| points[p.at()]);
        let area = (b - a).cross(&(c - a));
        t.iter().for_each(|p| normals[p.at()] += area);
    }
    normals.iter().map(|n| n.try_normalize(0.0).unwrap_or_else(Vec3::y)).collect()
}

/// Per point: a third of the triangles around it [m²].
pub fn point_areas(points: &[Vec3], triangles: &[[PointIndex; 3]]) -> Vec<f64> {
    let mut areas = vec![0.0; points.len()];
    for t in triangles {
        let [a, b, c] = t.map(|p| points[p.at()]);
        t.iter().for_each(|p| areas[p.at()] += (b - a).cross(&(c - a)).norm() / 6.0);
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
        let places = [Vec3::repeat(0.1), Vec3::repeat(-0.1), Vec3::repeat(0.4), Vec3::new(0.2, 0.3, 0.25)];
        let depths = solid.depths(&places, 1.0);
        assert!((depths[0] - 0.1).abs() < 1e-15, "{depths:?}");
        assert_eq!(depths[1..3], [0.0, 0.0]);
        assert!((depths[3] - 0.25 / 3f64.sqrt()).abs() < 1e-15, "to the slanting face: {depths:?}");
        assert_eq!(solid.depths(&places, 0.05)[0], 0.0, "deeper than asked for");
        assert!((solid.winding(&places[0]) - 1.0).abs() < 1e-12);
        assert!(solid.winding(&places[1]).abs() < 1e-12);
    }
}
