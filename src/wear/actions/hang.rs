//! `hang`: the garment is hung up.

use super::{Fraction2, WearAction};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Hang the garment up by its top or by chosen points, and let it hang.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Hang {
    /// What it hangs by. Default top.
    #[serde(default)]
    pub by: HangBy,
    /// For how long [s]. Default 5.
    #[serde(rename = "for", default = "for_s")]
    #[schemars(extend("exclusiveMinimum" = 0), range(max = 86400))]
    pub for_s: f64,
}

/// What a garment hangs by.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(untagged)]
pub enum HangBy {
    /// A named place.
    Place(HangPlace),
    /// The points nearest to these, [x, y] in fractions 0..1 of the bounding box.
    Points(#[schemars(length(min = 1, max = 1000))] Vec<Fraction2>),
}

/// A named place to hang a garment by.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum HangPlace {
    /// Its highest points, as on a hook or a line.
    Top,
}

impl Default for HangBy {
    fn default() -> Self {
        Self::Place(HangPlace::Top)
    }
}

fn for_s() -> f64 {
    5.0
}

impl WearAction for Hang {
    fn duration_s(&self) -> f64 {
        self.for_s
    }

    fn example() -> Self {
        Self { by: HangBy::Points(vec![Fraction2([0.1, 1.0]), Fraction2([0.9, 1.0])]), for_s: 8.0 }
    }
}
