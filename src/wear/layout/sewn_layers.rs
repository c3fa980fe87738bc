//! Pieces that are sewn onto others along their borders: pockets, plackets, facings.
//!
//! Where more than two triangles meet at an edge, sheets meet. Two sheets on one side of a seam lie on one another, and the one that
//! leaves the seam farther out is the outer one.

use crate::wear::tuning::TUNING;
use crease_geometry::math::Vec3;
use crease_geometry::mesh::{Groups, PointIndex, Topology, triangle};
use std::collections::BTreeMap;

/// Triangles that are connected over edges, patch by patch: over edge `e` between triangles `f` and `g` where `joins(e, f, g)`.
pub(crate) fn patches(topology: &Topology, joins: &dyn Fn(usize, usize, usize) -> bool) -> Vec<Vec<usize>> {
    let mut groups = Groups::new(topology.triangle_edges.len());
    for (e, on) in triangles_on_edges(topology).iter().enumerate() {
        for (i, &f) in on.iter().enumerate() {
            for &g in on[i + 1..].iter().filter(|g| joins(e, f as usize, **g as usize)) {
                groups.join(f, g);
            }
        }
    }
    let mut found: BTreeMap<u32, Vec<usize>> = BTreeMap::new();
    for f in 0..topology.triangle_edges.len() {
        found.entry(groups.find(f as u32)).or_default().push(f);
    }
    found.into_values().collect()
}

/// Per edge: all triangles on it.
fn triangles_on_edges(topology: &Topology) -> Vec<Vec<u32>> {
    let mut on = vec![Vec::new(); topology.edges.len()];
    for (f, edges) in topology.triangle_edges.iter().enumerate() {
        edges.iter().for_each(|e| on[*e as usize].push(f as u32));
    }
    on
}

/// Per triangle: number of sheets that it lies outside of, among those it is sewn onto. `None` where sheets lie outside of one another
/// in a circle.
pub(crate) fn stack_ranks(
    positions: &[Vec3],
    triangles: &[[PointIndex; 3]],
    topology: &Topology,
) -> Option<Vec<u32>> {
    let mut ranks = vec![0; triangles.len()];
    if topology.edge_valence.iter().all(|valence| *valence <= 2) {
        return Some(ranks);
    }
    let sheets = patches(topology, &|e, _, _| topology.edge_valence[e] == 2);
    let mut sheet = vec![0; triangles.len()];
    for (number, faces) in sheets.iter().enumerate() {
        faces.iter().for_each(|f| sheet[*f] = number);
    }
    // Per pair of sheets: how far the first leaves their seams outside of the second.
    let mut outward: BTreeMap<[usize; 2], f64> = BTreeMap::new();
    for (e, on) in triangles_on_edges(topology).iter().enumerate().filter(|(_, on)| on.len() > 2) {
        let ends = topology.edges[e].map(|p| positions[p.at()]);
        let wings: Vec<Wing> = on
            .iter()
            .map(|f| Wing::new(positions, &triangles[*f as usize], &topology.edges[e], &ends))
            .collect();
        for (i, j) in (0..on.len()).flat_map(|i| (i + 1..on.len()).map(move |j| (i, j))) {
            let [a, b] = [i, j].map(|k| sheet[on[k] as usize]);
            // Sheets on opposite sides of the seam continue one another.
            if a == b || wings[i].away.dot(&wings[j].away) <= 0.0 {
                continue;
            }
            let normal = wings[i].normal + wings[j].normal;
            let apart = (wings[i].away - wings[j].away).dot(&normal) * (ends[1] - ends[0]).norm();
            let (key, apart) = if a < b { ([a, b], apart) } else { ([b, a], -apart) };
            *outward.entry(key).or_default() += apart;
        }
    }
    let mut of_sheet = vec![0; sheets.len()];
    for _ in 0..=TUNING.lay.max_sewn_layers {
        let mut changed = false;
        for ([a, b], apart) in &outward {
            let (outer, inner) = if *apart > 0.0 { (*a, *b) } else { (*b, *a) };
            if of_sheet[outer] <= of_sheet[inner] {
                of_sheet[outer] = of_sheet[inner] + 1;
                changed = true;
            }
        }
        if !changed {
            ranks.iter_mut().zip(&sheet).for_each(|(rank, sheet)| *rank = of_sheet[*sheet]);
            return Some(ranks);
        }
    }
    None
}

/// A triangle at an edge.
struct Wing {
    /// Unit vector away from the edge, in the plane of the triangle.
    away: Vec3,
    /// Unit normal.
    normal: Vec3,
}

impl Wing {
    fn new(positions: &[Vec3], t: &[PointIndex; 3], edge: &[PointIndex; 2], ends: &[Vec3; 2]) -> Self {
        let corners = triangle::corners(positions, t);
        let opposite = t.iter().find(|p| !edge.contains(p)).map_or(ends[0], |p| positions[p.at()]);
        let along = (ends[1] - ends[0]).try_normalize(0.0).unwrap_or_else(Vec3::zeros);
        let out = opposite - ends[0];
        Self {
            away: (out - along * out.dot(&along)).try_normalize(0.0).unwrap_or_else(Vec3::zeros),
            normal: triangle::normal(&corners).unwrap_or_else(Vec3::zeros),
        }
    }
}
