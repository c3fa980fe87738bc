//! Time integrators, one file each.
//!
//! An integrator is three answers (PolyFEM's cut): where the points would go without forces, how strongly forces
//! count, and what velocity belongs to a new position. Newton knows nothing more of it:
//!
//! ```text
//! v = (x - base) / span            minimise |x - inertial|²_M / (2 span²) + E(x),   inertial = base + span * drift
//! ```

mod backward_euler;
mod bdf2;

use super::State;
use crate::math::Vec3;

/// What one step of an integrator needs to know.
#[derive(Debug, Clone)]
pub struct Stage {
    /// Positions that the new velocity is measured from, one per point [m].
    pub base: Vec<Vec3>,
    /// Velocities that the new velocity is compared with, one per point [m/s].
    pub drift: Vec<Vec3>,
    /// beta h: share of the step that forces count for [s].
    pub span: f64,
}

impl Stage {
    /// Where the points would go without forces [m].
    pub fn inertial(&self) -> Vec<Vec3> {
        self.base.iter().zip(&self.drift).map(|(b, d)| b + d * self.span).collect()
    }

    /// Velocity of new positions [m/s].
    pub fn velocity(&self, x: &[Vec3]) -> Vec<Vec3> {
        x.iter().zip(&self.base).map(|(x, b)| (x - b) / self.span).collect()
    }
}

/// The list of integrators.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Method {
    /// Backward Euler: first order, damps strongly.
    BackwardEuler,
    /// BDF2 with variable steps: second order; starts, and restarts after a jump, with one step of backward Euler.
    Bdf2,
}

/// Steps may grow by this factor at most: variable-step BDF2 is unstable beyond 1 + sqrt 2 (physics.md 4.2).
pub const MOST_GROWTH: f64 = 2.0;

impl Method {
    /// Every method with its name on the command line.
    pub const ALL: [(&'static str, Self); 2] =
        [("backward-euler", Self::BackwardEuler), ("bdf2", Self::Bdf2)];

    /// The method of that name.
    pub fn named(name: &str) -> Option<Self> {
        Self::ALL.iter().find(|(n, _)| *n == name).map(|(_, m)| *m)
    }

    /// Its name on the command line.
    pub fn name(self) -> &'static str {
        Self::ALL.iter().find(|(_, m)| *m == self).map_or("", |(n, _)| n)
    }

    /// Order of convergence.
    pub fn order(self) -> u32 {
        match self {
            Self::BackwardEuler => 1,
            Self::Bdf2 => 2,
        }
    }

    /// The stage of a step of `h` seconds from `state`.
    pub fn stage(self, state: &State, h: f64) -> Stage {
        match (self, &state.previous) {
            (Self::Bdf2, Some(previous)) if h <= MOST_GROWTH * previous.step * (1.0 + 1e-9) => {
                bdf2::stage(state, previous, h)
            }
            _ => backward_euler::stage(state, h),
        }
    }
}
