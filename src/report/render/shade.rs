//! Shading: colours of the samples from surface, lights, shadow and occlusion. Cloth is lit on both sides; its inner side
//! has a warmer colour. All values are in linear light until the last step.

use crate::report::render::camera::Projection;
use crate::report::render::colour::to_srgb;
use crate::report::render::image::Image;
use crate::report::render::lights::Lights;
use crate::report::render::occlusion::{occlusion, pixel_depths};
use crate::report::render::raster::{SAMPLES, Samples, sample_position};
use crate::report::render::shadow::Shadow;
use crate::report::render::surface::{DrawnSurface, ShadedSurface};
use crease_geometry::math::Vec3;
use crease_geometry::mesh::INVALID;
use rayon::prelude::*;

/// Background and ground, linear light.
const BACKGROUND: f64 = 0.86;

/// Returns the picture of `surface` from its `samples`.
pub(super) fn shade(surface: &DrawnSurface, projection: &Projection, samples: &Samples) -> Image {
    let shadow = Shadow::new(surface.points, surface.drawn, projection);
    let surface = ShadedSurface::new(surface);
    let lights = Lights::new(&surface.normals, projection);
    let depth = pixel_depths(projection, samples);
    let [width, height] = samples.size;
    let mut rgba = vec![0u8; 4 * width * height];
    rgba.par_chunks_mut(4 * width).enumerate().for_each(|(y, row)| {
        for (x, pixel) in row.chunks_exact_mut(4).enumerate() {
            let (mut sum, mut covered) = (Vec3::zeros(), 0);
            for (dx, dy) in [(0, 0), (1, 0), (0, 1), (1, 1)] {
                let (column, line) = (SAMPLES * x + dx, SAMPLES * y + dy);
                let f = samples.triangle[line * samples.row_len() + column];
                let position = sample_position(column, line);
                covered += usize::from(f != INVALID);
                sum += if f == INVALID {
                    Vec3::repeat(BACKGROUND * shadow.light(projection, position))
                } else {
                    surface.colour(f as usize, position, projection, &samples.projected, &lights)
                };
            }
            // On the ground the few directions of the occlusion would show as rings; it has its shadow.
            let covered = covered as f64 / (SAMPLES * SAMPLES) as f64;
            let open = 1.0 - covered * occlusion(&depth, samples.size, [x, y], projection);
            let colour = sum / (SAMPLES * SAMPLES) as f64 * open;
            pixel.copy_from_slice(&[to_srgb(colour.x), to_srgb(colour.y), to_srgb(colour.z), 255]);
        }
    });
    Image { width, height, rgba }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::report::render::camera::Camera;
    use crate::report::render::colour::BACKGROUND_SRGB;
    use crate::report::render::draw::render;
    use crate::report::render::field::Colouring;
    use crease_geometry::mesh::PointIndex;

    /// Ridges 1 mm high across a lying sheet are visible, owing to the grazing light.
    #[test]
    fn low_wrinkles_show() {
        let (n, side) = (80usize, 0.4);
        let draw = |height: f64| {
            let mut points = Vec::new();
            let mut triangles = Vec::new();
            for j in 0..n {
                for i in 0..n {
                    let (x, z) = (side * i as f64 / n as f64, side * j as f64 / n as f64);
                    points.push(Vec3::new(x, height * (x / 0.04 * std::f64::consts::TAU).sin(), z));
                    if i + 1 < n && j + 1 < n {
                        let at = |i: usize, j: usize| PointIndex((j * n + i) as u32);
                        triangles.push([at(i, j), at(i, j + 1), at(i + 1, j)]);
                        triangles.push([at(i + 1, j), at(i, j + 1), at(i + 1, j + 1)]);
                    }
                }
            }
            let image =
                render(&points, &triangles, &Colouring::Shape, &Camera::default(), [200, 200]).unwrap();
            let row: Vec<f64> = (60..140).map(|x| f64::from(image.pixel(x, 100)[1])).collect();
            let mean = row.iter().sum::<f64>() / row.len() as f64;
            (row.iter().map(|v| (v - mean).powi(2)).sum::<f64>() / row.len() as f64).sqrt()
        };
        let (flat, wrinkled) = (draw(0.0), draw(0.001));

        assert!(flat < 1.0, "a flat sheet is even: {flat}");
        assert!(wrinkled > 8.0, "contrast {wrinkled} of 255");
    }

    #[test]
    fn a_tilted_plane_is_not_occluded_and_the_ground_under_the_edge_is() {
        let points = [(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)].map(|(x, z)| Vec3::new(x, 0.05, z));
        let mut points = points.to_vec();
        points.extend(points.clone().iter().map(|p| Vec3::new(p.x, 0.0, p.z)));
        let triangles: Vec<[PointIndex; 3]> =
            [[0, 2, 1], [0, 3, 2], [4, 6, 5], [4, 7, 6]].map(|t: [u32; 3]| t.map(PointIndex)).to_vec();
        let image = render(&points, &triangles, &Colouring::Shape, &Camera::default(), [200, 150]).unwrap();
        let (a, b) = (image.pixel(100, 60), image.pixel(100, 75));
        assert!(a[1].abs_diff(b[1]) <= 1, "{a:?} {b:?}");
        let corner = image.pixel(0, 0);
        assert!(BACKGROUND_SRGB.iter().zip(corner).all(|(a, b)| a.abs_diff(b) < 6), "{corner:?}");
        let below = (100..150).map(|y| image.pixel(100, y)).rfind(|p| p[0] == p[2] && p[0] < 225);
        assert!(below.is_some(), "no shadow in front of the sheet");
    }
}
