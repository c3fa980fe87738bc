//! A picture in memory, and its bytes as PNG.

use crate::error::{Error, Result};

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
    fn an_inconsistent_image_is_an_error() {
        let image = Image { width: 7, height: 7, rgba: vec![0; 3] };
        assert!(encode_png(&image).is_err());
        assert_eq!(image.pixel(6, 6), [0; 4]);
        assert!(encode_png(&Image::filled(0, 0, [0; 3])).is_err());
    }
}
