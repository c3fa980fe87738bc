//! One-sided contact of single points of the cloth with a body, each with its own plane, and lagged friction on it.
//!
//! ```text
//! E = k/2 (d - g)²  for g = n.(x - c) < d,      D = max_friction f(|u|),   u = u0 + (I - n n^T) (x - stick_point)
//! f' = 2 y/eps - y²/eps²  for y < eps, else 1
//! ```
//!
//! The plane is tangent to the surface of the body next to the point, with the body as it is at the end of the step; d
//! is the activation distance, eps the slip tolerance. `stick_point` is the position of the point had it stuck, so that
//! cloth moves along with the body. The Hessian of the friction is the secant f'(|u|)/|u| in all directions along the
//! plane, the smallest quadratic upper bound of its potential (de Leeuw, Lange 2009): with the exact one, which is zero
//! along the slip, points slide too far and back. The energy is convex and defined at any penetration depth: cloth between two parts
//! of a body is pushed by both. The friction potential is that of Li and others 2020 (IPC). The pairs are found by
//! `contact::body_planes`.

use crate::energy::term::Energy;
use crease_geometry::math::{Mat3, Vec3};
use crease_linear::BlockSink;

/// Contact of one point with a plane of the body.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PlaneContact {
    /// Index of the point.
    pub point: u32,
    /// Position on the surface of the body at the end of the step [m].
    pub anchor: Vec3,
    /// Outward unit normal of the body there.
    pub normal: Vec3,
    /// Activation distance [m]: the contact pushes below it.
    pub dhat: f64,
    /// Stiffness of the contact [N/m].
    pub stiffness: f64,
    /// Position of the point had it stuck [m].
    pub stick_point: Vec3,
    /// Maximum friction force: friction coefficient times normal force [N].
    pub max_friction: f64,
    /// Tangential displacement below which the point sticks [m].
    pub slip_tol: f64,
    /// Tangential displacement from stick at the beginning of the step [m].
    pub stretch: Vec3,
}

impl PlaneContact {
    /// Returns the height above the plane [m].
    pub fn gap(&self, x: &Vec3) -> f64 {
        self.normal.dot(&(x - self.anchor))
    }

    /// Returns the tangential displacement from stick at `x` [m].
    pub fn stretch_at(&self, x: &Vec3) -> Vec3 {
        let u = self.stretch + (x - self.stick_point);
        u - self.normal * self.normal.dot(&u)
    }

    fn value(&self, x: &Vec3) -> f64 {
        let depth = (self.dhat - self.gap(x)).max(0.0);
        let (y, eps) = (self.stretch_at(x).norm(), self.slip_tol);
        let friction = if y < eps { y * y / eps - y.powi(3) / (3.0 * eps * eps) } else { y - eps / 3.0 };
        0.5 * self.stiffness * depth * depth + self.max_friction * friction
    }

    fn gradient(&self, x: &Vec3) -> Vec3 {
        let depth = (self.dhat - self.gap(x)).max(0.0);
        let u = self.stretch_at(x);
        u * (self.max_friction * self.slope_ratio(u.norm())) - self.normal * (self.stiffness * depth)
    }

    /// Returns f'(y) / y [1/m].
    fn slope_ratio(&self, y: f64) -> f64 {
        let eps = self.slip_tol;
        if y < eps { 2.0 / eps - y / (eps * eps) } else { 1.0 / y }
    }

    fn hessian(&self, x: &Vec3) -> Mat3 {
        let along = self.normal * self.normal.transpose();
        let mut block = Mat3::zeros();
        if self.gap(x) < self.dhat {
            block += along * self.stiffness;
        }
        if self.max_friction > 0.0 {
            let ratio = self.slope_ratio(self.stretch_at(x).norm());
            block += (Mat3::identity() - along) * (self.max_friction * ratio);
        }
        block
    }
}

/// All contacts of one step as an energy term.
pub struct PlaneContacts<'a>(pub &'a [PlaneContact]);

impl Energy for PlaneContacts<'_> {
    fn name(&self) -> &'static str {
        "plane contacts"
    }

    fn value(&self, x: &[Vec3]) -> f64 {
        self.0.iter().map(|c| c.value(&x[c.point as usize])).sum()
    }

    fn add_gradient(&self, x: &[Vec3], out: &mut [Vec3]) {
        self.0.iter().for_each(|c| out[c.point as usize] += c.gradient(&x[c.point as usize]));
    }

    fn add_hessian(&self, x: &[Vec3], out: &mut dyn BlockSink) {
        for c in self.0 {
            let block = c.hessian(&x[c.point as usize]);
            if block != Mat3::zeros() {
                out.add(c.point, c.point, &block);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::energy::energy_checks::check_gradient_and_hessian;

    #[test]
    fn gradient_and_hessian_match_in_stick_and_slip() {
        let normal = Vec3::new(0.2, 0.9, -0.4).normalize();
        let contact = |point, stretch: Vec3| PlaneContact {
            point,
            anchor: Vec3::new(0.1, 0.0, 0.0),
            normal,
            dhat: 0.01,
            stiffness: 50.0,
            stick_point: Vec3::new(0.1, 0.002, 0.0),
            max_friction: 0.3,
            slip_tol: 0.004,
            stretch,
        };
        let all = [contact(0, Vec3::zeros()), contact(1, Vec3::new(0.02, 0.01, 0.0))];
        check_gradient_and_hessian(
            &PlaneContacts(&all),
            &[Vec3::new(0.101, 0.001, 0.0005), Vec3::new(0.12, -0.003, 0.01)],
            1e-7,
        );
    }
}
