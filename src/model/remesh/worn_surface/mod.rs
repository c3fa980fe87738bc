//! Worn surface: position and turn of what was worn, anywhere on the garment.
//!
//! The mesh that was simulated has edges along the lines of its folds, and relaxed to the source pose it has its kinks there. It is
//! read as cloth: smooth where nothing was creased, flat up to a crease, and bent over the width of the crease. The normal of a place is the
//! normal of the file turned by the wear, so that what was not worn stays as it was.
//!
//! ```text
//! chains of hinges with a memory -> centre lines and the rows beside them (crease_edges)
//! rotation per corner, apart on both sides of a centre line, carried from the panels up to it (panels)
//! place of the source surface -> triangle of the mesh -> rotation, over the width of a crease between those of its sides (here)
//! ```

mod crease_distance;
mod crease_edges;
mod creases;
mod opened_memory;
mod panels;
mod sided_search;

pub use crease_distance::{CreaseDistances, NearCrease};
pub use creases::{Crease, CreaseChain};
pub use opened_memory::opened_memory;

use crate::garment::WornGarment;
use crate::remesh::GarmentSurface;
use crate::remesh::surface_mesh::{SurfacePoint, clamped_weights, interpolate};
use crate::remesh::tuning::TUNING;
use crate::remesh::worn_surface::crease_edges::CreaseEdges;
use crate::remesh::worn_surface::panels::corner_rotations;
use crate::remesh::worn_surface::sided_search::SidedSearch;
use crease_geometry::math::{Mat3, Vec3};
use crease_geometry::mesh::distance::{along_edge, barycentric};
use crease_geometry::mesh::triangle::{self, corners};
use crease_geometry::mesh::{PointIndex, SurfaceWalk};

/// What was worn, relaxed to the source pose, as a surface.
#[derive(Debug)]
pub struct WornSurface {
    /// Points in the source pose [m].
    points: Vec<Vec3>,
    /// Points after the wear [m].
    worn: Vec<Vec3>,
    triangles: Vec<[PointIndex; 3]>,
    walk: SurfaceWalk,
    /// Per triangle and corner: rotation by the wear.
    rotations: Vec<[Mat3; 3]>,
    /// Per triangle: the crease edges that it touches.
    near: Vec<Vec<u32>>,
    edges: Vec<CreaseEdge>,
    /// Half of the width of a crease [m].
    half_width: f64,
}

/// Edge of a centre line.
#[derive(Debug, Clone, Copy)]
struct CreaseEdge {
    ends: [PointIndex; 2],
    /// Triangles on both sides.
    sides: [u32; 2],
    /// Unit vector across it, to the first side.
    across: Vec3,
}

/// Place on a worn surface.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct WornPlace {
    /// Triangle of the mesh that it lies on, from which a search for a place beside it begins.
    pub face: u32,
    /// Position after the wear [m].
    pub position: Vec3,
    /// Map that turns directions of the source pose as the wear did; lengths are not kept.
    pub turn: Mat3,
}

impl WornSurface {
    /// The surface of `mesh` with the wear `worn`, whose creases are `width` [m] wide.
    pub fn new(mesh: &GarmentSurface, worn: &WornGarment, width: f64) -> Self {
        let after: Vec<Vec3> = mesh.points.iter().zip(&worn.displacement).map(|(x, d)| x + d).collect();
        let changes: Vec<f64> = worn.memory.angle_changes().collect();
        let found = CreaseEdges::find(mesh, &changes);
        let rotations = corner_rotations(mesh, &after, &found);
        let mut at_point: Vec<Vec<u32>> = vec![Vec::new(); mesh.points.len()];
        let mut edges = Vec::new();
        for h in found.centre_hinges() {
            let hinge = &mesh.topology.hinges[h];
            let [a, b, c, _] = hinge.points.map(|p| mesh.points[p.at()]);
            let Some(along) = (b - a).try_normalize(0.0) else { continue };
            let Some(across) = ((c - a) - along * along.dot(&(c - a))).try_normalize(0.0) else { continue };
            let ends = [hinge.points[0], hinge.points[1]];
            ends.iter().for_each(|p| at_point[p.at()].push(edges.len() as u32));
            edges.push(CreaseEdge { ends, sides: hinge.triangles, across });
        }
        let near = mesh.triangles.iter().map(|t| {
            let mut near: Vec<u32> = t.iter().flat_map(|p| at_point[p.at()].iter().copied()).collect();
            near.sort_unstable();
            near.dedup();
            near
        });
        Self {
            near: near.collect(),
            points: mesh.points.clone(),
            walk: SurfaceWalk::new(mesh.points.len(), &mesh.triangles),
            triangles: mesh.triangles.clone(),
            worn: after,
            rotations,
            edges,
            half_width: 0.5 * width,
        }
    }

    /// Per triangle of a garment of `points` [m] and `triangles`, on whose surface the mesh lies: a triangle of the mesh from which a search for a place of it begins;
    /// `None` where the mesh has none, such as on trims.
    pub fn starts(&self, points: &[Vec3], triangles: &[[PointIndex; 3]]) -> Vec<Option<u32>> {
        if self.triangles == triangles {
            return (0..self.triangles.len() as u32).map(Some).collect();
        }
        let search = SidedSearch::new(&self.points, &self.triangles);
        let start = |t: &[PointIndex; 3]| {
            let x = corners(points, t);
            let centre = (x[0] + x[1] + x[2]) / 3.0;
            search.nearest(centre, TUNING.max_start_distance, triangle::normal(&x))
        };
        triangles.iter().map(start).collect()
    }

    /// The worn place of the place `source` of the source surface [m], searched along the surface from triangle `start` of the mesh.
    pub fn at(&self, start: u32, source: &Vec3) -> WornPlace {
        let (at, from) = self.locate(start, source);
        let to = interpolate(&self.worn, &self.triangles, &at);
        let turn = self.turn_at(&at, &from);
        let beside = source - from;
        let turned = (turn * beside).try_normalize(0.0).map_or(beside, |unit| unit * beside.norm());
        WornPlace { face: at.face, position: to + turned, turn }
    }

    /// The place of the mesh closest to `source` [m], searched from triangle `start`, and its position before the wear [m].
    fn locate(&self, start: u32, source: &Vec3) -> (SurfacePoint, Vec3) {
        let at = self.above(start, source).unwrap_or_else(|| {
            let face = self.walk.closest(&self.points, &self.triangles, start, source);
            let weights = clamped_weights(source, &corners(&self.points, &self.triangles[face as usize]));
            SurfacePoint { face, weights }
        });
        (at, interpolate(&self.points, &self.triangles, &at))
    }

    /// The place of `source` [m] on triangle `face`, if it lies above or below it and next to it: most places do beside the one before.
    fn above(&self, face: u32, source: &Vec3) -> Option<SurfacePoint> {
        let x = corners(&self.points, &self.triangles[face as usize]);
        let weights = barycentric(source, &x);
        let on: Vec3 = (0..3).map(|k| x[k] * weights[k]).sum();
        let near = TUNING.max_rise * TUNING.max_rise * triangle::area(&x);
        let is_above = weights.iter().all(|w| *w >= 0.0) && (source - on).norm_squared() <= near;
        is_above.then_some(SurfacePoint { face, weights })
    }

    /// The turn at `at`, a place at `x` of the mesh [m].
    fn turn_at(&self, at: &SurfacePoint, x: &Vec3) -> Mat3 {
        let own: Mat3 = (0..3).map(|k| self.rotations[at.face as usize][k] * at.weights[k]).sum();
        let mut nearest: Option<(f64, &CreaseEdge, f64, Vec3)> = None;
        for edge in self.near[at.face as usize].iter().map(|e| &self.edges[*e as usize]) {
            let [a, b] = edge.ends.map(|p| self.points[p.at()]);
            let part = along_edge(x, &a, &b);
            let offset = x - (a + (b - a) * part);
            let distance = offset.norm();
            if distance < self.half_width && nearest.is_none_or(|(least, ..)| distance < least) {
                nearest = Some((distance, edge, part, offset));
            }
        }
        let Some((distance, edge, part, offset)) = nearest else { return own };
        // What the other side has at the line, from half of it on the line down to none at the border of the crease.
        let other = edge.sides[usize::from(offset.dot(&edge.across) > 0.0)];
        let fraction = 0.5 * (1.0 - distance / self.half_width);
        own * (1.0 - fraction) + self.side_turn(other, edge, part) * fraction
    }

    /// The turn of the side `face` of a crease edge at the fraction `part` of its length.
    fn side_turn(&self, face: u32, edge: &CreaseEdge, part: f64) -> Mat3 {
        let t = &self.triangles[face as usize];
        let corner = |p: PointIndex| t.iter().position(|q| *q == p).unwrap_or(0);
        let [a, b] = edge.ends.map(|p| self.rotations[face as usize][corner(p)]);
        a * (1.0 - part) + b * part
    }
}
