//! `settle`: what hands hold on the ground is released; gravity, friction and memory act alone.

use crate::wear::action_runner::{ActionContext, ActionStart, ConstantLoads};
use crate::wear::layout::fold_layout::FoldLayout;
use crate::wear::persistent_state::PersistentState;
use crate::wear::tuning::TUNING;
use crate::wear::wear_action::WearAction;
use crease_model::error::Result;
use crease_solver::sim::Loads;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Let go of what is held on the ground (folds, rolls, presses, a ball) and let the cloth come to rest. What is held in the air stays
/// held.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Settle {
    /// Largest duration [s]. Default 3.
    #[serde(rename = "for", default = "default_for_s")]
    #[schemars(extend("exclusiveMinimum" = 0), range(max = 3600))]
    pub for_s: f64,
}

fn default_for_s() -> f64 {
    3.0
}

impl WearAction for Settle {
    fn duration(&self) -> f64 {
        self.for_s
    }

    /// Marks nothing: it creases only what is folded already.
    fn predict_creases(&self, layout: &mut FoldLayout) {
        layout.require_flat();
    }

    fn start_action(
        &self,
        _context: &ActionContext,
        persistent: &mut PersistentState,
    ) -> Result<ActionStart> {
        if persistent.ground.is_some() {
            persistent.held_loads = None;
        }
        let loads = Loads { drag: TUNING.other.settle_drag, ..persistent.folded_loads() };
        ActionStart::here(ConstantLoads { loads, may_end_early: true })
    }

    fn example() -> Self {
        Self { for_s: 2.0 }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::wear::motion::springs::pin_spring;
    use crease_geometry::math::Vec3;

    /// Springs that act while a garment settles that is held by one, on the ground or above none.
    fn springs_left(ground: Option<f64>) -> usize {
        let held = Loads { springs: vec![pin_spring(0, Vec3::y(), 1e-3)], ..Loads::gravity_only(ground) };
        let mut persistent = PersistentState { ground, held_loads: Some(held), ..PersistentState::default() };
        let context = ActionContext {
            positions: &[Vec3::y()],
            source_positions: &[Vec3::y()],
            triangles: &[],
            masses: &[1e-3],
            thickness: 1e-3,
            script_file: "w.json",
            location: "0",
        };
        let mut started = Settle::example().start_action(&context, &mut persistent).expect("settles").runner;
        started.loads_at(1.0, &[Vec3::y()]).springs.len()
    }

    #[test]
    fn what_is_held_on_the_ground_is_released_and_what_hangs_stays() {
        assert_eq!([Some(0.0), None].map(springs_left), [0, 1]);
    }
}
