//! The interface of a scene, its state, and the cloth it consists of.

use crate::test_sheet::TestSheet;
use crease_geometry::math::Vec3;
use crease_model::error::Result;
use crease_model::garment::{Garment, RestState};
use crease_solver::contact::{Contact, ContactSettings};
use crease_solver::energy::{Bending, Junctions, Membrane};
use crease_solver::memory::{Memory, MemoryModel};
use crease_solver::sim::{Cloth, GRAVITY, Loads, State, StepOptions, Stepper};

/// Strain at the start from which on an element is left out of strain measurements [-].
const MAX_INITIAL_STRAIN: f64 = 1e-2;

/// State of a scene: cloth with its solver and memory.
pub struct SceneState {
    pub(super) stepper: Stepper,
    pub(super) state: State,
    pub(super) memory: Memory,
    /// Memory model; `None` for cloth without memory.
    pub(super) law: Option<MemoryModel>,
    pub(super) garment: Garment,
    /// One flag per triangle: whether it is unstrained at the start. The membrane clamps the altitude of slivers, so
    /// that their strain has no meaning.
    pub(super) unstrained: Vec<bool>,
}

/// A scene with initial state, loads and duration.
pub trait Scene: Sync {
    /// Name in tables.
    fn name(&self) -> &'static str;
    /// Time at its end [s].
    fn until(&self) -> f64;
    /// Length that position errors are divided by [m].
    fn size(&self) -> f64;
    /// Strain beyond which a run has failed [-].
    fn max_strain(&self) -> f64 {
        0.3
    }
    /// Initial state.
    ///
    /// # Errors
    /// If a mesh or preset cannot be made.
    fn initial_state(&self) -> Result<SceneState>;
    /// Loads at time `t` [s] on cloth with points `x` [m].
    fn loads(&self, t: f64, x: &[Vec3]) -> Loads;
    /// Times of discontinuities of the loads [s]: a step ends there, and multistep integrators restart.
    fn event_times(&self) -> Vec<f64> {
        Vec::new()
    }
}

/// Material of a scene's cloth.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct ClothMaterial {
    /// Area density [kg/m²].
    pub(super) density: f64,
    /// Stretch stiffness of warp and weft, twice that of shear [N/m].
    pub(super) stretch: f64,
    /// Bending stiffness [N·m].
    pub(super) bend: f64,
    /// Relaxation time of stretch [s].
    pub(super) stretch_damping: f64,
    /// Relaxation time of bending [s].
    pub(super) bend_damping: f64,
}

impl ClothMaterial {
    /// Makes the cloth of `sheet`. Masses are lumped by Voronoi area where triangles are right-angled: lumped by
    /// thirds the two ends of a row of quads would have masses 1 to 2.
    pub(super) fn cloth(&self, sheet: &TestSheet, garment: &Garment) -> Cloth {
        let k = self.stretch;
        let membrane =
            Membrane::from_parts(&sheet.triangles, &garment.material, [k, k, 0.5 * k], self.stretch_damping);
        let bending =
            Bending::from_parts(&garment.topology, &garment.material, [self.bend; 2], self.bend_damping);
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
        Cloth { mass, area, membrane, bending, junctions: Junctions::default() }
    }

    /// Makes contact with activation distance `distance` [m] and coefficient `friction`, stiff enough for the weight
    /// of `layers` layers.
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

impl SceneState {
    /// Cloth at rest at the garment's points, with flat memory.
    pub(super) fn new(garment: Garment, cloth: Cloth, contact: Contact) -> Self {
        let flat = vec![0.0; garment.topology.hinges.len()];
        let angle = cloth.bending.angles(&garment.points, &flat);
        let measure = cloth.membrane.measure(&garment.points);
        let unstrained = measure
            .iter()
            .map(|[u, v, _]| (u - 1.0).abs().max((v - 1.0).abs()) < MAX_INITIAL_STRAIN)
            .collect();
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
pub(super) fn smoothstep(t: f64, from: f64, to: f64) -> f64 {
    let u = ((t - from) / (to - from)).clamp(0.0, 1.0);
    u * u * (3.0 - 2.0 * u)
}

/// `count` + 1 values from `from` to `to`.
pub(super) fn spaced(from: f64, to: f64, count: usize) -> Vec<f64> {
    (0..=count).map(|i| from + (to - from) * i as f64 / count as f64).collect()
}
