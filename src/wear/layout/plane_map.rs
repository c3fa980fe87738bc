//! Map of a garment into the plane in which it lies, every triangle as close to its own shape as its neighbours let it be.
//!
//! As rigid as possible (Sorkine and Alexa 2007, in the plane as Liu and others 2008): in turn the best rotation of every triangle and the
//! positions for these rotations. Triangles that look down are turned over, so that the cloth folds where sides change.

use crate::wear::tuning::TUNING;
use crease_geometry::math::Vec3;
use crease_geometry::mesh::{PointIndex, Topology, triangle};
use crease_linear::ScalarCholesky;

/// Factor and shapes of the triangles in the plane.
pub(crate) struct PlaneMap<'a> {
    triangles: &'a [[PointIndex; 3]],
    /// Per triangle and corner: cotangent of its angle.
    weights: &'a [[f64; 3]],
    /// Per triangle: its corners (y = 0), turned over where it looks down [m].
    shapes: Vec<[Vec3; 3]>,
    factor: ScalarCholesky,
}

impl<'a> PlaneMap<'a> {
    /// The map of the cloth at `positions` [m], of triangles that look `up` or down, with `weights`, one per corner of each.
    pub fn new(
        positions: &[Vec3],
        triangles: &'a [[PointIndex; 3]],
        topology: &Topology,
        weights: &'a [[f64; 3]],
        up: &[bool],
    ) -> Option<Self> {
        let shape = |(t, up): (&[PointIndex; 3], &bool)| {
            let x = triangle::corners(positions, t);
            let along = x[1] - x[0];
            let across = x[2] - x[0];
            let length = along.norm().max(f64::MIN_POSITIVE);
            let foot = along.dot(&across) / length;
            let height = (across.norm_squared() - foot * foot).max(0.0).sqrt();
            // Counter-clockwise from above (x to -z) where it looks up.
            let side = if *up { -height } else { height };
            [Vec3::zeros(), Vec3::new(length, 0.0, 0.0), Vec3::new(foot, 0.0, side)]
        };
        // So weak that it only fixes the place.
        let held = vec![TUNING.lay.place_weight; positions.len()];
        let factor = laplacian(topology, weights, &held)?;
        let shapes = triangles.iter().zip(up).map(shape).collect();
        Some(Self { triangles, weights, shapes, factor })
    }

    /// Positions in the plane (y = 0) [m], from the projection of `start`.
    pub fn positions(&self, start: &[Vec3]) -> Vec<Vec3> {
        let count = start.len();
        let mut x: Vec<Vec3> = start.iter().map(|p| Vec3::new(p.x, 0.0, p.z)).collect();
        let home: Vec<Vec3> = x.iter().map(|p| p * TUNING.lay.place_weight).collect();
        for _ in 0..TUNING.lay.max_layout_iterations {
            // The coordinates of all points along x, then along z.
            let mut rhs: Vec<f64> = home.iter().map(|p| p.x).chain(home.iter().map(|p| p.z)).collect();
            for ((t, w), shape) in self.triangles.iter().zip(self.weights).zip(&self.shapes) {
                let [cos, sin] = rotation(&t.map(|p| x[p.at()]), w, shape);
                for (k, w) in w.iter().enumerate() {
                    let (i, j) = ((k + 1) % 3, (k + 2) % 3);
                    let own = (shape[i] - shape[j]) * *w;
                    let (along, across) = (cos * own.x - sin * own.z, sin * own.x + cos * own.z);
                    for (p, sign) in [(t[i].at(), 1.0), (t[j].at(), -1.0)] {
                        rhs[p] += sign * along;
                        rhs[count + p] += sign * across;
                    }
                }
            }
            self.factor.solve(&mut rhs);
            let next: Vec<Vec3> = (0..count).map(|p| Vec3::new(rhs[p], 0.0, rhs[count + p])).collect();
            let change = x.iter().zip(&next).map(|(a, b)| (a - b).norm()).fold(0.0, f64::max);
            x = next;
            if change < TUNING.lay.layout_tol {
                break;
            }
        }
        x
    }
}

/// Cosine and sine of the rotation in the plane that brings `shape` closest to `x`.
fn rotation(x: &[Vec3; 3], weights: &[f64; 3], shape: &[Vec3; 3]) -> [f64; 2] {
    let (mut cos, mut sin) = (0.0, 0.0);
    for (k, w) in weights.iter().enumerate() {
        let (i, j) = ((k + 1) % 3, (k + 2) % 3);
        let (at, own) = (x[i] - x[j], shape[i] - shape[j]);
        cos += w * (at.x * own.x + at.z * own.z);
        sin += w * (at.z * own.x - at.x * own.z);
    }
    let length = cos.hypot(sin).max(f64::MIN_POSITIVE);
    [cos / length, sin / length]
}

/// Cotangents of the angles of a triangle, bounded.
pub(crate) fn cotangents(x: &[Vec3; 3]) -> [f64; 3] {
    [0, 1, 2].map(|k| {
        let (a, b) = (x[(k + 1) % 3] - x[k], x[(k + 2) % 3] - x[k]);
        let cotangent = a.dot(&b) / a.cross(&b).norm().max(f64::MIN_POSITIVE);
        cotangent.clamp(TUNING.lay.min_cotangent, TUNING.lay.max_cotangent)
    })
}

/// Factor of D + L: `diagonal` is D, L the cotangent Laplacian. Every edge is one entry: of a fine file a list by triangles would be the
/// largest piece of memory of the whole bake.
fn laplacian(topology: &Topology, weights: &[[f64; 3]], diagonal: &[f64]) -> Option<ScalarCholesky> {
    let mut of_edge = vec![0.0; topology.edges.len()];
    for (edges, w) in topology.triangle_edges.iter().zip(weights) {
        // Edge k runs from corner k to the next: across from it is the third.
        for (k, edge) in edges.iter().enumerate() {
            of_edge[*edge as usize] += w[(k + 2) % 3];
        }
    }
    let mut sums = diagonal.to_vec();
    let mut entries = Vec::with_capacity(sums.len() + of_edge.len());
    for ([a, b], weight) in topology.edges.iter().zip(&of_edge) {
        sums[a.at()] += weight;
        sums[b.at()] += weight;
        entries.push((a.0.max(b.0), a.0.min(b.0), -weight));
    }
    entries.extend((0..).zip(&sums).map(|(p, sum)| (p, p, *sum)));
    ScalarCholesky::new(diagonal.len(), &entries)
}
