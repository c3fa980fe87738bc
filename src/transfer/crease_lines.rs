//! Crease lines of a memory: chains of strong hinges that run straight on, and their signed distance on the surface.
//!
//! A fold that was made on a mesh with edges along it is remembered by the hinges of these edges. Such a chain is a line on the
//! source; the signed distance from it, taken where the points of a target are matched, draws it on the target
//! ([`crate::transfer::crease_drawing`]). Memory on triangles that follow no line has no chains.

use crate::transfer::tuning::TUNING;
use crease_geometry::math::Vec3;
use crease_model::garment::RestState;
use crease_model::remesh::{GarmentSurface, HingeChain};
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
    let strong =
        |h: usize| (memory.rest_angle[h] - memory.source_angle[h]).abs() >= TUNING.min_crease_line_angle;
    let mut chains =
        HingeChain::all(&surface.points, &surface.topology, strong, TUNING.min_crease_line_cosine);
    chains.retain(|chain| chain.length >= TUNING.min_crease_line_fraction * size);
    chains.sort_by(|a, b| b.length.total_cmp(&a.length).then_with(|| a.points.cmp(&b.points)));
    for chain in chains {
        let line = CreaseLine::of(&chain, surface, target_edge);
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

impl CreaseLine {
    fn of(chain: &HingeChain, surface: &GarmentSurface, target_edge: f64) -> Self {
        let mut heights = Vec::new();
        let mut start = Vec::new();
        for (ends, h) in chain.edges() {
            for f in surface.topology.hinges[*h as usize].triangles {
                heights
                    .push(surface.normal(f as usize).norm() / length(surface, ends).max(f64::MIN_POSITIVE));
                start.push(f);
            }
        }
        heights.sort_by(f64::total_cmp);
        let row = heights[heights.len() / 2].clamp(TUNING.min_crease_row, TUNING.max_crease_row);
        let reach = TUNING.crease_line_reach * (row + target_edge);
        Self {
            points: chain.points.iter().map(|&p| surface.points[p as usize]).collect(),
            hinges: chain.hinges.clone(),
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
