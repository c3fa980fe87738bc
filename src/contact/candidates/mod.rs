//! Which point-triangle and edge-edge pairs may come near each other during a motion: the broad phase.
//!
//! Two triangles are compared when their boxes, swept along the motion and grown by half the reach each, overlap
//! (`mesh::tree`). Every point and every edge belongs to one of the triangles around it, and a pair of triangles
//! compares only what belongs to it: its points with the other triangle, its edges with the other's edges. So each
//! pair of primitives is looked at exactly once, and nothing has to be deduplicated. What passes its own boxes is
//! kept if its distance at the start is at most the reach plus the way the two can go towards each other.
//!
//! Pairs that share a point never count, points in no triangle are ignored. The lists are sorted and do not depend
//! on the history of the tree or on the number of threads. A candidate is not yet a contact: the energies decide by
//! the actual distance. A motion that is not finite counts as none (`contact::bound` makes none); a start that is not
//! finite takes the triangles around it out of the search, so whoever makes positions checks them.

mod kept;

use crate::math::Vec3;
use crate::mesh::boxes::SweptBox;
use crate::mesh::distance::{Gap, edge_edge, edge_edge_squared, point_triangle, point_triangle_squared};
use crate::mesh::motion::{edge_edge_step, point_triangle_step, stay_apart_on_an_axis};
use crate::mesh::tree::TriangleTree;
use crate::mesh::{PointIndex, Topology};
use kept::Kept;
use rayon::prelude::*;
use serde::{Deserialize, Serialize};

/// Pairs of triangles that one task compares.
const CHUNK: usize = 2048;
/// Triangles whose overlaps one task looks for.
const OWN_CHUNK: usize = 128;
/// The reach is widened by this fraction, so that rounding in boxes and distances never loses a pair.
const ROUNDING: f64 = 1e-9;

/// The two kinds of primitive pairs.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
pub enum PairKind {
    /// A point and a triangle.
    PointTriangle,
    /// Two edges.
    EdgeEdge,
}

/// A primitive pair as its four points: the point and the triangle's corners, or the ends of the two edges.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Quad {
    /// Which pair the points form.
    pub kind: PairKind,
    /// Into positions of one array: when two meshes meet, those of the second follow those of the first.
    pub points: [PointIndex; 4],
}

impl Quad {
    /// The values of the four points in `field`, one per point.
    #[inline]
    pub fn gather(&self, field: &[Vec3]) -> [Vec3; 4] {
        self.points.map(|p| field[p.at()])
    }

    /// The closest points at positions `points` \[m\].
    #[inline]
    pub fn gap(&self, points: &[Vec3]) -> Gap {
        self.kind.gap(&self.gather(points))
    }

    /// The largest safe fraction of the motion `displacement` \[m\] (`mesh::motion`) that keeps the pair above `floor`
    /// \[m\].
    #[inline]
    pub fn step(&self, points: &[Vec3], displacement: &[Vec3], floor: f64) -> f64 {
        self.kind.step(self.gather(points), self.gather(displacement), floor)
    }
}

impl PairKind {
    /// The closest points of a pair of this kind at `x` \[m\].
    #[inline]
    pub fn gap(self, x: &[Vec3; 4]) -> Gap {
        match self {
            Self::PointTriangle => point_triangle(&x[0], &x[1], &x[2], &x[3]),
            Self::EdgeEdge => edge_edge(&x[0], &x[1], &x[2], &x[3]),
        }
    }

    /// Whether the boxes of the two pieces at `x` \[m\] are more than `reach` \[m\] apart on some axis: then so are they.
    #[inline]
    pub fn apart_on_an_axis(self, x: &[Vec3; 4], reach: f64) -> bool {
        stay_apart_on_an_axis(x, &[Vec3::zeros(); 4], reach, self == Self::PointTriangle)
    }

    /// The largest safe fraction of the motion `dx` \[m\] of a pair of this kind at `x` \[m\] (`mesh::motion`).
    #[inline]
    pub fn step(self, x: [Vec3; 4], dx: [Vec3; 4], floor: f64) -> f64 {
        match self {
            Self::PointTriangle => point_triangle_step(x, dx, floor),
            Self::EdgeEdge => edge_edge_step(x, dx, floor),
        }
    }
}

/// Distance \[m\] of a pair in the rest shape. Where it is less than the contact distance the pair lies close together
/// within the cloth itself, and contact must act from a smaller distance only, or it would push at rest.
pub fn rest_distance(kind: PairKind, points: [PointIndex; 4], rest_points: &[Vec3]) -> f64 {
    Quad { kind, points }.gap(rest_points).distance
}

/// Pairs within one mesh.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Candidates {
    /// (point, triangle), sorted.
    pub point_triangle: Vec<[u32; 2]>,
    /// (edge, edge), lower first, sorted.
    pub edge_edge: Vec<[u32; 2]>,
}

/// Pairs between two meshes, the first usually the cloth and the second the body.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct CandidatesBetween {
    /// (point of the first, triangle of the second), sorted.
    pub point_triangle: Vec<[u32; 2]>,
    /// (point of the second, triangle of the first), sorted.
    pub triangle_point: Vec<[u32; 2]>,
    /// (edge of the first, edge of the second), sorted.
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
    pub fn quads<'a>(&'a self, mesh: &'a CandidateFinder) -> impl Iterator<Item = Quad> + 'a {
        let point_triangle = self.point_triangle.iter().map(|&[p, f]| mesh.quad_point_triangle(p, f));
        let edge_edge = self.edge_edge.iter().map(|&[e, f]| mesh.quad_edge_edge(e, f));
        point_triangle.chain(edge_edge)
    }
}

impl CandidatesBetween {
    /// Number of pairs of all kinds.
    pub fn len(&self) -> usize {
        self.point_triangle.len() + self.triangle_point.len() + self.edge_edge.len()
    }

    /// Whether there is no pair at all.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// All pairs as their points, in the order of the fields; points of the second mesh are counted on from `offset`,
    /// the number of points of the first.
    pub fn quads<'a>(
        &'a self,
        first: &'a CandidateFinder,
        second: &'a CandidateFinder,
        offset: u32,
    ) -> impl Iterator<Item = Quad> + 'a {
        let own = |p: u32| PointIndex(p);
        let other = move |p: u32| PointIndex(p + offset);
        let point_triangle = self.point_triangle.iter().map(move |&[p, f]| {
            let [a, b, c] = second.triangles[f as usize].corners.map(other);
            Quad { kind: PairKind::PointTriangle, points: [own(p), a, b, c] }
        });
        let triangle_point = self.triangle_point.iter().map(move |&[p, f]| {
            let [a, b, c] = first.triangles[f as usize].corners.map(own);
            Quad { kind: PairKind::PointTriangle, points: [other(p), a, b, c] }
        });
        let edge_edge = self.edge_edge.iter().map(move |&[e, f]| {
            let ([a, b], [c, d]) = (first.edges[e as usize].map(own), second.edges[f as usize].map(other));
            Quad { kind: PairKind::EdgeEdge, points: [a, b, c, d] }
        });
        point_triangle.chain(triangle_point).chain(edge_edge)
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
    tree: TriangleTree,
    kept: Kept,
    /// One per point.
    point_boxes: Vec<SweptBox>,
    /// One per edge.
    edge_boxes: Vec<SweptBox>,
    /// One per triangle.
    triangle_boxes: Vec<SweptBox>,
    /// One per point: length of its way \[m\]; empty at rest.
    ways: Vec<f64>,
}

/// Some points of a mesh and what is around them.
#[derive(Debug, Clone, Default)]
pub struct Portion {
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
            tree: TriangleTree::new(points, triangles, 0.0),
            kept: Kept::default(),
            point_boxes: Vec::new(),
            edge_boxes: Vec::new(),
            triangle_boxes: Vec::new(),
            ways: Vec::new(),
        }
    }

    /// The four points of a point-triangle pair.
    #[inline]
    pub fn quad_point_triangle(&self, point: u32, triangle: u32) -> Quad {
        let [a, b, c] = self.triangles[triangle as usize].corners;
        Quad { kind: PairKind::PointTriangle, points: [point, a, b, c].map(PointIndex) }
    }

    /// The four points of an edge-edge pair.
    #[inline]
    pub fn quad_edge_edge(&self, first: u32, second: u32) -> Quad {
        let ([a, b], [c, d]) = (self.edges[first as usize], self.edges[second as usize]);
        Quad { kind: PairKind::EdgeEdge, points: [a, b, c, d].map(PointIndex) }
    }

    /// The tree as of the last search, its boxes swept and grown by half the reach.
    pub fn tree(&self) -> &TriangleTree {
        &self.tree
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
        skip: &(dyn Fn(Quad) -> bool + Sync),
    ) -> Candidates {
        let reach = reach * (1.0 + ROUNDING);
        self.fit(start, end, 0.5 * reach);
        self.compare(&self.tree.overlaps(), start, end, reach, together, skip)
    }

    /// What comes near of the pairs of triangles.
    fn compare(
        &self,
        pairs: &[(u32, u32)],
        start: &[Vec3],
        end: &[Vec3],
        reach: f64,
        together: bool,
        skip: &(dyn Fn(Quad) -> bool + Sync),
    ) -> Candidates {
        let side = self.same_side(start, end, reach, together);
        let compare = |lists: &mut [Shortlist; 2], chunk: &[(u32, u32)]| {
            let [points, edges] = lists;
            for &(a, b) in chunk {
                side.shortlist_points(a, &side, b, points);
                side.shortlist_points(b, &side, a, points);
                side.shortlist_edges(a, &side, b, edges);
            }
            edges.ordered();
            let points = points
                .drain(|p, f| side.point_near::<true>(p, &side, f) && !skip(self.quad_point_triangle(p, f)));
            let edges =
                edges.drain(|e, f| side.edge_near::<true>(e, &side, f) && !skip(self.quad_edge_edge(e, f)));
            (points, edges)
        };
        let found: Vec<_> = pairs.par_chunks(CHUNK).map_init(Default::default, compare).collect();
        let (point_parts, edge_parts): (Vec<_>, Vec<_>) = found.into_iter().unzip();
        let (point_triangle, edge_edge) =
            rayon::join(|| sorted(&point_parts, start.len()), || sorted(&edge_parts, self.edges.len()));
        Candidates { point_triangle, edge_edge }
    }

    /// Fits all to a mesh that rests at `x` \[m\], for searches of `reach` \[m\].
    pub fn rest(&mut self, x: &[Vec3], reach: f64) {
        self.fit(x, x, 0.5 * reach * (1.0 + ROUNDING));
    }

    /// The points for which `moving` is set, one flag per point, as what [`Self::find_around`] moves while everything else
    /// rests at `x` \[m\]; `reach` \[m\] is that of the searches to come.
    pub fn portion(&mut self, moving: &[bool], x: &[Vec3], reach: f64) -> Portion {
        self.rest(x, reach);
        let among = |points: &[u32]| points.iter().any(|p| moving[*p as usize]);
        let numbers = |flags: &[bool]| (0..flags.len() as u32).filter(|i| flags[*i as usize]).collect();
        let edges: Vec<bool> = self.edges.iter().map(|e| among(e)).collect();
        let has: Vec<bool> = self.triangles.iter().map(|t| among(&t.corners)).collect();
        let known = self.around_portion(&has, x, reach);
        Portion { points: numbers(moving), edges: numbers(&edges), triangles: numbers(&has), has, known }
    }

    /// [`Self::find`] where only the points of a portion move, all others being where they were when it was made: the pairs
    /// with one of its triangles.
    pub fn find_around(
        &mut self,
        portion: &Portion,
        start: &[Vec3],
        end: &[Vec3],
        reach: f64,
        together: bool,
        skip: &(dyn Fn(Quad) -> bool + Sync),
    ) -> Candidates {
        let reach = reach * (1.0 + ROUNDING);
        self.sweep_portion(portion, start, end);
        if let Some(found) = self.find_around_known(portion, start, end, reach, together, skip) {
            return found;
        }
        self.tree.refit_some(&portion.triangles, start, end, 0.5 * reach);
        let first = |a: u32, b: u32| a < b || !portion.has[b as usize];
        let pairs = self.overlaps_of(&portion.triangles, &self.tree, first);
        self.compare(&pairs, start, end, reach, together, skip)
    }

    /// [`Self::find_between`] where only the points of a portion move, all others being where they were when it was made;
    /// `other` was fitted for this reach and rests.
    pub fn find_between_around(
        &mut self,
        portion: &Portion,
        start: &[Vec3],
        end: &[Vec3],
        other: &Self,
        other_start: &[Vec3],
        reach: f64,
    ) -> CandidatesBetween {
        let reach = reach * (1.0 + ROUNDING);
        self.sweep_portion(portion, start, end);
        self.tree.refit_some(&portion.triangles, start, end, 0.5 * reach);
        let pairs = self.overlaps_of(&portion.triangles, &other.tree, |_, _| true);
        self.compare_between(&pairs, start, other, other_start, reach)
    }

    /// The same between this mesh and another, both moving.
    pub fn find_between(
        &mut self,
        start: &[Vec3],
        end: &[Vec3],
        other: &mut Self,
        other_start: &[Vec3],
        other_end: &[Vec3],
        reach: f64,
    ) -> CandidatesBetween {
        let reach = reach * (1.0 + ROUNDING);
        self.fit(start, end, 0.5 * reach);
        other.fit(other_start, other_end, 0.5 * reach);
        let mut pairs = Vec::new();
        self.tree.for_each_overlap_with(&other.tree, |a, b| pairs.push((a, b)));
        self.compare_between(&pairs, start, other, other_start, reach)
    }

    fn compare_between(
        &self,
        pairs: &[(u32, u32)],
        start: &[Vec3],
        other: &Self,
        other_start: &[Vec3],
        reach: f64,
    ) -> CandidatesBetween {
        let (first, second) = (self.side(start, reach), other.side(other_start, reach));
        let compare = |lists: &mut [Shortlist; 3], chunk: &[(u32, u32)]| {
            let [points, triangles, edges] = lists;
            for &(a, b) in chunk {
                first.shortlist_points(a, &second, b, points);
                second.shortlist_points(b, &first, a, triangles);
                first.shortlist_edges(a, &second, b, edges);
            }
            let points = points.drain(|p, f| first.point_near::<false>(p, &second, f));
            let triangles = triangles.drain(|p, f| second.point_near::<false>(p, &first, f));
            let edges = edges.drain(|e, f| first.edge_near::<false>(e, &second, f));
            (points, (triangles, edges))
        };
        let found: Vec<_> = pairs.par_chunks(CHUNK).map_init(Default::default, compare).collect();
        let (points, rest): (Vec<_>, Vec<_>) = found.into_iter().unzip();
        let (triangles, edges): (Vec<_>, Vec<_>) = rest.into_iter().unzip();
        CandidatesBetween {
            point_triangle: sorted(&points, start.len()),
            triangle_point: sorted(&triangles, other_start.len()),
            edge_edge: sorted(&edges, self.edges.len()),
        }
    }

    /// Pairs of the triangles `own` with those of `other` whose boxes overlap theirs, where `wanted`.
    fn overlaps_of(
        &self,
        own: &[u32],
        other: &TriangleTree,
        wanted: impl Fn(u32, u32) -> bool + Sync,
    ) -> Vec<(u32, u32)> {
        let of_some = |own: &[u32]| {
            let mut pairs = Vec::new();
            for &a in own {
                self.tree.for_each_overlap_of(a, other, |b| {
                    if wanted(a, b) {
                        pairs.push((a, b));
                    }
                });
            }
            pairs
        };
        own.par_chunks(OWN_CHUNK).map(of_some).collect::<Vec<_>>().concat()
    }

    fn fit(&mut self, start: &[Vec3], end: &[Vec3], inflate: f64) {
        self.tree.refit(start, end, inflate);
        self.sweep(start, end);
    }

    /// Fits ways and boxes of points, edges and triangles to a motion.
    fn sweep(&mut self, start: &[Vec3], end: &[Vec3]) {
        self.ways.clear();
        if start != end {
            let ways = start.par_iter().zip(end).map(|(from, to)| length_of_way(from, to));
            ways.collect_into_vec(&mut self.ways);
        }
        let boxes = start.par_iter().zip(end).map(|(from, to)| SweptBox::of_point(from, to));
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
    fn sweep_portion(&mut self, portion: &Portion, start: &[Vec3], end: &[Vec3]) {
        self.ways.resize(start.len(), 0.0);
        for &p in &portion.points {
            let (from, to) = (&start[p as usize], &end[p as usize]);
            self.ways[p as usize] = length_of_way(from, to);
            self.point_boxes[p as usize] = SweptBox::of_point(from, to);
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

    /// Both sides of a mesh that meets itself.
    fn same_side<'a>(&'a self, start: &'a [Vec3], end: &'a [Vec3], reach: f64, together: bool) -> Side<'a> {
        Side { together: (together && start != end).then_some(end), ..self.side(start, reach) }
    }

    fn side<'a>(&'a self, start: &'a [Vec3], reach: f64) -> Side<'a> {
        Side { mesh: self, start, ways: &self.ways, reach, box_reach: SweptBox::reach(reach), together: None }
    }
}

/// Length of a way \[m\]; none where it is not finite.
fn length_of_way(from: &Vec3, to: &Vec3) -> f64 {
    let way = (to - from).norm();
    if way.is_finite() { way } else { 0.0 }
}

/// One of the two meshes that meet (or the same one twice), with its motion.
struct Side<'a> {
    mesh: &'a CandidateFinder,
    start: &'a [Vec3],
    /// One per point: length of its way \[m\]; empty at rest.
    ways: &'a [f64],
    /// How near a pair may come to be found \[m\].
    reach: f64,
    /// The same for boxes.
    box_reach: f32,
    /// Ends of the ways, when all points go the same fraction of theirs.
    together: Option<&'a [Vec3]>,
}

impl Side<'_> {
    /// Adds the points of `triangle` whose boxes are near triangle `of_other`.
    #[inline(always)]
    fn shortlist_points(&self, triangle: u32, other: &Side, of_other: u32, list: &mut Shortlist) {
        let other_box = &other.mesh.triangle_boxes[of_other as usize];
        list.make_room(3);
        for p in self.mesh.triangles[triangle as usize].points() {
            list.add_if([p, of_other], self.mesh.point_boxes[p as usize].near(other_box, self.box_reach));
        }
    }

    /// Adds the edges of `triangle` with the edges of triangle `of_other` whose boxes are near.
    #[inline(always)]
    fn shortlist_edges(&self, triangle: u32, other: &Side, of_other: u32, list: &mut Shortlist) {
        let others = &other.mesh.triangles[of_other as usize];
        list.make_room(9);
        for e in self.mesh.triangles[triangle as usize].edges() {
            let own_box = &self.mesh.edge_boxes[e as usize];
            for f in others.edges() {
                list.add_if([e, f], own_box.near(&other.mesh.edge_boxes[f as usize], self.box_reach));
            }
        }
    }

    /// Whether a point and a triangle of the other side can come near. `SAME`: both sides are one mesh, where a
    /// shared point excludes the pair.
    #[inline(always)]
    fn point_near<const SAME: bool>(&self, point: u32, other: &Side, triangle: u32) -> bool {
        let corners = other.mesh.triangles[triangle as usize].corners;
        let squared = |[p]: [&Vec3; 1], [a, b, c]: [&Vec3; 3]| point_triangle_squared(p, a, b, c);
        !(SAME && corners.contains(&point)) && self.may_come_near([point], other, corners, squared)
    }

    /// Whether an edge and an edge of the other side can come near.
    #[inline(always)]
    fn edge_near<const SAME: bool>(&self, edge: u32, other: &Side, other_edge: u32) -> bool {
        let (ends, others) = (self.mesh.edges[edge as usize], other.mesh.edges[other_edge as usize]);
        let squared = |[a, b]: [&Vec3; 2], [c, d]: [&Vec3; 2]| edge_edge_squared(a, b, c, d);
        let shared = SAME && ends.iter().any(|p| others.contains(p));
        !shared && self.may_come_near(ends, other, others, squared)
    }

    /// Whether a pair can come within the reach: its distance now, less the longest way of a point on either side.
    /// That is a corner's, since inner points move by averages of corners. The two ways count apart and common motion
    /// is not deducted, because each point may in the end make another fraction of its way.
    #[inline(always)]
    fn may_come_near<const M: usize, const N: usize>(
        &self,
        own: [u32; M],
        other: &Side,
        others: [u32; N],
        squared: impl Fn([&Vec3; M], [&Vec3; N]) -> f64,
    ) -> bool {
        let limit = self.reach
            + match self.together {
                Some(end) => self.way_against(end, &own, &others),
                None => self.way(&own) + other.way(&others),
            };
        let x = own.map(|p| &self.start[p as usize]);
        let y = others.map(|p| &other.start[p as usize]);
        squared(x, y) <= limit * limit
    }

    /// The longest way of one of the points against one of the others \[m\], all going by the same fraction.
    #[inline(always)]
    fn way_against(&self, end: &[Vec3], own: &[u32], others: &[u32]) -> f64 {
        let mut longest: f64 = 0.0;
        for &p in own {
            let way = end[p as usize] - self.start[p as usize];
            for &q in others {
                let against = (way - (end[q as usize] - self.start[q as usize])).norm_squared();
                longest = longest.max(if against.is_finite() { against } else { 0.0 });
            }
        }
        longest.sqrt()
    }

    /// The longest way of these points \[m\].
    #[inline(always)]
    fn way(&self, points: &[u32]) -> f64 {
        if self.ways.is_empty() {
            return 0.0;
        }
        points.iter().map(|&p| self.ways[p as usize]).fold(0.0, f64::max)
    }
}

/// Pairs whose boxes are near, on their way to the exact test. Collected first and tested then, and added without
/// a branch, because which box test passes cannot be predicted and a wrong guess costs more than the test.
#[derive(Default)]
struct Shortlist {
    pairs: Vec<[u32; 2]>,
    count: usize,
}

impl Shortlist {
    /// Room for that many calls of [`Shortlist::add_if`].
    #[inline(always)]
    fn make_room(&mut self, more: usize) {
        if self.count + more > self.pairs.len() {
            self.pairs.resize(2 * self.pairs.len() + more, [0; 2]);
        }
    }

    #[inline(always)]
    fn add_if(&mut self, pair: [u32; 2], yes: bool) {
        self.pairs[self.count] = pair;
        self.count += usize::from(yes);
    }

    /// The lower index of each pair first.
    fn ordered(&mut self) {
        self.pairs[..self.count]
            .iter_mut()
            .for_each(|pair| *pair = [pair[0].min(pair[1]), pair[0].max(pair[1])]);
    }

    /// Takes all pairs off the list, and gives those that pass the test.
    #[inline(always)]
    fn drain(&mut self, test: impl Fn(u32, u32) -> bool) -> Vec<[u32; 2]> {
        let mut kept = 0;
        for k in 0..std::mem::take(&mut self.count) {
            let pair = self.pairs[k];
            self.pairs[kept] = pair;
            kept += usize::from(test(pair[0], pair[1]));
        }
        self.pairs[..kept].to_vec()
    }
}

/// Merges the parts and sorts by both indices; the first is below `count`. Counting sort, then short runs.
fn sorted(parts: &[Vec<[u32; 2]>], count: usize) -> Vec<[u32; 2]> {
    let mut ends = vec![0u32; count + 1];
    for &[first, _] in parts.iter().flatten() {
        ends[first as usize + 1] += 1;
    }
    for i in 0..count {
        ends[i + 1] += ends[i];
    }
    let mut merged = vec![[0u32; 2]; ends[count] as usize];
    let mut next = ends.clone();
    for pair in parts.iter().flatten() {
        let slot = &mut next[pair[0] as usize];
        merged[*slot as usize] = *pair;
        *slot += 1;
    }
    for run in ends.windows(2) {
        merged[run[0] as usize..run[1] as usize].sort_unstable_by_key(|pair| pair[1]);
    }
    merged
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::Draw;
    use std::collections::BTreeSet;
    use std::time::Instant;

    struct Mesh {
        points: Vec<Vec3>,
        triangles: Vec<[PointIndex; 3]>,
        topology: Topology,
    }

    impl Mesh {
        /// `layers` sheets of nearly equilateral triangles with sides of 8 mm, `nx` by `ny` cells, `apart` \[m\] above
        /// each other, each shifted by part of a cell and shaken by `shake` \[m\].
        fn pile(layers: usize, nx: usize, ny: usize, apart: f64, shake: f64) -> Self {
            let (mut points, mut triangles) = (Vec::new(), Vec::new());
            let mut draw = Draw::from_state(31);
            for layer in 0..layers {
                let base = points.len() as u32;
                for i in 0..(nx + 1) * (ny + 1) {
                    let (column, row) = ((i % (nx + 1)) as f64, (i / (nx + 1)) as f64);
                    let x = 8e-3 * (column + 0.5 * (row % 2.0) + 0.37 * layer as f64);
                    let flat = Vec3::new(x, 8e-3 * 0.866 * row, apart * layer as f64);
                    points.push(flat + draw.vector() * shake);
                }
                for i in 0..nx * ny {
                    let (column, row) = (i % nx, i / nx);
                    let a = base + (row * (nx + 1) + column) as u32;
                    let (b, c, d) = (a + 1, a + nx as u32 + 1, a + nx as u32 + 2);
                    let two = if row % 2 == 0 { [[a, b, c], [b, d, c]] } else { [[a, b, d], [a, d, c]] };
                    triangles.extend(two.map(|t| t.map(PointIndex)));
                }
            }
            let topology = Topology::new(points.len(), &triangles);
            Self { points, triangles, topology }
        }

        fn finder(&self) -> CandidateFinder {
            CandidateFinder::new(&self.points, &self.triangles, &self.topology)
        }
    }

    fn shaken(points: &[Vec3], by: f64, draw: &mut Draw) -> Vec<Vec3> {
        points.iter().map(|x| x + draw.vector() * by).collect()
    }

    /// Every pair that comes within the reach for any fractions must be there; tried at random fractions.
    fn assert_complete(mesh: &Mesh, end: &[Vec3], reach: f64, found: &Candidates, draw: &mut Draw) {
        let finder = mesh.finder();
        let quads: BTreeSet<Quad> = found.quads(&finder).collect();
        assert_eq!(quads.len(), found.len(), "no pair twice");
        let mut near = 0;
        for _ in 0..4 {
            let now: Vec<Vec3> =
                mesh.points.iter().zip(end).map(|(x, y)| x + (y - x) * draw.unit().sqrt()).collect();
            let mut check = |quad: Quad| {
                let shared = (0..4).any(|i| (0..i).any(|j| quad.points[i] == quad.points[j]));
                if !shared && quad.gap(&now).distance <= reach {
                    near += 1;
                    assert!(quads.contains(&quad), "{quad:?} is missing");
                }
            };
            for p in 0..mesh.points.len() as u32 {
                (0..mesh.triangles.len() as u32).for_each(|f| check(finder.quad_point_triangle(p, f)));
            }
            for e in 0..mesh.topology.edges.len() as u32 {
                (0..e).for_each(|f| check(finder.quad_edge_edge(f, e)));
            }
        }
        assert!(near > 100, "only {near} pairs are near");
    }

    #[test]
    fn no_pair_that_may_come_near_is_missing() {
        let mesh = Mesh::pile(3, 6, 5, 1e-3, 2e-4);
        let mut draw = Draw::from_state(5);
        for (way, reach) in [(0.0, 3e-3), (1e-3, 2e-3), (8e-3, 1e-3), (2e-2, 0.0)] {
            let end = shaken(&mesh.points, way, &mut draw);
            let found = mesh.finder().find(&mesh.points, &end, reach, false, &|_| false);
            if way < 1e-2 {
                assert_complete(&mesh, &end, reach, &found, &mut draw);
            }
            assert!(found.point_triangle.is_sorted() && found.edge_edge.is_sorted());
            assert!(found.edge_edge.iter().all(|[e, f]| e < f));
        }
    }

    /// Around a portion that moves while the rest does not: the same pairs as a search of everything, less those that rest.
    #[test]
    fn around_a_portion_no_pair_is_missing_and_none_too_many() {
        let mesh = Mesh::pile(4, 6, 5, 1e-3, 2e-4);
        let mut draw = Draw::from_state(9);
        let moving: Vec<bool> = (0..mesh.points.len()).map(|p| p % 11 < 2).collect();
        for way in [0.0, 1e-3, 8e-3] {
            let all = shaken(&mesh.points, way, &mut draw);
            let ends = mesh.points.iter().zip(&all).zip(&moving);
            let end: Vec<Vec3> = ends.map(|((x, y), moving)| if *moving { *y } else { *x }).collect();
            let rests = |quad: Quad| quad.points.iter().all(|p| !moving[p.at()]);
            for together in [false, true] {
                let wanted = mesh.finder().find(&mesh.points, &end, 2e-3, together, &rests);
                let mut finder = mesh.finder();
                let portion = finder.portion(&moving, &mesh.points, 2e-3);
                // What is found does not depend on where the portion went before.
                let elsewhere = shaken(&mesh.points, 4e-3, &mut draw);
                for (target, told) in [(&elsewhere, false), (&all, true)] {
                    let to = |p: usize| if moving[p] { target[p] } else { mesh.points[p] };
                    let end: Vec<Vec3> = (0..moving.len()).map(to).collect();
                    let found = finder.find_around(&portion, &mesh.points, &end, 2e-3, together, &rests);
                    assert!(!told || found == wanted, "{way} {together}");
                }
                assert!(wanted.len() > 100, "{}", wanted.len());
            }
        }
    }

    #[test]
    fn what_is_kept_gives_the_same_answers() {
        let mesh = Mesh::pile(3, 12, 10, 1.2e-3, 3e-4);
        let (mut kept, mut anew) = (mesh.finder(), mesh.finder());
        let mut draw = Draw::from_state(3);
        let reach = 1.5e-3;
        let skip = |quad: Quad| quad.points.iter().all(|p| p.at() % 3 == 0);
        let mut x = mesh.points.clone();
        let mut served = [0; 3];
        for round in 0..60 {
            let mut end = x.clone();
            if round % 2 == 1 {
                // Everything a little, or a corner far as well, or all of it.
                let few = if round % 6 == 5 { x.len() } else { x.len() / 20 * (round % 4) };
                end = shaken(&x, 2e-5, &mut draw);
                end[..few].iter_mut().for_each(|x| *x += draw.vector() * 2e-3);
            }
            let together = round % 3 == 0;
            let found = kept.find_again(&x, &end, reach, together, &skip);
            assert_eq!(found, anew.find(&x, &end, reach, together, &skip), "round {round}");
            match kept.far(&x, &end, reach) {
                None => served[0] += 1,
                Some(far) => served[1 + usize::from(far.contains(&true))] += 1,
            }
            x = end;
            let moving: Vec<bool> = (0..x.len()).map(|p| p % 90 < 20).collect();
            let portion = kept.portion(&moving, &x, reach);
            let some = |by: f64, draw: &mut Draw| -> Vec<Vec3> {
                x.iter().zip(&moving).map(|(x, m)| if *m { x + draw.vector() * by } else { *x }).collect()
            };
            for by in [1e-5, 1e-3] {
                let end = some(by, &mut draw);
                let found = kept.find_around(&portion, &x, &end, reach, false, &skip);
                let fresh = anew.portion(&moving, &x, reach);
                assert!(fresh.known.is_none());
                assert_eq!(found, anew.find_around(&fresh, &x, &end, reach, false, &skip), "round {round}");
            }
        }
        assert!(served.iter().all(|count| *count > 5), "without, with and partly with the list: {served:?}");
    }

    #[test]
    fn between_a_portion_and_another_mesh_no_pair_is_missing() {
        let (mesh, other) = (Mesh::pile(1, 6, 5, 1e-3, 2e-4), Mesh::pile(1, 7, 4, 1e-3, 2e-4));
        let below: Vec<Vec3> = other.points.iter().map(|x| x - Vec3::z() * 1e-3).collect();
        let moving: Vec<bool> = (0..mesh.points.len()).map(|p| p % 7 == 0).collect();
        let mut draw = Draw::from_state(4);
        let all = shaken(&mesh.points, 3e-3, &mut draw);
        let end: Vec<Vec3> =
            (0..all.len()).map(|p| if moving[p] { all[p] } else { mesh.points[p] }).collect();
        let (mut finder, mut second) = (mesh.finder(), other.finder());
        let everything = finder.find_between(&mesh.points, &end, &mut second, &below, &below, 2e-3);
        second.rest(&below, 2e-3);
        let portion = finder.portion(&moving, &mesh.points, 2e-3);
        let found = finder.find_between_around(&portion, &mesh.points, &end, &second, &below, 2e-3);
        let (count, fixed) = (mesh.points.len() as u32, mesh.finder());
        let moves = |quad: &Quad| quad.points.iter().any(|p| moving.get(p.at()).is_some_and(|m| *m));
        let quads = |found: &CandidatesBetween| -> BTreeSet<Quad> {
            found.quads(&fixed, &second, count).filter(moves).collect()
        };
        let wanted = quads(&everything);
        assert!(wanted.len() > 30, "{}", wanted.len());
        assert_eq!(quads(&found), wanted);
    }

    #[test]
    fn at_rest_the_candidates_are_exactly_the_pairs_within_reach() {
        let mesh = Mesh::pile(3, 6, 5, 1e-3, 2e-4);
        let mut finder = mesh.finder();
        for reach in [1.2e-3, 3e-3, 6e-3] {
            let found = finder.find(&mesh.points, &mesh.points, reach, false, &|_| false);
            assert!(
                found.quads(&finder).all(|q| q.gap(&mesh.points).distance <= reach * (1.0 + 2.0 * ROUNDING))
            );
            let mut draw = Draw::from_state(6);
            assert_complete(&mesh, &mesh.points, reach, &found, &mut draw);
        }
    }

    #[test]
    fn the_answer_knows_no_history_and_no_threads() {
        let mesh = Mesh::pile(3, 12, 12, 1e-3, 2e-4);
        let mut draw = Draw::from_state(8);
        let (mut old, mut at) = (mesh.finder(), mesh.points.clone());
        for _ in 0..5 {
            let start = shaken(&at, 6e-3, &mut draw);
            let end = shaken(&start, 2e-3, &mut draw);
            let expected = mesh.finder().find(&start, &end, 2e-3, false, &|_| false);
            for threads in [1, 3] {
                let Ok(pool) = rayon::ThreadPoolBuilder::new().num_threads(threads).build() else {
                    panic!("no threads")
                };
                let found = pool.install(|| old.find(&start, &end, 2e-3, false, &|_| false));
                assert!(found == expected);
            }
            at = end;
        }
    }

    #[test]
    fn skipped_pairs_isolated_points_and_points_not_finite_are_left_out() {
        let mut mesh = Mesh::pile(2, 4, 4, 1e-3, 0.0);
        let lone = mesh.points.len() as u32;
        mesh.points.push(Vec3::new(0.01, 0.01, 5e-4));
        mesh.topology = Topology::new(mesh.points.len(), &mesh.triangles);
        let mut finder = mesh.finder();
        let all = finder.find(&mesh.points, &mesh.points, 2e-3, false, &|_| false);
        assert!(all.point_triangle.iter().all(|pair| pair[0] != lone));
        let without = |quad: &Quad| !quad.points.contains(&PointIndex(6));
        let some =
            finder.find(&mesh.points, &mesh.points, 2e-3, false, &|q| q.points.contains(&PointIndex(6)));
        assert!(all.quads(&finder).filter(without).eq(some.quads(&finder)) && some.len() < all.len());
        mesh.points[6].x = f64::NAN;
        // Its triangles are left out whole, and with them the pairs of what belongs to them.
        let finite = finder.find(&mesh.points, &mesh.points, 2e-3, false, &|_| false);
        assert!(finite.quads(&finder).all(|quad| without(&quad)) && finite.len() > all.len() / 2);
    }

    #[test]
    fn between_two_meshes_no_near_pair_is_missing_and_nothing_else_is_there() {
        let cloth = Mesh::pile(2, 6, 6, 1e-3, 1e-4);
        let mut body = Mesh::pile(1, 5, 5, 1e-3, 1e-4);
        body.points.iter_mut().for_each(|x| *x = Vec3::new(x.x, x.y * 1.3, x.z - 1.5e-3));
        let (mut one, mut other) = (cloth.finder(), body.finder());
        let reach = 2e-3;
        let found =
            one.find_between(&cloth.points, &cloth.points, &mut other, &body.points, &body.points, reach);
        let offset = cloth.points.len() as u32;
        let together: Vec<Vec3> = cloth.points.iter().chain(&body.points).copied().collect();
        let quads: BTreeSet<Quad> = found.quads(&one, &other, offset).collect();
        assert_eq!(quads.len(), found.len());
        assert!(quads.iter().all(|q| q.gap(&together).distance <= reach * (1.0 + 2.0 * ROUNDING)));
        let mut expected = 0;
        let mut check = |kind: PairKind, points: Vec<u32>| {
            let quad = Quad { kind, points: [0, 1, 2, 3].map(|i| PointIndex(points[i])) };
            if quad.gap(&together).distance <= reach {
                expected += 1;
                assert!(quads.contains(&quad), "{quad:?}");
            }
        };
        let shifted = |points: &[u32]| points.iter().map(|p| p + offset).collect::<Vec<u32>>();
        for t in &other.triangles {
            (0..offset).for_each(|p| check(PairKind::PointTriangle, [vec![p], shifted(&t.corners)].concat()));
        }
        for t in &one.triangles {
            let body_points = offset..together.len() as u32;
            body_points.for_each(|p| check(PairKind::PointTriangle, [vec![p], t.corners.to_vec()].concat()));
        }
        for e in &one.edges {
            other.edges.iter().for_each(|f| check(PairKind::EdgeEdge, [e.to_vec(), shifted(f)].concat()));
        }
        assert!(expected > 300 && quads.len() == expected, "{expected} {}", quads.len());
    }

    #[test]
    fn rest_distance_is_that_of_the_rest_shape() {
        let mesh = Mesh::pile(1, 4, 4, 1e-3, 0.0);
        let points = [0, 1, 6, 7].map(PointIndex);
        assert_eq!(rest_distance(PairKind::EdgeEdge, [0, 1, 3, 4].map(PointIndex), &mesh.points), 16e-3);
        assert!(rest_distance(PairKind::PointTriangle, points, &mesh.points) > 0.0);
    }

    /// Seconds of a whole garment of 14,000 points. Run by: cargo test --release --lib speed -- --ignored --nocapture
    #[test]
    #[ignore = "a measurement"]
    fn speed() {
        let time = |what: &str, run: &mut dyn FnMut() -> usize| {
            let mut best = f64::INFINITY;
            let mut count = 0;
            for _ in 0..30 {
                let begin = Instant::now();
                count = run();
                best = best.min(begin.elapsed().as_secs_f64());
            }
            println!("  {what}: {:.1} ms, {count}", best * 1e3);
        };
        for (name, mesh) in [
            ("2 layers 5 mm apart", Mesh::pile(2, 82, 82, 5e-3, 2e-4)),
            ("2 layers 1 mm apart", Mesh::pile(2, 82, 82, 1e-3, 1e-4)),
            ("8 layers 1 mm apart", Mesh::pile(8, 41, 41, 1e-3, 1e-4)),
            ("8 layers 0.5 mm apart", Mesh::pile(8, 41, 41, 5e-4, 5e-5)),
        ] {
            println!("{name}: {} points, {} triangles", mesh.points.len(), mesh.triangles.len());
            let mut draw = Draw::from_state(1);
            let mut finder = mesh.finder();
            let x = mesh.points.clone();
            let mut count = 0;
            time("refit", &mut || {
                finder.fit(&x, &x, 1.5e-3);
                0
            });
            time("triangle pairs (reach 3 mm)", &mut || {
                count = finder.tree.overlaps().len();
                count
            });
            time("candidates, reach 3 mm, at rest", &mut || {
                finder.find(&x, &x, 3e-3, false, &|_| false).len()
            });
            time("candidates, reach 1 mm, at rest", &mut || {
                finder.find(&x, &x, 1e-3, false, &|_| false).len()
            });
            let end = shaken(&x, 1e-3, &mut draw);
            time("candidates, reach 1 mm, way 1 mm", &mut || {
                finder.find(&x, &end, 1e-3, false, &|_| false).len()
            });
            let found = finder.find(&x, &end, 1e-3, false, &|_| false);
            println!("    {} + {}", found.point_triangle.len(), found.edge_edge.len());
            let mut quads: Vec<Quad> = Vec::new();
            time("quads", &mut || {
                quads.clear();
                quads.extend(found.quads(&finder));
                quads.len()
            });
            let d: Vec<Vec3> = x.iter().zip(&end).map(|(x, y)| y - x).collect();
            let floors = vec![2e-4; quads.len()];
            time("local step fractions (rounds)", &mut || {
                crate::contact::bound::local_step_fractions(&quads, &floors, &x, &d).rounds
            });
            time("distances", &mut || quads.iter().filter(|q| q.gap(&x).distance < 1e-3).count());
            time("crossings", &mut || crate::mesh::crossings::crossings(&x, &mesh.triangles).len());
        }
    }
}
