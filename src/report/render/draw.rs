//! Drawing of a picture, from points and triangles to an image.

use crate::report::render::camera::Camera;
use crate::report::render::field::Colouring;
use crate::report::render::image::Image;
use crate::report::render::shade::shade;
use crate::report::render::surface::DrawnSurface;
use crate::report::render::{caption, raster};
use crease_geometry::math::Vec3;
use crease_geometry::mesh::PointIndex;
use crease_model::error::{Error, Result};

/// Maximum side of a picture [pixels]; its buffers take about 0.6 GB.
pub const MAX_SIDE: usize = 4096;

/// Draws `triangles` over `points` [m, y up]; `size` is [width, height] in pixels. Fails if a side is 0 or above
/// [`MAX_SIDE`].
///
/// Triangles with a missing or non-finite point are skipped.
///
/// ```
/// use crease::GarmentFile;
/// use crease::picture::{Camera, Colouring, encode_png, render};
/// let sheet = GarmentFile::sheet([0.2, 0.2], [4, 4])?.garment;
/// let picture = render(&sheet.points, &sheet.triangles, &Colouring::Shape, &Camera::default(), [64, 48])?;
/// assert!(encode_png(&picture)?.starts_with(b"\x89PNG"));
/// # Ok::<(), crease::Error>(())
/// ```
pub fn render(
    points: &[Vec3],
    triangles: &[[PointIndex; 3]],
    colouring: &Colouring,
    camera: &Camera,
    size: [usize; 2],
) -> Result<Image> {
    render_shaded(points, triangles, None, colouring, camera, size)
}

/// Draws what [`render`] draws with the unit `normals` per triangle and corner; without them with smooth ones.
pub fn render_shaded(
    points: &[Vec3],
    triangles: &[[PointIndex; 3]],
    normals: Option<&[[Vec3; 3]]>,
    colouring: &Colouring,
    camera: &Camera,
    size: [usize; 2],
) -> Result<Image> {
    if size.iter().any(|&side| side == 0 || side > MAX_SIDE) {
        return Err(Error::input(
            "picture",
            "size",
            format!("{} x {} pixels cannot be drawn", size[0], size[1]),
            format!("give each side between 1 and {MAX_SIDE} pixels"),
        ));
    }
    let drawable: Vec<[usize; 3]> = triangles
        .iter()
        .map(|t| t.map(PointIndex::at))
        .filter(|t| t.iter().all(|&i| points.get(i).is_some_and(|p| p.iter().all(|c| c.is_finite()))))
        .collect();
    let legend_height = match colouring {
        Colouring::Shape => 0,
        Colouring::Field(_) => caption::legend_height(size),
    };
    let used = raster::used_points(points, &drawable);
    let projection = camera.aim(&used, [size[0], size[1].saturating_sub(legend_height).max(1)]);
    let samples = raster::rasterise(points, &drawable, &projection, size);
    // Normals are those of all triangles.
    let normals = normals.filter(|normals| normals.len() == drawable.len());
    let surface = DrawnSurface { points, triangles, drawn: &drawable, normals, colouring };
    let mut image = shade(&surface, &projection, &samples);
    if let Colouring::Field(field) = colouring {
        caption::draw_legend(&mut image, field, legend_height);
    }
    Ok(image)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::report::render::colour::{self, ColourMap};
    use crate::report::render::field::{Field, Values};
    use crate::report::render::test_shapes::sphere;

    /// A square facing +z at depth `z`, from `low` to `high` in x and y.
    fn square(low: f64, high: f64, z: f64, first: u32) -> (Vec<Vec3>, Vec<[PointIndex; 3]>) {
        let points = [(low, low), (high, low), (high, high), (low, high)].map(|(x, y)| Vec3::new(x, y, z));
        (
            points.to_vec(),
            vec![[0, 1, 2].map(|i| PointIndex(first + i)), [0, 2, 3].map(|i| PointIndex(first + i))],
        )
    }

    fn front() -> Camera {
        Camera { azimuth_deg: Some(0.0), elevation_deg: Some(0.0), ..Camera::default() }
    }

    fn differs_from_background(p: [u8; 4]) -> bool {
        let background = colour::BACKGROUND_SRGB;
        (0..3).any(|k| p[k].abs_diff(background[k]) > 24)
    }

    #[test]
    fn a_sphere_covers_a_disc() {
        let (points, triangles) = sphere(0.5, 40);
        // Without perspective the horizon hides the ground, and with it the shadow.
        let camera = Camera { distance: f64::INFINITY, ..front() };
        let image = render(&points, &triangles, &Colouring::Shape, &camera, [300, 300]).unwrap();
        let inside: Vec<(usize, usize)> = (0..300)
            .flat_map(|y| (0..300).map(move |x| (x, y)))
            .filter(|&(x, y)| differs_from_background(image.pixel(x, y)))
            .collect();
        let width = inside.iter().map(|p| p.0).max().unwrap() - inside.iter().map(|p| p.0).min().unwrap() + 1;
        let disc = std::f64::consts::PI / 4.0 * (width * width) as f64;
        assert!(width > 200, "the sphere fills the picture: {width}");
        assert!((inside.len() as f64 / disc - 1.0).abs() < 0.02, "{} pixels, disc {disc}", inside.len());
    }

    #[test]
    fn the_nearer_square_hides_the_farther_whatever_the_order() {
        for near_first in [true, false] {
            let (z0, z1) = if near_first { (0.1, -0.1) } else { (-0.1, 0.1) };
            let (mut points, mut triangles) = square(-0.5, 0.5, z0, 0);
            let (more, faces) = square(-0.5, 0.5, z1, 4);
            points.extend(more);
            triangles.extend(faces);
            let near = if near_first { [1.0, 1.0, -1.0, -1.0] } else { [-1.0, -1.0, 1.0, 1.0] };
            let mut field = Field::rest_angle_change(near.map(|v| 10.0 * v).to_vec());
            field.values = Values::PerTriangle(near.map(|v| 10.0 * v).to_vec());
            let image = render(&points, &triangles, &Colouring::Field(field), &front(), [200, 260]).unwrap();
            let [r, _, b, _] = image.pixel(100, 100);
            assert!(r > b.saturating_add(60), "near is +10, orange, not blue: {:?}", image.pixel(100, 100));
        }
    }

    #[test]
    fn a_known_value_has_its_legend_colour_up_to_light() {
        let (points, triangles) = square(-0.5, 0.5, 0.0, 0);
        for value in [0.0, 0.5, 1.0] {
            let mut field = Field::curvature(vec![value; 4]);
            field.range = Some([0.0, 1.0]);
            let image = render(&points, &triangles, &Colouring::Field(field), &front(), [200, 260]).unwrap();
            let seen = image.pixel(100, 100);
            let pure = ColourMap::Sequential.srgb(value);
            // Light scales the colour; the proportion of its channels in linear light stays.
            let linear = |c: u8| colour::to_linear(f64::from(c) / 255.0);
            let proportions = |c: [f64; 3]| c.map(|x| x / c.iter().sum::<f64>());
            let a = proportions([linear(seen[0]), linear(seen[1]), linear(seen[2])]);
            let b = proportions(pure.map(linear));
            for k in 0..3 {
                assert!((a[k] - b[k]).abs() < 0.03, "value {value}: {seen:?} against {pure:?}");
            }
        }
    }

    #[test]
    fn the_legend_shows_both_ends_of_the_map() {
        let (points, triangles) = square(-0.5, 0.5, 0.0, 0);
        let field = Field::displacement_mm(vec![0.0, 1.0, 2.0, 3.0]);
        let image = render(&points, &triangles, &Colouring::Field(field), &front(), [400, 300]).unwrap();
        for end in [0.0, 1.0] {
            let wanted = ColourMap::Sequential.srgb(end);
            let height = caption::legend_height([400, 300]);
            let found = (300 - height..300)
                .any(|y| (0..400).any(|x| (0..3).all(|k| image.pixel(x, y)[k].abs_diff(wanted[k]) <= 3)));
            assert!(found, "no legend colour for {end}");
        }
        let dark = |y: usize| (0..400).any(|x| image.pixel(x, y)[..3].iter().all(|&c| c < 90));
        assert!((300 - caption::legend_height([400, 300])..300).any(dark), "no writing in the legend");
    }

    #[test]
    fn bad_sizes_are_faults_and_bad_meshes_are_skipped() {
        let (mut points, mut triangles) = square(-0.5, 0.5, 0.0, 0);
        for size in [[0, 10], [10, 0], [MAX_SIDE + 1, 10]] {
            assert!(render(&points, &triangles, &Colouring::Shape, &front(), size).is_err());
        }
        triangles.push([PointIndex(0), PointIndex(1), PointIndex(99)]);
        points[3].x = f64::NAN;
        for size in [[1, 1], [3, 2], [64, 64]] {
            let colouring = Colouring::Field(Field::curvature(vec![f64::NAN]));
            let image = render(&points, &triangles, &colouring, &Camera::default(), size).unwrap();
            assert_eq!(image.rgba.len(), 4 * size[0] * size[1]);
        }
        assert!(render(&[], &[], &Colouring::Shape, &Camera::default(), [20, 20]).is_ok());
    }

    /// A speck far from the origin, a line, a garment in the wrong unit by far: a picture of nothing, but no crash.
    #[test]
    fn degenerate_shapes_are_drawn_without_harm() {
        let triangle = [[0, 1, 2].map(PointIndex)];
        for (offset, size) in
            [(0.0, 0.0), (1e9, 1e-12), (0.0, 1e-300), (0.0, 1e200), (1e308, 1e308), (-1e30, 1e3)]
        {
            let points = [(0.0, 0.0), (1.0, 0.3), (0.2, 1.0)]
                .map(|(x, z)| Vec3::new(offset + size * x, 0.5 * size * x, size * z - offset));
            let line = points.map(|p| Vec3::new(p.x, 0.0, 0.0));
            for points in [points, line] {
                let image =
                    render(&points, &triangle, &Colouring::Shape, &Camera::default(), [40, 30]).unwrap();
                assert_eq!(image.rgba.len(), 4 * 40 * 30, "{offset} {size}");
            }
        }
    }

    #[test]
    fn the_same_picture_comes_out_twice() {
        let (points, triangles) = sphere(0.5, 12);
        let draw = || render(&points, &triangles, &Colouring::Shape, &Camera::default(), [80, 80]).unwrap();
        assert!(draw().rgba == draw().rgba);
    }
}
