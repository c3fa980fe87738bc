//! A strip of cloth that falls on the ground and comes to rest: scene of the paper's Table 1.
//!
//! A strip of 32 x 44 cm of KOW's T-shirt hangs upright with its short edge above the ground, slightly tilted and
//! bowed, and falls. It is at rest when the residual, the unbalanced force over the weight (root mean square over the
//! mass), stays below a hundredth for a quarter of a second. Self-contact, friction and ground are those of a bake.

use crate::test_sheet::TestSheet;
use crease::internal::bake::Quality;
use crease_geometry::math::Vec3;
use crease_linear::SolveCost;
use crease_model::error::Result;
use crease_model::fabric::Fabric;
use crease_model::garment::{Garment, RestState};
use crease_solver::contact::{Contact, ContactSettings};
use crease_solver::memory::{Memory, MemoryModel, Strains};
use crease_solver::sim::{
    Cloth, GRAVITY, Loads, Method, NewtonSeconds, State, StepOptions, StepRelaxation, Stepper,
};
use std::time::Instant;

/// Points of the paper's meshes.
pub(super) const FALLING_STRIP_POINTS: [usize; 3] = [156, 603, 2306];
/// Residual below which the strip is at rest, over its weight [-].
pub(super) const REST_RESIDUAL: f64 = 1e-2;
/// Time for which the residual must stay below that [s].
pub(super) const REST_DURATION: f64 = 0.25;
/// Tilt of the strip in the first run [rad]: a vertical strip has no direction to fall in.
pub(super) const FIRST_TILT: f64 = 0.10;

/// Height of the hanging strip [m].
const HEIGHT: f64 = 0.44;
/// Width of the hanging strip [m].
const WIDTH: f64 = 0.32;
/// Size of a fixed step, and of the first adaptive one [s].
const STEP: f64 = 1.0 / 60.0;
/// Smallest number of adaptive steps within the duration of rest.
const MIN_STEPS_OF_REST: f64 = 4.0;
/// Simulated time after which a run ends [s].
const MAX_TIME: f64 = 20.0;
/// Height of the lower edge above the ground at the start [m].
const DROP_HEIGHT: f64 = 0.02;
/// Increase of the tilt from run to run [rad].
const TILT_INCREMENT: f64 = 0.01;
/// Depth of the strip's bow [m].
const BOW_DEPTH: f64 = 0.01;
/// Strain by the strip's weight: stretch is softened to it, as in a bake [-].
const WEIGHT_STRAIN: f64 = 0.005;
/// Largest activation distance of contact over the mean edge [-].
const MAX_DISTANCE_FRACTION: f64 = 0.2;
/// Air drag [1/s].
const DRAG: f64 = 0.5;

/// Control of the step size.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Stepping {
    /// Fixed steps, each solved to the tolerances of the default quality, so that numbers of steps are comparable.
    Fixed,
    /// Adaptive steps with the error control of the default quality, without the limit by memory events; at least a
    /// few within the duration of rest.
    Adaptive,
    /// Fixed steps of BDF2 without drag and without damping of the cloth: nothing but memory, friction and the integrator takes energy.
    Undamped,
}

/// Result and cost of a fall.
#[derive(Debug, Clone, PartialEq)]
pub struct Fall {
    /// Time at which the strip came to rest [s]; `None` if it did not.
    pub stabilised: Option<f64>,
    /// Wall time [s].
    pub wall: f64,
    /// Steps until then.
    pub steps: u64,
    /// Global Newton iterations until then.
    pub iterations: u64,
    /// Local Newton iterations until then.
    pub local_iterations: u64,
    /// Operations and memory traffic of the linear solves.
    pub cost: SolveCost,
    /// Wall time of Newton by stage [s].
    pub seconds: NewtonSeconds,
    /// Memory events.
    pub events: u64,
    /// Time [s] and residual [-] of every step.
    pub residuals: Vec<[f64; 2]>,
}

/// Makes the strip of about `points` points before its fall, tilted by `tilt` [rad].
pub(super) fn tilted_strip(points: usize, tilt: f64) -> Result<Garment> {
    let sheet = TestSheet::unstructured(HEIGHT, WIDTH, points)?;
    let (sin, cos) = tilt.sin_cos();
    let position = |along: f64, across: f64| {
        let height = along + 0.5 * HEIGHT;
        let bow = BOW_DEPTH * (std::f64::consts::PI * height / HEIGHT).sin() * (1.0 + across / WIDTH);
        Vec3::new(height * sin + bow * cos, DROP_HEIGHT + height * cos - bow * sin + BOW_DEPTH, across)
    };
    let points = sheet.flat.iter().map(|p| position(p.x, p.y)).collect();
    Ok(sheet.garment(points))
}

/// Makes the solver of a strip.
fn stepper(garment: &Garment, fabric: &Fabric, stepping: Stepping) -> Stepper {
    let mut fabric = fabric.clone();
    if stepping == Stepping::Undamped {
        (fabric.stretch_damping_s, fabric.bend_damping_s) = (0.0, 0.0);
    }
    let fabric = &fabric;
    let mut cloth = Cloth::new(garment, fabric);
    let max_stiffness = fabric.area_density() * GRAVITY * HEIGHT / WEIGHT_STRAIN;
    let stiffness = fabric.stretch_warp().min(max_stiffness);
    cloth.membrane.set_stiffness([stiffness, stiffness, fabric.shear().min(max_stiffness)]);
    let area: f64 = cloth.area.iter().sum();
    let edge = (area / garment.points.len() as f64).sqrt();
    let dhat = fabric.thickness().min(MAX_DISTANCE_FRACTION * edge);
    let contact_stiffness = stiffness / (area / garment.points.len() as f64);
    let settings = ContactSettings::for_fabric(fabric, dhat, contact_stiffness, true);
    let contact =
        Contact::new(settings, &garment.points, &garment.triangles, &garment.topology, cloth.area.clone());
    // Tolerances are those of a bake of the default quality.
    let step = Quality::Standard.step_options_for(cloth.mass.iter().sum::<f64>() * GRAVITY);
    let options = match stepping {
        Stepping::Fixed => {
            StepOptions { min_dt: STEP, max_dt: STEP, relaxation: StepRelaxation::OFF, ..step }
        }
        Stepping::Undamped => StepOptions {
            method: Method::Bdf2,
            min_dt: STEP,
            max_dt: STEP,
            relaxation: StepRelaxation::OFF,
            ..step
        },
        Stepping::Adaptive => StepOptions { max_dt: REST_DURATION / MIN_STEPS_OF_REST, ..step },
    };
    Stepper::new(cloth, contact, options)
}

/// Simulates the fall of a strip of about `points` points from the `run`-th initial tilt until it is at rest.
///
/// # Errors
/// If the strip cannot be meshed, which does not happen.
pub fn fall(
    points: usize,
    fabric: &Fabric,
    with_memory: bool,
    run: usize,
    stepping: Stepping,
) -> Result<Fall> {
    let garment = tilted_strip(points, FIRST_TILT + TILT_INCREMENT * run as f64)?;
    let mut stepper = stepper(&garment, fabric, stepping);
    let flat = vec![0.0; garment.topology.hinges.len()];
    let angle = stepper.cloth.bending.angles(&garment.points, &flat);
    let law = with_memory.then(|| {
        MemoryModel::new(&garment, fabric, stepper.cloth.bending.width(), fabric.memory.reference_length())
    });
    let mut memory = Memory::new(RestState::new(flat, garment.triangles.len()));
    let mut state = State::at_rest(garment.points.clone(), angle);
    let mut fall = Fall {
        stabilised: None,
        wall: 0.0,
        steps: 0,
        iterations: 0,
        local_iterations: 0,
        cost: SolveCost::default(),
        seconds: NewtonSeconds::default(),
        events: 0,
        residuals: Vec::new(),
    };
    let mass: f64 = stepper.cloth.mass.iter().sum();
    let drag = if stepping == Stepping::Undamped { 0.0 } else { DRAG };
    let loads = Loads { drag, ..Loads::gravity_only(Some(0.0)) };
    let clock = Instant::now();
    let mut at_rest_since = None;
    let mut dt_request = STEP;
    while state.time < MAX_TIME && fall.stabilised.is_none() {
        let (angle, velocity) = (state.angle.clone(), state.v.clone());
        let step = stepper.advance(
            &mut state,
            &memory.effective_rest,
            &mut |_: f64, _: &_| loads.clone(),
            dt_request,
        );
        dt_request = step.next_dt;
        fall.steps += 1;
        fall.iterations += step.newton.global_iterations as u64;
        fall.local_iterations += step.newton.local_iterations as u64;
        fall.cost += step.newton.cost;
        fall.seconds += step.newton.seconds;
        if let Some(law) = &law {
            let strains = |angle| Strains { angle, stretch: &[] };
            memory.commit(law, &strains(&angle), &strains(&state.angle), step.dt);
        }
        let unbalanced = state
            .v
            .iter()
            .zip(&velocity)
            .zip(&stepper.cloth.mass)
            .map(|((now, before), m)| m * ((now - before) / step.dt).norm_squared())
            .sum::<f64>();
        let residual = (unbalanced / mass).sqrt() / GRAVITY;
        fall.residuals.push([state.time, residual]);
        // In free fall the unbalanced force is the weight, so the strip is not at rest before it has landed.
        at_rest_since = if residual < REST_RESIDUAL { at_rest_since.or(Some(state.time)) } else { None };
        if at_rest_since.is_some_and(|since| state.time - since >= REST_DURATION) {
            fall.stabilised = at_rest_since;
        }
    }
    fall.wall = clock.elapsed().as_secs_f64();
    fall.events = memory.events.gradual + memory.events.critical;
    Ok(fall)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn meshes_have_the_number_of_points_of_the_paper() {
        for wanted in FALLING_STRIP_POINTS {
            let garment = tilted_strip(wanted, FIRST_TILT).expect("meshes");
            let ratio = garment.points.len() as f64 / wanted as f64;
            assert!((ratio - 1.0).abs() <= 0.02, "{wanted}: {}", garment.points.len());
            // One sheet: the Euler characteristic of a disc.
            let [v, e, f] = [garment.points.len(), garment.topology.edges.len(), garment.triangles.len()];
            assert_eq!(v + f - e, 1, "{wanted}");
            let area: f64 = garment.material.iter().map(|m| 0.5 * (m[1] - m[0]).perp(&(m[2] - m[0]))).sum();
            assert!((area / (HEIGHT * WIDTH) - 1.0).abs() < 1e-9, "{wanted}: {area}");
        }
    }
}
