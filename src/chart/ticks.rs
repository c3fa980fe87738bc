//! Ticks of an axis: 1, 2, 5 times a power of ten, decades, or names.

use crate::Axis;
use plotters::coord::ranged1d::{KeyPointHint, NoDefaultFormatting, Ranged, ValueFormatter};
use std::ops::Range;

/// Ends and ticks of an axis; coordinates are values, or their decimal logarithms.
#[derive(Debug, Clone)]
pub(super) struct Ticks {
    range: Range<f64>,
    at: Vec<f64>,
    pub(super) labels: Vec<String>,
    logarithmic: bool,
}

impl Ticks {
    /// Ticks of `axis` for a series of `values`.
    pub(super) fn of(axis: &Axis, values: impl Iterator<Item = f64>) -> Self {
        let coordinate = |v: f64| if axis.logarithmic { v.log10() } else { v };
        let (low, high) = match axis.range {
            Some([low, high]) => (coordinate(low), coordinate(high)),
            None => {
                let ends = values.map(coordinate).filter(|v| v.is_finite());
                let (low, high) =
                    ends.fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), v| (l.min(v), h.max(v)));
                let margin = if high > low { 0.04 * (high - low) } else { 0.5 };
                if low <= high { (low - margin, high + margin) } else { (0.0, 1.0) }
            }
        };
        let (at, labels): (Vec<f64>, Vec<String>) = if !axis.names.is_empty() {
            axis.names.iter().enumerate().map(|(k, name)| (k as f64, name.clone())).unzip()
        } else if axis.logarithmic {
            log_ticks(low, high)
        } else {
            linear_ticks(low, high)
        };
        Self { range: low..high, at, labels, logarithmic: axis.logarithmic }
    }

    /// Coordinate of a value.
    pub(super) fn coordinate(&self, value: f64) -> f64 {
        if self.logarithmic { value.log10() } else { value }
    }
}

/// Multiples of 1, 2 or 5 times a power of ten, about six of them.
fn linear_ticks(low: f64, high: f64) -> (Vec<f64>, Vec<String>) {
    let rough = ((high - low) / 6.0).max(f64::MIN_POSITIVE);
    let power = 10f64.powf(rough.log10().floor());
    let step = [1.0, 2.0, 5.0, 10.0].into_iter().map(|s| s * power).find(|s| *s >= rough).unwrap_or(power);
    let digits = (-step.log10().floor()).clamp(0.0, 12.0) as usize;
    let first = (low / step).ceil() as i64;
    let last = (high / step).floor() as i64;
    (first..=last.min(first + 20)).map(|k| k as f64 * step).map(|v| (v, format!("{v:.digits$}"))).unzip()
}

/// Powers of ten, and 2 and 5 times them where the axis is short; `low` and `high` are logarithms.
fn log_ticks(low: f64, high: f64) -> (Vec<f64>, Vec<String>) {
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
        let fraction = (value - self.range.start) / (self.range.end - self.range.start);
        limit.0 + (fraction * f64::from(limit.1 - limit.0)).round() as i32
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
        assert_eq!(linear_ticks(-0.3, 3.2).1, ["0", "1", "2", "3"]);
        assert_eq!(linear_ticks(0.0, 0.55).1, ["0.0", "0.1", "0.2", "0.3", "0.4", "0.5"]);
        assert_eq!(linear_ticks(0.0, 180.0).0.len(), 4);
        assert_eq!(log_ticks(0.0, 4.0).1, ["1", "10", "100", "1000", "10000"]);
        assert_eq!(log_ticks(-0.1, 1.1).1, ["1", "2", "5", "10"]);
    }
}
