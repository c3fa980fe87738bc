//! `fold`: one side of a line is turned over, as hands fold cloth on a table.

use crate::energy::TargetSpring;
use crate::error::Result;
use crate::math::Vec3;
use crate::sim::Loads;
use crate::wear::action_runner::{
    ActionContext, ActionRunner, ActionStart, FoldRecord, GarmentFrame, PersistentState, carry_spring,
    pin_spring, smoothstep,
};
use crate::wear::actions::{FieldError, WearAction};
use crate::wear::crease_prediction::FoldLayout;
use crate::wear::fold_map::{Axis, OnSheet};
use crate::wear::height_field::HeightField;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use serde_json::Value;
use std::f64::consts::PI;

/// Turn one side of a line over the rest, and hold it there. Folds stack: all layers that lie there go along.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Fold {
    /// Two points of the line, [x, y] in fractions 0..1 of the bounding box. The line goes on beyond them.
    pub line: [Fraction2; 2],
    /// Which side of the line is turned over.
    pub side: Side,
    /// How far it is turned [degrees]: 180 lays it flat on the rest. Default 180.
    #[serde(rename = "angle", default = "angle_deg")]
    #[schemars(extend("exclusiveMinimum" = 0), range(max = 180))]
    pub angle_deg: f64,
    /// How long turning takes [s]. Default 2.
    #[serde(rename = "over", default = "over_s")]
    #[schemars(extend("exclusiveMinimum" = 0), range(max = 3600))]
    pub over_s: f64,
    /// How long it is held afterwards [s]. Default 0.
    #[serde(rename = "hold", default)]
    #[schemars(range(min = 0, max = 86400))]
    pub hold_s: f64,
}

/// [x, y] in fractions 0..1 of the garment's bounding box as it lies or hangs, x to the right, y upward.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(transparent)]
pub struct Fraction2(#[schemars(inner(range(min = -10, max = 10)))] pub [f64; 2]);

impl Fraction2 {
    /// From the left edge, in widths.
    pub fn x(self) -> f64 {
        self.0[0]
    }

    /// From the lower edge, in heights.
    pub fn y(self) -> f64 {
        self.0[1]
    }
}

/// A side of a line, as seen from above with the garment's upper edge away from the viewer.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Side {
    /// Where x is smaller than on the line.
    Left,
    /// Where x is larger than on the line.
    Right,
    /// Where y is larger than on the line.
    Upper,
    /// Where y is smaller than on the line.
    Lower,
}

fn angle_deg() -> f64 {
    180.0
}

fn over_s() -> f64 {
    2.0
}

impl Fold {
    /// Whether a point, in fractions, is on the side that is turned over.
    pub fn turns(&self, point: Fraction2) -> bool {
        let [a, b] = self.line;
        let (dx, dy) = (b.x() - a.x(), b.y() - a.y());
        // Positive on the left of the direction a -> b.
        let left_of_direction = dx * (point.y() - a.y()) - dy * (point.x() - a.x());
        match self.side {
            Side::Left => left_of_direction * dy > 0.0,
            Side::Right => left_of_direction * dy < 0.0,
            Side::Upper => left_of_direction * dx > 0.0,
            Side::Lower => left_of_direction * dx < 0.0,
        }
    }
}

impl Fold {
    /// A place on the line [m], and unit vectors along it and from it to what is turned over.
    fn line_in(&self, frame: &GarmentFrame) -> (Vec3, Vec3, Vec3) {
        let [a, b] = self.line.map(|f| frame.place(f.0));
        let along = (b - a).normalize();
        let across = along.cross(&Vec3::y());
        let out = if self.turns(Fraction2(frame.fraction(&(a + across)))) { across } else { -across };
        (a, along, out)
    }
}

impl WearAction for Fold {
    fn duration(&self) -> f64 {
        self.over_s + self.hold_s
    }

    fn validate(&self) -> Vec<FieldError> {
        let [a, b] = self.line;
        let (dx, dy) = ((b.x() - a.x()).abs(), (b.y() - a.y()).abs());
        // A line shorter than a millionth of the garment has no direction worth trusting.
        const LEAST: f64 = 1e-6;
        if dx.max(dy) < LEAST {
            let what = "the two points of the line are the same: it has no direction";
            return vec![FieldError::new("line", what, "give two points apart from each other")];
        }
        match self.side {
            Side::Left | Side::Right if dy < LEAST => {
                vec![FieldError::new(
                    "side",
                    "a level line has no left and no right side",
                    "use `upper` or `lower`",
                )]
            }
            Side::Upper | Side::Lower if dx < LEAST => {
                vec![FieldError::new(
                    "side",
                    "an upright line has no upper and no lower side",
                    "use `left` or `right`",
                )]
            }
            _ => Vec::new(),
        }
    }

    /// Marks its line and lays the flap over.
    fn sketch(&self, sketch: &mut FoldLayout) {
        match sketch.ground_frame() {
            Some(frame) if self.angle_deg > LAID_OVER => {
                let (a, _, out) = self.line_in(&frame);
                sketch.fold(a, out);
            }
            _ => sketch.anywhere(),
        }
    }

    fn start_action(&self, context: &ActionContext, persistent: &mut PersistentState) -> Result<ActionStart> {
        let Some(frame) = persistent.ground_frame() else {
            return Err(context.refuse("`fold` needs a garment that lies", "lay it first: {\"lay\": {}}"));
        };
        let (a, along, out) = self.line_in(&frame);
        // A stack bends over half its circumference: its middle shall come to lie on the line.
        let thick = stack_height(
            context.positions.iter().filter(|p| (*p - a).dot(&out).abs() < GRIP_WIDTH),
            context.thickness,
        );
        let a = a - out * (0.25 * PI * thick);
        let beyond = |p: &Vec3| (p - a).dot(&out);
        let (flap, rest): (Vec<u32>, Vec<u32>) =
            (0..context.positions.len() as u32).partition(|&p| beyond(&context.positions[p as usize]) > 0.0);
        if flap.is_empty() || rest.is_empty() {
            let side = if flap.is_empty() { "nothing" } else { "everything" };
            return Err(context.refuse(
                format!("{side} lies on the side of the line that is turned"),
                "move the line: fractions of the box run from 0 to 1, x to the right, y upward",
            ));
        }
        // The axis runs over the stack as it is along the line; bulges elsewhere are pressed down as the flap lands.
        let top = stack_height(
            context.positions.iter().filter(|p| beyond(p).abs() < GRIP_WIDTH),
            context.thickness,
        );
        let axis_height = top + 0.75 * context.thickness;
        let axis = Axis {
            origin: Vec3::new(a.x, axis_height, a.z),
            along,
            out,
            least_depth: 0.5 * context.thickness,
        };
        let under = HeightField::over(rest.iter().map(|&p| context.positions[p as usize]));
        let guided = flap
            .iter()
            .map(|&p| {
                let place = axis.on_sheet(&context.positions[p as usize], 0.0);
                let rise = under.rise(&axis.turned(&place, PI), top);
                let straight = ((place.s - PI * place.depth) / RISE_RAMP).clamp(0.0, 1.0);
                Guided { point: p, place, rise: rise * straight, mass: context.masses[p as usize] }
            })
            .collect();
        // A hand on the part that stays, along the line.
        let stay = rest
            .iter()
            .filter(|&&p| beyond(&context.positions[p as usize]) > -GRIP_WIDTH)
            .map(|&p| pin_spring(p, context.positions[p as usize], context.masses[p as usize]))
            .collect();
        // The rest sleeps on the table while the flap is turned: nothing moves it.
        let held = context.positions.iter().map(|p| beyond(p) <= -GRIP_WIDTH).collect();
        let made = FoldRecord { flap, origin: a, along, out, angle: self.angle_deg.to_radians() };
        let resting = persistent.idle_loads();
        ActionStart::here(Turn { axis, guided, stay, held, made, over: self.over_s, resting })
    }

    fn example() -> Self {
        Self {
            line: [Fraction2([0.3, 0.0]), Fraction2([0.35, 1.0])],
            side: Side::Left,
            angle_deg: 170.0,
            over_s: 2.5,
            hold_s: 5.0,
        }
    }
}

/// A flap turned by more than this lies on the rest [degrees].
const LAID_OVER: f64 = 150.0;
/// Width of the hand that holds the resting part along the line [m].
pub(in crate::wear) const GRIP_WIDTH: f64 = 0.05;
/// A step turns the flap by this angle at most [rad].
pub(in crate::wear) const MAX_TURN_PER_STEP: f64 = 0.12;
/// Share of the points along the line that lie no higher than the stack; the others are bulges of older folds.
const STACK_SHARE: f64 = 0.9;
/// How long hands take to let go of a flap that lies [s].
const LETTING_GO: f64 = 0.4;
/// Pressure of palms that smooth a fold along its line while it is held [Pa]: 10 N over a fold of 0.5 m.
const PALM_PRESSURE: f64 = 200.0;
/// Drag of hands that let go [1/s].
const HAND_DRAG: f64 = 20.0;
/// Folds beyond this angle lie by themselves; others are held until they are opened or released [rad].
const LIES_BEYOND: f64 = 3.0;

/// Way from where the sheet is straight again over which the rise comes in [m].
const RISE_RAMP: f64 = 0.03;

/// How high a stack of points is [m]; of a layer's `thickness` where there are none.
fn stack_height<'a>(points: impl Iterator<Item = &'a Vec3>, thickness: f64) -> f64 {
    let mut heights: Vec<f64> = points.map(|p| p.y).collect();
    heights.sort_unstable_by(f64::total_cmp);
    heights.get((STACK_SHARE * heights.len() as f64) as usize).copied().unwrap_or(thickness)
}

/// A flap that is being turned over.
struct Turn {
    axis: Axis,
    guided: Vec<Guided>,
    stay: Vec<TargetSpring>,
    /// Points that sleep meanwhile, one flag per point.
    held: Vec<bool>,
    made: FoldRecord,
    over: f64,
    resting: Loads,
}

/// A point of the flap.
struct Guided {
    point: u32,
    /// Where on its sheet.
    place: OnSheet,
    /// How much higher it lands than on a plane [m].
    rise: f64,
    /// [kg].
    mass: f64,
}

impl Turn {
    /// What acts `t` seconds after the flap was let go: palms lie on the new fold and smooth it.
    fn smoothed(&self, t: f64, x: &[Vec3]) -> Loads {
        let near = |p: &Vec3| (p - self.made.origin).dot(&self.made.out).abs() < GRIP_WIDTH;
        Loads {
            pressure: PALM_PRESSURE * smoothstep(t / LETTING_GO),
            pressed: x.iter().map(near).collect(),
            max_dt: if t < LETTING_GO { LETTING_GO / 4.0 } else { f64::INFINITY },
            transient: t < LETTING_GO,
            ..self.resting.clone()
        }
    }
}

impl ActionRunner for Turn {
    fn loads_at(&mut self, t: f64, x: &[Vec3]) -> Loads {
        let turning = t <= self.over * (1.0 + 1e-9);
        let grip = if turning || self.made.angle <= LIES_BEYOND {
            1.0
        } else {
            1.0 - smoothstep((t - self.over) / LETTING_GO)
        };
        if grip <= 0.0 {
            return self.smoothed(t - self.over - LETTING_GO, x);
        }
        let phi = self.made.angle * smoothstep(t / self.over);
        let lifted = smoothstep(phi / PI);
        let flap = self.guided.iter().map(|g| {
            let normal = self.axis.normal(&g.place, phi);
            let target = self.axis.turned(&g.place, phi) + normal * (g.rise * lifted);
            carry_spring(g.point, target, normal, g.mass).scaled(grip)
        });
        // The smooth motion is 1.5 times as fast in the middle as on average.
        let longest_step =
            if turning { MAX_TURN_PER_STEP * self.over / (1.5 * self.made.angle) } else { LETTING_GO / 4.0 };
        let held = if turning { self.held.clone() } else { Vec::new() };
        let stay = self.stay.iter().map(|guide| guide.scaled(grip));
        // Hands that let go slow down what they held.
        let drag = self.resting.drag + if turning { 0.0 } else { HAND_DRAG * grip };
        Loads {
            springs: flap.chain(stay).collect(),
            guided: turning,
            transient: grip < 1.0,
            fixed: held,
            drag,
            max_dt: longest_step,
            ..self.resting.clone()
        }
    }

    fn event_times(&self) -> Vec<f64> {
        vec![self.over, self.over + LETTING_GO, self.over + 2.0 * LETTING_GO]
    }

    fn save_state(&self) -> Option<Value> {
        Some(Value::Null)
    }

    fn finish(&mut self, persistent: &mut PersistentState, x: &[Vec3]) {
        if self.made.angle <= LIES_BEYOND {
            persistent.held_loads = Some(self.loads_at(f64::INFINITY, x));
        }
        persistent.folds.push(self.made.clone());
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sides_do_not_depend_on_the_direction_of_the_line() {
        for (side, inside, outside) in [
            (Side::Left, [0.1, 0.5], [0.9, 0.5]),
            (Side::Right, [0.9, 0.5], [0.1, 0.5]),
            (Side::Upper, [0.5, 0.9], [0.5, 0.1]),
            (Side::Lower, [0.5, 0.1], [0.5, 0.9]),
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

    /// Only while hands let go, and palms come down after them, is what acts on its way to something else.
    #[test]
    fn a_fold_that_is_held_passes_to_nothing() {
        let x: Vec<Vec3> =
            [[0.0, 0.0], [0.4, 0.0], [0.0, -0.4], [0.4, -0.4]].map(|[x, z]| Vec3::new(x, 1e-3, z)).to_vec();
        let context = ActionContext {
            positions: &x,
            source_positions: &x,
            masses: &[1e-3; 4],
            thickness: 1e-3,
            script_file: "w.json",
            location: "0",
        };
        let over = 2.0;
        for (angle_deg, passes) in [(180.0, true), (90.0, false)] {
            let frame = Some(crate::wear::GarmentFrame::lying(&x));
            let mut persistent = PersistentState { frame, ground: Some(0.0), ..PersistentState::default() };
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
                assert_eq!(at(over + t * LETTING_GO).transient, passes, "{angle_deg} {t}");
            }
            assert!(!at(over + 2.5 * LETTING_GO).transient);
            runner.finish(&mut persistent, &x);
            assert!(!persistent.idle_loads().transient);
        }
    }
}
