//! A strip that is clamped horizontally, released, and comes to rest under its weight: convergence to an equilibrium.
//!
//! Gamma = rho g L³ / B = 10, L = 0.1 m, 20 elements long and 6 wide, half clamp (`chart::cantilever`), bending
//! damped. Every converged integrator reaches the equilibrium with any step size: here long steps are the most
//! efficient.

use crate::scenes::scene::{ClothMaterial, Scene, SceneState, spaced};
use crate::test_sheet::TestSheet;
use crease_geometry::math::Vec3;
use crease_model::error::Result;
use crease_solver::contact::Contact;
use crease_solver::sim::{GRAVITY, Loads};

/// Length of the free strip [m].
const LENGTH: f64 = 0.1;
/// Elements along the strip.
const ELEMENTS: usize = 20;
/// Area density [kg/m²].
const DENSITY: f64 = 0.2;

/// The released cantilever.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Cantilever;

impl Cantilever {
    fn sheet() -> TestSheet {
        let mut along = vec![-LENGTH / ELEMENTS as f64];
        along.extend(spaced(0.0, LENGTH, ELEMENTS));
        TestSheet::strip(&along, 0.3 * LENGTH, 6)
    }
}

impl Scene for Cantilever {
    fn name(&self) -> &'static str {
        "cantilever"
    }

    fn until(&self) -> f64 {
        4.0
    }

    fn size(&self) -> f64 {
        LENGTH
    }

    fn initial_state(&self) -> Result<SceneState> {
        let sheet = Self::sheet();
        let garment = sheet.flat_garment();
        let bend = DENSITY * GRAVITY * LENGTH.powi(3) / 10.0;
        let material = ClothMaterial {
            density: DENSITY,
            stretch: 1e5 * bend / LENGTH.powi(2),
            bend,
            stretch_damping: 0.0,
            bend_damping: 0.05,
        };
        let cloth = material.cloth(&sheet, &garment);
        let contact = Contact::none(garment.points.len());
        let mut scene_state = SceneState::new(garment, cloth, contact);
        let clamped: Vec<bool> = sheet.flat.iter().map(|p| p.x < 1e-9).collect();
        let ratio = sheet.half_clamp(&clamped);
        scene_state.memory.rest.stiffness_ratio.clone_from(&ratio);
        scene_state.memory.effective_rest.stiffness_ratio = ratio;
        Ok(scene_state)
    }

    fn loads(&self, _t: f64, _x: &[Vec3]) -> Loads {
        let fixed = Self::sheet().flat.iter().map(|p| p.x < 1e-9).collect();
        Loads { fixed, drag: 4.0, ..Loads::gravity_only(None) }
    }
}
