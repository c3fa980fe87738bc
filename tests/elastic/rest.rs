//! Equilibria from near or far starts.

use crate::sheet::SheetModels;
use crease_chart::TestSheet;
use crease_geometry::math::Vec3;
use crease_model::garment::RestState;
use crease_solver::contact::Contact;
use crease_solver::energy::{Bending, Energy, Gravity, Membrane};
use crease_solver::sim::{Inertia, NewtonOptions, NewtonReport, Problem, Workspace};

/// Returns the gradient of all `terms`, one per point [N].
pub fn forces(terms: &[&dyn Energy], x: &[Vec3]) -> Vec<Vec3> {
    let mut gradient = vec![Vec3::zeros(); x.len()];
    terms.iter().for_each(|term| term.add_gradient(x, &mut gradient));
    gradient
}

/// Returns the largest component of the force on a free point [N].
pub fn residual(terms: &[&dyn Energy], x: &[Vec3], fixed: &[bool]) -> f64 {
    let free = forces(terms, x).into_iter().zip(fixed).filter(|(_, fixed)| !**fixed);
    free.map(|(f, _)| f.amax()).fold(0.0, f64::max)
}

/// Minimises the sum of `terms` from `x`, without inertia.
pub fn balance(terms: &[&dyn Energy], x: &mut [Vec3], fixed: &[bool], newton: NewtonOptions) -> NewtonReport {
    let problem = Problem { inertia: None, terms, fixed, predicted_positions: None };
    problem.solve(x, &mut Contact::none(x.len()), &newton, &mut Workspace::default())
}

/// A sheet that hangs, bends or buckles.
pub struct Scene {
    pub membrane: Membrane,
    pub bending: Bending,
    pub memory: RestState,
    pub mass: Vec<f64>,
    pub gravity: Vec3,
    pub fixed: Vec<bool>,
}

impl Scene {
    /// `sheet` of `density` [kg/m²], `stretch` [N/m] along warp and weft (half of it in shear) and `rigidity` [N·m],
    /// half clamped at its `fixed` points.
    pub fn clamped(sheet: &TestSheet, density: f64, stretch: f64, rigidity: f64, fixed: Vec<bool>) -> Self {
        Self {
            membrane: sheet.membrane([stretch, stretch, 0.5 * stretch]),
            bending: sheet.bending(rigidity),
            memory: sheet.half_clamped(&fixed),
            mass: sheet.mass(density),
            gravity: Vec3::zeros(),
            fixed,
        }
    }

    /// Calls `with` with the energies around `x`.
    pub fn terms<R>(&self, x: &[Vec3], with: impl FnOnce(&[&dyn Energy]) -> R) -> R {
        let last = self.bending.angles(x, &[]);
        let membrane = self.membrane.term(&self.memory, &[], f64::INFINITY);
        let bending = self.bending.term(&self.memory, &last, f64::INFINITY);
        let gravity = Gravity { mass: &self.mass, acceleration: self.gravity };
        with(&[&membrane, &bending, &gravity])
    }

    /// Finds the equilibrium from `x` by proximal steps (inertia without velocity) whose pseudo time doubles, then by
    /// plain Newton to `tolerance` [m]. A bent sheet is far from its flat start for a stiff membrane, where plain
    /// Newton is slow.
    pub fn settle(&self, x: &mut [Vec3], pseudo_time: f64, tolerance: f64) -> NewtonReport {
        let mut total = NewtonReport::default();
        let mut work = Workspace::default();
        let mut contact = Contact::none(x.len());
        let mut pseudo_dt = pseudo_time;
        for _ in 0..24 {
            let start = x.to_vec();
            let newton = NewtonOptions {
                displacement_tol: 1e3 * tolerance,
                decrement_tol: 0.0,
                rel_decrement_tol: 0.0,
                max_iterations: 3,
            };
            let report = self.terms(&start, |terms| {
                let inertia = Some(Inertia { mass: &self.mass, inertial: &start, effective_dt: pseudo_dt });
                let problem = Problem { inertia, terms, fixed: &self.fixed, predicted_positions: None };
                problem.solve(x, &mut contact, &newton, &mut work)
            });
            total.add(&report);
            pseudo_dt *= 2.0;
        }
        let newton = NewtonOptions {
            displacement_tol: tolerance,
            decrement_tol: 0.0,
            rel_decrement_tol: 0.0,
            max_iterations: 200,
        };
        let start = x.to_vec();
        total.add(&self.terms(&start, |terms| balance(terms, x, &self.fixed, newton)));
        total
    }

    /// Returns the largest force on a free point over the weight [-].
    pub fn residual_over_weight(&self, x: &[Vec3]) -> f64 {
        let weight = self.mass.iter().sum::<f64>() * self.gravity.norm();
        self.terms(x, |terms| residual(terms, x, &self.fixed)) / weight
    }
}
