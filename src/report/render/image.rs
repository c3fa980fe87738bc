//! A picture in memory, and its bytes as PNG.

use crate::report::render::colour::{to_linear, to_srgb};
use crease_model::error::{Error, Result};

/// A picture, row by row from the top left, in sRGB with alpha.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Image {
    /// Pixels in a row.
    pub width: usize,
    /// Rows.
    pub height: usize,
    /// Four bytes per pixel: red, green, blue (sRGB), alpha.
    pub rgba: Vec<u8>,
}

impl Image {
    /// Creates a picture of one colour.
    pub fn filled(width: usize, height: usize, [r, g, b]: [u8; 3]) -> Self {
        let rgba = [r, g, b, 255].repeat(width.saturating_mul(height));
        Self { width, height, rgba }
    }

    /// Returns the pixel in column `x` of row `y`; transparent black outside the picture.
    pub fn pixel(&self, x: usize, y: usize) -> [u8; 4] {
        let inside = x < self.width && y < self.height;
        let at = 4 * (y * self.width + x);
        let bytes = inside.then(|| self.rgba.get(at..at + 4)).flatten();
        bytes.and_then(|b| b.try_into().ok()).unwrap_or([0; 4])
    }

    /// Mixes a colour into pixel (`x`, `y`) by `coverage`, 0 to 1, as light adds; nothing happens outside.
    pub fn blend(&mut self, x: usize, y: usize, colour: [u8; 3], coverage: f64) {
        let under = self.pixel(x, y);
        let linear = |c: u8| to_linear(f64::from(c) / 255.0);
        let mix = |k: usize| to_srgb(linear(under[k]) + coverage * (linear(colour[k]) - linear(under[k])));
        self.set(x, y, [mix(0), mix(1), mix(2)]);
    }

    /// The picture at half its size: each pixel is the mean of four.
    pub fn halved(&self) -> Self {
        let mut out = Self::filled(self.width / 2, self.height / 2, [0; 3]);
        for y in 0..out.height {
            for x in 0..out.width {
                let four =
                    [(0, 0), (1, 0), (0, 1), (1, 1)].map(|(dx, dy)| self.pixel(2 * x + dx, 2 * y + dy));
                let mean =
                    |k: usize| four.iter().map(|p| to_linear(f64::from(p[k]) / 255.0)).sum::<f64>() / 4.0;
                out.set(x, y, [0, 1, 2].map(|k| to_srgb(mean(k))));
            }
        }
        out
    }

    /// Sets a pixel. Pixels outside the picture are ignored.
    pub fn set(&mut self, x: usize, y: usize, [r, g, b]: [u8; 3]) {
        if x < self.width && y < self.height {
            let at = 4 * (y * self.width + x);
            if let Some(bytes) = self.rgba.get_mut(at..at + 4) {
                bytes.copy_from_slice(&[r, g, b, 255]);
            }
        }
    }

    /// Copies `other` with its upper left corner at (`x`, `y`). Pixels outside the picture are ignored.
    pub fn paste(&mut self, other: &Image, x: usize, y: usize) {
        for row in 0..other.height {
            for column in 0..other.width {
                let [r, g, b, _] = other.pixel(column, row);
                self.set(x + column, y + row, [r, g, b]);
            }
        }
    }
}

/// Encodes a picture as a PNG file.
pub fn encode_png(image: &Image) -> Result<Vec<u8>> {
    let error = |message: String| Error::input("picture", "", message, "");
    let side = |n: usize| u32::try_from(n).map_err(|_| error(format!("{n} pixels do not fit into a PNG")));
    let mut bytes = Vec::new();
    let mut encoder = png::Encoder::new(&mut bytes, side(image.width)?, side(image.height)?);
    encoder.set_color(png::ColorType::Rgba);
    encoder.set_depth(png::BitDepth::Eight);
    encoder.set_compression(png::Compression::Fast);
    encoder.set_source_srgb(png::SrgbRenderingIntent::Perceptual);
    let mut writer = encoder.write_header().map_err(|e| error(e.to_string()))?;
    writer.write_image_data(&image.rgba).map_err(|e| error(e.to_string()))?;
    writer.finish().map_err(|e| error(e.to_string()))?;
    Ok(bytes)
}

/// Encodes pictures of one size as an animated PNG that repeats, each shown for `1 / rate` s.
pub fn encode_apng(images: &[Image], rate: u16) -> Result<Vec<u8>> {
    let error = |message: String| Error::input("picture", "", message, "");
    let Some(first) = images.first() else { return Err(error("an animation needs a picture".into())) };
    let side = |n: usize| u32::try_from(n).map_err(|_| error(format!("{n} pixels do not fit into a PNG")));
    let mut bytes = Vec::new();
    let mut encoder = png::Encoder::new(&mut bytes, side(first.width)?, side(first.height)?);
    encoder.set_color(png::ColorType::Rgb);
    encoder.set_depth(png::BitDepth::Eight);
    encoder.set_compression(png::Compression::High);
    encoder.set_source_srgb(png::SrgbRenderingIntent::Perceptual);
    encoder.set_animated(side(images.len())?, 0).map_err(|e| error(e.to_string()))?;
    encoder.set_frame_delay(1, rate.max(1)).map_err(|e| error(e.to_string()))?;
    let mut writer = encoder.write_header().map_err(|e| error(e.to_string()))?;
    for image in images {
        let rgb: Vec<u8> = image.rgba.chunks_exact(4).flat_map(|p| [p[0], p[1], p[2]]).collect();
        writer.write_image_data(&rgb).map_err(|e| error(e.to_string()))?;
    }
    writer.finish().map_err(|e| error(e.to_string()))?;
    Ok(bytes)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_png_reads_back_as_it_was() {
        let mut image = Image::filled(5, 3, [10, 20, 30]);
        image.set(4, 2, [200, 100, 50]);
        let bytes = encode_png(&image).unwrap();
        let mut reader = png::Decoder::new(std::io::Cursor::new(bytes)).read_info().unwrap();
        let mut back = vec![0; reader.output_buffer_size().unwrap()];
        let info = reader.next_frame(&mut back).unwrap();
        assert_eq!((info.width, info.height), (5, 3));
        assert_eq!(back, image.rgba);
    }

    #[test]
    fn an_animation_has_all_its_pictures() {
        let images = [[10, 20, 30], [200, 100, 50], [0, 0, 0]].map(|colour| Image::filled(6, 4, colour));
        let bytes = encode_apng(&images, 12).unwrap();
        let mut reader = png::Decoder::new(std::io::Cursor::new(bytes)).read_info().unwrap();
        assert_eq!(reader.info().animation_control.map(|control| control.num_frames), Some(3));
        for image in &images {
            let mut back = vec![0; reader.output_buffer_size().unwrap()];
            reader.next_frame(&mut back).unwrap();
            assert_eq!(back[..3], image.rgba[..3]);
        }
        assert!(encode_apng(&[], 12).is_err());
        assert!(encode_apng(&[images[0].clone(), Image::filled(5, 4, [0; 3])], 12).is_err());
    }

    #[test]
    fn an_inconsistent_image_is_an_error() {
        let image = Image { width: 7, height: 7, rgba: vec![0; 3] };
        assert!(encode_png(&image).is_err());
        assert_eq!(image.pixel(6, 6), [0; 4]);
        assert!(encode_png(&Image::filled(0, 0, [0; 3])).is_err());
    }
}
