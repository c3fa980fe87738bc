//! `hang`: the garment is hung up.

use crate::error::Result;
use crate::math::{Mat3, Vec3, bounds};
use crate::sim::Loads;
use crate::wear::action_runner::{ActionContext, ActionStart, ConstantLoads, GarmentFrame, PersistentState};
use crate::wear::actions::{Fraction2, WearAction};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Hang the garment up by its top or by chosen points, and let it hang.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Hang {
    /// What it hangs by. Default top.
    #[serde(default)]
    pub by: HangBy,
    /// For how long [s]. Default 5.
    #[serde(rename = "for", default = "for_s")]
    #[schemars(extend("exclusiveMinimum" = 0), range(max = 86400))]
    pub for_s: f64,
}

/// What a garment hangs by.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(untagged)]
pub enum HangBy {
    /// A named place.
    Place(HangPlace),
    /// The points nearest to these, [x, y] in fractions 0..1 of the bounding box.
    Points(#[schemars(length(min = 1, max = 1000))] Vec<Fraction2>),
}

/// A named place to hang a garment by.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum HangPlace {
    /// Its highest points, as on a hook or a line.
    Top,
}

impl Default for HangBy {
    fn default() -> Self {
        Self::Place(HangPlace::Top)
    }
}

fn for_s() -> f64 {
    5.0
}

impl WearAction for Hang {
    fn duration(&self) -> f64 {
        self.for_s
    }

    fn start_action(&self, context: &ActionContext, persistent: &mut PersistentState) -> Result<ActionStart> {
        // Lying: what points away from the viewer (-z) goes up, what looks up (+y) looks at the viewer.
        let upright = if persistent.ground_frame().is_some() {
            Mat3::new(1.0, 0.0, 0.0, 0.0, 0.0, -1.0, 0.0, 1.0, 0.0)
        } else {
            Mat3::identity()
        };
        let placed: Vec<Vec3> = context.positions.iter().map(|p| upright * p).collect();
        let frame = GarmentFrame::hanging(&placed);
        let (low, high) = bounds(&placed);
        let grip = GRIP * (high - low).norm();
        let held: Vec<bool> = match &self.by {
            HangBy::Place(HangPlace::Top) => placed.iter().map(|p| high.y - p.y <= grip).collect(),
            HangBy::Points(places) => {
                let mut held = vec![false; placed.len()];
                for place in places {
                    let target = frame.place(place.0);
                    let flat = |p: &Vec3| (p - target).xy().norm();
                    let nearest = placed.iter().map(flat).fold(f64::INFINITY, f64::min);
                    placed
                        .iter()
                        .zip(&mut held)
                        .filter(|(p, _)| flat(p) <= nearest + grip)
                        .for_each(|(_, h)| *h = true);
                }
                held
            }
        };
        persistent.orientation = upright * persistent.orientation;
        persistent.frame = Some(frame);
        persistent.ground = None;
        persistent.folds.clear();
        persistent.body = None;
        let drive = Loads { fixed: held, max_dt: 0.1, ..Loads::gravity_only(None) };
        persistent.held_loads = Some(drive.clone());
        Ok(ActionStart {
            runner: Box::new(ConstantLoads { loads: drive, may_end_early: true }),
            start_positions: Some(placed),
            duration: None,
        })
    }

    fn example() -> Self {
        Self { by: HangBy::Points(vec![Fraction2([0.1, 1.0]), Fraction2([0.9, 1.0])]), for_s: 8.0 }
    }
}

/// Size of a grip, as a share of the garment's diagonal.
const GRIP: f64 = 0.01;
