//! Primitives of a mesh: which triangle compares which point and edge, and their boxes during a motion.

use crate::contact::broad_phase::primitive_pair::{PairKind, PrimitivePair};
use crate::contact::broad_phase::search_query::SearchQuery;
use crease_geometry::math::Vec3;
use crease_geometry::mesh::aabb::MovingBox;
use crease_geometry::mesh::{INVALID, PointIndex, Topology};
use rayon::prelude::*;

/// A triangle with the primitives it owns; [`INVALID`] after the last.
#[derive(Debug, Clone, Copy)]
pub(super) struct Triangle {
    pub corners: [u32; 3],
    points: [u32; 3],
    edges: [u32; 3],
}

impl Triangle {
    /// Points that the triangle owns.
    pub fn points(&self) -> impl Iterator<Item = u32> + '_ {
        self.points.iter().copied().take_while(|&p| p != INVALID)
    }

    /// Edges that the triangle owns.
    pub fn edges(&self) -> impl Iterator<Item = u32> + '_ {
        self.edges.iter().copied().take_while(|&e| e != INVALID)
    }
}

/// Points, edges and triangles of a mesh. Every point and edge belongs to one of the triangles around it.
#[derive(Debug, Clone)]
pub(super) struct MeshPrimitives {
    pub triangles: Vec<Triangle>,
    pub edges: Vec<[u32; 2]>,
    /// Owner of each point; [`INVALID`] for points in no triangle.
    pub point_owner: Vec<u32>,
    /// Owner of each edge.
    pub edge_owner: Vec<u32>,
}

impl MeshPrimitives {
    /// Assigns the primitives of a mesh of `triangles` with their `topology`.
    pub fn new(triangles: &[[PointIndex; 3]], topology: &Topology) -> Self {
        let corners = triangles.iter().map(|t| t.map(|p| p.0));
        let points_of = assign_primitives(corners.clone(), topology.point_count);
        let edges_of = assign_primitives(topology.triangle_edges.iter().copied(), topology.edges.len());
        let owners = |of: &[[u32; 3]], count: usize| {
            let mut owner = vec![INVALID; count];
            for (f, own) in of.iter().enumerate() {
                own.iter().filter(|i| **i != INVALID).for_each(|i| owner[*i as usize] = f as u32);
            }
            owner
        };
        let point_owner = owners(&points_of, topology.point_count);
        let edge_owner = owners(&edges_of, topology.edges.len());
        let owning = corners.zip(points_of).zip(edges_of);
        Self {
            triangles: owning.map(|((corners, points), edges)| Triangle { corners, points, edges }).collect(),
            edges: topology.edges.iter().map(|e| e.map(|p| p.0)).collect(),
            point_owner,
            edge_owner,
        }
    }

    /// Returns the four points of a point-triangle pair.
    #[inline]
    pub fn point_triangle_pair(&self, point: u32, triangle: u32) -> PrimitivePair {
        let [a, b, c] = self.triangles[triangle as usize].corners;
        PrimitivePair { kind: PairKind::PointTriangle, points: [point, a, b, c].map(PointIndex) }
    }

    /// Returns the four points of an edge-edge pair.
    #[inline]
    pub fn edge_edge_pair(&self, first: u32, second: u32) -> PrimitivePair {
        let ([a, b], [c, d]) = (self.edges[first as usize], self.edges[second as usize]);
        PrimitivePair { kind: PairKind::EdgeEdge, points: [a, b, c, d].map(PointIndex) }
    }

    /// Returns the subset of points for which `moving` is set, one flag per point, with all that is around them.
    pub fn subset(&self, moving: &[bool]) -> PointSubset {
        let among = |points: &[u32]| points.iter().any(|p| moving[*p as usize]);
        let numbers = |flags: &[bool]| (0..flags.len() as u32).filter(|i| flags[*i as usize]).collect();
        let edges: Vec<bool> = self.edges.iter().map(|e| among(e)).collect();
        let has_triangle: Vec<bool> = self.triangles.iter().map(|t| among(&t.corners)).collect();
        PointSubset {
            points: numbers(moving),
            edges: numbers(&edges),
            triangles: numbers(&has_triangle),
            has_triangle,
        }
    }
}

/// Assigns every primitive to the triangle around it that has the fewest so far, so that no pair of triangles takes long to compare.
/// `around` has the primitives at the corners or sides of each triangle, `count` is the number of primitives.
fn assign_primitives(around: impl Iterator<Item = [u32; 3]> + Clone, count: usize) -> Vec<[u32; 3]> {
    let mut owner = vec![INVALID; count];
    let mut load = Vec::new();
    for (f, all) in around.clone().enumerate() {
        load.push(0u8);
        for i in all {
            let other = owner[i as usize];
            if other == INVALID || load[other as usize] > load[f] + 1 {
                if other != INVALID {
                    load[other as usize] -= 1;
                }
                owner[i as usize] = f as u32;
                load[f] += 1;
            }
        }
    }
    let owned = |f: usize, all: [u32; 3]| {
        let mut own = [INVALID; 3];
        let of_f = all.into_iter().filter(|&i| owner[i as usize] == f as u32);
        own.iter_mut().zip(of_f).for_each(|(slot, i)| *slot = i);
        own
    };
    around.enumerate().map(|(f, all)| owned(f, all)).collect()
}

/// Some points of a mesh and the primitives around them.
#[derive(Debug, Clone, Default)]
pub struct PointSubset {
    pub(super) points: Vec<u32>,
    /// Edges with an end among the points.
    edges: Vec<u32>,
    /// Triangles with a corner among the points.
    triangles: Vec<u32>,
    /// Whether a triangle is one of them, one flag per triangle of the mesh.
    pub(super) has_triangle: Vec<bool>,
}

/// Boxes of the primitives of a mesh during a motion, and the lengths of the displacements.
#[derive(Debug, Clone, Default)]
pub(super) struct PrimitiveBoxes {
    /// One per point.
    pub points: Vec<MovingBox>,
    /// One per edge.
    pub edges: Vec<MovingBox>,
    /// One per triangle.
    pub triangles: Vec<MovingBox>,
    /// Lengths of the displacements \[m\], one per point; empty at rest.
    pub lengths: Vec<f64>,
}

impl PrimitiveBoxes {
    /// Fits all boxes to the motion of a query.
    pub fn fit(&mut self, mesh: &MeshPrimitives, query: &SearchQuery) {
        let SearchQuery { start, end, uniform_step, .. } = *query;
        self.lengths.clear();
        if start != end {
            let lengths = start.par_iter().zip(end).map(|(from, to)| displacement_length(from, to));
            lengths.collect_into_vec(&mut self.lengths);
        }
        let boxes = start.par_iter().zip(end).map(|(from, to)| point_box(from, to, uniform_step));
        boxes.collect_into_vec(&mut self.points);
        let points = &self.points;
        let point = |p: u32| &points[p as usize];
        let boxes = mesh.edges.par_iter().map(|&[a, b]| point(a).with(point(b)));
        boxes.collect_into_vec(&mut self.edges);
        let boxes = mesh.triangles.par_iter().map(|triangle| {
            let [a, b, c] = triangle.corners;
            point(a).with(point(b)).with(point(c))
        });
        boxes.collect_into_vec(&mut self.triangles);
    }

    /// Fits the boxes of a subset to the motion of a query; the others stay as they are.
    pub fn fit_subset(&mut self, mesh: &MeshPrimitives, subset: &PointSubset, query: &SearchQuery) {
        let SearchQuery { start, end, uniform_step, .. } = *query;
        self.lengths.resize(start.len(), 0.0);
        for &p in &subset.points {
            let (from, to) = (&start[p as usize], &end[p as usize]);
            self.lengths[p as usize] = displacement_length(from, to);
            self.points[p as usize] = point_box(from, to, uniform_step);
        }
        let points = &self.points;
        let point = |p: u32| &points[p as usize];
        for &e in &subset.edges {
            let [a, b] = mesh.edges[e as usize];
            self.edges[e as usize] = point(a).with(point(b));
        }
        for &f in &subset.triangles {
            let [a, b, c] = mesh.triangles[f as usize].corners;
            self.triangles[f as usize] = point(a).with(point(b)).with(point(c));
        }
    }
}

/// Returns the box of a point that moves.
#[inline]
fn point_box(from: &Vec3, to: &Vec3, uniform_step: bool) -> MovingBox {
    if uniform_step { MovingBox::uniform(from, to) } else { MovingBox::swept(from, to) }
}

/// Returns the length of a displacement \[m\]; 0 where it is not finite.
fn displacement_length(from: &Vec3, to: &Vec3) -> f64 {
    let length = (to - from).norm();
    if length.is_finite() { length } else { 0.0 }
}
