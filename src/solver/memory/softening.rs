//! Softening: cloth that is hot and moist, or wet, gives up its memory and takes on the shape that it is held in.
//!
//! Water and heat loosen the bonds between fibres that a crease was set with, and new bonds form in the present shape as the
//! cloth dries. Over a duration h, with the rate r and the set fraction f,
//!
//! ```text
//! rest <- rest + p (source + f (theta - source) - rest)      p = 1 - exp(-r h)
//! s    <- s + p (1 - s)                                      rest stretch likewise towards 1
//! ```
//!
//! with the same result for one step or many. A pressed fold has its angle set (f = 1, an iron), cloth that dries without
//! pressure keeps a part of its bend. The memory law acts beside it.

use crate::memory::Memory;
use crease_model::garment::Garment;

/// Softened cloth.
#[derive(Debug, Clone, PartialEq)]
pub struct Softening {
    /// Points whose cloth is soft, one flag per point; empty for all. A hinge or triangle is soft where all its own points are.
    pub points: Vec<bool>,
    /// Rate at which the present shape replaces the memory [1/s].
    pub rate: f64,
    /// Fraction of the present bend that is set [-], from 0 to 1.
    pub set_fraction: f64,
}

impl Memory {
    /// Softens the cloth of `garment`, whose hinges have the angles `angle` [rad], for `duration` [s]. A masked hinge or triangle
    /// changes in proportion to its mask.
    ///
    /// # Panics
    /// If `garment`, `angle` or the points of `softening` do not belong to this memory.
    pub fn soften(&mut self, garment: &Garment, softening: &Softening, angle: &[f64], duration: f64) {
        let replaced = 1.0 - (-softening.rate * duration).exp();
        let fraction = |points: &mut dyn Iterator<Item = usize>| {
            let of_point = |p: usize| {
                let soft = softening.points.is_empty() || softening.points[p];
                if soft { garment.memory_mask[p] } else { 0.0 }
            };
            replaced * points.map(of_point).fold(1.0, f64::min).clamp(0.0, 1.0)
        };
        for (h, hinge) in garment.topology.hinges.iter().enumerate() {
            let p = fraction(&mut hinge.points[..2].iter().map(|p| p.at()));
            if p > 0.0 {
                let source = self.rest.source_angle[h];
                let goal = source + softening.set_fraction * (angle[h] - source);
                self.rest.rest_angle[h] += p * (goal - self.rest.rest_angle[h]);
                self.rest.stiffness_ratio[h] += p * (1.0 - self.rest.stiffness_ratio[h]);
                self.restart_hinge(h);
            }
        }
        for (f, triangle) in garment.triangles.iter().enumerate() {
            let p = fraction(&mut triangle.iter().map(|p| p.at()));
            for stretch in [&mut self.rest.rest_stretch_warp[f], &mut self.rest.rest_stretch_weft[f]] {
                *stretch += p * (1.0 - *stretch);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    use crease_model::garment::RestState;

    /// A flat sheet of 0.2 x 0.2 m, 5 x 5 points.
    fn sheet() -> Garment {
        Garment::sheet([0.2; 2], [4; 2]).expect("is a sheet")
    }

    /// A creased and stretched sheet, and the angles of its hinges while it is flat but for the first.
    fn creased() -> (Garment, Memory, Vec<f64>) {
        let garment = sheet();
        let hinges = garment.topology.hinges.len();
        let mut rest = RestState::flat(hinges, garment.triangles.len());
        rest.rest_angle.fill(1.0);
        rest.stiffness_ratio.fill(5.0);
        rest.rest_stretch_warp.fill(1.1);
        let mut angle = vec![0.0; hinges];
        angle[0] = 2.0;
        (garment, Memory::new(rest), angle)
    }

    #[test]
    fn soft_cloth_takes_on_its_shape_and_loses_stiffness_and_stretch() {
        let (garment, mut memory, angle) = creased();
        let softening = Softening { points: Vec::new(), rate: 1.0, set_fraction: 1.0 };
        memory.soften(&garment, &softening, &angle, 20.0);
        assert!((memory.rest.rest_angle[0] - 2.0).abs() < 1e-6);
        assert!(memory.rest.rest_angle[1..].iter().all(|rest| rest.abs() < 1e-6));
        assert!(memory.rest.stiffness_ratio.iter().all(|s| (s - 1.0).abs() < 1e-6));
        assert!(memory.rest.rest_stretch_warp.iter().all(|r| (r - 1.0).abs() < 1e-6));
    }

    #[test]
    fn one_step_does_what_many_do_and_only_where_the_cloth_is_soft() {
        let (garment, memory, angle) = creased();
        let soft: Vec<bool> = garment.points.iter().map(|p| p.x < garment.points[0].x + 0.11).collect();
        let softening = Softening { points: soft.clone(), rate: 0.3, set_fraction: 0.4 };
        let (mut one, mut many) = (memory.clone(), memory.clone());
        one.soften(&garment, &softening, &angle, 4.0);
        (0..400).for_each(|_| many.soften(&garment, &softening, &angle, 0.01));
        let expected = 1.0 + (1.0 - (-1.2f64).exp()) * (0.4 * 0.0 - 1.0);
        let mut changed = 0;
        for (h, hinge) in garment.topology.hinges.iter().enumerate() {
            assert!((one.rest.rest_angle[h] - many.rest.rest_angle[h]).abs() < 1e-9);
            let is_soft = hinge.points[..2].iter().all(|p| soft[p.at()]);
            let wanted = if is_soft { expected } else { 1.0 };
            if h > 0 {
                assert!((one.rest.rest_angle[h] - wanted).abs() < 1e-9, "{h}");
            }
            changed += usize::from(is_soft);
        }
        assert!(changed > 0 && changed < garment.topology.hinges.len());
    }
}
