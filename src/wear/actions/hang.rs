//! `hang`: the garment is hung up, for a moment or overnight.

use crate::wear::action_runner::{ActionContext, ActionRunner, ActionStart};
use crate::wear::actions::lay::{Facing, Lay, LyingDirections};
use crate::wear::fraction::Fraction2;
use crate::wear::imperfection::{imperfection_note, off_the_plane};
use crate::wear::layout::fold_layout::FoldLayout;
use crate::wear::persistent_state::{GarmentFrame, PersistentState};
use crate::wear::tuning::TUNING;
use crate::wear::wear_action::WearAction;
use crease_geometry::math::{Mat3, Vec3, bounds};
use crease_model::error::Result;
use crease_solver::memory::Softening;
use crease_solver::sim::Loads;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use serde_json::Value;

/// Hang the garment up by its top, on a hanger or a hook, or by chosen points, and let it hang, for a moment or overnight.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Hang {
    /// Points that it hangs by. Default top.
    #[serde(default)]
    pub by: HangBy,
    /// Duration [s]. Default 5.
    #[serde(rename = "for", default = "default_for_s")]
    #[schemars(extend("exclusiveMinimum" = 0), range(max = 86400))]
    pub for_s: f64,
    /// Whether it is wet and dries as it hangs: most of its memory gives way to the shape that it hangs in. Default false.
    #[serde(default)]
    pub wet: bool,
}

/// Points that a garment hangs by.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(untagged)]
pub enum HangBy {
    /// A named set of points.
    Named(HangPoints),
    /// The points nearest to these, [x, y] in fractions 0..1 of the bounding box.
    Points(#[schemars(length(min = 1, max = 1000))] Vec<Fraction2>),
}

/// A named set of points to hang a garment by.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
#[schemars(rename = "HangPlace")]
pub enum HangPoints {
    /// Its highest points, as on a line.
    Top,
    /// Two supports along its upper edge, as far apart as the arms of a hanger. The garment is straightened first: it hangs from the
    /// shape of its file.
    Hanger,
    /// One point in the middle of its upper edge, as by a loop. The garment is straightened first.
    Hook,
}

impl Default for HangBy {
    fn default() -> Self {
        Self::Named(HangPoints::Top)
    }
}

fn default_for_s() -> f64 {
    5.0
}

/// An interval of the width of a garment in which it is supported, as fractions of its frame.
#[derive(Debug, Clone, Copy)]
struct Support {
    low: f64,
    high: f64,
}

impl HangPoints {
    /// Where a garment with the frame `frame` is supported along its upper edge; none for its highest points.
    fn supports(self, frame: &GarmentFrame) -> Vec<Support> {
        let tuning = TUNING.other;
        match self {
            Self::Top => Vec::new(),
            Self::Hook => vec![Support { low: 0.5, high: 0.5 }],
            Self::Hanger => {
                let arm = (0.5 * tuning.hanger_width / frame.right.norm().max(f64::MIN_POSITIVE)).min(0.5);
                let inner = (1.0 - tuning.hanger_support_fraction) * arm;
                vec![
                    Support { low: 0.5 - arm, high: 0.5 - inner },
                    Support { low: 0.5 + inner, high: 0.5 + arm },
                ]
            }
        }
    }
}

impl Hang {
    /// The points that are held, one flag per point of the upright garment `x` with the frame `frame`.
    fn held_points(&self, x: &[Vec3], frame: &GarmentFrame) -> Vec<bool> {
        let (low, high) = bounds(x);
        let grip = TUNING.other.hang_grip_fraction * (high - low).norm();
        match &self.by {
            HangBy::Named(points) => match points.supports(frame) {
                none if none.is_empty() => x.iter().map(|p| high.y - p.y <= grip).collect(),
                supports => held_along_top(x, frame, &supports, grip),
            },
            HangBy::Points(fractions) => {
                let mut held = vec![false; x.len()];
                for fraction in fractions {
                    let target = frame.position(fraction.0);
                    let distance = |p: &Vec3| (p - target).xy().norm();
                    let nearest = x.iter().map(distance).fold(f64::INFINITY, f64::min);
                    x.iter()
                        .zip(&mut held)
                        .filter(|(p, _)| distance(p) <= nearest + grip)
                        .for_each(|(_, h)| *h = true);
                }
                held
            }
        }
    }

    /// Whether the garment hangs from the shape of its file.
    fn starts_from_file(&self) -> bool {
        matches!(self.by, HangBy::Named(HangPoints::Hanger | HangPoints::Hook))
    }

    /// The upright garment, and the rotation from its present directions to those.
    fn upright(&self, context: &ActionContext, persistent: &PersistentState) -> (Vec<Vec3>, Mat3) {
        if self.starts_from_file() {
            let lay = Lay { facing: Facing::Front, over_s: 1.0 };
            let LyingDirections { facing, upper } = lay.directions(context.source_positions);
            let from_file =
                Mat3::from_rows(&[upper.cross(&facing).transpose(), upper.transpose(), facing.transpose()]);
            let hung = context.source_positions.iter().map(|p| from_file * p).collect();
            return (hung, from_file * persistent.orientation.transpose());
        }
        // Of a lying garment, -z (away from the viewer) becomes up, and +y (up) becomes +z (towards the viewer).
        let rotation = if persistent.ground_frame().is_some() {
            Mat3::new(1.0, 0.0, 0.0, 0.0, 0.0, -1.0, 0.0, 1.0, 0.0)
        } else {
            Mat3::identity()
        };
        (context.positions.iter().map(|p| rotation * p).collect(), rotation)
    }
}

/// The points of the upright garment `x` with the frame `frame` that `supports` bear, one flag per point: in each column of width
/// `grip` [m] those not more than `grip` below the highest.
fn held_along_top(x: &[Vec3], frame: &GarmentFrame, supports: &[Support], grip: f64) -> Vec<bool> {
    let width = frame.right.norm().max(f64::MIN_POSITIVE);
    let mut held = vec![false; x.len()];
    for support in supports {
        let columns = ((support.high - support.low) * width / grip).ceil() as usize;
        for k in 0..=columns {
            let at = support.low + (support.high - support.low) * k as f64 / columns.max(1) as f64;
            let distance = |p: &Vec3| (frame.fraction(p)[0] - at).abs() * width;
            let nearest = x.iter().map(distance).fold(f64::INFINITY, f64::min);
            let within = |p: &Vec3| distance(p) <= nearest + grip;
            let top = x.iter().filter(|p| within(p)).map(|p| p.y).fold(f64::NEG_INFINITY, f64::max);
            let column = x.iter().zip(&mut held).filter(|(p, _)| within(p) && top - p.y <= grip);
            column.for_each(|(_, held)| *held = true);
        }
    }
    held
}

impl WearAction for Hang {
    fn duration(&self) -> f64 {
        self.for_s
    }

    /// A garment that is straightened and dry hangs without creases.
    fn predict_creases(&self, layout: &mut FoldLayout) {
        if self.starts_from_file() && !self.wet {
            layout.take_up();
        } else {
            layout.mark_unpredictable();
        }
    }

    fn start_action(&self, context: &ActionContext, persistent: &mut PersistentState) -> Result<ActionStart> {
        let (hung, rotation) = self.upright(context, persistent);
        let frame = GarmentFrame::hanging(&hung);
        let fixed = self.held_points(&hung, &frame);
        persistent.orientation = rotation * persistent.orientation;
        persistent.frame = Some(frame);
        persistent.ground = None;
        persistent.turns.clear();
        persistent.body = None;
        persistent.laid_bend.clear();
        let loads = Loads { fixed, max_dt: TUNING.other.hang_max_dt, ..Loads::gravity_only(None) };
        persistent.held_loads = Some(loads.clone());
        let wet = TUNING.wet;
        let start = ActionStart::here(HangRunner {
            loads,
            is_short: self.for_s <= TUNING.other.hang_swing_time,
            drying: self.wet.then(|| Softening {
                points: Vec::new(),
                rate: wet.drying_dose / self.for_s,
                set_fraction: wet.set_fraction,
            }),
        })?;
        let imperfect = off_the_plane(&hung);
        let note = imperfect.as_ref().map(|_| imperfection_note("hang").into());
        Ok(ActionStart { start_positions: Some(imperfect.unwrap_or(hung)), note, ..start })
    }

    fn example() -> Self {
        Self { by: HangBy::Points(vec![Fraction2([0.1, 1.0]), Fraction2([0.9, 1.0])]), for_s: 8.0, wet: true }
    }
}

/// A garment that hangs.
struct HangRunner {
    loads: Loads,
    /// Whether nothing happens any more once it hangs still.
    is_short: bool,
    /// What water does to the cloth until it is dry.
    drying: Option<Softening>,
}

impl ActionRunner for HangRunner {
    fn loads_at(&mut self, t: f64, _x: &[Vec3]) -> Loads {
        let tuning = TUNING.other;
        let still = tuning.hang_dt_growth * (t - tuning.hang_swing_time).max(0.0);
        Loads { max_dt: tuning.hang_max_dt + still, ..self.loads.clone() }
    }

    fn softening(&self, _t: f64) -> Option<&Softening> {
        self.drying.as_ref()
    }

    fn may_end_early(&self) -> bool {
        self.is_short && self.drying.is_none()
    }

    fn save_state(&self) -> Option<Value> {
        Some(Value::Null)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A garment of 0.9 x 0.6 m with sleeves: shoulders slope down from a neck of 0.2 m.
    fn shirt() -> Vec<Vec3> {
        let mut points = Vec::new();
        for k in 0..=90 {
            let x = 0.01 * f64::from(k);
            let from_middle: f64 = (x - 0.45f64).abs();
            let top = if from_middle < 0.095 { 0.55 } else { 0.6 - 0.2 * (from_middle - 0.1) };
            points.extend((0..=60).map(|l| Vec3::new(x, top * f64::from(l) / 60.0, 0.0)));
        }
        points
    }

    #[test]
    fn a_hanger_bears_both_shoulders_and_a_hook_the_middle() {
        let x = shirt();
        let frame = GarmentFrame::hanging(&x);
        let held = |points| {
            let hang = Hang { by: HangBy::Named(points), ..Hang::example() };
            let held = hang.held_points(&x, &frame);
            x.iter().zip(held).filter(|(_, held)| *held).map(|(p, _)| *p).collect::<Vec<_>>()
        };
        let shoulders = held(HangPoints::Hanger);
        let [left, right] =
            [-1.0, 1.0].map(|side| shoulders.iter().filter(|p| (p.x - 0.45) * side > 0.0).count());
        assert_eq!(left, right);
        assert!(left > 8 && shoulders.iter().all(|p| (p.x - 0.45).abs() > 0.09 && (p.x - 0.45).abs() < 0.23));
        assert!(shoulders.iter().all(|p| p.y > 0.55));
        let loop_points = held(HangPoints::Hook);
        assert!(!loop_points.is_empty());
        assert!(loop_points.iter().all(|p| (p.x - 0.45).abs() < 0.03 && p.y > 0.53));
    }

    #[test]
    fn steps_grow_while_it_hangs_overnight() {
        let loads = Loads::gravity_only(None);
        let mut runner = HangRunner { loads, is_short: false, drying: None };
        let (mut t, mut steps) = (0.0, 0);
        while t < 28_800.0 {
            t += runner.loads_at(t, &[]).max_dt;
            steps += 1;
        }
        assert!(steps < 300, "{steps} steps");
        assert!(!runner.may_end_early());
    }
}
