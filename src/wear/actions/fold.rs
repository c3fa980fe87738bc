//! `fold`: one side of a line is turned over, as hands fold cloth on a table.

use crate::wear::action_runner::{ActionContext, ActionFailure, ActionRunner, ActionStart, NeededPlace};
use crate::wear::fraction::Fraction2;
use crate::wear::layout::fold_layout::FoldLayout;
use crate::wear::layout::fold_map::{FoldAxis, FoldCoords, line_shift};
use crate::wear::layout::height_field::HeightField;
use crate::wear::layout::panel::panel;
use crate::wear::motion::motion_profile::{PEAK_RATE, smoothstep};
use crate::wear::motion::springs::{carry_spring, pin_spring};
use crate::wear::persistent_state::{FoldRecord, GarmentFrame, PersistentState, TurnRecord};
use crate::wear::tuning::TUNING;
use crate::wear::wear_action::{FieldError, WearAction};
use crease_geometry::math::Vec3;
use crease_model::error::{Message, Operation, Result};
use crease_solver::energy::TargetSpring;
use crease_solver::sim::Loads;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use serde_json::Value;
use std::f64::consts::PI;

/// Turn one side of a line over the rest, and hold it there. Folds stack: all layers that lie there go along.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Fold {
    /// Two points of the line, [x, y] in fractions 0..1 of the bounding box. The line continues beyond them.
    pub line: [Fraction2; 2],
    /// Side of the line that is turned over.
    pub side: FoldSide,
    /// Angle by which it is turned [degrees]: 180 lays it flat on the rest. Default 180.
    #[serde(rename = "angle", default = "default_angle_deg")]
    #[schemars(extend("exclusiveMinimum" = 0), range(max = 180))]
    pub angle_deg: f64,
    /// Duration of the turn [s]. Default 2.
    #[serde(rename = "over", default = "default_over_s")]
    #[schemars(extend("exclusiveMinimum" = 0), range(max = 3600))]
    pub over_s: f64,
    /// Time that it is held afterwards [s]. Default 0.
    #[serde(rename = "hold", default)]
    #[schemars(range(min = 0, max = 86400))]
    pub hold_s: f64,
}

/// A side of a line, as seen from above with the garment's upper edge away from the viewer.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
#[schemars(rename = "Side")]
pub enum FoldSide {
    /// Where x is smaller than on the line.
    Left,
    /// Where x is larger than on the line.
    Right,
    /// Where y is larger than on the line.
    Upper,
    /// Where y is smaller than on the line.
    Lower,
}

fn default_angle_deg() -> f64 {
    180.0
}

fn default_over_s() -> f64 {
    2.0
}

/// A fold line on the ground.
struct FoldLine {
    /// A point of the line [m].
    origin: Vec3,
    /// Unit vector along it.
    along: Vec3,
    /// Unit vector from it to the flap.
    outward: Vec3,
}

impl FoldLine {
    /// Distance beyond the line of a point [m].
    fn beyond(&self, p: &Vec3) -> f64 {
        (p - self.origin).dot(&self.outward)
    }
}

impl Fold {
    /// Whether a point is on the side that is turned over.
    pub fn turns(&self, point: Fraction2) -> bool {
        let [a, b] = self.line;
        let (dx, dy) = (b.x() - a.x(), b.y() - a.y());
        // Positive on the left of the direction a -> b.
        let left_of_direction = dx * (point.y() - a.y()) - dy * (point.x() - a.x());
        match self.side {
            FoldSide::Left => left_of_direction * dy > 0.0,
            FoldSide::Right => left_of_direction * dy < 0.0,
            FoldSide::Upper => left_of_direction * dx > 0.0,
            FoldSide::Lower => left_of_direction * dx < 0.0,
        }
    }

    /// The line on a garment with the frame `frame`.
    fn line_in(&self, frame: &GarmentFrame) -> FoldLine {
        let [a, b] = self.line.map(|f| frame.position(f.0));
        let along = (b - a).normalize();
        let across = along.cross(&Vec3::y());
        let turns = self.turns(Fraction2(frame.fraction(&(a + across))));
        FoldLine { origin: a, along, outward: if turns { across } else { -across } }
    }
}

impl WearAction for Fold {
    fn duration(&self) -> f64 {
        self.over_s + self.hold_s
    }

    fn validate(&self) -> Vec<FieldError> {
        let [a, b] = self.line;
        let (dx, dy) = ((b.x() - a.x()).abs(), (b.y() - a.y()).abs());
        // A line shorter than a millionth of the garment has no reliable direction.
        const MIN_LENGTH_FRACTION: f64 = 1e-6;
        if dx.max(dy) < MIN_LENGTH_FRACTION {
            let message = "the two points of the line are the same: it has no direction";
            return vec![FieldError::new("line", message, "give two points apart from each other")];
        }
        let wrong_side = |message, help| vec![FieldError::new("side", message, help)];
        let mut errors = match self.side {
            FoldSide::Left | FoldSide::Right if dy < MIN_LENGTH_FRACTION => {
                wrong_side("a level line has no left and no right side", "use `upper` or `lower`")
            }
            FoldSide::Upper | FoldSide::Lower if dx < MIN_LENGTH_FRACTION => {
                wrong_side("an upright line has no upper and no lower side", "use `left` or `right`")
            }
            _ => Vec::new(),
        };
        errors.extend(FieldError::of_radians(self.angle_deg));
        errors
    }

    /// Marks the line and turns the flap over.
    fn predict_creases(&self, layout: &mut FoldLayout) {
        match layout.ground_frame() {
            Some(frame) if self.angle_deg > TUNING.fold.flat_fold_deg => {
                let line = self.line_in(&frame);
                layout.fold(line.origin, line.outward);
            }
            _ => layout.mark_unpredictable(),
        }
    }

    fn start_action(&self, context: &ActionContext, persistent: &mut PersistentState) -> Result<ActionStart> {
        let Some(frame) = persistent.open_frame() else {
            return Err(context.refuse_place("fold", NeededPlace::Open));
        };
        let (x, masses, thickness) = (context.positions, context.masses, context.thickness);
        let strip_width = TUNING.fold.strip_width;
        let mut line = self.line_in(&frame);
        let at_line = stack_height(x.iter().filter(|p| line.beyond(p).abs() < strip_width), thickness);
        line.origin -= line.outward * line_shift(at_line);
        let (flap, rest): (Vec<u32>, Vec<u32>) =
            (0..x.len() as u32).partition(|&p| line.beyond(&x[p as usize]) > 0.0);
        if flap.is_empty() || rest.is_empty() {
            let side = if flap.is_empty() { "nothing" } else { "everything" };
            return Err(context.refuse(
                format!("{side} lies on the side of the line that is turned"),
                "move the line: fractions of the box run from 0 to 1, x to the right, y upward",
            ));
        }
        // The axis runs over the stack as it is along the line; bulges elsewhere are pressed down by the flap.
        let top = stack_height(x.iter().filter(|p| line.beyond(p).abs() < strip_width), thickness);
        let axis = FoldAxis {
            origin: Vec3::new(line.origin.x, top + TUNING.fold.axis_clearance * thickness, line.origin.z),
            along: line.along,
            outward: line.outward,
            min_depth: 0.5 * thickness,
        };
        let under = HeightField::over(rest.iter().map(|&p| x[p as usize]));
        let flap_point = |&p: &u32| {
            let coords = axis.to_fold_coords(&x[p as usize], 0.0);
            let rise = under.rise(&axis.folded(&coords, PI), top);
            let straight = ((coords.s - PI * coords.depth) / TUNING.fold.rise_ramp).clamp(0.0, 1.0);
            FlapPoint { point: p, coords, rise: rise * straight, mass: masses[p as usize] }
        };
        let held = TUNING.fold.held_width;
        // Of a garment in the shape of a body some cloth stands up: folds made before would open under it, and others would be made beside
        // their lines. Flat hands stroke the whole stack.
        let is_stroked = !persistent.cut.is_empty();
        let angle = self.angle_deg.to_radians();
        // There more of the cloth finds its place after the flap; on the side of the flap the outermost layer bends over half a turn.
        let band = if is_stroked { 2.0 } else { 1.0 } * TUNING.fold.band_width;
        let bend = PI * top;
        let near_line = |p: &Vec3| (-band..band + bend).contains(&line.beyond(p));
        // The part that stays is held along the line; beyond, it is fixed while the flap turns: nothing moves it.
        let sprung = rest.iter().filter(|&&p| line.beyond(&x[p as usize]) > -held);
        let pin = |&p: &u32| pin_spring(p, x[p as usize], masses[p as usize]);
        ActionStart::here(FoldRunner {
            axis,
            flap: flap.iter().map(flap_point).collect(),
            pins: sprung.map(pin).collect(),
            fixed: x.iter().map(|p| line.beyond(p) <= -held).collect(),
            smoothed: x.iter().map(|p| is_stroked || line.beyond(p).abs() < strip_width).collect(),
            smoothing_pressure: if is_stroked {
                TUNING.fold.stroking_pressure
            } else {
                TUNING.fold.smoothing_pressure
            },
            record: FoldRecord {
                flap,
                origin: line.origin,
                along: line.along,
                outward: line.outward,
                angle,
                panel: if angle > TUNING.fold.self_supporting_angle {
                    panel(x, context.triangles, near_line)
                } else {
                    Vec::new()
                },
            },
            over: self.over_s,
            is_held: false,
            idle_loads: persistent.idle_loads(),
        })
    }

    fn example() -> Self {
        Self {
            line: [Fraction2([0.3, 0.0]), Fraction2([0.35, 1.0])],
            side: FoldSide::Left,
            angle_deg: 170.0,
            over_s: 2.5,
            hold_s: 5.0,
        }
    }
}

/// Height of a stack of points [m]; a layer's `thickness` if there are none.
pub(super) fn stack_height<'a>(points: impl Iterator<Item = &'a Vec3>, thickness: f64) -> f64 {
    let mut heights: Vec<f64> = points.map(|p| p.y).collect();
    heights.sort_unstable_by(f64::total_cmp);
    heights.get((TUNING.fold.stack_quantile * heights.len() as f64) as usize).copied().unwrap_or(thickness)
}

/// A flap that is turned over, then released or held.
struct FoldRunner {
    axis: FoldAxis,
    flap: Vec<FlapPoint>,
    /// Springs that hold the rest along the line.
    pins: Vec<TargetSpring>,
    /// Points that are fixed while the flap turns, one flag per point.
    fixed: Vec<bool>,
    /// Points that are smoothed after the release, one flag per point: those of a strip of cloth along the line, since points that
    /// entered and left a strip of the ground would be pushed to and fro; all of a garment that was laid out.
    smoothed: Vec<bool>,
    /// Pressure on them [Pa].
    smoothing_pressure: f64,
    record: FoldRecord,
    /// Duration of the turn [s].
    over: f64,
    /// Whether hands took hold of the flap again, since it sprang back when they let go.
    is_held: bool,
    idle_loads: Loads,
}

/// A point of a flap.
struct FlapPoint {
    point: u32,
    coords: FoldCoords,
    /// Height of its final position above that on a plane [m].
    rise: f64,
    /// [kg].
    mass: f64,
}

impl FoldRunner {
    fn supports_itself(&self) -> bool {
        self.record.angle > TUNING.fold.self_supporting_angle && !self.is_held
    }

    /// Takes hold of the flap: springs have all of it from here on, and nothing is fixed.
    fn hold(&mut self) {
        self.is_held = true;
        self.record.panel.clear();
    }

    /// Takes hold of a flap that was turned over and springs back, with the points at `x` [m] `t` seconds after the start.
    fn hold_if_springing_back(&mut self, t: f64, x: &[Vec3]) {
        let is_let_go = t > self.over * (1.0 + 1e-9) && self.supports_itself();
        let springing_back = TUNING.fold.min_reached_fraction..TUNING.failure.min_turned_fraction;
        if is_let_go && self.turned_fraction(x).is_some_and(|turned| springing_back.contains(&turned)) {
            self.hold();
        }
    }

    /// Fraction of its path that the flap has covered with the points at `x` [m], weighted with mass and path [-]; `None` for a
    /// path too short to tell.
    fn turned_fraction(&self, x: &[Vec3]) -> Option<f64> {
        let (mut covered, mut whole, mut mass) = (0.0, 0.0, 0.0);
        for p in &self.flap {
            let [start, end] = [0.0, self.record.angle].map(|phi| self.axis.folded(&p.coords, phi));
            let (path, left) = ((end - start).norm(), (x[p.point as usize] - end).norm());
            covered += p.mass * (path - left);
            whole += p.mass * path;
            mass += p.mass;
        }
        (whole > mass * TUNING.failure.min_judged_path).then(|| covered / whole)
    }

    /// Loads `t` seconds after the release of the flap: pressure that smooths the new fold.
    fn smoothing_loads(&self, t: f64) -> Loads {
        let fold = &TUNING.fold;
        let rises = t < fold.release_time;
        Loads {
            pressure: self.smoothing_pressure * smoothstep(t / fold.release_time),
            pressed: self.smoothed.clone(),
            max_dt: if rises { fold.release_time / fold.release_steps } else { f64::INFINITY },
            transient: rises,
            fixed: self.record.panel.clone(),
            ..self.idle_loads.clone()
        }
    }
}

impl ActionRunner for FoldRunner {
    fn loads_at(&mut self, t: f64, x: &[Vec3]) -> Loads {
        let release_time = TUNING.fold.release_time;
        self.hold_if_springing_back(t, x);
        let turning = t <= self.over * (1.0 + 1e-9);
        let grip = if turning || !self.supports_itself() {
            1.0
        } else {
            1.0 - smoothstep((t - self.over) / release_time)
        };
        if grip <= 0.0 {
            return self.smoothing_loads(t - self.over - release_time);
        }
        let phi = self.record.angle * smoothstep(t / self.over);
        let risen = smoothstep(phi / PI);
        let flap = self.flap.iter().map(|p| {
            let normal = self.axis.normal(&p.coords, phi);
            let target = self.axis.folded(&p.coords, phi) + normal * (p.rise * risen);
            carry_spring(p.point, target, normal, p.mass).scaled(grip)
        });
        let pins = self.pins.iter().map(|pin| pin.scaled(grip));
        Loads {
            springs: flap.chain(pins).collect(),
            guided: turning,
            transient: grip < 1.0,
            fixed: if turning { &self.fixed } else { &self.record.panel }.clone(),
            // The release slows down what was held.
            drag: self.idle_loads.drag + if grip < 1.0 { TUNING.fold.release_drag * grip } else { 0.0 },
            max_dt: if turning {
                TUNING.fold.max_turn_per_step * self.over / (PEAK_RATE * self.record.angle)
            } else if grip < 1.0 {
                release_time / TUNING.fold.release_steps
            } else {
                f64::INFINITY
            },
            ..self.idle_loads.clone()
        }
    }

    fn event_times(&self) -> Vec<f64> {
        let release_time = TUNING.fold.release_time;
        vec![self.over, self.over + release_time, self.over + 2.0 * release_time]
    }

    fn save_state(&self) -> Option<Value> {
        Some(if self.is_held { Value::Bool(true) } else { Value::Null })
    }

    fn restore_state(&mut self, saved: &Value, _point_count: usize) -> bool {
        if saved.as_bool() == Some(true) {
            self.hold();
        }
        saved.is_null() || self.is_held
    }

    fn note(&self) -> Option<String> {
        self.is_held.then(|| {
            "the flap springs back from so thick a stack when it is let go: it is held, as by hands, until it is opened or \
             released"
                .to_owned()
        })
    }

    fn failure(&self, x: &[Vec3]) -> Option<ActionFailure> {
        let turned = self.turned_fraction(x)?;
        (turned < TUNING.failure.min_turned_fraction).then(|| {
            let at = self.record.origin;
            ActionFailure {
                message: format!(
                    "the flap did not turn over: it covered {:.0} % of its path about the line through ({:.3}, {:.3}, {:.3}) m",
                    (100.0 * turned).max(0.0),
                    at.x,
                    at.y,
                    at.z
                ),
                help: Message::from(
                    "fold more slowly (`over`), move the line, choose a softer fabric, or mend what crosses in the file (`",
                ) + Operation::Inspect
                    + "`)",
            }
        })
    }

    fn finish(&mut self, persistent: &mut PersistentState, x: &[Vec3]) {
        if !self.supports_itself() {
            persistent.held_loads = Some(self.loads_at(f64::INFINITY, x));
        }
        persistent.turns.push(TurnRecord::Fold(self.record.clone()));
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crease_geometry::math::PlaneStretch;

    /// Cloth that lies at `x` [m], of `masses` [kg].
    fn context<'a>(x: &'a [Vec3], masses: &'a [f64]) -> ActionContext<'a> {
        ActionContext {
            positions: x,
            source_positions: x,
            triangles: &[],
            masses,
            thickness: 1e-3,
            script_file: "w.json",
            location: "0",
        }
    }

    /// State of cloth that lies at `x` [m].
    fn lying(x: &[Vec3]) -> PersistentState {
        let frame = Some(GarmentFrame::lying(x));
        PersistentState { frame, ground: Some(0.0), ..PersistentState::default() }
    }

    /// A fold of the right half by 180 degrees.
    fn right_half() -> Fold {
        let line = [Fraction2([0.5, 0.0]), Fraction2([0.5, 1.0])];
        Fold { line, angle_deg: 180.0, side: FoldSide::Right, ..Fold::example() }
    }

    #[test]
    fn sides_do_not_depend_on_the_direction_of_the_line() {
        for (side, inside, outside) in [
            (FoldSide::Left, [0.1, 0.5], [0.9, 0.5]),
            (FoldSide::Right, [0.9, 0.5], [0.1, 0.5]),
            (FoldSide::Upper, [0.5, 0.9], [0.5, 0.1]),
            (FoldSide::Lower, [0.5, 0.1], [0.5, 0.9]),
        ] {
            for line in [[[0.4, 0.3], [0.6, 0.7]], [[0.4, 0.7], [0.6, 0.3]]] {
                let forth = Fold { line: line.map(Fraction2), side, ..Fold::example() };
                let back = Fold { line: [forth.line[1], forth.line[0]], ..forth.clone() };
                for fold in [forth, back] {
                    assert!(fold.turns(Fraction2(inside)), "{fold:?}");
                    assert!(!fold.turns(Fraction2(outside)), "{fold:?}");
                }
            }
        }
    }

    /// Loads are transient only during the release and while the smoothing pressure rises.
    #[test]
    fn a_fold_that_is_held_has_no_transient_loads() {
        let x: Vec<Vec3> =
            [[0.0, 0.0], [0.4, 0.0], [0.0, -0.4], [0.4, -0.4]].map(|[x, z]| Vec3::new(x, 1e-3, z)).to_vec();
        let context = context(&x, &[1e-3; 4]);
        let over = 2.0;
        let release_time = TUNING.fold.release_time;
        for (angle_deg, transient) in [(180.0, true), (90.0, false)] {
            let mut persistent = lying(&x);
            let fold = Fold {
                line: [Fraction2([0.5, 0.0]), Fraction2([0.5, 1.0])],
                angle_deg,
                over_s: over,
                ..Fold::example()
            };
            let mut runner = fold.start_action(&context, &mut persistent).expect("can be folded").runner;
            let mut at = |t: f64| runner.loads_at(t, &x);
            assert!(at(0.5 * over).guided && !at(0.5 * over).transient && !at(over).transient);
            for t in [0.25, 0.75, 1.0, 1.5] {
                assert_eq!(at(over + t * release_time).transient, transient, "{angle_deg} {t}");
            }
            assert!(!at(over + 2.5 * release_time).transient);
            runner.finish(&mut persistent, &x);
            assert!(!persistent.idle_loads().transient);
        }
    }

    #[test]
    fn the_strip_that_is_smoothed_is_one_of_the_cloth_and_the_rest_is_fixed_beyond_25_mm() {
        let x: Vec<Vec3> = [0.0, 0.17, 0.18, 0.24, 0.26, 0.4]
            .iter()
            .flat_map(|&x| [0.0, -0.4].map(|z| Vec3::new(x, 1e-3, z)))
            .collect();
        let context = context(&x, &[1e-3; 12]);
        let (fold, mut persistent) = (right_half(), lying(&x));
        let mut runner = fold.start_action(&context, &mut persistent).expect("can be folded").runner;
        // Distances beyond the line of the six columns: -0.2, -0.03, -0.02, 0.04, 0.06 and 0.2 m.
        let columns = |flags: Vec<bool>| flags.into_iter().step_by(2).collect::<Vec<_>>();
        let fixed = columns(runner.loads_at(0.5 * fold.over_s, &x).fixed);
        assert_eq!(fixed, [true, true, false, false, false, false]);
        let moved: Vec<Vec3> = x.iter().map(|p| p + Vec3::x() * 0.1).collect();
        let pressed = columns(runner.loads_at(fold.over_s + 2.0 * TUNING.fold.release_time, &moved).pressed);
        assert_eq!(pressed, [false, true, true, true, false, false]);
    }

    #[test]
    fn a_garment_that_was_laid_out_is_stroked_all_over() {
        let x: Vec<Vec3> =
            [0.0, 0.18, 0.22, 0.4].iter().flat_map(|&x| [0.0, -0.4].map(|z| Vec3::new(x, 1e-3, z))).collect();
        let context = context(&x, &[1e-3; 8]);
        let fold = right_half();
        let loads = |cut: Vec<PlaneStretch>| {
            let mut persistent = PersistentState { cut, ..lying(&x) };
            let mut runner = fold.start_action(&context, &mut persistent).expect("can be folded").runner;
            runner.loads_at(fold.over_s + 2.0 * TUNING.fold.release_time, &x)
        };
        let [lay, laid] = [Vec::new(), vec![PlaneStretch::of_axes(&Vec3::x(), &Vec3::y(), 0.2)]].map(loads);
        assert_eq!(lay.pressed.iter().filter(|pressed| **pressed).count(), 4);
        assert!(laid.pressed.iter().all(|pressed| *pressed) && laid.pressure < lay.pressure);
    }

    /// A flap that springs back half open when it is let go is held from there on, also after the action, and the run says so.
    #[test]
    fn a_flap_that_springs_back_is_held() {
        let x: Vec<Vec3> =
            [[0.0, 0.0], [0.4, 0.0], [0.0, -0.4], [0.4, -0.4]].map(|[x, z]| Vec3::new(x, 1e-3, z)).to_vec();
        let context = context(&x, &[1e-3; 4]);
        let (fold, mut persistent) = (right_half(), lying(&x));
        let mut runner = fold.start_action(&context, &mut persistent).expect("can be folded").runner;
        let flap_at = |x: f64, y: f64| {
            let flap = [0.0, -0.4].map(|z| Vec3::new(x, y, z));
            vec![Vec3::new(0.0, 1e-3, 0.0), flap[0], Vec3::new(0.0, 1e-3, -0.4), flap[1]]
        };
        let turned = flap_at(0.0, 3e-3);
        assert!(!runner.loads_at(fold.over_s, &turned).springs.is_empty());
        let later = fold.over_s + 3.0 * TUNING.fold.release_time;
        assert!(runner.loads_at(later, &turned).springs.is_empty() && runner.note().is_none());
        let sprung_back = flap_at(0.15, 0.17);
        assert!(!runner.loads_at(later, &sprung_back).springs.is_empty());
        assert!(runner.note().is_some_and(|note| note.contains("held")));
        let saved = runner.save_state().expect("can be saved");
        let mut resumed = fold.start_action(&context, &mut persistent.clone()).expect("can be folded").runner;
        assert!(resumed.restore_state(&saved, 4) && resumed.note().is_some());
        runner.finish(&mut persistent, &turned);
        assert!(!persistent.idle_loads().springs.is_empty());
    }
}
