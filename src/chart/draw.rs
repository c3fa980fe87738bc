//! Rendering of figures with plotters: as SVG, and as PNG of twice the size.
//!
//! The palette is that of Okabe and Ito, which colour-blind readers can distinguish; crossing series differ in mark
//! as well.

use crate::raster::Canvas;
use crate::ticks::Ticks;
use crate::{Figure, Mark, Panel, Series};
use crease::internal::report::render::{Image, encode_png};
use crease_model::error::{Error, Result};
use plotters::element::DashedPathElement;
use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, Pos, VPos};

/// Colours of Okabe and Ito, those with enough contrast on white first; `BLACK` and `GREY` are the last two.
const PALETTE: [RGBColor; 8] = [
    RGBColor(0, 114, 178),
    RGBColor(213, 94, 0),
    RGBColor(0, 158, 115),
    RGBColor(204, 121, 167),
    RGBColor(86, 180, 233),
    RGBColor(230, 159, 0),
    RGBColor(0, 0, 0),
    RGBColor(150, 150, 150),
];

/// Width of a panel [SVG pixels].
const PANEL_WIDTH: u32 = 560;
/// Height of a panel, with its part of the title [SVG pixels].
const PANEL_HEIGHT: u32 = 460;
/// Pixels of the PNG per SVG pixel.
const PNG_SCALE: u32 = 2;
/// Top of the legend, below the title [SVG pixels].
const LEGEND_TOP: u32 = 38;
/// Height of a row of the legend [SVG pixels].
const LEGEND_ROW_HEIGHT: u32 = 20;
/// Panels beside one another at most.
const MAX_COLUMNS: usize = 3;
/// Colour of text and axes.
const INK: RGBColor = RGBColor(20, 20, 20);

/// Renders the figure as SVG.
pub(super) fn svg(figure: &Figure) -> Result<String> {
    let mut text = String::new();
    draw(SVGBackend::with_string(&mut text, size(figure)).into_drawing_area(), figure, 1)?;
    Ok(text)
}

/// Renders the figure as PNG.
pub(super) fn png(figure: &Figure) -> Result<Vec<u8>> {
    let (width, height) = size(figure);
    // Lines are smooth because the picture is drawn at twice its size.
    let scale = 2 * PNG_SCALE;
    let side = |n: u32| (n * scale) as usize;
    let mut image = Image::filled(side(width), side(height), [255; 3]);
    draw(Canvas(&mut image).into_drawing_area(), figure, scale)?;
    encode_png(&image.halved())
}

/// Width and height of the picture [SVG pixels].
fn size(figure: &Figure) -> (u32, u32) {
    let Grid { rows, columns } = Grid::of(figure);
    let legend_height = LEGEND_ROW_HEIGHT * legend_rows(figure).len() as u32;
    (PANEL_WIDTH * columns as u32, PANEL_HEIGHT * rows as u32 + legend_height)
}

/// Arrangement of the panels.
struct Grid {
    rows: usize,
    columns: usize,
}

impl Grid {
    fn of(figure: &Figure) -> Self {
        let count = figure.panels.len().max(1);
        let columns = count.min(MAX_COLUMNS);
        Self { rows: count.div_ceil(columns), columns }
    }
}

/// Series of the legend, in rows that fit the width of the picture.
fn legend_rows(figure: &Figure) -> Vec<Vec<&Series>> {
    let room = PANEL_WIDTH as usize * Grid::of(figure).columns - 40;
    let mut rows: Vec<Vec<&Series>> = Vec::new();
    let mut seen: Vec<&str> = vec![""];
    let mut used = usize::MAX;
    for series in figure.panels.iter().flat_map(|p| &p.series) {
        if seen.contains(&series.name.as_str()) {
            continue;
        }
        seen.push(&series.name);
        let width = entry_width(&series.name);
        if used.saturating_add(width) > room {
            rows.push(Vec::new());
            used = 0;
        }
        used += width;
        if let Some(row) = rows.last_mut() {
            row.push(series);
        }
    }
    rows
}

/// Width of a legend entry, mark and space included [SVG pixels].
fn entry_width(name: &str) -> usize {
    7 * name.chars().count() + 52
}

type Area<B> = DrawingArea<B, plotters::coord::Shift>;

fn draw_error(error: impl std::fmt::Display) -> Error {
    Error::input("chart", "", format!("cannot be drawn: {error}"), "")
}

/// Style of text of `size` SVG pixels; plotters draws 1 / 1.24 of the size it is given.
fn text_style(size: u32, scale: u32) -> TextStyle<'static> {
    ("sans-serif", 1.24 * f64::from(size * scale)).into_text_style(&(1, 1)).color(&INK)
}

fn draw<B: DrawingBackend>(root: Area<B>, figure: &Figure, scale: u32) -> Result<()> {
    let scaled = |n: u32| (n * scale) as i32;
    root.fill(&WHITE).map_err(draw_error)?;
    let middle = root.dim_in_pixel().0 as i32 / 2;
    let title = text_style(17, scale).pos(Pos::new(HPos::Center, VPos::Top));
    root.draw(&Text::new(figure.title.clone(), (middle, scaled(10)), title)).map_err(draw_error)?;
    let mut top = LEGEND_TOP;
    for row in legend_rows(figure) {
        let width: usize = row.iter().map(|s| entry_width(&s.name)).sum();
        let mut left = middle - scaled(width as u32 / 2);
        for series in row {
            draw_entry(&root, series, (left, scaled(top + 7)), scale)?;
            left += scaled(entry_width(&series.name) as u32);
        }
        top += LEGEND_ROW_HEIGHT;
    }
    let (_, body) = root.split_vertically(scaled(top));
    let Grid { rows, columns } = Grid::of(figure);
    for (area, panel) in body.split_evenly((rows, columns)).iter().zip(&figure.panels) {
        draw_panel(area, panel, scale)?;
    }
    root.present().map_err(draw_error)
}

/// Draws one entry of the legend, from its left end.
fn draw_entry<B: DrawingBackend>(
    root: &Area<B>,
    series: &Series,
    (left, middle): (i32, i32),
    scale: u32,
) -> Result<()> {
    let right = |fraction: f64| left + (26.0 * fraction * f64::from(scale)) as i32;
    let points = match series.mark {
        Mark::Line | Mark::Dashed | Mark::Bars => vec![[0.0, 0.0], [1.0, 0.0]],
        Mark::Dots | Mark::Rings | Mark::Crosses => vec![[0.7, 0.0]],
    };
    let at = |p: [f64; 2]| (right(p[0]), middle);
    draw_series(&Series { points, ..series.clone() }, scale, &at, &mut |primitive| primitive.draw_on(root))?;
    let text = text_style(13, scale).pos(Pos::new(HPos::Left, VPos::Center));
    root.draw(&Text::new(series.name.clone(), (right(1.3), middle), text)).map_err(draw_error)
}

fn draw_panel<B: DrawingBackend>(area: &Area<B>, panel: &Panel, scale: u32) -> Result<()> {
    let x = Ticks::of(&panel.x, panel.series.iter().flat_map(|s| s.points.iter().map(|p| p[0])));
    let y = Ticks::of(&panel.y, panel.series.iter().flat_map(|s| s.points.iter().map(|p| p[1])));
    let longest = y.labels.iter().map(|l| l.chars().count()).max().unwrap_or(0) as u32;
    let mut chart = ChartBuilder::on(area)
        .caption(&panel.title, text_style(14, scale))
        .margin(10 * scale)
        .margin_right(24 * scale)
        .x_label_area_size(46 * scale)
        .y_label_area_size((36 + 7 * longest) * scale)
        .build_cartesian_2d(x.clone(), y.clone())
        .map_err(draw_error)?;
    chart
        .configure_mesh()
        .x_desc(&panel.x.label)
        .y_desc(&panel.y.label)
        .axis_desc_style(text_style(14, scale))
        .label_style(text_style(12, scale))
        .light_line_style(TRANSPARENT)
        .bold_line_style(RGBColor(225, 225, 225).stroke_width(scale))
        .axis_style(INK.stroke_width(scale))
        .draw()
        .map_err(draw_error)?;
    let plane = chart.plotting_area();
    let pixels = plane.strip_coord_spec();
    let (left, top) = plane.get_base_pixel();
    let at = |p: [f64; 2]| {
        let (x, y) = plane.map_coordinate(&(p[0], p[1]));
        (x - left, y - top)
    };
    // Not every point has a place: a logarithm may be that of zero.
    let on_axes = |p: &[f64; 2]| {
        let p = [x.coordinate(p[0]), y.coordinate(p[1])];
        (p[0].is_finite() && p[1].is_finite()).then_some(p)
    };
    for series in &panel.series {
        let points = series.points.iter().filter_map(on_axes).collect();
        draw_series(&Series { points, ..series.clone() }, scale, &at, &mut |primitive| {
            primitive.draw_on(&pixels)
        })?;
    }
    let (width, height) = pixels.dim_in_pixel();
    let mut places =
        LabelPlaces { size: (width as i32, height as i32), scale: scale as i32, taken: Vec::new() };
    for series in &panel.series {
        for (p, label) in series.points.iter().zip(&series.labels) {
            if let Some(p) = on_axes(p) {
                let text = text_style(11, scale).pos(Pos::new(HPos::Left, VPos::Top));
                let corner = places.take(at(p), label);
                pixels.draw(&Text::new(label.clone(), corner, text)).map_err(draw_error)?;
            }
        }
    }
    Ok(())
}

/// Places of texts beside points, so that none covers another [pixels].
struct LabelPlaces {
    /// Width and height of the area.
    size: (i32, i32),
    /// Pixels per unit of length in texts and marks.
    scale: i32,
    /// Left, upper, right and lower sides of the texts so far.
    taken: Vec<[i32; 4]>,
}

impl LabelPlaces {
    /// Takes a place beside the point at `(x, y)` and returns its upper left corner: below or above it, to the right or left, the first that is
    /// free and inside the area; below to the right where none is.
    fn take(&mut self, (x, y): (i32, i32), label: &str) -> (i32, i32) {
        // A letter of 11 units is about 7 wide.
        let count = label.chars().count() as i32;
        let (away, width, height) = (6 * self.scale, 7 * self.scale * count, 14 * self.scale);
        let place = |left: bool, above: bool| {
            let left = if left { x - away - width } else { x + away };
            let upper = if above { y - height } else { y };
            [left, upper, left + width, upper + height]
        };
        let is_free = |[left, upper, right, lower]: &[i32; 4]| {
            let inside = *left >= 0 && *upper >= 0 && *right <= self.size.0 && *lower <= self.size.1;
            let apart = |other: &[i32; 4]| {
                *left >= other[2] || other[0] >= *right || *upper >= other[3] || other[1] >= *lower
            };
            inside && self.taken.iter().all(apart)
        };
        let places = [(false, false), (false, true), (true, false), (true, true)];
        let found = places.map(|(left, above)| place(left, above)).into_iter().find(is_free);
        let chosen = found.unwrap_or_else(|| place(false, false));
        self.taken.push(chosen);
        (chosen[0], chosen[1])
    }
}

/// Primitive of a series [pixels].
enum Primitive {
    Path(Vec<(i32, i32)>, ShapeStyle),
    Dashes(Vec<(i32, i32)>, ShapeStyle, i32),
    Disc((i32, i32), i32, ShapeStyle),
    Cross((i32, i32), i32, ShapeStyle),
}

impl Primitive {
    fn draw_on<B: DrawingBackend>(self, area: &Area<B>) -> Result<()> {
        match self {
            Self::Path(points, style) => area.draw(&PathElement::new(points, style)).map_err(draw_error),
            Self::Dashes(points, style, dash) => {
                area.draw(&DashedPathElement::new(points, dash, dash, style)).map_err(draw_error)
            }
            Self::Disc(at, radius, style) => area.draw(&Circle::new(at, radius, style)).map_err(draw_error),
            Self::Cross(at, radius, style) => area.draw(&Cross::new(at, radius, style)).map_err(draw_error),
        }
    }
}

fn draw_series(
    series: &Series,
    scale: u32,
    at: &dyn Fn([f64; 2]) -> (i32, i32),
    draw: &mut dyn FnMut(Primitive) -> Result<()>,
) -> Result<()> {
    let colour = PALETTE[series.colour % PALETTE.len()];
    let pen = |width: u32| colour.stroke_width(width * scale);
    let size = scale as i32;
    let pixels: Vec<(i32, i32)> = series.points.iter().map(|p| at(*p)).collect();
    match series.mark {
        Mark::Line => draw(Primitive::Path(pixels, pen(2))),
        Mark::Dashed => draw(Primitive::Dashes(pixels, pen(1), 5 * size)),
        Mark::Bars => {
            pixels.chunks_exact(2).try_for_each(|ends| draw(Primitive::Path(ends.to_vec(), pen(9))))
        }
        Mark::Dots => {
            pixels.into_iter().try_for_each(|p| draw(Primitive::Disc(p, 4 * size, colour.filled())))
        }
        Mark::Rings => pixels.into_iter().try_for_each(|p| draw(Primitive::Disc(p, 6 * size, pen(2)))),
        Mark::Crosses => pixels.into_iter().try_for_each(|p| draw(Primitive::Cross(p, 5 * size, pen(2)))),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Axis;

    #[test]
    fn a_figure_renders_to_svg_and_png_also_without_data() {
        let panel = |points: Vec<[f64; 2]>| Panel {
            title: "panel".into(),
            x: Axis::log("time [s]"),
            y: Axis::linear("angle [deg]"),
            series: [Mark::Line, Mark::Dashed, Mark::Dots, Mark::Rings, Mark::Crosses, Mark::Bars]
                .into_iter()
                .map(|mark| Series::new("series", 0, mark, points.clone()))
                .map(|series| series.with_labels(vec!["beside".into(); points.len()]))
                .collect(),
        };
        let points = vec![[1.0, 2.0], [10.0, 3.0], [0.0, 1.0], [f64::NAN, 1.0]];
        let panels = vec![panel(points), panel(Vec::new())];
        let figure = Figure { title: "title".into(), panels };
        let text = svg(&figure).expect("draws");
        assert!(text.starts_with("<svg") && text.contains("time [s]") && text.contains("polyline"));
        // Of every series, beside the two points that have a place on the axes.
        assert_eq!(text.matches("beside").count(), 12);
        assert_eq!(png(&figure).expect("draws")[1..4], *b"PNG");
    }
}
