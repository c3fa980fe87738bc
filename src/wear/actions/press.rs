//! `press`: weight or an iron, straight down.

use crate::wear::action_runner::{ActionContext, ActionRunner, ActionStart, NeededPlace};
use crate::wear::layout::fold_layout::FoldLayout;
use crate::wear::motion::motion_profile::smoothstep;
use crate::wear::persistent_state::PersistentState;
use crate::wear::tuning::TUNING;
use crate::wear::wear_action::WearAction;
use crease_geometry::math::Vec3;
use crease_model::error::Result;
use crease_solver::sim::Loads;
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
    /// Duration [s].
    #[serde(rename = "for")]
    #[schemars(extend("exclusiveMinimum" = 0), range(max = 86400))]
    pub for_s: f64,
}

impl WearAction for Press {
    fn duration(&self) -> f64 {
        self.for_s
    }

    fn predict_creases(&self, layout: &mut FoldLayout) {
        layout.require_flat();
    }

    fn start_action(&self, context: &ActionContext, persistent: &mut PersistentState) -> Result<ActionStart> {
        if persistent.ground.is_none() {
            return Err(context.refuse_place("press", NeededPlace::OnGround));
        }
        ActionStart::here(PressRunner {
            pressure: self.pressure_pa,
            ramp_time: TUNING.other.press_ramp_time.min(0.5 * self.for_s),
            idle_loads: persistent.folded_loads(),
        })
    }

    fn example() -> Self {
        Self { pressure_pa: 200.0, for_s: 30.0 }
    }
}

/// A pressure on the cloth.
struct PressRunner {
    /// [Pa].
    pressure: f64,
    /// Time in which it rises [s].
    ramp_time: f64,
    idle_loads: Loads,
}

impl ActionRunner for PressRunner {
    fn loads_at(&mut self, t: f64, _x: &[Vec3]) -> Loads {
        let rises = t <= self.ramp_time * (1.0 + 1e-9);
        Loads {
            pressure: self.pressure * smoothstep(t / self.ramp_time),
            max_dt: if rises { self.ramp_time / TUNING.other.press_ramp_steps } else { f64::INFINITY },
            ..self.idle_loads.clone()
        }
    }

    fn event_times(&self) -> Vec<f64> {
        vec![self.ramp_time]
    }

    fn save_state(&self) -> Option<Value> {
        Some(Value::Null)
    }
}
