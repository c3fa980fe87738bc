//! The number types of a factor.

/// A number type of a factor.
pub(super) trait Real: faer::traits::RealField + Copy + Default {
    /// Magnitude below which entries of a factor are set to zero, where the largest are about 1e6: products of two
    /// entries at this limit are still normal numbers.
    const TINY: Self;
    fn from_f64(x: f64) -> Self;
    fn to_f64(self) -> f64;
}

impl Real for f32 {
    const TINY: Self = 2e-13;
    #[inline]
    fn from_f64(x: f64) -> Self {
        x as Self
    }
    #[inline]
    fn to_f64(self) -> f64 {
        self.into()
    }
}

impl Real for f64 {
    const TINY: Self = 1e-120;
    #[inline]
    fn from_f64(x: f64) -> Self {
        x
    }
    #[inline]
    fn to_f64(self) -> f64 {
        self
    }
}
