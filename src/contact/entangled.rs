//! Crossings that are there at the start: left out of the response and of the bound until they come apart.
//!
//! Pushing apart two triangles that cross pushes them the wrong way as often as not, and a bound that keeps their
//! corners and edges from meeting keeps them hooked for ever. So the pairs of points, edges and triangles of two
//! triangles that cross are free to pass, while all other pairs are guarded as ever; and no position is accepted at
//! which more triangles cross than did when the step began, counted exactly (`mesh::crossings`). What has come apart is
//! guarded from the next step on, with a contact distance that grows from the gap there is.

use super::body::Body;
use super::candidates::{PairKind, Quad};
use crate::math::Vec3;
use crate::mesh::PointIndex;
use crate::mesh::crossings::{crossings, crossings_between};
use rustc_hash::FxHashSet;

/// Triangles that cross, and the pairs that are therefore left alone.
#[derive(Debug, Clone, Default)]
pub(super) struct Entangled {
    /// Pairs of triangles of the cloth, sorted.
    pub layers: Vec<[u32; 2]>,
    /// (triangle of the cloth, triangle of the body), sorted.
    pub with_body: Vec<[u32; 2]>,
    /// Pairs that are left alone, points of the body after those of the cloth.
    free: FxHashSet<Quad>,
}

/// A mesh as seen by the count: positions [m], triangles, the edges of each triangle, and all edges.
#[derive(Clone, Copy)]
pub(super) struct Mesh<'a> {
    pub x: &'a [Vec3],
    pub triangles: &'a [[PointIndex; 3]],
    pub triangle_edges: &'a [[u32; 3]],
    pub edges: &'a [[u32; 2]],
}

impl Entangled {
    /// Counts at these places.
    pub fn find(cloth: Mesh, body: Option<&Body>) -> Self {
        let layers = crossings(cloth.x, cloth.triangles);
        let with_body = match body {
            Some(body) => crossings_between(cloth.x, cloth.triangles, &body.now, &body.triangles),
            None => Vec::new(),
        };
        let mut free = FxHashSet::default();
        for &[a, b] in &layers {
            release(&mut free, (cloth, a, 0), (cloth, b, 0));
        }
        if let Some(body) = body {
            let mesh = Mesh {
                x: &body.now,
                triangles: &body.triangles,
                triangle_edges: &body.triangle_edges,
                edges: &body.edges,
            };
            let offset = cloth.x.len() as u32;
            for &[a, b] in &with_body {
                release(&mut free, (cloth, a, 0), (mesh, b, offset));
            }
        }
        Self { layers, with_body, free }
    }

    /// Whether nothing crosses.
    pub fn is_empty(&self) -> bool {
        self.free.is_empty()
    }

    /// Whether the pair is left alone.
    pub fn frees(&self, quad: &Quad) -> bool {
        self.free.contains(quad)
    }

    /// The pairs that are left alone here and were not in `other`, in no order.
    pub fn free_but_not_in<'a>(&'a self, other: &'a Self) -> impl Iterator<Item = &'a Quad> {
        self.free.difference(&other.free)
    }

    /// Whether more triangles cross at these places than when this was made.
    pub fn is_worse_at(&self, cloth: Mesh, body: Option<&Body>) -> bool {
        if self.is_empty() {
            return false;
        }
        let with_body = |body: &Body| {
            crossings_between(cloth.x, cloth.triangles, &body.now, &body.triangles).len()
                > self.with_body.len()
        };
        crossings(cloth.x, cloth.triangles).len() > self.layers.len() || body.is_some_and(with_body)
    }
}

/// Adds all pairs of primitives of two triangles, each with its mesh and the number of its first point.
fn release(free: &mut FxHashSet<Quad>, first: (Mesh, u32, u32), second: (Mesh, u32, u32)) {
    let corners =
        |(mesh, f, offset): (Mesh, u32, u32)| mesh.triangles[f as usize].map(|p| PointIndex(p.0 + offset));
    let edges = |(mesh, f, _): (Mesh, u32, u32)| mesh.triangle_edges[f as usize];
    let ends =
        |(mesh, _, offset): (Mesh, u32, u32), e: u32| mesh.edges[e as usize].map(|p| PointIndex(p + offset));
    let mut point_triangle = |points: [PointIndex; 3], [a, b, c]: [PointIndex; 3]| {
        free.extend(points.map(|p| Quad { kind: PairKind::PointTriangle, points: [p, a, b, c] }));
    };
    point_triangle(corners(first), corners(second));
    point_triangle(corners(second), corners(first));
    for e in edges(first) {
        for f in edges(second) {
            // Of one mesh the lower edge comes first, as in the lists of candidates; of two the cloth's.
            let turned = first.2 == second.2 && e > f;
            let ([a, b], [c, d]) = (ends(first, e), ends(second, f));
            let points = if turned { [c, d, a, b] } else { [a, b, c, d] };
            free.insert(Quad { kind: PairKind::EdgeEdge, points });
        }
    }
}
