//! Text on pictures: the legend of a field, and captions of two pictures side by side.

use crate::report::render::colour::BACKGROUND_SRGB;
use crate::report::render::field::{Clipped, Field};
use crate::report::render::font;
use crate::report::render::image::Image;

/// Colour of text.
const TEXT_COLOUR: [u8; 3] = [40, 42, 46];
/// Gap between two pictures [pixels].
const GAP: usize = 8;

/// Returns the pixels per dot of the font for a picture of this width.
fn scale(width: usize) -> usize {
    (width / 400).max(1)
}

/// Returns the height of the legend of a picture of `size` [pixels]; 0 if the picture is too small for one.
pub(super) fn legend_height([width, height]: [usize; 2]) -> usize {
    let wanted = 2 * font::height(scale(width)) + 20 * scale(width);
    if width >= 120 && height >= 2 * wanted { wanted } else { 0 }
}

/// Draws the legend into the lowest `height` rows: title and unit, colour bar, numbers.
pub(super) fn draw_legend(image: &mut Image, field: &Field, height: usize) {
    if height == 0 {
        return;
    }
    let dot = scale(image.width);
    let limits = field.limits();
    let top = image.height - height;
    let title =
        if field.unit.is_empty() { field.title.clone() } else { format!("{} [{}]", field.title, field.unit) };
    let bar_left = image.width / 5;
    let bar_width = image.width - 2 * bar_left;
    font::write(image, &title, centred(&title, image.width / 2, dot, image.width), top, dot, TEXT_COLOUR);
    let bar_top = top + font::height(dot) + 3 * dot;
    let bar_height = 10 * dot;
    for x in 0..bar_width {
        let fraction = x as f64 / (bar_width - 1).max(1) as f64;
        for y in 0..bar_height {
            image.set(bar_left + x, bar_top + y, field.map.srgb(fraction));
        }
    }
    let Clipped { below, above } = field.clipped(limits);
    for (k, fraction) in [0.0, 0.5, 1.0].into_iter().enumerate() {
        let mut text = number(limits[0] + fraction * (limits[1] - limits[0]), limits[1] - limits[0]);
        if k == 0 && below {
            text.insert(0, '≤');
        }
        if k == 2 && above {
            text.insert(0, '≥');
        }
        let middle = bar_left + (fraction * (bar_width - 1) as f64) as usize;
        for y in 0..2 * dot {
            image.set(middle, bar_top + bar_height + y, TEXT_COLOUR);
        }
        let x = centred(&text, middle, dot, image.width);
        font::write(image, &text, x, bar_top + bar_height + 3 * dot, dot, TEXT_COLOUR);
    }
}

/// Returns the left end of `text` centred at `middle`, within the picture.
fn centred(text: &str, middle: usize, dot: usize, image_width: usize) -> usize {
    let width = font::width(text, dot);
    middle.saturating_sub(width / 2).min(image_width.saturating_sub(width))
}

/// Formats `value` with as many digits as a range of this `span` needs.
fn number(value: f64, span: f64) -> String {
    let digits = (2.0 - span.max(1e-9).log10().floor()).clamp(0.0, 6.0) as usize;
    let text = format!("{value:.digits$}");
    let text = if text.contains('.') { text.trim_end_matches('0').trim_end_matches('.') } else { &text };
    if text == "-0" { "0".into() } else { text.into() }
}

/// Returns two pictures side by side, each below its caption.
pub fn side_by_side(left: &Image, right: &Image, captions: [&str; 2]) -> Image {
    let dot = scale(left.width.max(right.width));
    let head = font::height(dot) + 8 * dot;
    let height = head + left.height.max(right.height);
    let mut image = Image::filled(left.width + GAP + right.width, height, BACKGROUND_SRGB);
    for (part, x, caption) in [(left, 0, captions[0]), (right, left.width + GAP, captions[1])] {
        // Longer captions would run into the other picture.
        let max_length = part.width / font::width("mm", dot).max(1) * 2;
        let caption: String = caption.chars().take(max_length).collect();
        let indent = part.width.saturating_sub(font::width(&caption, dot)) / 2;
        font::write(&mut image, &caption, x + indent, 4 * dot, dot, TEXT_COLOUR);
        image.paste(part, x, head);
    }
    image
}

/// Returns two pictures one above the other.
pub fn one_above_the_other(upper: &Image, lower: &Image) -> Image {
    let (width, height) = (upper.width.max(lower.width), upper.height + GAP + lower.height);
    let mut image = Image::filled(width, height, BACKGROUND_SRGB);
    image.paste(upper, 0, 0);
    image.paste(lower, 0, upper.height + GAP);
    image
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_short_and_exact() {
        assert_eq!(number(-30.0, 60.0), "-30");
        assert_eq!(number(1.5, 3.0), "1.5");
        assert_eq!(number(-0.0, 60.0), "0");
        assert_eq!(number(0.0005, 0.001), "0.0005");
        assert_eq!(number(1200.0, 1200.0), "1200");
    }

    #[test]
    fn both_pictures_are_there_under_their_captions() {
        let (left, right) = (Image::filled(120, 40, [255, 0, 0]), Image::filled(80, 60, [0, 0, 255]));
        let both = side_by_side(&left, &right, ["before", "after"]);
        assert_eq!(both.width, 120 + GAP + 80);
        let head = both.height - 60;
        assert_eq!(both.pixel(0, head), [255, 0, 0, 255]);
        assert_eq!(both.pixel(120 + GAP, head + 59), [0, 0, 255, 255]);
        assert_eq!(both.pixel(10, head + 50)[..3], BACKGROUND_SRGB);
        for columns in [0..120, 120 + GAP..both.width] {
            assert!(
                columns.clone().any(|x| (0..head).any(|y| both.pixel(x, y)[..3] == TEXT_COLOUR)),
                "a caption is missing"
            );
        }
    }

    #[test]
    fn rows_keep_their_pictures() {
        let (upper, lower) = (Image::filled(120, 40, [255, 0, 0]), Image::filled(80, 60, [0, 0, 255]));
        let rows = one_above_the_other(&upper, &lower);
        assert_eq!([rows.width, rows.height], [120, 100 + GAP]);
        assert_eq!(rows.pixel(119, 39), [255, 0, 0, 255]);
        assert_eq!(rows.pixel(0, 40 + GAP), [0, 0, 255, 255]);
        assert_eq!(rows.pixel(100, 99)[..3], BACKGROUND_SRGB);
    }
}
