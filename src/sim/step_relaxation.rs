//! Where a step may be made less strictly than its options say, because what it leaves shows in nothing.

use crate::sim::Loads;

/// How much less strictly, and where. [`StepRelaxation::NONE`] for nowhere.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct StepRelaxation {
    /// How many times as long as gestures ask a step may be while hands lead the cloth ([`Loads::leads`]), and, squared, how
    /// many times the error: most of it is the arc that a straight way cuts short, and where the cloth is after it hands
    /// tell. 1 for no difference.
    pub guided_dt_scale: f64,
    /// How many times as much energy may be left to gain while what acts passes from one thing to another
    /// ([`Loads::passing`]): where the cloth is then is gone over again right after. 1 for no difference.
    pub transient_energy_scale: f64,
    /// Share of the energy with which the cloth moves that may be left to gain where it is on its own ([`Loads::is_free`]) [-].
    /// 0 for no difference.
    pub kinetic_energy_fraction: f64,
}

impl StepRelaxation {
    /// Steps are made as strictly as their options say.
    pub const OFF: Self =
        Self { guided_dt_scale: 1.0, transient_energy_scale: 1.0, kinetic_energy_fraction: 0.0 };
    /// What the default quality takes.
    pub const DEFAULT: Self =
        Self { guided_dt_scale: 3.0, transient_energy_scale: 5.0, kinetic_energy_fraction: 0.1 };

    /// How many times as long as others steps may be under `drive`.
    pub(super) fn stride(&self, drive: &Loads) -> f64 {
        if drive.guided { self.guided_dt_scale } else { 1.0 }
    }

    /// What may be left to gain under `drive` [J], by cloth that moves with `kinetic` energy [J], where it is `energy` else; that is 0
    /// where energy is not what steps are measured by.
    pub(super) fn energy(&self, energy: f64, drive: &Loads, kinetic: f64) -> f64 {
        if drive.transient {
            energy * self.transient_energy_scale
        } else if drive.is_unloaded() && energy > 0.0 {
            energy.max(self.kinetic_energy_fraction * kinetic)
        } else {
            energy
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_what_moves_on_its_own_may_leave_a_share_of_its_motion() {
        let free = Loads::gravity_only(Some(0.0));
        let pressed = Loads { pressure: 1.0, ..free.clone() };
        let held = Loads { fixed: vec![false, true], ..free.clone() };
        let passing = Loads { transient: true, ..pressed.clone() };
        let leads = Loads { guided: true, fixed: vec![true], ..free.clone() };
        let usual = StepRelaxation::DEFAULT;
        assert_eq!(usual.energy(1e-3, &free, 1.0), 0.1);
        assert_eq!(usual.energy(1e-3, &free, 0.005), 1e-3);
        assert_eq!(usual.energy(0.0, &free, 1.0), 0.0);
        // As a bake has made it of a body.
        let worn =
            Loads { body_displacement: std::sync::Arc::new([crate::math::Vec3::zeros()]), ..free.clone() };
        for drive in [&pressed, &held, &leads, &worn] {
            assert_eq!(usual.energy(1e-3, drive, 1.0), 1e-3);
        }
        assert_eq!(usual.energy(1e-3, &passing, 1.0), 5e-3);
        assert_eq!([&leads, &free].map(|drive| usual.stride(drive)), [3.0, 1.0]);
        for drive in [&free, &pressed, &held, &passing, &leads] {
            assert_eq!(StepRelaxation::OFF.energy(1e-3, drive, 1.0), 1e-3);
            assert_eq!(StepRelaxation::OFF.stride(drive), 1.0);
        }
    }
}
