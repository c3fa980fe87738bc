//! Coulomb friction, lagged: the normal forces and directions are those at the start of the step, the slip is
//! implicit. Smoothed around zero slip as in Li et al. 2020 ("Incremental Potential Contact", eq. 15 to 18):
//!
//! ```text
//! D(u) = mu lambda f(|u|),   f' = 2 y/eps - y²/eps² for y < eps, else 1        u: tangential slip of the step [m]
//! ```
//!
//! Below `eps` the pair sticks but for a slip of that size; `eps` follows the step so that the creep velocity is set.

use crate::energy::{BlockSink, add_symmetric};
use crate::math::{Mat3, Vec3};

/// One lagged contact.
#[derive(Debug, Clone, Copy)]
pub(super) struct Slider {
    /// The points in contact; unused ones have weight 0 and repeat the first.
    pub points: [u32; 4],
    /// Signed weights: slip = sum w_i (x_i - start_i), tangential part.
    pub weights: [f64; 4],
    /// Unit normal.
    pub normal: Vec3,
    /// Friction coefficient times normal force [N].
    pub limit: f64,
}

/// All sliders of a step.
#[derive(Debug, Clone, Default)]
pub(super) struct Friction {
    pub sliders: Vec<Slider>,
    /// Positions at the start of the step [m].
    pub start: Vec<Vec3>,
    /// Slip below which a contact sticks [m].
    pub stick: f64,
}

impl Friction {
    #[inline]
    fn slip(&self, s: &Slider, x: &[Vec3]) -> Vec3 {
        let mut u = Vec3::zeros();
        for (&p, &w) in s.points.iter().zip(&s.weights) {
            u += (x[p as usize] - self.start[p as usize]) * w;
        }
        u - s.normal * s.normal.dot(&u)
    }

    /// Dissipation potential [J].
    pub fn value(&self, x: &[Vec3]) -> f64 {
        let e = self.stick;
        let potential = |y: f64| {
            if y < e { y * y / e - y * y * y / (3.0 * e * e) + e / 3.0 } else { y }
        };
        self.sliders.iter().map(|s| s.limit * potential(self.slip(s, x).norm())).sum()
    }

    /// f'(y) / y [1/m] and f''(y) [1/m].
    #[inline]
    fn stiffness(&self, y: f64) -> (f64, f64) {
        let e = self.stick;
        if y < e { ((2.0 - y / e) / e, (2.0 - 2.0 * y / e) / e) } else { (1.0 / y, 0.0) }
    }

    /// Adds the gradient [N].
    pub fn add_gradient(&self, x: &[Vec3], out: &mut [Vec3]) {
        for s in &self.sliders {
            let u = self.slip(s, x);
            let force = u * (s.limit * self.stiffness(u.norm()).0);
            for (&p, &w) in s.points.iter().zip(&s.weights) {
                out[p as usize] += force * w;
            }
        }
    }

    /// Adds the Hessian, which is positive.
    pub fn add_hessian(&self, x: &[Vec3], out: &mut dyn BlockSink) {
        for s in &self.sliders {
            let u = self.slip(s, x);
            let y = u.norm();
            let (across, along) = self.stiffness(y);
            let mut block = (Mat3::identity() - s.normal * s.normal.transpose()) * across;
            if y > 0.0 {
                block -= u * u.transpose() * ((across - along) / (y * y));
            }
            block *= s.limit;
            add_weighted(out, &s.points, &s.weights, &block);
        }
    }
}

/// Adds w_i w_j `block` for every pair of the four points.
#[inline]
pub(super) fn add_weighted(out: &mut dyn BlockSink, points: &[u32; 4], weights: &[f64; 4], block: &Mat3) {
    for i in 0..4 {
        for j in 0..=i {
            let share = weights[i] * weights[j];
            if share != 0.0 {
                add_symmetric(out, points[i], points[j], &(block * share));
            }
        }
    }
}
