//! Crease lines of a memory: its creases as curves on the source, and the signed distance from them on the surface.
//!
//! A fold that was made on a mesh with edges along it is remembered by the hinges of these edges and of the rows beside them. Such a crease is a
//! line on the source; the signed distance from it, taken where the points of a target are matched, draws it on the target
//! ([`crate::transfer::crease_drawing`]). Memory on triangles that follow no line has no chains. A fold is one straight line through
//! all layers of the garment that lies, and its crease is divided where the cloth turns over to the next layer.

use crate::transfer::canonical_pose::CanonicalPose;
use crate::transfer::lying_plane::LyingPlane;
use crate::transfer::tuning::TUNING;
use crease_geometry::math::{Vec2, Vec3};
use crease_model::garment::RestState;
use crease_model::remesh::{CreaseChain, GarmentSurface};
use rustc_hash::{FxHashMap, FxHashSet};
use std::cmp::Reverse;
use std::collections::BinaryHeap;
use std::ops::Range;

/// A crease line on a source surface.
#[derive(Debug, Clone)]
pub(super) struct CreaseLine {
    /// Its points in order [m].
    points: Vec<Vec3>,
    /// Per point: the length of the line up to it [m].
    lengths: Vec<f64>,
    /// Change of rest angle between each two of them, with that of the rows beside it [rad].
    pub angle: Vec<f64>,
    /// Hinges of the source between each two of them, with those of the rows beside it.
    pub hinges: Vec<Vec<u32>>,
    /// The fold that made it, if it is straight where the source lies: lines of one fold lie on one straight line there.
    pub fold: Option<Fold>,
    /// Triangles of the source around it, on its own layer.
    around: FxHashSet<u32>,
    /// Height of the triangles beside it [m]: what lies farther off does not belong to the crease.
    pub row: f64,
    /// Distance from it up to which places are looked for [m].
    pub reach: f64,
}

impl CreaseLine {
    /// Signed distance of the place `x` of source triangle `face` from the line, and the length of the line up to its foot [m]; `None` where the
    /// line does not reach.
    pub fn locate(&self, surface: &GarmentSurface, face: usize, x: &Vec3) -> Option<[f64; 2]> {
        if !self.around.contains(&(face as u32)) {
            return None;
        }
        let normal = surface.normal(face).try_normalize(0.0)?;
        let last = self.points.len() - 2;
        let mut best: Option<(f64, [f64; 2])> = None;
        for (k, ends) in self.points.windows(2).enumerate() {
            let along = ends[1] - ends[0];
            let length = along.norm();
            let direction = along / length.max(f64::MIN_POSITIVE);
            let foot = (x - ends[0]).dot(&direction);
            // The line goes on past its ends, so that it reaches the border of the cloth.
            let low = if k == 0 { -self.overhang() } else { 0.0 };
            let high = length + if k == last { self.overhang() } else { 0.0 };
            let apart = x - (ends[0] + direction * foot.clamp(low, high));
            let distance = apart.norm();
            if best.is_none_or(|(least, _)| distance < least) {
                let is_past = (k == 0 && foot < low) || (k == last && foot > high);
                let level = if is_past { f64::NAN } else { apart.dot(&normal.cross(&direction)) };
                best = Some((distance, [level, self.lengths[k] + foot.clamp(low, high)]));
            }
        }
        best.map(|(_, found)| found).filter(|[level, _]| level.is_finite())
    }

    /// Length by which the line goes on past its ends [m].
    pub fn overhang(&self) -> f64 {
        TUNING.crease_line_overhang * self.row
    }

    /// Whether the line, with what it goes on by, has a place `along` [m] from its start.
    pub fn reaches(&self, along: f64) -> bool {
        along >= -self.overhang() && along <= self.length() + self.overhang()
    }

    /// The part of the line `along` [m] from its start lies in.
    pub fn part_at(&self, along: f64) -> usize {
        self.lengths.partition_point(|length| *length <= along).saturating_sub(1).min(self.angle.len() - 1)
    }

    /// Length of part `k` of the line [m].
    pub fn part_length(&self, k: usize) -> f64 {
        self.lengths[k + 1] - self.lengths[k]
    }

    /// Its length [m].
    pub fn length(&self) -> f64 {
        self.lengths.last().copied().unwrap_or(0.0)
    }
}

/// Crease lines that `memory` has on `surface`, the strongest first, for a target of mean edge `target_edge` [m] and of diagonal
/// `size` [m]; `own` is the surface as it was before it was aligned with the target.
pub(super) fn crease_lines(
    surface: &GarmentSurface,
    own: &GarmentSurface,
    memory: &RestState,
    target_edge: f64,
    size: f64,
) -> Vec<CreaseLine> {
    let (mut lines, mut folds) = (Vec::new(), Vec::new());
    let mut plane: Option<Option<LyingPlane>> = None;
    for chain in CreaseChain::all(surface, memory) {
        let whole = CreaseLine::of(&chain, 0..chain.hinges.len(), surface, target_edge);
        let weighted: f64 = (0..whole.angle.len()).map(|k| whole.angle[k].abs() * whole.part_length(k)).sum();
        let is_fold = weighted >= TUNING.min_crease_line_angle * whole.length();
        if whole.length() < TUNING.min_crease_line_fraction * size || !is_fold {
            continue;
        }
        let plane = plane
            .get_or_insert_with(|| LyingPlane::of(&CanonicalPose::of(own).apply(own, Vec3::repeat(1.0))));
        let parts =
            plane.as_ref().and_then(|plane| straight_parts(&chain, &whole, surface, plane, &mut folds));
        match parts {
            Some(parts) => lines.extend(parts.into_iter().map(|Part { hinges, fold }| CreaseLine {
                fold,
                ..CreaseLine::of(&chain, hinges, surface, target_edge)
            })),
            None => lines.push(whole),
        }
    }
    lines
}

impl CreaseLine {
    /// The hinges `part` of `chain`.
    fn of(chain: &CreaseChain, part: Range<usize>, surface: &GarmentSurface, target_edge: f64) -> Self {
        let points: Vec<Vec3> =
            chain.points[part.start..=part.end].iter().map(|&p| surface.points[p as usize]).collect();
        let mut lengths = vec![0.0];
        for ends in points.windows(2) {
            lengths.push(lengths[lengths.len() - 1] + (ends[1] - ends[0]).norm());
        }
        let mut heights = Vec::new();
        let mut start = Vec::new();
        for (k, h) in chain.hinges[part.clone()].iter().enumerate() {
            for f in surface.topology.hinges[*h as usize].triangles {
                let length = lengths[k + 1] - lengths[k];
                heights.push(surface.normal(f as usize).norm() / length.max(f64::MIN_POSITIVE));
                start.push(f);
            }
        }
        heights.sort_by(f64::total_cmp);
        let row = heights[heights.len() / 2].clamp(TUNING.min_crease_row, TUNING.max_crease_row);
        let reach = TUNING.crease_line_reach * (row + target_edge);
        let hinges = part.clone().map(|k| [&[chain.hinges[k]], &chain.rows[k][..]].concat());
        Self {
            hinges: hinges.collect(),
            angle: chain.angle[part].to_vec(),
            around: triangles_within(surface, &start, reach),
            fold: None,
            points,
            lengths,
            row,
            reach,
        }
    }
}

/// Part of a crease.
struct Part {
    hinges: Range<usize>,
    /// Its fold, if it is straight where the source lies.
    fold: Option<Fold>,
}

/// Straight line where a source lies, in which a fold was made: two places on it, as fractions of the box of what lies.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Fold(pub [Vec2; 2]);

impl Fold {
    /// The two places where `plane` lies [m].
    pub fn on(&self, plane: &LyingPlane) -> [Vec2; 2] {
        let [low, high] = plane.bounds();
        self.0.map(|fraction| low + fraction.component_mul(&(high - low)))
    }
}

/// The parts of `chain` between the kinks of its line and where the cloth turns over; `None` for one that is not straight between them. Their folds are
/// among `folds` or are added.
fn straight_parts(
    chain: &CreaseChain,
    whole: &CreaseLine,
    surface: &GarmentSurface,
    plane: &LyingPlane,
    folds: &mut Vec<[Vec2; 2]>,
) -> Option<Vec<Part>> {
    let looks_up = |k: &usize| {
        let [f, _] = surface.topology.hinges[chain.hinges[*k] as usize].triangles;
        plane.looks_up[f as usize]
    };
    let places: Vec<Vec2> = chain.points.iter().map(|p| plane.places[*p as usize]).collect();
    let mut parts = Vec::new();
    let all: Vec<usize> = (0..chain.hinges.len()).collect();
    for run in all.chunk_by(|a, b| looks_up(a) == looks_up(b)) {
        divide(&places, run[0]..run[0] + run.len(), &mut parts);
    }
    let length = |part: &Range<usize>| whole.lengths[part.end] - whole.lengths[part.start];
    let is_long = |part: &Range<usize>| length(part) >= TUNING.min_straight_crease;
    let straight: f64 = parts.iter().filter(|part| is_long(part)).map(length).sum();
    if straight < TUNING.min_straight_fraction * whole.length() {
        return None;
    }
    let [low, high] = plane.bounds();
    let with_fold = |hinges: Range<usize>| {
        let fold = is_long(&hinges).then(|| fold_of([places[hinges.start], places[hinges.end]], folds));
        let fraction = |x: Vec2| (x - low).component_div(&(high - low));
        Part { hinges, fold: fold.map(|ends| Fold(ends.map(fraction))) }
    };
    Some(parts.into_iter().map(with_fold).collect())
}

/// The fold among `folds`, of which two places are known [m], that has a line between `ends`; it is added where none has.
fn fold_of(ends: [Vec2; 2], folds: &mut Vec<[Vec2; 2]>) -> [Vec2; 2] {
    let has = |fold: &&[Vec2; 2]| {
        let along = (fold[1] - fold[0]).try_normalize(0.0).unwrap_or_else(Vec2::x);
        ends.iter().all(|end| (end - fold[0]).perp(&along).abs() <= TUNING.max_fold_deviation)
    };
    folds.iter().find(has).copied().unwrap_or_else(|| {
        folds.push(ends);
        ends
    })
}

/// Divides the polygon `places` [m] over `range` of its sides where it is farthest from straight.
fn divide(places: &[Vec2], range: Range<usize>, parts: &mut Vec<Range<usize>>) {
    let (a, b) = (places[range.start], places[range.end]);
    let along = (b - a).try_normalize(0.0).unwrap_or_else(Vec2::x);
    let apart = |k: usize| (places[k] - a).perp(&along).abs();
    let farthest = (range.start + 1..range.end).max_by(|i, j| apart(*i).total_cmp(&apart(*j)));
    match farthest.filter(|k| apart(*k) > TUNING.max_straight_deviation) {
        Some(k) => {
            divide(places, range.start..k, parts);
            divide(places, k..range.end, parts);
        }
        None => parts.push(range),
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
