//! `unfold`: folds are opened again, the last one first.

use crate::error::Result;
use crate::math::Vec3;
use crate::sim::Loads;
use crate::wear::action_runner::{
    ActionContext, ActionRunner, ActionStart, FoldRecord, PersistentState, carry_spring, smoothstep,
};
use crate::wear::actions::fold::{GRIP_WIDTH, MAX_TURN_PER_STEP};
use crate::wear::actions::{FieldError, WearAction};
use crate::wear::crease_prediction::FoldLayout;
use crate::wear::fold_map::{Axis, OnSheet};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use serde_json::{Value, json};

/// Open folds again, the last one first. Without `last`, all of them.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Unfold {
    /// Open every fold. May be left out; not together with `last`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub all: Option<bool>,
    /// How many folds to open, counted back from the latest.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = 1, max = 10000))]
    pub last: Option<u32>,
    /// How long opening them takes, all together [s]. Default 2.
    #[serde(rename = "over", default = "over_s")]
    #[schemars(extend("exclusiveMinimum" = 0), range(max = 3600))]
    pub over_s: f64,
}

fn over_s() -> f64 {
    2.0
}

impl WearAction for Unfold {
    /// All folds together take `over`: a script does not know how many there are.
    fn duration(&self) -> f64 {
        self.over_s
    }

    fn validate(&self) -> Vec<FieldError> {
        match (self.all, self.last) {
            (Some(true), Some(_)) => {
                vec![FieldError::new("last", "`all` and `last` do not go together", "keep one of them")]
            }
            (Some(false), None) => {
                vec![FieldError::new(
                    "all",
                    "`all` is false and `last` is missing",
                    "say how many folds with `last`",
                )]
            }
            _ => Vec::new(),
        }
    }

    /// Opens what was folded.
    fn sketch(&self, sketch: &mut FoldLayout) {
        sketch.unfold(self.last.map(|n| n as usize));
    }

    fn start_action(&self, context: &ActionContext, persistent: &mut PersistentState) -> Result<ActionStart> {
        let count = persistent.folds.len();
        if count == 0 {
            return Err(context.refuse("there is no fold to open", "fold first, or leave `unfold` out"));
        }
        let wanted = self.last.map_or(count, |n| n as usize);
        if wanted > count {
            let cure = format!("`last` may be at most {count} here");
            return Err(
                context.refuse(format!("{wanted} folds shall be opened and only {count} are made"), cure)
            );
        }
        persistent.held_loads = None;
        let mut folds = persistent.folds.split_off(count - wanted);
        folds.reverse();
        let each = self.over_s / folds.len() as f64;
        let resting = persistent.idle_loads();
        let (mass, thickness) = (context.masses.to_vec(), context.thickness);
        ActionStart::here(Open { folds, each, under_way: None, mass, thickness, resting })
    }

    fn example() -> Self {
        Self { all: None, last: Some(2), over_s: 1.5 }
    }
}

/// Share of points that may lie out of order when the height between flap and rest is chosen.
const STRAY: f64 = 0.02;

/// Folds that are opened one after the other, latest first.
struct Open {
    folds: Vec<FoldRecord>,
    /// Time for one fold [s].
    each: f64,
    under_way: Option<Opening>,
    mass: Vec<f64>,
    thickness: f64,
    resting: Loads,
}

/// One fold that is being opened.
#[derive(Serialize, Deserialize)]
struct Opening {
    number: usize,
    axis: Axis,
    /// Point, where on its sheet, its mass [kg].
    guided: Vec<(u32, OnSheet, f64)>,
    /// Points that sleep meanwhile: the rest, but for a strip along the line. One flag per point.
    held: Vec<bool>,
    /// How much the flap must come up in all, or it would end in the ground [m].
    lift: f64,
}

impl Open {
    fn opening(&self, number: usize, x: &[Vec3]) -> Opening {
        let fold = &self.folds[number];
        let mut in_flap = vec![false; x.len()];
        fold.flap.iter().for_each(|&p| in_flap[p as usize] = true);
        let inside = |p: &Vec3| (p - fold.origin).dot(&fold.out) < -0.01;
        let heights = |flap: bool| {
            let mut h: Vec<f64> =
                x.iter().zip(&in_flap).filter(|(p, f)| **f == flap && inside(p)).map(|(p, _)| p.y).collect();
            h.sort_unstable_by(f64::total_cmp);
            h
        };
        let (flap, rest) = (heights(true), heights(false));
        let share = |h: &[f64], s: f64| h.get(((h.len() as f64 - 1.0) * s) as usize).copied();
        let between = match (share(&flap, STRAY), share(&rest, 1.0 - STRAY)) {
            (Some(f), Some(r)) => 0.5 * (f + r),
            (Some(f), None) => f - self.thickness,
            (None, r) => r.unwrap_or(0.0) + self.thickness,
        };
        let axis = Axis {
            origin: Vec3::new(fold.origin.x, between, fold.origin.z),
            along: fold.along,
            out: fold.out,
            least_depth: 0.5 * self.thickness,
        };
        let guided: Vec<_> = fold
            .flap
            .iter()
            .map(|&p| {
                let place = axis.on_sheet(&x[p as usize], fold.angle);
                (p, place, self.mass[p as usize])
            })
            .collect();
        let deepest = guided.iter().map(|(_, place, _)| place.depth).fold(0.0, f64::max);
        let ground = self.resting.ground.unwrap_or(f64::NEG_INFINITY);
        let lift = (deepest + self.thickness - (between - ground)).max(0.0);
        let held = x
            .iter()
            .zip(&in_flap)
            .map(|(p, flap)| !flap && (p - fold.origin).dot(&fold.out) <= -GRIP_WIDTH)
            .collect();
        Opening { number, axis, guided, held, lift }
    }
}

impl ActionRunner for Open {
    fn loads_at(&mut self, t: f64, x: &[Vec3]) -> Loads {
        let number = ((t / self.each - 1e-9).floor().max(0.0) as usize).min(self.folds.len() - 1);
        let opening = match self.under_way.take() {
            Some(opening) if opening.number == number => opening,
            _ => self.opening(number, x),
        };
        let done = smoothstep((t - self.each * number as f64) / self.each);
        let angle = self.folds[number].angle;
        let guides = opening
            .guided
            .iter()
            .map(|(point, place, mass)| {
                // Lifted where it lies away from the line, so that the crease itself is not pulled.
                let lift = opening.lift * done * (place.s / LIFT_RAMP).min(1.0);
                let phi = angle * (1.0 - done);
                let target = opening.axis.turned(place, phi) + Vec3::y() * lift;
                carry_spring(*point, target, opening.axis.normal(place, phi), *mass)
            })
            .collect();
        let held = opening.held.clone();
        self.under_way = Some(opening);
        Loads {
            springs: guides,
            guided: true,
            fixed: held,
            max_dt: MAX_TURN_PER_STEP * self.each / (1.5 * angle),
            ..self.resting.clone()
        }
    }

    fn save_state(&self) -> Option<Value> {
        Some(json!(self.under_way))
    }

    fn restore_state(&mut self, memo: &Value, point_count: usize) -> bool {
        let Ok(under_way) = Option::<Opening>::deserialize(memo) else { return false };
        let fits = under_way.as_ref().is_none_or(|opening| {
            opening.held.len() == point_count
                && opening.guided.iter().all(|(point, ..)| (*point as usize) < point_count)
        });
        self.under_way = under_way;
        fits
    }

    fn event_times(&self) -> Vec<f64> {
        (1..self.folds.len()).map(|k| self.each * k as f64).collect()
    }
}

/// Way from the line over which the lift comes in [m].
const LIFT_RAMP: f64 = 0.03;
