//! Parameter sweeps: every scene with every integrator, step size and tolerance.

use crate::accuracy::point::{AccuracyPoint, SceneReference, measure, reference};
use crate::comparison::METHODS;
use crate::scenes::{Cantilever, Flap, Scene, SceneSetting, Swing};
use crease_model::error::Result;
use crease_solver::sim::Method;

/// Tolerances of Newton over the size of the scene [-].
const NEWTON_TOLERANCES: &[f64] = &[1e-4, 1e-7];
/// Errors at which costs are compared, over the size of the scene [-].
const COMPARED_ERRORS: [f64; 3] = [1e-2, 3e-3, 1e-3];

/// A scene and the step sizes it is run with.
pub(super) struct Sweep {
    scene: Box<dyn Scene>,
    /// Longest step [s].
    longest_step: f64,
    /// Number of times the longest step is halved.
    halvings: u32,
}

/// All sweeps.
pub(super) fn sweeps() -> Vec<Sweep> {
    vec![
        Sweep { scene: Box::new(Flap), longest_step: 1.0 / 10.0, halvings: 5 },
        Sweep { scene: Box::new(Swing::SWING_30), longest_step: 0.02, halvings: 5 },
        Sweep { scene: Box::new(Swing::RELEASE_90), longest_step: 0.02, halvings: 5 },
        Sweep { scene: Box::new(Cantilever), longest_step: 0.5, halvings: 6 },
    ]
}

impl Sweep {
    /// Name of the scene.
    pub(super) fn name(&self) -> &'static str {
        self.scene.name()
    }

    /// Runs the sweep; adds remarks to `notes`.
    pub(super) fn run(&self, runs: usize, notes: &mut Vec<String>) -> Result<Vec<AccuracyPoint>> {
        let scene = self.scene.as_ref();
        let shortest = self.longest_step / f64::from(1 << self.halvings);
        let SceneReference { outcome, own_error } = reference(scene, shortest)?;
        let mut all = Vec::new();
        for &method in METHODS {
            for k in 0..=self.halvings {
                let step = self.longest_step / f64::from(1 << k);
                let tolerances = if method.converges() { NEWTON_TOLERANCES } else { &[0.0] };
                for tolerance in tolerances {
                    let setting = SceneSetting::fixed(method, step, tolerance * scene.size());
                    all.push(measure(scene, &outcome, &setting, runs)?);
                }
            }
        }
        let converged = all.iter().filter(|p| p.failed.is_none());
        let smallest = converged.map(|p| p.position_error).fold(f64::INFINITY, f64::min);
        let name = self.name();
        notes.push(format!(
            "{name}: error of the reference {own_error:.1e} of the size, smallest error shown {smallest:.1e}"
        ));
        notes.extend(cost_at_equal_error(name, &all));
        Ok(all)
    }
}

/// Relative cost of the integrators at equal error, each by its cheapest setting within the error; one sentence per
/// error.
fn cost_at_equal_error(scene: &str, points: &[AccuracyPoint]) -> Vec<String> {
    COMPARED_ERRORS
        .into_iter()
        .filter_map(|error| {
            let cheapest = |method: Method| {
                let good = points
                    .iter()
                    .filter(|p| p.method == method && p.failed.is_none() && p.position_error <= error);
                good.min_by(|a, b| a.wall.total_cmp(&b.wall))
            };
            let mut each: Vec<&AccuracyPoint> = METHODS.iter().filter_map(|m| cheapest(*m)).collect();
            each.sort_by(|a, b| a.wall.total_cmp(&b.wall));
            let best = each.first()?.wall;
            let costs: Vec<String> = each
                .iter()
                .map(|p| {
                    let (name, ratio) = (p.method.name(), p.wall / best);
                    format!("{name} x{ratio:.1} ({} solves, {})", p.linear_solves, p.setting)
                })
                .collect();
            Some(format!("{scene}, position error within {error:.0e} of the size: {}", costs.join("; ")))
        })
        .collect()
}
