//! Light on the samples: a key light, a grazing light that makes wrinkles stand out, a sky, occlusion, and a soft
//! shadow on the ground. Cloth is lit on both sides; its inner side has a warmer colour.
//!
//! Occlusion compares each pixel's depth with pairs of opposite neighbours: a plane, however tilted, gives none; a valley or
//! the foot of an overlapping layer does. It is a cue, not physics. Everything is in linear light until the last step.

use crate::math::{Vec2, Vec3};
use crate::mesh::PointIndex;
use crate::report::render::camera::View;
use crate::report::render::colour::to_srgb;
use crate::report::render::raster::{NOTHING, SAMPLES, Samples, sample_position, weights};
use crate::report::render::{Colouring, Image, Values};
use rayon::prelude::*;

/// Background and ground, linear light.
const BACKGROUND: f64 = 0.86;
/// The same on screen.
pub(super) const BACKGROUND_SRGB: [u8; 3] = [238, 238, 238];
/// Outer and inner side of cloth in a picture of the shape.
const OUTSIDE: [f64; 3] = [0.40, 0.46, 0.54];
const INSIDE: [f64; 3] = [0.50, 0.40, 0.32];
/// Elevation of the grazing light over the surface that faces the viewer [degrees].
const GRAZING_DEG: f64 = 16.0;
/// Corners share a normal across an edge that bends by less than this [degrees]; sharper creases stay sharp.
const SMOOTH_DEG: f64 = 50.0;
/// How much a field's colour gives way to light: enough to see the shape, not so much that values mislead.
const FIELD_LIGHT: f64 = 0.55;

/// The picture of what `samples` hold. `drawn` are the triangles drawn; `triangles` all of them, in whose order
/// per-triangle values come.
pub(super) fn shade(
    points: &[Vec3],
    triangles: &[[PointIndex; 3]],
    drawn: &[[usize; 3]],
    colouring: &Colouring,
    view: &View,
    samples: &Samples,
) -> Image {
    let surface = Surface::new(points, triangles, drawn, colouring);
    let lights = Lights::new(&surface, view);
    let shadow = Shadow::new(points, drawn, view);
    let depth = depth_of_pixels(view, samples);
    let [width, height] = samples.size;
    let mut rgba = vec![0u8; 4 * width * height];
    rgba.par_chunks_mut(4 * width).enumerate().for_each(|(y, row)| {
        for (x, pixel) in row.chunks_exact_mut(4).enumerate() {
            let mut sum = Vec3::zeros();
            for (dx, dy) in [(0, 0), (1, 0), (0, 1), (1, 1)] {
                let (column, line) = (SAMPLES * x + dx, SAMPLES * y + dy);
                let f = samples.triangle[line * samples.row_len() + column];
                let place = sample_position(column, line);
                sum += if f == NOTHING {
                    Vec3::repeat(BACKGROUND * shadow.light(view, place))
                } else {
                    surface.colour(f as usize, place, view, samples, &lights)
                };
            }
            let open = 1.0 - occlusion(&depth, samples.size, [x, y], view);
            let colour = sum / (SAMPLES * SAMPLES) as f64 * open;
            pixel.copy_from_slice(&[to_srgb(colour.x), to_srgb(colour.y), to_srgb(colour.z), 255]);
        }
    });
    Image { width, height, rgba }
}

/// What the surface is like at a place of a triangle.
struct Surface<'a> {
    drawn: &'a [[usize; 3]],
    /// Unit normal per drawn triangle.
    flat: Vec<Vec3>,
    /// Normals per drawn triangle and corner.
    smooth: Vec<[Vec3; 3]>,
    /// Values per drawn triangle and corner, as shares of the range; empty for the shape alone.
    shares: Vec<[f64; 3]>,
    colouring: &'a Colouring,
}

impl<'a> Surface<'a> {
    fn new(
        points: &[Vec3],
        triangles: &[[PointIndex; 3]],
        drawn: &'a [[usize; 3]],
        colouring: &'a Colouring,
    ) -> Self {
        let areas: Vec<Vec3> = drawn
            .iter()
            .map(|t| {
                let [a, b, c] = t.map(|i| points[i]);
                (b - a).cross(&(c - a))
            })
            .collect();
        let flat: Vec<Vec3> = areas.iter().map(|n| n.try_normalize(0.0).unwrap_or_else(Vec3::y)).collect();
        let smooth = corner_normals(points.len(), drawn, &areas, &flat);
        let shares = shares(triangles, drawn, points.len(), colouring);
        Self { drawn, flat, smooth, shares, colouring }
    }

    fn colour(&self, f: usize, place: Vec2, view: &View, samples: &Samples, lights: &Lights) -> Vec3 {
        let corners = self.drawn[f].map(|i| samples.projected[i]);
        let flat = weights(&corners, place).unwrap_or([1.0, 0.0, 0.0]);
        let mut w: [f64; 3] = std::array::from_fn(|k| flat[k] * view.perspective_weight(corners[k].z));
        let sum: f64 = w.iter().sum();
        w.iter_mut().for_each(|x| *x /= sum);
        let [a, b, c] = self.smooth[f];
        let outer = self.flat[f].dot(&view.toward) >= 0.0;
        let side = if outer { 1.0 } else { -1.0 };
        let normal = side * (w[0] * a + w[1] * b + w[2] * c).try_normalize(0.0).unwrap_or(self.flat[f]);
        let light = lights.on(normal);
        match self.colouring {
            Colouring::Shape => Vec3::from(if outer { OUTSIDE } else { INSIDE }) * light,
            Colouring::Field(field) => {
                let share: f64 = (0..3).map(|k| w[k] * self.shares[f][k]).sum();
                Vec3::from(field.map.linear(share)) * (1.0 - FIELD_LIGHT + FIELD_LIGHT * light)
            }
        }
    }
}

/// Normals per corner: the mean over the point's triangles that bend away by less than [`SMOOTH_DEG`].
fn corner_normals(point_count: usize, drawn: &[[usize; 3]], areas: &[Vec3], flat: &[Vec3]) -> Vec<[Vec3; 3]> {
    let mut first = vec![0usize; point_count + 1];
    for &i in drawn.iter().flatten() {
        first[i + 1] += 1;
    }
    for i in 0..point_count {
        first[i + 1] += first[i];
    }
    let mut of_point = vec![0u32; first[point_count]];
    let mut next = first.clone();
    for (f, t) in drawn.iter().enumerate() {
        for &i in t {
            of_point[next[i]] = f as u32;
            next[i] += 1;
        }
    }
    let limit = SMOOTH_DEG.to_radians().cos();
    drawn
        .iter()
        .enumerate()
        .map(|(f, t)| {
            t.map(|i| {
                let around = of_point[first[i]..first[i + 1]].iter().map(|&g| g as usize);
                let sum: Vec3 = around.filter(|&g| flat[g].dot(&flat[f]) > limit).map(|g| areas[g]).sum();
                sum.try_normalize(0.0).unwrap_or(flat[f])
            })
        })
        .collect()
}

/// Values of the corners of drawn triangles as shares of the legend's range; NaN where there is none.
fn shares(
    triangles: &[[PointIndex; 3]],
    drawn: &[[usize; 3]],
    point_count: usize,
    colouring: &Colouring,
) -> Vec<[f64; 3]> {
    let Colouring::Field(field) = colouring else { return Vec::new() };
    let [low, high] = field.limits();
    let share = |value: Option<&f64>| value.map_or(f64::NAN, |v| ((v - low) / (high - low)).clamp(0.0, 1.0));
    match &field.values {
        Values::PerPoint(values) => drawn.iter().map(|t| t.map(|i| share(values.get(i)))).collect(),
        Values::PerTriangle(values) if drawn.len() == triangles.len() => {
            (0..drawn.len()).map(|f| [share(values.get(f)); 3]).collect()
        }
        // Some triangles were left out, in order: walk both lists.
        Values::PerTriangle(values) => {
            let mut all = triangles.iter().zip(values.iter().map(Some).chain(std::iter::repeat(None)));
            drawn
                .iter()
                .map(|t| {
                    let same = |s: &[PointIndex; 3]| {
                        s.map(PointIndex::at) == *t && t.iter().all(|&i| i < point_count)
                    };
                    [share(all.find(|(s, _)| same(s)).and_then(|(_, v)| v)); 3]
                })
                .collect()
        }
    }
}

/// Directions towards the lights.
struct Lights {
    key: Vec3,
    grazing: Vec3,
}

impl Lights {
    /// The key light stands over the viewer's head; the grazing light comes from the left, low over the surface
    /// that mainly faces the viewer, so that it suits lying and standing garments alike. Were they on opposite
    /// sides, one would fill the shades of the other and small wrinkles would vanish.
    fn new(surface: &Surface, view: &View) -> Self {
        let facing: Vec3 = surface.flat.iter().map(|n| n * n.dot(&view.toward).signum()).sum();
        let facing = facing.try_normalize(0.0).unwrap_or(view.toward);
        let side = 0.4 * view.up - view.right;
        let along = (side - facing * facing.dot(&side)).try_normalize(1e-9).unwrap_or(-view.right);
        let (sin, cos) = GRAZING_DEG.to_radians().sin_cos();
        Self {
            key: (view.toward - 0.2 * view.right + 0.8 * view.up).normalize(),
            grazing: cos * along + sin * facing,
        }
    }

    /// Light on a surface with this normal: about 1 where both lights meet it.
    fn on(&self, normal: Vec3) -> f64 {
        let sky = 0.5 + 0.5 * normal.y;
        // Wrapped a little beyond the terminator: soft, as from a large lamp.
        let wrap = |d: f64| ((d + 0.15) / 1.15).max(0.0);
        0.12 + 0.15 * sky + 0.38 * wrap(normal.dot(&self.key)) + 1.15 * normal.dot(&self.grazing).max(0.0)
    }
}

/// How dark the ground is under the garment: its outline cast straight down, blurred.
struct Shadow {
    low: Vec2,
    cell: f64,
    columns: usize,
    rows: usize,
    dark: Vec<f32>,
}

/// Cells along the longer side of the shadow.
const SHADOW_CELLS: f64 = 240.0;
/// Reach of the blur, as a share of the garment's radius.
const SHADOW_BLUR: f64 = 0.035;
/// Light lost in full shadow.
const SHADOW_STRENGTH: f64 = 0.42;

impl Shadow {
    fn new(points: &[Vec3], drawn: &[[usize; 3]], view: &View) -> Self {
        let flat = |i: usize| points[i].xz();
        let border = 6.0 * SHADOW_BLUR * view.radius;
        let (mut low, mut high) = (Vec2::repeat(f64::INFINITY), Vec2::repeat(f64::NEG_INFINITY));
        for &i in drawn.iter().flatten() {
            (low, high) = (low.inf(&flat(i)), high.sup(&flat(i)));
        }
        if drawn.is_empty() {
            return Self { low: Vec2::zeros(), cell: 1.0, columns: 0, rows: 0, dark: Vec::new() };
        }
        low -= Vec2::repeat(border);
        high += Vec2::repeat(border);
        // A garment smaller than rounding, or too large for numbers, still needs cells of some size.
        let cell = Some((high - low).max() / SHADOW_CELLS).filter(|c| c.is_normal()).unwrap_or(1.0);
        let [columns, rows] =
            [(high - low).x, (high - low).y].map(|s| (s / cell).ceil().min(SHADOW_CELLS) as usize + 1);
        let mut shadow = Self { low, cell, columns, rows, dark: vec![0.0; columns * rows] };
        for t in drawn {
            shadow.cover(t.map(|i| (flat(i) - low) / cell));
        }
        let reach = (SHADOW_BLUR * view.radius / cell).round().min(SHADOW_CELLS) as usize;
        for _ in 0..2 {
            blur(&mut shadow.dark, columns, rows, 1, columns, reach);
            blur(&mut shadow.dark, rows, columns, columns, 1, reach);
        }
        shadow
    }

    /// Marks the cells a triangle lies over; at least those of its corners.
    fn cover(&mut self, corners: [Vec2; 3]) {
        for c in corners {
            self.mark(c.x as usize, c.y as usize);
        }
        let raised = corners.map(|c| Vec3::new(c.x, c.y, 0.0));
        let range = |k: usize, count: usize| {
            let low = corners.iter().map(|c| c[k]).fold(f64::INFINITY, f64::min);
            let high = corners.iter().map(|c| c[k]).fold(0.0, f64::max);
            low as usize..(high as usize).saturating_add(1).min(count)
        };
        for y in range(1, self.rows) {
            for x in range(0, self.columns) {
                let centre = Vec2::new(x as f64 + 0.5, y as f64 + 0.5);
                if weights(&raised, centre).is_some_and(|w| w.iter().all(|&s| s >= 0.0)) {
                    self.mark(x, y);
                }
            }
        }
    }

    fn mark(&mut self, x: usize, y: usize) {
        if x < self.columns
            && let Some(slot) = self.dark.get_mut(y * self.columns + x)
        {
            *slot = 1.0;
        }
    }

    /// Share of light that reaches the ground seen at a pixel position; 1 where no ground is seen.
    fn light(&self, view: &View, pixel: Vec2) -> f64 {
        let Some((p, _)) = view.ground_at(pixel) else { return 1.0 };
        let place = (p.xz() - self.low) / self.cell - Vec2::repeat(0.5);
        if place.x < 0.0 || place.y < 0.0 {
            return 1.0;
        }
        let (i, j) = (place.x as usize, place.y as usize);
        if i + 1 >= self.columns || j + 1 >= self.rows {
            return 1.0;
        }
        let (s, t) = (place.x - i as f64, place.y - j as f64);
        let at = |i: usize, j: usize| f64::from(self.dark[j * self.columns + i]);
        let dark = (1.0 - t) * ((1.0 - s) * at(i, j) + s * at(i + 1, j))
            + t * ((1.0 - s) * at(i, j + 1) + s * at(i + 1, j + 1));
        1.0 - SHADOW_STRENGTH * dark
    }
}

/// Box blur along lines of `len` cells `step` apart, over `lines` lines `stride` apart.
fn blur(cells: &mut [f32], len: usize, lines: usize, step: usize, stride: usize, reach: usize) {
    let mut line = vec![0.0f32; len];
    for l in 0..lines {
        let mut sum = 0.0;
        let read = |cells: &[f32], i: usize| cells[l * stride + i * step];
        for i in 0..reach.min(len) {
            sum += read(cells, i);
        }
        for (i, slot) in line.iter_mut().enumerate() {
            if i + reach < len {
                sum += read(cells, i + reach);
            }
            if i > reach {
                sum -= read(cells, i - reach - 1);
            }
            *slot = sum / (2 * reach + 1) as f32;
        }
        for (i, &value) in line.iter().enumerate() {
            cells[l * stride + i * step] = value;
        }
    }
}

/// Depth [m] of the nearest sample of each pixel; of the ground where only that is seen; NaN in the distance.
fn depth_of_pixels(view: &View, samples: &Samples) -> Vec<f32> {
    let [width, height] = samples.size;
    let mut depth = vec![f32::NAN; width * height];
    depth.par_chunks_mut(width).enumerate().for_each(|(y, row)| {
        for (x, slot) in row.iter_mut().enumerate() {
            let near = [(0, 0), (1, 0), (0, 1), (1, 1)]
                .map(|(dx, dy)| samples.nearness[(SAMPLES * y + dy) * samples.row_len() + SAMPLES * x + dx])
                .into_iter()
                .fold(0.0, f32::max);
            *slot = if near > 0.0 {
                view.depth(f64::from(near)) as f32
            } else {
                let middle = Vec2::new(x as f64 + 0.5, y as f64 + 0.5);
                view.ground_at(middle).map_or(f32::NAN, |(_, d)| d as f32)
            };
        }
    });
    depth
}

/// Reaches of the occlusion, as shares of the garment's radius: small wrinkles, and whole folds.
const REACHES: [f64; 2] = [0.008, 0.035];
/// Half a circle of directions; each stands for itself and its opposite.
const DIRECTIONS: [[f64; 2]; 6] =
    [[1.0, 0.0], [0.866, 0.5], [0.5, 0.866], [0.0, 1.0], [-0.5, 0.866], [-0.866, 0.5]];

/// Share of light lost at a pixel because its surroundings are nearer to the viewer.
fn occlusion(depth: &[f32], [width, height]: [usize; 2], [x, y]: [usize; 2], view: &View) -> f64 {
    let here = depth[y * width + x];
    if here.is_nan() {
        return 0.0;
    }
    let mut lost = 0.0;
    for reach in REACHES {
        let metres = (reach * view.radius) as f32;
        let pixels = (reach * view.radius * view.scale).max(1.0);
        let at = |dx: f64, dy: f64| {
            let (i, j) = (x as f64 + dx, y as f64 + dy);
            let inside = i >= 0.0 && j >= 0.0 && i < width as f64 && j < height as f64;
            let there = inside.then(|| depth[j as usize * width + i as usize])?;
            if there.is_nan() {
                return Some(-metres);
            }
            // What is nearer by more than a reach does not touch this place: it fades, or it would draw a halo.
            let rise = (there - here).max(-metres);
            Some(if rise > metres { metres * (metres / rise).powi(3) } else { rise })
        };
        let mut sum = 0.0;
        for (k, [dx, dy]) in DIRECTIONS.into_iter().enumerate() {
            let r = pixels * if k % 2 == 0 { 1.0 } else { 0.55 };
            // Half a pair says nothing about bending: at the rim of the picture it is left out.
            if let (Some(a), Some(b)) = (at(dx * r, dy * r), at(-dx * r, -dy * r)) {
                sum += (a + b).max(0.0) / (2.0 * metres);
            }
        }
        lost += 0.55 * f64::from(sum) / DIRECTIONS.len() as f64;
    }
    lost.min(0.7)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::report::render::{Camera, render};

    /// A row of ridges 1 mm high across a lying sheet must show: the grazing light is there for them.
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
