//! `lay`: the garment is laid flat on the ground, layers in order, none crossing.

use crate::wear::action_runner::{ActionContext, ActionFailure, ActionRunner, ActionStart, LaidOut};
use crate::wear::layout::flat_layout::FlatLayout;
use crate::wear::layout::fold_layout::FoldLayout;
use crate::wear::motion::motion_profile::smoothstep;
use crate::wear::persistent_state::{GarmentFrame, PersistentState};
use crate::wear::tuning::TUNING;
use crate::wear::wear_action::WearAction;
use crease_geometry::math::{Mat3, Vec3, bounds};
use crease_model::error::{Message, Operation, Result};
use crease_model::garment::{is_flat_across, max_flat_extent};
use crease_solver::sim::Loads;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use serde_json::Value;

/// Lay the garment flat on the ground, layers in order, none crossing. Later positions count in its bounding box as
/// it then lies: x from 0 at the left to 1 at the right, y from 0 at the lower edge (hem) to 1 at the upper (neck).
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Lay {
    /// Side of the garment, as its file has it, that looks up once it lies. Default front.
    #[serde(default)]
    pub facing: Facing,
    /// Duration [s]. Default 2.
    #[serde(rename = "over", default = "default_over_s")]
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
    /// The left side (+x) of the person in the garment looks up.
    Left,
    /// The right side (-x) of the person in the garment looks up.
    Right,
    /// What is up in the file (+y) stays up: for cloth that lies flat already.
    Up,
    /// What is down in the file (-y) looks up.
    Down,
}

fn default_over_s() -> f64 {
    2.0
}

/// Directions of a garment's file once it lies.
pub(super) struct LyingDirections {
    /// Unit vector that will point up.
    pub facing: Vec3,
    /// Unit vector that will point away from the viewer.
    pub upper: Vec3,
}

impl Lay {
    /// Directions in a file with the points `source` [m].
    pub(super) fn directions(&self, source: &[Vec3]) -> LyingDirections {
        let (low, high) = bounds(source);
        let size = high - low;
        let lies = is_flat_across(&size, 1);
        let facing = match (self.facing, lies) {
            (Facing::Front, false) => Vec3::z(),
            (Facing::Back, false) => -Vec3::z(),
            (Facing::Front | Facing::Up, _) => Vec3::y(),
            (Facing::Back | Facing::Down, _) => -Vec3::y(),
            (Facing::Left, _) => Vec3::x(),
            (Facing::Right, _) => -Vec3::x(),
        };
        let upper = if facing.y == 0.0 { Vec3::y() } else { -Vec3::z() };
        LyingDirections { facing, upper }
    }
}

impl WearAction for Lay {
    fn duration(&self) -> f64 {
        self.over_s
    }

    /// Lays the garment down.
    fn predict_creases(&self, layout: &mut FoldLayout) {
        layout.lay_down(|context, persistent| self.start_action(context, persistent));
    }

    fn start_action(&self, context: &ActionContext, persistent: &mut PersistentState) -> Result<ActionStart> {
        let LyingDirections { facing, upper } = self.directions(context.source_positions);
        let from_file =
            Mat3::from_rows(&[upper.cross(&facing).transpose(), facing.transpose(), (-upper).transpose()]);
        let rotation = from_file * persistent.orientation.transpose();
        let mut laid: Vec<Vec3> = context.positions.iter().map(|p| rotation * p).collect();
        persistent.orientation = from_file;
        persistent.turns.clear();
        persistent.held_loads = None;
        persistent.laid_bend.clear();
        persistent.cut.clear();
        // A garment that is laid down has been taken off.
        persistent.body = None;
        persistent.ground = Some(0.0);
        let mut laid_out = None;
        let upright: Vec<Vec3> = context.source_positions.iter().map(|p| from_file * p).collect();
        let lies = |x: &[Vec3]| {
            let (low, high) = bounds(x);
            high.y - low.y + context.thickness <= TUNING.lay.flat_layers * context.thickness
        };
        if !lies(&laid) && lies(&upright) {
            laid = upright;
        } else if !lies(&laid) {
            let layout =
                FlatLayout::new(&upright, context.triangles, TUNING.lay.layout_gap * context.thickness);
            let Some(layout) = layout else {
                let help = Message::from("`") + Operation::Inspect + "` tells what is wrong with the file";
                return Err(context.refuse("the garment cannot be laid: its points are not finite", help));
            };
            laid = layout.positions;
            laid_out = Some(LaidOut { level: layout.level, quality: layout.quality });
        }
        place_on_ground(&mut laid, context.thickness);
        persistent.frame = Some(GarmentFrame::lying(&laid));
        let start = ActionStart::here(LayRunner {
            over: self.over_s,
            thickness: context.thickness,
            is_smoothed: laid_out.is_some(),
        })?;
        Ok(ActionStart { start_positions: Some(laid), laid_out, ..start })
    }

    fn example() -> Self {
        Self { facing: Facing::Back, over_s: 1.5 }
    }
}

/// Moves the points `x` [m] to the middle of the ground, the lowest `clearance` [m] above it.
fn place_on_ground(x: &mut [Vec3], clearance: f64) {
    let (low, high) = bounds(x);
    let shift = Vec3::new(-0.5 * (low.x + high.x), clearance - low.y, -0.5 * (low.z + high.z));
    x.iter_mut().for_each(|p| *p += shift);
}

/// The cloth comes to rest on the ground.
///
/// What was laid out slides without friction at first, under the pressure of flat hands; then it is free.
struct LayRunner {
    /// Duration [s].
    over: f64,
    /// Thickness of a layer [m].
    thickness: f64,
    /// Whether the cloth is smoothed by hands at first.
    is_smoothed: bool,
}

impl LayRunner {
    /// Time up to which the cloth slides [s].
    fn smoothing_time(&self) -> f64 {
        if self.is_smoothed { TUNING.lay.smoothing_fraction * self.over } else { 0.0 }
    }

    /// Whether hands smooth the cloth in a step that ends at `t` [s].
    fn is_smoothing(&self, t: f64) -> bool {
        t <= self.smoothing_time() * (1.0 + 1e-9)
    }
}

impl ActionRunner for LayRunner {
    fn loads_at(&mut self, t: f64, _x: &[Vec3]) -> Loads {
        let rise = smoothstep(t / (TUNING.lay.smoothing_rise * self.over));
        Loads {
            friction: if self.is_smoothing(t) { 0.0 } else { 1.0 },
            pressure: if self.is_smoothing(t) { TUNING.fold.stroking_pressure * rise } else { 0.0 },
            drag: TUNING.lay.drag,
            max_dt: TUNING.lay.max_free_dt_fraction * self.over,
            ..Loads::gravity_only(Some(0.0))
        }
    }

    fn event_times(&self) -> Vec<f64> {
        if self.is_smoothed { vec![self.smoothing_time()] } else { Vec::new() }
    }

    fn accumulates_memory(&self) -> bool {
        false
    }

    fn save_state(&self) -> Option<Value> {
        Some(Value::Null)
    }

    fn failure(&self, x: &[Vec3]) -> Option<ActionFailure> {
        let (low, high) = bounds(x);
        let limit = max_flat_extent(&(high - low), 1).max(TUNING.lay.flat_layers * self.thickness);
        let standing = x.iter().filter(|p| p.y > limit).count();
        (standing as f64 > TUNING.failure.max_standing_fraction * x.len() as f64).then(|| ActionFailure {
            message: format!(
                "the garment does not lie: {:.0} % of it stand more than {:.0} mm above the ground, up to {:.0} mm",
                100.0 * standing as f64 / x.len() as f64,
                1e3 * limit,
                1e3 * high.y
            ),
            help: Message::from(
                "lay another side up (`facing`), lay it more slowly (`over`), or choose a softer fabric; `",
            ) + Operation::Inspect
                + "` tells what crosses in the file",
        })
    }

    fn finish(&mut self, persistent: &mut PersistentState, x: &[Vec3]) {
        persistent.frame = Some(GarmentFrame::lying(x));
    }
}
