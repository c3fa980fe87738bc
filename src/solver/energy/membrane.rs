//! Stretch and shear of triangles: Baraff and Witkin 1998, with area-normalised energies.
//!
//! Per triangle of rest area `a` with material axes u (warp) and v (weft), deformation gradient columns w_u, w_v:
//!
//! ```text
//! E = a/2 [ k_u (|w_u| - r_u)² + k_v (|w_v| - r_v)² + k_s (w_u . w_v)² ]
//! ```
//!
//! with the rest stretches r (1 when new) read from the rest state. Baraff and Witkin scale the *condition* by the area,
//! which makes stiffness depend on the mesh; here the energy is scaled, so that k_u, k_v, k_s are in N/m of cloth
//! width. Damping along the constraint (Kim, Oh and Wohn, eq. 4) is a spring to the last accepted value C_n with
//! stiffness k * damping/step; both springs together are one with a shifted target, computed once per step. The
//! geometric stiffness of a compressed axis is left out of the Hessian (it would be negative).

use crate::energy::term::{Energy, sum_of};
use crate::energy::tuning::TUNING;
use crease_geometry::math::{Mat3, PlaneStretch, Vec2, Vec3};
use crease_linear::{BlockSink, add_symmetric};
use crease_model::fabric::Fabric;
use crease_model::garment::{Garment, RestState};
use std::borrow::Cow;

/// Constants of the membrane during a run: one entry per triangle.
#[derive(Debug, Clone)]
pub struct Membrane {
    corners: Vec<[u32; 3]>,
    /// Material derivative of the shape functions [1/m]: w_u = sum x_i b_i.x, w_v = sum x_i b_i.y.
    derivative: Vec<[Vec2; 3]>,
    /// That derivative for the shape in the garment's file [1/m], where the cloth has another rest shape; empty elsewhere.
    source_derivative: Vec<[Vec2; 3]>,
    /// Rest areas [m²].
    area: Vec<f64>,
    /// Rest areas times numbers of layers [m²].
    weight: Vec<f64>,
    /// Stretch stiffness along warp and weft, and shear stiffness [N/m].
    stiffness: [f64; 3],
    /// Relaxation time of stretch damping [s].
    damping: f64,
}

impl Membrane {
    /// Returns the membrane of `garment` made of `fabric`.
    pub fn new(garment: &Garment, fabric: &Fabric) -> Self {
        Self::from_parts(
            &garment.triangles.iter().map(|t| t.map(|p| p.0)).collect::<Vec<_>>(),
            &garment.material,
            [fabric.stretch_warp(), fabric.stretch_weft(), fabric.shear()],
            fabric.stretch_damping_s,
        )
    }

    /// Returns the membrane of triangles `corners` with material coordinates `material` [m], `stiffness` (warp, weft,
    /// shear) [N/m] and relaxation time `damping` [s].
    pub fn from_parts(
        corners: &[[u32; 3]],
        material: &[[Vec2; 3]],
        stiffness: [f64; 3],
        damping: f64,
    ) -> Self {
        let mut derivative = Vec::with_capacity(corners.len());
        let mut area = Vec::with_capacity(corners.len());
        for m in material {
            let (d1, d2) = (m[1] - m[0], m[2] - m[0]);
            let twice = d1.x * d2.y - d1.y * d2.x;
            let longest = d1.norm_squared().max(d2.norm_squared()).max((m[2] - m[1]).norm_squared());
            let min_twice = TUNING.min_altitude_ratio * longest;
            let divisor = if twice.abs() < min_twice { min_twice.copysign(twice) } else { twice };
            let b1 = Vec2::new(d2.y, -d2.x) / divisor;
            let b2 = Vec2::new(-d1.y, d1.x) / divisor;
            derivative.push([-b1 - b2, b1, b2]);
            area.push(0.5 * twice.abs());
        }
        let weight = area.clone();
        Self {
            corners: corners.to_vec(),
            derivative,
            source_derivative: Vec::new(),
            area,
            weight,
            stiffness,
            damping,
        }
    }

    /// Returns the membrane of triangles `faces` only.
    fn subset(&self, faces: &[usize]) -> Self {
        Self {
            corners: faces.iter().map(|&f| self.corners[f]).collect(),
            derivative: faces.iter().map(|&f| self.derivative[f]).collect(),
            source_derivative: Vec::new(),
            area: faces.iter().map(|&f| self.area[f]).collect(),
            weight: faces.iter().map(|&f| self.weight[f]).collect(),
            ..*self
        }
    }

    /// Rest areas, one per triangle [m²].
    pub fn area(&self) -> &[f64] {
        &self.area
    }

    /// Returns the stretch of every triangle from its shape in the garment's file to that at `x` [m], with principal strains of at most
    /// `max_strain` [-].
    pub fn stretches_to(&self, x: &[Vec3], max_strain: f64) -> Vec<PlaneStretch> {
        let of_source =
            if self.source_derivative.is_empty() { &self.derivative } else { &self.source_derivative };
        let stretch = |(corners, derivative)| {
            let (u, v) = axes_of(corners, derivative, x);
            PlaneStretch::of_axes(&u, &v, max_strain)
        };
        self.corners.iter().zip(of_source).map(stretch).collect()
    }

    /// Gives every triangle the rest shape that it has in the garment's file after its stretch, one per triangle; with none, that of
    /// the file. Masses and areas stay.
    pub fn set_rest_stretches(&mut self, stretches: &[PlaneStretch]) {
        if !self.source_derivative.is_empty() {
            self.derivative = std::mem::take(&mut self.source_derivative);
        }
        if !stretches.is_empty() {
            self.source_derivative.clone_from(&self.derivative);
            for (derivative, stretch) in self.derivative.iter_mut().zip(stretches) {
                *derivative = derivative.map(|b| stretch.unstretched(b));
            }
        }
    }

    /// Replaces the stretch and shear stiffness [N/m].
    pub fn set_stiffness(&mut self, stiffness: [f64; 3]) {
        self.stiffness = stiffness;
    }

    /// Multiplies the stiffness of every triangle by its factor of `layers`, one per triangle [-].
    pub fn reinforce(&mut self, layers: &[f64]) {
        self.weight = self.area.iter().zip(layers).map(|(area, layers)| area * layers).collect();
    }

    /// Lowers all stiffnesses by one factor so that none is above `limit` [N/m].
    pub fn limit_stiffness(&mut self, limit: f64) {
        let largest = self.stiffness.iter().copied().fold(0.0, f64::max);
        if largest > limit {
            self.stiffness.iter_mut().for_each(|k| *k *= limit / largest);
        }
    }

    /// Returns the centroid of triangle `f` at `x` [m].
    pub fn centre(&self, f: usize, x: &[Vec3]) -> Vec3 {
        self.corners[f].iter().map(|&p| x[p as usize]).sum::<Vec3>() / 3.0
    }

    /// Returns w_u and w_v of triangle `f` at `x` [-].
    #[inline]
    fn axes(&self, f: usize, x: &[Vec3]) -> (Vec3, Vec3) {
        axes_of(&self.corners[f], &self.derivative[f], x)
    }

    /// Returns |w_u|, |w_v| and w_u.w_v of every triangle [-].
    pub fn measure(&self, x: &[Vec3]) -> Vec<[f64; 3]> {
        (0..self.corners.len())
            .map(|f| {
                let (u, v) = self.axes(f, x);
                [u.norm(), v.norm(), u.dot(&v)]
            })
            .collect()
    }

    /// Returns the term of one step: rest stretches from `rest_state`, damping over `step` [s] towards `last`
    /// ([`Self::measure`] at the last accepted state). An infinite step turns damping off.
    pub fn term(&self, rest_state: &RestState, last: &[[f64; 3]], step: f64) -> MembraneTerm<'_> {
        let ratio = if self.damping > 0.0 { self.damping / step } else { 0.0 };
        let rest = rest_state.rest_stretch_warp.iter().zip(&rest_state.rest_stretch_weft);
        let target = rest
            .enumerate()
            .map(|(f, (&u, &v))| {
                let rest = [u, v, 0.0];
                match last.get(f) {
                    Some(c) if ratio > 0.0 => {
                        std::array::from_fn(|k| (rest[k] + ratio * c[k]) / (1.0 + ratio))
                    }
                    _ => rest,
                }
            })
            .collect();
        MembraneTerm { model: Cow::Borrowed(self), target, factor: 1.0 + ratio }
    }
}

/// Returns w_u and w_v of a triangle with these corners and this material derivative [1/m] at `x` [m].
#[inline]
fn axes_of([i, j, k]: &[u32; 3], b: &[Vec2; 3], x: &[Vec3]) -> (Vec3, Vec3) {
    let (p, q, r) = (&x[*i as usize], &x[*j as usize], &x[*k as usize]);
    (p * b[0].x + q * b[1].x + r * b[2].x, p * b[0].y + q * b[1].y + r * b[2].y)
}

/// Stretch and shear during one step.
pub struct MembraneTerm<'a> {
    model: Cow<'a, Membrane>,
    /// Targets of |w_u|, |w_v| and w_u.w_v, one per triangle [-].
    target: Vec<[f64; 3]>,
    /// Stiffness factor of elasticity and damping together [-].
    factor: f64,
}

impl Energy for MembraneTerm<'_> {
    fn name(&self) -> &'static str {
        "membrane"
    }

    fn value(&self, x: &[Vec3]) -> f64 {
        let [ku, kv, ks] = self.model.stiffness;
        let of = |(f, t): (usize, &[f64; 3])| {
            let (u, v) = self.model.axes(f, x);
            let (cu, cv, cs) = (u.norm() - t[0], v.norm() - t[1], u.dot(&v) - t[2]);
            self.model.weight[f] * (ku * cu * cu + kv * cv * cv + ks * cs * cs)
        };
        0.5 * self.factor * sum_of(&self.target, of)
    }

    fn add_gradient(&self, x: &[Vec3], out: &mut [Vec3]) {
        let [ku, kv, ks] = self.model.stiffness;
        for (f, t) in self.target.iter().enumerate() {
            let (u, v) = self.model.axes(f, x);
            let (lu, lv) = (u.norm(), v.norm());
            let scale = self.factor * self.model.weight[f];
            let shear = ks * (u.dot(&v) - t[2]);
            let by_u = (u * (ku * (lu - t[0]) / lu.max(1e-12)) + v * shear) * scale;
            let by_v = (v * (kv * (lv - t[1]) / lv.max(1e-12)) + u * shear) * scale;
            for (&i, b) in self.model.corners[f].iter().zip(&self.model.derivative[f]) {
                out[i as usize] += by_u * b.x + by_v * b.y;
            }
        }
    }

    fn add_hessian(&self, x: &[Vec3], out: &mut dyn BlockSink) {
        self.add_secant_hessian(x, x, out);
    }

    /// Axes are those at the midpoint: |w'|² - |w|² is (w' + w) . (w' - w) for any angle between the two. Tensions are
    /// those at the beginning, because the midpoint of the chord of a rotation is shorter than both of its ends.
    fn add_secant_hessian(&self, x: &[Vec3], midpoint: &[Vec3], out: &mut dyn BlockSink) {
        let [ku, kv, ks] = self.model.stiffness;
        for (f, t) in self.target.iter().enumerate() {
            if !out.is_relevant(&self.model.corners[f]) {
                continue;
            }
            let (from_u, from_v) = self.model.axes(f, x);
            let (u, v) = self.model.axes(f, midpoint);
            let scale = self.factor * self.model.weight[f];
            let shear = from_u.dot(&from_v) - t[2];
            // The positive half of the indefinite part shear * [[0, I], [I, 0]].
            let positive = 0.5 * ks * shear.abs();
            let axis = |from: &Vec3, w: &Vec3, k: f64, rest: f64| {
                let length = w.norm().max(1e-12);
                let along = w * w.transpose() / (length * length);
                let across = (1.0 - rest / from.norm().max(1e-12)).max(0.0);
                (along + (Mat3::identity() - along) * across) * k
            };
            let uu =
                (axis(&from_u, &u, ku, t[0]) + v * v.transpose() * ks + Mat3::identity() * positive) * scale;
            let vv =
                (axis(&from_v, &v, kv, t[1]) + u * u.transpose() * ks + Mat3::identity() * positive) * scale;
            let uv = (v * u.transpose() * ks + Mat3::identity() * (positive * shear.signum())) * scale;
            let (corner, b) = (&self.model.corners[f], &self.model.derivative[f]);
            let vu = uv.transpose();
            for i in 0..3 {
                for j in 0..=i {
                    let block = uu * (b[i].x * b[j].x)
                        + vv * (b[i].y * b[j].y)
                        + uv * (b[i].x * b[j].y)
                        + vu * (b[i].y * b[j].x);
                    add_symmetric(out, corner[i], corner[j], &block);
                }
            }
        }
    }

    fn visit_stencils(&self, visit: &mut dyn FnMut(&[u32])) {
        self.model.corners.iter().for_each(|t| visit(t));
    }

    fn restricted_to(&self, points: &[bool]) -> Option<Box<dyn Energy + '_>> {
        let has = |t: &[u32; 3]| t.iter().any(|p| points[*p as usize]);
        let faces: Vec<usize> =
            self.model.corners.iter().enumerate().filter(|(_, t)| has(t)).map(|(f, _)| f).collect();
        Some(Box::new(MembraneTerm {
            target: faces.iter().map(|&f| self.target[f]).collect(),
            model: Cow::Owned(self.model.subset(&faces)),
            factor: self.factor,
        }))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::energy::energy_checks::{
        check_gradient_and_hessian, check_restriction, check_rigid_motion, check_secant_of_a_rotation,
    };

    fn pair() -> (Membrane, RestState) {
        let flat = [Vec2::new(0.0, 0.0), Vec2::new(0.1, 0.0), Vec2::new(0.03, 0.08), Vec2::new(0.06, -0.05)];
        let corners = [[0u32, 1, 2], [1, 0, 3]];
        let material: Vec<[Vec2; 3]> = corners.iter().map(|t| t.map(|i| flat[i as usize])).collect();
        let membrane = Membrane::from_parts(&corners, &material, [1000.0, 800.0, 40.0], 0.02);
        let mut rest_state = RestState::flat(0, 2);
        rest_state.rest_stretch_warp[0] = 1.03;
        (membrane, rest_state)
    }

    fn posed() -> Vec<Vec3> {
        vec![
            Vec3::new(0.001, -0.002, 0.003),
            Vec3::new(0.103, 0.004, -0.002),
            Vec3::new(0.031, 0.079, 0.012),
            Vec3::new(0.058, -0.056, 0.02),
        ]
    }

    #[test]
    fn gradient_and_hessian_match_with_and_without_damping() {
        let (membrane, rest_state) = pair();
        let last = vec![[0.98, 1.01, 0.02]; 2];
        for term in [membrane.term(&rest_state, &[], 0.01), membrane.term(&rest_state, &last, 0.01)] {
            check_gradient_and_hessian(&term, &posed(), 1e-7);
            check_rigid_motion(&term, &posed());
            check_restriction(&term, &posed(), &[false, false, false, true], 1e-3);
        }
    }

    #[test]
    fn a_rotation_costs_nothing_by_the_secant() {
        let (membrane, _) = pair();
        let flat = [(0.0, 0.0), (0.1, 0.0), (0.03, 0.08), (0.06, -0.05)].map(|(u, v)| Vec3::new(u, v, 0.0));
        check_secant_of_a_rotation(&membrane.term(&RestState::flat(0, 2), &[], 0.01), &flat);
    }

    #[test]
    fn cloth_rests_in_the_shape_it_was_given_and_forgets_it() {
        let (mut membrane, _) = pair();
        let energy = |membrane: &Membrane, x: &[Vec3]| {
            membrane.term(&RestState::flat(0, 2), &[], f64::INFINITY).value(x)
        };
        let flat: Vec<Vec3> = [(0.0, 0.0), (0.1, 0.0), (0.03, 0.08), (0.06, -0.05)]
            .map(|(u, v)| Vec3::new(1.1 * u + 0.05 * v, v, 0.0))
            .into();
        let before = energy(&membrane, &flat);
        membrane.set_rest_stretches(&membrane.stretches_to(&flat, 0.2));
        assert!(before > 1e-3 && energy(&membrane, &flat) < 1e-20);
        // Stretches are always from the shape in the file.
        let again = membrane.stretches_to(&flat, 0.2);
        membrane.set_rest_stretches(&again);
        assert!(energy(&membrane, &flat) < 1e-20);
        membrane.set_rest_stretches(&membrane.stretches_to(&flat, 0.02));
        assert!(energy(&membrane, &flat) > 0.1 * before, "no more than that strain is taken on");
        membrane.set_rest_stretches(&[]);
        assert_eq!(energy(&membrane, &flat), before);
    }

    #[test]
    fn warp_is_u_and_weft_is_v() {
        // Swapping the axes still drapes and merely rotates the cloth by 90 degrees, so that only exact values show it.
        let (membrane, _) = pair();
        let rest_state = RestState::flat(0, 2);
        let stretch = |sx: f64, sy: f64| {
            let x: Vec<Vec3> = [(0.0, 0.0), (0.1, 0.0), (0.03, 0.08), (0.06, -0.05)]
                .map(|(u, v)| Vec3::new(u * sx, v * sy, 0.0))
                .into();
            membrane.term(&rest_state, &[], f64::INFINITY).value(&x)
        };
        let area = 0.1 * 0.13 / 2.0;
        assert!((stretch(1.01, 1.0) - 0.5 * area * 1000.0 * 1e-4).abs() < 1e-12);
        assert!((stretch(1.0, 1.01) - 0.5 * area * 800.0 * 1e-4).abs() < 1e-12);
    }
}
