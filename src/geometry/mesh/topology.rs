//! Topology of a triangle mesh: unique edges, the triangles on them, and hinges.
//!
//! A hinge is an interior edge with exactly two triangles that agree on orientation:
//!
//! ```text
//!          x2
//!         /  \        triangle A = (x0, x1, x2)
//!       x0 -- x1
//!         \  /        triangle B = (x1, x0, x3)
//!          x3
//! ```
//!
//! Edges with one triangle are boundary; with three or more, or with two that disagree, they carry no hinge and
//! are reported by the importer.

use crate::math::Vec3;
use crate::mesh::index::{INVALID, PointIndex};
use rustc_hash::FxHashMap;

/// Ends of an edge in increasing order.
pub fn edge_key<P: Ord>(a: P, b: P) -> [P; 2] {
    if a < b { [a, b] } else { [b, a] }
}

/// Corners of a triangle in increasing order.
pub fn triangle_key<P: Ord>(mut corners: [P; 3]) -> [P; 3] {
    corners.sort_unstable();
    corners
}

/// An interior edge with its two triangles.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Hinge {
    /// The shared edge x0 x1 (in the direction of triangle A), x2 opposite in A, x3 opposite in B.
    pub points: [PointIndex; 4],
    /// Triangles A and B.
    pub triangles: [u32; 2],
    /// Index of the edge in [`Topology::edges`].
    pub edge: u32,
}

/// Edges and hinges of a triangle mesh.
///
/// ```
/// use crease_geometry::mesh::{PointIndex, Topology};
/// let triangles = [[0, 1, 2], [2, 1, 3]].map(|t| t.map(PointIndex));
/// let topology = Topology::new(4, &triangles);
/// assert_eq!((topology.edges.len(), topology.hinges.len()), (5, 1));
/// ```
#[derive(Debug, Clone, Default)]
pub struct Topology {
    /// Number of points of the mesh.
    pub point_count: usize,
    /// Edges, each once, ends in increasing order, sorted.
    pub edges: Vec<[PointIndex; 2]>,
    /// Edges of each triangle: corners 0-1, 1-2, 2-0.
    pub triangle_edges: Vec<[u32; 3]>,
    /// First two triangles of each edge, [`INVALID`] where there is none.
    pub edge_triangles: Vec<[u32; 2]>,
    /// Number of triangles on each edge.
    pub edge_valence: Vec<u32>,
    /// Hinges: interior, consistently oriented edges, in edge order.
    pub hinges: Vec<Hinge>,
    /// Hinge of each edge, if it carries one.
    pub edge_hinge: Vec<Option<u32>>,
    /// Edges whose two triangles disagree on orientation.
    pub misoriented: Vec<u32>,
}

impl Topology {
    /// Returns the topology of `triangles` over `point_count` points. Triangles must not repeat a point.
    pub fn new(point_count: usize, triangles: &[[PointIndex; 3]]) -> Self {
        let ends = |t: &[PointIndex; 3], k: usize| {
            let (a, b) = (t[k], t[(k + 1) % 3]);
            if a < b { [a, b] } else { [b, a] }
        };
        let mut edges: Vec<[PointIndex; 2]> =
            triangles.iter().flat_map(|t| (0..3).map(|k| ends(t, k))).collect();
        edges.sort_unstable();
        edges.dedup();
        let lookup: FxHashMap<[PointIndex; 2], u32> =
            edges.iter().enumerate().map(|(i, &e)| (e, i as u32)).collect();

        let mut edge_triangles = vec![[INVALID; 2]; edges.len()];
        let mut edge_valence = vec![0u32; edges.len()];
        let mut triangle_edges = Vec::with_capacity(triangles.len());
        for (f, t) in triangles.iter().enumerate() {
            let mut of_triangle = [0u32; 3];
            for (k, slot) in of_triangle.iter_mut().enumerate() {
                let e = lookup[&ends(t, k)];
                *slot = e;
                let count = &mut edge_valence[e as usize];
                if *count < 2 {
                    edge_triangles[e as usize][*count as usize] = f as u32;
                }
                *count += 1;
            }
            triangle_edges.push(of_triangle);
        }

        let mut hinges = Vec::new();
        let mut edge_hinge = vec![None; edges.len()];
        let mut misoriented = Vec::new();
        for (e, pair) in edge_triangles.iter().enumerate() {
            if edge_valence[e] != 2 {
                continue;
            }
            let (a, b) = (&triangles[pair[0] as usize], &triangles[pair[1] as usize]);
            let side = |f: u32| triangle_edges[f as usize].iter().position(|&x| x as usize == e).unwrap_or(0);
            let (ka, kb) = (side(pair[0]), side(pair[1]));
            if a[ka] == b[kb] {
                misoriented.push(e as u32);
                continue;
            }
            edge_hinge[e] = Some(hinges.len() as u32);
            hinges.push(Hinge {
                points: [a[ka], a[(ka + 1) % 3], a[(ka + 2) % 3], b[(kb + 2) % 3]],
                triangles: *pair,
                edge: e as u32,
            });
        }
        Self {
            point_count,
            edges,
            triangle_edges,
            edge_triangles,
            edge_valence,
            hinges,
            edge_hinge,
            misoriented,
        }
    }

    /// Returns the boundary loops: each a closed chain of points along edges with one triangle, in triangle direction.
    /// At a point where loops touch, the chain continues with the lowest unused edge.
    pub fn boundary_loops(&self, triangles: &[[PointIndex; 3]]) -> Vec<Vec<PointIndex>> {
        let mut next: FxHashMap<PointIndex, Vec<PointIndex>> = FxHashMap::default();
        let mut starts = Vec::new();
        for (e, pair) in self.edge_triangles.iter().enumerate() {
            if self.edge_valence[e] != 1 {
                continue;
            }
            let t = &triangles[pair[0] as usize];
            let k = self.triangle_edges[pair[0] as usize].iter().position(|&x| x as usize == e).unwrap_or(0);
            next.entry(t[k]).or_default().push(t[(k + 1) % 3]);
            starts.push(t[k]);
        }
        let mut loops = Vec::new();
        for start in starts {
            let mut chain = Vec::new();
            let mut at = start;
            while let Some(to) = next.get_mut(&at).and_then(|ends| (!ends.is_empty()).then(|| ends.remove(0)))
            {
                chain.push(at);
                at = to;
            }
            if !chain.is_empty() {
                loops.push(chain);
            }
        }
        loops
    }
}

/// Returns the length of the closed chain `border` of points at `points` \[m\].
pub fn loop_length(points: &[Vec3], border: &[PointIndex]) -> f64 {
    let next = border.iter().cycle().skip(1);
    border.iter().zip(next).map(|(a, b)| (points[b.at()] - points[a.at()]).norm()).sum()
}
