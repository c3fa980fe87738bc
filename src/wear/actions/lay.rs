//! `lay`: the garment is laid flat on the ground, layers in order, none crossing.

use crate::error::Result;
use crate::garment::{Footprint, is_lying};
use crate::math::{Mat3, Vec3, bounds};
use crate::sim::Loads;
use crate::wear::action_runner::{
    ActionContext, ActionRunner, ActionStart, GarmentFrame, PersistentState, smoothstep,
};
use crate::wear::actions::WearAction;
use crate::wear::crease_prediction::FoldLayout;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use serde_json::{Value, json};

/// Lay the garment flat on the ground, layers in order, none crossing. Later positions count in its bounding box as
/// it then lies: x from 0 at the left to 1 at the right, y from 0 at the lower edge (hem) to 1 at the upper (neck).
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Lay {
    /// Which side of the garment, as the file has it, looks up once it lies. Default front.
    #[serde(default)]
    pub facing: Facing,
    /// How long laying takes [s]. Default 2.
    #[serde(rename = "over", default = "over_s")]
    #[schemars(extend("exclusiveMinimum" = 0), range(max = 3600))]
    pub over_s: f64,
}

/// A side of the garment in its own pose, y up, front toward +z.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Facing {
    /// The front (+z) looks up.
    #[default]
    Front,
    /// The back (-z) looks up.
    Back,
    /// The wearer's left side (+x) looks up.
    Left,
    /// The wearer's right side (-x) looks up.
    Right,
    /// What is up in the file (+y) stays up: for cloth that lies flat already.
    Up,
    /// What is down in the file (-y) looks up.
    Down,
}

fn over_s() -> f64 {
    2.0
}

impl WearAction for Lay {
    fn duration(&self) -> f64 {
        self.over_s
    }

    /// Lays it down.
    fn sketch(&self, sketch: &mut FoldLayout) {
        sketch.lay(self);
    }

    fn start_action(&self, context: &ActionContext, persistent: &mut PersistentState) -> Result<ActionStart> {
        let (facing, upper) = self.directions(context.source_positions);
        let (facing, upper) = (persistent.orientation * facing, persistent.orientation * upper);
        let turn =
            Mat3::from_rows(&[upper.cross(&facing).transpose(), facing.transpose(), (-upper).transpose()]);
        let mut placed: Vec<Vec3> = context.positions.iter().map(|p| turn * p).collect();
        let (low, high) = bounds(&placed);
        let shift = Vec3::new(-0.5 * (low.x + high.x), context.thickness - low.y, -0.5 * (low.z + high.z));
        placed.iter_mut().for_each(|p| *p += shift);
        persistent.orientation = turn * persistent.orientation;
        persistent.folds.clear();
        persistent.held_loads = None;
        // Whoever lays a garment down has taken it off.
        persistent.body = None;
        persistent.ground = Some(0.0);
        persistent.frame = Some(GarmentFrame::lying(&placed));
        let height = high.y - low.y + context.thickness;
        let flat = FLAT_LAYERS * context.thickness;
        let runner = Flatten {
            heights: [height, flat.min(height)],
            now: height,
            over: self.over_s,
            thickness: context.thickness,
        };
        Ok(ActionStart { runner: Box::new(runner), start_positions: Some(placed), duration: None })
    }

    fn example() -> Self {
        Self { facing: Facing::Back, over_s: 1.5 }
    }
}

/// A garment is pressed down to this many layer thicknesses before it is let go.
const FLAT_LAYERS: f64 = 12.0;
/// Share of the time that pressing down takes; in the rest it lies free.
const PRESS_SHARE: f64 = 0.7;
/// A step lowers the ceiling by this share at most.
const MOST_SQUEEZE: f64 = 0.08;
/// A garment is lying in its file if it is this much thinner in y than in x and z.
const LYING_RATIO: f64 = 0.25;

impl Lay {
    /// Which direction of the file shall look up, and which shall point away from the viewer.
    fn directions(&self, source: &[Vec3]) -> (Vec3, Vec3) {
        let (low, high) = bounds(source);
        let size = high - low;
        let lies = is_lying(&size, Footprint::Shorter, LYING_RATIO);
        let facing = match (self.facing, lies) {
            (Facing::Front, false) => Vec3::z(),
            (Facing::Back, false) => -Vec3::z(),
            (Facing::Front | Facing::Up, _) => Vec3::y(),
            (Facing::Back | Facing::Down, _) => -Vec3::y(),
            (Facing::Left, _) => Vec3::x(),
            (Facing::Right, _) => -Vec3::x(),
        };
        let upper = if facing.y == 0.0 { Vec3::y() } else { -Vec3::z() };
        (facing, upper)
    }
}

/// A ceiling that comes down on the garment, then goes away.
///
/// Before every step all heights shrink by the share that the ceiling sinks: a linear map, which cannot make layers
/// cross. The solver then lets the cloth give way sideways.
struct Flatten {
    /// Of the ceiling at the start and at the end [m].
    heights: [f64; 2],
    /// Of the ceiling now [m].
    now: f64,
    over: f64,
    thickness: f64,
}

impl Flatten {
    fn presses(&self) -> bool {
        self.heights[1] < self.heights[0]
    }

    fn height(&self, t: f64) -> f64 {
        let done = smoothstep(t / (PRESS_SHARE * self.over));
        self.heights[0] * (self.heights[1] / self.heights[0]).powf(done)
    }
}

impl ActionRunner for Flatten {
    fn loads_at(&mut self, t: f64, _x: &[Vec3]) -> Loads {
        let pressing = self.presses() && t <= PRESS_SHARE * self.over * (1.0 + 1e-9);
        let steps = (self.heights[0] / self.heights[1]).ln() / -(1.0 - MOST_SQUEEZE).ln();
        Loads {
            ceiling: pressing.then(|| self.height(t) + self.thickness),
            friction: if pressing { 0.0 } else { 1.0 },
            drag: 10.0,
            // The smooth start and end make the fastest part 1.5 times the mean.
            max_dt: if pressing {
                PRESS_SHARE * self.over / (1.5 * steps).max(10.0)
            } else {
                0.1 * self.over
            },
            ..Loads::gravity_only(Some(0.0))
        }
    }

    fn event_times(&self) -> Vec<f64> {
        if self.presses() { vec![PRESS_SHARE * self.over] } else { Vec::new() }
    }

    fn apply_map(&mut self, t: f64, x: &mut [Vec3]) -> bool {
        if !self.presses() || t > PRESS_SHARE * self.over * (1.0 + 1e-9) {
            return false;
        }
        let height = self.height(t);
        let share = height / self.now;
        self.now = height;
        x.iter_mut().for_each(|p| p.y *= share);
        true
    }

    fn accumulates_memory(&self) -> bool {
        false
    }

    fn save_state(&self) -> Option<Value> {
        Some(json!(self.now))
    }

    fn restore_state(&mut self, memo: &Value, _point_count: usize) -> bool {
        let now = memo.as_f64().filter(|now| *now > 0.0);
        self.now = now.unwrap_or(self.now);
        now.is_some()
    }

    fn finish(&mut self, persistent: &mut PersistentState, x: &[Vec3]) {
        persistent.frame = Some(GarmentFrame::lying(x));
    }
}
