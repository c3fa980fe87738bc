//! `iron`: hot moist cloth is flattened under a soleplate. Where it lies open it loses its memory, where it is folded it keeps
//! the fold.

use crate::wear::action_runner::{ActionContext, ActionRunner, ActionStart, NeededPlace};
use crate::wear::fraction::Fraction2;
use crate::wear::layout::fold_layout::FoldLayout;
use crate::wear::motion::motion_profile::smoothstep;
use crate::wear::persistent_state::{GarmentFrame, PersistentState};
use crate::wear::tuning::TUNING;
use crate::wear::wear_action::{FieldError, WearAction};
use crease_geometry::math::Vec3;
use crease_model::error::Result;
use crease_solver::memory::Softening;
use crease_solver::sim::Loads;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use serde_json::Value;

/// Iron the garment as it lies: all of it, a box, or a strip along a line, through all layers that lie there. Cloth that lies open
/// loses its memory; a fold that lies there is set.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Iron {
    /// Two opposite corners of the box that is ironed, [x, y] in fractions 0..1 of the bounding box. Not together with `line`.
    #[serde(rename = "box", default, skip_serializing_if = "Option::is_none")]
    pub area: Option<[Fraction2; 2]>,
    /// Two ends of a line, [x, y] in fractions 0..1 of the bounding box, along which a soleplate of 100 mm width is moved.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub line: Option<[Fraction2; 2]>,
    /// Pressure of the soleplate [Pa]. Default 4000, an iron that is pushed.
    #[serde(rename = "pressure", default = "default_pressure_pa")]
    #[schemars(extend("exclusiveMinimum" = 0), range(max = 1_000_000))]
    pub pressure_pa: f64,
    /// Time that it rests on every part of the area [s]. Default 10.
    #[serde(rename = "for", default = "default_for_s")]
    #[schemars(extend("exclusiveMinimum" = 0), range(max = 3600))]
    pub for_s: f64,
}

fn default_pressure_pa() -> f64 {
    4000.0
}

fn default_for_s() -> f64 {
    10.0
}

impl Iron {
    /// Whether the point `p` [m] of a garment with the frame `frame` is ironed.
    fn covers(&self, p: &Vec3, frame: &GarmentFrame) -> bool {
        let within = |value: f64, a: f64, b: f64| value >= a.min(b) && value <= a.max(b);
        if let Some([a, b]) = self.area {
            let [x, y] = frame.fraction(p);
            return within(x, a.x(), b.x()) && within(y, a.y(), b.y());
        }
        let Some(line) = self.line else { return true };
        let [a, b] = line.map(|end| frame.position(end.0));
        let level = |v: Vec3| Vec3::new(v.x, 0.0, v.z);
        let (along, arm) = (level(b - a), level(p - a));
        let t = (arm.dot(&along) / along.norm_squared().max(f64::MIN_POSITIVE)).clamp(0.0, 1.0);
        (arm - along * t).norm() <= TUNING.iron.half_width
    }
}

impl WearAction for Iron {
    fn duration(&self) -> f64 {
        self.for_s
    }

    fn validate(&self) -> Vec<FieldError> {
        let is_empty = |[a, b]: [Fraction2; 2]| a.x() == b.x() || a.y() == b.y();
        let is_point = |[a, b]: [Fraction2; 2]| a == b;
        let error = |field, message, help| vec![FieldError::new(field, message, help)];
        match (self.area, self.line) {
            (Some(_), Some(_)) => {
                error("line", "`box` and `line` do not go together", "keep one of them, or iron twice")
            }
            (Some(area), None) if is_empty(area) => {
                error("box", "the box has no area", "give two opposite corners")
            }
            (None, Some(line)) if is_point(line) => error(
                "line",
                "the two ends of the line are the same",
                "give two points apart from each other",
            ),
            _ => Vec::new(),
        }
    }

    /// Marks nothing: it sets only what is folded already.
    fn predict_creases(&self, layout: &mut FoldLayout) {
        layout.require_flat();
    }

    fn start_action(&self, context: &ActionContext, persistent: &mut PersistentState) -> Result<ActionStart> {
        let Some(frame) = persistent.ground_frame() else {
            return Err(context.refuse_place("iron", NeededPlace::Lying));
        };
        let ironed: Vec<bool> = context.positions.iter().map(|p| self.covers(p, &frame)).collect();
        if !ironed.contains(&true) {
            return Err(context.refuse(
                "nothing lies where it is ironed",
                "move the box or the line: fractions of the box of the garment run from 0 to 1, x to the right, y upward",
            ));
        }
        let tuning = TUNING.iron;
        ActionStart::here(IronRunner {
            pressure: self.pressure_pa,
            ramp_time: TUNING.other.press_ramp_time.min(0.5 * self.for_s),
            softening: Softening { points: ironed, rate: tuning.setting_rate, set_fraction: 1.0 },
            idle_loads: persistent.idle_loads(),
        })
    }

    fn example() -> Self {
        Self {
            area: None,
            line: Some([Fraction2([0.2, 0.1]), Fraction2([0.3, 0.9])]),
            pressure_pa: 3000.0,
            for_s: 8.0,
        }
    }
}

/// A hot soleplate on a part of the garment.
struct IronRunner {
    /// [Pa].
    pressure: f64,
    /// Time in which it rises [s].
    ramp_time: f64,
    /// What its heat does, with the points under it.
    softening: Softening,
    idle_loads: Loads,
}

impl ActionRunner for IronRunner {
    fn loads_at(&mut self, t: f64, _x: &[Vec3]) -> Loads {
        let rises = t <= self.ramp_time * (1.0 + 1e-9);
        Loads {
            pressure: self.pressure * smoothstep(t / self.ramp_time),
            pressed: self.softening.points.clone(),
            max_dt: if rises {
                self.ramp_time / TUNING.other.press_ramp_steps
            } else {
                TUNING.iron.max_set_per_step / self.softening.rate
            },
            ..self.idle_loads.clone()
        }
    }

    /// Cloth is soft once the soleplate is on it.
    fn softening(&self, t: f64) -> Option<&Softening> {
        (t > self.ramp_time).then_some(&self.softening)
    }

    fn event_times(&self) -> Vec<f64> {
        vec![self.ramp_time]
    }

    fn save_state(&self) -> Option<Value> {
        Some(Value::Null)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_box_a_strip_and_all_of_a_garment_are_ironed() {
        let x = [Vec3::zeros(), Vec3::new(1.0, 0.0, -2.0)];
        let frame = GarmentFrame::lying(&x);
        let whole = Iron { line: None, ..Iron::example() };
        let corners = [Fraction2([0.5, 1.0]), Fraction2([0.0, 0.5])];
        let part = Iron { area: Some(corners), ..whole.clone() };
        let strip = Iron { line: Some([Fraction2([0.5, 0.0]), Fraction2([0.5, 0.5])]), ..whole.clone() };
        for (at, expected) in [
            ([0.25, -1.5], [true, false]),
            ([0.25, -0.5], [false, false]),
            ([0.52, -0.5], [false, true]),
            ([0.52, -1.02], [false, true]),
            ([0.52, -1.5], [false, false]),
            ([0.44, -0.5], [false, false]),
        ] {
            let p = Vec3::new(at[0], 0.01, at[1]);
            assert!(whole.covers(&p, &frame));
            assert_eq!([&part, &strip].map(|iron| iron.covers(&p, &frame)), expected, "{at:?}");
        }
    }
}
