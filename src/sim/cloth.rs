//! The elastic model of one garment: masses, membrane, bending.

use crate::energy::{Bending, Membrane};
use crate::fabric::Fabric;
use crate::garment::Garment;
use crate::math::Vec3;

/// What the solver keeps of a garment and its fabric; nothing in it changes during a run.
#[derive(Debug, Clone)]
pub struct Cloth {
    /// One per point [kg].
    pub mass: Vec<f64>,
    /// Area each point stands for [m²].
    pub area: Vec<f64>,
    /// Stretch and shear.
    pub membrane: Membrane,
    /// Bending.
    pub bending: Bending,
}

impl Cloth {
    /// `garment` made of `fabric`, with the fabric's own stiffness.
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

    /// What cloth of velocities `v` [m/s], one per point, carries with it [J].
    pub fn kinetic_energy(&self, v: &[Vec3]) -> f64 {
        0.5 * self.mass.iter().zip(v).map(|(m, v)| m * v.norm_squared()).sum::<f64>()
    }
}
