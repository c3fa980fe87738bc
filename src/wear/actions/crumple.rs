//! `crumple`: the garment is squeezed into a ball, as in a fist or a full suitcase.

use crate::error::Result;
use crate::math::{Vec3, bounds};
use crate::sim::{Loads, SphereLoad};
use crate::wear::action_runner::{ActionContext, ActionRunner, ActionStart, PersistentState, smoothstep};
use crate::wear::actions::WearAction;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use serde_json::Value;

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
    fn duration(&self) -> f64 {
        self.over_s + self.hold_s
    }

    fn start_action(&self, context: &ActionContext, persistent: &mut PersistentState) -> Result<ActionStart> {
        let (low, high) = bounds(context.positions);
        let last_radius = 0.5 * self.to * (high - low).max();
        let mut centre = (low + high) * 0.5;
        // The closed ball hovers over the ground: hands hold it.
        centre.y = persistent.ground.map_or(centre.y, |ground| ground + last_radius + CLEARANCE);
        let first_radius = context.positions.iter().map(|p| (p - centre).norm()).fold(last_radius, f64::max);
        persistent.folds.clear();
        persistent.body = None;
        persistent.held_loads = None;
        let ground = persistent.ground;
        ActionStart::here(Squeeze { centre, radii: [first_radius, last_radius], over: self.over_s, ground })
    }

    fn example() -> Self {
        Self { to: 0.25, over_s: 3.5, hold_s: 20.0 }
    }
}

/// Height of the closed ball over the ground [m].
const CLEARANCE: f64 = 0.02;
/// What hands press with on cloth outside the ball [Pa]: 320 N on a T-shirt's 0.8 m² at most. With half of it stiff balls stay up to a
/// fifth too large; with 1 kPa and above layers were pressed to nothing, and cloth stretched by half (docs/validation/contact.md).
const PRESSURE: f64 = 400.0;
/// Longest step while the ball closes, as a share of the time that takes.
const STEP_SHARE: f64 = 0.01;

/// A ball that closes around the cloth and stays closed.
struct Squeeze {
    centre: Vec3,
    /// At the start and at the end [m].
    radii: [f64; 2],
    over: f64,
    ground: Option<f64>,
}

impl ActionRunner for Squeeze {
    fn loads_at(&mut self, t: f64, _x: &[Vec3]) -> Loads {
        // Equal steps in the logarithm: every step shortens all ways by the same share.
        let radius = self.radii[0] * (self.radii[1] / self.radii[0]).powf(smoothstep(t / self.over));
        let closing = t <= self.over * (1.0 + 1e-9);
        Loads {
            sphere: Some(SphereLoad { centre: self.centre, radius, pressure: PRESSURE }),
            max_dt: if closing { STEP_SHARE * self.over } else { f64::INFINITY },
            ..Loads::gravity_only(self.ground)
        }
    }

    fn event_times(&self) -> Vec<f64> {
        vec![self.over]
    }

    fn save_state(&self) -> Option<Value> {
        Some(Value::Null)
    }

    fn finish(&mut self, persistent: &mut PersistentState, x: &[Vec3]) {
        persistent.held_loads = Some(self.loads_at(f64::INFINITY, x));
    }
}
