//! Bending: the face-coupled hinge operator (`docs/adr/0008-face-coupled-bending.md` says why).
//!
//! The three hinge angles of a face make a curvature tensor of that face,
//!
//! ```text
//! S_f = sum_e (theta_e - rest_e) sqrt(s_e) l_e / (2 A_f) t_e t_e^T        t_e: in-plane normal of edge e
//! E_f = 1/2 A_f (B_warp S_uu² + B_weft S_vv² + 2 B_twist S_uv²)            B_twist = sqrt(B_warp B_weft)
//! ```
//!
//! so that the energy is 1/2 (theta - rest)^T Q (theta - rest) with a constant sparse Q: a plate with Poisson ratio 0
//! on one-diagonal and equilateral meshes, where independent hinges bend 20 % too soft and twist up to 3 times too
//! stiff. Hinges missing at a border are eliminated by minimising over their angle (the free border). Rest angle and
//! stiffness ratio s stay per hinge. The Hessian is Gauss-Newton, which is positive by construction. Angles are
//! unwrapped against the last accepted step, so that folds pass 180 degrees without a jump. With intersection-free
//! contact no fold passes 180 degrees; there the principal angle is the right one, however far a hinge snaps within one
//! step ([`Bending::keep_apart`]).

use crate::energy::term::{Energy, sum_of};
use crate::energy::tuning::TUNING;
use crease_geometry::math::{Vec2, Vec3};
use crease_geometry::mesh::{INVALID, Topology, hinge_angle, hinge_gradient, unwrap_angle};
use crease_linear::{BlockSink, add_symmetric};
use crease_model::fabric::Fabric;
use crease_model::garment::{Garment, RestState};
use nalgebra::{Matrix3, Vector3};
use rayon::prelude::*;
use rustc_hash::FxHashMap;
use std::borrow::Cow;

/// Constants of the bending model during a run.
#[derive(Debug, Clone)]
pub struct Bending {
    /// The four points of every hinge.
    points: Vec<[u32; 4]>,
    /// The hinges of every face with at least one, `INVALID` where an edge carries none.
    faces: Vec<[u32; 3]>,
    /// The points of these hinges, `INVALID` after the last.
    stencils: Vec<[u32; MAX_POINTS]>,
    /// The 3 x 3 matrices Q_f over these hinges [N·m]; zero rows where there is none.
    coupling: Vec<Matrix3<f64>>,
    /// (A1 + A2) / l of every hinge [m], the width of cloth that it represents.
    width: Vec<f64>,
    /// Relaxation time of bending damping [s].
    damping: f64,
    /// Triangle of every face.
    triangle: Vec<u32>,
    /// Whether contact keeps layers from passing through each other.
    apart: bool,
}

/// Maximum number of points of the hinges of a face: its corners and one beyond each side.
const MAX_POINTS: usize = 6;

/// Returns the points of `hinges`, each once, `INVALID` after the last. `points` are those of every hinge.
fn stencil(hinges: &[u32; 3], points: &[[u32; 4]]) -> [u32; MAX_POINTS] {
    let mut stencil = [INVALID; MAX_POINTS];
    for p in hinges.iter().filter(|h| **h != INVALID).flat_map(|&h| points[h as usize]) {
        if let Some(slot) = stencil.iter_mut().find(|slot| **slot == p || **slot == INVALID) {
            *slot = p;
        }
    }
    stencil
}

impl Bending {
    /// Returns the bending model of `garment` made of `fabric`.
    pub fn new(garment: &Garment, fabric: &Fabric) -> Self {
        Self::from_parts(
            &garment.topology,
            &garment.material,
            [fabric.bend_warp(), fabric.bend_weft()],
            fabric.bend_damping_s,
        )
    }

    /// Returns the bending model over `topology` with material coordinates `material` [m], rigidities (warp, weft)
    /// [N·m] and relaxation time `damping` [s].
    pub fn from_parts(topology: &Topology, material: &[[Vec2; 3]], rigidity: [f64; 2], damping: f64) -> Self {
        let area = |m: &[Vec2; 3]| 0.5 * ((m[1] - m[0]).perp(&(m[2] - m[0]))).abs();
        let mut width = Vec::with_capacity(topology.hinges.len());
        for hinge in &topology.hinges {
            let [a, b] = hinge.triangles.map(|f| f as usize);
            let k = topology.triangle_edges[a].iter().position(|&e| e == hinge.edge).unwrap_or(0);
            let length = (material[a][(k + 1) % 3] - material[a][k]).norm();
            width.push((area(&material[a]) + area(&material[b])) / length);
        }
        let mut faces = Vec::new();
        let mut triangle = Vec::new();
        let mut coupling = Vec::new();
        // S as the vector (S_uu, S_vv, sqrt2 S_uv), scaled so that Q is a plain Gram matrix.
        let scale =
            Vector3::new(rigidity[0].sqrt(), rigidity[1].sqrt(), (rigidity[0] * rigidity[1]).powf(0.25));
        for (f, m) in material.iter().enumerate() {
            let hinges =
                topology.triangle_edges[f].map(|e| topology.edge_hinge[e as usize].unwrap_or(INVALID));
            let area = area(m);
            if hinges == [INVALID; 3] || area <= 0.0 {
                continue;
            }
            let column = |k: usize| {
                let edge = m[(k + 1) % 3] - m[k];
                let t = Vec2::new(-edge.y, edge.x) / edge.norm();
                let s = Vector3::new(t.x * t.x, t.y * t.y, std::f64::consts::SQRT_2 * t.x * t.y);
                s.component_mul(&scale) * (edge.norm() / (2.0 * area))
            };
            let mut columns = Matrix3::from_columns(&[column(0), column(1), column(2)]);
            // A border edge carries no moment: projecting its column out of the others minimises over its angle.
            for k in (0..3).filter(|&k| hinges[k] == INVALID) {
                let free = columns.column(k).into_owned();
                let length = free.norm_squared();
                if length > 1e-24 * scale.norm_squared() {
                    for j in 0..3 {
                        let factor = columns.column(j).dot(&free) / length;
                        let rest = columns.column(j) - free * factor;
                        columns.set_column(j, &rest);
                    }
                }
                columns.set_column(k, &Vector3::zeros());
            }
            faces.push(hinges);
            triangle.push(f as u32);
            coupling.push(columns.transpose() * columns * area);
        }
        let points: Vec<[u32; 4]> = topology.hinges.iter().map(|h| h.points.map(|p| p.0)).collect();
        let stencils = faces.iter().map(|hinges| stencil(hinges, &points)).collect();
        Self { points, faces, stencils, coupling, width, damping, triangle, apart: false }
    }

    /// Multiplies the rigidity of every triangle by its factor of `factors`, one per triangle [-].
    pub fn reinforce(&mut self, factors: &[f64]) {
        for (coupling, f) in self.coupling.iter_mut().zip(&self.triangle) {
            *coupling *= factors[*f as usize];
        }
    }

    /// Returns the model of those faces that contain at least one of `points`, and their hinges in the new order.
    fn restricted_to(&self, points: &[bool]) -> (Self, Vec<u32>) {
        let has = |f: &usize| self.stencil(*f).iter().any(|p| points[*p as usize]);
        let faces: Vec<usize> = (0..self.faces.len()).filter(has).collect();
        let (mut hinges, mut new_index) = (Vec::new(), FxHashMap::default());
        let mut renumber = |h: u32| {
            if h == INVALID {
                return INVALID;
            }
            *new_index.entry(h).or_insert_with(|| {
                hinges.push(h);
                hinges.len() as u32 - 1
            })
        };
        let model = Self {
            faces: faces.iter().map(|&f| self.faces[f].map(&mut renumber)).collect(),
            stencils: faces.iter().map(|&f| self.stencils[f]).collect(),
            coupling: faces.iter().map(|&f| self.coupling[f]).collect(),
            points: hinges.iter().map(|&h| self.points[h as usize]).collect(),
            width: hinges.iter().map(|&h| self.width[h as usize]).collect(),
            triangle: faces.iter().map(|&f| self.triangle[f]).collect(),
            damping: self.damping,
            apart: self.apart,
        };
        (model, hinges)
    }

    /// Returns the points of the hinges of face `f`.
    fn stencil(&self, f: usize) -> &[u32] {
        let points = &self.stencils[f];
        &points[..points.iter().position(|p| *p == INVALID).unwrap_or(points.len())]
    }

    /// (A1 + A2) / l, one per hinge [m].
    pub fn width(&self) -> &[f64] {
        &self.width
    }

    /// Declares that layers never pass through each other from here on: angles stay within 180 degrees.
    pub fn keep_apart(&mut self) {
        self.apart = true;
    }

    /// Returns the angle of every hinge at `x` [rad]; where layers may pass through each other, the one nearest to
    /// `last` (one per hinge, or empty for the principal values).
    pub fn angles(&self, x: &[Vec3], last: &[f64]) -> Vec<f64> {
        if last.is_empty() {
            return self.points.iter().map(|p| hinge_angle(&p.map(|i| x[i as usize]))).collect();
        }
        self.points.iter().zip(last).map(|(p, &last)| self.angle(p, x, last)).collect()
    }

    #[inline]
    fn angle(&self, points: &[u32; 4], x: &[Vec3], last: f64) -> f64 {
        let angle = hinge_angle(&points.map(|i| x[i as usize]));
        if self.apart && last.abs() < TUNING.max_principal_angle { angle } else { unwrap_angle(angle, last) }
    }

    /// Returns the term of one step: rest angles and stiffness from `rest_state`, damping over `step` [s] towards `last`,
    /// the unwrapped angles of the last accepted state. An infinite step turns damping off.
    pub fn term<'a>(&'a self, rest_state: &RestState, last: &'a [f64], step: f64) -> BendingTerm<'a> {
        let ratio = if self.damping > 0.0 { self.damping / step } else { 0.0 };
        let target =
            rest_state.rest_angle.iter().zip(last).map(|(r, l)| (r + ratio * l) / (1.0 + ratio)).collect();
        let root = rest_state.stiffness_ratio.iter().map(|s| (s * (1.0 + ratio)).sqrt()).collect();
        BendingTerm { model: Cow::Borrowed(self), target, root, last: Cow::Borrowed(last) }
    }
}

/// Bending during one step.
pub struct BendingTerm<'a> {
    model: Cow<'a, Bending>,
    /// Target angles of elasticity and damping together, one per hinge [rad].
    target: Vec<f64>,
    /// Square roots of the stiffness factors, one per hinge [-].
    root: Vec<f64>,
    /// Unwrapped angles of the last accepted state, one per hinge [rad].
    last: Cow<'a, [f64]>,
}

impl BendingTerm<'_> {
    /// Returns sqrt(s) (theta - target) of every hinge [rad].
    fn strain(&self, x: &[Vec3]) -> Vec<f64> {
        self.model
            .points
            .par_iter()
            .enumerate()
            .with_min_len(TUNING.min_hinges_per_task)
            .map(|(h, p)| self.root[h] * (self.model.angle(p, x, self.last[h]) - self.target[h]))
            .collect()
    }

    #[inline]
    fn of_face(strain: &[f64], hinges: &[u32; 3]) -> Vector3<f64> {
        Vector3::from(hinges.map(|h| if h == INVALID { 0.0 } else { strain[h as usize] }))
    }

    /// Returns the torque of every hinge, dE/dtheta [N·m].
    pub fn torques(&self, x: &[Vec3]) -> Vec<f64> {
        let strain = self.strain(x);
        let mut torque = vec![0.0; strain.len()];
        for (hinges, q) in self.model.faces.iter().zip(&self.model.coupling) {
            let t = q * Self::of_face(&strain, hinges);
            for k in 0..3 {
                if hinges[k] != INVALID {
                    torque[hinges[k] as usize] += t[k] * self.root[hinges[k] as usize];
                }
            }
        }
        torque
    }
}

impl Energy for BendingTerm<'_> {
    fn name(&self) -> &'static str {
        "bending"
    }

    fn value(&self, x: &[Vec3]) -> f64 {
        let strain = self.strain(x);
        let of = |(f, hinges): (usize, &[u32; 3])| {
            let c = Self::of_face(&strain, hinges);
            c.dot(&(self.model.coupling[f] * c))
        };
        0.5 * sum_of(&self.model.faces, of)
    }

    fn add_gradient(&self, x: &[Vec3], out: &mut [Vec3]) {
        let gradients = self.model.points.par_iter().with_min_len(TUNING.min_hinges_per_task);
        let gradients: Vec<_> = gradients.map(|p| hinge_gradient(&p.map(|i| x[i as usize]))).collect();
        let torques = self.torques(x);
        for ((p, gradient), torque) in self.model.points.iter().zip(&gradients).zip(torques) {
            for (&i, g) in p.iter().zip(gradient.iter().flatten()) {
                out[i as usize] += g * torque;
            }
        }
    }

    fn add_hessian(&self, x: &[Vec3], out: &mut dyn BlockSink) {
        for (f, (hinges, q)) in self.model.faces.iter().zip(&self.model.coupling).enumerate() {
            let points = self.model.stencil(f);
            if !out.is_relevant(points) {
                continue;
            }
            // Derivatives of the three angles by each point, scaled by sqrt(s); zero for a degenerate hinge.
            let mut by_angle = [[Vec3::zeros(); 3]; MAX_POINTS];
            for (k, &h) in hinges.iter().enumerate().filter(|(_, h)| **h != INVALID) {
                let hinge = &self.model.points[h as usize];
                let gradient = hinge_gradient(&hinge.map(|i| x[i as usize])).unwrap_or_default();
                for (p, g) in hinge.iter().zip(&gradient) {
                    let slot = points.iter().position(|known| known == p).unwrap_or_default();
                    by_angle[slot][k] = g * self.root[h as usize];
                }
            }
            for i in 0..points.len() {
                // Column k: sum_l Q_kl g_il
                let weighted: [Vec3; 3] = std::array::from_fn(|k| {
                    by_angle[i][0] * q[(k, 0)] + by_angle[i][1] * q[(k, 1)] + by_angle[i][2] * q[(k, 2)]
                });
                for j in 0..=i {
                    let block = weighted[0] * by_angle[j][0].transpose()
                        + weighted[1] * by_angle[j][1].transpose()
                        + weighted[2] * by_angle[j][2].transpose();
                    add_symmetric(out, points[i], points[j], &block);
                }
            }
        }
    }

    fn add_secant_hessian(&self, _x: &[Vec3], midpoint: &[Vec3], out: &mut dyn BlockSink) {
        self.add_hessian(midpoint, out);
    }

    fn visit_stencils(&self, visit: &mut dyn FnMut(&[u32])) {
        (0..self.model.faces.len()).for_each(|f| visit(self.model.stencil(f)));
    }

    fn restricted_to(&self, points: &[bool]) -> Option<Box<dyn Energy + '_>> {
        let (model, hinges) = self.model.restricted_to(points);
        let of = |field: &[f64]| hinges.iter().map(|&h| field[h as usize]).collect::<Vec<f64>>();
        Some(Box::new(BendingTerm {
            target: of(&self.target),
            root: of(&self.root),
            last: Cow::Owned(of(&self.last)),
            model: Cow::Owned(model),
        }))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::energy::energy_checks::{
        check_gradient_and_hessian, check_restriction, check_rigid_motion, check_secant_of_a_rotation,
        dense_hessian,
    };
    use crease_geometry::mesh::PointIndex;

    /// A fan of five triangles around point 0: interior and border faces.
    fn fan() -> (Topology, Vec<[Vec2; 3]>, Vec<Vec2>) {
        let flat: Vec<Vec2> = std::iter::once(Vec2::zeros())
            .chain((0..5).map(|k| {
                let a = f64::from(k) * std::f64::consts::TAU / 5.0;
                Vec2::new(a.cos(), a.sin()) * (0.01 + 0.001 * f64::from(k))
            }))
            .collect();
        let triangles: Vec<[u32; 3]> = (0..5).map(|k| [0, 1 + k, 1 + (k + 1) % 5]).collect();
        let topology = Topology::new(6, &triangles.iter().map(|t| t.map(PointIndex)).collect::<Vec<_>>());
        let material = triangles.iter().map(|t| t.map(|i| flat[i as usize])).collect();
        (topology, material, flat)
    }

    /// A hinge snaps from 120 to -120 degrees within a step: through zero where layers cannot pass, through 180 degrees
    /// where they can.
    #[test]
    fn a_hinge_that_snaps_stays_within_half_a_turn_where_layers_are_kept_apart() {
        let triangles = [[0, 1, 2], [1, 0, 3]].map(|t| t.map(PointIndex));
        let flat = [[0.0, 0.0], [1.0, 0.0], [0.5, 1.0], [0.5, -1.0]].map(Vec2::from);
        let material = triangles.map(|t| t.map(|p| flat[p.at()]));
        let at = |degrees: f64| {
            let (sin, cos) = degrees.to_radians().sin_cos();
            [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.5, 1.0, 0.0], [0.5, -cos, sin]].map(Vec3::from)
        };
        let mut bending = Bending::from_parts(&Topology::new(4, &triangles), &material, [1e-5; 2], 0.0);
        let turned = |bending: &Bending, from: f64, to: f64| {
            let last = bending.angles(&at(from), &[]);
            bending.angles(&at(to), &last)[0].to_degrees() * last[0].signum() * from.signum()
        };
        assert!((turned(&bending, 120.0, -120.0) - 240.0).abs() < 1e-9);
        bending.keep_apart();
        assert!((turned(&bending, 120.0, -120.0) + 120.0).abs() < 1e-9);
        assert!(
            (turned(&bending, 179.9, -179.9) - 180.1).abs() < 1e-9,
            "triangles that overlap from the start"
        );
        // The energy term uses the same angles.
        let (last, rest_state) = (bending.angles(&at(120.0), &[]), RestState::flat(1, 2));
        let [there, back] =
            [-120.0, 120.0].map(|to| bending.term(&rest_state, &last, f64::INFINITY).value(&at(to)));
        assert!((there - back).abs() < 1e-12 * back, "{there} {back}");
    }

    #[test]
    fn gradient_and_hessian_match() {
        let (topology, material, flat) = fan();
        let bending = Bending::from_parts(&topology, &material, [1e-5, 6e-6], 0.01);
        let mut rest_state = RestState::flat(bending.width().len(), material.len());
        rest_state.rest_angle[1] = 0.4;
        rest_state.stiffness_ratio[2] = 3.0;
        let x: Vec<Vec3> = flat
            .iter()
            .enumerate()
            .map(|(i, p)| Vec3::new(p.x, p.y, 0.003 * (i as f64 * 1.7).sin()))
            .collect();
        let last = bending.angles(&x, &[]);
        let term = bending.term(&rest_state, &last, 0.01);
        check_gradient_and_hessian(&term, &x, 1e-8);
        check_rigid_motion(&term, &x);
        check_secant_of_a_rotation(&term, &x);
        check_restriction(&term, &x, &[false, true, false, false, false, false], 1e-4);
    }

    #[test]
    fn at_rest_the_gauss_newton_hessian_is_the_true_one() {
        let (topology, material, flat) = fan();
        let bending = Bending::from_parts(&topology, &material, [1e-5, 1e-5], 0.0);
        let rest_state = RestState::flat(bending.width().len(), material.len());
        let x: Vec<Vec3> = flat.iter().map(|p| Vec3::new(p.x, p.y, 0.0)).collect();
        let last = bending.angles(&x, &[]);
        let term = bending.term(&rest_state, &last, f64::INFINITY);
        let h = dense_hessian(&term, &x);
        let eps = 1e-7;
        let (mut up, mut down) = (x.clone(), x.clone());
        up[0].z += eps;
        down[0].z -= eps;
        let (mut gu, mut gd) = (vec![Vec3::zeros(); 6], vec![Vec3::zeros(); 6]);
        term.add_gradient(&up, &mut gu);
        term.add_gradient(&down, &mut gd);
        for i in 0..6 {
            let difference = (gu[i].z - gd[i].z) / (2.0 * eps);
            assert!((difference - h[(3 * i + 2, 2)]).abs() < 1e-5 * h.amax());
        }
    }
}
