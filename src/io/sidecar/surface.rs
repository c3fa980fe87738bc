//! The surface and the memory of a sidecar, as they are carried to another mesh.
//!
//! The memory is reordered to the hinges of the surface's own topology; a sidecar whose hinges are not those of its triangles is
//! refused.

use crate::sidecar::Sidecar;
use crease_geometry::math::Vec2;
use crease_geometry::mesh::{Hinge, PointIndex, Topology};
use crease_model::error::{Error, Result};
use crease_model::garment::RestState;
use crease_model::remesh::{GarmentSurface, warp_direction};
use rustc_hash::FxHashMap;

/// The surface of `sidecar` and its memory, one entry per hinge of the surface's topology.
///
/// # Errors
/// A diagnostic of `file` if a triangle is degenerate or the hinges are not those of the triangles.
pub fn sidecar_surface(file: &str, sidecar: &Sidecar) -> Result<(GarmentSurface, RestState)> {
    let points = sidecar.mesh_points();
    let triangles = sidecar.mesh_triangles();
    if let Some(i) = triangles.iter().position(|[a, b, c]| a == b || b == c || c == a) {
        return Err(contradiction(file, format!("mesh.triangles[{i}]"), "names a point twice"));
    }
    let topology = Topology::new(points.len(), &triangles);
    let order = hinge_order(file, &topology, &sidecar.hinges.points)?;
    let pick = |values: &[f64]| order.iter().map(|&h| values[h]).collect::<Vec<f64>>();
    let memory = RestState {
        source_angle: pick(&sidecar.hinges.source_angle_rad),
        rest_angle: pick(&sidecar.hinges.rest_angle_rad),
        stiffness_ratio: pick(&sidecar.hinges.stiffness_ratio),
        rest_stretch_warp: sidecar.triangles.rest_stretch_warp.clone(),
        rest_stretch_weft: sidecar.triangles.rest_stretch_weft.clone(),
    };
    let warp = sidecar.triangles.warp_angle_rad.as_ref().map(|angles| {
        let corners = |t: &[PointIndex; 3]| t.map(|p| points[p.at()]);
        triangles.iter().zip(angles).map(|(t, &angle)| warp_direction(&corners(t), angle)).collect()
    });
    let uvs = sidecar
        .mesh
        .source_uv
        .as_ref()
        .zip(sidecar.mesh.triangle_vertices.as_ref())
        .map(|(uvs, corners)| corners.iter().map(|t| t.map(|v| Vec2::from(uvs[v as usize]))).collect());
    let on_fold_line = sidecar.mesh.fold_line_points.as_ref().map(|on| {
        let mut flags = vec![false; points.len()];
        on.iter().for_each(|p| flags[*p as usize] = true);
        flags
    });
    Ok((GarmentSurface { points, triangles, topology, uvs, warp, on_fold_line }, memory))
}

/// Per hinge of `topology`, its index in `listed`.
fn hinge_order(file: &str, topology: &Topology, listed: &[[u32; 4]]) -> Result<Vec<usize>> {
    let key = |a: u32, b: u32| if a < b { [a, b] } else { [b, a] };
    let indices: FxHashMap<[u32; 2], usize> =
        listed.iter().enumerate().map(|(i, h)| (key(h[0], h[1]), i)).collect();
    if listed.len() != topology.hinges.len() {
        let what = format!("has {} hinges, the triangles have {}", listed.len(), topology.hinges.len());
        return Err(contradiction(file, "hinges.points".to_owned(), what));
    }
    let find = |h: &Hinge| {
        let [a, b, c, d] = h.points.map(|p| p.0);
        let index = indices.get(&key(a, b)).copied()?;
        let opposite = &listed[index][2..];
        (opposite == [c, d] || opposite == [d, c]).then_some(index)
    };
    topology
        .hinges
        .iter()
        .map(|h| {
            find(h).ok_or_else(|| {
                let what = format!("lacks the hinge between points {} and {}", h.points[0].0, h.points[1].0);
                contradiction(file, "hinges.points".to_owned(), what)
            })
        })
        .collect()
}

fn contradiction(file: &str, location: String, what: impl Into<crease_model::error::Message>) -> Error {
    Error::input(file, location, what, "use the sidecar as crease wrote it, or bake again")
}
