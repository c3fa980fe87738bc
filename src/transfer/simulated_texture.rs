//! Texture coordinates of the mesh that was simulated: those of the file's surface, on which it lies.
//!
//! Memory is earned on the simulated mesh, whose edges follow the folds; the file's triangles hold a coarser copy. With these
//! coordinates a match by texture takes the earned memory, too. Every triangle takes the island of the texture that is nearest to its
//! centroid on the same side of the cloth, and every corner the nearest place of that island that lies near the centroid in the texture,
//! too: corners at a seam stay on their own side of it, also where one island meets itself, as on a tube.

use crate::transfer::correspondence::texture_islands;
use crate::transfer::tuning::TUNING;
use crease_geometry::math::{Vec2, Vec3};
use crease_geometry::mesh::distance::{barycentric, point_triangle_squared};
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
        let middle = near(simulated.centroid(f), &agrees)?;
        let island = islands[middle.triangle as usize];
        let is_own = |g: u32| islands[g as usize] == island && agrees(g);
        let at = uv_at(&middle, uvs);
        let from = file.corners(middle.triangle as usize);
        let [a, b, c] = simulated.corners(f).map(|x| {
            let expected = weighted(&uvs[middle.triangle as usize], barycentric(&x, &from));
            let reach = TUNING.max_texture_deviation * (expected - at).norm();
            let is_beside = |g: u32| is_own(g) && distance_in_texture(&uvs[g as usize], &expected) <= reach;
            near(x, &is_beside).or_else(|| near(x, &is_own)).map(|place| uv_at(&place, uvs))
        });
        Some([a?, b?, c?])
    });
    let own: Vec<[Vec2; 3]> = own.collect::<Option<_>>()?;
    Some(GarmentSurface { uvs: Some(own), ..simulated.clone() })
}

/// Distance of `at` from a triangle of the texture.
fn distance_in_texture(triangle: &[Vec2; 3], at: &Vec2) -> f64 {
    let [p, a, b, c] = [at, &triangle[0], &triangle[1], &triangle[2]].map(|uv| Vec3::new(uv.x, uv.y, 0.0));
    point_triangle_squared(&p, &a, &b, &c).sqrt()
}

/// Texture coordinates at a place of the file's surface.
fn uv_at(place: &NearestTriangle, uvs: &[[Vec2; 3]]) -> Vec2 {
    weighted(&uvs[place.triangle as usize], place.weights())
}

/// Sum of the corners of a triangle of the texture times `weights`.
fn weighted(corners: &[Vec2; 3], weights: [f64; 3]) -> Vec2 {
    corners.iter().zip(weights).map(|(uv, w)| uv * w).sum()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crease_geometry::mesh::{PointIndex, Topology};
    use std::f64::consts::TAU;

    /// A tube of radius and height 0.1 m with `count` columns, the first of which begins at `start` of a turn. One island of the texture
    /// covers it and meets itself at the beginning of a turn.
    fn tube(count: u32, start: f64) -> GarmentSurface {
        let turn = |k: u32| start + f64::from(k) / f64::from(count);
        let point = |k: u32, y: f64| Vec3::new(0.1 * (TAU * turn(k)).cos(), y, 0.1 * (TAU * turn(k)).sin());
        let points: Vec<Vec3> = (0..count).flat_map(|k| [point(k, 0.0), point(k, 0.1)]).collect();
        let columns = (0..count).map(|k| (k, (k + 1) % count));
        let triangles: Vec<[PointIndex; 3]> = columns
            .flat_map(|(k, n)| [[2 * k, 2 * k + 1, 2 * n], [2 * n, 2 * k + 1, 2 * n + 1]])
            .map(|t| t.map(PointIndex))
            .collect();
        let uvs = (0..count)
            .flat_map(|k| {
                let [l, r] = [k, k + 1].map(turn);
                [[[l, 0.0], [l, 1.0], [r, 0.0]], [[r, 0.0], [l, 1.0], [r, 1.0]]]
            })
            .map(|t| t.map(|[u, v]| Vec2::new(u, v)))
            .collect();
        let topology = Topology::new(points.len(), &triangles);
        GarmentSurface { points, triangles, topology, uvs: Some(uvs), warp: None, on_fold_line: None }
    }

    #[test]
    fn an_island_that_meets_itself_is_not_crossed() {
        let file = tube(24, 0.0);
        let simulated = GarmentSurface { uvs: None, ..tube(40, 0.0) };
        let textured = with_texture_of(&simulated, &file).expect("lies on it");
        for uv in textured.uvs.expect("has a texture") {
            let width = [0, 1, 2].map(|k| (uv[k].x - uv[(k + 1) % 3].x).abs());
            assert!(width.iter().all(|width| *width < 0.1), "{uv:?}");
        }
    }
}
