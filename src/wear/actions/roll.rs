//! `roll`: the lying garment is rolled up from one side.

use crate::wear::action_runner::{ActionContext, ActionFailure, ActionRunner, ActionStart, NeededPlace};
use crate::wear::actions::FoldSide;
use crate::wear::actions::fold::stack_height;
use crate::wear::layout::roll_map::{RollCoords, RollMap, RollRecord};
use crate::wear::motion::motion_profile::smoothstep;
use crate::wear::motion::springs::pin_spring;
use crate::wear::persistent_state::{GarmentFrame, PersistentState, TurnRecord};
use crate::wear::tuning::TUNING;
use crate::wear::wear_action::WearAction;
use crease_geometry::math::Vec3;
use crease_model::error::Result;
use crease_solver::energy::TargetSpring;
use crease_solver::sim::Loads;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use serde_json::Value;

/// Roll the lying garment up from one side, with all the layers that lie there, and hold it as a band does. `unfold` opens it.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Roll {
    /// Side where the roll begins. Default `lower`.
    #[serde(default = "default_from")]
    pub from: FoldSide,
    /// Radius of the inmost winding [m]; larger where a thick stack needs it. Default 0.03.
    #[serde(rename = "radius", default = "default_radius_m")]
    #[schemars(range(min = 0.005, max = 1))]
    pub radius_m: f64,
    /// Duration of rolling it up [s]. Default 4.
    #[serde(rename = "over", default = "default_over_s")]
    #[schemars(extend("exclusiveMinimum" = 0), range(max = 3600))]
    pub over_s: f64,
    /// Time that it is held afterwards [s]. Default 0.
    #[serde(rename = "hold", default)]
    #[schemars(range(min = 0, max = 86400))]
    pub hold_s: f64,
}

fn default_from() -> FoldSide {
    FoldSide::Lower
}

fn default_radius_m() -> f64 {
    0.03
}

fn default_over_s() -> f64 {
    4.0
}

impl Default for Roll {
    fn default() -> Self {
        Self { from: default_from(), radius_m: default_radius_m(), over_s: default_over_s(), hold_s: 0.0 }
    }
}

impl Roll {
    /// Unit vector in which the roll proceeds on a garment with the frame `frame`.
    fn forward(&self, frame: &GarmentFrame) -> Vec3 {
        match self.from {
            FoldSide::Left => frame.right.normalize(),
            FoldSide::Right => -frame.right.normalize(),
            FoldSide::Lower => frame.upward.normalize(),
            FoldSide::Upper => -frame.upward.normalize(),
        }
    }
}

impl WearAction for Roll {
    fn duration(&self) -> f64 {
        self.over_s + self.hold_s
    }

    fn start_action(&self, context: &ActionContext, persistent: &mut PersistentState) -> Result<ActionStart> {
        let Some(frame) = persistent.open_frame() else {
            return Err(context.refuse_place("roll", NeededPlace::Open));
        };
        let (x, thickness) = (context.positions, context.thickness);
        let forward = self.forward(&frame);
        let places = x.iter().map(|p| (p - frame.origin).dot(&forward));
        let (low, high) =
            places.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), s| (low.min(s), high.max(s)));
        let length = high - low;
        let pitch = TUNING.roll.winding_clearance * (stack_height(x.iter(), thickness) + thickness);
        let ground = persistent.ground.unwrap_or(0.0);
        let begin = frame.origin + forward * low;
        let map = RollMap {
            origin: Vec3::new(begin.x, ground, begin.z),
            along: forward.cross(&Vec3::y()),
            forward,
            core: self.radius_m.max(TUNING.roll.core_clearance * RollMap::min_core(length, pitch)),
            pitch,
        };
        ActionStart::here(RollRunner {
            record: RollRecord { map, length, coords: x.iter().map(|p| map.coords(p)).collect() },
            start: x.to_vec(),
            masses: context.masses.to_vec(),
            over: self.over_s,
            idle_loads: persistent.idle_loads(),
        })
    }

    fn example() -> Self {
        Self { from: FoldSide::Upper, radius_m: 0.04, over_s: 3.0, hold_s: 10.0 }
    }
}

/// A garment that is rolled up and held.
struct RollRunner {
    record: RollRecord,
    /// Positions at the start [m], one per point.
    start: Vec<Vec3>,
    /// [kg], one per point.
    masses: Vec<f64>,
    /// Duration of rolling up [s].
    over: f64,
    idle_loads: Loads,
}

impl RollRunner {
    /// Springs that carry what is rolled up at the length `u` [m] and hold what lies directly before the roll.
    fn springs(&self, u: f64) -> Vec<TargetSpring> {
        let before = u + TUNING.roll.held_length;
        let points = self.record.coords.iter().enumerate();
        let sprung = points.filter(|(_, at)| at.s <= before).map(|(p, at)| {
            if at.s > u {
                pin_spring(p as u32, self.start[p], self.masses[p])
            } else {
                self.record.spring(p, u, self.masses[p])
            }
        });
        sprung.collect()
    }
}

impl ActionRunner for RollRunner {
    fn loads_at(&mut self, t: f64, _x: &[Vec3]) -> Loads {
        let turning = t <= self.over * (1.0 + 1e-9);
        let u = self.record.length * smoothstep(t / self.over);
        let is_before = |at: &RollCoords| at.s > u + TUNING.roll.held_length;
        Loads {
            springs: self.springs(u),
            guided: turning,
            fixed: if turning { self.record.coords.iter().map(is_before).collect() } else { Vec::new() },
            max_dt: if turning { self.record.max_dt(self.over) } else { self.idle_loads.max_dt },
            ..self.idle_loads.clone()
        }
    }

    fn event_times(&self) -> Vec<f64> {
        vec![self.over]
    }

    fn save_state(&self) -> Option<Value> {
        Some(Value::Null)
    }

    fn failure(&self, x: &[Vec3]) -> Option<ActionFailure> {
        let distance = self.record.mean_distance(x, self.record.length, &self.masses);
        (distance > TUNING.failure.max_roll_distance * self.record.map.core).then(|| ActionFailure {
            message: format!(
                "the garment is not rolled up: its points are {:.0} mm from their places in the roll, on average",
                1e3 * distance
            ),
            help: "roll more slowly (`over`) or more loosely (`radius`), or fold the garment less before".into(),
        })
    }

    fn finish(&mut self, persistent: &mut PersistentState, x: &[Vec3]) {
        persistent.held_loads = Some(self.loads_at(f64::INFINITY, x));
        persistent.turns.push(TurnRecord::Roll(self.record.clone()));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Points of two layers of a sheet of 0.6 x 0.4 m that lies on the ground.
    fn sheet() -> Vec<Vec3> {
        let place = |k: usize| [0.05 * (k % 13) as f64, 0.05 * ((k / 13) % 9) as f64];
        (0..2 * 13 * 9)
            .map(|k| (place(k), if k < 13 * 9 { 5e-4 } else { 15e-4 }))
            .map(|([x, z], y)| Vec3::new(x, y, -z))
            .collect()
    }

    fn start(roll: &Roll, x: &[Vec3], persistent: &mut PersistentState) -> Result<ActionStart> {
        let masses = vec![1e-3; x.len()];
        let context = ActionContext {
            positions: x,
            source_positions: x,
            triangles: &[],
            masses: &masses,
            thickness: 1e-3,
            script_file: "w.json",
            location: "0",
        };
        roll.start_action(&context, persistent)
    }

    #[test]
    fn every_side_is_rolled_up_to_the_other_and_opens_again() {
        let x = sheet();
        for (from, [towards_x, towards_z]) in [
            (FoldSide::Left, [0.6, 0.0]),
            (FoldSide::Right, [-0.6, 0.0]),
            (FoldSide::Lower, [0.0, -0.4]),
            (FoldSide::Upper, [0.0, 0.4]),
        ] {
            let lying = PersistentState {
                frame: Some(GarmentFrame::lying(&x)),
                ground: Some(0.0),
                ..PersistentState::default()
            };
            let mut persistent = lying.clone();
            let roll = Roll { from, ..Roll::default() };
            let mut runner = start(&roll, &x, &mut persistent).expect("can be rolled").runner;
            // What is not reached yet does not move.
            let half = runner.loads_at(0.5 * roll.over_s, &x);
            let fixed = half.fixed.iter().filter(|fixed| **fixed).count();
            assert!(half.guided && fixed > x.len() / 4 && fixed < x.len() / 2, "{from:?}: {fixed}");
            let end = runner.loads_at(roll.over_s + 1.0, &x);
            assert!(!end.guided && end.fixed.is_empty() && end.springs.len() == x.len());
            runner.finish(&mut persistent, &x);
            let [TurnRecord::Roll(record)] = &persistent.turns[..] else { panic!("one roll") };
            // All of it is around an axis at the other side.
            let rolled: Vec<Vec3> =
                record.coords.iter().map(|at| record.map.rolled(at, record.length)).collect();
            let mean = |points: &[Vec3]| points.iter().sum::<Vec3>() / points.len() as f64;
            let moved = mean(&rolled) - mean(&x);
            let wanted = 0.5 * Vec3::new(towards_x, 0.0, towards_z);
            assert!((moved - wanted - Vec3::y() * moved.y).norm() < 0.02, "{from:?}: {moved}");
            assert!(runner.failure(&rolled).is_none());
            assert!(runner.failure(&x).is_some_and(|failure| failure.message.contains("not rolled up")));

            let masses = vec![1.0; x.len()];
            assert!(record.unrolled_fraction(&x, &masses) > 0.999);
            assert!(record.unrolled_fraction(&rolled, &masses) < 0.001);
            assert!(persistent.open_frame().is_none() && persistent.idle_loads().springs.len() == x.len());
            assert!(start(&roll, &x, &mut persistent).is_err(), "a roll is not rolled again");
        }
    }

    #[test]
    fn cloth_that_does_not_lie_is_not_rolled() {
        let x = sheet();
        let refused = start(&Roll::default(), &x, &mut PersistentState::default()).err().expect("refused");
        assert!(refused.to_string().contains("lay it first"), "{refused}");
    }
}
