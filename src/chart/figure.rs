//! Pictures as plain data: panels with two axes, and series of points in them.

/// Index of grey in the palette, for backgrounds.
pub const GREY: usize = 7;
/// Index of black in the palette, for references of other origin.
pub const BLACK: usize = 6;

/// A picture.
#[derive(Debug, Clone, PartialEq)]
pub struct Figure {
    /// Title above all panels.
    pub title: String,
    /// Panels from left to right, three in a row.
    pub panels: Vec<Panel>,
}

/// Two axes and the series between them.
#[derive(Debug, Clone, PartialEq)]
pub struct Panel {
    /// Title above the panel; may be empty.
    pub title: String,
    /// Horizontal axis.
    pub x: Axis,
    /// Vertical axis.
    pub y: Axis,
    /// Series in drawing order.
    pub series: Vec<Series>,
}

/// An axis.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Axis {
    /// Quantity with its unit.
    pub label: String,
    /// Whether the scale is logarithmic; values of 0 and below are then left out.
    pub logarithmic: bool,
    /// Names at 0, 1, 2, ... instead of numbers.
    pub names: Vec<String>,
    /// Ends of the axis; `None` for those of the data.
    pub range: Option<[f64; 2]>,
}

impl Axis {
    /// An axis with a linear scale that ends where the data end.
    pub fn linear(label: &str) -> Self {
        Self { label: label.to_owned(), ..Self::default() }
    }

    /// An axis with a logarithmic scale that ends where the data end.
    pub fn log(label: &str) -> Self {
        Self { logarithmic: true, ..Self::linear(label) }
    }

    /// The same axis from `low` to `high`.
    #[must_use]
    pub fn between(self, low: f64, high: f64) -> Self {
        Self { range: Some([low, high]), ..self }
    }
}

/// Mark of a series.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Mark {
    /// A line through the points.
    Line,
    /// A thin dashed line through the points.
    Dashed,
    /// A dot at every point.
    Dots,
    /// A ring at every point.
    Rings,
    /// A cross at every point: failures and events.
    Crosses,
    /// A thick bar from every even point to the next.
    Bars,
}

/// Points with a common mark and colour.
#[derive(Debug, Clone, PartialEq)]
pub struct Series {
    /// Name in the legend; series of one name have a common entry, an empty name has none.
    pub name: String,
    /// Index of the colour in the palette.
    pub colour: usize,
    /// Mark of the points.
    pub mark: Mark,
    /// Points in the units of the axes.
    pub points: Vec<[f64; 2]>,
    /// Texts beside the points, one per point; empty for none.
    pub labels: Vec<String>,
}

impl Series {
    /// A series of `points`.
    pub fn new(name: &str, colour: usize, mark: Mark, points: Vec<[f64; 2]>) -> Self {
        Self { name: name.to_owned(), colour, mark, points, labels: Vec::new() }
    }

    /// The same series with a text beside every point.
    #[must_use]
    pub fn with_labels(self, labels: Vec<String>) -> Self {
        Self { labels, ..self }
    }
}
