//! Coulomb friction, lagged: the normal forces and directions are those at the start of the step, the slip is
//! implicit. Every contact keeps a tangential stretch u from step to step, as a bristle does that bends before it
//! slides, so that what sticks does not creep:
//!
//! ```text
//! u = u_n + T (x - x_n)            x_n: start of the step;  T: tangential part of the relative motion
//! D(u) = mu lambda f(|u|),   f' = 2 y/eps - y²/eps² for y < eps, else 1
//! after the step: u_n <- u min(1, eps/|u|)
//! ```
//!
//! The smooth f is that of Li et al. 2020 ("Incremental Potential Contact", eq. 15 to 18). There u is the slip of
//! the step alone, and a load below the limit slides at a creep velocity for ever; with the kept stretch it comes to
//! rest within eps. The stretch is kept as a share of eps, which grows with the step: force and place stay as they
//! are when the step changes.
//!
//! What Newton takes for its Hessian is the secant f'(y)/y in every direction across the normal, the least quadratic that
//! lies nowhere below D (f is concave in y²: de Leeuw, Lange 2009, "Sharp quadratic majorization in one dimension"). The
//! true Hessian of what slides is zero along its way: directions went far beyond the place where it sticks again.
//!
//! A contact that sticks holds up to `static_ratio` times what it bears while it slides.

use crate::contact::broad_phase::PairKind;
use crate::energy::{BlockSink, add_symmetric};
use crate::math::{Mat3, Vec3};
use rustc_hash::FxHashMap;
use serde::{Deserialize, Serialize};

/// What names a contact from step to step: the kind of pair (none for a plane) and its points.
type Key = (Option<PairKind>, [u32; 4]);

/// One lagged contact.
#[derive(Debug, Clone, Copy)]
pub(super) struct FrictionContact {
    /// The kind of pair; none for a plane.
    pub kind: Option<PairKind>,
    /// The points in contact; unused ones have weight 0 and repeat the first.
    pub points: [u32; 4],
    /// Signed weights: relative motion = sum w_i (x_i - start_i).
    pub weights: [f64; 4],
    /// Unit normal.
    pub normal: Vec3,
    /// Friction coefficient times normal force [N].
    pub limit: f64,
    /// Stretch at the start of the step [m], across the normal.
    pub stretch: Vec3,
}

/// All sliders of a step.
#[derive(Debug, Clone, Default)]
pub(super) struct Friction {
    pub sliders: Vec<FrictionContact>,
    /// Positions at the start of the step [m].
    start: Vec<Vec3>,
    /// Stretch at which a contact begins to slide [m].
    stick: f64,
    /// How much more a contact bears that sticks.
    static_ratio: f64,
    /// All of them, while only some points move.
    all: Option<Vec<FrictionContact>>,
    /// Stretch after the last accepted step, as a share of `stick`.
    kept: FxHashMap<Key, Vec3>,
}

/// The stretch that one contact kept from the last accepted step.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct TangentialState {
    /// The kind of pair; none for a plane.
    kind: Option<PairKind>,
    points: [u32; 4],
    /// As a share of what makes it slide.
    #[serde(with = "crate::math::serde_vec::vector")]
    share: Vec3,
}

/// Stretch at which a contact begins to slide, at most [m]. It grows with the step, so that what sticks keeps still for
/// Newton; in a step of seconds that would be millimetres, and wrinkles that friction holds would slide flat.
const MOST_STICK: f64 = 1e-4;

/// Stretch at which a contact begins to slide in a step of `h` seconds [m], where `slip_velocity_tol` [m/s] still counts as rest.
pub(super) fn stick(slip_velocity_tol: f64, h: f64) -> f64 {
    (slip_velocity_tol * h).min(MOST_STICK)
}

/// A contact counts as sliding above this share of `stick`.
const SLIDES: f64 = 1.0 - 1e-9;

impl Friction {
    /// Starts a step at these places without any slider.
    pub fn begin(&mut self, x: &[Vec3], stick: f64, static_ratio: f64) {
        self.sliders.clear();
        self.start.clear();
        self.start.extend_from_slice(x);
        self.stick = stick;
        self.static_ratio = static_ratio;
    }

    /// Adds a contact; its stretch is taken from what was kept, turned into the present tangent plane.
    pub fn add(&mut self, mut slider: FrictionContact) {
        if let Some(kept) = self.kept.get(&(slider.kind, slider.points)) {
            let across = kept - slider.normal * slider.normal.dot(kept);
            let length = across.norm();
            if length > 0.0 {
                slider.stretch = across * (self.stick * kept.norm() / length);
            }
            if kept.norm() < SLIDES {
                slider.limit *= self.static_ratio;
            }
        }
        self.sliders.push(slider);
    }

    /// Leaves out contacts of points that all rest: one flag per point that `moving` ones have set.
    pub fn restrict_to(&mut self, moving: &[bool]) {
        let moves =
            |s: &&FrictionContact| s.points.iter().any(|p| moving.get(*p as usize).is_some_and(|m| *m));
        let few = self.sliders.iter().filter(moves).copied().collect();
        self.all = Some(std::mem::replace(&mut self.sliders, few));
    }

    /// All contacts count again.
    pub fn unrestrict(&mut self) {
        if let Some(all) = self.all.take() {
            self.sliders = all;
        }
    }

    /// What all contacts kept, in a fixed order.
    pub fn kept(&self) -> Vec<TangentialState> {
        let mut all: Vec<_> = self
            .kept
            .iter()
            .map(|(&(kind, points), &share)| TangentialState { kind, points, share })
            .collect();
        all.sort_unstable_by_key(|k| (k.kind, k.points));
        all
    }

    /// Goes on from what contacts kept.
    pub fn restore(&mut self, kept: &[TangentialState]) {
        self.kept = kept.iter().map(|k| ((k.kind, k.points), k.share)).collect();
    }

    /// The step is over at these places: keeps every contact's stretch.
    pub fn accept(&mut self, x: &[Vec3]) {
        self.kept.clear();
        for s in &self.sliders {
            let u = self.slip(s, x);
            let y = u.norm();
            let share = if y < self.stick { u / self.stick } else { u / y };
            self.kept.insert((s.kind, s.points), share);
        }
    }

    #[inline]
    fn slip(&self, s: &FrictionContact, x: &[Vec3]) -> Vec3 {
        let mut u = Vec3::zeros();
        for (&p, &w) in s.points.iter().zip(&s.weights) {
            u += (x[p as usize] - self.start[p as usize]) * w;
        }
        u - s.normal * s.normal.dot(&u) + s.stretch
    }

    /// Dissipation potential [J].
    pub fn value(&self, x: &[Vec3]) -> f64 {
        let e = self.stick;
        let potential = |y: f64| {
            if y < e { y * y / e - y * y * y / (3.0 * e * e) + e / 3.0 } else { y }
        };
        self.sliders.iter().map(|s| s.limit * potential(self.slip(s, x).norm())).sum()
    }

    /// f'(y) / y [1/m].
    #[inline]
    fn secant(&self, y: f64) -> f64 {
        let e = self.stick;
        if y < e { (2.0 - y / e) / e } else { 1.0 / y }
    }

    /// Force with which one contact resists, as a gradient by its relative motion [N].
    pub fn force(&self, s: &FrictionContact, x: &[Vec3]) -> Vec3 {
        let u = self.slip(s, x);
        u * (s.limit * self.secant(u.norm()))
    }

    /// Adds the gradient [N].
    pub fn add_gradient(&self, x: &[Vec3], out: &mut [Vec3]) {
        for s in &self.sliders {
            spread(out, &s.points, &s.weights, &self.force(s, x));
        }
    }

    /// The secant Hessian of one contact by its relative motion [N/m], which is positive.
    pub fn block(&self, s: &FrictionContact, x: &[Vec3]) -> Mat3 {
        let y = self.slip(s, x).norm();
        (Mat3::identity() - s.normal * s.normal.transpose()) * (s.limit * self.secant(y))
    }

    /// Adds the secant Hessian.
    pub fn add_hessian(&self, x: &[Vec3], out: &mut dyn BlockSink) {
        for s in &self.sliders {
            if !out.is_relevant(&s.points) {
                continue;
            }
            add_weighted(out, &s.points, &s.weights, &self.block(s, x));
        }
    }
}

/// Adds w_i `force` for each of the four points.
#[inline]
pub(super) fn spread(out: &mut [Vec3], points: &[u32; 4], weights: &[f64; 4], force: &Vec3) {
    for (&p, &w) in points.iter().zip(weights) {
        out[p as usize] += force * w;
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

#[cfg(test)]
mod tests {
    use super::*;

    fn on_the_ground(limit: f64) -> FrictionContact {
        FrictionContact {
            kind: None,
            points: [0; 4],
            weights: [1.0, 0.0, 0.0, 0.0],
            normal: Vec3::y(),
            limit,
            stretch: Vec3::zeros(),
        }
    }

    /// Drags a point along by `ways` [m], one accepted step each; the force after each.
    fn dragged(ways: &[f64], stick: f64) -> Vec<f64> {
        let mut friction = Friction::default();
        let mut x = [Vec3::zeros()];
        let mut forces = Vec::new();
        for way in ways {
            friction.begin(&x, stick, 1.0);
            friction.add(on_the_ground(2.0));
            x[0].x += way;
            forces.push(friction.force(&friction.sliders[0], &x).x);
            friction.accept(&x);
        }
        forces
    }

    #[test]
    fn a_stretch_below_the_limit_is_kept_and_one_above_slides() {
        let forces = dragged(&[0.5e-5, 0.0, 0.0, 3e-5, 1e-7, -1e-5, -1e-5], 1e-5);
        assert!((forces[0] - 1.5).abs() < 1e-12, "2 (2 y - y²) at y = 1/2");
        assert_eq!(forces[..3], [forces[0]; 3], "no creep");
        assert_eq!(forces[3..5], [2.0, 2.0], "the limit, however far");
        assert!(forces[5].abs() < 1e-9 && forces[6] == -2.0, "let go, then the other way: {forces:?}");
    }

    #[test]
    fn force_and_place_stay_when_the_step_changes() {
        let mut friction = Friction::default();
        let mut x = [Vec3::zeros()];
        friction.begin(&x, 1e-5, 1.0);
        friction.add(on_the_ground(2.0));
        x[0].z = 0.3e-5;
        let before = friction.force(&friction.sliders[0], &x);
        friction.accept(&x);
        friction.begin(&x, 7e-4, 1.0);
        friction.add(on_the_ground(2.0));
        assert!((friction.force(&friction.sliders[0], &x) - before).norm() < 1e-12);
    }

    #[test]
    fn the_gradient_matches_differences_and_the_secant_lies_nowhere_below() {
        let mut friction = Friction::default();
        let mut x = [Vec3::zeros()];
        friction.begin(&x, 1e-3, 1.0);
        friction.add(on_the_ground(3.0));
        x[0] = Vec3::new(2e-4, 0.0, -3e-4);
        friction.accept(&x);
        friction.begin(&x, 1e-3, 1.0);
        friction.add(on_the_ground(3.0));
        for way in [Vec3::new(1e-4, 2e-4, 3e-4), Vec3::new(2e-3, 0.0, 1e-3)] {
            let here = [x[0] + way];
            let e = 1e-8;
            let force = friction.force(&friction.sliders[0], &here);
            let block = friction.block(&friction.sliders[0], &here);
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
    fn what_sticks_bears_more_until_it_slides() {
        let mut friction = Friction::default();
        let mut x = [Vec3::zeros()];
        let mut force_after = |way: f64, friction: &mut Friction| {
            friction.begin(&x, 1e-5, 1.5);
            friction.add(on_the_ground(2.0));
            x[0].x += way;
            let force = friction.force(&friction.sliders[0], &x).x;
            friction.accept(&x);
            force
        };
        assert!((force_after(0.1e-5, &mut friction) - 2.0 * (0.2 - 0.01)).abs() < 1e-12);
        assert_eq!(force_after(1e-4, &mut friction), 3.0, "torn loose at the static limit");
        assert_eq!(force_after(1e-4, &mut friction), 2.0, "sliding");
    }
}
