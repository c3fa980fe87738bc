//! `unfold`: folds are opened again, the last one first.

use crate::error::Result;
use crate::math::Vec3;
use crate::sim::Loads;
use crate::wear::action_runner::{ActionContext, ActionFailure, ActionRunner, ActionStart};
use crate::wear::fold_layout::FoldLayout;
use crate::wear::fold_map::{FoldAxis, FoldCoords};
use crate::wear::motion_profile::{PEAK_RATE, smoothstep};
use crate::wear::persistent_state::{FoldRecord, PersistentState};
use crate::wear::springs::carry_spring;
use crate::wear::tuning::TUNING;
use crate::wear::wear_action::{FieldError, WearAction};
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
    /// Number of folds to open, counted back from the latest.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = 1, max = 10000))]
    pub last: Option<u32>,
    /// Duration of opening them all [s]. Default 2.
    #[serde(rename = "over", default = "default_over_s")]
    #[schemars(extend("exclusiveMinimum" = 0), range(max = 3600))]
    pub over_s: f64,
}

fn default_over_s() -> f64 {
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
                let message = "`all` is false and `last` is missing";
                vec![FieldError::new("all", message, "say how many folds with `last`")]
            }
            _ => Vec::new(),
        }
    }

    /// Opens what was folded.
    fn predict_creases(&self, layout: &mut FoldLayout) {
        layout.unfold(self.last.map(|n| n as usize));
    }

    fn start_action(&self, context: &ActionContext, persistent: &mut PersistentState) -> Result<ActionStart> {
        let count = persistent.folds.len();
        if count == 0 {
            return Err(context.refuse("there is no fold to open", "fold first, or leave `unfold` out"));
        }
        let wanted = self.last.map_or(count, |n| n as usize);
        if wanted > count {
            let message = format!("{wanted} folds shall be opened and only {count} are made");
            return Err(context.refuse(message, format!("`last` may be at most {count} here")));
        }
        persistent.held_loads = None;
        let mut folds = persistent.folds.split_off(count - wanted);
        folds.reverse();
        ActionStart::here(UnfoldRunner {
            time_per_fold: self.over_s / folds.len() as f64,
            folds,
            current: None,
            masses: context.masses.to_vec(),
            thickness: context.thickness,
            idle_loads: persistent.idle_loads(),
        })
    }

    fn example() -> Self {
        Self { all: None, last: Some(2), over_s: 1.5 }
    }
}

/// Folds that are opened one after the other.
struct UnfoldRunner {
    /// Latest first.
    folds: Vec<FoldRecord>,
    /// [s].
    time_per_fold: f64,
    current: Option<OpeningFold>,
    /// [kg], one per point.
    masses: Vec<f64>,
    /// Thickness of a layer [m].
    thickness: f64,
    idle_loads: Loads,
}

/// A fold that is being opened; part of checkpoints.
#[derive(Serialize, Deserialize)]
struct OpeningFold {
    /// Index of the fold, in order of opening.
    number: usize,
    axis: FoldAxis,
    flap: Vec<OpeningPoint>,
    /// Fixed points, one flag per point: the rest, except for a strip along the line.
    fixed: Vec<bool>,
    /// Height by which the flap rises in all, so that it does not end below the ground [m].
    lift: f64,
    /// Number of a fold before this one that did not open, if there is one.
    #[serde(default)]
    unopened: Option<usize>,
}

/// A point of an opening flap.
#[derive(Serialize, Deserialize)]
struct OpeningPoint {
    point: u32,
    coords: FoldCoords,
    /// [kg].
    mass: f64,
}

impl UnfoldRunner {
    /// Starts to open fold `number` of a cloth at the positions `x` [m].
    fn open(&self, number: usize, x: &[Vec3]) -> OpeningFold {
        let fold = &self.folds[number];
        let mut in_flap = vec![false; x.len()];
        fold.flap.iter().for_each(|&p| in_flap[p as usize] = true);
        let between = self.height_between(fold, &in_flap, x);
        let axis = FoldAxis {
            origin: Vec3::new(fold.origin.x, between, fold.origin.z),
            along: fold.along,
            outward: fold.outward,
            min_depth: 0.5 * self.thickness,
        };
        let flap_point = |&p: &u32| OpeningPoint {
            point: p,
            coords: axis.to_fold_coords(&x[p as usize], fold.angle),
            mass: self.masses[p as usize],
        };
        let flap: Vec<OpeningPoint> = fold.flap.iter().map(flap_point).collect();
        let max_depth = flap.iter().map(|p| p.coords.depth).fold(0.0, f64::max);
        let ground = self.idle_loads.ground.unwrap_or(f64::NEG_INFINITY);
        let is_fixed = |(p, in_flap): (&Vec3, &bool)| {
            !in_flap && (p - fold.origin).dot(&fold.outward) <= -TUNING.fold.strip_width
        };
        OpeningFold {
            number,
            axis,
            flap,
            fixed: x.iter().zip(&in_flap).map(is_fixed).collect(),
            lift: (max_depth + self.thickness - (between - ground)).max(0.0),
            unopened: None,
        }
    }

    /// The first fold that did not open, up to the one that `opening` has opened with the points at `x` [m].
    fn unopened(&self, opening: &OpeningFold, x: &[Vec3]) -> Option<usize> {
        let fold = &self.folds[opening.number];
        let (mut open, mut all) = (0.0, 0.0);
        for p in &opening.flap {
            let weight = p.mass * p.coords.s;
            let is_open = (x[p.point as usize] - fold.origin).dot(&fold.outward) > 0.0;
            open += if is_open { weight } else { 0.0 };
            all += weight;
        }
        let is_unopened = open < TUNING.failure.min_turned_fraction * all;
        opening.unopened.or_else(|| is_unopened.then_some(opening.number))
    }

    /// Height between flap and rest of `fold`, whose flap is flagged per point [m].
    fn height_between(&self, fold: &FoldRecord, in_flap: &[bool], x: &[Vec3]) -> f64 {
        let inside = |p: &Vec3| (p - fold.origin).dot(&fold.outward) < -TUNING.fold.height_sample_offset;
        let sorted_heights = |flap: bool| {
            let own = x.iter().zip(in_flap).filter(|(p, f)| **f == flap && inside(p));
            let mut heights: Vec<f64> = own.map(|(p, _)| p.y).collect();
            heights.sort_unstable_by(f64::total_cmp);
            heights
        };
        let (flap, rest) = (sorted_heights(true), sorted_heights(false));
        let quantile = |h: &[f64], q: f64| h.get(((h.len() as f64 - 1.0) * q) as usize).copied();
        let outliers = TUNING.fold.max_outlier_fraction;
        match (quantile(&flap, outliers), quantile(&rest, 1.0 - outliers)) {
            (Some(f), Some(r)) => 0.5 * (f + r),
            (Some(f), None) => f - self.thickness,
            (None, r) => r.unwrap_or(0.0) + self.thickness,
        }
    }
}

impl ActionRunner for UnfoldRunner {
    fn loads_at(&mut self, t: f64, x: &[Vec3]) -> Loads {
        let number = ((t / self.time_per_fold - 1e-9).floor().max(0.0) as usize).min(self.folds.len() - 1);
        let opening = match self.current.take() {
            Some(opening) if opening.number == number => opening,
            Some(done) => OpeningFold { unopened: self.unopened(&done, x), ..self.open(number, x) },
            None => self.open(number, x),
        };
        let done = smoothstep((t - self.time_per_fold * number as f64) / self.time_per_fold);
        let angle = self.folds[number].angle;
        let spring = |p: &OpeningPoint| {
            // Points away from the line are lifted, so that the crease itself is not pulled.
            let lift = opening.lift * done * (p.coords.s / TUNING.fold.lift_ramp).min(1.0);
            let phi = angle * (1.0 - done);
            let target = opening.axis.folded(&p.coords, phi) + Vec3::y() * lift;
            carry_spring(p.point, target, opening.axis.normal(&p.coords, phi), p.mass)
        };
        let loads = Loads {
            springs: opening.flap.iter().map(spring).collect(),
            guided: true,
            fixed: opening.fixed.clone(),
            max_dt: TUNING.fold.max_turn_per_step * self.time_per_fold / (PEAK_RATE * angle),
            ..self.idle_loads.clone()
        };
        self.current = Some(opening);
        loads
    }

    fn save_state(&self) -> Option<Value> {
        Some(json!(self.current))
    }

    fn restore_state(&mut self, saved: &Value, point_count: usize) -> bool {
        let Ok(current) = Option::<OpeningFold>::deserialize(saved) else { return false };
        let fits = current.as_ref().is_none_or(|opening| {
            opening.fixed.len() == point_count
                && opening.flap.iter().all(|p| (p.point as usize) < point_count)
        });
        self.current = current;
        fits
    }

    fn failure(&self, x: &[Vec3]) -> Option<ActionFailure> {
        let number = self.unopened(self.current.as_ref()?, x)?;
        let at = self.folds[number].origin;
        Some(ActionFailure {
            message: format!(
                "fold {} from the last, about the line through ({:.3}, {:.3}, {:.3}) m, did not open",
                number + 1,
                at.x,
                at.y,
                at.z
            ),
            help: "unfold more slowly (`over`), or fold fewer layers".to_owned(),
        })
    }

    fn event_times(&self) -> Vec<f64> {
        (1..self.folds.len()).map(|k| self.time_per_fold * k as f64).collect()
    }
}
