//! Running a scene: settings, the loop over steps, and the outcome.

use crate::scenes::scene::{Scene, SceneState};
use crate::statistics::rms_difference;
use crease::internal::bake::Quality;
use crease_geometry::math::Vec3;
use crease_geometry::mesh::intersections::self_intersections;
use crease_model::error::Result;
use crease_solver::memory::Strains;
use crease_solver::sim::{GRAVITY, Method, NewtonOptions, State, StepOptions, StepRelaxation, StepReport};
use std::time::Instant;

/// Newton iterations per step; a step that exceeds them does not converge for another reason than this limit.
const MAX_NEWTON_ITERATIONS: usize = 40;
/// Shortest step of fixed stepping [s].
const MIN_FIXED_STEP: f64 = 1e-9;
/// Difference below which two times are equal [s].
const TIME_TOL: f64 = 1e-9;
/// The failure that ends a run.
const NOT_A_NUMBER: &str = "not a number";

/// Integrator, step size and tolerance of a run.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SceneSetting {
    /// The integrator.
    pub method: Method,
    /// Size of every step; with `quality` the largest one [s].
    pub step: f64,
    /// Displacement tolerance of Newton [m].
    pub tolerance: f64,
    /// Quality of a bake whose step control and tolerances are used; `None` for fixed steps.
    pub quality: Option<Quality>,
}

impl SceneSetting {
    /// Fixed steps of `step` [s], Newton to `tolerance` [m].
    pub fn fixed(method: Method, step: f64, tolerance: f64) -> Self {
        Self { method, step, tolerance, quality: None }
    }

    /// Step options for cloth of `weight` [N].
    fn options(&self, weight: f64) -> StepOptions {
        match self.quality {
            Some(quality) => {
                let step = quality.step_options_for(weight);
                let min_dt = step.min_dt.min(self.step);
                StepOptions { method: self.method, min_dt, max_dt: self.step, ..step }
            }
            None => StepOptions {
                method: self.method,
                newton: NewtonOptions {
                    displacement_tol: self.tolerance,
                    decrement_tol: 0.0,
                    rel_decrement_tol: 0.0,
                    max_iterations: MAX_NEWTON_ITERATIONS,
                },
                local_error_tol: f64::INFINITY,
                relaxation: StepRelaxation::OFF,
                min_dt: MIN_FIXED_STEP,
                max_dt: self.step,
            },
        }
    }
}

/// Outcome of a run.
#[derive(Debug, Clone, PartialEq)]
pub struct SceneOutcome {
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
    /// Linear systems solved (for vertex block descent: sweeps).
    pub linear_solves: u64,
    /// Largest strain of any triangle along warp or weft after any step [-].
    pub max_strain: f64,
    /// Largest speed of a point after any step [m/s].
    pub max_speed: f64,
    /// Kinetic energy at the end [J].
    pub kinetic_energy: f64,
    /// Fraction of the steps that did not converge [-].
    pub unconverged_fraction: f64,
    /// Reason of a failure: the result is not a state of cloth.
    pub failed: Option<&'static str>,
}

impl SceneOutcome {
    /// Largest distance between a point here and in `other`, over `size` [-].
    pub fn position_error(&self, other: &Self, size: f64) -> f64 {
        self.x.iter().zip(&other.x).map(|(a, b)| (a - b).norm()).fold(0.0, f64::max) / size
    }

    /// Root mean square difference of the rest angles [rad].
    pub fn rest_angle_error(&self, other: &Self) -> f64 {
        rms_difference(&self.rest_angle, &other.rest_angle)
    }

    /// Root mean square difference of the angles [rad].
    pub fn angle_error(&self, other: &Self) -> f64 {
        rms_difference(&self.angle, &other.angle)
    }
}

/// Runs `scene` with `setting`.
///
/// # Errors
/// If the scene cannot be set up; failures of the run are part of the outcome.
pub fn run(scene: &dyn Scene, setting: &SceneSetting) -> Result<SceneOutcome> {
    let mut scene_state = scene.initial_state()?;
    let weight = scene_state.stepper.cloth.mass.iter().sum::<f64>() * GRAVITY;
    scene_state.stepper.options = setting.options(weight);
    let mut outcome = SceneOutcome {
        x: Vec::new(),
        v: Vec::new(),
        angle: Vec::new(),
        rest_angle: Vec::new(),
        wall: 0.0,
        linear_solves: 0,
        max_strain: 0.0,
        max_speed: 0.0,
        kinetic_energy: 0.0,
        unconverged_fraction: 0.0,
        failed: None,
    };
    let (mut steps, mut unconverged, mut from) = (0u64, 0u64, 0.0);
    let mut ends = scene.event_times();
    ends.push(scene.until());
    'run: for to in ends {
        // The loads are discontinuous here: a multistep integrator restarts.
        scene_state.state.previous = None;
        let count = ((to - from) / setting.step).round().max(1.0);
        let fixed_dt = (to - from) / count;
        let mut dt_request = fixed_dt;
        while to - scene_state.state.time > TIME_TOL {
            let left = to - scene_state.state.time;
            // Rounding must not leave a tiny last step.
            let h = if dt_request > left - TIME_TOL { left } else { dt_request };
            steps += 1;
            let report = step(scene, &mut scene_state, h, &mut outcome);
            dt_request = if setting.quality.is_some() { report.next_dt } else { fixed_dt };
            unconverged += u64::from(!report.converged);
            outcome.failed = outcome.failed.or(failure(scene, &scene_state, &mut outcome));
            if outcome.failed == Some(NOT_A_NUMBER) {
                break 'run;
            }
        }
        from = to;
    }
    outcome.unconverged_fraction = unconverged as f64 / steps.max(1) as f64;
    if outcome.failed.is_none()
        && !self_intersections(&scene_state.state.x, &scene_state.garment.triangles).is_empty()
    {
        outcome.failed = Some("layers intersect");
    }
    outcome.kinetic_energy = scene_state.stepper.cloth.kinetic_energy(&scene_state.state.v);
    let SceneState { state, memory, .. } = scene_state;
    Ok(SceneOutcome {
        x: state.x,
        v: state.v,
        angle: state.angle,
        rest_angle: memory.rest.rest_angle,
        ..outcome
    })
}

/// Advances by one step and commits it to memory.
fn step(scene: &dyn Scene, scene_state: &mut SceneState, h: f64, outcome: &mut SceneOutcome) -> StepReport {
    let before = scene_state.state.angle.clone();
    let clock = Instant::now();
    let mut loads_at = |time: f64, state: &State| scene.loads(time, &state.x);
    let report = scene_state.stepper.advance(
        &mut scene_state.state,
        &scene_state.memory.effective_rest,
        &mut loads_at,
        h,
    );
    if let Some(law) = &scene_state.law {
        let strains = |angle| Strains { angle, stretch: &[] };
        scene_state.memory.commit(law, &strains(&before), &strains(&scene_state.state.angle), report.dt);
    }
    outcome.wall += clock.elapsed().as_secs_f64();
    outcome.linear_solves += (report.newton.global_iterations + report.newton.local_iterations) as u64;
    report
}

/// Reason of a failure after a step, if there is one; updates the largest strain and speed.
fn failure(scene: &dyn Scene, scene_state: &SceneState, outcome: &mut SceneOutcome) -> Option<&'static str> {
    if !scene_state.state.x.iter().chain(&scene_state.state.v).all(|x| x.sum().is_finite()) {
        return Some(NOT_A_NUMBER);
    }
    let strains = scene_state.stepper.cloth.membrane.measure(&scene_state.state.x);
    let strain = |[u, v, _]: &[f64; 3]| (u - 1.0).abs().max((v - 1.0).abs());
    let measured = strains.iter().zip(&scene_state.unstrained).filter(|(_, unstrained)| **unstrained);
    let max_strain = measured.map(|(s, _)| strain(s)).fold(0.0, f64::max);
    outcome.max_strain = outcome.max_strain.max(max_strain);
    let max_speed = scene_state.state.v.iter().map(|v| v.norm()).fold(0.0, f64::max);
    outcome.max_speed = outcome.max_speed.max(max_speed);
    (max_strain > scene.max_strain()).then_some("overstretched")
}
