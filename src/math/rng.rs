//! Numbers that look random and are the same on every machine: shaken starts of charts, and tests.

use crate::math::Vec3;

/// A linear congruential generator (multiplier and increment of Knuth's MMIX), of which the upper 53 bits are given.
#[derive(Debug, Clone)]
pub struct Draw(u64);

impl Draw {
    /// Goes on from `state`. States in a row give first numbers that are close together: see [`Draw::seeded`].
    pub fn from_state(state: u64) -> Self {
        Self(state)
    }

    /// Draws that have nothing in common for seeds in a row.
    pub fn seeded(seed: u64) -> Self {
        let mut draw = Self(seed.wrapping_mul(0x9E37_79B9_7F4A_7C15).wrapping_add(1));
        (0..4).for_each(|_| {
            draw.unit();
        });
        draw
    }

    /// The next 64 bits; the lower ones repeat early.
    pub fn bits(&mut self) -> u64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        self.0
    }

    /// 0 to 1, less than 1.
    pub fn unit(&mut self) -> f64 {
        (self.bits() >> 11) as f64 / (1u64 << 53) as f64
    }

    /// 0 to 1 along every axis.
    pub fn in_unit_cube(&mut self) -> Vec3 {
        Vec3::new(self.unit(), self.unit(), self.unit())
    }

    /// -1 to 1 along every axis.
    pub fn vector(&mut self) -> Vec3 {
        (self.in_unit_cube() - Vec3::repeat(0.5)) * 2.0
    }
}
