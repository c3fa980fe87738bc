//! Which point-triangle and edge-edge pairs may come near each other during a motion: the broad phase.
//!
//! Two triangles are compared when their boxes, swept along the motion, come within the reach, or, where all points go the
//! same share of their ways, do so at some moment (`mesh::patches`; between two meshes `mesh::tree`). Every point and
//! every edge belongs to one of the triangles around it, and a pair of triangles compares only what belongs to it: its
//! points with the other triangle, its edges with the other's edges. So each pair of primitives is looked at exactly
//! once, and nothing has to be deduplicated. What passes its own boxes is kept if its distance at the start is at most
//! the reach plus the way the two can go towards each other.
//!
//! Pairs that share a point never count, points in no triangle are ignored. The lists are sorted and do not depend
//! on the history of the trees or on the number of threads. A candidate is not yet a contact: the energies decide by
//! the actual distance. A motion that is not finite counts as none (`contact::bound` makes none); a start that is not
//! finite takes the triangles around it out of the search, so whoever makes positions checks them.

mod pair_filter;
mod primitive_pair;
#[cfg(test)]
mod tests;
mod verlet_list;

use crate::contact::broad_phase::pair_filter::{Shortlist, Side, sorted};
use crate::contact::broad_phase::verlet_list::Kept;
use crate::math::Vec3;
use crate::mesh::aabb::{MovingBox, SweptBox};
use crate::mesh::static_bvh::{Pairs, StaticBvh};
use crate::mesh::{PointIndex, Topology};
pub use primitive_pair::{PairKind, PrimitivePair, rest_distance};
use rayon::prelude::*;

/// The reach is widened by this fraction, so that rounding in boxes and distances never loses a pair.
const ROUNDING: f64 = 1e-9;

/// Pairs within one mesh.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Candidates {
    /// (point, triangle), sorted.
    pub point_triangle: Vec<[u32; 2]>,
    /// (edge, edge), lower first, sorted.
    pub edge_edge: Vec<[u32; 2]>,
}

impl Candidates {
    /// Number of pairs of both kinds.
    pub fn len(&self) -> usize {
        self.point_triangle.len() + self.edge_edge.len()
    }

    /// Whether there is no pair at all.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// All pairs as their points: first point-triangle, then edge-edge, in order. `mesh` is the finder they come from.
    pub fn quads<'a>(&'a self, mesh: &'a CandidateFinder) -> impl Iterator<Item = PrimitivePair> + 'a {
        let point_triangle = self.point_triangle.iter().map(|&[p, f]| mesh.quad_point_triangle(p, f));
        let edge_edge = self.edge_edge.iter().map(|&[e, f]| mesh.quad_edge_edge(e, f));
        point_triangle.chain(edge_edge)
    }
}

/// Finds candidates for one mesh as it moves; keeps its tree from call to call.
#[derive(Clone)]
pub struct CandidateFinder {
    triangles: Vec<Triangle>,
    edges: Vec<[u32; 2]>,
    /// The triangle that each point and each edge belongs to; [`NONE`] for points in no triangle.
    point_owner: Vec<u32>,
    edge_owner: Vec<u32>,
    patches: StaticBvh,
    kept: Kept,
    /// One per point.
    point_boxes: Vec<MovingBox>,
    /// One per edge.
    edge_boxes: Vec<MovingBox>,
    /// One per triangle.
    triangle_boxes: Vec<MovingBox>,
    /// One per point: length of its way \[m\]; empty at rest.
    ways: Vec<f64>,
}

/// Some points of a mesh and what is around them.
#[derive(Debug, Clone, Default)]
pub struct PointSubset {
    points: Vec<u32>,
    /// All with an end among the points.
    edges: Vec<u32>,
    /// All with a corner among the points.
    triangles: Vec<u32>,
    /// One per triangle of the mesh: whether it is one of them.
    has: Vec<bool>,
    /// The kept candidates with one of its triangles, where they say all.
    known: Option<Candidates>,
}

/// A triangle with what belongs to it; [`NONE`] after the last.
#[derive(Debug, Clone, Copy)]
struct Triangle {
    corners: [u32; 3],
    points: [u32; 3],
    edges: [u32; 3],
}

/// No primitive.
const NONE: u32 = u32::MAX;

impl Triangle {
    fn points(&self) -> impl Iterator<Item = u32> + '_ {
        self.points.iter().copied().take_while(|&p| p != NONE)
    }

    fn edges(&self) -> impl Iterator<Item = u32> + '_ {
        self.edges.iter().copied().take_while(|&e| e != NONE)
    }
}

/// Gives every primitive to the triangle around it that has the fewest so far: evenly, so that no pair of triangles
/// is long to compare. `around` is what each triangle has at its corners or sides, `count` the number of primitives.
fn shared_out(around: impl Iterator<Item = [u32; 3]> + Clone, count: usize) -> Vec<[u32; 3]> {
    let mut owner = vec![NONE; count];
    let mut load = Vec::new();
    for (f, all) in around.clone().enumerate() {
        load.push(0u8);
        for i in all {
            let other = owner[i as usize];
            if other == NONE || load[other as usize] > load[f] + 1 {
                if other != NONE {
                    load[other as usize] -= 1;
                }
                owner[i as usize] = f as u32;
                load[f] += 1;
            }
        }
    }
    let mine = |f: usize, all: [u32; 3]| {
        let mut own = [NONE; 3];
        let of_f = all.into_iter().filter(|&i| owner[i as usize] == f as u32);
        own.iter_mut().zip(of_f).for_each(|(slot, i)| *slot = i);
        own
    };
    around.enumerate().map(|(f, all)| mine(f, all)).collect()
}

impl CandidateFinder {
    /// For a mesh of `triangles` with their `topology`, at first at `points` \[m\].
    pub fn new(points: &[Vec3], triangles: &[[PointIndex; 3]], topology: &Topology) -> Self {
        let corners = triangles.iter().map(|t| t.map(|p| p.0));
        let points_of = shared_out(corners.clone(), topology.point_count);
        let edges_of = shared_out(topology.triangle_edges.iter().copied(), topology.edges.len());
        let owners = |of: &[[u32; 3]], count: usize| {
            let mut owner = vec![NONE; count];
            for (f, own) in of.iter().enumerate() {
                own.iter().filter(|i| **i != NONE).for_each(|i| owner[*i as usize] = f as u32);
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
            patches: StaticBvh::new(points, triangles),
            kept: Kept::default(),
            point_boxes: Vec::new(),
            edge_boxes: Vec::new(),
            triangle_boxes: Vec::new(),
            ways: Vec::new(),
        }
    }

    /// The four points of a point-triangle pair.
    #[inline]
    pub fn quad_point_triangle(&self, point: u32, triangle: u32) -> PrimitivePair {
        let [a, b, c] = self.triangles[triangle as usize].corners;
        PrimitivePair { kind: PairKind::PointTriangle, points: [point, a, b, c].map(PointIndex) }
    }

    /// The four points of an edge-edge pair.
    #[inline]
    pub fn quad_edge_edge(&self, first: u32, second: u32) -> PrimitivePair {
        let ([a, b], [c, d]) = (self.edges[first as usize], self.edges[second as usize]);
        PrimitivePair { kind: PairKind::EdgeEdge, points: [a, b, c, d].map(PointIndex) }
    }

    /// All pairs that may come within `reach` \[m\] while every point moves straight from `start` to `end` \[m\] by any
    /// fraction of its way (pass the same array twice for a mesh at rest), or, when they go `together`, all by the
    /// same fraction. Pairs for which `skip` is true are left out; it is asked only about pairs that are near, in
    /// no order, from several threads.
    pub fn find(
        &mut self,
        start: &[Vec3],
        end: &[Vec3],
        reach: f64,
        together: bool,
        skip: &(dyn Fn(PrimitivePair) -> bool + Sync),
    ) -> Candidates {
        let reach = reach * (1.0 + ROUNDING);
        self.sweep(start, end, together);
        let pairs = self.overlapping_triangles(start, end, reach, together, None);
        self.compare(&pairs, start, end, reach, together, skip)
    }

    /// The pairs of triangles that meet on the way the boxes were swept along, only those with a `marked` one, if any are told.
    fn overlapping_triangles(
        &mut self,
        start: &[Vec3],
        end: &[Vec3],
        reach: f64,
        together: bool,
        marked: Option<&[bool]>,
    ) -> Vec<Pairs> {
        let rests = !together || start == end;
        self.patches.overlapping_triangles(&self.triangle_boxes, SweptBox::reach(reach), rests, marked)
    }

    /// What comes near of the pairs of triangles.
    fn compare(
        &self,
        pairs: &[Pairs],
        start: &[Vec3],
        end: &[Vec3],
        reach: f64,
        together: bool,
        skip: &(dyn Fn(PrimitivePair) -> bool + Sync),
    ) -> Candidates {
        let side = self.same_side(start, end, reach, together);
        let compare = |lists: &mut [Shortlist; 2], part: &Pairs| {
            let [points, edges] = lists;
            for &(a, b) in part {
                side.shortlist_points(a, b, points);
                side.shortlist_points(b, a, points);
                side.shortlist_edges(a, b, edges);
            }
            edges.ordered();
            let points = points.drain(|p, f| side.point_near(p, f) && !skip(self.quad_point_triangle(p, f)));
            let edges = edges.drain(|e, f| side.edge_near(e, f) && !skip(self.quad_edge_edge(e, f)));
            (points, edges)
        };
        let found: Vec<_> = pairs.par_iter().with_max_len(1).map_init(Default::default, compare).collect();
        let (point_parts, edge_parts): (Vec<_>, Vec<_>) = found.into_iter().unzip();
        let (point_triangle, edge_edge) =
            rayon::join(|| sorted(&point_parts, start.len()), || sorted(&edge_parts, self.edges.len()));
        Candidates { point_triangle, edge_edge }
    }

    /// The points for which `moving` is set, one flag per point, as what [`Self::find_around`] moves while everything else
    /// rests at `x` \[m\]; `reach` \[m\] is that of the searches to come.
    pub fn portion(&mut self, moving: &[bool], x: &[Vec3], reach: f64) -> PointSubset {
        self.sweep(x, x, true);
        let among = |points: &[u32]| points.iter().any(|p| moving[*p as usize]);
        let numbers = |flags: &[bool]| (0..flags.len() as u32).filter(|i| flags[*i as usize]).collect();
        let edges: Vec<bool> = self.edges.iter().map(|e| among(e)).collect();
        let has: Vec<bool> = self.triangles.iter().map(|t| among(&t.corners)).collect();
        let known = self.around_portion(&has, x, reach);
        PointSubset { points: numbers(moving), edges: numbers(&edges), triangles: numbers(&has), has, known }
    }

    /// [`Self::find`] where only the points of a portion move, all others being where they were when it was made: the pairs
    /// with one of its triangles.
    pub fn find_around(
        &mut self,
        portion: &PointSubset,
        start: &[Vec3],
        end: &[Vec3],
        reach: f64,
        together: bool,
        skip: &(dyn Fn(PrimitivePair) -> bool + Sync),
    ) -> Candidates {
        let reach = reach * (1.0 + ROUNDING);
        self.sweep_portion(portion, start, end, together);
        if let Some(found) = self.find_around_known(portion, start, end, reach, together, skip) {
            return found;
        }
        let pairs = self.overlapping_triangles(start, end, reach, together, Some(&portion.has));
        self.compare(&pairs, start, end, reach, together, skip)
    }

    /// Fits ways and boxes of points, edges and triangles to a motion.
    fn sweep(&mut self, start: &[Vec3], end: &[Vec3], together: bool) {
        self.ways.clear();
        if start != end {
            let ways = start.par_iter().zip(end).map(|(from, to)| length_of_way(from, to));
            ways.collect_into_vec(&mut self.ways);
        }
        let boxes = start.par_iter().zip(end).map(|(from, to)| box_of(from, to, together));
        boxes.collect_into_vec(&mut self.point_boxes);
        let points = &self.point_boxes;
        let point = |p: u32| &points[p as usize];
        let boxes = self.edges.par_iter().map(|&[a, b]| point(a).with(point(b)));
        boxes.collect_into_vec(&mut self.edge_boxes);
        let boxes = self.triangles.par_iter().map(|triangle| {
            let [a, b, c] = triangle.corners;
            point(a).with(point(b)).with(point(c))
        });
        boxes.collect_into_vec(&mut self.triangle_boxes);
    }

    /// Fits what belongs to a portion to its motion.
    fn sweep_portion(&mut self, portion: &PointSubset, start: &[Vec3], end: &[Vec3], together: bool) {
        self.ways.resize(start.len(), 0.0);
        for &p in &portion.points {
            let (from, to) = (&start[p as usize], &end[p as usize]);
            self.ways[p as usize] = length_of_way(from, to);
            self.point_boxes[p as usize] = box_of(from, to, together);
        }
        let points = &self.point_boxes;
        let point = |p: u32| &points[p as usize];
        for &e in &portion.edges {
            let [a, b] = self.edges[e as usize];
            self.edge_boxes[e as usize] = point(a).with(point(b));
        }
        for &f in &portion.triangles {
            let [a, b, c] = self.triangles[f as usize].corners;
            self.triangle_boxes[f as usize] = point(a).with(point(b)).with(point(c));
        }
    }

    fn same_side<'a>(&'a self, start: &'a [Vec3], end: &'a [Vec3], reach: f64, together: bool) -> Side<'a> {
        let together = (together && start != end).then_some(end);
        Side { mesh: self, start, ways: &self.ways, reach, box_reach: SweptBox::reach(reach), together }
    }
}

/// Around a point on its way.
#[inline]
fn box_of(from: &Vec3, to: &Vec3, together: bool) -> MovingBox {
    if together { MovingBox::together(from, to) } else { MovingBox::swept(from, to) }
}

/// Length of a way \[m\]; none where it is not finite.
fn length_of_way(from: &Vec3, to: &Vec3) -> f64 {
    let way = (to - from).norm();
    if way.is_finite() { way } else { 0.0 }
}
