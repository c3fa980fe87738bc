//! `lay`: the garment is laid flat on the ground, layers in order, none crossing.

use super::WearAction;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Lay the garment flat on the ground, layers in order, none crossing. Later positions count in its bounding box as
/// it then lies: x from 0 at the left to 1 at the right, y from 0 at the lower edge (hem) to 1 at the upper (neck).
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Lay {
    /// Which side of the garment, as the file has it, looks up once it lies. Default front.
    #[serde(default)]
    pub facing: Facing,
    /// How long laying takes [s]. Default 2.
    #[serde(rename = "over", default = "over_s")]
    #[schemars(extend("exclusiveMinimum" = 0), range(max = 3600))]
    pub over_s: f64,
}

/// A side of the garment in its own pose, y up, front toward +z.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Facing {
    /// The front (+z) looks up.
    #[default]
    Front,
    /// The back (-z) looks up.
    Back,
    /// The wearer's left side (+x) looks up.
    Left,
    /// The wearer's right side (-x) looks up.
    Right,
    /// What is up in the file (+y) stays up: for cloth that lies flat already.
    Up,
    /// What is down in the file (-y) looks up.
    Down,
}

fn over_s() -> f64 {
    2.0
}

impl WearAction for Lay {
    fn duration_s(&self) -> f64 {
        self.over_s
    }

    fn example() -> Self {
        Self { facing: Facing::Back, over_s: 1.5 }
    }
}
