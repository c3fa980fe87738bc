//! Rasterisation: the triangle seen by each sample of the picture, by a depth buffer of twice the resolution in both
//! directions.

use crate::report::render::camera::Projection;
use crease_geometry::math::{Vec2, Vec3};
use crease_geometry::mesh::INVALID;

/// Samples per pixel in each direction.
pub(super) const SAMPLES: usize = 2;

/// Samples of a picture.
pub(super) struct Samples {
    /// Picture size [pixels].
    pub size: [usize; 2],
    /// Per sample, rows from the top: index of the triangle seen in the list of drawn triangles.
    pub triangle: Vec<u32>,
    /// Per sample: nearness of the triangle; 0 without one.
    pub nearness: Vec<f32>,
    /// Per point of the mesh: position [pixels] and nearness.
    pub projected: Vec<Vec3>,
}

impl Samples {
    /// Returns the number of samples in a row.
    pub fn row_len(&self) -> usize {
        SAMPLES * self.size[0]
    }
}

/// Returns the points that the triangles use; others do not affect the camera.
pub(super) fn used_points(points: &[Vec3], triangles: &[[usize; 3]]) -> Vec<Vec3> {
    let mut used = vec![false; points.len()];
    for &i in triangles.iter().flatten() {
        used[i] = true;
    }
    points.iter().zip(used).filter(|(_, u)| *u).map(|(p, _)| *p).collect()
}

/// Returns the position of a sample [pixels].
pub(super) fn sample_position(column: usize, row: usize) -> Vec2 {
    Vec2::new(column as f64 + 0.5, row as f64 + 0.5) / SAMPLES as f64
}

/// Returns the barycentric weights of the corners at `p`, on screen; `None` for a triangle seen edge-on.
pub(super) fn weights(corners: &[Vec3; 3], p: Vec2) -> Option<[f64; 3]> {
    let [a, b, c] = corners.map(|q| q.xy());
    let whole = (b - a).perp(&(c - a));
    if whole.abs() < 1e-12 {
        return None;
    }
    let (u, v) = ((p - a).perp(&(c - a)) / whole, (b - a).perp(&(p - a)) / whole);
    Some([1.0 - u - v, u, v])
}

/// Rasterises all triangles, whose indices must be in range.
pub(super) fn rasterise(
    points: &[Vec3],
    triangles: &[[usize; 3]],
    projection: &Projection,
    size: [usize; 2],
) -> Samples {
    let projected: Vec<Vec3> = points.iter().map(|&p| projection.project(p)).collect();
    let (columns, rows) = (SAMPLES * size[0], SAMPLES * size[1]);
    let mut samples = Samples {
        size,
        triangle: vec![INVALID; columns * rows],
        nearness: vec![0.0; columns * rows],
        projected,
    };
    for (f, t) in triangles.iter().enumerate() {
        let corners = t.map(|i| samples.projected[i]);
        draw(&mut samples, f as u32, &corners, columns, rows);
    }
    samples
}

/// Rasterises triangle `f`.
fn draw(samples: &mut Samples, f: u32, corners: &[Vec3; 3], columns: usize, rows: usize) {
    let span = |k: usize, count: usize| {
        let low = corners.iter().map(|c| c[k]).fold(f64::INFINITY, f64::min);
        let high = corners.iter().map(|c| c[k]).fold(f64::NEG_INFINITY, f64::max);
        let first = (low * SAMPLES as f64 - 0.5).ceil().max(0.0) as usize;
        first..((high * SAMPLES as f64 + 0.5).max(0.0) as usize).min(count)
    };
    for row in span(1, rows) {
        for column in span(0, columns) {
            let Some(w) = weights(corners, sample_position(column, row)) else { return };
            // A slight overlap avoids holes between neighbours.
            if w.iter().any(|&x| x < -1e-9) {
                continue;
            }
            let nearness = (w[0] * corners[0].z + w[1] * corners[1].z + w[2] * corners[2].z) as f32;
            let at = row * columns + column;
            if nearness > samples.nearness[at] {
                samples.nearness[at] = nearness;
                samples.triangle[at] = f;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::report::render::camera::Camera;

    #[test]
    fn two_triangles_of_a_square_leave_no_hole_between_them() {
        let points = [(0.0, 0.0), (1.0, 0.1), (0.9, 1.0), (-0.1, 1.1)].map(|(x, y)| Vec3::new(x, y, 0.0));
        let triangles = [[0, 1, 2], [0, 2, 3]];
        let projection = Camera { azimuth_deg: Some(0.0), elevation_deg: Some(0.0), ..Camera::default() }
            .aim(&points, [60, 60]);
        let samples = rasterise(&points, &triangles, &projection, [60, 60]);
        for row in 0..120 {
            let line = &samples.triangle[120 * row..120 * (row + 1)];
            let first = line.iter().position(|&f| f != INVALID);
            let last = line.iter().rposition(|&f| f != INVALID);
            if let (Some(first), Some(last)) = (first, last) {
                assert!(line[first..=last].iter().all(|&f| f != INVALID), "a hole in row {row}");
            }
        }
    }
}
