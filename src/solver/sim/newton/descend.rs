//! One descent step along a direction that the caller computes, for solvers other than Newton's method.
//!
//! The result is limited by contact and the line search exactly as a Newton direction: it may be far from the minimum,
//! but it neither passes layers through each other nor increases phi.

use crate::contact::Contact;
use crate::sim::newton::context::SolveContext;
use crate::sim::newton::line_search::Descent;
use crate::sim::newton::problem::Problem;
use crate::sim::newton::report::NewtonReport;
use crate::sim::newton::workspace::Workspace;
use crease_geometry::math::{Vec3, dot};
use crease_linear::BlockMatrix;
use std::time::Instant;

impl Problem<'_> {
    /// Moves `x` along the direction that `direction` returns for the Hessian over the free points and the gradient at
    /// `x` (one per point [N]), as far as contact and the line search allow, after `contact` has begun its step. Adds one
    /// local iteration to `report`.
    ///
    /// Returns the step size [-]; 0 without a direction, or if phi does not decrease along it.
    pub fn descend(
        &self,
        x: &mut [Vec3],
        contact: &mut Contact,
        work: &mut Workspace,
        report: &mut NewtonReport,
        direction: impl FnOnce(&BlockMatrix, &[Vec3]) -> Option<Vec<Vec3>>,
    ) -> f64 {
        let g = self.linearise(x, x, contact, work, report);
        let clock = Instant::now();
        let Some(d) = direction(&work.matrix, &g) else { return 0.0 };
        report.seconds.linear_solve += clock.elapsed().as_secs_f64();
        report.local_iterations += 1;
        report.max_displacement = d.iter().map(|d| d.norm()).fold(0.0, f64::max);
        report.newton_decrement = -dot(&g, &d);
        if !report.max_displacement.is_finite() {
            return 0.0;
        }
        let mut value = self.value(x, contact);
        let descent = Descent { gradient: &g, direction: &d };
        self.line_search(x, descent, &mut value, &mut SolveContext::new(contact, work, report))
    }
}
