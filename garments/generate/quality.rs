//! Mesh quality: number of points, triangle shape, openings.

use crate::Mesh;
use crease_geometry::mesh::{PointIndex, Topology};
use std::collections::BTreeMap;

/// Quality of one mesh, with welded seams.
#[derive(Debug, Clone, Copy)]
pub struct Quality {
    /// Number of points after welding.
    pub point_count: usize,
    /// Number of vertices in the file.
    pub vertex_count: usize,
    /// Number of triangles.
    pub triangle_count: usize,
    /// Smallest angle of any triangle [degrees].
    pub min_angle_deg: f64,
    /// Mean edge length [m].
    pub mean_edge_m: f64,
    /// Mean of 4 sqrt(3) area / sum of squared edges: 1 for equilateral triangles.
    pub mean_shape: f64,
    /// Number of boundary loops.
    pub opening_count: usize,
    /// Number of connected components.
    pub part_count: usize,
    /// Number of edges with more than two triangles, or with two of opposite orientation.
    pub bad_edge_count: usize,
}

impl std::fmt::Display for Quality {
    fn fmt(&self, out: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(
            out,
            "{} points ({} vertices), {} triangles, edge {:.2} mm, smallest angle {:.1} degrees, shape {:.3}, {} openings, {} parts, {} bad edges",
            self.point_count,
            self.vertex_count,
            self.triangle_count,
            1e3 * self.mean_edge_m,
            self.min_angle_deg,
            self.mean_shape,
            self.opening_count,
            self.part_count,
            self.bad_edge_count
        )
    }
}

/// Number of points and triangles over them after merging vertices of equal position, as the file stores it.
fn weld(mesh: &Mesh) -> (usize, Vec<[PointIndex; 3]>) {
    let mut seen: BTreeMap<[u32; 3], u32> = BTreeMap::new();
    let point_of: Vec<u32> = mesh
        .positions
        .iter()
        .map(|p| {
            let next = seen.len() as u32;
            *seen.entry([p.x, p.y, p.z].map(|c| (c as f32).to_bits())).or_insert(next)
        })
        .collect();
    let triangles = mesh.triangles.iter().map(|t| t.map(|i| PointIndex(point_of[i as usize]))).collect();
    (seen.len(), triangles)
}

/// Number of connected components, by union-find.
fn part_count(point_count: usize, topology: &Topology) -> usize {
    let mut parent: Vec<usize> = (0..point_count).collect();
    fn root(parent: &mut [usize], mut i: usize) -> usize {
        while parent[i] != i {
            parent[i] = parent[parent[i]];
            i = parent[i];
        }
        i
    }
    for [a, b] in &topology.edges {
        let (a, b) = (root(&mut parent, a.at()), root(&mut parent, b.at()));
        parent[a] = b;
    }
    (0..point_count).filter(|&i| parent[i] == i).count()
}

/// Measures `mesh`.
pub fn measure(mesh: &Mesh) -> Quality {
    let (point_count, triangles) = weld(mesh);
    let topology = Topology::new(point_count, &triangles);
    let (mut min_angle, mut edges, mut shape) = (f64::MAX, 0.0, 0.0);
    for t in &mesh.triangles {
        let p = t.map(|i| mesh.positions[i as usize]);
        let mut squares = 0.0;
        for k in 0..3 {
            let (d, e) = (p[(k + 1) % 3] - p[k], p[(k + 2) % 3] - p[k]);
            min_angle = d.angle(&e).min(min_angle);
            squares += d.norm_squared();
            edges += d.norm();
        }
        shape += 2.0 * 3f64.sqrt() * (p[1] - p[0]).cross(&(p[2] - p[0])).norm() / squares;
    }
    let count = mesh.triangles.len() as f64;
    Quality {
        point_count,
        vertex_count: mesh.positions.len(),
        triangle_count: mesh.triangles.len(),
        min_angle_deg: min_angle.to_degrees(),
        mean_edge_m: edges / (3.0 * count),
        mean_shape: shape / count,
        opening_count: topology.boundary_loops(&triangles).len(),
        part_count: part_count(point_count, &topology),
        bad_edge_count: topology.misoriented.len() + topology.edge_valence.iter().filter(|&&v| v > 2).count(),
    }
}
