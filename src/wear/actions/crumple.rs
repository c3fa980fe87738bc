//! `crumple`: the garment is squeezed into a ball, as in a fist or a full suitcase.

use super::WearAction;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Squeeze the garment into a ball.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Crumple {
    /// Diameter of the ball as a fraction of the garment's largest extent.
    #[schemars(extend("exclusiveMinimum" = 0), extend("exclusiveMaximum" = 1))]
    pub to: f64,
    /// How long squeezing takes [s]. Default 3.
    #[serde(rename = "over", default = "over_s")]
    #[schemars(extend("exclusiveMinimum" = 0), range(max = 3600))]
    pub over_s: f64,
    /// How long it is held afterwards [s]. Default 0.
    #[serde(rename = "hold", default)]
    #[schemars(range(min = 0, max = 86400))]
    pub hold_s: f64,
}

fn over_s() -> f64 {
    3.0
}

impl WearAction for Crumple {
    fn duration_s(&self) -> f64 {
        self.over_s + self.hold_s
    }

    fn example() -> Self {
        Self { to: 0.25, over_s: 3.5, hold_s: 20.0 }
    }
}
