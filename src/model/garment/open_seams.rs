//! Borders that face each other at next to no distance: seams that a file left open.

use crate::error::{Message, Setting};
use crate::garment::Garment;
use crate::garment::tuning::TUNING;
use crease_geometry::math::Vec3;
use crease_geometry::mesh::triangle_bvh::TriangleBvh;
use crease_geometry::mesh::{PointIndex, triangle};

/// A border edge with its triangle.
struct BorderEdge {
    triangle: u32,
    middle: Vec3,
    length: f64,
    /// Unit direction in the plane of the triangle, away from it.
    outward: Vec3,
}

/// Returns a warning if borders of `garment` lie along one another and are not joined.
pub(super) fn open_seams(garment: &Garment) -> Option<Message> {
    let edges = border_edges(garment);
    let triangles: Vec<[PointIndex; 3]> =
        edges.iter().map(|edge| garment.triangles[edge.triangle as usize]).collect();
    let bvh = TriangleBvh::new(&garment.points, &triangles, 0.0);
    let (mut length, mut gap) = (0.0, 0.0f64);
    for edge in &edges {
        let own = &garment.triangles[edge.triangle as usize];
        let faces = |g: u32| {
            let other = &edges[g as usize];
            other.outward.dot(&edge.outward) < TUNING.max_seam_cosine
                && triangles[g as usize].iter().filter(|p| own.contains(p)).count() < 2
                && (other.middle - edge.middle).dot(&edge.outward) > -TUNING.max_seam_gap
        };
        if let Some(near) = bvh.nearest_where(&garment.points, edge.middle, TUNING.max_seam_gap, faces) {
            length += edge.length;
            gap = gap.max(near.closest.distance);
        }
    }
    (length > 0.0).then(|| {
        let what = format!(
            "{:.2} m of borders lie within {:.2} mm of another border and are not joined to it (open seams): ",
            0.5 * length,
            (1e3 * gap).max(0.01)
        );
        Message::from(what)
            + Setting::Weld.to_number(format!("{:.1}", (1e4 * gap).ceil().max(1.0) / 10.0))
            + " joins vertices up to that many millimetres apart; sides with different numbers of vertices have to be sewn in the \
               file"
    })
}

fn border_edges(garment: &Garment) -> Vec<BorderEdge> {
    let topology = &garment.topology;
    let mut edges = Vec::new();
    for (f, sides) in topology.triangle_edges.iter().enumerate() {
        let corners = triangle::corners(&garment.points, &garment.triangles[f]);
        for (k, &e) in sides.iter().enumerate() {
            if topology.edge_valence[e as usize] != 1 {
                continue;
            }
            let (a, b, opposite) = (corners[k], corners[(k + 1) % 3], corners[(k + 2) % 3]);
            let along = b - a;
            let away = a - opposite;
            let across = away - along * (away.dot(&along) / along.norm_squared());
            if let Some(outward) = across.try_normalize(0.0) {
                let middle = (a + b) * 0.5;
                edges.push(BorderEdge { triangle: f as u32, middle, length: along.norm(), outward });
            }
        }
    }
    edges
}
