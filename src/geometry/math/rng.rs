//! Pseudo-random numbers that are the same on every machine: perturbed initial conditions of charts, and tests.

use crate::math::Vec3;

/// Linear congruential generator with the multiplier and increment of Knuth's MMIX; real numbers use its upper 53 bits.
#[derive(Debug, Clone)]
pub struct Rng(u64);

impl Rng {
    /// Continues from `state`. Consecutive states give first numbers that are close together: see [`Rng::from_seed`].
    pub fn from_state(state: u64) -> Self {
        Self(state)
    }

    /// Creates a generator; consecutive seeds give unrelated sequences.
    pub fn from_seed(seed: u64) -> Self {
        let mut rng = Self(seed.wrapping_mul(0x9E37_79B9_7F4A_7C15).wrapping_add(1));
        (0..4).for_each(|_| {
            rng.uniform();
        });
        rng
    }

    /// Returns the next 64 bits; the lower ones have short periods.
    pub fn next_u64(&mut self) -> u64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        self.0
    }

    /// Returns a number in [0, 1).
    pub fn uniform(&mut self) -> f64 {
        (self.next_u64() >> 11) as f64 / (1u64 << 53) as f64
    }

    /// Returns a vector in [0, 1)^3.
    pub fn in_unit_cube(&mut self) -> Vec3 {
        Vec3::new(self.uniform(), self.uniform(), self.uniform())
    }

    /// Returns a vector in [-1, 1)^3.
    pub fn in_cube(&mut self) -> Vec3 {
        (self.in_unit_cube() - Vec3::repeat(0.5)) * 2.0
    }
}
