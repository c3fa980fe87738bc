//! `press`: weight or an iron, straight down.

use crate::error::Result;
use crate::math::Vec3;
use crate::sim::Loads;
use crate::wear::action_runner::{ActionContext, ActionRunner, ActionStart, PersistentState, smoothstep};
use crate::wear::actions::WearAction;
use crate::wear::crease_prediction::FoldLayout;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use serde_json::Value;

/// Press straight down on the whole garment as it lies.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Press {
    /// Pressure on the upper side [Pa]: about 200 under a pile of shirts, 2,000 under a hand, 4,000 under a pushed iron.
    #[serde(rename = "pressure")]
    #[schemars(extend("exclusiveMinimum" = 0), range(max = 1_000_000))]
    pub pressure_pa: f64,
    /// For how long [s].
    #[serde(rename = "for")]
    #[schemars(extend("exclusiveMinimum" = 0), range(max = 86400))]
    pub for_s: f64,
}

impl WearAction for Press {
    fn duration(&self) -> f64 {
        self.for_s
    }

    /// Marks what lies on sides.
    fn sketch(&self, sketch: &mut FoldLayout) {
        sketch.press();
    }

    fn start_action(&self, context: &ActionContext, persistent: &mut PersistentState) -> Result<ActionStart> {
        if persistent.ground.is_none() {
            return Err(
                context.refuse("`press` needs a garment on the ground", "lay it first: {\"lay\": {}}")
            );
        }
        let laid_on = LAID_ON.min(0.5 * self.for_s);
        ActionStart::here(Weight { pressure: self.pressure_pa, laid_on, resting: persistent.idle_loads() })
    }

    fn example() -> Self {
        Self { pressure_pa: 200.0, for_s: 30.0 }
    }
}

/// Time in which a weight is laid on [s], or half of the press if that is shorter: dropped all at once it would throw whatever stands
/// up somewhere.
const LAID_ON: f64 = 0.4;
/// Steps in which it is, at least.
const STEPS: f64 = 4.0;

/// A weight that lies on the cloth.
struct Weight {
    /// [Pa].
    pressure: f64,
    /// [s].
    laid_on: f64,
    resting: Loads,
}

impl ActionRunner for Weight {
    fn loads_at(&mut self, t: f64, _x: &[Vec3]) -> Loads {
        let rises = t <= self.laid_on * (1.0 + 1e-9);
        Loads {
            pressure: self.pressure * smoothstep(t / self.laid_on),
            max_dt: if rises { self.laid_on / STEPS } else { f64::INFINITY },
            ..self.resting.clone()
        }
    }

    fn event_times(&self) -> Vec<f64> {
        vec![self.laid_on]
    }

    fn save_state(&self) -> Option<Value> {
        Some(Value::Null)
    }
}
