//! Wedges: the file's vertices at the corners of a garment's triangles.
//!
//! A garment has points; texture coordinates belong to vertices, and at a seam one point has several. A triangle of the
//! garment corresponds to the triangle of the file whose corners became its points.

use crate::garment::{Garment, SourceAsset};
use crease_geometry::math::Vec2;
use crease_geometry::mesh::PointIndex;
use rustc_hash::FxHashMap;

/// Triangle between points, with the file's vertices at its corners.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct TriangleWedges {
    /// Corners.
    pub(super) points: [PointIndex; 3],
    /// Vertices at the corners; `None` where a repair mixed those of several triangles.
    pub(super) vertices: Option<[u32; 3]>,
}

impl TriangleWedges {
    /// Whether two of its corners are one point.
    pub(super) fn is_collapsed(&self) -> bool {
        let [a, b, c] = self.points;
        a == b || b == c || c == a
    }
}

/// Returns the vertices at the corners of every triangle of `garment`, counted over the worn pieces of `asset` in file
/// order. A triangle made by a repair has the first vertex of each of its points. `None` for a garment that is finer than
/// its file: its points have no vertices there.
pub fn corner_vertices(asset: &SourceAsset, garment: &Garment) -> Option<Vec<[u32; 3]>> {
    let mut first_vertex = vec![None; garment.points.len()];
    for (vertex, point) in garment.source_point.iter().enumerate().rev() {
        if let Some(slot) = first_vertex.get_mut(point.at()) {
            *slot = Some(vertex as u32);
        }
    }
    let mut of_points: FxHashMap<[PointIndex; 3], [u32; 3]> = FxHashMap::default();
    let mut start = 0u32;
    for piece in asset.worn_pieces() {
        for corners in &piece.triangles {
            let vertices = corners.map(|c| start + c);
            let points = vertices.map(|v| garment.source_point.get(v as usize).copied());
            if let [Some(a), Some(b), Some(c)] = points {
                let (key, vertices) = sorted([a, b, c], vertices);
                of_points.entry(key).or_insert(vertices);
            }
        }
        start += piece.positions.len() as u32;
    }
    let find = |t: &[PointIndex; 3]| {
        let (key, _) = sorted(*t, [0; 3]);
        let known = of_points.get(&key);
        let at = |p: PointIndex| match known {
            Some(vertices) => key.iter().position(|q| *q == p).map(|k| vertices[k]),
            None => first_vertex[p.at()],
        };
        let [a, b, c] = t.map(at);
        Some([a?, b?, c?])
    };
    garment.triangles.iter().map(find).collect()
}

/// Returns the texture coordinates of every corner of every triangle, if all worn pieces of `asset` have them.
pub fn corner_uvs(asset: &SourceAsset, corners: &[[u32; 3]]) -> Option<Vec<[Vec2; 3]>> {
    let mut uvs: Vec<Vec2> = Vec::new();
    for piece in asset.worn_pieces() {
        uvs.extend(piece.uvs.as_ref()?);
    }
    corners
        .iter()
        .map(|vertices| {
            let [a, b, c] = vertices.map(|v| uvs.get(v as usize).copied());
            Some([a?, b?, c?])
        })
        .collect()
}

/// Sorts the points in increasing order and the vertices along with them.
fn sorted(points: [PointIndex; 3], vertices: [u32; 3]) -> ([PointIndex; 3], [u32; 3]) {
    let mut order = [0, 1, 2];
    order.sort_unstable_by_key(|&k| points[k]);
    (order.map(|k| points[k]), order.map(|k| vertices[k]))
}
