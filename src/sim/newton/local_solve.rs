//! Newton for the few places that are not at peace yet, everything else standing still.
//!
//! After a full step of the whole, what is left is local: a contact that came or went, an element that turned over. What a
//! point could gain by itself is g·D⁻¹g with its diagonal block D; points that together could gain next to nothing are left
//! out. For the others, with some rings around them, Newton goes on by itself: with the elements and contacts around them,
//! which costs next to nothing beside a look at the whole. Then the gradient of the whole says whether it is at peace now.

use crate::contact::Contact;
use crate::energy::Energy;
use crate::math::Vec3;
use crate::sim::newton::line_search::LEAST_SHARE;
use crate::sim::newton::{NewtonReport, Problem, Workspace};
use std::time::Instant;

/// Share of the energy that counts as converged which points outside a part may have to gain; a part goes on until it has
/// less, too.
const LEFT_OUT: f64 = 0.5;
/// A point that has more than this share of it is not one of many that have little.
const ALONE: f64 = 0.05;
/// A part reaches this many rings of neighbours beyond its restless points.
const RINGS: usize = 2;
/// A part of more than this share of the free points is not worth while.
pub(super) const FEW: f64 = 0.3;
/// Times that restless points are looked for before the whole is solved again.
const ROUNDS: usize = 4;
/// Room for so many numbers of its factor is kept for the next part: most have less, few a hundred times as many.
const KEPT_NUMBERS: usize = 1 << 20;
/// Iterations of one part.
const ITERATIONS: usize = 8;

/// How far places shall settle.
#[derive(Debug, Clone, Copy)]
pub(super) struct Settling {
    /// What may be left to gain [J].
    pub energy: f64,
    /// The same where it is spread out over more of the garment than that, little at each point [J].
    pub spread: f64,
    /// A part of more than this share of the free points is not worth while.
    pub few: f64,
}

/// What came of it.
pub(super) enum Peace {
    /// Nothing is left to gain that counts.
    Everywhere,
    /// Something has moved, and more is left than single places can do.
    Nearer,
    /// Nothing has moved.
    Nowhere,
}

impl Problem<'_> {
    /// Lets restless places settle, from `x` with gradient `g` and the system as last assembled.
    pub(super) fn settle_places(
        &self,
        x: &mut [Vec3],
        g: &[Vec3],
        contact: &mut Contact,
        settling: Settling,
        work: &mut Workspace,
        report: &mut NewtonReport,
    ) -> Peace {
        let mut g = g.to_vec();
        let mut peace = Peace::Nowhere;
        for _ in 0..ROUNDS {
            let clock = Instant::now();
            let restless = self.restless(&g, settling, work, report);
            report.seconds.linear_solve += clock.elapsed().as_secs_f64();
            let Some(restless) = restless else { break };
            if !restless.contains(&true) {
                return Peace::Everywhere;
            }
            if !self.settle(x, &restless, contact, settling.energy, work, report) {
                break;
            }
            peace = Peace::Nearer;
            let clock = Instant::now();
            g = self.gradient(x, contact);
            report.seconds.assembly += clock.elapsed().as_secs_f64();
        }
        peace
    }

    /// The points that still have energy to gain, one flag per point, and those that they are coupled to: without them no more than
    /// [`LEFT_OUT`] of what may be is left, and none are restless where all have no more. `None` if they are many.
    fn restless(
        &self,
        g: &[Vec3],
        settling: Settling,
        work: &Workspace,
        report: &mut NewtonReport,
    ) -> Option<Vec<bool>> {
        let matrix = work.matrix();
        let enough = LEFT_OUT * settling.energy;
        let mut gains: Vec<(f64, u32)> = Vec::with_capacity(matrix.row_count());
        for (r, &p) in matrix.points().iter().enumerate() {
            let g = &g[p as usize];
            gains.push((matrix.diagonal(r).cholesky()?.solve(g).dot(g), p));
        }
        gains.sort_unstable_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        let total = gains.iter().map(|(gain, _)| gain).sum::<f64>();
        if total <= enough {
            report.newton_decrement = total;
            return Some(vec![false; g.len()]);
        }
        // Those that have most, without whom the others have no more than `enough` together and `alone` each.
        let chosen = |enough: f64, alone: f64| {
            let mut left = enough;
            let peaceful = gains.iter().take_while(|(gain, _)| {
                left -= gain;
                left >= 0.0 && *gain <= alone
            });
            let peaceful = peaceful.count();
            let mut restless = vec![false; g.len()];
            gains[peaceful..].iter().for_each(|&(_, p)| restless[p as usize] = true);
            (0..RINGS).for_each(|_| matrix.dilate(&mut restless));
            let count = restless.iter().filter(|r| **r).count();
            (count as f64 <= settling.few * matrix.row_count() as f64).then_some(restless)
        };
        chosen(enough, f64::INFINITY).or_else(|| {
            let spread = LEFT_OUT * settling.spread;
            let restless = (spread > enough).then(|| chosen(spread, ALONE * settling.energy)).flatten()?;
            if !restless.contains(&true) {
                report.newton_decrement = total;
            }
            Some(restless)
        })
    }

    /// Newton for the `restless` points alone, until they have no more than [`LEFT_OUT`] of `energy` [J] to gain. Whether anything has
    /// moved.
    fn settle(
        &self,
        x: &mut [Vec3],
        restless: &[bool],
        contact: &mut Contact,
        energy: f64,
        work: &mut Workspace,
        report: &mut NewtonReport,
    ) -> bool {
        let clock = Instant::now();
        let parts: Vec<_> = self.terms.iter().map(|term| term.restricted_to(restless)).collect();
        let terms: Vec<&dyn Energy> =
            self.terms.iter().zip(&parts).map(|(whole, part)| part.as_deref().unwrap_or(*whole)).collect();
        let held: Vec<bool> = restless.iter().map(|restless| !restless).collect();
        let problem =
            Problem { inertia: self.inertia, terms: &terms, fixed: &held, predicted_positions: None };
        report.seconds.assembly += clock.elapsed().as_secs_f64();
        let clock = Instant::now();
        contact.restrict_to(x, restless);
        report.seconds.contact += clock.elapsed().as_secs_f64();
        let mut own = work.places.take().unwrap_or_default();
        own.borrow_buffers(work);
        let mut value = problem.value(x, contact);
        let mut moved_at_all = false;
        for _ in 0..ITERATIONS {
            let g = problem.linearise(x, x, contact, &mut own, report);
            let clock = Instant::now();
            let direction = problem.direction(x, &g, &mut own);
            report.cost += own.take_cost();
            report.seconds.linear_solve += clock.elapsed().as_secs_f64();
            let Some(mut d) = direction else { break };
            report.local_iterations += 1;
            let Some(asked) = problem.rein_in(&g, &mut d, report) else { break };
            let moved = problem.move_with(x, &g, &d, &mut value, contact, report);
            moved_at_all |= moved > LEAST_SHARE;
            if asked.decrement <= LEFT_OUT * energy || moved <= LEAST_SHARE {
                break;
            }
        }
        own.borrow_buffers(work);
        own.let_go_beyond(KEPT_NUMBERS);
        work.places = Some(own);
        let clock = Instant::now();
        contact.unrestrict();
        report.seconds.contact += clock.elapsed().as_secs_f64();
        moved_at_all
    }
}
