//! A strip that is clamped level, let go, and comes to rest: how well methods hold still.
//!
//! Gamma = rho g L³ / B = 10, L = 0.1 m, 20 elements long and 6 wide, half clamp (`chart::cantilever`), bending damped.
//! Its end is an equilibrium, which every converged method reaches with any step: here long steps win.

use crate::chart::scenes::{Actors, Kind, Scene, Sheet, spaced};
use crate::contact::Contact;
use crate::error::Result;
use crate::math::Vec3;
use crate::sim::{GRAVITY, Loads};

const LENGTH: f64 = 0.1;
const ELEMENTS: usize = 20;
const DENSITY: f64 = 0.2;

/// The scene.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Cantilever;

impl Cantilever {
    fn sheet() -> Sheet {
        let mut along = vec![-LENGTH / ELEMENTS as f64];
        along.extend(spaced(0.0, LENGTH, ELEMENTS));
        Sheet::strip(&along, 0.3 * LENGTH, 6)
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

    fn begin(&self) -> Result<Actors> {
        let sheet = Self::sheet();
        let garment = sheet.flat_garment();
        let bend = DENSITY * GRAVITY * LENGTH.powi(3) / 10.0;
        let kind =
            Kind { density: DENSITY, stretch: 1e5 * bend / LENGTH.powi(2), bend, damping: [0.0, 0.05] };
        let cloth = kind.cloth(&sheet, &garment);
        let contact = Contact::none(garment.points.len());
        let mut actors = Actors::new(garment, cloth, contact);
        let ratio = sheet.half_clamp(|p| p.x < 1e-9);
        actors.memory.rest.stiffness_ratio.clone_from(&ratio);
        actors.memory.effective_rest.stiffness_ratio = ratio;
        Ok(actors)
    }

    fn drive(&self, _t: f64, _x: &[Vec3]) -> Loads {
        let held = Self::sheet().flat.iter().map(|p| p.x < 1e-9).collect();
        Loads { fixed: held, drag: 4.0, ..Loads::gravity_only(None) }
    }
}
