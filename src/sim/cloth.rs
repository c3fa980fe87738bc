//! The elastic model of one garment: masses, membrane, bending.

use crate::energy::{Bending, Membrane};
use crate::fabric::Fabric;
use crate::garment::{Garment, hem_fractions};
use crate::math::Vec3;

/// Width of a hem [m]: 20 mm, as shirts and T-shirts have it.
pub const HEM_WIDTH: f64 = 0.02;
/// Bending stiffness of a hem relative to one layer [-]: two layers that slide on one another have 2, two that are bonded 8; sewn
/// ones lie between, here at the geometric mean. No measurement of hems was found.
pub const HEM_BENDING: f64 = 4.0;

/// Elastic model and masses of one garment; constant during a run.
#[derive(Debug, Clone)]
pub struct Cloth {
    /// Masses, one per point [kg].
    pub mass: Vec<f64>,
    /// Lumped areas, one per point [m²].
    pub area: Vec<f64>,
    /// Stretch and shear model.
    pub membrane: Membrane,
    /// Bending model.
    pub bending: Bending,
}

impl Cloth {
    /// Returns the model of `garment` made of `fabric`.
    pub fn new(garment: &Garment, fabric: &Fabric) -> Self {
        let membrane = Membrane::new(garment, fabric);
        let mut area = vec![0.0; garment.points.len()];
        for (t, a) in garment.triangles.iter().zip(membrane.area()) {
            for p in t {
                area[p.at()] += a / 3.0;
            }
        }
        let mass = area.iter().map(|a| a * fabric.area_density()).collect();
        Self { mass, area, membrane, bending: Bending::new(garment, fabric) }
    }

    /// The model of `garment` made of `fabric`, its open borders hemmed: over [`HEM_WIDTH`] the cloth is double. It weighs and resists
    /// stretch twice as much, and bends [`HEM_BENDING`] times as stiffly.
    pub fn hemmed(garment: &Garment, fabric: &Fabric) -> Self {
        let mut cloth = Self::new(garment, fabric);
        let fractions = hem_fractions(garment, HEM_WIDTH);
        let factors =
            |factor: f64| -> Vec<f64> { fractions.iter().map(|s| 1.0 + (factor - 1.0) * s).collect() };
        let layers = factors(2.0);
        cloth.mass.fill(0.0);
        for ((t, area), layers) in garment.triangles.iter().zip(cloth.membrane.area()).zip(&layers) {
            for p in t {
                cloth.mass[p.at()] += area / 3.0 * layers * fabric.area_density();
            }
        }
        cloth.membrane.reinforce(&layers);
        cloth.bending.reinforce(&factors(HEM_BENDING));
        cloth
    }

    /// Returns the kinetic energy [J] at velocities `v`, one per point [m/s].
    pub fn kinetic_energy(&self, v: &[Vec3]) -> f64 {
        0.5 * self.mass.iter().zip(v).map(|(m, v)| m * v.norm_squared()).sum::<f64>()
    }
}
