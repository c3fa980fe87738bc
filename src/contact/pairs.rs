//! Cloth against cloth: point-triangle and edge-edge pairs within the contact distance, and the bound on motion.

use super::ContactSettings;
use super::barrier;
use super::bound::local_step_fractions;
use super::candidates::{CandidateFinder, Candidates, PairKind, Quad};
use crate::math::Vec3;
use crate::mesh::distance::Gap;
use crate::mesh::tree::TriangleTree;
use crate::mesh::{PointIndex, Topology};
use rayon::prelude::*;

/// A pair within its contact distance.
#[derive(Debug, Clone, Copy)]
pub(super) struct Touch {
    pub points: [u32; 4],
    /// Signed: distance vector = sum w_i x_i.
    pub weights: [f64; 4],
    /// Unit vector along the distance vector.
    pub normal: Vec3,
    /// [m].
    pub distance: f64,
    /// Contact distance of this pair [m].
    pub reach: f64,
    /// [N/m].
    pub stiffness: f64,
}

/// A pair that may come near.
#[derive(Debug, Clone, Copy)]
struct Pair {
    points: [u32; 4],
    kind: PairKind,
    /// Contact distance [m]: shorter for pairs that are near by construction (beside a seam).
    reach: f64,
    /// Area the pair stands for [m²].
    area: f64,
}

pub(super) struct PairContact {
    distance: f64,
    stiffness: f64,
    rest: Vec<Vec3>,
    triangles: Vec<[PointIndex; 3]>,
    edges: Vec<[u32; 2]>,
    point_area: Vec<f64>,
    edge_area: Vec<f64>,
    finder: CandidateFinder,
    pairs: Vec<Pair>,
    /// Points that stay where they are during the step, one flag per point; empty for none.
    pub asleep: Vec<bool>,
}

/// Pairs that are this near in the rest shape push apart only below this share of their rest distance.
const REST_SHARE: f64 = 0.9;
/// Candidates reach this many contact distances, so that the pattern of the linear system can look ahead.
const CANDIDATE_MARGIN: f64 = 1.5;

impl PairContact {
    pub fn new(
        settings: &ContactSettings,
        rest: &[Vec3],
        triangles: &[[PointIndex; 3]],
        topology: &Topology,
        area: &[f64],
    ) -> Self {
        // An edge stands for a third of the area of its two ends' share along it: sum over edges = sum over points.
        let mut degree = vec![0.0f64; rest.len()];
        let edges: Vec<[u32; 2]> = topology.edges.iter().map(|e| e.map(|p| p.0)).collect();
        for e in &edges {
            e.iter().for_each(|&p| degree[p as usize] += 1.0);
        }
        let share = |p: u32| area[p as usize] / degree[p as usize].max(1.0);
        let edge_area = edges.iter().map(|e| share(e[0]) + share(e[1])).collect();
        Self {
            distance: settings.distance,
            stiffness: settings.stiffness,
            rest: rest.to_vec(),
            triangles: triangles.to_vec(),
            edges,
            point_area: area.to_vec(),
            edge_area,
            finder: CandidateFinder::new(rest, triangles, topology),
            pairs: Vec::new(),
            asleep: Vec::new(),
        }
    }

    fn take(&mut self, found: Candidates) {
        let point = |&[p, f]: &[u32; 2]| {
            let t = self.triangles[f as usize].map(|c| c.0);
            (([p, t[0], t[1], t[2]]), PairKind::PointTriangle, 0.5 * self.point_area[p as usize])
        };
        let edge = |&[a, b]: &[u32; 2]| {
            let (e, f) = (self.edges[a as usize], self.edges[b as usize]);
            let area = 0.25 * (self.edge_area[a as usize] + self.edge_area[b as usize]);
            (([e[0], e[1], f[0], f[1]]), PairKind::EdgeEdge, area)
        };
        let rest = &self.rest;
        let distance = self.distance;
        self.pairs = found
            .point_triangle
            .par_iter()
            .map(point)
            .chain(found.edge_edge.par_iter().map(edge))
            .map(|(points, kind, area)| {
                let near = gap(rest, &points, kind).distance;
                Pair { points, kind, reach: distance.min(REST_SHARE * near), area }
            })
            .collect();
    }

    pub fn look_around(&mut self, x: &[Vec3]) {
        let found = self.finder.find(x, x, CANDIDATE_MARGIN * self.distance, true, &sleeps(&self.asleep));
        self.take(found);
    }

    /// See [`super::Contact::uncovered_area`].
    pub fn uncovered_area(&self, x: &[Vec3]) -> Vec<f64> {
        let tree = TriangleTree::new(x, &self.triangles, 0.0);
        let open: Vec<f64> = self
            .triangles
            .par_iter()
            .map(|t| {
                let [a, b, c] = t.map(|p| x[p.at()]);
                let centre = (a + b + c) / 3.0 + Vec3::y() * 1e-6;
                let shadow = 0.5 * ((b - a).cross(&(c - a))).y.abs();
                if tree.any_hit(x, centre, Vec3::y(), 10.0) { 0.0 } else { shadow }
            })
            .collect();
        let mut area = vec![0.0; x.len()];
        for (t, open) in self.triangles.iter().zip(open) {
            t.iter().for_each(|p| area[p.at()] += open / 3.0);
        }
        area
    }

    /// All pairs within their contact distance at `x`, in a fixed order.
    pub fn touches(&self, x: &[Vec3]) -> Vec<Touch> {
        self.touches_within(x, 1.0)
    }

    /// The same for pairs within `margin` times their contact distance (as far as they are candidates).
    pub fn touches_within(&self, x: &[Vec3], margin: f64) -> Vec<Touch> {
        self.pairs
            .par_iter()
            .filter_map(|pair| {
                let gap = gap(x, &pair.points, pair.kind);
                (gap.distance < margin * pair.reach).then(|| Touch {
                    points: pair.points,
                    weights: gap.weights,
                    normal: if gap.distance > 0.0 { gap.vector / gap.distance } else { Vec3::y() },
                    distance: gap.distance.max(1e-12),
                    reach: pair.reach,
                    stiffness: self.stiffness * pair.area,
                })
            })
            .collect()
    }

    /// See [`super::Contact::bound_motion`].
    ///
    /// Candidates hold for any fractions of the moves; every point then gets the fraction that keeps its pairs
    /// apart (`bound`). A pair may use up most of its gap in one go but not all of it: the barrier must have a say
    /// before layers come really near, or a gain elsewhere would squeeze them to nothing.
    pub fn bound_motion(&mut self, x: &[Vec3], d: &mut [Vec3]) {
        let (quads, floors) = self.on_the_way(x, d, false);
        let bounded = local_step_fractions(&quads, &floors, x, d).apply(d);
        d.copy_from_slice(&bounded);
    }

    /// See [`super::Contact::bound_together`].
    pub fn bound_together(&mut self, x: &[Vec3], d: &mut [Vec3]) {
        let (quads, floors) = self.on_the_way(x, d, true);
        let safe: Vec<f64> =
            quads.par_iter().zip(&floors).map(|(quad, floor)| quad.step(x, d, *floor)).collect();
        let least = safe.into_iter().fold(1.0, f64::min);
        d.iter_mut().for_each(|d| *d *= least);
    }

    /// Takes up the candidates for the way from x to x + d: the pairs, and how near each may come.
    fn on_the_way(&mut self, x: &[Vec3], d: &[Vec3], together: bool) -> (Vec<Quad>, Vec<f64>) {
        let end: Vec<Vec3> = x.iter().zip(d).map(|(x, d)| x + d).collect();
        let reach = CANDIDATE_MARGIN * self.distance;
        let found = self.finder.find(x, &end, reach, together, &sleeps(&self.asleep));
        self.take(found);
        self.pairs
            .par_iter()
            .map(|pair| {
                let floor = barrier::floor(gap(x, &pair.points, pair.kind).distance, pair.reach);
                (Quad { kind: pair.kind, points: pair.points.map(PointIndex) }, floor)
            })
            .unzip()
    }
}

/// Whether nothing of a pair can move.
fn sleeps(asleep: &[bool]) -> impl Fn(Quad) -> bool + Sync + '_ {
    |quad| !asleep.is_empty() && quad.points.iter().all(|p| asleep[p.at()])
}

#[inline]
fn gap(x: &[Vec3], points: &[u32; 4], kind: PairKind) -> Gap {
    kind.gap(&points.map(|p| x[p as usize]))
}
