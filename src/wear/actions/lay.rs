//! `lay`: the garment is laid flat on the ground, layers in order, none crossing.

use crate::wear::action_runner::{ActionContext, ActionFailure, ActionRunner, ActionStart, LaidOut};
use crate::wear::layout::flat_layout::FlatLayout;
use crate::wear::layout::fold_layout::FoldLayout;
use crate::wear::motion::motion_profile::{PEAK_RATE, smoothstep};
use crate::wear::persistent_state::{GarmentFrame, PersistentState};
use crate::wear::tuning::TUNING;
use crate::wear::wear_action::WearAction;
use crease_geometry::math::{Mat3, Vec3, bounds};
use crease_model::error::{Message, Operation, Result};
use crease_model::garment::{is_flat_across, max_flat_extent};
use crease_solver::sim::Loads;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use serde_json::{Value, json};

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
        let (low, high) = bounds(&laid);
        persistent.orientation = from_file;
        persistent.turns.clear();
        persistent.held_loads = None;
        persistent.laid_bend.clear();
        persistent.cut.clear();
        // A garment that is laid down has been taken off.
        persistent.body = None;
        persistent.ground = Some(0.0);
        let mut height = high.y - low.y + context.thickness;
        let flat = TUNING.lay.flat_layers * context.thickness;
        let (mut laid_out, mut note) = (None, None);
        if height > flat
            && let Some(layout) = {
                let upright: Vec<Vec3> = context.source_positions.iter().map(|p| from_file * p).collect();
                FlatLayout::new(&upright, context.triangles, TUNING.lay.layout_gap * context.thickness)
            }
        {
            laid = layout.positions;
            note = Some(format!(
                "front over back, in a cut that differs from the file's shape by {:.1} % (rms strain); {:.1} % of the cloth does not fit into \
                 the plane beyond that and makes wrinkles",
                100.0 * layout.strain,
                100.0 * layout.excess
            ));
            laid_out = Some(LaidOut { level: layout.level, excess: layout.excess });
            height = flat;
        }
        place_on_ground(&mut laid, context.thickness);
        persistent.frame = Some(GarmentFrame::lying(&laid));
        let start = ActionStart::here(LayRunner {
            first_height: height,
            last_height: flat.min(height),
            height,
            over: self.over_s,
            thickness: context.thickness,
            is_smoothed: laid_out.is_some() || flat < height,
        })?;
        Ok(ActionStart { start_positions: Some(laid), laid_out, note, ..start })
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

/// A ceiling that comes down on the garment and is then removed.
///
/// Before every step all heights shrink by the same factor as the ceiling: a linear map, which cannot make layers cross.
/// The solver then lets the cloth move sideways.
struct LayRunner {
    /// Height of the ceiling at the start [m].
    first_height: f64,
    /// Height of the ceiling once it is down [m].
    last_height: f64,
    /// Present height of the ceiling [m].
    height: f64,
    /// Duration [s].
    over: f64,
    /// Thickness of a layer [m].
    thickness: f64,
    /// Whether the cloth slides without friction until the press time, as if smoothed by hands.
    is_smoothed: bool,
}

impl LayRunner {
    fn has_ceiling(&self) -> bool {
        self.last_height < self.first_height
    }

    /// Time at which the ceiling is down [s].
    fn press_time(&self) -> f64 {
        TUNING.lay.press_time_fraction * self.over
    }

    /// Whether the ceiling is coming down in a step that ends at `t` [s].
    fn is_pressing(&self, t: f64) -> bool {
        self.has_ceiling() && t <= self.press_time() * (1.0 + 1e-9)
    }

    /// Height of the ceiling at `t` [s], in metres.
    fn height_at(&self, t: f64) -> f64 {
        let done = smoothstep(t / self.press_time());
        self.first_height * (self.last_height / self.first_height).powf(done)
    }
}

impl ActionRunner for LayRunner {
    fn loads_at(&mut self, t: f64, _x: &[Vec3]) -> Loads {
        let pressing = self.is_pressing(t);
        let slides = self.is_smoothed && t <= self.press_time() * (1.0 + 1e-9);
        let steps =
            (self.first_height / self.last_height).ln() / -(1.0 - TUNING.lay.max_squeeze_per_step).ln();
        Loads {
            ceiling: pressing.then(|| self.height_at(t) + self.thickness),
            friction: if slides { 0.0 } else { 1.0 },
            drag: TUNING.lay.drag,
            max_dt: if pressing {
                self.press_time() / (PEAK_RATE * steps).max(TUNING.lay.min_steps)
            } else {
                TUNING.lay.max_free_dt_fraction * self.over
            },
            ..Loads::gravity_only(Some(0.0))
        }
    }

    fn event_times(&self) -> Vec<f64> {
        if self.is_smoothed { vec![self.press_time()] } else { Vec::new() }
    }

    fn apply_map(&mut self, t: f64, x: &mut [Vec3]) -> bool {
        if !self.is_pressing(t) {
            return false;
        }
        let height = self.height_at(t);
        let factor = height / self.height;
        self.height = height;
        x.iter_mut().for_each(|p| p.y *= factor);
        true
    }

    fn accumulates_memory(&self) -> bool {
        false
    }

    fn save_state(&self) -> Option<Value> {
        Some(json!(self.height))
    }

    fn restore_state(&mut self, saved: &Value, _point_count: usize) -> bool {
        let height = saved.as_f64().filter(|height| *height > 0.0);
        self.height = height.unwrap_or(self.height);
        height.is_some()
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
