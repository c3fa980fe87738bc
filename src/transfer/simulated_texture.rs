//! Texture coordinates of the mesh that was simulated: those of the file's surface, on which it lies.
//!
//! Memory is earned on the simulated mesh, whose edges follow the folds; the file's triangles hold a coarser copy. With these
//! coordinates a match by texture takes the earned memory, too. Every triangle takes the island of the texture that is nearest to its
//! centroid on the same side of the cloth, and every corner the nearest place of that island, so that corners beside a seam stay on
//! their own side of it.

use crate::transfer::correspondence::texture_islands;
use crease_geometry::math::{Vec2, Vec3};
use crease_geometry::mesh::triangle_bvh::{NearestTriangle, TriangleBvh};
use crease_model::remesh::GarmentSurface;

/// Returns `simulated` with the texture coordinates of `file`, on whose surface it lies; `None` where that has none, or where part of
/// it is elsewhere.
pub(super) fn with_texture_of(simulated: &GarmentSurface, file: &GarmentSurface) -> Option<GarmentSurface> {
    let uvs = file.uvs.as_ref()?;
    let islands = texture_islands(file, uvs);
    let tree = TriangleBvh::new(&file.points, &file.triangles, 0.0);
    let sign = file.orientation_sign() * simulated.orientation_sign();
    let normals: Vec<Vec3> = (0..file.triangles.len()).map(|f| sign * file.normal(f)).collect();
    let own = (0..simulated.triangles.len()).map(|f| {
        let normal = simulated.normal(f);
        let agrees = |g: u32| normals[g as usize].dot(&normal) > 0.0;
        let near =
            |x: Vec3, fits: &dyn Fn(u32) -> bool| tree.nearest_where(&file.points, x, f64::INFINITY, fits);
        let island = islands[near(simulated.centroid(f), &agrees)?.triangle as usize];
        let is_own = |g: u32| islands[g as usize] == island && agrees(g);
        let [a, b, c] = simulated.corners(f).map(|x| near(x, &is_own).map(|place| uv_at(&place, uvs)));
        Some([a?, b?, c?])
    });
    let own: Vec<[Vec2; 3]> = own.collect::<Option<_>>()?;
    Some(GarmentSurface { uvs: Some(own), ..simulated.clone() })
}

/// Texture coordinates at a place of the file's surface.
fn uv_at(place: &NearestTriangle, uvs: &[[Vec2; 3]]) -> Vec2 {
    uvs[place.triangle as usize].iter().zip(place.weights()).map(|(uv, w)| uv * w).sum()
}
