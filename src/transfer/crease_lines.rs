//! Crease lines of a memory: chains of strong hinges that run straight on, and their signed distance on the surface.
//!
//! A fold that was made on a mesh with edges along it is remembered by the hinges of these edges. Such a chain is a line on the
//! source; the signed distance from it, taken where the points of a target are matched, draws it on the target
//! ([`crate::transfer::crease_drawing`]). Memory on triangles that follow no line has no chains.

use crate::transfer::tuning::TUNING;
use crease_geometry::math::Vec3;
use crease_model::garment::RestState;
use crease_model::remesh::GarmentSurface;
use rustc_hash::{FxHashMap, FxHashSet};
use std::cmp::Reverse;
use std::collections::BinaryHeap;

/// A crease line on a source surface.
#[derive(Debug, Clone)]
pub(super) struct CreaseLine {
    /// Its points in order [m].
    points: Vec<Vec3>,
    /// Hinge of the source between each two of them.
    pub hinges: Vec<u32>,
    /// Triangles of the source around it, on its own layer.
    around: FxHashSet<u32>,
    /// Height of the triangles beside it [m]: what lies farther off does not belong to the crease.
    pub row: f64,
}

impl CreaseLine {
    /// Signed distance of the place `x` of source triangle `face` from the line [m]; `None` where the line does not reach.
    pub fn level(&self, surface: &GarmentSurface, face: usize, x: &Vec3) -> Option<f64> {
        self.locate(surface, face, x).map(|(level, _)| level)
    }

    /// The signed distance of such a place, and the number of the hinge of the line it is next to.
    pub fn locate(&self, surface: &GarmentSurface, face: usize, x: &Vec3) -> Option<(f64, usize)> {
        if !self.around.contains(&(face as u32)) {
            return None;
        }
        let normal = surface.normal(face).try_normalize(0.0)?;
        let last = self.points.len() - 2;
        let mut best: Option<(f64, (f64, usize))> = None;
        for (k, ends) in self.points.windows(2).enumerate() {
            let along = ends[1] - ends[0];
            let length = along.norm();
            let direction = along / length.max(f64::MIN_POSITIVE);
            let foot = (x - ends[0]).dot(&direction);
            // The line goes on past its ends, so that it reaches the border of the cloth.
            let low = if k == 0 { -TUNING.crease_line_overhang * self.row } else { 0.0 };
            let high = length + if k == last { TUNING.crease_line_overhang * self.row } else { 0.0 };
            let apart = x - (ends[0] + direction * foot.clamp(low, high));
            let distance = apart.norm();
            if best.is_none_or(|(least, _)| distance < least) {
                let is_past = (k == 0 && foot < low) || (k == last && foot > high);
                let level = if is_past { f64::NAN } else { apart.dot(&normal.cross(&direction)) };
                best = Some((distance, (level, k)));
            }
        }
        best.map(|(_, found)| found).filter(|(level, _)| level.is_finite())
    }

    /// Length of hinge `k` of the line [m].
    pub fn hinge_length(&self, k: usize) -> f64 {
        (self.points[k + 1] - self.points[k]).norm()
    }

    fn length(&self) -> f64 {
        (0..self.hinges.len()).map(|k| self.hinge_length(k)).sum()
    }
}

/// Crease lines that `memory` has on `surface`, the longest first, for a target of mean edge `target_edge` [m] and of diagonal
/// `size` [m].
pub(super) fn crease_lines(
    surface: &GarmentSurface,
    memory: &RestState,
    target_edge: f64,
    size: f64,
) -> Vec<CreaseLine> {
    let mut lines: Vec<CreaseLine> = Vec::new();
    let mut chains = chains(surface, memory);
    chains.retain(|chain| chain.length >= TUNING.min_crease_line_fraction * size);
    chains.sort_by(|a, b| b.length.total_cmp(&a.length).then_with(|| a.points.cmp(&b.points)));
    for chain in chains {
        let line = chain.line(surface, target_edge);
        // Two rows of strong hinges side by side are one crease.
        let beside = |(ends, h): &(&[u32], &u32)| {
            let middle = 0.5 * (surface.points[ends[0] as usize] + surface.points[ends[1] as usize]);
            surface.topology.hinges[**h as usize].triangles.iter().any(|&f| {
                let level = |other: &CreaseLine| other.level(surface, f as usize, &middle);
                lines.iter().any(|other| level(other).is_some_and(|level| level.abs() < other.row))
            })
        };
        let covered: f64 = chain.edges().filter(beside).map(|(ends, _)| length(surface, ends)).sum();
        if covered < 0.5 * line.length() {
            lines.push(line);
        }
    }
    lines
}

fn length(surface: &GarmentSurface, ends: &[u32]) -> f64 {
    (surface.points[ends[1] as usize] - surface.points[ends[0] as usize]).norm()
}

/// Strong hinges that go straight on from one another.
struct Chain {
    /// Points along it.
    points: Vec<u32>,
    /// Hinge between each two of them.
    hinges: Vec<u32>,
    /// Its length [m].
    length: f64,
}

impl Chain {
    /// Ends and hinge of every edge.
    fn edges(&self) -> impl Iterator<Item = (&[u32], &u32)> {
        self.points.windows(2).zip(&self.hinges)
    }

    fn line(&self, surface: &GarmentSurface, target_edge: f64) -> CreaseLine {
        let mut heights = Vec::new();
        let mut start = Vec::new();
        for (ends, h) in self.edges() {
            for f in surface.topology.hinges[*h as usize].triangles {
                heights
                    .push(surface.normal(f as usize).norm() / length(surface, ends).max(f64::MIN_POSITIVE));
                start.push(f);
            }
        }
        heights.sort_by(f64::total_cmp);
        let row = heights[heights.len() / 2].clamp(TUNING.min_crease_row, TUNING.max_crease_row);
        let reach = TUNING.crease_line_reach * (row + target_edge);
        CreaseLine {
            points: self.points.iter().map(|&p| surface.points[p as usize]).collect(),
            hinges: self.hinges.clone(),
            around: triangles_within(surface, &start, reach),
            row,
        }
    }
}

/// Triangles within `reach` [m] of those of `start`, from neighbour to neighbour.
fn triangles_within(surface: &GarmentSurface, start: &[u32], reach: f64) -> FxHashSet<u32> {
    let mut distance: FxHashMap<u32, f64> = start.iter().map(|&f| (f, 0.0)).collect();
    // Distances are positive, and so their bits are in order.
    let mut queue: BinaryHeap<Reverse<(u64, u32)>> = start.iter().map(|&f| Reverse((0, f))).collect();
    while let Some(Reverse((bits, f))) = queue.pop() {
        let own = f64::from_bits(bits);
        if distance.get(&f).is_some_and(|known| *known < own) {
            continue;
        }
        for e in surface.topology.triangle_edges[f as usize] {
            let Some(h) = surface.topology.edge_hinge[e as usize] else { continue };
            for g in surface.topology.hinges[h as usize].triangles {
                let there = own + (surface.centroid(g as usize) - surface.centroid(f as usize)).norm();
                if there <= reach && distance.get(&g).is_none_or(|known| there < *known) {
                    distance.insert(g, there);
                    queue.push(Reverse((there.to_bits(), g)));
                }
            }
        }
    }
    distance.into_keys().collect()
}

/// Chains of strong hinges that go straight on from one another.
fn chains(surface: &GarmentSurface, memory: &RestState) -> Vec<Chain> {
    let mut at_point: FxHashMap<u32, Vec<u32>> = FxHashMap::default();
    let (mut edges, mut hinges) = (Vec::new(), Vec::new());
    for (h, hinge) in surface.topology.hinges.iter().enumerate() {
        if (memory.rest_angle[h] - memory.source_angle[h]).abs() >= TUNING.min_crease_line_angle {
            for p in &hinge.points[..2] {
                at_point.entry(p.0).or_default().push(edges.len() as u32);
            }
            edges.push([hinge.points[0].0, hinge.points[1].0]);
            hinges.push(h as u32);
        }
    }
    let next = continuations(surface, &edges, &at_point);
    let mut used = vec![false; edges.len()];
    let mut chains = Vec::new();
    for first in 0..edges.len() {
        if used[first] {
            continue;
        }
        used[first] = true;
        // From the second end on, then from the first: points, and the hinges after the first edge.
        let mut halves: [(Vec<u32>, Vec<u32>); 2] = Default::default();
        for ((points, beyond), end) in halves.iter_mut().zip([1, 0]) {
            let (mut edge, mut end) = (first, end);
            loop {
                let point = edges[edge][end];
                points.push(point);
                let Some(other) = next[edge][end].filter(|other| !used[*other as usize]) else { break };
                edge = other as usize;
                used[edge] = true;
                beyond.push(hinges[edge]);
                end = usize::from(edges[edge][0] == point);
            }
        }
        let [(ahead, hinges_ahead), (back, hinges_back)] = halves;
        let points: Vec<u32> = back.into_iter().rev().chain(ahead).collect();
        chains.push(Chain {
            length: points.windows(2).map(|ends| length(surface, ends)).sum(),
            points,
            hinges: hinges_back.into_iter().rev().chain([hinges[first]]).chain(hinges_ahead).collect(),
        });
    }
    chains
}

/// Per edge and end: the edge that goes on there. At every point the straightest pairs are joined first.
fn continuations(
    surface: &GarmentSurface,
    edges: &[[u32; 2]],
    at_point: &FxHashMap<u32, Vec<u32>>,
) -> Vec<[Option<u32>; 2]> {
    let mut next = vec![[None; 2]; edges.len()];
    let mut points: Vec<&u32> = at_point.keys().collect();
    points.sort_unstable();
    for p in points {
        let own = &at_point[p];
        let outward = |e: u32| {
            let [a, b] = edges[e as usize];
            let other = if a == *p { b } else { a };
            (surface.points[other as usize] - surface.points[*p as usize])
                .try_normalize(0.0)
                .unwrap_or_else(Vec3::zeros)
        };
        let mut pairs = Vec::new();
        for (i, &a) in own.iter().enumerate() {
            for &b in &own[i + 1..] {
                let cosine = -outward(a).dot(&outward(b));
                if cosine >= TUNING.min_crease_line_cosine {
                    pairs.push((cosine, a, b));
                }
            }
        }
        pairs.sort_by(|x, y| y.0.total_cmp(&x.0).then((x.1, x.2).cmp(&(y.1, y.2))));
        let end = |e: u32| usize::from(edges[e as usize][1] == *p);
        for (_, a, b) in pairs {
            if next[a as usize][end(a)].is_none() && next[b as usize][end(b)].is_none() {
                next[a as usize][end(a)] = Some(b);
                next[b as usize][end(b)] = Some(a);
            }
        }
    }
    next
}
