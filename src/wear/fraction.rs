//! Positions in scripts: fractions of the garment's bounding box.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// [x, y] in fractions 0..1 of the garment's bounding box as it lies or hangs, x to the right, y upward.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(transparent)]
pub struct Fraction2(#[schemars(inner(range(min = -10, max = 10)))] pub [f64; 2]);

impl Fraction2 {
    /// Distance from the left edge [widths].
    pub fn x(self) -> f64 {
        self.0[0]
    }

    /// Distance from the lower edge [heights].
    pub fn y(self) -> f64 {
        self.0[1]
    }
}
