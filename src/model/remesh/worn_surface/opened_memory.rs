//! The memory that a pose shows: weight and body open creases, the deeper ones by more.
//!
//! What moves a garment out of its pose is the angle by which a crease turns the cloth as a whole, whatever number of hinges has it. So the net
//! angle of a crease, that of its centre line with the rows beside it, is limited, and beside creases the angle of a hinge by the width of cloth
//! that it stands for.

use crate::garment::{RestState, opened_fraction};
use crate::remesh::GarmentSurface;
use crate::remesh::worn_surface::crease_edges::CreaseEdges;

/// The memory `earned` on `mesh`, one entry per hinge and triangle of it, as a pose opens it that leaves at most the angle `limit` [rad] of a crease:
/// a net change `a` becomes `limit` tanh(`a` / `limit`). Rest lengths and stiffness stay.
pub fn opened_memory(mesh: &GarmentSurface, earned: &RestState, limit: f64) -> RestState {
    let changes: Vec<f64> = earned.angle_changes().collect();
    let edges = CreaseEdges::find(mesh, &changes);
    let net = edges.net_angles(mesh, &changes);
    let fraction = |h: usize| opened_fraction(&mesh.points, &mesh.triangles, &mesh.topology.hinges[h]);
    let alone = |(h, change): (usize, &f64)| left_of(*change, limit * fraction(h));
    let mut opened: Vec<f64> = changes.iter().enumerate().map(alone).collect();
    for h in edges.centre_hinges() {
        opened[h] = changes[h] * fraction_left(net[h], limit);
    }
    for (row, centre) in edges.rows() {
        opened[row] = changes[row] * fraction_left(net[centre], limit);
    }
    let angles = earned.source_angle.iter().zip(&opened);
    RestState { rest_angle: angles.map(|(source, change)| source + change).collect(), ..earned.clone() }
}

/// What a pose with the limit `limit` [rad] leaves of the angle `angle` [rad].
fn left_of(angle: f64, limit: f64) -> f64 {
    if limit > 0.0 { limit * (angle / limit).tanh() } else { 0.0 }
}

/// The same as a fraction of it [-].
fn fraction_left(angle: f64, limit: f64) -> f64 {
    if angle == 0.0 { 1.0 } else { left_of(angle, limit) / angle }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::garment::Garment;

    /// A sheet of `count` squares along x, 0.24 m long, whose hinges within `reach` of the middle have the angle 2 together, the middle two thirds of it
    /// or more; the sum of the opened ones along a row.
    fn left(count: u32, reach: f64) -> f64 {
        let garment = Garment::sheet([0.24, 0.24], [count, 24]).expect("is a sheet");
        let mesh = GarmentSurface::without_texture(&garment);
        let x = |p: &crease_geometry::mesh::PointIndex| garment.points[p.at()].x;
        let low = garment.points.iter().map(|x| x.x).fold(f64::INFINITY, f64::min);
        let across = |h: &crease_geometry::mesh::Hinge| (x(&h.points[0]) - x(&h.points[1])).abs() < 1e-9;
        let near = |h: &crease_geometry::mesh::Hinge| {
            across(h) && (x(&h.points[0]) - low - 0.12).abs() < reach + 1e-9
        };
        let hinges = &garment.topology.hinges;
        let beside = hinges.iter().filter(|h| near(h)).count() as f64 / 24.0 - 1.0;
        let mut memory = RestState::flat(hinges.len(), garment.triangles.len());
        for (angle, hinge) in memory.rest_angle.iter_mut().zip(hinges) {
            let is_middle = (x(&hinge.points[0]) - low - 0.12).abs() < 1e-9;
            *angle = match (near(hinge), is_middle) {
                (true, true) => 2.0 - 0.33 * beside,
                (true, false) => 0.33,
                (false, _) => 0.0,
            };
        }
        let opened = opened_memory(&mesh, &memory, 0.8);
        opened.angle_changes().sum::<f64>() / 24.0
    }

    #[test]
    fn a_crease_opens_to_the_same_angle_on_any_mesh() {
        let expected = 0.8 * (2.0f64 / 0.8).tanh();
        // One hinge, three of 8 mm, and one of 20 mm.
        for (count, reach) in [(30, 0.0), (30, 8e-3), (12, 0.0)] {
            let left = left(count, reach);
            assert!((left - expected).abs() < 1e-6, "{count} squares, {reach} m: {left}, not {expected}");
        }
    }
}
