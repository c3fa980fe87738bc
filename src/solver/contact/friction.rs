//! Lagged Coulomb friction with a tangential stretch per contact.
//!
//! Normal forces and directions are those at the start of the step; the slip is implicit. Every contact keeps a tangential stretch u
//! from step to step, as a bristle that bends before it slides, so that a sticking contact does not creep:
//!
//! ```text
//! u = u_n + T (x - x_n)            x_n: start of the step;  T: tangential part of the relative motion
//! D(u) = mu lambda f(|u|),   f' = 2 y/eps - y²/eps² for y < eps, else 1
//! after the step: u_n <- u min(1, eps/|u|)
//! ```
//!
//! The smooth f is that of Li et al. 2020 ("Incremental Potential Contact", eq. 15 to 18). There u is the slip of the step alone, and
//! a load below the limit slides at a small velocity for ever; with the kept stretch it comes to rest within eps. The stretch is kept
//! relative to eps, which grows with the step: force and position do not change when the step does.
//!
//! The Hessian is the secant f'(y)/y in every direction across the normal, the smallest quadratic that lies nowhere below D (f is
//! concave in y²: de Leeuw, Lange 2009, "Sharp quadratic majorization in one dimension"). The true Hessian of a sliding contact is zero
//! along its slip: Newton directions went far beyond the point where it sticks again.
//!
//! A sticking contact bears up to `static_ratio` times the force of a sliding one.

use crate::contact::broad_phase::PairKind;
use crate::contact::tuning::TUNING;
use crease_geometry::math::{Mat3, Vec3};
use crease_linear::{BlockSink, add_symmetric};
use rustc_hash::FxHashMap;
use serde::{Deserialize, Serialize};

/// Identity of a contact from step to step.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
struct ContactKey {
    /// Kind of the pair; `None` for a plane.
    kind: Option<PairKind>,
    points: [u32; 4],
}

/// One lagged contact.
#[derive(Debug, Clone, Copy)]
pub(super) struct FrictionContact {
    /// Kind of the pair; `None` for a plane.
    pub kind: Option<PairKind>,
    /// Points in contact; unused ones have weight 0 and repeat the first.
    pub points: [u32; 4],
    /// Signed weights: relative motion = sum w_i (x_i - start_i).
    pub weights: [f64; 4],
    /// Unit normal.
    pub normal: Vec3,
    /// Friction coefficient times normal force [N].
    pub max_force: f64,
    /// Stretch at the start of the step [m], across the normal.
    pub stretch: Vec3,
}

impl FrictionContact {
    fn key(&self) -> ContactKey {
        ContactKey { kind: self.kind, points: self.points }
    }
}

/// Friction contacts of a step.
#[derive(Debug, Clone, Default)]
pub(super) struct Friction {
    pub contacts: Vec<FrictionContact>,
    /// Positions at the start of the step [m].
    start: Vec<Vec3>,
    /// Stretch eps at which a contact begins to slide [m].
    slip_tol: f64,
    static_ratio: f64,
    /// All contacts, while `contacts` are those of a subset of points.
    unrestricted: Option<Vec<FrictionContact>>,
    /// Stretch after the last accepted step, over `slip_tol` [-].
    stretch_ratios: FxHashMap<ContactKey, Vec3>,
}

/// Tangential state of one contact after the last accepted step.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct TangentialState {
    /// Kind of the pair; `None` for a plane.
    kind: Option<PairKind>,
    points: [u32; 4],
    /// Stretch over the stretch at which the contact slides [-].
    #[serde(with = "crease_geometry::math::serde_vec::vector")]
    stretch_ratio: Vec3,
}

/// Returns the stretch at which a contact begins to slide in a step of `h` seconds [m]. Speeds below `slip_velocity_tol` [m/s] count
/// as rest.
pub(super) fn slip_tolerance(slip_velocity_tol: f64, h: f64) -> f64 {
    (slip_velocity_tol * h).min(TUNING.friction.max_slip_tolerance)
}

impl Friction {
    /// Starts a step at `x` [m] without contacts.
    pub fn begin_step(&mut self, x: &[Vec3], slip_tol: f64, static_ratio: f64) {
        self.contacts.clear();
        self.start.clear();
        self.start.extend_from_slice(x);
        self.slip_tol = slip_tol;
        self.static_ratio = static_ratio;
    }

    /// Adds a contact. Its stretch is the one that was kept, rotated into the present tangent plane.
    pub fn add(&mut self, mut contact: FrictionContact) {
        if let Some(kept) = self.stretch_ratios.get(&contact.key()) {
            let across = kept - contact.normal * contact.normal.dot(kept);
            let length = across.norm();
            if length > 0.0 {
                contact.stretch = across * (self.slip_tol * kept.norm() / length);
            }
            if kept.norm() < TUNING.friction.sliding_ratio {
                contact.max_force *= self.static_ratio;
            }
        }
        self.contacts.push(contact);
    }

    /// Leaves out contacts of points that are all fixed; `moving` has one flag per point.
    pub fn restrict_to(&mut self, moving: &[bool]) {
        let moves =
            |c: &&FrictionContact| c.points.iter().any(|p| moving.get(*p as usize).is_some_and(|m| *m));
        let subset = self.contacts.iter().filter(moves).copied().collect();
        self.unrestricted = Some(std::mem::replace(&mut self.contacts, subset));
    }

    /// Takes all contacts into account again.
    pub fn unrestrict(&mut self) {
        if let Some(all) = self.unrestricted.take() {
            self.contacts = all;
        }
    }

    /// Returns the state of all contacts, in a fixed order.
    pub fn state(&self) -> Vec<TangentialState> {
        let state = |(key, &stretch_ratio): (&ContactKey, &Vec3)| TangentialState {
            kind: key.kind,
            points: key.points,
            stretch_ratio,
        };
        let mut all: Vec<_> = self.stretch_ratios.iter().map(state).collect();
        all.sort_unstable_by_key(|s| (s.kind, s.points));
        all
    }

    /// Continues from the state of all contacts.
    pub fn restore(&mut self, state: &[TangentialState]) {
        let key = |s: &TangentialState| ContactKey { kind: s.kind, points: s.points };
        self.stretch_ratios = state.iter().map(|s| (key(s), s.stretch_ratio)).collect();
    }

    /// Accepts the step at `x` [m]: keeps the stretch of every contact.
    pub fn end_step(&mut self, x: &[Vec3]) {
        self.stretch_ratios.clear();
        for c in &self.contacts {
            let u = self.stretch(c, x);
            let y = u.norm();
            let ratio = if y < self.slip_tol { u / self.slip_tol } else { u / y };
            self.stretch_ratios.insert(c.key(), ratio);
        }
    }

    /// Returns the stretch u of a contact at `x` [m].
    #[inline]
    fn stretch(&self, c: &FrictionContact, x: &[Vec3]) -> Vec3 {
        let mut u = Vec3::zeros();
        for (&p, &w) in c.points.iter().zip(&c.weights) {
            u += (x[p as usize] - self.start[p as usize]) * w;
        }
        u - c.normal * c.normal.dot(&u) + c.stretch
    }

    /// Returns the dissipation potential at `x` [J].
    pub fn value(&self, x: &[Vec3]) -> f64 {
        let e = self.slip_tol;
        let potential = |y: f64| {
            if y < e { y * y / e - y * y * y / (3.0 * e * e) + e / 3.0 } else { y }
        };
        self.contacts.iter().map(|c| c.max_force * potential(self.stretch(c, x).norm())).sum()
    }

    /// Returns f'(y) / y [1/m].
    #[inline]
    fn secant(&self, y: f64) -> f64 {
        let e = self.slip_tol;
        if y < e { (2.0 - y / e) / e } else { 1.0 / y }
    }

    /// Returns the gradient of one contact by its relative motion [N].
    pub fn contact_gradient(&self, c: &FrictionContact, x: &[Vec3]) -> Vec3 {
        let u = self.stretch(c, x);
        u * (c.max_force * self.secant(u.norm()))
    }

    /// Adds the gradient [N].
    pub fn add_gradient(&self, x: &[Vec3], out: &mut [Vec3]) {
        for c in &self.contacts {
            add_weighted_gradient(out, &c.points, &c.weights, &self.contact_gradient(c, x));
        }
    }

    /// Returns the secant Hessian of one contact by its relative motion [N/m], which is positive semidefinite.
    pub fn contact_hessian(&self, c: &FrictionContact, x: &[Vec3]) -> Mat3 {
        let y = self.stretch(c, x).norm();
        (Mat3::identity() - c.normal * c.normal.transpose()) * (c.max_force * self.secant(y))
    }

    /// Adds the secant Hessian [N/m].
    pub fn add_hessian(&self, x: &[Vec3], out: &mut dyn BlockSink) {
        for c in &self.contacts {
            if !out.is_relevant(&c.points) {
                continue;
            }
            add_weighted_hessian(out, &c.points, &c.weights, &self.contact_hessian(c, x));
        }
    }
}

/// Adds w_i `gradient` for each of the four points.
#[inline]
pub(super) fn add_weighted_gradient(
    out: &mut [Vec3],
    points: &[u32; 4],
    weights: &[f64; 4],
    gradient: &Vec3,
) {
    for (&p, &w) in points.iter().zip(weights) {
        out[p as usize] += gradient * w;
    }
}

/// Adds w_i w_j `block` for every pair of the four points.
#[inline]
pub(super) fn add_weighted_hessian(
    out: &mut dyn BlockSink,
    points: &[u32; 4],
    weights: &[f64; 4],
    block: &Mat3,
) {
    for i in 0..4 {
        for j in 0..=i {
            let weight = weights[i] * weights[j];
            if weight != 0.0 {
                add_symmetric(out, points[i], points[j], &(block * weight));
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn on_the_ground(max_force: f64) -> FrictionContact {
        FrictionContact {
            kind: None,
            points: [0; 4],
            weights: [1.0, 0.0, 0.0, 0.0],
            normal: Vec3::y(),
            max_force,
            stretch: Vec3::zeros(),
        }
    }

    /// Drags a point by `displacements` [m], one accepted step each; returns the force after each [N].
    fn dragged(displacements: &[f64], slip_tol: f64) -> Vec<f64> {
        let mut friction = Friction::default();
        let mut x = [Vec3::zeros()];
        let mut forces = Vec::new();
        for displacement in displacements {
            friction.begin_step(&x, slip_tol, 1.0);
            friction.add(on_the_ground(2.0));
            x[0].x += displacement;
            forces.push(friction.contact_gradient(&friction.contacts[0], &x).x);
            friction.end_step(&x);
        }
        forces
    }

    #[test]
    fn a_stretch_below_the_limit_is_kept_and_one_above_slides() {
        let forces = dragged(&[0.5e-5, 0.0, 0.0, 3e-5, 1e-7, -1e-5, -1e-5], 1e-5);
        assert!((forces[0] - 1.5).abs() < 1e-12, "2 (2 y - y²) at y = 1/2");
        assert_eq!(forces[..3], [forces[0]; 3], "no creep");
        assert_eq!(forces[3..5], [2.0, 2.0], "the limit at any distance");
        assert!(
            forces[5].abs() < 1e-9 && forces[6] == -2.0,
            "unloaded, then in the other direction: {forces:?}"
        );
    }

    #[test]
    fn force_and_position_do_not_change_with_the_step() {
        let mut friction = Friction::default();
        let mut x = [Vec3::zeros()];
        friction.begin_step(&x, 1e-5, 1.0);
        friction.add(on_the_ground(2.0));
        x[0].z = 0.3e-5;
        let before = friction.contact_gradient(&friction.contacts[0], &x);
        friction.end_step(&x);
        friction.begin_step(&x, 7e-4, 1.0);
        friction.add(on_the_ground(2.0));
        assert!((friction.contact_gradient(&friction.contacts[0], &x) - before).norm() < 1e-12);
    }

    #[test]
    fn the_gradient_matches_differences_and_the_secant_lies_nowhere_below() {
        let mut friction = Friction::default();
        let mut x = [Vec3::zeros()];
        friction.begin_step(&x, 1e-3, 1.0);
        friction.add(on_the_ground(3.0));
        x[0] = Vec3::new(2e-4, 0.0, -3e-4);
        friction.end_step(&x);
        friction.begin_step(&x, 1e-3, 1.0);
        friction.add(on_the_ground(3.0));
        for displacement in [Vec3::new(1e-4, 2e-4, 3e-4), Vec3::new(2e-3, 0.0, 1e-3)] {
            let here = [x[0] + displacement];
            let e = 1e-8;
            let force = friction.contact_gradient(&friction.contacts[0], &here);
            let block = friction.contact_hessian(&friction.contacts[0], &here);
            for axis in 0..3 {
                let (mut up, mut down) = (here, here);
                up[0][axis] += e;
                down[0][axis] -= e;
                let slope = (friction.value(&up) - friction.value(&down)) / (2.0 * e);
                assert!((slope - force[axis]).abs() < 1e-6 * 3.0, "{slope} {force}");
            }
            let value = friction.value(&here);
            let mut tight = f64::INFINITY;
            for k in 0..400 {
                let (sin, cos) = (0.1 * f64::from(k)).sin_cos();
                let d = Vec3::new(cos, 0.3, sin) * (1e-5 * f64::from(k));
                let bound = value + force.dot(&d) + 0.5 * d.dot(&(block * d));
                let there = friction.value(&[here[0] + d]);
                assert!(there <= bound + 1e-15, "{d}: {there} above {bound}");
                tight = if k > 0 { tight.min((bound - there) / (0.5 * d.dot(&(block * d)))) } else { tight };
            }
            assert!(tight < 1e-2, "tight somewhere: {tight}");
        }
    }

    #[test]
    fn a_sticking_contact_bears_more_until_it_slides() {
        let mut friction = Friction::default();
        let mut x = [Vec3::zeros()];
        let mut force_after = |displacement: f64, friction: &mut Friction| {
            friction.begin_step(&x, 1e-5, 1.5);
            friction.add(on_the_ground(2.0));
            x[0].x += displacement;
            let force = friction.contact_gradient(&friction.contacts[0], &x).x;
            friction.end_step(&x);
            force
        };
        assert!((force_after(0.1e-5, &mut friction) - 2.0 * (0.2 - 0.01)).abs() < 1e-12);
        assert_eq!(force_after(1e-4, &mut friction), 3.0, "slides at the static limit");
        assert_eq!(force_after(1e-4, &mut friction), 2.0, "sliding");
    }
}
