//! `crumple`: the garment is squeezed into a ball, as in a fist or a full suitcase.

use crate::wear::action_runner::{ActionContext, ActionFailure, ActionRunner, ActionStart};
use crate::wear::imperfection::{imperfection_note, off_the_plane};
use crate::wear::motion::motion_profile::smoothstep;
use crate::wear::persistent_state::PersistentState;
use crate::wear::tuning::TUNING;
use crate::wear::wear_action::WearAction;
use crease_geometry::math::{Vec3, bounds};
use crease_model::error::Result;
use crease_solver::memory::Softening;
use crease_solver::sim::{Loads, SphereLoad};
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
    /// Duration of the squeeze [s]. Default 3.
    #[serde(rename = "over", default = "default_over_s")]
    #[schemars(extend("exclusiveMinimum" = 0), range(max = 3600))]
    pub over_s: f64,
    /// Time that the ball is held afterwards [s]. Default 0.
    #[serde(rename = "hold", default)]
    #[schemars(range(min = 0, max = 86400))]
    pub hold_s: f64,
    /// Whether the cloth is wet: it gives up its memory and sets a part of the bend that it has in the ball. Default false.
    #[serde(default)]
    pub wet: bool,
}

fn default_over_s() -> f64 {
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
        // The closed ball hovers over the ground, as if held.
        let clearance = TUNING.other.sphere_clearance;
        centre.y = persistent.ground.map_or(centre.y, |ground| ground + last_radius + clearance);
        let first_radius = context.positions.iter().map(|p| (p - centre).norm()).fold(last_radius, f64::max);
        persistent.turns.clear();
        persistent.body = None;
        persistent.laid_bend.clear();
        persistent.held_loads = None;
        let ground = persistent.ground;
        // On the ground it is its weight that lets cloth leave its plane.
        let imperfect = if ground.is_none() { off_the_plane(context.positions) } else { None };
        let start = ActionStart::here(CrumpleRunner {
            centre,
            first_radius,
            last_radius,
            over: self.over_s,
            ground,
            wetness: self.wet.then(wet_cloth),
        })?;
        let note = imperfect.as_ref().map(|_| imperfection_note("crumple").into());
        Ok(ActionStart { start_positions: imperfect, note, ..start })
    }

    fn example() -> Self {
        Self { to: 0.25, over_s: 3.5, hold_s: 20.0, wet: true }
    }
}

/// A sphere that closes around the cloth and stays closed.
struct CrumpleRunner {
    /// [m].
    centre: Vec3,
    /// Radius at the start [m].
    first_radius: f64,
    /// Radius once closed [m].
    last_radius: f64,
    /// Duration of closing [s].
    over: f64,
    /// Height of the ground [m].
    ground: Option<f64>,
    /// What water does to the cloth.
    wetness: Option<Softening>,
}

/// Cloth that is wet through.
fn wet_cloth() -> Softening {
    let wet = TUNING.wet;
    Softening { points: Vec::new(), rate: wet.setting_rate, set_fraction: wet.set_fraction }
}

impl ActionRunner for CrumpleRunner {
    fn loads_at(&mut self, t: f64, _x: &[Vec3]) -> Loads {
        // Geometric: every step shortens all distances by the same factor.
        let radius =
            self.first_radius * (self.last_radius / self.first_radius).powf(smoothstep(t / self.over));
        let closing = t <= self.over * (1.0 + 1e-9);
        Loads {
            sphere: Some(SphereLoad { centre: self.centre, radius, pressure: TUNING.other.sphere_pressure }),
            max_dt: if closing { TUNING.other.sphere_dt_fraction * self.over } else { f64::INFINITY },
            ..Loads::gravity_only(self.ground)
        }
    }

    fn event_times(&self) -> Vec<f64> {
        vec![self.over]
    }

    fn softening(&self, _t: f64) -> Option<&Softening> {
        self.wetness.as_ref()
    }

    fn failure(&self, x: &[Vec3]) -> Option<ActionFailure> {
        let radius = x.iter().map(|p| (p - self.centre).norm()).fold(0.0, f64::max);
        let closed = (self.first_radius - radius) / (self.first_radius - self.last_radius);
        (closed < TUNING.failure.min_crumpled_fraction).then(|| ActionFailure {
            message: format!(
                "the garment is not squeezed together: it reaches {:.0} mm from the middle of the ball, where {:.0} mm were asked for",
                1e3 * radius,
                1e3 * self.last_radius
            ),
            help: "squeeze it less (a larger `to`), more slowly (`over`), or choose a softer fabric".into(),
        })
    }

    fn save_state(&self) -> Option<Value> {
        Some(Value::Null)
    }

    fn finish(&mut self, persistent: &mut PersistentState, x: &[Vec3]) {
        persistent.held_loads = Some(self.loads_at(f64::INFINITY, x));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_garment_that_stays_out_of_the_ball_is_not_squeezed_together() {
        let (centre, first_radius, last_radius) = (Vec3::new(0.0, 1.0, 0.0), 0.5, 0.1);
        let runner =
            CrumpleRunner { centre, first_radius, last_radius, over: 1.0, ground: None, wetness: None };
        let points = |reach: f64| [0.0, 0.1, reach].map(|x| centre + Vec3::x() * x);
        assert_eq!(runner.failure(&points(0.12)), None);
        let failure = runner.failure(&points(0.45)).expect("it is not squeezed");
        assert!(failure.message.contains("reaches 450 mm from the middle of the ball, where 100 mm"));
    }
}
