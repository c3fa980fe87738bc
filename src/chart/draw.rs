//! Draws every figure, with plotters: once as SVG, once as PNG of twice the size.
//!
//! Colours are Okabe and Ito's, which colour-blind readers tell apart; series differ in mark as well where they cross.
//! Ticks are ours: 1, 2, 5 times a power of ten, decades, or names.

use crate::chart::raster::Canvas;
use crate::chart::{Axis, Figure, Mark, Panel, Series};
use crate::error::{Error, Result};
use crate::report::render::{Image, encode_png};
use plotters::coord::ranged1d::{KeyPointHint, NoDefaultFormatting, Ranged, ValueFormatter};
use plotters::element::DashedPathElement;
use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, Pos, VPos};
use std::ops::Range;

/// Okabe and Ito's colours, those with enough contrast on white first.
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
/// The grey of the palette, for what stands behind.
pub(super) const GREY: usize = 7;
/// The black of the palette, for what others measured.
pub(super) const BLACK: usize = 6;

/// Width of a panel and height of the picture, in SVG pixels.
const PANEL: [u32; 2] = [560, 460];
/// Pixels of the PNG per SVG pixel.
const PNG_SCALE: u32 = 2;
/// Top of the legend, below the title.
const LEGEND: u32 = 38;
/// Height of a row of the legend.
const ROW: u32 = 20;

/// The figure as SVG.
pub(super) fn svg(figure: &Figure) -> Result<String> {
    let mut text = String::new();
    draw(SVGBackend::with_string(&mut text, size(figure)).into_drawing_area(), figure, 1)?;
    Ok(text)
}

/// The figure as PNG.
pub(super) fn png(figure: &Figure) -> Result<Vec<u8>> {
    let (width, height) = size(figure);
    let side = |n: u32| (n * PNG_SCALE) as usize;
    let mut image = Image::filled(side(width), side(height), [255; 3]);
    draw(Canvas(&mut image).into_drawing_area(), figure, PNG_SCALE)?;
    encode_png(&image)
}

fn size(figure: &Figure) -> (u32, u32) {
    let [rows, columns] = grid(figure).map(|n| n as u32);
    (PANEL[0] * columns, PANEL[1] * rows + ROW * legend_rows(figure).len() as u32)
}

/// Rows and columns of panels: three panels stand beside one another at most.
fn grid(figure: &Figure) -> [usize; 2] {
    let count = figure.panels.len().max(1);
    let columns = count.min(3);
    [count.div_ceil(columns), columns]
}

/// Series of the legend, in rows that fit the width.
fn legend_rows(figure: &Figure) -> Vec<Vec<&Series>> {
    let room = PANEL[0] as usize * grid(figure)[1] - 40;
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

/// Width of a legend entry, mark and space included, in SVG pixels.
fn entry_width(name: &str) -> usize {
    7 * name.chars().count() + 52
}

type Area<B> = DrawingArea<B, plotters::coord::Shift>;

fn fault(error: impl std::fmt::Display) -> Error {
    Error::input("chart", "", format!("cannot be drawn: {error}"), "")
}

/// Text of `size` SVG pixels; plotters writes 1 / 1.24 of what it is told.
fn letters(size: u32, scale: u32) -> TextStyle<'static> {
    ("sans-serif", 1.24 * f64::from(size * scale)).into_text_style(&(1, 1)).color(&BLACK_INK)
}

const BLACK_INK: RGBColor = RGBColor(20, 20, 20);

fn draw<B: DrawingBackend>(root: Area<B>, figure: &Figure, scale: u32) -> Result<()> {
    let scaled = |n: u32| (n * scale) as i32;
    root.fill(&WHITE).map_err(fault)?;
    let middle = root.dim_in_pixel().0 as i32 / 2;
    let title = letters(17, scale).pos(Pos::new(HPos::Center, VPos::Top));
    root.draw(&Text::new(figure.title.clone(), (middle, scaled(10)), title)).map_err(fault)?;
    let mut top = LEGEND;
    for row in legend_rows(figure) {
        let width: usize = row.iter().map(|s| entry_width(&s.name)).sum();
        let mut left = middle - scaled(width as u32 / 2);
        for series in row {
            draw_entry(&root, series, (left, scaled(top + 7)), scale)?;
            left += scaled(entry_width(&series.name) as u32);
        }
        top += ROW;
    }
    let (_, body) = root.split_vertically(scaled(top));
    let [rows, columns] = grid(figure);
    for (area, panel) in body.split_evenly((rows, columns)).iter().zip(&figure.panels) {
        draw_panel(area, panel, scale)?;
    }
    root.present().map_err(fault)
}

/// One entry of the legend, from its left end.
fn draw_entry<B: DrawingBackend>(
    root: &Area<B>,
    series: &Series,
    (left, middle): (i32, i32),
    scale: u32,
) -> Result<()> {
    let right = |share: f64| left + (26.0 * share * f64::from(scale)) as i32;
    let points = match series.mark {
        Mark::Line | Mark::Dashed | Mark::Bars => vec![[0.0, 0.0], [1.0, 0.0]],
        Mark::Dots | Mark::Rings | Mark::Crosses => vec![[0.7, 0.0]],
    };
    let at = |p: [f64; 2]| (right(p[0]), middle);
    draw_series(&Series { points, ..series.clone() }, scale, &at, &mut |piece| piece.draw_on(root))?;
    let text = letters(13, scale).pos(Pos::new(HPos::Left, VPos::Center));
    root.draw(&Text::new(series.name.clone(), (right(1.3), middle), text)).map_err(fault)
}

fn draw_panel<B: DrawingBackend>(area: &Area<B>, panel: &Panel, scale: u32) -> Result<()> {
    let x = Ticks::of(&panel.x, panel.series.iter().flat_map(|s| s.points.iter().map(|p| p[0])));
    let y = Ticks::of(&panel.y, panel.series.iter().flat_map(|s| s.points.iter().map(|p| p[1])));
    let longest = y.labels.iter().map(|l| l.chars().count()).max().unwrap_or(0) as u32;
    let mut chart = ChartBuilder::on(area)
        .caption(&panel.title, letters(14, scale))
        .margin(10 * scale)
        .margin_right(24 * scale)
        .x_label_area_size(46 * scale)
        .y_label_area_size((36 + 7 * longest) * scale)
        .build_cartesian_2d(x.clone(), y.clone())
        .map_err(fault)?;
    chart
        .configure_mesh()
        .x_desc(&panel.x.label)
        .y_desc(&panel.y.label)
        .axis_desc_style(letters(14, scale))
        .label_style(letters(12, scale))
        .light_line_style(TRANSPARENT)
        .bold_line_style(RGBColor(225, 225, 225).stroke_width(scale))
        .axis_style(BLACK_INK.stroke_width(scale))
        .draw()
        .map_err(fault)?;
    let plane = chart.plotting_area();
    let pixels = plane.strip_coord_spec();
    let (left, top) = plane.get_base_pixel();
    let at = |p: [f64; 2]| {
        let (x, y) = plane.map_coordinate(&(p[0], p[1]));
        (x - left, y - top)
    };
    for series in &panel.series {
        let points = series.points.iter().map(|p| [x.place(p[0]), y.place(p[1])]);
        let points = points.filter(|p| p[0].is_finite() && p[1].is_finite()).collect();
        draw_series(&Series { points, ..series.clone() }, scale, &at, &mut |piece| piece.draw_on(&pixels))?;
    }
    Ok(())
}

/// One piece of a series, in pixels.
enum Piece {
    Path(Vec<(i32, i32)>, ShapeStyle),
    Dashes(Vec<(i32, i32)>, ShapeStyle, i32),
    Disc((i32, i32), i32, ShapeStyle),
    Cross((i32, i32), i32, ShapeStyle),
}

impl Piece {
    fn draw_on<B: DrawingBackend>(self, area: &Area<B>) -> Result<()> {
        match self {
            Self::Path(points, style) => area.draw(&PathElement::new(points, style)).map_err(fault),
            Self::Dashes(points, style, dash) => {
                area.draw(&DashedPathElement::new(points, dash, dash, style)).map_err(fault)
            }
            Self::Disc(at, radius, style) => area.draw(&Circle::new(at, radius, style)).map_err(fault),
            Self::Cross(at, radius, style) => area.draw(&Cross::new(at, radius, style)).map_err(fault),
        }
    }
}

fn draw_series(
    series: &Series,
    scale: u32,
    at: &dyn Fn([f64; 2]) -> (i32, i32),
    draw: &mut dyn FnMut(Piece) -> Result<()>,
) -> Result<()> {
    let colour = PALETTE[series.colour % PALETTE.len()];
    let pen = |width: u32| colour.stroke_width(width * scale);
    let size = scale as i32;
    let pixels: Vec<(i32, i32)> = series.points.iter().map(|p| at(*p)).collect();
    match series.mark {
        Mark::Line => draw(Piece::Path(pixels, pen(2))),
        Mark::Dashed => draw(Piece::Dashes(pixels, pen(1), 5 * size)),
        Mark::Bars => pixels.chunks_exact(2).try_for_each(|ends| draw(Piece::Path(ends.to_vec(), pen(9)))),
        Mark::Dots => pixels.into_iter().try_for_each(|p| draw(Piece::Disc(p, 4 * size, colour.filled()))),
        Mark::Rings => pixels.into_iter().try_for_each(|p| draw(Piece::Disc(p, 6 * size, pen(2)))),
        Mark::Crosses => pixels.into_iter().try_for_each(|p| draw(Piece::Cross(p, 5 * size, pen(2)))),
    }
}

/// An axis with its ends and ticks; coordinates are values, or their decimal logarithms.
#[derive(Debug, Clone)]
struct Ticks {
    range: Range<f64>,
    at: Vec<f64>,
    labels: Vec<String>,
    logarithmic: bool,
}

impl Ticks {
    fn of(axis: &Axis, values: impl Iterator<Item = f64>) -> Self {
        let place = |v: f64| if axis.logarithmic { v.log10() } else { v };
        let (low, high) = match axis.range {
            Some([low, high]) => (place(low), place(high)),
            None => {
                let ends = values.map(place).filter(|v| v.is_finite());
                let (low, high) =
                    ends.fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), v| (l.min(v), h.max(v)));
                let room = if high > low { 0.04 * (high - low) } else { 0.5 };
                if low <= high { (low - room, high + room) } else { (0.0, 1.0) }
            }
        };
        let (at, labels): (Vec<f64>, Vec<String>) = if !axis.names.is_empty() {
            axis.names.iter().enumerate().map(|(k, name)| (k as f64, name.clone())).unzip()
        } else if axis.logarithmic {
            decade_ticks(low, high)
        } else {
            even_ticks(low, high)
        };
        Self { range: low..high, at, labels, logarithmic: axis.logarithmic }
    }

    fn place(&self, value: f64) -> f64 {
        if self.logarithmic { value.log10() } else { value }
    }
}

/// Every step of 1, 2 or 5 times a power of ten, about six of them.
fn even_ticks(low: f64, high: f64) -> (Vec<f64>, Vec<String>) {
    let rough = ((high - low) / 6.0).max(f64::MIN_POSITIVE);
    let power = 10f64.powf(rough.log10().floor());
    let step = [1.0, 2.0, 5.0, 10.0].into_iter().map(|s| s * power).find(|s| *s >= rough).unwrap_or(power);
    let digits = (-step.log10().floor()).clamp(0.0, 12.0) as usize;
    let first = (low / step).ceil() as i64;
    let last = (high / step).floor() as i64;
    (first..=last.min(first + 20)).map(|k| k as f64 * step).map(|v| (v, format!("{v:.digits$}"))).unzip()
}

/// Powers of ten, and 2 and 5 times them where the axis is short; `low` and `high` are logarithms.
fn decade_ticks(low: f64, high: f64) -> (Vec<f64>, Vec<String>) {
    let factors: &[f64] = if high - low < 2.5 { &[1.0, 2.0, 5.0] } else { &[1.0] };
    let first = low.floor() as i32;
    let every = (((high - low) / 8.0).ceil() as usize).max(1);
    (first..=high.ceil() as i32)
        .step_by(every)
        .flat_map(|power| factors.iter().map(move |f| f * 10f64.powi(power)))
        .filter(|v| (low..=high).contains(&v.log10()))
        .map(|v| {
            let plain = (1e-3..1e5).contains(&v);
            (v.log10(), if plain { format!("{v}") } else { format!("1e{:.0}", v.log10()) })
        })
        .unzip()
}

impl Ranged for Ticks {
    type FormatOption = NoDefaultFormatting;
    type ValueType = f64;

    fn map(&self, value: &f64, limit: (i32, i32)) -> i32 {
        let share = (value - self.range.start) / (self.range.end - self.range.start);
        limit.0 + (share * f64::from(limit.1 - limit.0)).round() as i32
    }

    fn key_points<Hint: KeyPointHint>(&self, _hint: Hint) -> Vec<f64> {
        self.at.clone()
    }

    fn range(&self) -> Range<f64> {
        self.range.clone()
    }
}

impl ValueFormatter<f64> for Ticks {
    fn format_ext(&self, value: &f64) -> String {
        let nearest = self.at.iter().zip(&self.labels).find(|(at, _)| (*at - value).abs() < 1e-9);
        nearest.map_or_else(String::new, |(_, label)| label.clone())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ticks_are_round_numbers_within_the_axis() {
        assert_eq!(even_ticks(-0.3, 3.2).1, ["0", "1", "2", "3"]);
        assert_eq!(even_ticks(0.0, 0.55).1, ["0.0", "0.1", "0.2", "0.3", "0.4", "0.5"]);
        assert_eq!(even_ticks(0.0, 180.0).0.len(), 4);
        assert_eq!(decade_ticks(0.0, 4.0).1, ["1", "10", "100", "1000", "10000"]);
        assert_eq!(decade_ticks(-0.1, 1.1).1, ["1", "2", "5", "10"]);
    }

    #[test]
    fn a_figure_becomes_both_pictures_and_empty_data_do_no_harm() {
        let panel = |points: Vec<[f64; 2]>| Panel {
            title: "panel".into(),
            x: Axis::decades("time [s]"),
            y: Axis::of("angle [deg]"),
            series: [Mark::Line, Mark::Dashed, Mark::Dots, Mark::Rings, Mark::Crosses, Mark::Bars]
                .into_iter()
                .map(|mark| Series::new("series", 0, mark, points.clone()))
                .collect(),
        };
        let points = vec![[1.0, 2.0], [10.0, 3.0], [0.0, 1.0], [f64::NAN, 1.0]];
        let panels = vec![panel(points), panel(Vec::new())];
        let figure = Figure { title: "title".into(), panels };
        let text = svg(&figure).expect("draws");
        assert!(text.starts_with("<svg") && text.contains("time [s]") && text.contains("polyline"));
        assert_eq!(png(&figure).expect("draws")[1..4], *b"PNG");
    }
}
