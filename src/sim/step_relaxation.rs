//! Where a step may be made less strictly than its options say, because what it leaves shows in nothing.

use crate::sim::Drive;

/// How much less strictly, and where. [`Leeway::NONE`] for nowhere.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Leeway {
    /// How many times as long as gestures ask a step may be while hands lead the cloth ([`Drive::leads`]), and, squared, how
    /// many times the error: most of it is the arc that a straight way cuts short, and where the cloth is after it hands
    /// tell. 1 for no difference.
    pub stride: f64,
    /// How many times as much energy may be left to gain while what acts passes from one thing to another
    /// ([`Drive::passing`]): where the cloth is then is gone over again right after. 1 for no difference.
    pub passing: f64,
    /// Share of the energy with which the cloth moves that may be left to gain where it is on its own ([`Drive::is_free`]) [-].
    /// 0 for no difference.
    pub motion: f64,
}

impl Leeway {
    /// Steps are made as strictly as their options say.
    pub const NONE: Self = Self { stride: 1.0, passing: 1.0, motion: 0.0 };
    /// What the default quality takes.
    pub const USUAL: Self = Self { stride: 3.0, passing: 5.0, motion: 0.1 };

    /// How many times as long as others steps may be under `drive`.
    pub(super) fn stride(&self, drive: &Drive) -> f64 {
        if drive.leads { self.stride } else { 1.0 }
    }

    /// What may be left to gain under `drive` [J], by cloth that moves with `kinetic` energy [J], where it is `energy` else; that is 0
    /// where energy is not what steps are measured by.
    pub(super) fn energy(&self, energy: f64, drive: &Drive, kinetic: f64) -> f64 {
        if drive.passing {
            energy * self.passing
        } else if drive.is_free() && energy > 0.0 {
            energy.max(self.motion * kinetic)
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
        let free = Drive::at_rest(Some(0.0));
        let pressed = Drive { pressure: 1.0, ..free.clone() };
        let held = Drive { held: vec![false, true], ..free.clone() };
        let passing = Drive { passing: true, ..pressed.clone() };
        let leads = Drive { leads: true, held: vec![true], ..free.clone() };
        let usual = Leeway::USUAL;
        assert_eq!(usual.energy(1e-3, &free, 1.0), 0.1);
        assert_eq!(usual.energy(1e-3, &free, 0.005), 1e-3);
        assert_eq!(usual.energy(0.0, &free, 1.0), 0.0);
        // As a bake has made it of a body.
        let worn = Drive { lead: std::sync::Arc::new([crate::math::Vec3::zeros()]), ..free.clone() };
        for drive in [&pressed, &held, &leads, &worn] {
            assert_eq!(usual.energy(1e-3, drive, 1.0), 1e-3);
        }
        assert_eq!(usual.energy(1e-3, &passing, 1.0), 5e-3);
        assert_eq!([&leads, &free].map(|drive| usual.stride(drive)), [3.0, 1.0]);
        for drive in [&free, &pressed, &held, &passing, &leads] {
            assert_eq!(Leeway::NONE.energy(1e-3, drive, 1.0), 1e-3);
            assert_eq!(Leeway::NONE.stride(drive), 1.0);
        }
    }
}
