//! The elastic model of one garment: masses, membrane, bending.

use crate::energy::{Bending, Junctions, Membrane};
use crease_geometry::math::Vec3;
use crease_geometry::mesh::{PointIndex, triangle};
use crease_model::fabric::Fabric;
use crease_model::garment::{Garment, hem_fractions, seam_fractions};

/// Where cloth is sewn and lies double.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Sewing {
    /// Whether open borders are hemmed.
    pub hems: bool,
    /// Whether seams have an allowance.
    pub seams: bool,
}

impl Sewing {
    /// Hems and seams.
    pub const ALL: Self = Self { hems: true, seams: true };
    /// Single cloth everywhere.
    pub const NONE: Self = Self { hems: false, seams: false };
}

/// Width of a hem [m]: 20 mm, as shirts and T-shirts have it.
const HEM_WIDTH: f64 = 0.02;
/// Bending stiffness of a hem relative to one layer [-]: two layers that slide on one another have 2, two that are bonded 8, as the
/// second moment of their section has it (`docs/reference/fabrics.md`); a hem, sewn along both sides, lies between, here at the
/// geometric mean.
const HEM_BENDING: f64 = 4.0;
/// Width of the allowance on either side of a seam [m]: 10 mm, as patterns have it.
const SEAM_WIDTH: f64 = 0.01;
/// Bending stiffness over the allowance of a seam relative to one layer [-]: allowances are held along the seam only and slide on the
/// cloth.
const SEAM_BENDING: f64 = 2.0;

/// Strips of a garment that are double.
#[derive(Debug, Clone)]
pub struct SewnStrips {
    /// Per triangle: fraction 0..1 of it that is hem.
    pub hem: Vec<f64>,
    /// Per triangle: fraction 0..1 of it that is the allowance of a seam.
    pub seam: Vec<f64>,
}

impl SewnStrips {
    /// The strips of `garment`: over 20 mm along open borders, 10 mm on either side of seams, as far as `sewing` and the garment's
    /// sewing mask have them.
    pub fn new(garment: &Garment, sewing: Sewing) -> Self {
        let strip = |on: bool, of: fn(&Garment, f64) -> Vec<f64>, width: f64| {
            if on { of(garment, width) } else { vec![0.0; garment.triangles.len()] }
        };
        Self {
            hem: strip(sewing.hems, hem_fractions, HEM_WIDTH),
            seam: strip(sewing.seams, seam_fractions, SEAM_WIDTH),
        }
    }

    /// Fractions 0..1 of the area of `garment` that are hem and allowance of a seam.
    pub fn fractions(&self, garment: &Garment) -> [f64; 2] {
        let area_of = |t: &[PointIndex; 3]| triangle::area(&triangle::corners(&garment.points, t));
        let area: Vec<f64> = garment.triangles.iter().map(area_of).collect();
        let whole = area.iter().sum::<f64>().max(f64::MIN_POSITIVE);
        [&self.hem, &self.seam].map(|strip| strip.iter().zip(&area).map(|(f, a)| f * a).sum::<f64>() / whole)
    }

    /// Per triangle: a quantity relative to that of single cloth, which has `hem` times as much of it in a hem and `seam` times over the
    /// allowance of a seam.
    fn factors(&self, hem: f64, seam: f64) -> Vec<f64> {
        let both = self.hem.iter().zip(&self.seam);
        both.map(|(h, s)| 1.0 + (hem - 1.0) * h + (seam - 1.0) * s).collect()
    }
}

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
    /// Bending model of edges of more than two triangles.
    pub junctions: Junctions,
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
        let (bending, junctions) = (Bending::new(garment, fabric), Junctions::new(garment, fabric));
        Self { mass, area, membrane, bending, junctions }
    }

    /// The model of `garment` made of `fabric`, double where it is sewn ([`SewnStrips`]). Two layers weigh and resist stretch twice as
    /// much; a hem bends four times as stiffly as one layer, a seam twice.
    pub fn sewn(garment: &Garment, fabric: &Fabric, sewing: Sewing) -> Self {
        let mut cloth = Self::new(garment, fabric);
        let strips = SewnStrips::new(garment, sewing);
        let layers = strips.factors(2.0, 2.0);
        cloth.mass.fill(0.0);
        for ((t, area), layers) in garment.triangles.iter().zip(cloth.membrane.area()).zip(&layers) {
            for p in t {
                cloth.mass[p.at()] += area / 3.0 * layers * fabric.area_density();
            }
        }
        cloth.membrane.reinforce(&layers);
        let bending = strips.factors(HEM_BENDING, SEAM_BENDING);
        cloth.bending.reinforce(&bending);
        cloth.junctions.reinforce(&bending);
        cloth
    }

    /// Returns the kinetic energy [J] at velocities `v`, one per point [m/s].
    pub fn kinetic_energy(&self, v: &[Vec3]) -> f64 {
        0.5 * self.mass.iter().zip(v).map(|(m, v)| m * v.norm_squared()).sum::<f64>()
    }
}
