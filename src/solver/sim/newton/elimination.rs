//! Line search with nonlinear elimination of the points that limit the step.
//!
//! One spot where layers touch limits the step of a direction that is right everywhere else: a line search would cut
//! the step of all points to a half or a hundredth for it, again and again. Instead, the full step is taken, the spot
//! is solved for by a local Newton method with everything else fixed, and the result is accepted if phi has decreased
//! sufficiently (Lanzkron, Rose, Wilkes 1996; Cai, Li 2011).

use crate::sim::newton::context::SolveContext;
use crate::sim::newton::line_search::{Descent, SearchPath, Trial, axpy, collision_free_displacement};
use crate::sim::newton::local_solve::LocalSolveLimits;
use crate::sim::newton::problem::{Potential, Problem};
use crate::sim::newton::tuning::TUNING;
use crease_geometry::math::Vec3;
use std::time::Instant;

impl Problem<'_> {
    /// Moves `x` along a global direction as far as contact and phi allow, after eliminating the points that limit the
    /// step, and returns the step size [-]. The workspace holds the system at `x`; local solves stop at `energy_tol`
    /// [J].
    pub(super) fn line_search_eliminating(
        &self,
        x: &mut [Vec3],
        descent: Descent,
        value: &mut Potential,
        energy_tol: f64,
        context: &mut SolveContext,
    ) -> f64 {
        let tuning = &TUNING.line_search;
        let displacement = collision_free_displacement(x, descent, false, context.contact, context.report);
        let slope = SearchPath::slope(descent.gradient, &displacement);
        let path = SearchPath { displacement: &displacement, slope };
        let mut step = 1.0;
        while slope <= 0.0 && step >= tuning.min_step_to_eliminate {
            let clock = Instant::now();
            let mut trial_x = axpy(x, &displacement, step);
            let trial_value = self.value(&trial_x, context.contact);
            let trial = Trial { step, positions: &trial_x, value: trial_value };
            let decreases = self.is_sufficient_decrease(trial, value, path, context.contact);
            let g =
                (!decreases && trial_value.sum.is_finite()).then(|| self.gradient(&trial_x, context.contact));
            context.report.seconds.assembly += clock.elapsed().as_secs_f64();
            if decreases {
                x.copy_from_slice(&trial_x);
                *value = trial_value;
                return step;
            }
            let iterations_before = context.report.local_iterations;
            if let Some(g) = g {
                // The figures of the global iteration stay as they are.
                let (decrement, displacement) =
                    (context.report.newton_decrement, context.report.max_displacement);
                let limits = LocalSolveLimits {
                    // No more precise than the predicted decrease is worth.
                    energy_tol: energy_tol.max(step * -slope),
                    diffuse_energy_tol: 0.0,
                    max_fraction: tuning.max_eliminated_fraction,
                };
                self.solve_locally(&mut trial_x, &g, limits, context);
                (context.report.newton_decrement, context.report.max_displacement) =
                    (decrement, displacement);
            }
            if context.report.local_iterations > iterations_before {
                let clock = Instant::now();
                let eliminated = self.value(&trial_x, context.contact);
                context.report.seconds.assembly += clock.elapsed().as_secs_f64();
                if eliminated.sum <= value.sum + tuning.armijo_after_elimination * step * slope {
                    x.copy_from_slice(&trial_x);
                    *value = eliminated;
                    return step;
                }
                // The local solve has left the contact search with the pairs of its own displacements.
                collision_free_displacement(x, descent, false, context.contact, context.report);
            }
            step *= 0.5;
        }
        self.line_search_along(x, descent, displacement, step, value, context)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::contact::Contact;
    use crate::energy::Energy;
    use crate::sim::newton::report::NewtonReport;
    use crate::sim::newton::workspace::Workspace;
    use crease_geometry::math::Mat3;
    use crease_linear::{BlockSink, add_symmetric};

    const COUNT: usize = 60;
    /// Target height of all points, and height of a wall that stops one of them [m].
    const AIM: f64 = 0.01;
    const WALL: f64 = 0.002;

    /// A chain whose points are pulled upwards, one of them against a wall that the Hessian contains only once it is
    /// touched.
    struct Chain;

    impl Chain {
        /// Returns how far the point in the middle is inside the wall [m].
        fn depth(x: &[Vec3]) -> f64 {
            (x[COUNT / 2].y - WALL).max(0.0)
        }
    }

    impl Energy for Chain {
        fn name(&self) -> &'static str {
            "chain"
        }

        fn value(&self, x: &[Vec3]) -> f64 {
            let pull: f64 = x.iter().map(|x| 0.5 * (x.y - AIM).powi(2)).sum();
            let springs: f64 = x.windows(2).map(|x| 0.5 * (x[1] - x[0]).norm_squared()).sum();
            pull + springs + 500.0 * Self::depth(x).powi(2)
        }

        fn add_gradient(&self, x: &[Vec3], out: &mut [Vec3]) {
            for (out, x) in out.iter_mut().zip(x) {
                out.y += x.y - AIM;
            }
            for k in 1..COUNT {
                let pull = x[k] - x[k - 1];
                out[k] += pull;
                out[k - 1] -= pull;
            }
            out[COUNT / 2].y += 1000.0 * Self::depth(x);
        }

        fn add_hessian(&self, x: &[Vec3], out: &mut dyn BlockSink) {
            let upwards = Mat3::from_diagonal(&Vec3::y());
            for p in 0..COUNT as u32 {
                add_symmetric(out, p, p, &upwards);
            }
            for p in 1..COUNT as u32 {
                add_symmetric(out, p, p, &Mat3::identity());
                add_symmetric(out, p - 1, p - 1, &Mat3::identity());
                add_symmetric(out, p, p - 1, &-Mat3::identity());
            }
            if Self::depth(x) > 0.0 {
                let p = COUNT as u32 / 2;
                add_symmetric(out, p, p, &(upwards * 1000.0));
            }
        }

        fn visit_stencils(&self, visit: &mut dyn FnMut(&[u32])) {
            (1..COUNT as u32).for_each(|p| visit(&[p - 1, p]));
        }
    }

    /// Makes the Hessian positive where the chain leaves it singular.
    struct HessianShift;

    impl Energy for HessianShift {
        fn name(&self) -> &'static str {
            "hessian shift"
        }

        fn value(&self, _x: &[Vec3]) -> f64 {
            0.0
        }

        fn add_gradient(&self, _x: &[Vec3], _out: &mut [Vec3]) {}

        fn add_hessian(&self, _x: &[Vec3], out: &mut dyn BlockSink) {
            (0..COUNT as u32).for_each(|p| out.add(p, p, &(Mat3::identity() * 1e-6)));
        }
    }

    /// One point at a wall limits the step of all to a quarter; once it is eliminated all others take the full step.
    #[test]
    fn a_point_that_limits_the_step_is_eliminated() {
        let fixed = vec![false; COUNT];
        let terms: [&dyn Energy; 2] = [&Chain, &HessianShift];
        let problem = Problem { inertia: None, terms: &terms, fixed: &fixed, predicted_positions: None };
        let mut contact = Contact::none(COUNT);
        let (mut work, mut report) = (Workspace::default(), NewtonReport::default());
        let start = vec![Vec3::zeros(); COUNT];
        let g = problem.linearise(&start, &start, &contact, &mut work, &mut report);
        let d = problem.direction(&start, &g, &mut work).expect("positive");
        let at_start = problem.value(&start, &contact);
        let descent = Descent { gradient: &g, direction: &d };
        let mut context = SolveContext::new(&mut contact, &mut work, &mut report);

        let (mut x, mut value) = (start.clone(), at_start);
        assert_eq!(problem.line_search(&mut x, descent, &mut value, &mut context), 0.25);
        let limited = value.sum;

        let (mut x, mut value) = (start, at_start);
        let step = problem.line_search_eliminating(&mut x, descent, &mut value, 1e-9, &mut context);
        assert_eq!(step, 1.0);
        assert!(report.local_iterations > 0);
        assert!(value.sum < 0.5 * limited, "{} against {limited}", value.sum);
        assert_eq!(value.sum, problem.value(&x, &contact).sum);
        assert!((x[0].y - AIM).abs() < 1e-6 && Chain::depth(&x) < 1e-4, "{} {}", x[0].y, x[COUNT / 2].y);
    }
}
