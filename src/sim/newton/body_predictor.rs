//! The cloth that a moving body leads: before Newton, the body is brought to where it should be at the end of the step.
//!
//! A body usually moves by more than a contact distance in a step; cloth that stood still would be in its way at once.
//! So the response of the cloth to the motion of the body is solved for first, from the same system that Newton uses:
//!
//! ```text
//! H d = -(dg/db) r        r: what the body has still to go,  H: Hessian at x with inertia
//! ```
//!
//! and both move, point by point as far as all stay apart (`contact::advance`). Where the body does not touch the cloth
//! it simply moves. A few rounds bring it home; what it then still lags is a demand that the cloth does not allow.

use crate::contact::Contact;
use crate::math::Vec3;
use crate::sim::{NewtonReport, Problem, Workspace};

/// Rounds of leading at most.
const ROUNDS: usize = 6;
/// A round that makes up less than this share of the lag is the last.
const PROGRESS: f64 = 0.05;

impl Problem<'_> {
    /// Moves the body of `contact` towards its target and the cloth at `x` along with it. Returns what the work was.
    pub(in crate::sim) fn follow(
        &self,
        x: &mut [Vec3],
        contact: &mut Contact,
        work: &mut Workspace,
    ) -> NewtonReport {
        let mut report = NewtonReport::default();
        let lag = |contact: &Contact| contact.body().map_or(0.0, |body| body.lag().0);
        for _ in 0..ROUNDS {
            if !contact.body_lags() {
                break;
            }
            let before = lag(contact);
            let clock = std::time::Instant::now();
            let mut pull = vec![Vec3::zeros(); x.len()];
            let led = contact.add_pull(x, &mut pull);
            pull.iter_mut().zip(self.held).filter(|(_, held)| **held).for_each(|(g, _)| *g = Vec3::zeros());
            let mut d = vec![Vec3::zeros(); x.len()];
            if led {
                self.assemble(x, x, contact, work);
                report.seconds[0] += clock.elapsed().as_secs_f64();
                let clock = std::time::Instant::now();
                let Some(solved) = self.direction(x, &pull, work) else { break };
                report.iterations += 1;
                report.seconds[1] += clock.elapsed().as_secs_f64();
                if solved.iter().all(|d| d.sum().is_finite()) {
                    d = solved;
                }
            }
            let clock = std::time::Instant::now();
            contact.advance(x, &d);
            report.seconds[2] += clock.elapsed().as_secs_f64();
            if lag(contact) > (1.0 - PROGRESS) * before {
                break;
            }
        }
        report
    }
}
