//! `release`: whatever is held is let go at once.

use super::WearAction;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Let go at once of everything that is held, hung, pressed or squeezed. Takes no time: a `settle` usually follows.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Release {}

impl WearAction for Release {
    fn duration_s(&self) -> f64 {
        0.0
    }

    fn example() -> Self {
        Self {}
    }
}
