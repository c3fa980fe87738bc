//! The memory of angles as curvature of the cloth.

use crate::garment::{Garment, RestState};
use crease_geometry::math::{Mat3, Vec3};
use crease_geometry::mesh::triangle;

/// Per triangle of `garment`: the change of curvature that its hinges remember [1/m], that of every hinge spread over both sides of it.
pub fn changed_curvature(garment: &Garment, memory: &RestState) -> Vec<Mat3> {
    let mut sum = vec![Mat3::zeros(); garment.triangles.len()];
    for (h, hinge) in garment.topology.hinges.iter().enumerate() {
        let change = memory.rest_angle[h] - memory.source_angle[h];
        if change == 0.0 {
            continue;
        }
        let [a, b] = [hinge.points[0], hinge.points[1]].map(|p| garment.points[p.at()]);
        for f in hinge.triangles.map(|f| f as usize) {
            let corners = triangle::corners(&garment.points, &garment.triangles[f]);
            let normal = triangle::normal(&corners).unwrap_or_else(Vec3::zeros);
            let across = normal.cross(&(b - a)).try_normalize(0.0).unwrap_or_else(Vec3::zeros);
            let area = triangle::area(&corners).max(f64::MIN_POSITIVE);
            sum[f] += across * across.transpose() * (change * (b - a).norm() / (2.0 * area));
        }
    }
    sum
}
