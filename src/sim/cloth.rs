//! The elastic model of one garment: masses, membrane, bending.

use crate::energy::{Bending, Membrane};
use crate::fabric::Fabric;
use crate::garment::Garment;
use crate::math::Vec3;

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

    /// Returns the kinetic energy [J] at velocities `v`, one per point [m/s].
    pub fn kinetic_energy(&self, v: &[Vec3]) -> f64 {
        0.5 * self.mass.iter().zip(v).map(|(m, v)| m * v.norm_squared()).sum::<f64>()
    }
}
