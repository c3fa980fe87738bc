//! Moves points of the finer mesh back towards the triangles of the file where its triangles would intersect.

use crate::remesh::fine_mesh::split_mesh::SplitMesh;
use crate::remesh::fine_mesh::{FileMesh, FinePoint};
use crate::remesh::tuning::TUNING;
use crease_geometry::math::Vec3;
use crease_geometry::mesh::PointIndex;
use crease_geometry::mesh::intersections::self_intersections;

/// Moves the `points` of triangles that intersect towards `linear`, where the worn triangles of the file have them, until none intersect
/// that are not parts of intersecting triangles of the file. Returns the number of pairs that are left.
pub(super) fn resolve(mesh: &SplitMesh, file: &FileMesh, linear: &[Vec3], points: &mut [FinePoint]) -> usize {
    let indices = |t: [u32; 3]| t.map(PointIndex);
    let triangles: Vec<[PointIndex; 3]> = mesh.triangles.iter().map(|t| indices(t.points)).collect();
    let of_file: Vec<[PointIndex; 3]> = file.triangles.iter().map(|t| indices(t.points)).collect();
    let allowed: [Vec<[u32; 2]>; 2] =
        [file.points, file.after].map(|points| self_intersections(points, &of_file));
    let is_added = |[f, g]: &[u32; 2]| {
        let [a, b] = [f, g].map(|f| mesh.triangles[*f as usize].parent);
        let parents = [a.min(b), a.max(b)];
        allowed.iter().all(|allowed| allowed.binary_search(&parents).is_err())
    };
    let worn: Vec<Vec3> = points.iter().map(|point| point.position).collect();
    let mut part = vec![1.0; worn.len()];
    for round in 0.. {
        let now: Vec<Vec3> = points.iter().map(|point| point.position).collect();
        let mut added = self_intersections(&now, &triangles);
        added.retain(is_added);
        if added.is_empty() || round == TUNING.max_fine_rounds {
            return added.len();
        }
        let mut marked = vec![false; worn.len()];
        for f in added.iter().flatten() {
            mesh.triangles[*f as usize].points.iter().for_each(|p| marked[*p as usize] = true);
        }
        for _ in 0..round {
            marked = with_neighbours(mesh, &marked);
        }
        for p in (0..worn.len()).filter(|p| marked[*p]) {
            part[p] = if part[p] > TUNING.min_fine_part { 0.5 * part[p] } else { 0.0 };
            points[p].position = linear[p] * (1.0 - part[p]) + worn[p] * part[p];
        }
    }
    0
}

/// The flagged points and those that have a triangle in common with one.
fn with_neighbours(mesh: &SplitMesh, flags: &[bool]) -> Vec<bool> {
    let mut all = flags.to_vec();
    for t in &mesh.triangles {
        if t.points.iter().any(|p| flags[*p as usize]) {
            t.points.iter().for_each(|p| all[*p as usize] = true);
        }
    }
    all
}
