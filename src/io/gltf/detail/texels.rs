//! Picture of directions: filled triangle by triangle in texture space, padded beyond the filled texels, and written as
//! PNG; existing pictures are read.

use crate::tuning::TUNING;
use crease_geometry::math::{Vec2, Vec3};

/// Bits per channel of a normal map.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum MapDepth {
    /// 8 bits, which every program reads.
    #[default]
    Eight,
    /// 16 bits.
    Sixteen,
}

/// What a map shows.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum DetailOf {
    /// What the worn vertices of the file do not show; it goes into the material.
    #[default]
    Rest,
    /// All of the wear, on the mesh before the wear; it is a file.
    All,
}

/// Options of detail maps.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct MapOptions {
    /// Texels per side.
    pub side: usize,
    /// Bits per channel of the normal map.
    pub depth: MapDepth,
    /// What the map shows.
    pub of: DetailOf,
    /// Whether the mask of creases is painted as well.
    pub creases: bool,
}

impl MapOptions {
    /// Maps of what the worn vertices do not show, of `side` x `side` texels.
    pub fn new(side: usize, depth: MapDepth) -> Self {
        Self { side, depth, of: DetailOf::Rest, creases: false }
    }
}

/// Direction and height of one texel.
#[derive(Debug, Clone, Copy)]
pub(super) struct TexelSample {
    /// Unit direction in tangent space.
    pub(super) direction: Vec3,
    /// Height of the fine surface above the coarse one \[m\].
    pub(super) height_m: f64,
    /// Angle of the crease there as a fraction of half a turn \[-\], 0 beside creases.
    pub(super) crease: f64,
}

/// Unit directions in tangent space, rows from the top.
#[derive(Debug, Clone)]
pub(super) struct Texels {
    pub(super) width: usize,
    pub(super) height: usize,
    /// Direction of each texel; zero for empty ones.
    pub(super) direction: Vec<Vec3>,
    /// Height of each texel \[m\]: distance of the fine surface above the coarse one.
    pub(super) height_m: Vec<f32>,
    /// Angle of the crease at each texel as a fraction of half a turn \[-\].
    pub(super) crease: Vec<f32>,
    /// Number of texels that two parts of the garment fill with different directions.
    pub(super) conflicts: usize,
}

impl Texels {
    pub(super) fn new(size: usize) -> Self {
        let count = size * size;
        Self {
            width: size,
            height: size,
            direction: vec![Vec3::zeros(); count],
            height_m: vec![0.0; count],
            crease: vec![0.0; count],
            conflicts: 0,
        }
    }

    /// Returns the number of filled texels.
    pub(super) fn filled_count(&self) -> usize {
        self.direction.iter().filter(|d| **d != Vec3::zeros()).count()
    }

    /// Fills every texel whose centre lies in the triangle of `corners` (texture coordinates) with the unit direction and the
    /// height [m] that `sample` returns for its barycentric coordinates. Coordinates beyond 0 to 1 repeat.
    pub(super) fn fill(&mut self, corners: [Vec2; 3], sample: &dyn Fn([f64; 3]) -> Option<TexelSample>) {
        let size = Vec2::new(self.width as f64, self.height as f64);
        let [a, b, c] = corners.map(|uv| uv.component_mul(&size));
        let doubled = (b - a).perp(&(c - a));
        let (low, high) = (a.inf(&b).inf(&c), a.sup(&b).sup(&c));
        // A triangle as wide as several pictures is damage.
        let is_valid =
            doubled != 0.0 && (high - low).iter().zip(&size).all(|(side, size)| *side <= 2.0 * size);
        if !is_valid || !low.iter().chain(high.iter()).all(|x| x.abs() < 1e9) {
            return;
        }
        for row in (low.y - 0.5).ceil() as i64..=(high.y - 0.5).floor() as i64 {
            for column in (low.x - 0.5).ceil() as i64..=(high.x - 0.5).floor() as i64 {
                let p = Vec2::new(column as f64 + 0.5, row as f64 + 0.5);
                let weights = [
                    (b - p).perp(&(c - p)) / doubled,
                    (c - p).perp(&(a - p)) / doubled,
                    (a - p).perp(&(b - p)) / doubled,
                ];
                if weights.iter().any(|s| *s < -1e-9) {
                    continue;
                }
                let (x, y) = (column.rem_euclid(self.width as i64), row.rem_euclid(self.height as i64));
                if let Some(found) = sample(weights) {
                    self.set(y as usize * self.width + x as usize, found);
                }
            }
        }
    }

    fn set(&mut self, at: usize, TexelSample { direction, height_m, crease }: TexelSample) {
        let present = self.direction[at];
        if present == Vec3::zeros() {
            self.direction[at] = direction;
            self.height_m[at] = height_m as f32;
            self.crease[at] = crease as f32;
        } else if present.dot(&direction) < TUNING.max_texel_deviation.cos() {
            self.conflicts += 1;
        }
    }

    /// Extends the filled texels beyond their borders by `texels`, so that filters do not mix in empty ones; all other texels
    /// become flat.
    pub(super) fn pad(&mut self, texels: usize) {
        let mut front: Vec<usize> =
            (0..self.direction.len()).filter(|&at| self.direction[at] != Vec3::zeros()).collect();
        for _ in 0..texels {
            // A texel takes the mean of its filled neighbours, all of one ring at the same time.
            let mut ring: Vec<usize> = front.iter().flat_map(|&at| self.neighbours(at)).collect();
            ring.sort_unstable();
            ring.dedup();
            ring.retain(|&at| self.direction[at] == Vec3::zeros());
            let means: Vec<(Vec3, [f32; 2])> = ring.iter().map(|&at| self.neighbour_mean(at)).collect();
            for (&at, (direction, [height, crease])) in ring.iter().zip(means) {
                self.direction[at] = direction;
                (self.height_m[at], self.crease[at]) = (height, crease);
            }
            front = ring;
        }
        self.direction.iter_mut().filter(|d| **d == Vec3::zeros()).for_each(|d| *d = Vec3::z());
    }

    fn neighbours(&self, at: usize) -> impl Iterator<Item = usize> + use<> {
        let (x, y, width, height) = (at % self.width, at / self.width, self.width, self.height);
        let steps = (0..9)
            .filter(|k| *k != 4)
            .map(move |k| ((x + k % 3).wrapping_sub(1), (y + k / 3).wrapping_sub(1)));
        steps.filter(move |&(x, y)| x < width && y < height).map(move |(x, y)| y * width + x)
    }

    fn neighbour_mean(&self, at: usize) -> (Vec3, [f32; 2]) {
        let (mut direction, mut height, mut crease, mut count) = (Vec3::zeros(), 0.0, 0.0, 0.0f32);
        for near in self.neighbours(at).filter(|&near| self.direction[near] != Vec3::zeros()) {
            direction += self.direction[near];
            height += self.height_m[near];
            crease += self.crease[near];
            count += 1.0;
        }
        let mean = [height, crease].map(|sum| sum / count.max(1.0));
        (direction.try_normalize(1e-9).unwrap_or_else(Vec3::z), mean)
    }

    /// Returns the direction at texture coordinates `uv`, interpolated bilinearly.
    pub(super) fn sample(&self, uv: Vec2) -> Vec3 {
        let position = |coordinate: f64, count: usize| {
            let at = coordinate * count as f64 - 0.5;
            let low = at.floor();
            let index = |k: f64| (k as i64).rem_euclid(count as i64) as usize;
            (index(low), index(low + 1.0), at - low)
        };
        let ((x0, x1, s), (y0, y1, t)) = (position(uv.x, self.width), position(uv.y, self.height));
        let at = |x: usize, y: usize| self.direction[y * self.width + x];
        let sum = (at(x0, y0) * (1.0 - s) + at(x1, y0) * s) * (1.0 - t)
            + (at(x0, y1) * (1.0 - s) + at(x1, y1) * s) * t;
        sum.try_normalize(1e-9).unwrap_or_else(Vec3::z)
    }

    /// Writes the directions as a picture with three channels.
    pub(super) fn to_png(&self, depth: MapDepth) -> Result<Vec<u8>, String> {
        let rows =
            self.direction.iter().flat_map(|d| [d.x, d.y, d.z]).map(|x| 0.5 + 0.5 * x.clamp(-1.0, 1.0));
        write_png(self.width, self.height, png::ColorType::Rgb, depth, rows)
    }

    /// Writes the heights as a grey 16-bit picture; also returns the heights of black and white [m].
    pub(super) fn height_png(&self) -> Result<(Vec<u8>, [f32; 2]), String> {
        let max = self.height_m.iter().fold(1e-6f32, |max, height| max.max(height.abs()));
        let rows = self.height_m.iter().map(|height| f64::from(0.5 + 0.5 * height / max));
        let png = write_png(self.width, self.height, png::ColorType::Grayscale, MapDepth::Sixteen, rows)?;
        Ok((png, [-max, max]))
    }

    /// Writes the angles of creases as a grey 8-bit picture: white for half a turn.
    pub(super) fn crease_png(&self) -> Result<Vec<u8>, String> {
        let rows = self.crease.iter().map(|crease| f64::from(crease.clamp(0.0, 1.0)));
        write_png(self.width, self.height, png::ColorType::Grayscale, MapDepth::Eight, rows)
    }

    /// Reads the directions of a normal map from a PNG file.
    pub(super) fn from_png(bytes: &[u8]) -> Result<Self, String> {
        let mut decoder = png::Decoder::new(std::io::Cursor::new(bytes));
        decoder.set_transformations(png::Transformations::EXPAND);
        let mut reader = decoder.read_info().map_err(|e| e.to_string())?;
        let size = reader
            .output_buffer_size()
            .filter(|size| *size <= TUNING.max_picture_bytes)
            .ok_or("it is too large")?;
        let mut buffer = vec![0; size];
        let info = reader.next_frame(&mut buffer).map_err(|e| e.to_string())?;
        let channels = info.color_type.samples();
        if channels < 3 {
            return Err("it has no colours".into());
        }
        let values: Vec<f64> = match info.bit_depth {
            png::BitDepth::Sixteen => {
                let words = buffer.as_chunks::<2>().0.iter();
                words.map(|&w| f64::from(u16::from_be_bytes(w)) / 65535.0).collect()
            }
            _ => buffer.iter().map(|&b| f64::from(b) / 255.0).collect(),
        };
        let direction: Vec<Vec3> = values
            .chunks_exact(channels)
            .map(|c| Vec3::new(c[0], c[1], c[2]).map(|x| 2.0 * x - 1.0))
            .map(|d| d.try_normalize(1e-6).unwrap_or_else(Vec3::z))
            .collect();
        let (width, height) = (info.width as usize, info.height as usize);
        if direction.len() < width * height || direction.is_empty() {
            return Err("it ends too early".into());
        }
        let zeros = vec![0.0; direction.len()];
        Ok(Self { width, height, height_m: zeros.clone(), crease: zeros, direction, conflicts: 0 })
    }
}

fn write_png(
    width: usize,
    height: usize,
    colour: png::ColorType,
    depth: MapDepth,
    fractions: impl Iterator<Item = f64>,
) -> Result<Vec<u8>, String> {
    let side = |n: usize| u32::try_from(n).map_err(|e| e.to_string());
    let mut bytes = Vec::new();
    let mut encoder = png::Encoder::new(&mut bytes, side(width)?, side(height)?);
    encoder.set_color(colour);
    let data: Vec<u8> = match depth {
        MapDepth::Eight => {
            encoder.set_depth(png::BitDepth::Eight);
            fractions.map(|x| (x * 255.0).round() as u8).collect()
        }
        MapDepth::Sixteen => {
            encoder.set_depth(png::BitDepth::Sixteen);
            fractions.flat_map(|x| ((x * 65535.0).round() as u16).to_be_bytes()).collect()
        }
    };
    encoder.set_compression(png::Compression::Fast);
    let mut writer = encoder.write_header().map_err(|e| e.to_string())?;
    writer.write_image_data(&data).map_err(|e| e.to_string())?;
    writer.finish().map_err(|e| e.to_string())?;
    Ok(bytes)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn at(direction: Vec3, height_m: f64) -> Option<TexelSample> {
        Some(TexelSample { direction, height_m, crease: 0.0 })
    }

    fn tilted() -> Vec3 {
        Vec3::new(0.3, -0.2, 1.0).normalize()
    }

    #[test]
    fn triangles_fill_their_texels_once_and_borders_are_padded() {
        let mut texels = Texels::new(16);
        let square = [[0.25, 0.25], [0.75, 0.25], [0.75, 0.75], [0.25, 0.75]].map(Vec2::from);
        let half = |texels: &mut Texels, k: [usize; 3], d: Vec3| {
            texels.fill(k.map(|k| square[k]), &|_| at(d, 1e-3));
        };
        half(&mut texels, [0, 1, 2], tilted());
        half(&mut texels, [0, 2, 3], tilted());
        assert_eq!(texels.filled_count(), 64);
        assert_eq!(texels.conflicts, 0);
        half(&mut texels, [0, 1, 2], -tilted());
        assert!(texels.conflicts >= 28, "{}", texels.conflicts);
        texels.pad(2);
        assert_eq!(texels.direction[16 * 2 + 2], tilted());
        assert_eq!(texels.direction[0], Vec3::z());
        // Between texels beyond the border a viewer still reads the same.
        assert!((texels.sample(Vec2::new(0.22, 0.5)) - tilted()).norm() < 1e-12);
    }

    #[test]
    fn coordinates_beyond_one_repeat_and_damage_is_left_out() {
        let mut texels = Texels::new(8);
        texels.fill([[1.0, 0.0], [2.0, 0.0], [1.0, 1.0]].map(Vec2::from), &|_| at(tilted(), 0.0));
        assert!(texels.filled_count() >= 28);
        let before = texels.filled_count();
        for bad in [f64::NAN, 1e30, 50.0] {
            texels.fill([[bad, 0.0], [0.0, 0.0], [0.0, bad]].map(Vec2::from), &|_| at(tilted(), 0.0));
        }
        assert_eq!(texels.filled_count(), before);
    }

    #[test]
    fn a_png_reads_back_to_sixteen_bits() {
        let mut texels = Texels::new(4);
        texels.fill([[0.0, 0.0], [2.0, 0.0], [0.0, 2.0]].map(Vec2::from), &|s| {
            at(Vec3::new(0.4 * s[1], 0.4 * s[2], 1.0).normalize(), s[0])
        });
        let back = Texels::from_png(&texels.to_png(MapDepth::Sixteen).unwrap()).unwrap();
        let worst =
            texels.direction.iter().zip(&back.direction).map(|(a, b)| (a - b).norm()).fold(0.0, f64::max);
        assert!(worst < 4e-5, "{worst}");
        assert!(Texels::from_png(b"\x89PNG broken").is_err());
        assert!(texels.height_png().is_ok());
    }
}
