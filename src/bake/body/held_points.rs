//! Points of a skinned garment that are held to its skin: those that the file marks or, where it marks none, upper borders
//! (waistbands, collars, straps, rims of hats) and cloth without a body under it.
//!
//! A border is an upper one if it reaches the top of its connected part. Where it lies about level all of it is held, of
//! a longer one (the outline of a cape, the front of a jacket) what lies at the top. Of two upper borders of which one
//! belongs to a joint above that of the other, as shoulder and cuff of a sleeve, only the first is held.
//!
//! Cloth has no body under it where skin was cut away: no body lies within a distance of it that is a fraction of the
//! width of the cloth there, and it is some way from cloth that has one.

use crate::bake::tuning::TUNING;
use crease_geometry::math::Vec3;
use crease_geometry::mesh::point_in_solid::point_normals;
use crease_geometry::mesh::triangle_bvh::TriangleBvh;
use crease_geometry::mesh::{PointIndex, edge_distances};
use crease_model::body::AnimatedBody;
use crease_model::garment::Garment;
use rayon::prelude::*;

/// Points that are held, and why.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(in crate::bake) struct HeldPoints {
    /// One flag per point.
    pub flags: Vec<bool>,
    /// Number of points held because the file says so.
    pub marked: usize,
    /// Number of points on upper borders.
    pub on_borders: usize,
    /// Number of points without a body under them.
    pub uncovered: usize,
}

impl HeldPoints {
    /// The points of `garment` that the file marks by `values`, one per point.
    pub fn marked(values: &[f64]) -> Self {
        let flags: Vec<bool> = values.iter().map(|value| *value > TUNING.leash.min_held_value).collect();
        let marked = flags.iter().filter(|flag| **flag).count();
        Self { flags, marked, on_borders: 0, uncovered: 0 }
    }

    /// The upper borders of `garment` and what of it has no part of `body` under it. `main_node` is, per point, the node of
    /// the body that moves it most; points without one are not held.
    pub fn found(garment: &Garment, body: &AnimatedBody, main_node: &[Option<usize>]) -> Self {
        let mut flags = upper_borders(garment, body, main_node);
        let on_borders = flags.iter().filter(|flag| **flag).count();
        for (flag, uncovered) in flags.iter_mut().zip(uncovered_points(garment, body)) {
            *flag |= uncovered;
        }
        flags.iter_mut().zip(main_node).for_each(|(flag, node)| *flag &= node.is_some());
        let count = flags.iter().filter(|flag| **flag).count();
        Self {
            flags,
            marked: 0,
            on_borders: on_borders.min(count),
            uncovered: count.saturating_sub(on_borders),
        }
    }

    /// What is held and why, in words.
    pub fn describe(&self) -> String {
        let parts = [
            (self.marked, "that the file marks"),
            (self.on_borders, "on upper borders"),
            (self.uncovered, "without a body under them"),
        ];
        let parts: Vec<String> = parts
            .iter()
            .filter(|(count, _)| *count > 0)
            .map(|(count, why)| format!("{count} {why}"))
            .collect();
        if parts.is_empty() { "none".to_owned() } else { parts.join(", ") }
    }
}

/// A border that reaches the top of its part.
struct UpperBorder {
    part: u32,
    /// Points that are held.
    points: Vec<PointIndex>,
    /// Node of the body that moves most of them.
    node: Option<usize>,
}

/// One flag per point: whether it is on an upper border; of a part without any border, whether it is at its top.
fn upper_borders(garment: &Garment, body: &AnimatedBody, main_node: &[Option<usize>]) -> Vec<bool> {
    let part_of = garment.point_parts();
    let loops = garment.topology.boundary_loops(&garment.triangles);
    let part_of_loop = |border: &[PointIndex]| border.first().map_or(u32::MAX, |p| part_of[p.at()]);
    let count = garment.triangle_part.iter().max().map_or(0, |last| *last as usize + 1);
    let mut upper: Vec<UpperBorder> = Vec::new();
    for part in 0..count as u32 {
        let own: Vec<usize> = (0..part_of.len()).filter(|p| part_of[*p] == part).collect();
        let (low, high) = height_range(own.iter().map(|p| &garment.points[*p]));
        let band = TUNING.leash.top_band * (high - low);
        let borders: Vec<&Vec<PointIndex>> =
            loops.iter().filter(|border| part_of_loop(border) == part).collect();
        let heights = |border: &[PointIndex]| height_range(border.iter().map(|p| &garment.points[p.at()]));
        let top = borders.iter().map(|border| heights(border).1).fold(f64::NEG_INFINITY, f64::max);
        for border in &borders {
            let (bottom, own_top) = heights(border);
            if own_top < top - band {
                continue;
            }
            let is_level = own_top - bottom <= TUNING.leash.level_border * (high - low);
            let is_held = |p: &&PointIndex| is_level || garment.points[p.at()].y >= top - band;
            let points: Vec<PointIndex> = border.iter().filter(is_held).copied().collect();
            upper.push(UpperBorder { part, node: mode_of(&points, main_node), points });
        }
        if borders.is_empty() {
            let at_top = own.iter().filter(|p| garment.points[**p].y >= high - band);
            let points = at_top.map(|p| PointIndex(*p as u32)).collect();
            upper.push(UpperBorder { part, points, node: None });
        }
    }
    let mut flags = vec![false; garment.points.len()];
    for border in &upper {
        let is_above = |other: &UpperBorder| match (other.node, border.node) {
            (Some(above), Some(node)) if other.part == border.part => is_ancestor(body, above, node),
            _ => false,
        };
        if !upper.iter().any(is_above) {
            border.points.iter().for_each(|p| flags[p.at()] = true);
        }
    }
    flags
}

/// Lowest and highest height of `points` [m].
fn height_range<'a>(points: impl Iterator<Item = &'a Vec3>) -> (f64, f64) {
    points.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), p| (low.min(p.y), high.max(p.y)))
}

/// The node that most of `points` have.
fn mode_of(points: &[PointIndex], main_node: &[Option<usize>]) -> Option<usize> {
    let mut nodes: Vec<usize> = points.iter().filter_map(|p| main_node[p.at()]).collect();
    nodes.sort_unstable();
    let count = |chunk: &&[usize]| chunk.len();
    nodes.chunk_by(|a, b| a == b).max_by_key(count).and_then(|chunk| chunk.first().copied())
}

fn is_ancestor(body: &AnimatedBody, above: usize, node: usize) -> bool {
    body.rig().is_some_and(|rig| rig.skeleton.ancestors(node).any(|up| up == above))
}

/// One flag per point: whether no body is under it.
fn uncovered_points(garment: &Garment, body: &AnimatedBody) -> Vec<bool> {
    let tuning = &TUNING.leash;
    let body_points = body.rest_points();
    let of_body = TriangleBvh::new(body_points, body.triangles(), 0.0);
    let of_cloth = TriangleBvh::new(&garment.points, &garment.triangles, 0.0);
    let normals = point_normals(&garment.points, &garment.triangles);
    let part_of = garment.point_parts();
    let is_covered = |(p, (x, normal)): (usize, (&Vec3, &Vec3))| {
        // The width of the cloth here: to its other side, where it has one.
        let inner = x - normal * tuning.min_width;
        let across = of_cloth.first_hit(&garment.points, inner, -normal, tuning.max_width);
        let own = across.filter(|hit| garment.triangle_part[hit.triangle as usize] == part_of[p]);
        let width = own.map(|hit| hit.t + tuning.min_width);
        let reach = width.map_or(tuning.open_reach, |width| tuning.width_reach * width).max(tuning.min_reach);
        let is_inside = |f: u32| {
            let corners = body.triangles()[f as usize].map(|p| body_points[p.at()] - x);
            // A body beside a closed tube of cloth is not under it.
            width.is_none()
                || corners.iter().any(|arm| arm.dot(normal) < tuning.max_inner_cosine * arm.norm())
        };
        of_body.nearest_where(body_points, *x, reach, is_inside).is_some()
    };
    let covered: Vec<bool> = garment.points.par_iter().zip(&normals).enumerate().map(is_covered).collect();
    let margin = tuning.uncovered_margin;
    let distance = edge_distances(&garment.points, &garment.topology, &covered, margin);
    distance.into_iter().map(|distance| distance > margin).collect()
}
