//! `unfold`: folds and rolls are opened again, the last one first.

use crate::wear::action_runner::{ActionContext, ActionFailure, ActionRunner, ActionStart};
use crate::wear::layout::fold_layout::FoldLayout;
use crate::wear::layout::fold_map::{FoldAxis, FoldCoords};
use crate::wear::motion::motion_profile::{PEAK_RATE, smoothstep};
use crate::wear::motion::springs::carry_spring;
use crate::wear::persistent_state::{FoldRecord, PersistentState, TurnRecord};
use crate::wear::tuning::TUNING;
use crate::wear::wear_action::{FieldError, WearAction};
use crease_geometry::math::Vec3;
use crease_model::error::Result;
use crease_solver::energy::TargetSpring;
use crease_solver::sim::Loads;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use serde_json::{Value, json};

/// Open folds and rolls again, the last one first. Without `last`, all of them.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Unfold {
    /// Open every fold and roll. May be left out; not together with `last`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub all: Option<bool>,
    /// Number of folds and rolls to open, counted back from the latest.
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

impl Unfold {
    /// Whether it opens all of a garment in the state `persistent`, which is folded.
    pub fn opens_all(&self, persistent: &PersistentState) -> bool {
        let count = persistent.turns.len();
        count > 0 && self.last.is_none_or(|wanted| wanted as usize == count)
    }
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
        let count = persistent.turns.len();
        if count == 0 {
            return Err(context
                .refuse("there is no fold or roll to open", "fold or roll first, or leave `unfold` out"));
        }
        let wanted = self.last.map_or(count, |n| n as usize);
        if wanted > count {
            let message = format!("{wanted} folds and rolls shall be opened and only {count} are made");
            return Err(context.refuse(message, format!("`last` may be at most {count} here")));
        }
        persistent.held_loads = None;
        let mut turns = persistent.turns.split_off(count - wanted);
        turns.reverse();
        persistent.free_panels();
        ActionStart::here(UnfoldRunner {
            time_per_turn: self.over_s / turns.len() as f64,
            turns,
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

/// Folds and rolls that are opened one after the other.
struct UnfoldRunner {
    /// Latest first.
    turns: Vec<TurnRecord>,
    /// [s].
    time_per_turn: f64,
    current: Option<Opening>,
    /// [kg], one per point.
    masses: Vec<f64>,
    /// Thickness of a layer [m].
    thickness: f64,
    idle_loads: Loads,
}

/// What is being opened; part of checkpoints.
#[derive(Serialize, Deserialize)]
struct Opening {
    /// Index of the fold or roll, in order of opening.
    number: usize,
    /// The fold; `None` for a roll.
    fold: Option<OpeningFold>,
    /// Index of one before this that did not open, if there is one.
    #[serde(default)]
    unopened: Option<usize>,
}

/// A fold that is being opened.
#[derive(Serialize, Deserialize)]
struct OpeningFold {
    axis: FoldAxis,
    flap: Vec<OpeningPoint>,
    /// Fixed points, one flag per point: the rest, except for a strip along the line.
    fixed: Vec<bool>,
    /// Height by which the flap rises in all, so that it does not end below the ground [m].
    lift: f64,
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
    /// Starts to open fold or roll `number` of a cloth at the positions `x` [m].
    fn open(&self, number: usize, x: &[Vec3]) -> Opening {
        let fold = match &self.turns[number] {
            TurnRecord::Fold(fold) => Some(self.open_fold(fold, x)),
            TurnRecord::Roll(_) => None,
        };
        Opening { number, fold, unopened: None }
    }

    /// Starts to open `fold` of a cloth at the positions `x` [m].
    fn open_fold(&self, fold: &FoldRecord, x: &[Vec3]) -> OpeningFold {
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
            axis,
            flap,
            fixed: x.iter().zip(&in_flap).map(is_fixed).collect(),
            lift: (max_depth + self.thickness - (between - ground)).max(0.0),
        }
    }

    /// The first fold or roll that did not open, up to the one that `opening` has opened with the points at `x` [m].
    fn unopened(&self, opening: &Opening, x: &[Vec3]) -> Option<usize> {
        let is_open = match (&self.turns[opening.number], &opening.fold) {
            (TurnRecord::Fold(record), Some(fold)) => {
                fold.open_fraction(record, x) >= TUNING.failure.min_turned_fraction
            }
            (TurnRecord::Roll(roll), _) => {
                roll.unrolled_fraction(x, &self.masses) >= TUNING.failure.min_turned_fraction
            }
            _ => true,
        };
        opening.unopened.or_else(|| (!is_open).then_some(opening.number))
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

impl OpeningFold {
    /// Fraction of the flap of `record` that lies on its own side of the line, weighted with mass and distance from it [-], with
    /// the points at `x` [m].
    fn open_fraction(&self, record: &FoldRecord, x: &[Vec3]) -> f64 {
        let (mut open, mut all) = (0.0, 0.0);
        for p in &self.flap {
            let weight = p.mass * p.coords.s;
            let is_open = (x[p.point as usize] - record.origin).dot(&record.outward) > 0.0;
            open += if is_open { weight } else { 0.0 };
            all += weight;
        }
        if all > 0.0 { open / all } else { 1.0 }
    }

    /// Springs that carry the flap turned by `angle` [rad], when the fraction `done` of the way is covered.
    fn springs(&self, angle: f64, done: f64) -> Vec<TargetSpring> {
        let spring = |p: &OpeningPoint| {
            // Points away from the line are lifted, so that the crease itself is not pulled.
            let lift = self.lift * done * (p.coords.s / TUNING.fold.lift_ramp).min(1.0);
            let target = self.axis.folded(&p.coords, angle) + Vec3::y() * lift;
            carry_spring(p.point, target, self.axis.normal(&p.coords, angle), p.mass)
        };
        self.flap.iter().map(spring).collect()
    }
}

impl ActionRunner for UnfoldRunner {
    fn loads_at(&mut self, t: f64, x: &[Vec3]) -> Loads {
        let number = ((t / self.time_per_turn - 1e-9).floor().max(0.0) as usize).min(self.turns.len() - 1);
        let opening = match self.current.take() {
            Some(opening) if opening.number == number => opening,
            Some(done) => Opening { unopened: self.unopened(&done, x), ..self.open(number, x) },
            None => self.open(number, x),
        };
        let done = smoothstep((t - self.time_per_turn * number as f64) / self.time_per_turn);
        let guided = Loads { guided: true, ..self.idle_loads.clone() };
        let loads = match (&self.turns[number], &opening.fold) {
            (TurnRecord::Fold(record), Some(fold)) => Loads {
                springs: fold.springs(record.angle * (1.0 - done), done),
                fixed: fold.fixed.clone(),
                max_dt: TUNING.fold.max_turn_per_step * self.time_per_turn / (PEAK_RATE * record.angle),
                ..guided
            },
            (TurnRecord::Roll(roll), _) => {
                let u = roll.length * (1.0 - done);
                let spring = |(p, mass): (usize, &f64)| roll.spring(p, u, *mass);
                Loads {
                    springs: self.masses.iter().enumerate().map(spring).collect(),
                    max_dt: roll.max_dt(self.time_per_turn),
                    ..guided
                }
            }
            _ => guided,
        };
        self.current = Some(opening);
        loads
    }

    fn save_state(&self) -> Option<Value> {
        Some(json!(self.current))
    }

    fn restore_state(&mut self, saved: &Value, point_count: usize) -> bool {
        let Ok(current) = Option::<Opening>::deserialize(saved) else { return false };
        let fits = current.as_ref().is_none_or(|opening| {
            let Some(turn) = self.turns.get(opening.number) else { return false };
            let is_its_kind = opening.fold.is_some() == matches!(turn, TurnRecord::Fold(_));
            let is_unopened = opening.unopened.is_none_or(|number| number < self.turns.len());
            let fold_fits = opening.fold.as_ref().is_none_or(|fold| {
                fold.fixed.len() == point_count && fold.flap.iter().all(|p| (p.point as usize) < point_count)
            });
            is_its_kind && is_unopened && fold_fits
        });
        self.current = current;
        fits
    }

    fn failure(&self, x: &[Vec3]) -> Option<ActionFailure> {
        let number = self.unopened(self.current.as_ref()?, x)?;
        let (what, at) = match &self.turns[number] {
            TurnRecord::Fold(fold) => ("fold", fold.origin),
            TurnRecord::Roll(roll) => ("roll", roll.map.origin),
        };
        Some(ActionFailure {
            message: format!(
                "{what} {} from the last, about the line through ({:.3}, {:.3}, {:.3}) m, did not open",
                number + 1,
                at.x,
                at.y,
                at.z
            ),
            help: "unfold more slowly (`over`), or fold fewer layers".into(),
        })
    }

    fn event_times(&self) -> Vec<f64> {
        (1..self.turns.len()).map(|k| self.time_per_turn * k as f64).collect()
    }
}
