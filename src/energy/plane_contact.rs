//! The body under single points of cloth: each rests on a plane of its own and rubs on it.
//!
//! ```text
//! E = k/2 (r - g)²  for g = n.(x - c) < r,      D = limit f(|u|),   u = u0 + (I - n n^T) (x - from)
//! f' = 2 y/eps - y²/eps²  for y < eps, else 1
//! ```
//!
//! The plane is that of the body's surface nearest to the point, where the body is at the end of the step; `from` is where
//! the point would be had it stuck, so that cloth goes along with the skin. Convex, and defined at any depth: cloth that is
//! caught between two parts of a body is pushed by each and held by none. Who is near what is `contact::body_field`'s.

use crate::energy::{BlockSink, Energy};
use crate::math::{Mat3, Vec3};

/// The body under one point.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PlaneContact {
    /// The point.
    pub point: u32,
    /// Place of the surface at the end of the step [m].
    pub anchor: Vec3,
    /// Its outward normal there, unit.
    pub normal: Vec3,
    /// It pushes nearer than this [m].
    pub dhat: f64,
    /// [N/m].
    pub stiffness: f64,
    /// Where the point would be had it stuck [m].
    pub stick_point: Vec3,
    /// Friction coefficient times normal force [N].
    pub max_friction: f64,
    /// It sticks within this [m].
    pub slip_tol: f64,
    /// Tangential stretch that it begins with [m].
    pub stretch: Vec3,
}

impl PlaneContact {
    /// Height over the surface [m].
    pub fn gap(&self, x: &Vec3) -> f64 {
        self.normal.dot(&(x - self.anchor))
    }

    /// Tangential stretch at `x` [m].
    pub fn stretch_at(&self, x: &Vec3) -> Vec3 {
        let u = self.stretch + (x - self.stick_point);
        u - self.normal * self.normal.dot(&u)
    }

    fn value(&self, x: &Vec3) -> f64 {
        let press = (self.dhat - self.gap(x)).max(0.0);
        let (y, eps) = (self.stretch_at(x).norm(), self.slip_tol);
        let rub = if y < eps { y * y / eps - y.powi(3) / (3.0 * eps * eps) } else { y - eps / 3.0 };
        0.5 * self.stiffness * press * press + self.max_friction * rub
    }

    fn gradient(&self, x: &Vec3) -> Vec3 {
        let press = (self.dhat - self.gap(x)).max(0.0);
        let u = self.stretch_at(x);
        u * (self.max_friction * self.steepness(u.norm())) - self.normal * (self.stiffness * press)
    }

    /// f'(y) / y [1/m].
    fn steepness(&self, y: f64) -> f64 {
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
            let u = self.stretch_at(x);
            let (y, eps) = (u.norm(), self.slip_tol);
            let steep = self.steepness(y);
            let curve = if y < eps { 2.0 / eps - 2.0 * y / (eps * eps) } else { 0.0 };
            block += (Mat3::identity() - along) * (self.max_friction * steep);
            if let Some(u) = u.try_normalize(0.0) {
                block += u * u.transpose() * (self.max_friction * (curve - steep));
            }
        }
        block
    }
}

/// All of them.
pub struct PlaneContacts<'a>(pub &'a [PlaneContact]);

impl Energy for PlaneContacts<'_> {
    fn name(&self) -> &'static str {
        "body"
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
    use super::super::energy_checks::check_gradient_and_hessian;
    use super::*;

    #[test]
    fn passes_the_shelf_sticking_and_sliding() {
        let normal = Vec3::new(0.2, 0.9, -0.4).normalize();
        let cushion = |point, stretch: Vec3| PlaneContact {
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
        let all = [cushion(0, Vec3::zeros()), cushion(1, Vec3::new(0.02, 0.01, 0.0))];
        check_gradient_and_hessian(
            &PlaneContacts(&all),
            &[Vec3::new(0.101, 0.001, 0.0005), Vec3::new(0.12, -0.003, 0.01)],
            1e-7,
        );
    }
}
