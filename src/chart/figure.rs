//! What a picture shows, as plain data: panels with two axes, and series of points in them.

/// A picture.
#[derive(Debug, Clone, PartialEq)]
pub struct Figure {
    /// Over everything.
    pub title: String,
    /// Beside one another from the left, three in a row.
    pub panels: Vec<Panel>,
}

/// Two axes and what is drawn between them.
#[derive(Debug, Clone, PartialEq)]
pub struct Panel {
    /// Over the panel; may be empty.
    pub title: String,
    /// To the right.
    pub x: Axis,
    /// Upwards.
    pub y: Axis,
    /// In drawing order.
    pub series: Vec<Series>,
}

/// An axis.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Axis {
    /// What it shows, with the unit.
    pub label: String,
    /// Decades instead of equal steps; values of 0 and below are left out.
    pub logarithmic: bool,
    /// Names at 0, 1, 2, ... instead of numbers.
    pub names: Vec<String>,
    /// Ends of the axis; `None` for those of the data.
    pub range: Option<[f64; 2]>,
}

impl Axis {
    /// An axis with equal steps that ends where the data end.
    pub fn of(label: &str) -> Self {
        Self { label: label.to_owned(), ..Self::default() }
    }

    /// The same with decades.
    pub fn decades(label: &str) -> Self {
        Self { logarithmic: true, ..Self::of(label) }
    }

    /// The same from `low` to `high`.
    pub fn between(self, low: f64, high: f64) -> Self {
        Self { range: Some([low, high]), ..self }
    }
}

/// How a series is drawn.
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
    /// A cross at every point: what failed, or where something happened.
    Crosses,
    /// A thick bar from every even point to the next.
    Bars,
}

/// Points that belong together.
#[derive(Debug, Clone, PartialEq)]
pub struct Series {
    /// In the legend; series of the same name share an entry, an empty name has none.
    pub name: String,
    /// Number of its colour in the palette.
    pub colour: usize,
    /// How it is drawn.
    pub mark: Mark,
    /// In the units of the axes.
    pub points: Vec<[f64; 2]>,
}

impl Series {
    /// A series.
    pub fn new(name: &str, colour: usize, mark: Mark, points: Vec<[f64; 2]>) -> Self {
        Self { name: name.to_owned(), colour, mark, points }
    }
}
