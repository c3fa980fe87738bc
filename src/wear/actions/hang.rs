//! `hang`: the garment is hung up.

use crate::error::Result;
use crate::math::{Mat3, Vec3, bounds};
use crate::sim::Loads;
use crate::wear::action_runner::{ActionContext, ActionStart, ConstantLoads};
use crate::wear::fraction::Fraction2;
use crate::wear::persistent_state::{GarmentFrame, PersistentState};
use crate::wear::tuning::TUNING;
use crate::wear::wear_action::WearAction;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Hang the garment up by its top or by chosen points, and let it hang.
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
    /// Its highest points, as on a hook or a line.
    Top,
}

impl Default for HangBy {
    fn default() -> Self {
        Self::Named(HangPoints::Top)
    }
}

fn default_for_s() -> f64 {
    5.0
}

impl Hang {
    /// The points that are held, one flag per point of the upright garment `x` with the frame `frame`.
    fn held_points(&self, x: &[Vec3], frame: &GarmentFrame) -> Vec<bool> {
        let (low, high) = bounds(x);
        let grip = TUNING.other.hang_grip_fraction * (high - low).norm();
        match &self.by {
            HangBy::Named(HangPoints::Top) => x.iter().map(|p| high.y - p.y <= grip).collect(),
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
}

impl WearAction for Hang {
    fn duration(&self) -> f64 {
        self.for_s
    }

    fn start_action(&self, context: &ActionContext, persistent: &mut PersistentState) -> Result<ActionStart> {
        // Of a lying garment, -z (away from the viewer) becomes up, and +y (up) becomes +z (towards the viewer).
        let upright = if persistent.ground_frame().is_some() {
            Mat3::new(1.0, 0.0, 0.0, 0.0, 0.0, -1.0, 0.0, 1.0, 0.0)
        } else {
            Mat3::identity()
        };
        let hung: Vec<Vec3> = context.positions.iter().map(|p| upright * p).collect();
        let frame = GarmentFrame::hanging(&hung);
        let fixed = self.held_points(&hung, &frame);
        persistent.orientation = upright * persistent.orientation;
        persistent.frame = Some(frame);
        persistent.ground = None;
        persistent.folds.clear();
        persistent.body = None;
        persistent.laid_bend.clear();
        let loads = Loads { fixed, max_dt: TUNING.other.hang_max_dt, ..Loads::gravity_only(None) };
        persistent.held_loads = Some(loads.clone());
        let start = ActionStart::here(ConstantLoads { loads, may_end_early: true })?;
        Ok(ActionStart { start_positions: Some(hung), ..start })
    }

    fn example() -> Self {
        Self { by: HangBy::Points(vec![Fraction2([0.1, 1.0]), Fraction2([0.9, 1.0])]), for_s: 8.0 }
    }
}
