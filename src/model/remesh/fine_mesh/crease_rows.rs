//! Splits edges along the middle and both borders of every crease, so that it is as wide as it is, and not as wide as the triangles around.

use crate::remesh::fine_mesh::refine::Places;
use crate::remesh::fine_mesh::split_mesh::SplitMesh;
use crate::remesh::tuning::TUNING;
use crease_geometry::math::Vec3;

/// Splits the edges of `mesh` that the middle of a crease crosses, then those that its borders cross.
pub(super) fn cut(mesh: &mut SplitMesh, places: &mut Places) {
    for crossing in [middle_crossing, border_crossing] {
        for edge in mesh.edges() {
            if mesh.points.len() >= TUNING.max_fine_points {
                return;
            }
            let Some(weight) = crossing(mesh, places, edge) else { continue };
            places.split(mesh, edge, weight);
        }
    }
}

/// Place on an edge where its second end has the weight `part` [m].
fn along(mesh: &SplitMesh, [a, b]: [u32; 2], part: f64) -> Vec3 {
    mesh.points[a as usize] * (1.0 - part) + mesh.points[b as usize] * part
}

/// Distance from the ends within which a crossing is taken for the end, as a part of the length of an edge.
fn snap(mesh: &SplitMesh, edge: [u32; 2], half_width: f64) -> f64 {
    TUNING.fine_snap * half_width / mesh.length(edge).max(f64::MIN_POSITIVE)
}

/// Where the middle of a crease crosses an edge.
fn middle_crossing(mesh: &SplitMesh, places: &Places, edge: [u32; 2]) -> Option<f64> {
    let face = places.at(edge[0] as usize)?.face;
    places.at(edge[1] as usize)?;
    let near = |part: f64| places.creases.at(face, &along(mesh, edge, part));
    let mut crease = near(0.0).or_else(|| near(1.0))?;
    // The crossing with the line of one piece of the middle may lie beside it: then on the piece that is closest there.
    for _ in 0..TUNING.max_fine_tries {
        let [from, to] = [0.0, 1.0].map(|part| places.creases.side(crease.edge, &along(mesh, edge, part)));
        if from * to >= 0.0 {
            return None;
        }
        let part = from / (from - to);
        let found = near(part)?;
        if found.distance < TUNING.fine_snap * found.half_width {
            let snap = snap(mesh, edge, found.half_width);
            return (part > snap && part < 1.0 - snap).then_some(part);
        }
        if found.edge == crease.edge {
            return None;
        }
        crease = found;
    }
    None
}

/// Where the border of a crease crosses an edge that its middle does not cross.
fn border_crossing(mesh: &SplitMesh, places: &Places, edge: [u32; 2]) -> Option<f64> {
    let face = places.at(edge[0] as usize)?.face;
    places.at(edge[1] as usize)?;
    // How far beyond the border a place is [m].
    let beyond = |part: f64| {
        let found = places.creases.at(face, &along(mesh, edge, part))?;
        Some(found.distance - found.half_width)
    };
    let (mut low, mut high) = (0.0, 1.0);
    let (start, end) = (beyond(0.0)?, beyond(1.0)?);
    if start * end >= 0.0 {
        return None;
    }
    for _ in 0..TUNING.fine_bisections {
        let middle = 0.5 * (low + high);
        if beyond(middle)? * start > 0.0 { low = middle } else { high = middle }
    }
    let part = 0.5 * (low + high);
    let half_width = places.creases.at(face, &along(mesh, edge, part))?.half_width;
    let snap = snap(mesh, edge, half_width);
    (part > snap && part < 1.0 - snap).then_some(part)
}
