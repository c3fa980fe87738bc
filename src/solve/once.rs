//! One Newton iteration and no more, for the methods that make one (`be1`, `bdf2-1`).
//!
//! The step goes all the way that the linear model says: there is no line search, so that phi may rise, as in Baraff and
//! Witkin 1998. Layers still never cross: the way is cut where they are near, and cut for all points alike should the place
//! it leads to not be allowed. Nothing is asked to converge.

use super::{NewtonReport, Problem, Workspace};
use crate::contact::Contact;
use crate::math::Vec3;
use std::time::Instant;

impl Problem<'_> {
    /// Moves `x` by one Newton step.
    pub(super) fn once(&self, x: &mut [Vec3], contact: &mut Contact, work: &mut Workspace) -> NewtonReport {
        let mut report = NewtonReport::default();
        if self.held.iter().all(|held| *held) {
            return report;
        }
        let clock = Instant::now();
        let g = self.gradient(x, contact);
        report.residual = g.iter().map(|g| g.amax()).fold(0.0, f64::max);
        self.assemble(x, contact, work);
        report.seconds[0] = clock.elapsed().as_secs_f64();
        let clock = Instant::now();
        let Some(d) = self.direction(x, &g, work) else { return report };
        report.seconds[1] = clock.elapsed().as_secs_f64();
        report.iterations = 1;
        report.last_move = d.iter().map(|d| d.norm()).fold(0.0, f64::max);
        report.left = -g.iter().zip(&d).map(|(g, d)| g.dot(d)).sum::<f64>();
        if !report.last_move.is_finite() {
            return report;
        }
        let clock = Instant::now();
        for together in [false, true] {
            let mut way = d.clone();
            if together {
                contact.bound_together(x, &mut way);
            } else {
                contact.bound_motion(x, &mut way);
            }
            let there: Vec<Vec3> = x.iter().zip(&way).map(|(x, d)| x + d).collect();
            // Infinite beyond the ground and where something would cross.
            if contact.value(&there).is_finite() {
                x.copy_from_slice(&there);
                break;
            }
        }
        report.seconds[2] = clock.elapsed().as_secs_f64();
        report
    }
}
