//! A mesh whose edges are split, with its triangles over points and over vertices of the file.

use crate::remesh::fine_mesh::{FileMesh, FineVertex};
use crease_geometry::math::Vec3;
use crease_geometry::mesh::edge_key;
use rustc_hash::FxHashMap;

/// Triangle of the mesh.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct SplitTriangle {
    /// Points at its corners.
    pub points: [u32; 3],
    /// Vertices at its corners.
    pub vertices: [u32; 3],
    /// Triangle of the file that it is a part of.
    pub parent: u32,
}

/// Split of an edge: the new point, or the new vertex, is the mean of its ends.
#[derive(Debug, Clone, Copy, PartialEq)]
struct EdgeSplit {
    ends: [u32; 2],
    /// Weight of the second end.
    weight: f64,
}

/// Split of an edge between two vertices of a triangle.
#[derive(Debug, Clone, Copy, PartialEq)]
struct VertexSplit {
    point: u32,
    split: EdgeSplit,
}

/// A mesh in the course of splits.
pub(super) struct SplitMesh {
    /// Source position per point [m].
    pub points: Vec<Vec3>,
    pub triangles: Vec<SplitTriangle>,
    /// Triangles on every edge.
    on_edge: FxHashMap<[u32; 2], Vec<u32>>,
    /// Points of the file.
    file_points: usize,
    /// Per new point: the split that made it.
    splits: Vec<EdgeSplit>,
    /// Vertices of the file.
    file_vertices: usize,
    /// Per new vertex: the split that made it.
    vertex_splits: Vec<VertexSplit>,
}

impl SplitMesh {
    /// The triangles of the file.
    pub fn new(file: &FileMesh) -> Self {
        let mut on_edge: FxHashMap<[u32; 2], Vec<u32>> = FxHashMap::default();
        for (f, t) in file.triangles.iter().enumerate() {
            for k in 0..3 {
                on_edge.entry(edge_key(t.points[k], t.points[(k + 1) % 3])).or_default().push(f as u32);
            }
        }
        let triangle = |(f, t): (usize, &super::FileTriangle)| SplitTriangle {
            points: t.points,
            vertices: t.vertices,
            parent: f as u32,
        };
        Self {
            points: file.points.to_vec(),
            triangles: file.triangles.iter().enumerate().map(triangle).collect(),
            on_edge,
            file_points: file.points.len(),
            splits: Vec::new(),
            file_vertices: file.vertex_count,
            vertex_splits: Vec::new(),
        }
    }

    /// All edges, sorted.
    pub fn edges(&self) -> Vec<[u32; 2]> {
        let mut edges: Vec<[u32; 2]> = self.on_edge.keys().copied().collect();
        edges.sort_unstable();
        edges
    }

    /// The triangles on an edge.
    pub fn on(&self, edge: [u32; 2]) -> &[u32] {
        self.on_edge.get(&edge).map_or(&[], Vec::as_slice)
    }

    /// Length of an edge in the source pose [m].
    pub fn length(&self, [a, b]: [u32; 2]) -> f64 {
        (self.points[a as usize] - self.points[b as usize]).norm()
    }

    /// The edges of triangle `f`.
    pub fn edges_of(&self, f: u32) -> [[u32; 2]; 3] {
        let t = self.triangles[f as usize].points;
        [0, 1, 2].map(|k| edge_key(t[k], t[(k + 1) % 3]))
    }

    /// The edges at point `p` of the triangles `faces` and of the last ones made, as many, sorted.
    pub fn edges_at(&self, p: u32, faces: &[u32]) -> Vec<[u32; 2]> {
        let last = self.triangles.len().saturating_sub(faces.len())..self.triangles.len();
        let faces = faces.iter().copied().chain(last.map(|f| f as u32));
        let mut edges: Vec<[u32; 2]> =
            faces.flat_map(|f| self.edges_of(f)).filter(|edge| edge.contains(&p)).collect();
        edges.sort_unstable();
        edges.dedup();
        edges
    }

    /// Splits an edge where its second end has `weight`; returns the new point.
    pub fn split(&mut self, edge: [u32; 2], weight: f64) -> u32 {
        let [a, b] = edge;
        let new = self.points.len() as u32;
        self.points.push(self.points[a as usize] * (1.0 - weight) + self.points[b as usize] * weight);
        self.splits.push(EdgeSplit { ends: edge, weight });
        // Vertices that the triangles on the edge have there.
        let mut made: Vec<([u32; 2], u32)> = Vec::new();
        for f in self.on_edge.remove(&edge).unwrap_or_default() {
            let t = self.triangles[f as usize];
            let corner = |p: u32| t.points.iter().position(|q| *q == p).unwrap_or(0);
            let (i, j) = (corner(a), corner(b));
            let ends = [t.vertices[i], t.vertices[j]];
            let vertex = match made.iter().find(|(own, _)| *own == ends) {
                Some((_, vertex)) => *vertex,
                None => self.new_vertex(new, ends, weight, &mut made),
            };
            let g = self.triangles.len() as u32;
            let with = |k: usize| {
                let mut part = t;
                (part.points[k], part.vertices[k]) = (new, vertex);
                part
            };
            self.triangles[f as usize] = with(j);
            self.triangles.push(with(i));
            let c = t.points[3 - i - j];
            if let Some(on) = self.on_edge.get_mut(&edge_key(b, c)) {
                on.retain(|own| *own != f);
                on.push(g);
            }
            self.on_edge.entry(edge_key(a, new)).or_default().push(f);
            self.on_edge.entry(edge_key(b, new)).or_default().push(g);
            self.on_edge.entry(edge_key(c, new)).or_default().extend([f, g]);
        }
        new
    }

    fn new_vertex(
        &mut self,
        point: u32,
        ends: [u32; 2],
        weight: f64,
        made: &mut Vec<([u32; 2], u32)>,
    ) -> u32 {
        let vertex = (self.file_vertices + self.vertex_splits.len()) as u32;
        self.vertex_splits.push(VertexSplit { point, split: EdgeSplit { ends, weight } });
        made.push((ends, vertex));
        vertex
    }

    /// Values of all points from those of the points of the file, linear on its triangles.
    pub fn carried(&self, of_file: &[Vec3]) -> Vec<Vec3> {
        let mut all = of_file.to_vec();
        all.truncate(self.file_points);
        for EdgeSplit { ends: [a, b], weight } in &self.splits {
            all.push(all[*a as usize] * (1.0 - weight) + all[*b as usize] * *weight);
        }
        all
    }

    /// The new vertices as means of those of the file.
    pub fn fine_vertices(&self) -> Vec<FineVertex> {
        let mut all: Vec<FineVertex> = Vec::with_capacity(self.vertex_splits.len());
        for VertexSplit { point, split: EdgeSplit { ends, weight } } in &self.vertex_splits {
            let mut mean = FineVertex { point: *point, of: [u32::MAX; 3], weights: [0.0; 3] };
            for (end, part) in ends.iter().zip([1.0 - weight, *weight]) {
                match (*end as usize).checked_sub(self.file_vertices) {
                    Some(k) => {
                        let known = all[k];
                        known.of.iter().zip(known.weights).for_each(|(v, w)| add(&mut mean, *v, part * w));
                    }
                    None => add(&mut mean, *end, part),
                }
            }
            let first = mean.of[0];
            mean.of.iter_mut().filter(|v| **v == u32::MAX).for_each(|v| *v = first);
            all.push(mean);
        }
        all
    }
}

/// Adds a vertex of the file to a mean; there are at most three, as a new vertex lies in a triangle of the file.
fn add(mean: &mut FineVertex, vertex: u32, weight: f64) {
    if weight == 0.0 {
        return;
    }
    let slot = mean.of.iter().position(|v| *v == vertex || *v == u32::MAX);
    if let Some(slot) = slot {
        mean.of[slot] = vertex;
        mean.weights[slot] += weight;
    }
}
