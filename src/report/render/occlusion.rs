//! Ambient occlusion in screen space.
//!
//! The depth of each pixel is compared with pairs of opposite neighbours. A plane, however tilted, is not occluded; a
//! valley or the edge of an overlapping layer is. This is a depth cue, not a physical model.

use crate::report::render::camera::Projection;
use crate::report::render::raster::{SAMPLES, Samples};
use crease_geometry::math::Vec2;
use rayon::prelude::*;

/// Returns the depth of each pixel [m]: of its nearest sample, otherwise of the ground; NaN above the horizon.
pub(super) fn pixel_depths(projection: &Projection, samples: &Samples) -> Vec<f32> {
    let [width, height] = samples.size;
    let mut depth = vec![f32::NAN; width * height];
    depth.par_chunks_mut(width).enumerate().for_each(|(y, row)| {
        for (x, slot) in row.iter_mut().enumerate() {
            let nearness = [(0, 0), (1, 0), (0, 1), (1, 1)]
                .map(|(dx, dy)| samples.nearness[(SAMPLES * y + dy) * samples.row_len() + SAMPLES * x + dx])
                .into_iter()
                .fold(0.0, f32::max);
            *slot = if nearness > 0.0 {
                projection.depth(f64::from(nearness)) as f32
            } else {
                let middle = Vec2::new(x as f64 + 0.5, y as f64 + 0.5);
                projection.ground_at(middle).map_or(f32::NAN, |seen| seen.depth as f32)
            };
        }
    });
    depth
}

/// Radii of the occlusion as fractions of the radius of the garment: for small wrinkles and for whole folds [-].
const RADIUS_FRACTIONS: [f64; 2] = [0.008, 0.035];
/// Directions over half a circle; each represents its opposite, too.
const DIRECTIONS: [[f64; 2]; 6] =
    [[1.0, 0.0], [0.866, 0.5], [0.5, 0.866], [0.0, 1.0], [-0.5, 0.866], [-0.866, 0.5]];

/// Returns the fraction of light lost at a pixel whose surroundings are nearer to the camera.
pub(super) fn occlusion(
    depth: &[f32],
    [width, height]: [usize; 2],
    [x, y]: [usize; 2],
    projection: &Projection,
) -> f64 {
    let here = depth[y * width + x];
    if here.is_nan() {
        return 0.0;
    }
    let mut lost = 0.0;
    for fraction in RADIUS_FRACTIONS {
        let metres = (fraction * projection.radius) as f32;
        let pixels = (fraction * projection.radius * projection.scale).max(1.0);
        let at = |dx: f64, dy: f64| {
            let (i, j) = (x as f64 + dx, y as f64 + dy);
            let inside = i >= 0.0 && j >= 0.0 && i < width as f64 && j < height as f64;
            let there = inside.then(|| depth[j as usize * width + i as usize])?;
            if there.is_nan() {
                return Some(-metres);
            }
            // Surfaces nearer by more than the radius do not touch this point; without the fading they would cause a halo.
            let rise = (there - here).max(-metres);
            Some(if rise > metres { metres * (metres / rise).powi(3) } else { rise })
        };
        let mut sum = 0.0;
        for (k, [dx, dy]) in DIRECTIONS.into_iter().enumerate() {
            let r = pixels * if k % 2 == 0 { 1.0 } else { 0.55 };
            // One sample of a pair does not determine curvature; such pairs at the border of the picture are skipped.
            if let (Some(a), Some(b)) = (at(dx * r, dy * r), at(-dx * r, -dy * r)) {
                sum += (a + b).max(0.0) / (2.0 * metres);
            }
        }
        lost += 0.55 * f64::from(sum) / DIRECTIONS.len() as f64;
    }
    lost.min(0.7)
}
