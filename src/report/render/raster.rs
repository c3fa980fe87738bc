//! Which triangle each sample of the picture shows, by a depth buffer at twice the picture's resolution each way.

use crate::math::{Vec2, Vec3};
use crate::report::render::camera::View;

/// Samples per pixel, each way.
pub(super) const SAMPLES: usize = 2;
/// No triangle here.
pub(super) const NOTHING: u32 = u32::MAX;

/// The samples of a picture.
pub(super) struct Samples {
    /// Picture size [pixels].
    pub size: [usize; 2],
    /// Per sample, rows from the top: the triangle seen, as counted in the list that was drawn.
    pub triangle: Vec<u32>,
    /// Per sample: nearness of what is seen; 0 where nothing is.
    pub nearness: Vec<f32>,
    /// Per point of the mesh: its place [pixels] and nearness.
    pub projected: Vec<Vec3>,
}

impl Samples {
    /// Samples in a row.
    pub fn row_len(&self) -> usize {
        SAMPLES * self.size[0]
    }
}

/// The points that the triangles use: others shall not move the camera.
pub(super) fn used_points(points: &[Vec3], triangles: &[[usize; 3]]) -> Vec<Vec3> {
    let mut used = vec![false; points.len()];
    for &i in triangles.iter().flatten() {
        used[i] = true;
    }
    points.iter().zip(used).filter(|(_, u)| *u).map(|(p, _)| *p).collect()
}

/// Where a sample lies [pixels].
pub(super) fn sample_position(column: usize, row: usize) -> Vec2 {
    Vec2::new(column as f64 + 0.5, row as f64 + 0.5) / SAMPLES as f64
}

/// Weights of the three corners at `p`, on screen; `None` for a triangle seen edge-on.
pub(super) fn weights(corners: &[Vec3; 3], p: Vec2) -> Option<[f64; 3]> {
    let [a, b, c] = corners.map(|q| q.xy());
    let whole = (b - a).perp(&(c - a));
    if whole.abs() < 1e-12 {
        return None;
    }
    let (u, v) = ((p - a).perp(&(c - a)) / whole, (b - a).perp(&(p - a)) / whole);
    Some([1.0 - u - v, u, v])
}

/// Draws all triangles; indices must be in range (the caller has sorted out those that are not).
pub(super) fn rasterise(points: &[Vec3], triangles: &[[usize; 3]], view: &View, size: [usize; 2]) -> Samples {
    let projected: Vec<Vec3> = points.iter().map(|&p| view.project(p)).collect();
    let (columns, rows) = (SAMPLES * size[0], SAMPLES * size[1]);
    let mut samples = Samples {
        size,
        triangle: vec![NOTHING; columns * rows],
        nearness: vec![0.0; columns * rows],
        projected,
    };
    for (f, t) in triangles.iter().enumerate() {
        let corners = t.map(|i| samples.projected[i]);
        draw(&mut samples, f as u32, &corners, columns, rows);
    }
    samples
}

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
            // A hair of overlap: no pinholes between neighbours.
            if w.iter().any(|&x| x < -1e-9) {
                continue;
            }
            let near = (w[0] * corners[0].z + w[1] * corners[1].z + w[2] * corners[2].z) as f32;
            let at = row * columns + column;
            if near > samples.nearness[at] {
                samples.nearness[at] = near;
                samples.triangle[at] = f;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::report::render::Camera;

    #[test]
    fn two_triangles_of_a_square_leave_no_hole_between_them() {
        let points = [(0.0, 0.0), (1.0, 0.1), (0.9, 1.0), (-0.1, 1.1)].map(|(x, y)| Vec3::new(x, y, 0.0));
        let triangles = [[0, 1, 2], [0, 2, 3]];
        let view = Camera { azimuth_deg: Some(0.0), elevation_deg: Some(0.0), ..Camera::default() }
            .aim(&points, [60, 60]);
        let samples = rasterise(&points, &triangles, &view, [60, 60]);
        for row in 0..120 {
            let line = &samples.triangle[120 * row..120 * (row + 1)];
            let first = line.iter().position(|&f| f != NOTHING);
            let last = line.iter().rposition(|&f| f != NOTHING);
            if let (Some(first), Some(last)) = (first, last) {
                assert!(line[first..=last].iter().all(|&f| f != NOTHING), "a hole in row {row}");
            }
        }
    }
}
