//! Text of legends, captions and charts: DejaVu Sans, embedded, drawn with antialiasing by the ab_glyph crate.
//!
//! The embedded file has Latin and Greek letters, digits, and the characters of units; others are drawn as a box. It was cut
//! from DejaVu Sans 2.37 by `pyftsubset` (fontTools).

use crate::report::render::image::Image;
use ab_glyph::{Font, FontRef, GlyphId, PxScale, ScaleFont, point};
use std::sync::LazyLock;

const FILE: &[u8] = include_bytes!("DejaVuSans-subset.ttf");
static FONT: LazyLock<Option<FontRef<'static>>> = LazyLock::new(|| FontRef::try_from_slice(FILE).ok());

/// Height of a line of text as a fraction of its size.
const LINE_HEIGHT: f64 = 1.18;

/// Font at a size.
fn scaled(size: f64) -> Option<ab_glyph::PxScaleFont<&'static FontRef<'static>>> {
    let font = FONT.as_ref()?;
    let units = font.units_per_em()?;
    // The crate measures a font by ascent minus descent.
    Some(font.as_scaled(PxScale::from(size as f32 * font.height_unscaled() / units)))
}

/// Width of `text` at `size` \[pixels\].
pub fn width(text: &str, size: f64) -> usize {
    let mut end = 0.0;
    if let Some(font) = scaled(size) {
        let mut last = None;
        for letter in text.chars() {
            let id = font.glyph_id(letter);
            end += advance(&font, &mut last, id);
        }
    }
    end.ceil() as usize
}

/// Height of a line of text at `size` \[pixels\].
pub fn height(size: f64) -> usize {
    (LINE_HEIGHT * size).ceil() as usize
}

/// Kerning and width of the letter `id` after `last`.
fn advance<F: Font, S: ScaleFont<F>>(font: &S, last: &mut Option<GlyphId>, id: GlyphId) -> f32 {
    let kerning = last.replace(id).map_or(0.0, |last| font.kern(last, id));
    kerning + font.h_advance(id)
}

/// Calls `visit` with column, row and coverage (0 to 1) of every pixel that `text` touches, from its upper left corner.
pub fn visit(text: &str, size: f64, visit: &mut dyn FnMut(usize, usize, f64)) {
    let Some(font) = scaled(size) else { return };
    let (mut pen, mut last) = (0.0, None);
    for letter in text.chars() {
        let id = font.glyph_id(letter);
        let kerning = last.replace(id).map_or(0.0, |last| font.kern(last, id));
        pen += kerning;
        let glyph = id.with_scale_and_position(font.scale(), point(pen, font.ascent()));
        pen += font.h_advance(id);
        let Some(outline) = font.outline_glyph(glyph) else { continue };
        let bounds = outline.px_bounds();
        outline.draw(|x, y, coverage| {
            let (x, y) = (bounds.min.x + x as f32, bounds.min.y + y as f32);
            if coverage > 0.0 && x >= 0.0 && y >= 0.0 {
                visit(x as usize, y as usize, f64::from(coverage.min(1.0)));
            }
        });
    }
}

/// Writes `text` with its upper left corner at (`x`, `y`).
pub(super) fn write(image: &mut Image, text: &str, x: usize, y: usize, size: f64, colour: [u8; 3]) {
    visit(text, size, &mut |dx, dy, coverage| image.blend(x + dx, y + dy, colour, coverage));
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Coverage of `text`, in a box that contains it.
    fn look(text: &str, size: f64) -> Vec<f64> {
        let (wide, tall) = (width(text, size) + 4, height(size) + 4);
        let mut out = vec![0.0; wide * tall];
        visit(text, size, &mut |x, y, coverage| out[(y * wide + x).min(wide * tall - 1)] += coverage);
        out
    }

    #[test]
    fn letters_and_units_are_drawn_and_differ() {
        let missing = look("\u{10ffff}", 20.0);
        let all: Vec<char> = ('!'..='~').chain("°²µ≤≥−×·±→πσ".chars()).collect();
        for (i, &a) in all.iter().enumerate() {
            let own = look(&a.to_string(), 20.0);
            assert!(own.iter().sum::<f64>() > 1.0, "{a} is blank");
            assert_ne!(own, missing, "{a} is not in the font");
            for &b in &all[i + 1..] {
                assert_ne!(own, look(&b.to_string(), 20.0), "{a} and {b}");
            }
        }
    }

    #[test]
    fn edges_are_smooth_and_the_size_is_that_asked_for() {
        let shades = look("O", 40.0).into_iter().filter(|c| *c > 0.05 && *c < 0.95).count();
        assert!(shades > 40, "{shades} pixels between text and ground");
        let rows = |size| {
            let mut rows = [usize::MAX, 0];
            visit("H", size, &mut |_, y, _| rows = [rows[0].min(y), rows[1].max(y)]);
            rows[1] - rows[0] + 1
        };
        // Capitals of DejaVu Sans are 0.729 of its size tall.
        assert!(rows(100.0).abs_diff(73) <= 2 && rows(20.0).abs_diff(15) <= 1);
        assert_eq!(width("mm", 20.0), width("m", 40.0));
    }
}
