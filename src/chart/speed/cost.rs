//! Cost of one scene, and its ratios to the kernels of the machine.

use crate::speed::kernels::Kernels;
use crease_linear::SolveCost;

/// Cost of one scene.
pub(super) struct SceneCost {
    /// Name of the scene.
    pub(super) scene: &'static str,
    /// Points of the garment.
    pub(super) points: usize,
    /// Points of the simulated mesh: those of a mesh made for the script.
    pub(super) simulated_points: usize,
    /// Wall time [s].
    pub(super) wall: f64,
    /// Simulated time [s]; `None` for an equilibrium.
    pub(super) simulated: Option<f64>,
    /// Time steps.
    pub(super) steps: u64,
    /// Linear solves, global and local.
    pub(super) solves: u64,
    /// Operations and memory traffic of the linear solves.
    pub(super) work: SolveCost,
    /// Wall time of each stage [s].
    pub(super) stages: Vec<(&'static str, f64)>,
}

/// Ratios of a scene's cost to the kernels [-].
pub(super) struct CostRatios {
    /// Wall time per linear solve over one factorisation.
    pub(super) total: f64,
    /// Time of the linear solves alone, per solve, over one factorisation; `None` where the stages are not known.
    pub(super) solver: Option<f64>,
    /// Time of contact per linear solve over one search; `None` where the stages are not known.
    pub(super) contact: Option<f64>,
    /// Floating-point rate of the linear solves over that of the factorisation kernel.
    pub(super) rate: Option<f64>,
    /// Memory throughput of the linear solves over that of the streaming copy.
    pub(super) copy: Option<f64>,
}

impl SceneCost {
    /// Wall time of a stage [s]; `None` where it is not known.
    pub(super) fn stage(&self, name: &str) -> Option<f64> {
        self.stages.iter().find(|(stage, _)| *stage == name).map(|(_, seconds)| *seconds)
    }

    /// Ratios to `kernels`.
    pub(super) fn over(&self, kernels: &Kernels) -> CostRatios {
        let solves = self.solves.max(1) as f64;
        let each = |stage: &str| self.stage(stage).map(|seconds| seconds / solves);
        let solving = self.stage("linear_solve").filter(|seconds| *seconds > 0.0);
        CostRatios {
            total: self.wall / solves / kernels.factor,
            solver: each("linear_solve").map(|seconds| seconds / kernels.factor),
            contact: each("contact").map(|seconds| seconds / kernels.search),
            rate: solving.map(|seconds| 2.0 * self.work.multiplications / seconds / kernels.rate()),
            copy: solving.map(|seconds| self.work.bytes / seconds / kernels.copy),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn unknown_stages_have_no_ratio() {
        let kernels = Kernels::measure(300, 1).unwrap();
        let mut cost = SceneCost {
            scene: "s",
            points: 300,
            simulated_points: 300,
            wall: 2.0,
            simulated: None,
            steps: 1,
            solves: 4,
            work: SolveCost { multiplications: 1e9, bytes: 1e9 },
            stages: vec![],
        };
        let ratios = cost.over(&kernels);
        assert!(ratios.solver.is_none() && ratios.rate.is_none() && ratios.copy.is_none());
        cost.stages = vec![("linear_solve", 1.0)];
        let ratios = cost.over(&kernels);
        assert_eq!(ratios.rate, Some(2e9 / kernels.rate()));
        assert_eq!(ratios.total, 0.5 / kernels.factor);
        assert_eq!(ratios.solver, Some(0.25 / kernels.factor));
    }
}
