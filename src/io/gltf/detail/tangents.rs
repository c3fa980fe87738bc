//! Computes the tangents of a mesh by the MikkTSpace convention, one per vertex.
//!
//! glTF's texture coordinates grow downward and its bitangent, cross(normal, tangent) times the handedness, points up in
//! the picture; MikkTSpace is therefore given 1 - v. It works per corner and may ask for a vertex to be split; a file's
//! vertices keep their number here, so that a vertex gets the mean of its corners, with the handedness of the majority.

use crate::gltf::worn_target::perpendicular_unit;
use bevy_mikktspace::{Geometry, TangentSpace, generate_tangents};
use crease_geometry::math::{Vec2, Vec3};

/// Tangent of a vertex.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Tangent {
    /// Unit direction.
    pub(super) direction: Vec3,
    /// +1 or -1.
    pub(super) handedness: f64,
}

/// Mesh with texture coordinates; lists are one per vertex.
struct Mesh<'a> {
    positions: &'a [Vec3],
    normals: &'a [Vec3],
    uvs: &'a [Vec2],
    triangles: &'a [[u32; 3]],
    /// Per vertex: sums over its corners.
    sums: Vec<TangentSum>,
}

/// Sums over the corners of a vertex.
#[derive(Debug, Clone, Copy)]
struct TangentSum {
    direction: Vec3,
    handedness: f64,
}

impl Mesh<'_> {
    fn vertex(&self, face: usize, corner: usize) -> usize {
        self.triangles[face][corner] as usize
    }
}

impl Geometry for Mesh<'_> {
    fn num_faces(&self) -> usize {
        self.triangles.len()
    }

    fn num_vertices_of_face(&self, _: usize) -> usize {
        3
    }

    fn position(&self, face: usize, corner: usize) -> [f32; 3] {
        narrow(&self.positions[self.vertex(face, corner)])
    }

    fn normal(&self, face: usize, corner: usize) -> [f32; 3] {
        narrow(&self.normals[self.vertex(face, corner)])
    }

    fn tex_coord(&self, face: usize, corner: usize) -> [f32; 2] {
        let uv = &self.uvs[self.vertex(face, corner)];
        [uv.x as f32, (1.0 - uv.y) as f32]
    }

    fn set_tangent(&mut self, space: Option<TangentSpace>, face: usize, corner: usize) {
        let v = self.vertex(face, corner);
        if let Some(space) = space {
            let [x, y, z] = space.tangent().map(f64::from);
            self.sums[v].direction += Vec3::new(x, y, z);
            self.sums[v].handedness += if space.is_orientation_preserving() { 1.0 } else { -1.0 };
        }
    }
}

fn narrow(v: &Vec3) -> [f32; 3] {
    [v.x as f32, v.y as f32, v.z as f32]
}

/// Computes the tangents of a mesh; `positions`, `normals` and `uvs` are one per vertex, `triangles` index them. Where
/// texture coordinates define no direction, any direction perpendicular to the normal.
pub(super) fn compute_tangents(
    positions: &[Vec3],
    normals: &[Vec3],
    uvs: &[Vec2],
    triangles: &[[u32; 3]],
) -> Vec<Tangent> {
    let count = positions.len().min(normals.len()).min(uvs.len());
    let valid: Vec<[u32; 3]> =
        triangles.iter().filter(|t| t.iter().all(|&v| (v as usize) < count)).copied().collect();
    let sums = vec![TangentSum { direction: Vec3::zeros(), handedness: 0.0 }; count];
    let mut mesh = Mesh { positions, normals, uvs, triangles: &valid, sums };
    // Fails only for an empty mesh; then no corner has been set.
    let _ = generate_tangents(&mut mesh);
    let finished = mesh.sums.iter().zip(normals).map(|(sum, n)| {
        let perpendicular = sum.direction - n * n.dot(&sum.direction);
        let direction = perpendicular.try_normalize(1e-9).unwrap_or_else(|| perpendicular_unit(*n));
        Tangent { direction, handedness: if sum.handedness < 0.0 { -1.0 } else { 1.0 } }
    });
    finished.collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A unit square in the plane z = 0 seen from +z, its picture upright or mirrored.
    fn square(mirrored: bool) -> Vec<Tangent> {
        let at = |x: f64, y: f64| Vec3::new(x, y, 0.0);
        let positions = [at(0.0, 0.0), at(1.0, 0.0), at(1.0, 1.0), at(0.0, 1.0)];
        let uv = |p: &Vec3| Vec2::new(if mirrored { 1.0 - p.x } else { p.x }, 1.0 - p.y);
        let uvs: Vec<Vec2> = positions.iter().map(uv).collect();
        compute_tangents(&positions, &[Vec3::z(); 4], &uvs, &[[0, 1, 2], [0, 2, 3]])
    }

    #[test]
    fn tangents_follow_u_and_bitangents_point_up_in_the_picture() {
        for t in square(false) {
            assert!((t.direction - Vec3::x()).norm() < 1e-6 && t.handedness == 1.0, "{t:?}");
        }
        for t in square(true) {
            assert!((t.direction + Vec3::x()).norm() < 1e-6 && t.handedness == -1.0, "{t:?}");
        }
    }

    #[test]
    fn without_texture_any_direction_perpendicular_to_the_normal_is_taken() {
        let points = [Vec3::zeros(), Vec3::x(), Vec3::y()];
        for t in compute_tangents(&points, &[Vec3::z(); 3], &[Vec2::zeros(); 3], &[[0, 1, 2]]) {
            assert!((t.direction.norm() - 1.0).abs() < 1e-9 && t.direction.z.abs() < 1e-9);
        }
        assert!(compute_tangents(&[], &[], &[], &[]).is_empty());
        assert_eq!(compute_tangents(&points, &[Vec3::z(); 3], &[Vec2::zeros(); 3], &[[0, 1, 9]]).len(), 3);
    }
}
