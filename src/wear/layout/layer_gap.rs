//! Heights of layers that lie on one another and are joined along a rim or a seam.
//!
//! Layers lie a gap apart and meet in common points. Where the course of these is jagged, edges and points of one layer come next to the other:
//! their heights are moved apart, constraint by constraint (position-based dynamics, Müller and others 2007).

use crate::wear::tuning::TUNING;
use crease_geometry::math::Vec3;
use crease_geometry::mesh::distance::{edge_edge, point_triangle};
use crease_geometry::mesh::triangle_bvh::TriangleBvh;
use crease_geometry::mesh::{PointIndex, edge_key};
use rayon::prelude::*;
use rustc_hash::{FxHashMap, FxHashSet};

/// A place where the upper layer must lie above the lower: four points, with positive weights in the upper layer and negative ones
/// in the lower.
struct Constraint([(usize, f64); 4]);

/// Raises and lowers the points at `x` [m] until triangles of every layer, of which `layers` are the numbers from below, lie at
/// least `gap` [m] above those of all layers below near the points that are `shared` between layers, one flag per point.
pub(crate) fn separate(
    x: &mut [Vec3],
    triangles: &[[PointIndex; 3]],
    layers: &[u32],
    shared: &[bool],
    gap: f64,
) {
    let mut numbers: Vec<u32> = layers.to_vec();
    numbers.sort_unstable();
    numbers.dedup();
    let near: Vec<Layer> =
        numbers.iter().map(|number| Layer::new(triangles, layers, *number, shared)).collect();
    let pairs =
        near.iter().enumerate().flat_map(|(k, lower)| near[k + 1..].iter().map(move |upper| [lower, upper]));
    let constraints: Vec<Constraint> = pairs.flat_map(|pair| constraints(x, pair, gap)).collect();
    for _ in 0..TUNING.lay.max_gap_rounds {
        let mut largest = 0.0f64;
        for Constraint(points) in &constraints {
            let missing = gap - points.iter().map(|(p, w)| w * x[*p].y).sum::<f64>();
            if missing > 0.0 {
                largest = largest.max(missing);
                let step = missing / points.iter().map(|(_, w)| w * w).sum::<f64>();
                points.iter().for_each(|(p, w)| x[*p].y += step * w);
            }
        }
        if largest < TUNING.lay.gap_tol * gap {
            break;
        }
    }
    let lowest = x.iter().map(|p| p.y).fold(f64::INFINITY, f64::min);
    x.iter_mut().for_each(|p| p.y -= lowest);
}

/// Edges and triangles of one layer next to points that are shared with others.
struct Layer {
    edges: Vec<[usize; 2]>,
    triangles: Vec<[usize; 3]>,
}

impl Layer {
    fn new(triangles: &[[PointIndex; 3]], layers: &[u32], number: u32, shared: &[bool]) -> Self {
        let mut seen = FxHashSet::default();
        let mut layer = Self { edges: Vec::new(), triangles: Vec::new() };
        for (t, _) in triangles.iter().zip(layers).filter(|(_, layer)| **layer == number) {
            if t.iter().all(|p| !shared[p.at()]) {
                continue;
            }
            layer.triangles.push(t.map(|p| p.at()));
            for k in 0..3 {
                let key = edge_key(t[k], t[(k + 1) % 3]);
                if seen.insert(key) {
                    layer.edges.push([t[k].at(), t[(k + 1) % 3].at()]);
                }
            }
        }
        layer
    }
}

/// Constraints between two layers, the lower one first.
fn constraints(x: &[Vec3], [lower, upper]: [&Layer; 2], gap: f64) -> Vec<Constraint> {
    let [below, above] =
        [lower, upper].map(|layer| layer.edges.iter().flatten().copied().collect::<FxHashSet<usize>>());
    let is_common = |p: &usize| below.contains(p) && above.contains(p);
    let key = |e: &[usize; 2]| [e[0].min(e[1]), e[0].max(e[1])];
    let [lower_edges, upper_edges] =
        [lower, upper].map(|layer| layer.edges.iter().map(key).collect::<FxHashSet<_>>());
    let mut found = Vec::new();
    // Edges that pass one another.
    let cells = Cells::new(lower.edges.iter().map(|e| e.map(|p| x[p])), gap);
    for e in &upper.edges {
        for &k in &cells.near(e.map(|p| x[p])) {
            let g = lower.edges[k];
            // Two edges of both layers would each have to lie above the other: see `touching`.
            let both_common = upper_edges.contains(&key(&g)) && lower_edges.contains(&key(e));
            if both_common || g.contains(&e[0]) || g.contains(&e[1]) {
                continue;
            }
            let [a, b, c, d] = [e[0], e[1], g[0], g[1]].map(|p| Vec3::new(x[p].x, 0.0, x[p].z));
            let closest = edge_edge(&a, &b, &c, &d);
            if closest.distance < gap {
                let points = [e[0], e[1], g[0], g[1]];
                found.push(Constraint([0, 1, 2, 3].map(|k| (points[k], closest.weights[k]))));
            }
        }
    }
    // Points under or over a triangle.
    for (layer, other, is_upper) in [(upper, lower, true), (lower, upper, false)] {
        let mut points: Vec<usize> =
            other.edges.iter().flatten().copied().filter(|p| !is_common(p)).collect();
        points.sort_unstable();
        points.dedup();
        let cells = Cells::new(points.iter().map(|p| [x[*p]; 2]), gap);
        for t in &layer.triangles {
            for &k in &cells.near(t.map(|p| x[p])) {
                let p = points[k];
                let flat = |p: usize| Vec3::new(x[p].x, 0.0, x[p].z);
                let apart = point_triangle(&flat(p), &flat(t[0]), &flat(t[1]), &flat(t[2]));
                if apart.distance > TUNING.lay.gap_tol * gap || t.contains(&p) {
                    continue;
                }
                let points = [p, t[0], t[1], t[2]];
                let sign = if is_upper { -1.0 } else { 1.0 };
                found.push(Constraint([0, 1, 2, 3].map(|k| (points[k], sign * apart.weights[k]))));
            }
        }
    }
    found
}

/// Triangles at `x` [m], in the order of their numbers, that touch another: whose edges or corners come nearer than `distance` [m] to
/// features of it that they have no point in common with. Two triangles with a common corner count, too: one that is folded over in the
/// plane of its own layer touches its neighbours.
pub(crate) fn touching(x: &[Vec3], triangles: &[[PointIndex; 3]], distance: f64) -> Vec<u32> {
    let at = |p: PointIndex| &x[p.at()];
    let touch = |t: &[PointIndex; 3], u: &[PointIndex; 3]| {
        let sides = |t: &[PointIndex; 3]| [[t[0], t[1]], [t[1], t[2]], [t[2], t[0]]];
        let of_u = sides(u);
        let edges = sides(t).into_iter().flat_map(|e| of_u.map(|g| (e, g)));
        edges
            .filter(|(e, g)| !g.contains(&e[0]) && !g.contains(&e[1]))
            .any(|(e, g)| edge_edge(at(e[0]), at(e[1]), at(g[0]), at(g[1])).distance < distance)
            || [(t, u), (u, t)].into_iter().any(|(t, u)| {
                t.iter().any(|p| {
                    !u.contains(p) && point_triangle(at(*p), at(u[0]), at(u[1]), at(u[2])).distance < distance
                })
            })
    };
    let near = TriangleBvh::new(x, triangles, distance).overlaps();
    let touches = |(f, g): &(u32, u32)| touch(&triangles[*f as usize], &triangles[*g as usize]);
    let mut found: Vec<u32> = near.into_par_iter().filter(touches).flat_map_iter(|(f, g)| [f, g]).collect();
    found.sort_unstable();
    found.dedup();
    found
}

/// Boxes in the plane of x and z, by place.
struct Cells {
    cells: FxHashMap<[i32; 2], Vec<usize>>,
    margin: f64,
}

impl Cells {
    fn new<const N: usize>(items: impl Iterator<Item = [Vec3; N]>, margin: f64) -> Self {
        let mut new = Self { cells: FxHashMap::default(), margin };
        for (k, corners) in items.enumerate() {
            for cell in new.covered(corners) {
                new.cells.entry(cell).or_default().push(k);
            }
        }
        new
    }

    /// Cells that the box of `corners` meets.
    fn covered<const N: usize>(&self, corners: [Vec3; N]) -> Vec<[i32; 2]> {
        let span = |axis: usize| {
            let low = corners.iter().map(|c| c[axis]).fold(f64::INFINITY, f64::min) - self.margin;
            let high = corners.iter().map(|c| c[axis]).fold(f64::NEG_INFINITY, f64::max) + self.margin;
            let cell = |c: f64| (c / TUNING.prediction.layer_cell).floor() as i32;
            cell(low)..=cell(high)
        };
        let (i, j) = (span(0), span(2));
        i.flat_map(|i| j.clone().map(move |j| [i, j])).collect()
    }

    /// Items whose boxes may meet that of `corners`, each once.
    fn near<const N: usize>(&self, corners: [Vec3; N]) -> Vec<usize> {
        let cells = self.covered(corners).into_iter();
        let mut found: Vec<usize> = cells.filter_map(|c| self.cells.get(&c)).flatten().copied().collect();
        found.sort_unstable();
        found.dedup();
        found
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn edges_that_cross_in_the_plane_touch() {
        let gap = 1e-3;
        // Two triangles whose first edges cross in the middle; the other corners lie apart.
        let flat = [[-1.0, 0.0], [1.0, 0.0], [-0.9, 2.0], [0.0, -1.0], [0.0, 1.0], [2.0, -0.9]];
        let triangles = [[0, 1, 2], [3, 4, 5]].map(|t| t.map(PointIndex));
        let at = |height: f64| -> Vec<Vec3> {
            let y = |k| if k < 3 { 0.0 } else { height };
            flat.iter().enumerate().map(|(k, p)| Vec3::new(0.01 * p[0], y(k), 0.01 * p[1])).collect()
        };
        assert_eq!(touching(&at(0.0), &triangles, 0.01 * gap), [0, 1]);
        assert!(touching(&at(0.5 * gap), &triangles, 0.01 * gap).is_empty());
    }

    #[test]
    fn a_triangle_folded_over_in_its_own_layer_touches() {
        // A fan round the first point; the last of its points lies beyond the one before it, so that triangle 2 covers part of 1.
        let fan = |last: [f64; 2]| {
            let flat = [[0.0, 0.0], [1.0, 0.0], [0.5, 0.9], [-0.5, 0.9], last];
            let x: Vec<Vec3> = flat.iter().map(|p| Vec3::new(0.01 * p[0], 0.0, -0.01 * p[1])).collect();
            touching(&x, &[[0, 1, 2], [0, 2, 3], [0, 3, 4]].map(|t| t.map(PointIndex)), 1e-5)
        };
        assert!(fan([-1.0, 0.0]).is_empty());
        assert_eq!(fan([0.0, 0.6]), [1, 2]);
        // Not only the neighbour across an edge: any with a common corner.
        assert_eq!(fan([0.7, 0.3]), [0, 1, 2]);
    }

    #[test]
    fn rim_edges_of_one_layer_are_moved_apart() {
        let gap = 1e-3;
        // All corners are shared with other layers, but the edge of the first triangle lies in the lower layer only.
        let flat = [[-1.0, 0.0], [1.0, 0.0], [0.0, 2.0], [0.0, -1.0], [0.0, 1.0], [2.0, 0.0]];
        let mut x: Vec<Vec3> = flat.iter().map(|p| Vec3::new(0.01 * p[0], 0.0, 0.01 * p[1])).collect();
        let triangles = [[0, 1, 2], [3, 4, 5]].map(|t| t.map(PointIndex));
        separate(&mut x, &triangles, &[0, 1], &[true; 6], gap);
        assert!(touching(&x, &triangles, 0.01 * gap).is_empty(), "{x:?}");
    }
}
