//! Side of every triangle of a garment that looks up once it lies.
//!
//! The upward part of the normals is averaged over the surface nearby. Two triangles on an edge are coupled by the cosine of the angle
//! between them: strongly where the cloth runs on smoothly, not at all across a right angle, and with the opposite sign across a sharp fold
//! (the fall of a collar on its stand, the middle of a pleat). Every triangle counts from its own winding, so that triangles that disagree
//! on orientation, and edges of more than two triangles, need no special case.

use crate::wear::tuning::TUNING;
use crease_geometry::math::{Vec3, bounds};
use crease_geometry::mesh::{Groups, PointIndex, Topology, triangle};
use crease_linear::ScalarCholesky;

/// Two triangles on an edge.
pub(crate) struct Neighbours {
    /// Index of the edge.
    pub edge: usize,
    /// The triangles.
    pub triangles: [usize; 2],
    /// Cosine of the angle between their normals [-].
    pub cosine: f64,
}

/// All pairs of triangles with a common edge.
pub(crate) fn neighbours(
    positions: &[Vec3],
    triangles: &[[PointIndex; 3]],
    topology: &Topology,
) -> Vec<Neighbours> {
    let mut on = vec![Vec::new(); topology.edges.len()];
    for (f, edges) in topology.triangle_edges.iter().enumerate() {
        edges.iter().for_each(|e| on[*e as usize].push(f));
    }
    let normal =
        |f: usize| triangle::normal(&triangle::corners(positions, &triangles[f])).unwrap_or_else(Vec3::zeros);
    let mut found = Vec::new();
    for (edge, on) in on.iter().enumerate() {
        for (i, j) in (0..on.len()).flat_map(|i| (i + 1..on.len()).map(move |j| (i, j))) {
            let triangles = [on[i], on[j]];
            let [m, n] = triangles.map(normal);
            found.push(Neighbours { edge, triangles, cosine: m.dot(&n) });
        }
    }
    found
}

/// How much triangles look up before they are laid.
pub(crate) struct LayoutSides {
    /// Per triangle: the upward part of its normal, averaged over the surface nearby, from -1 to 1.
    pub level: Vec<f64>,
    /// Per triangle: whether it looks up once it lies.
    pub up: Vec<bool>,
}

impl LayoutSides {
    /// Sides of the cloth at `positions` [m] (y up). `None` where positions are not finite.
    pub fn new(
        positions: &[Vec3],
        triangles: &[[PointIndex; 3]],
        topology: &Topology,
        neighbours: &[Neighbours],
    ) -> Option<Self> {
        let corners: Vec<[Vec3; 3]> = triangles.iter().map(|t| triangle::corners(positions, t)).collect();
        let areas: Vec<f64> = corners.iter().map(triangle::area).collect();
        let (low, high) = bounds(positions);
        let reach = TUNING.lay.side_smoothing * (high - low).max();
        let mut entries: Vec<(u32, u32, f64)> = Vec::with_capacity(triangles.len() + neighbours.len());
        let mut diagonal: Vec<f64> = areas.iter().map(|a| a.max(f64::MIN_POSITIVE)).collect();
        for Neighbours { edge, triangles: [f, g], cosine } in neighbours {
            let [a, b] = topology.edges[*edge].map(|p| positions[p.at()]);
            let length = (b - a).norm();
            // Distance of the centroids across the edge.
            let apart = 2.0 / 3.0 * (areas[*f] + areas[*g]) / length.max(f64::MIN_POSITIVE);
            let weight =
                cosine.abs() * 0.5 * reach * reach * length / apart.max(0.1 * length + f64::MIN_POSITIVE);
            diagonal[*f] += weight;
            diagonal[*g] += weight;
            entries.push((*f.max(g) as u32, *f.min(g) as u32, -weight * cosine.signum()));
        }
        entries.extend((0..).zip(&diagonal).map(|(f, sum)| (f, f, *sum)));
        let factor = ScalarCholesky::new(triangles.len(), &entries)?;
        let upward = |(x, a): (&[Vec3; 3], &f64)| a * triangle::normal(x).map_or(0.0, |n| n.y);
        let mut level: Vec<f64> = corners.iter().zip(&areas).map(upward).collect();
        factor.solve(&mut level);
        let up = level.iter().map(|level| *level > 0.0).collect();
        let mut sides = Self { level, up };
        sides.merge_small(&areas, neighbours);
        Some(sides)
    }

    /// Whether the cloth turns over between two triangles once it lies.
    pub fn turns_over(&self, pair: &Neighbours) -> bool {
        let [f, g] = pair.triangles;
        (self.up[f] == self.up[g]) != (pair.cosine > 0.0)
    }

    /// Turns over small patches that hardly look up or down.
    fn merge_small(&mut self, areas: &[f64], neighbours: &[Neighbours]) {
        let mut groups = Groups::new(areas.len());
        for pair in neighbours.iter().filter(|pair| !self.turns_over(pair)) {
            groups.join(pair.triangles[0] as u32, pair.triangles[1] as u32);
        }
        let mut sums = vec![(0.0, 0.0); areas.len()];
        let roots: Vec<usize> = (0..areas.len() as u32).map(|f| groups.find(f) as usize).collect();
        for (f, root) in roots.iter().enumerate() {
            sums[*root].0 += areas[f];
            sums[*root].1 += areas[f] * self.level[f].abs();
        }
        let total: f64 = areas.iter().sum();
        for (f, root) in roots.iter().enumerate() {
            let (area, clear) = sums[*root];
            if area < TUNING.lay.min_side_fraction * total && clear < TUNING.lay.min_side_level * area {
                self.up[f] = !self.up[f];
            }
        }
    }
}
