//! Distances from the middle of the creases of a worn surface, searched along the surface.

use crate::remesh::worn_surface::{CreaseEdge, WornSurface};
use crease_geometry::math::Vec3;
use crease_geometry::mesh::distance::{along_edge, point_triangle_squared};
use crease_geometry::mesh::triangle::{self, corners};

/// Creases near every triangle of a worn surface.
#[derive(Debug)]
pub struct CreaseDistances<'a> {
    surface: &'a WornSurface,
    /// Per triangle: the edges of creases that are near it on the surface.
    near: Vec<Vec<u32>>,
    /// Per edge of a crease: its angle [rad].
    angles: Vec<f64>,
}

/// The crease that is closest to a place.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct NearCrease {
    /// Edge of its middle, by number.
    pub edge: u32,
    /// Distance from its middle [m].
    pub distance: f64,
    /// Half of its width there [m].
    pub half_width: f64,
    /// Angle by which the wear bent it there, without sign [rad].
    pub angle: f64,
}

impl<'a> CreaseDistances<'a> {
    /// The distances up to about `reach` [m].
    pub fn new(surface: &'a WornSurface, reach: f64) -> Self {
        let mut near: Vec<Vec<u32>> = vec![Vec::new(); surface.triangles.len()];
        let mut seen = vec![u32::MAX; surface.triangles.len()];
        for (e, edge) in surface.edges.iter().enumerate() {
            let mut open: Vec<u32> = edge.sides.to_vec();
            while let Some(f) = open.pop() {
                if seen[f as usize] == e as u32 || surface.distance_between(e as u32, f) > reach {
                    continue;
                }
                seen[f as usize] = e as u32;
                near[f as usize].push(e as u32);
                open.extend_from_slice(surface.walk.around(f));
            }
        }
        let angles = surface.edges.iter().map(|edge| surface.bend(edge)).collect();
        Self { surface, near, angles }
    }

    /// The crease closest to the place `source` of the source surface [m], searched from triangle `start` of the worn surface.
    pub fn at(&self, start: u32, source: &Vec3) -> Option<NearCrease> {
        let surface = self.surface;
        let (at, x) = surface.locate(start, source);
        let each = self.near[at.face as usize].iter().map(|e| (surface.offset(*e, &x).norm(), *e));
        let (distance, edge) = each.min_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)))?;
        let angle = self.angles[edge as usize];
        Some(NearCrease { edge, distance, half_width: surface.half_width, angle })
    }

    /// Distance of the place `source` from the line of edge `edge` of a crease [m], positive on its first side.
    pub fn side(&self, edge: u32, source: &Vec3) -> f64 {
        let edge = &self.surface.edges[edge as usize];
        (source - self.surface.points[edge.ends[0].at()]).dot(&edge.across)
    }
}

impl WornSurface {
    /// Shortest vector from edge `e` of a crease to `x` [m].
    fn offset(&self, e: u32, x: &Vec3) -> Vec3 {
        let [a, b] = self.edges[e as usize].ends.map(|p| self.points[p.at()]);
        x - (a + (b - a) * along_edge(x, &a, &b))
    }

    /// Angle by which the wear turned the sides of a crease against one another in the middle of `edge` [rad].
    fn bend(&self, edge: &CreaseEdge) -> f64 {
        let [a, b] = edge.sides.map(|face| self.side_turn(face, edge, 0.5));
        let normal = triangle::normal(&corners(&self.points, &self.triangles[edge.sides[0] as usize]));
        normal.map_or(0.0, |n| (a * n).angle(&(b * n)))
    }

    /// About the distance of triangle `f` from edge `e` of a crease [m]: over the corners of the one and the ends and the middle of the other.
    fn distance_between(&self, e: u32, f: u32) -> f64 {
        let [a, b] = self.edges[e as usize].ends.map(|p| self.points[p.at()]);
        let t = corners(&self.points, &self.triangles[f as usize]);
        let to_triangle =
            [a, 0.5 * (a + b), b].map(|x| point_triangle_squared(&x, &t[0], &t[1], &t[2]).sqrt());
        let from_corners = t.map(|x| self.offset(e, &x).norm());
        to_triangle.into_iter().chain(from_corners).fold(f64::INFINITY, f64::min)
    }
}
