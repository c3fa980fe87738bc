//! How far a direction is gone: the bound that keeps layers apart, the line search, and the places that spoil the way.
//!
//! One spot where layers meet spoils a direction that is right everywhere else: a line search cuts the way of the whole for
//! it, to a half or a hundredth, again and again. A direction of the whole is gone to its end instead, the spots settle by a
//! Newton of their own (`places`), everything else standing still, and what comes out is taken where phi has fallen by its
//! share: nonlinear elimination (Lanzkron, Rose, Wilkes 1996; Cai, Li 2011).

use crate::contact::Contact;
use crate::math::Vec3;
use crate::sim::newton::local_solve::Settling;
use crate::sim::newton::{NewtonReport, Problem, Value, Workspace};
use std::time::Instant;

/// Differences of phi below this share of its terms are not trusted over its slope: the terms are sums themselves
/// and may lose some digits inside (the weight of cloth on both sides of height zero).
const BLIND: f64 = 1e-10;
/// A line search that keeps less of the way than this has failed, and the way is cut differently.
pub(super) const LEAST_SHARE: f64 = 0.01;
/// Places that spoil a way may be up to this share of the free points.
const MANY: f64 = 0.5;
/// With them settled, phi must have fallen by this share of what the way promised.
const FAIR: f64 = 0.1;
/// A way of less than this share is not worth settling places for.
const LEAST_MENDED: f64 = 0.1;

impl Problem<'_> {
    /// Moves `x` along `d`, a direction of the whole, as far as layers and phi allow, where places that spoil the way settle first; the
    /// share of the way that was kept. What is below `enough` [J] does not count, `work` holds the system at `x`.
    #[allow(clippy::too_many_arguments)] // what a solve has in hand
    pub(super) fn move_whole(
        &self,
        x: &mut [Vec3],
        g: &[Vec3],
        d: &[Vec3],
        value: &mut Value,
        contact: &mut Contact,
        (enough, work): (f64, &mut Workspace),
        report: &mut NewtonReport,
    ) -> f64 {
        let way = bounded(x, d, false, contact, report);
        let slope: f64 = g.iter().zip(&way).map(|(g, d)| g.dot(d)).sum();
        let mut share = 1.0;
        while slope <= 0.0 && share >= LEAST_MENDED {
            let clock = Instant::now();
            let mut there = along(x, &way, share);
            let arrived = self.value(&there, contact);
            let falls = self.falls(&there, &arrived, value, (&way, slope), share, contact);
            let g = (!falls && arrived.sum.is_finite()).then(|| self.gradient(&there, contact));
            report.seconds.assembly += clock.elapsed().as_secs_f64();
            if falls {
                x.copy_from_slice(&there);
                *value = arrived;
                return share;
            }
            let before = report.local_iterations;
            if let Some(g) = g {
                // What is said of the whole is still true of it.
                let (left, last_move) = (report.newton_decrement, report.max_displacement);
                // As far as what the way promised is worth.
                let energy = enough.max(share * -slope);
                let settling = Settling { energy, spread: 0.0, few: MANY };
                self.settle_places(&mut there, &g, contact, settling, work, report);
                (report.newton_decrement, report.max_displacement) = (left, last_move);
            }
            if report.local_iterations > before {
                let clock = Instant::now();
                let settled = self.value(&there, contact);
                report.seconds.assembly += clock.elapsed().as_secs_f64();
                if settled.sum <= value.sum + FAIR * share * slope {
                    x.copy_from_slice(&there);
                    *value = settled;
                    return share;
                }
                // Who may come near on the way is known around the places only by now.
                bounded(x, d, false, contact, report);
            }
            share *= 0.5;
        }
        self.move_with(x, g, d, value, contact, report)
    }

    /// Moves `x` along `d` as far as layers and the line search allow; the share of the way that was kept.
    pub(super) fn move_with(
        &self,
        x: &mut [Vec3],
        g: &[Vec3],
        d: &[Vec3],
        value: &mut Value,
        contact: &mut Contact,
        report: &mut NewtonReport,
    ) -> f64 {
        let mut moved = 0.0;
        // Single points cut short first; if that spoils the direction, all cut alike, which cannot.
        for together in [false, true] {
            let way = bounded(x, d, together, contact, report);
            let clock = Instant::now();
            let slope: f64 = g.iter().zip(&way).map(|(g, d)| g.dot(d)).sum();
            if slope > 0.0 && !together {
                // The cuts have spoiled it.
                continue;
            }
            let least = if together { 0.0 } else { LEAST_SHARE };
            moved = self.line_search(x, &way, slope, least, value, contact);
            report.seconds.assembly += clock.elapsed().as_secs_f64();
            if moved > LEAST_SHARE {
                break;
            }
        }
        moved
    }

    /// The same for those who keep no value of phi.
    pub(super) fn move_along(
        &self,
        x: &mut [Vec3],
        g: &[Vec3],
        d: &[Vec3],
        contact: &mut Contact,
        report: &mut NewtonReport,
    ) -> f64 {
        let mut value = self.value(x, contact);
        self.move_with(x, g, d, &mut value, contact, report)
    }

    /// Moves `x` along `d` by the share for which phi falls enough (Armijo where the slope is down); 0 if it would have
    /// to be less than `least`.
    fn line_search(
        &self,
        x: &mut [Vec3],
        d: &[Vec3],
        slope: f64,
        least: f64,
        value: &mut Value,
        contact: &Contact,
    ) -> f64 {
        let mut share = 1.0;
        for _ in 0..24 {
            if share < least {
                return 0.0;
            }
            let there = along(x, d, share);
            let arrived = self.value(&there, contact);
            if self.falls(&there, &arrived, value, (d, slope), share, contact) {
                x.copy_from_slice(&there);
                *value = arrived;
                return share;
            }
            share *= 0.5;
        }
        0.0
    }

    /// Whether phi is `arrived` low enough `there`, a `share` of the way on which it falls by `slope` at first, from `value`.
    ///
    /// Near the end phi falls by less than its rounding, and its values say nothing any more. The slope at the trial
    /// place still does: where phi is nearly quadratic it has fallen if it rises there less steeply than it fell at the
    /// start (the approximate Wolfe condition of Hager and Zhang 2005).
    fn falls(
        &self,
        there: &[Vec3],
        arrived: &Value,
        value: &Value,
        (way, slope): (&[Vec3], f64),
        share: f64,
        contact: &Contact,
    ) -> bool {
        // Rounding of a sum of many terms.
        let noise = 1e-13 * value.size;
        // Not a number never counts as blind.
        let blind = (arrived.sum - value.sum).abs() <= BLIND * value.size;
        arrived.sum <= value.sum + 1e-4 * share * slope.min(0.0) + noise
            || (blind && self.slope(there, way, contact) <= -0.9 * slope)
    }
}

/// The places `share` of the way `d` from `x` on.
fn along(x: &[Vec3], d: &[Vec3], share: f64) -> Vec<Vec3> {
    x.iter().zip(d).map(|(x, d)| x + d * share).collect()
}

/// The way from `x` by `d` where layers are near: all points cut short alike if `together`, else single ones. Afterwards values may be
/// asked for anywhere on it.
fn bounded(
    x: &[Vec3],
    d: &[Vec3],
    together: bool,
    contact: &mut Contact,
    report: &mut NewtonReport,
) -> Vec<Vec3> {
    let clock = Instant::now();
    let mut way = d.to_vec();
    if together {
        contact.limit_displacement_uniform(x, &mut way);
    } else {
        contact.limit_displacement(x, &mut way);
    }
    report.seconds.contact += clock.elapsed().as_secs_f64();
    way
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::energy::{BlockSink, Energy, add_symmetric};
    use crate::math::Mat3;

    const COUNT: usize = 60;
    /// Where all points are pulled to, and where a wall stops one of them [m].
    const AIM: f64 = 0.01;
    const WALL: f64 = 0.002;

    /// A chain whose points are pulled upwards, one of them against a wall that its Hessian does not know of before it is touched.
    struct Chain;

    impl Chain {
        /// How deep the point in the middle is in the wall [m].
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

    /// One point at a wall cuts the way of all to a quarter; where it settles first all others go to their end.
    #[test]
    fn a_place_that_spoils_a_direction_settles_and_the_others_arrive() {
        let held = vec![false; COUNT];
        let terms: [&dyn Energy; 2] = [&Chain, &HessianShift];
        let problem = Problem { inertia: None, terms: &terms, fixed: &held, predicted_positions: None };
        let mut contact = Contact::none(COUNT);
        let (mut work, mut report) = (Workspace::default(), NewtonReport::default());
        let start = vec![Vec3::zeros(); COUNT];
        let g = problem.linearise(&start, &start, &contact, &mut work, &mut report);
        let d = problem.direction(&start, &g, &mut work).expect("positive");
        let at_start = problem.value(&start, &contact);

        let (mut x, mut value) = (start.clone(), at_start);
        assert_eq!(problem.move_with(&mut x, &g, &d, &mut value, &mut contact, &mut report), 0.25);
        let cut_short = value.sum;

        let (mut x, mut value) = (start, at_start);
        let share =
            problem.move_whole(&mut x, &g, &d, &mut value, &mut contact, (1e-9, &mut work), &mut report);
        assert_eq!(share, 1.0);
        assert!(report.local_iterations > 0);
        assert!(value.sum < 0.5 * cut_short, "{} against {cut_short}", value.sum);
        assert_eq!(value.sum, problem.value(&x, &contact).sum);
        assert!((x[0].y - AIM).abs() < 1e-6 && Chain::depth(&x) < 1e-4, "{} {}", x[0].y, x[COUNT / 2].y);
    }
}
