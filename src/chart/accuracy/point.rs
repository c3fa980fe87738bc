//! Cost and error of one run of a scene, and the reference that errors refer to.

use crate::comparison::is_visual;
use crate::scenes;
use crate::scenes::{Scene, SceneOutcome, SceneSetting};
use crease_model::error::Result;
use crease_solver::sim::Method;

/// Newton's tolerance for references [m].
const REFERENCE_TOL: f64 = 1e-10;
/// Runs longer than this are timed once [s].
const MAX_REPEATED_WALL: f64 = 0.5;

/// Cost and error of one run.
#[derive(Debug, Clone, PartialEq)]
pub struct AccuracyPoint {
    /// The integrator.
    pub method: Method,
    /// Step size and tolerance in words.
    pub setting: String,
    /// Step size [s].
    pub step: f64,
    /// Tolerance of Newton [m].
    pub tolerance: f64,
    /// Wall time [s].
    pub wall: f64,
    /// Linear systems solved.
    pub linear_solves: u64,
    /// Largest error of a position over the size of the scene [-].
    pub position_error: f64,
    /// Root mean square error of the hinge angles [rad].
    pub angle_error: f64,
    /// Root mean square error of the rest angles [rad]; `None` for cloth without memory.
    pub rest_angle_error: Option<f64>,
    /// Largest strain during the run [-].
    pub max_strain: f64,
    /// Reason of a failure.
    pub failed: Option<&'static str>,
}

/// The outcome that errors of a scene refer to.
#[derive(Debug, Clone, PartialEq)]
pub struct SceneReference {
    /// Extrapolated outcome.
    pub outcome: SceneOutcome,
    /// Estimate of its own error: distance from the run with twice the step, over the size of the scene [-].
    pub own_error: f64,
}

/// Makes the reference of a scene whose shortest compared step is `step` [s].
///
/// It is extrapolated from the two-stage method with an eighth and a quarter of `step`: the scene must be smooth,
/// without contact.
///
/// # Errors
/// If the scene cannot be set up.
pub fn reference(scene: &dyn Scene, step: f64) -> Result<SceneReference> {
    let run_with = |h: f64| scenes::run(scene, &SceneSetting::fixed(Method::Sdirk2, h, REFERENCE_TOL));
    let (fine, coarse) = (run_with(step / 8.0)?, run_with(2.0 * step / 8.0)?);
    let own_error = fine.position_error(&coarse, scene.size());
    let extrapolated = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a + (a - b) / 3.0).collect();
    let x = fine.x.iter().zip(&coarse.x).map(|(a, b)| a + (a - b) / 3.0).collect();
    let angle = extrapolated(&fine.angle, &coarse.angle);
    // Memory events are discrete: rest angles are not extrapolated.
    Ok(SceneReference { outcome: SceneOutcome { x, angle, ..fine }, own_error: own_error / 3.0 })
}

/// Runs `scene` with one setting, `runs` times if it is short, and compares the outcome with the reference.
///
/// # Errors
/// If the scene cannot be set up.
pub fn measure(
    scene: &dyn Scene,
    reference: &SceneOutcome,
    setting: &SceneSetting,
    runs: usize,
) -> Result<AccuracyPoint> {
    let outcome = scenes::run(scene, setting)?;
    let mut walls = vec![outcome.wall];
    let runs = if outcome.wall < MAX_REPEATED_WALL { runs } else { 1 };
    for _ in 1..runs {
        walls.push(scenes::run(scene, setting)?.wall);
    }
    walls.sort_by(f64::total_cmp);
    let has_memory = reference.rest_angle.iter().any(|a| *a != 0.0);
    Ok(AccuracyPoint {
        method: setting.method,
        setting: describe(setting),
        step: setting.step,
        tolerance: setting.tolerance,
        wall: walls[walls.len() / 2],
        linear_solves: outcome.linear_solves,
        position_error: outcome.position_error(reference, scene.size()),
        angle_error: outcome.angle_error(reference),
        rest_angle_error: has_memory.then(|| outcome.rest_angle_error(reference)),
        max_strain: outcome.max_strain,
        failed: outcome.failed,
    })
}

/// Step size and tolerance in words.
fn describe(setting: &SceneSetting) -> String {
    let step = format!("{:.3} ms", 1e3 * setting.step);
    if setting.method.converges() {
        format!("{step}, to {:.0e} m", setting.tolerance)
    } else if is_visual(setting.method) {
        format!("{step}, sweeps")
    } else {
        format!("{step}, 1 iteration")
    }
}
