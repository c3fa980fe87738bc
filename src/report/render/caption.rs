//! Words on a picture: the legend of a field, and captions over two pictures side by side.

use crate::report::render::shade::BACKGROUND_SRGB;
use crate::report::render::{Field, Image, font};

/// Colour of writing.
const INK: [u8; 3] = [40, 42, 46];
/// Columns of free space between two pictures side by side.
const GUTTER: usize = 8;

/// Pixels per dot of the font, for a picture of this width.
fn scale(width: usize) -> usize {
    (width / 400).max(1)
}

/// Height of the legend under a picture of `size` [pixels]: none where there is no room for it.
pub(super) fn legend_height([width, height]: [usize; 2]) -> usize {
    let wanted = 2 * font::height(scale(width)) + 20 * scale(width);
    if width >= 120 && height >= 2 * wanted { wanted } else { 0 }
}

/// Draws the legend into the lowest `height` rows: title and unit, the colours, the numbers under them.
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
    font::write(image, &title, centred(&title, image.width / 2, dot, image.width), top, dot, INK);
    let bar_top = top + font::height(dot) + 3 * dot;
    let bar_height = 10 * dot;
    for x in 0..bar_width {
        let share = x as f64 / (bar_width - 1).max(1) as f64;
        for y in 0..bar_height {
            image.set(bar_left + x, bar_top + y, field.map.srgb(share));
        }
    }
    let [below, above] = field.clipped(limits);
    for (k, share) in [0.0, 0.5, 1.0].into_iter().enumerate() {
        let mut text = number(limits[0] + share * (limits[1] - limits[0]), limits[1] - limits[0]);
        if k == 0 && below {
            text.insert(0, '≤');
        }
        if k == 2 && above {
            text.insert(0, '≥');
        }
        let middle = bar_left + (share * (bar_width - 1) as f64) as usize;
        for y in 0..2 * dot {
            image.set(middle, bar_top + bar_height + y, INK);
        }
        let x = centred(&text, middle, dot, image.width);
        font::write(image, &text, x, bar_top + bar_height + 3 * dot, dot, INK);
    }
}

/// Left end of `text` centred at `middle`, kept inside the picture.
fn centred(text: &str, middle: usize, dot: usize, image_width: usize) -> usize {
    let width = font::width(text, dot);
    middle.saturating_sub(width / 2).min(image_width.saturating_sub(width))
}

/// `value` with as many digits as a range of this `span` deserves.
fn number(value: f64, span: f64) -> String {
    let digits = (2.0 - span.max(1e-9).log10().floor()).clamp(0.0, 6.0) as usize;
    let text = format!("{value:.digits$}");
    let text = if text.contains('.') { text.trim_end_matches('0').trim_end_matches('.') } else { &text };
    if text == "-0" { "0".into() } else { text.into() }
}

/// Two pictures beside each other, each under its caption: before and after, ours and a reference.
pub fn side_by_side(left: &Image, right: &Image, captions: [&str; 2]) -> Image {
    let dot = scale(left.width.max(right.width));
    let head = font::height(dot) + 8 * dot;
    let height = head + left.height.max(right.height);
    let mut image = Image::filled(left.width + GUTTER + right.width, height, BACKGROUND_SRGB);
    for (part, x, caption) in [(left, 0, captions[0]), (right, left.width + GUTTER, captions[1])] {
        // A caption longer than its picture would run into the other one.
        let room = part.width / font::width("mm", dot).max(1) * 2;
        let caption: String = caption.chars().take(room).collect();
        let indent = part.width.saturating_sub(font::width(&caption, dot)) / 2;
        font::write(&mut image, &caption, x + indent, 4 * dot, dot, INK);
        image.paste(part, x, head);
    }
    image
}

/// Two pictures, or rows of pictures, one above the other.
pub fn one_above_the_other(upper: &Image, lower: &Image) -> Image {
    let (width, height) = (upper.width.max(lower.width), upper.height + GUTTER + lower.height);
    let mut image = Image::filled(width, height, BACKGROUND_SRGB);
    image.paste(upper, 0, 0);
    image.paste(lower, 0, upper.height + GUTTER);
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
        assert_eq!(both.width, 120 + GUTTER + 80);
        let head = both.height - 60;
        assert_eq!(both.pixel(0, head), [255, 0, 0, 255]);
        assert_eq!(both.pixel(120 + GUTTER, head + 59), [0, 0, 255, 255]);
        assert_eq!(both.pixel(10, head + 50)[..3], BACKGROUND_SRGB);
        for columns in [0..120, 120 + GUTTER..both.width] {
            assert!(
                columns.clone().any(|x| (0..head).any(|y| both.pixel(x, y)[..3] == INK)),
                "a caption is missing"
            );
        }
    }

    #[test]
    fn rows_keep_their_pictures() {
        let (upper, lower) = (Image::filled(120, 40, [255, 0, 0]), Image::filled(80, 60, [0, 0, 255]));
        let rows = one_above_the_other(&upper, &lower);
        assert_eq!([rows.width, rows.height], [120, 100 + GUTTER]);
        assert_eq!(rows.pixel(119, 39), [255, 0, 0, 255]);
        assert_eq!(rows.pixel(0, 40 + GUTTER), [0, 0, 255, 255]);
        assert_eq!(rows.pixel(100, 99)[..3], BACKGROUND_SRGB);
    }
}
