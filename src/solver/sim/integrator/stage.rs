//! The implicit problem of one stage of a step.

use crease_geometry::math::Vec3;

/// One implicit problem of a step.
#[derive(Debug, Clone)]
pub struct Stage {
    /// Positions from which the new velocity is measured, one per point [m].
    pub base_positions: Vec<Vec3>,
    /// Velocities with which the new velocity is compared, one per point [m/s].
    pub base_velocities: Vec<Vec3>,
    /// Effective time step beta h, over which forces act [s].
    pub effective_dt: f64,
    /// Weight w of x_n in `base_positions` = w x_n + (1 - w) `previous_positions` [-]. Every quantity with a rate (a
    /// strain, an angle) has its base by the same sum.
    pub current_weight: f64,
    /// The other positions in that sum, one per point [m]; `None` where the base is x_n alone.
    pub previous_positions: Option<Vec<Vec3>>,
}

impl Stage {
    /// Returns the inertial positions, those without forces, one per point [m].
    pub fn inertial(&self) -> Vec<Vec3> {
        let points = self.base_positions.iter().zip(&self.base_velocities);
        points.map(|(b, d)| b + d * self.effective_dt).collect()
    }

    /// Returns the velocities of new positions `x`, one per point [m/s].
    pub fn velocity(&self, x: &[Vec3]) -> Vec<Vec3> {
        x.iter().zip(&self.base_positions).map(|(x, b)| (x - b) / self.effective_dt).collect()
    }

    /// Returns the base of the rate of a quantity: the weighted sum of its values `current` at x_n and `previous` at
    /// [`Self::previous_positions`]. `previous` is evaluated only where it is needed.
    pub(in crate::sim) fn base_of<T: Clone, const N: usize>(
        &self,
        current: Vec<T>,
        previous: impl FnOnce(&[Vec3]) -> Vec<T>,
        to_array: impl Fn(&T) -> [f64; N],
        from_array: impl Fn([f64; N]) -> T,
    ) -> Vec<T> {
        let Some(positions) = &self.previous_positions else { return current };
        let mix = |(a, b): (&T, &T)| {
            let (a, b) = (to_array(a), to_array(b));
            from_array(std::array::from_fn(|k| {
                self.current_weight * a[k] + (1.0 - self.current_weight) * b[k]
            }))
        };
        current.iter().zip(&previous(positions)).map(mix).collect()
    }
}

/// Returns `weight` a + (1 - `weight`) b.
pub(super) fn weighted_sum(weight: f64, a: &[Vec3], b: &[Vec3]) -> Vec<Vec3> {
    a.iter().zip(b).map(|(a, b)| a * weight + b * (1.0 - weight)).collect()
}
