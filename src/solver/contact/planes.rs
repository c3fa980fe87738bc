//! Ground and ceiling: horizontal planes that points of the cloth stay between.

use crate::contact::barrier;
use crease_geometry::math::{Mat3, Vec3};
use crease_linear::BlockSink;

/// Ground below and ceiling above the cloth, seen by points only.
pub(super) struct HorizontalPlanes {
    ground: Option<f64>,
    ceiling: Option<f64>,
    /// Activation distance [m].
    dhat: f64,
    /// Stiffness of the barrier [N/m], one per point.
    stiffness: Vec<f64>,
}

/// A plane at a height [m] with the side that the cloth is on: +1 above the ground, -1 below the ceiling.
#[derive(Clone, Copy)]
struct Plane {
    height: f64,
    side: f64,
}

impl Plane {
    /// Returns the distance of a point [m].
    fn gap(&self, x: &Vec3) -> f64 {
        self.side * (x.y - self.height)
    }
}

impl HorizontalPlanes {
    /// No planes yet. `dhat`: activation distance [m]; `stiffness` [N/m] has one entry per point.
    pub fn new(dhat: f64, stiffness: Vec<f64>) -> Self {
        Self { ground: None, ceiling: None, dhat, stiffness }
    }

    /// Puts the planes at these heights [m], or removes them.
    pub fn set(&mut self, ground: Option<f64>, ceiling: Option<f64>) {
        self.ground = ground;
        self.ceiling = ceiling;
    }

    fn all(&self) -> impl Iterator<Item = Plane> + use<> {
        let at = |height: Option<f64>, side: f64| height.map(|height| Plane { height, side });
        [at(self.ground, 1.0), at(self.ceiling, -1.0)].into_iter().flatten()
    }

    /// Returns the normal force of the ground on each point of the cloth at `x` [N]; `None` without a ground.
    pub fn ground_forces<'a>(&'a self, x: &'a [Vec3]) -> Option<impl Iterator<Item = f64> + 'a> {
        let ground = self.ground?;
        let stiffness = self.stiffness.iter();
        Some(x.iter().zip(stiffness).map(move |(x, k)| -barrier::derivative(x.y - ground, self.dhat, *k)))
    }

    /// Shortens the displacements `d` of single points from `x` until none passes a plane.
    pub fn limit_displacement(&self, x: &[Vec3], d: &mut [Vec3]) {
        for plane in self.all() {
            for (x, d) in x.iter().zip(d.iter_mut()) {
                *d *= self.step_size(plane, x, d);
            }
        }
    }

    /// Returns the step size that keeps all points off the planes [-].
    pub fn uniform_step_size(&self, x: &[Vec3], d: &[Vec3]) -> f64 {
        let mut step_size: f64 = 1.0;
        for plane in self.all() {
            for (x, d) in x.iter().zip(d) {
                step_size = step_size.min(self.step_size(plane, x, d));
            }
        }
        step_size
    }

    /// Returns the step size of the displacement `d` from `x` that stays off a plane [-].
    fn step_size(&self, plane: Plane, x: &Vec3, d: &Vec3) -> f64 {
        let (gap, approach) = (plane.gap(x), plane.side * d.y);
        let min_gap = barrier::min_distance(gap, self.dhat);
        if approach < 0.0 && gap + approach < min_gap {
            ((gap - min_gap) / -approach).clamp(0.0, 1.0)
        } else {
            1.0
        }
    }

    /// Returns the energy of the barriers at `x` [J]; infinite beyond a plane.
    pub fn value(&self, x: &[Vec3]) -> f64 {
        let mut sum = 0.0;
        for plane in self.all() {
            for (x, k) in x.iter().zip(&self.stiffness) {
                let gap = plane.gap(x);
                if gap <= 0.0 {
                    return f64::INFINITY;
                }
                sum += barrier::value(gap, self.dhat, *k);
            }
        }
        sum
    }

    /// Adds the gradient [N].
    pub fn add_gradient(&self, x: &[Vec3], out: &mut [Vec3]) {
        for plane in self.all() {
            for ((x, k), g) in x.iter().zip(&self.stiffness).zip(out.iter_mut()) {
                g.y += plane.side * barrier::derivative(plane.gap(x), self.dhat, *k);
            }
        }
    }

    /// Adds the Hessian [N/m].
    pub fn add_hessian(&self, x: &[Vec3], out: &mut dyn BlockSink) {
        let up = Mat3::from_diagonal(&Vec3::y());
        for plane in self.all() {
            for (p, (x, k)) in x.iter().zip(&self.stiffness).enumerate() {
                let curvature = barrier::second_derivative(plane.gap(x), self.dhat, *k);
                if curvature > 0.0 {
                    out.add(p as u32, p as u32, &(up * curvature));
                }
            }
        }
    }
}
