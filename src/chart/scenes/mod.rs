//! A trial: one scene, run by one method with one setting, through the stepper of a bake.
//!
//! ```text
//! Scene + Setting -> run -> Outcome        compared with a reference -> Error
//! ```
//!
//! The scenes (one file each) have fixed steps, so that a setting is a step length and a tolerance; all share energies,
//! contact and memory with a bake. Charts `accuracy` and `stability` and the tests of `tests/methods.rs` are made of
//! them. Wall time is that of the steps alone, without what is measured between them.

mod cantilever;
mod flap;
mod flight;
mod stack;
mod swing;

pub use cantilever::Cantilever;
pub use flap::Flap;
pub use flight::Flight;
pub use stack::Stack;
pub use swing::Swing;

use crate::bake::Quality;
use crate::chart::test_sheet::Sheet;
use crate::contact::{Contact, ContactSettings};
use crate::energy::{Bending, Membrane};
use crate::error::Result;
use crate::garment::{Garment, RestState};
use crate::math::Vec3;
use crate::memory::{Memory, MemoryModel, Strains};
use crate::mesh::intersections::self_intersections;
use crate::sim::{Cloth, Method, NewtonOptions, State, StepOptions, StepRelaxation, StepReport, Stepper};
use crate::sim::{GRAVITY, Loads};
use std::time::Instant;

/// How a scene is run.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Setting {
    /// The integrator.
    pub method: Method,
    /// Length of every step [s].
    pub step: f64,
    /// Newton stops when no point would move by more than this [m].
    pub tolerance: f64,
    /// Steps as this quality of a bake chooses and solves them, `step` at most; `None` for steps of one length.
    pub quality: Option<Quality>,
}

impl Setting {
    /// Steps of one length [s], Newton to `tolerance` [m].
    pub fn fixed(method: Method, step: f64, tolerance: f64) -> Self {
        Self { method, step, tolerance, quality: None }
    }

    fn options(&self, weight: f64) -> StepOptions {
        match self.quality {
            Some(quality) => {
                let step = quality.step_options_for(weight);
                let shortest = step.min_dt.min(self.step);
                StepOptions { method: self.method, min_dt: shortest, max_dt: self.step, ..step }
            }
            None => StepOptions {
                method: self.method,
                newton: NewtonOptions {
                    displacement_tol: self.tolerance,
                    decrement_tol: 0.0,
                    rel_decrement_tol: 0.0,
                    max_iterations: MOST_ITERATIONS,
                },
                local_error_tol: f64::INFINITY,
                relaxation: StepRelaxation::OFF,
                min_dt: 1e-9,
                max_dt: self.step,
            },
        }
    }
}

/// What takes part in a scene.
pub struct Actors {
    stepper: Stepper,
    state: State,
    memory: Memory,
    /// `None` for cloth that does not remember.
    law: Option<MemoryModel>,
    garment: Garment,
    /// One flag per triangle: whether the membrane takes it as it is at the start.
    unstrained: Vec<bool>,
}

/// A scene with a beginning, a course and an end.
pub trait Scene: Sync {
    /// Its name in tables.
    fn name(&self) -> &'static str;
    /// Time at its end [s].
    fn until(&self) -> f64;
    /// Length that errors of position are a share of [m].
    fn size(&self) -> f64;
    /// Strain beyond which the cloth has failed [-].
    fn strain_bound(&self) -> f64 {
        0.3
    }
    /// What takes part, before the first step.
    fn begin(&self) -> Result<Actors>;
    /// What acts at time `t` [s] on cloth at `x` [m].
    fn drive(&self, t: f64, x: &[Vec3]) -> Loads;
    /// Times at which something starts or stops [s]: a step ends there and motion restarts.
    fn breaks(&self) -> Vec<f64> {
        Vec::new()
    }
}

/// What came out.
#[derive(Debug, Clone, PartialEq)]
pub struct Outcome {
    /// Positions at the end, one per point [m].
    pub x: Vec<Vec3>,
    /// Velocities at the end, one per point [m/s].
    pub v: Vec<Vec3>,
    /// Hinge angles at the end [rad].
    pub angle: Vec<f64>,
    /// Rest angles at the end [rad].
    pub rest_angle: Vec<f64>,
    /// Wall time of the steps [s].
    pub wall: f64,
    /// Linear systems solved (for vertex block descent: rounds).
    pub linear_solves: u64,
    /// Largest strain of any triangle along warp or weft after any step [-].
    pub largest_strain: f64,
    /// Fastest point after any step [m/s].
    pub fastest: f64,
    /// Kinetic energy at the end [J].
    pub kinetic: f64,
    /// Share of the steps that ran out of iterations [-].
    pub unconverged: f64,
    /// What is wrong with it, if it failed: it is no cloth any more.
    pub failed: Option<&'static str>,
}

impl Outcome {
    /// Largest distance of a point from where it is in `other`, as a share of `size`.
    pub fn position_error(&self, other: &Self, size: f64) -> f64 {
        self.x.iter().zip(&other.x).map(|(a, b)| (a - b).norm()).fold(0.0, f64::max) / size
    }

    /// Root mean square difference of the rest angles [rad].
    pub fn rest_angle_error(&self, other: &Self) -> f64 {
        rms(&self.rest_angle, &other.rest_angle)
    }

    /// Root mean square difference of the angles [rad].
    pub fn angle_error(&self, other: &Self) -> f64 {
        rms(&self.angle, &other.angle)
    }
}

fn rms(a: &[f64], b: &[f64]) -> f64 {
    (a.iter().zip(b).map(|(a, b)| (a - b).powi(2)).sum::<f64>() / a.len().max(1) as f64).sqrt()
}

/// Iterations of Newton at most: enough that a step that does not converge has a reason.
const MOST_ITERATIONS: usize = 40;
/// The failure that ends a run.
const NOT_A_NUMBER: &str = "not a number";

/// Runs `scene` by `setting`.
pub fn run(scene: &dyn Scene, setting: &Setting) -> Result<Outcome> {
    let mut actors = scene.begin()?;
    let weight = actors.stepper.cloth.mass.iter().sum::<f64>() * GRAVITY;
    actors.stepper.options = setting.options(weight);
    let mut outcome = Outcome {
        x: Vec::new(),
        v: Vec::new(),
        angle: Vec::new(),
        rest_angle: Vec::new(),
        wall: 0.0,
        linear_solves: 0,
        largest_strain: 0.0,
        fastest: 0.0,
        kinetic: 0.0,
        unconverged: 0.0,
        failed: None,
    };
    let (mut steps, mut unconverged, mut from) = (0u64, 0u64, 0.0);
    let mut breaks = scene.breaks();
    breaks.push(scene.until());
    'run: for to in breaks {
        // What acts changes here: a two-step method starts anew.
        actors.state.previous = None;
        let count = ((to - from) / setting.step).round().max(1.0);
        let even = (to - from) / count;
        let mut wished = even;
        while to - actors.state.time > 1e-9 {
            let left = to - actors.state.time;
            // Rounding must not leave a tiny last step.
            let h = if wished > left - 1e-9 { left } else { wished };
            steps += 1;
            let report = step(scene, &mut actors, h, &mut outcome);
            wished = if setting.quality.is_some() { report.next_dt } else { even };
            unconverged += u64::from(!report.converged);
            outcome.failed = outcome.failed.or(broken(scene, &actors, &mut outcome));
            if outcome.failed == Some(NOT_A_NUMBER) {
                break 'run;
            }
        }
        from = to;
    }
    outcome.unconverged = unconverged as f64 / steps.max(1) as f64;
    if outcome.failed.is_none() && !self_intersections(&actors.state.x, &actors.garment.triangles).is_empty()
    {
        outcome.failed = Some("layers cross");
    }
    outcome.kinetic = actors.stepper.cloth.kinetic_energy(&actors.state.v);
    let Actors { state, memory, .. } = actors;
    Ok(Outcome { x: state.x, v: state.v, angle: state.angle, rest_angle: memory.rest.rest_angle, ..outcome })
}

/// One step and the memory after it.
fn step(scene: &dyn Scene, actors: &mut Actors, h: f64, outcome: &mut Outcome) -> StepReport {
    let before = actors.state.angle.clone();
    let clock = Instant::now();
    let mut drive_at = |time: f64, state: &State| scene.drive(time, &state.x);
    let report = actors.stepper.advance(&mut actors.state, &actors.memory.effective_rest, &mut drive_at, h);
    if let Some(law) = &actors.law {
        let seen = |angle| Strains { angle, stretch: &[] };
        actors.memory.commit(law, &seen(&before), &seen(&actors.state.angle), report.dt);
    }
    outcome.wall += clock.elapsed().as_secs_f64();
    outcome.linear_solves += (report.newton.global_iterations + report.newton.local_iterations) as u64;
    report
}

/// What is wrong with the cloth after a step; notes its strain and speed.
fn broken(scene: &dyn Scene, actors: &Actors, outcome: &mut Outcome) -> Option<&'static str> {
    if !actors.state.x.iter().chain(&actors.state.v).all(|x| x.sum().is_finite()) {
        return Some(NOT_A_NUMBER);
    }
    let strains = actors.stepper.cloth.membrane.measure(&actors.state.x);
    let strain = |[u, v, _]: &[f64; 3]| (u - 1.0).abs().max((v - 1.0).abs());
    // Slivers whose altitude the membrane clamps read as strained from the beginning: they say nothing.
    let honest = strains.iter().zip(&actors.unstrained).filter(|(_, honest)| **honest);
    let largest = honest.map(|(s, _)| strain(s)).fold(0.0, f64::max);
    outcome.largest_strain = outcome.largest_strain.max(largest);
    let fastest = actors.state.v.iter().map(|v| v.norm()).fold(0.0, f64::max);
    outcome.fastest = outcome.fastest.max(fastest);
    (largest > scene.strain_bound()).then_some("drawn out")
}

/// What the cloth of a scene is made of.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Kind {
    /// [kg/m²]
    pub(super) density: f64,
    /// Along warp and weft, and half of it in shear [N/m].
    pub(super) stretch: f64,
    /// [N·m]
    pub(super) bend: f64,
    /// Relaxation times of stretch and bending [s].
    pub(super) damping: [f64; 2],
}

impl Kind {
    /// Cloth of `sheet`. Mass goes to the points by their Voronoi area where triangles are right-angled: by thirds the two
    /// ends of a row of quads would weigh 1 to 2.
    pub(super) fn cloth(&self, sheet: &Sheet, garment: &Garment) -> Cloth {
        let k = self.stretch;
        let membrane =
            Membrane::from_parts(&sheet.triangles, &garment.material, [k, k, 0.5 * k], self.damping[0]);
        let bending =
            Bending::from_parts(&garment.topology, &garment.material, [self.bend; 2], self.damping[1]);
        let mut area = vec![0.0; sheet.flat.len()];
        for (t, (m, a)) in sheet.triangles.iter().zip(garment.material.iter().zip(membrane.area())) {
            for k in 0..3 {
                let (p, q) = (m[(k + 1) % 3] - m[k], m[(k + 2) % 3] - m[k]);
                let right = p.dot(&q).abs() <= 1e-9 * p.norm() * q.norm();
                let any_right = (0..3).any(|j| {
                    let (p, q) = (m[(j + 1) % 3] - m[j], m[(j + 2) % 3] - m[j]);
                    p.dot(&q).abs() <= 1e-9 * p.norm() * q.norm()
                });
                area[t[k] as usize] += a * if right {
                    0.5
                } else if any_right {
                    0.25
                } else {
                    1.0 / 3.0
                };
            }
        }
        let mass = area.iter().map(|a| a * self.density).collect();
        Cloth { mass, area, membrane, bending }
    }

    /// Contact that can carry `layers` of it, within `distance` [m], with `friction`.
    pub(super) fn contact(
        &self,
        garment: &Garment,
        cloth: &Cloth,
        distance: f64,
        friction: f64,
        layers: f64,
    ) -> Contact {
        let mean = cloth.area.iter().sum::<f64>() / cloth.area.len() as f64;
        let load = layers * self.density * GRAVITY;
        let stiffness = (load / (0.3 * distance)).max(self.stretch / mean);
        let settings = ContactSettings::uniform(distance, stiffness, friction);
        Contact::new(settings, &garment.points, &garment.triangles, &garment.topology, cloth.area.clone())
    }
}

impl Actors {
    /// Cloth that starts at rest at the garment's points, flat in memory.
    fn new(garment: Garment, cloth: Cloth, contact: Contact) -> Self {
        let flat = vec![0.0; garment.topology.hinges.len()];
        let angle = cloth.bending.angles(&garment.points, &flat);
        let measure = cloth.membrane.measure(&garment.points);
        let unstrained =
            measure.iter().map(|[u, v, _]| (u - 1.0).abs().max((v - 1.0).abs()) < 1e-2).collect();
        Self {
            unstrained,
            state: State::at_rest(garment.points.clone(), angle),
            memory: Memory::new(RestState::new(flat, garment.triangles.len())),
            law: None,
            stepper: Stepper::new(cloth, contact, StepOptions::default()),
            garment,
        }
    }
}

/// 0 before `from`, 1 after `to`, smooth between.
fn smoothstep(t: f64, from: f64, to: f64) -> f64 {
    let u = ((t - from) / (to - from)).clamp(0.0, 1.0);
    u * u * (3.0 - 2.0 * u)
}

/// `count` + 1 values from `from` to `to`.
fn spaced(from: f64, to: f64, count: usize) -> Vec<f64> {
    (0..=count).map(|i| from + (to - from) * i as f64 / count as f64).collect()
}
