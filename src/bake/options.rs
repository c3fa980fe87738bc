//! Options of a bake: what [`crate::bake::Bake`] can be asked for.

use crate::bake::Quality;
use crate::bake::tuning::TUNING;
use crease_model::body::{AnimatedBody, GarmentSkin};
use crease_solver::sim::{NewtonOptions, Sewing, StepOptions, StepRelaxation};
use std::sync::Arc;

/// Options of a bake. Those that a [`Quality`] presets are `None` until they are set, and stay as set whatever the quality.
///
/// ```
/// use crease::{BakeOptions, Quality};
/// let options = BakeOptions { quality: Quality::Draft, finest_edge: Some(0.015), ..BakeOptions::default() };
/// assert_eq!(options.finest_edge(), 0.015);
/// assert_eq!(options.event_dt_fraction(), Quality::Draft.event_dt_fraction());
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct BakeOptions {
    /// Compromise between speed and accuracy: preset of every option that is `None`.
    pub quality: Quality,
    /// Whether the cloth has memory.
    pub memory: bool,
    /// Options of the time steps.
    pub step: Option<StepOptions>,
    /// Energy tolerance of a step as the height by which it would lift the whole garment [m]: a step is converged when the
    /// predicted decrease is below it, so that single points may still fall into a wrinkle in the next step.
    pub energy_tol_m: Option<f64>,
    /// Strain under the garment's own weight up to which a lower stretch stiffness than the fabric's may be used [-].
    pub max_weight_strain: Option<f64>,
    /// Step after a memory event as a fraction of the time to the next event [-]: the cloth responds to each before the
    /// next is due. On a body it may be two and a half times as long.
    pub event_dt_fraction: Option<f64>,
    /// Whether every model is on and at full size, with short steps of one length, each solved for the whole garment: the
    /// reference for the choice of models ([`crate::bake::ModelPlan`]).
    pub full_fidelity: bool,
    /// Frames per simulated second for the observer; 0 for none.
    pub frames_per_second: f64,
    /// The body that wears the garment.
    pub body: Option<Arc<AnimatedBody>>,
    /// Skin of the garment in its file, by whose joints the body holds it; `None` for a garment that only contact holds.
    pub skin: Option<Arc<GarmentSkin>>,
    /// Whether cloth that the moving body cannot affect is fixed.
    pub deactivate_static: bool,
    /// Whether the garment's own triangles are simulated instead of a mesh made for the script ([`crate::bake::MeshChoice`]).
    pub own_triangles: bool,
    /// Where the cloth is sewn and lies double: open borders over 20 mm, seams over 10 mm on either side.
    pub sewing: Sewing,
    /// Length of edges where the script creases the cloth [m], of a mesh made for it.
    pub finest_edge: Option<f64>,
    /// Whether frames show the points of the simulated mesh instead of those of the garment.
    pub frames_of_simulated: bool,
    /// Factor on everything the garment comes to remember, in the result [-]: 1 for what the wear left, 0 for nothing.
    pub strength: f64,
    /// Steps of an action between two possible checkpoints: what an interrupted run loses at most. At each the pattern of
    /// the linear system is rebuilt, and in a hold a factor that several steps use.
    pub checkpoint_steps: u64,
}

impl Default for BakeOptions {
    fn default() -> Self {
        Self {
            quality: Quality::Standard,
            memory: true,
            step: None,
            energy_tol_m: None,
            max_weight_strain: None,
            event_dt_fraction: None,
            full_fidelity: false,
            frames_per_second: 0.0,
            body: None,
            skin: None,
            deactivate_static: true,
            own_triangles: false,
            sewing: Sewing::ALL,
            finest_edge: None,
            frames_of_simulated: false,
            strength: 1.0,
            checkpoint_steps: 32,
        }
    }
}

impl BakeOptions {
    /// Options of `quality`, with nothing else set.
    pub fn of_quality(quality: Quality) -> Self {
        Self { quality, ..Self::default() }
    }

    /// Options of the time steps: those that are set, or those of the quality.
    pub fn step(&self) -> StepOptions {
        self.step.unwrap_or_else(|| self.quality.step_options())
    }

    /// Energy tolerance of a step as a height [m]: the one that is set, or that of the quality.
    pub fn energy_tol_m(&self) -> f64 {
        self.energy_tol_m.unwrap_or_else(|| self.quality.energy_tol())
    }

    /// Permitted strain under the garment's own weight [-]: the one that is set, or that of the quality.
    pub fn max_weight_strain(&self) -> f64 {
        self.max_weight_strain.unwrap_or_else(|| self.quality.max_weight_strain())
    }

    /// Step after a memory event as a fraction of the time to the next [-]: the one that is set, or that of the quality.
    pub fn event_dt_fraction(&self) -> f64 {
        self.event_dt_fraction.unwrap_or_else(|| self.quality.event_dt_fraction())
    }

    /// Length of edges where the script creases the cloth [m]: the one that is set, or that of the quality.
    pub fn finest_edge(&self) -> f64 {
        self.finest_edge.unwrap_or_else(|| self.quality.finest_edge())
    }

    /// The options with every preset of the quality filled in.
    pub(super) fn resolved(&self) -> Self {
        Self {
            step: Some(self.step()),
            energy_tol_m: Some(self.energy_tol_m()),
            max_weight_strain: Some(self.max_weight_strain()),
            event_dt_fraction: Some(self.event_dt_fraction()),
            finest_edge: Some(self.finest_edge()),
            ..self.clone()
        }
    }

    /// Whether frames are asked for that show the garment's own points.
    pub(super) fn shows_garment(&self) -> bool {
        self.frames_per_second > 0.0 && !self.frames_of_simulated
    }

    /// Step options in use: those of `full_fidelity` replace the chosen ones.
    pub(super) fn effective_step(&self) -> StepOptions {
        let step = self.step();
        if !self.full_fidelity {
            return step;
        }
        let newton = NewtonOptions { rel_decrement_tol: 0.0, ..step.newton };
        let dt = TUNING.stepping.full_fidelity_dt;
        StepOptions { newton, min_dt: dt, max_dt: dt, relaxation: StepRelaxation::OFF, ..step }
    }

    /// Step after a memory event in use, as a fraction of the time to the next event [-].
    pub(super) fn effective_event_dt_fraction(&self) -> f64 {
        let factor = if self.body.is_some() { TUNING.stepping.body_event_dt_factor } else { 1.0 };
        factor * self.event_dt_fraction()
    }

    /// Energy tolerance of a step in use, as a height [m].
    pub(super) fn effective_energy_tol(&self) -> f64 {
        if self.full_fidelity {
            TUNING.stepping.full_fidelity_energy_factor * self.energy_tol_m()
        } else {
            self.energy_tol_m()
        }
    }
}
