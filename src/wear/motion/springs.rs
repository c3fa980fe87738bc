//! Springs that carry and hold points of the cloth.

use crate::wear::tuning::TUNING;
use crease_geometry::math::Vec3;
use crease_solver::energy::TargetSpring;
use crease_solver::sim::GRAVITY;

/// The spring that carries a point of `mass` [kg]: it draws the point to `target`, stiffly along `normal`, and balances its
/// weight.
pub(crate) fn carry_spring(point: u32, target: Vec3, normal: Vec3, mass: f64) -> TargetSpring {
    let weight = Vec3::y() * (mass * GRAVITY);
    let stiffness = mass * GRAVITY / TUNING.springs.sag;
    let tangential_stiffness = TUNING.springs.tangential_fraction * stiffness;
    let along = normal * normal.dot(&weight);
    let target = target + along / stiffness + (weight - along) / tangential_stiffness;
    TargetSpring { point, target, normal, stiffness, tangential_stiffness }
}

/// The spring that holds a point of `mass` [kg] at `position`.
pub(crate) fn pin_spring(point: u32, position: Vec3, mass: f64) -> TargetSpring {
    TargetSpring::isotropic(point, position, mass * GRAVITY / TUNING.springs.sag)
}
