//! Looser tolerances for steps whose error does not show in the result.

use crate::sim::loads::Loads;

/// Factors by which tolerances of a step are loosened; [`StepRelaxation::OFF`] for none.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct StepRelaxation {
    /// Factor on the maximum time step of the loads while springs or a body guide the cloth ([`Loads::guided`]), and,
    /// squared, on the local error [-]: most of the error is the arc that a straight displacement cuts short, and what
    /// guides the cloth decides where it ends. 1 for no change.
    pub guided_dt_scale: f64,
    /// Factor on the energy tolerance while the loads are in transition ([`Loads::transient`]) [-]: positions are
    /// solved for again right after it. 1 for no change.
    pub transient_energy_scale: f64,
    /// Minimum energy tolerance as a fraction of the kinetic energy of unloaded cloth ([`Loads::is_unloaded`]) [-]. 0
    /// for no change.
    pub kinetic_energy_fraction: f64,
}

impl StepRelaxation {
    /// All tolerances as the options say.
    pub const OFF: Self =
        Self { guided_dt_scale: 1.0, transient_energy_scale: 1.0, kinetic_energy_fraction: 0.0 };
    /// The relaxation of the default quality.
    pub const DEFAULT: Self =
        Self { guided_dt_scale: 3.0, transient_energy_scale: 5.0, kinetic_energy_fraction: 0.1 };

    /// Returns the factor on the maximum time step under `loads` [-].
    pub(super) fn dt_scale(&self, loads: &Loads) -> f64 {
        if loads.guided { self.guided_dt_scale } else { 1.0 }
    }

    /// Returns the energy tolerance [J] under `loads` of cloth with kinetic energy `kinetic` [J], where it is
    /// `energy_tol` [J] without relaxation. A tolerance of 0, which turns the energy criterion off, stays 0.
    pub(super) fn energy_tol(&self, energy_tol: f64, loads: &Loads, kinetic: f64) -> f64 {
        if loads.transient {
            energy_tol * self.transient_energy_scale
        } else if loads.is_unloaded() && energy_tol > 0.0 {
            energy_tol.max(self.kinetic_energy_fraction * kinetic)
        } else {
            energy_tol
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_unloaded_cloth_may_keep_a_fraction_of_its_kinetic_energy() {
        let free = Loads::gravity_only(Some(0.0));
        let pressed = Loads { pressure: 1.0, ..free.clone() };
        let pinned = Loads { fixed: vec![false, true], ..free.clone() };
        let transient = Loads { transient: true, ..pressed.clone() };
        let guided = Loads { guided: true, fixed: vec![true], ..free.clone() };
        let default = StepRelaxation::DEFAULT;
        assert_eq!(default.energy_tol(1e-3, &free, 1.0), 0.1);
        assert_eq!(default.energy_tol(1e-3, &free, 0.005), 1e-3);
        assert_eq!(default.energy_tol(0.0, &free, 1.0), 0.0);
        // As a bake represents a body.
        let on_body = Loads {
            body_displacement: std::sync::Arc::new([crease_geometry::math::Vec3::zeros()]),
            ..free.clone()
        };
        for loads in [&pressed, &pinned, &guided, &on_body] {
            assert_eq!(default.energy_tol(1e-3, loads, 1.0), 1e-3);
        }
        assert_eq!(default.energy_tol(1e-3, &transient, 1.0), 5e-3);
        assert_eq!([&guided, &free].map(|loads| default.dt_scale(loads)), [3.0, 1.0]);
        for loads in [&free, &pressed, &pinned, &transient, &guided] {
            assert_eq!(StepRelaxation::OFF.energy_tol(1e-3, loads, 1.0), 1e-3);
            assert_eq!(StepRelaxation::OFF.dt_scale(loads), 1.0);
        }
    }
}
