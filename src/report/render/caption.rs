//! Text on pictures: the legend of a field, and captions of two pictures side by side.

use crate::report::render::colour::BACKGROUND_SRGB;
use crate::report::render::field::{Clipped, Field};
use crate::report::render::font;
use crate::report::render::image::Image;

/// Colour of text.
const TEXT_COLOUR: [u8; 3] = [40, 42, 46];
/// Gap between two pictures [pixels].
const GAP: usize = 8;

/// Returns the size of text on a picture of this width [pixels].
fn text_size(width: usize) -> f64 {
    (width as f64 / 52.0).clamp(10.0, 40.0)
}

/// Returns the height of the legend of a picture of `size` [pixels]; 0 if the picture is too small for one.
pub(super) fn legend_height([width, height]: [usize; 2]) -> usize {
    let text = text_size(width);
    let wanted = 2 * font::height(text) + (2.2 * text) as usize;
    if width >= 120 && height >= 2 * wanted { wanted } else { 0 }
}

/// Draws the legend into the lowest `height` rows: title and unit, colour bar, numbers.
pub(super) fn draw_legend(image: &mut Image, field: &Field, height: usize) {
    if height == 0 {
        return;
    }
    let text_size = text_size(image.width);
    let unit = (text_size / 8.0).ceil() as usize;
    let limits = field.limits();
    let top = image.height - height;
    let title =
        if field.unit.is_empty() { field.title.clone() } else { format!("{} [{}]", field.title, field.unit) };
    let bar_left = image.width / 4;
    let bar_width = image.width - 2 * bar_left;
    let title_left = centred(&title, image.width / 2, text_size, image.width);
    font::write(image, &title, title_left, top, text_size, TEXT_COLOUR);
    let bar_top = top + font::height(text_size) + 2 * unit;
    let bar_height = (0.9 * text_size) as usize;
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
            text.insert_str(0, "≤ ");
        }
        if k == 2 && above {
            text.insert_str(0, "≥ ");
        }
        let middle = bar_left + (fraction * (bar_width - 1) as f64) as usize;
        for (x, y) in (0..unit.div_ceil(2)).flat_map(|x| (0..2 * unit).map(move |y| (x, y))) {
            image.set(middle + x, bar_top + bar_height + y, TEXT_COLOUR);
        }
        let x = centred(&text, middle, text_size, image.width);
        font::write(image, &text, x, bar_top + bar_height + 2 * unit, text_size, TEXT_COLOUR);
    }
}

/// Returns the left end of `text` centred at `middle`, within the picture.
fn centred(text: &str, middle: usize, text_size: f64, image_width: usize) -> usize {
    let width = font::width(text, text_size);
    middle.saturating_sub(width / 2).min(image_width.saturating_sub(width))
}

/// Formats `value` with as many digits as a range of this `span` needs.
fn number(value: f64, span: f64) -> String {
    let digits = (2.0 - span.max(1e-9).log10().floor()).clamp(0.0, 6.0) as usize;
    let text = format!("{value:.digits$}");
    let text = if text.contains('.') { text.trim_end_matches('0').trim_end_matches('.') } else { &text };
    if text == "-0" { "0".into() } else { text.replace('-', "−") }
}

/// Returns two pictures side by side, each below its caption.
pub fn side_by_side(left: &Image, right: &Image, captions: [&str; 2]) -> Image {
    let text_size = 1.2 * text_size(left.width.max(right.width));
    let margin = (0.4 * text_size) as usize;
    let head = font::height(text_size) + 2 * margin;
    let height = head + left.height.max(right.height);
    let mut image = Image::filled(left.width + GAP + right.width, height, BACKGROUND_SRGB);
    for (part, x, caption) in [(left, 0, captions[0]), (right, left.width + GAP, captions[1])] {
        // Longer captions would run into the other picture.
        let mut caption = caption.to_owned();
        while font::width(&caption, text_size) > part.width && caption.pop().is_some() {}
        let indent = part.width.saturating_sub(font::width(&caption, text_size)) / 2;
        font::write(&mut image, &caption, x + indent, margin, text_size, TEXT_COLOUR);
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
        assert_eq!(number(-30.0, 60.0), "−30");
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
                columns.clone().any(|x| (0..head).any(|y| both.pixel(x, y)[1] < BACKGROUND_SRGB[1] / 2)),
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
