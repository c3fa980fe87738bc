//! Soft shadow of a garment on the ground.

use crate::report::render::camera::Projection;
use crate::report::render::raster::weights;
use crease_geometry::math::{Vec2, Vec3};

/// Shadow on the ground: the blurred vertical projection of the garment, on a grid.
pub(super) struct Shadow {
    /// Lower corner of the grid in x and z [m].
    low: Vec2,
    /// Width of a cell [m].
    cell: f64,
    columns: usize,
    rows: usize,
    /// Darkness per cell, row by row, 0 to 1.
    dark: Vec<f32>,
}

/// Number of cells along the longer side of the grid.
const MAX_CELLS: f64 = 400.0;
/// Radius of the blur of the wide, soft shadow as a fraction of the radius of the garment [-].
const BLUR_FRACTION: f64 = 0.04;
/// Radius of the blur of the narrow shadow where the garment touches the ground, as such a fraction [-].
const CONTACT_FRACTION: f64 = 0.008;
/// Weight of the narrow shadow [-].
const CONTACT_WEIGHT: f32 = 0.45;
/// Number of box blurs, which together are close to a Gaussian.
const BLUR_PASSES: usize = 3;
/// Fraction of light lost in full shadow [-].
const MAX_LOSS: f64 = 0.5;

impl Shadow {
    /// Computes the shadow of the triangles `drawn`.
    pub fn new(points: &[Vec3], drawn: &[[usize; 3]], projection: &Projection) -> Self {
        let flat = |i: usize| points[i].xz();
        let border = 6.0 * BLUR_FRACTION * projection.radius;
        let (mut low, mut high) = (Vec2::repeat(f64::INFINITY), Vec2::repeat(f64::NEG_INFINITY));
        for &i in drawn.iter().flatten() {
            (low, high) = (low.inf(&flat(i)), high.sup(&flat(i)));
        }
        if drawn.is_empty() {
            return Self { low: Vec2::zeros(), cell: 1.0, columns: 0, rows: 0, dark: Vec::new() };
        }
        low -= Vec2::repeat(border);
        high += Vec2::repeat(border);
        // Garments below rounding or beyond the range of numbers still need cells of some size.
        let cell = Some((high - low).max() / MAX_CELLS).filter(|c| c.is_normal()).unwrap_or(1.0);
        let [columns, rows] =
            [(high - low).x, (high - low).y].map(|s| (s / cell).ceil().min(MAX_CELLS) as usize + 1);
        let mut shadow = Self { low, cell, columns, rows, dark: vec![0.0; columns * rows] };
        for t in drawn {
            shadow.cover(t.map(|i| (flat(i) - low) / cell));
        }
        let blurred = |fraction: f64, weight: f32| {
            let radius = (fraction * projection.radius / cell).round().min(MAX_CELLS) as usize;
            let mut dark = shadow.dark.clone();
            for _ in 0..BLUR_PASSES {
                blur(&mut dark, &Lines { length: columns, count: rows, step: 1, stride: columns }, radius);
                blur(&mut dark, &Lines { length: rows, count: columns, step: columns, stride: 1 }, radius);
            }
            dark.iter_mut().for_each(|d| *d *= weight);
            dark
        };
        let (contact, soft) =
            (blurred(CONTACT_FRACTION, CONTACT_WEIGHT), blurred(BLUR_FRACTION, 1.0 - CONTACT_WEIGHT));
        shadow.dark = contact.into_iter().zip(soft).map(|(a, b)| a + b).collect();
        shadow
    }

    /// Marks the cells below a triangle, at least those of its corners.
    fn cover(&mut self, corners: [Vec2; 3]) {
        for c in corners {
            self.mark(c.x as usize, c.y as usize);
        }
        let planar = corners.map(|c| Vec3::new(c.x, c.y, 0.0));
        let range = |k: usize, count: usize| {
            let low = corners.iter().map(|c| c[k]).fold(f64::INFINITY, f64::min);
            let high = corners.iter().map(|c| c[k]).fold(0.0, f64::max);
            low as usize..(high as usize).saturating_add(1).min(count)
        };
        for y in range(1, self.rows) {
            for x in range(0, self.columns) {
                let centre = Vec2::new(x as f64 + 0.5, y as f64 + 0.5);
                if weights(&planar, centre).is_some_and(|w| w.iter().all(|&s| s >= 0.0)) {
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

    /// Returns the fraction of light on the ground seen at `pixel`; 1 where no ground is seen.
    pub fn light(&self, projection: &Projection, pixel: Vec2) -> f64 {
        let Some(seen) = projection.ground_at(pixel) else { return 1.0 };
        let position = (seen.point.xz() - self.low) / self.cell - Vec2::repeat(0.5);
        if position.x < 0.0 || position.y < 0.0 {
            return 1.0;
        }
        let (i, j) = (position.x as usize, position.y as usize);
        if i + 1 >= self.columns || j + 1 >= self.rows {
            return 1.0;
        }
        let (s, t) = (position.x - i as f64, position.y - j as f64);
        let at = |i: usize, j: usize| f64::from(self.dark[j * self.columns + i]);
        let dark = (1.0 - t) * ((1.0 - s) * at(i, j) + s * at(i + 1, j))
            + t * ((1.0 - s) * at(i, j + 1) + s * at(i + 1, j + 1));
        1.0 - MAX_LOSS * dark
    }
}

/// Parallel lines of cells in a grid.
struct Lines {
    /// Cells per line.
    length: usize,
    /// Number of lines.
    count: usize,
    /// Distance between neighbouring cells of a line, in the list of cells.
    step: usize,
    /// Distance between neighbouring lines, in the list of cells.
    stride: usize,
}

/// Box blur of `radius` cells along `lines`.
fn blur(cells: &mut [f32], lines: &Lines, radius: usize) {
    let &Lines { length, count, step, stride } = lines;
    let mut line = vec![0.0f32; length];
    for l in 0..count {
        let mut sum = 0.0;
        let read = |cells: &[f32], i: usize| cells[l * stride + i * step];
        for i in 0..radius.min(length) {
            sum += read(cells, i);
        }
        for (i, slot) in line.iter_mut().enumerate() {
            if i + radius < length {
                sum += read(cells, i + radius);
            }
            if i > radius {
                sum -= read(cells, i - radius - 1);
            }
            *slot = sum / (2 * radius + 1) as f32;
        }
        for (i, &value) in line.iter().enumerate() {
            cells[l * stride + i * step] = value;
        }
    }
}
