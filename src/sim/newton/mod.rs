//! Newton's method on the incremental potential of a step (or on the plain energy, for equilibria):
//!
//! ```text
//! phi(x) = |x - inertial|²_M / (2 span²) + sum of energies(x)
//! ```
//!
//! Every iteration: gradient, positive Hessian, direct solve (of the whole, or of the few places that are not at peace
//! yet), a bound on the motion that keeps layers apart, a line
//! search that never lets phi grow. Knows no integrator and no script.

mod levenberg_marquardt;
mod line_search;
mod local_solve;
mod vertex_block_descent;

use crate::contact::Contact;
use crate::energy::Energy;
use crate::math::Vec3;
use crate::sim::linear::conjugate_gradient::conjugate_gradient;
use crate::sim::newton::levenberg_marquardt::Damping;
use crate::sim::newton::local_solve::{FEW, Peace, Settling};
use crate::sim::{BlockMatrix, Cholesky, FIXED_ROW, FactorError, SolveCost};
use rayon::prelude::*;
use std::ops::AddAssign;

/// When to stop.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct NewtonOptions {
    /// Converged when no point would move farther than this [m].
    pub displacement_tol: f64,
    /// Converged, too, when the energy left to gain is below this [J]: a few points still on their way. 0 for never.
    pub decrement_tol: f64,
    /// And when it is below this share of what the first direction promised [-]: where cloth goes far in a step there is no sense in
    /// finding its place much better than the step can tell it. 0 for never; only where `energy` is not, and in steps in which hands
    /// lead the cloth.
    pub rel_decrement_tol: f64,
    /// Iterations at most.
    pub max_iterations: usize,
}

impl Default for NewtonOptions {
    fn default() -> Self {
        Self { displacement_tol: 3e-5, decrement_tol: 0.0, rel_decrement_tol: 1e-3, max_iterations: 40 }
    }
}

/// Wall-clock time of a solve by stage [s].
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct NewtonSeconds {
    /// Values, gradients and Hessians of all energies.
    pub assembly: f64,
    /// Factorisations and triangular solves.
    pub linear_solve: f64,
    /// Search for contacts and collision-free step sizes.
    pub contact: f64,
}

impl AddAssign for NewtonSeconds {
    fn add_assign(&mut self, other: Self) {
        self.assembly += other.assembly;
        self.linear_solve += other.linear_solve;
        self.contact += other.contact;
    }
}

/// What a solve did.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct NewtonReport {
    /// Iterations made (linear solves of the whole).
    pub global_iterations: usize,
    /// Iterations that solved for a few places only.
    pub local_iterations: usize,
    /// Whether the tolerance was met.
    pub converged: bool,
    /// Largest move the last iteration asked for [m].
    pub max_displacement: f64,
    /// Energy that the last iteration still had to gain [J].
    pub newton_decrement: f64,
    /// Largest gradient entry over the free points at the end [N].
    pub residual: f64,
    /// Wall-clock time by stage.
    pub seconds: NewtonSeconds,
    /// What the linear solves took.
    pub cost: SolveCost,
}

impl NewtonReport {
    /// Adds the work of another solve; the outcome is the other's.
    pub fn add(&mut self, other: &Self) {
        let iterations = self.global_iterations + other.global_iterations;
        let local_iterations = self.local_iterations + other.local_iterations;
        let (mut seconds, mut cost) = (self.seconds, self.cost);
        seconds += other.seconds;
        cost += other.cost;
        *self = Self { global_iterations: iterations, local_iterations, seconds, cost, ..*other };
    }
}

/// The inertia term `|x - inertial|²_M / (2 effective_dt²)` of one implicit problem.
#[derive(Debug, Clone, Copy)]
pub struct Inertia<'a> {
    /// Masses, one per point [kg].
    pub mass: &'a [f64],
    /// Positions without forces, one per point [m].
    pub inertial: &'a [Vec3],
    /// Effective time step [s].
    pub effective_dt: f64,
}

/// One problem: minimise phi over the free points.
pub struct Problem<'a> {
    /// Inertia; `None` for equilibria.
    pub inertia: Option<Inertia<'a>>,
    /// The energies.
    pub terms: &'a [&'a dyn Energy],
    /// Points that stay where they are put, one flag per point.
    pub fixed: &'a [bool],
    /// Where the points are expected in the end [m], if anything is known of it: the first direction is made for the way there. It
    /// changes how fast Newton arrives, not where.
    pub predicted_positions: Option<&'a [Vec3]>,
}

/// Buffers that are worth keeping between solves.
#[derive(Default)]
pub struct Workspace {
    matrix: BlockMatrix,
    direct: Cholesky,
    /// For single places.
    pub(super) places: Option<Box<Self>>,
    /// Points that were held when the whole was last factorised, one flag each; empty without a factor.
    factorised_for: Vec<bool>,
    /// Solves to come that may begin with single places.
    calm: u32,
    /// Whether something was added to the system as it was assembled: inertia, or a shift.
    altered: bool,
    /// Solves to come that are wary of an older factor, and how many will be after it has failed again.
    pause: u32,
    next_pause: u32,
}

/// No point goes farther in one iteration [m], apart from what all do alike: a direction that throws one far off sweeps all
/// others on the way, and the search for contacts drowns in candidates.
const FARTHEST: f64 = 0.25;
/// A step whose moves are short has not converged while it has more than this many times the energy to gain that counts as
/// converged.
const JAMMED: f64 = 100.0;
/// A direction of the whole of which this share was gone leaves single places to settle.
const WENT: f64 = 0.2;
/// Where a first look at the whole finds it converged, so many solves after it begin with single places,
const CALM_SOLVES: u32 = 4;
/// in steps of up to so many seconds.
const CALM_SPAN: f64 = 0.5;
/// So many local iterations are allowed in place of one of the whole.
const LOCAL_FOR_WHOLE: usize = 8;
/// Where an older factor fails again and again only one in so many solves is not wary of it.
const LONGEST_PAUSE: u32 = 8;
/// Contacts up to this many times their distance get a place in a new pattern, so that it lasts.
const PATTERN_MARGIN: f64 = 1.5;

impl Workspace {
    /// The system as last assembled.
    pub(super) fn matrix(&self) -> &BlockMatrix {
        &self.matrix
    }

    /// Takes the solver's buffers of `other`, which gets these: one of the two works at a time.
    pub(super) fn borrow_buffers(&mut self, other: &mut Self) {
        self.direct.swap_buffers(&mut other.direct);
    }

    /// Lets go of a factor of more than so many numbers, which is not asked for again.
    pub(super) fn let_go_beyond(&mut self, numbers: usize) {
        self.direct.release_if_larger_than(numbers);
    }

    /// What linear solves took since this was last asked for.
    pub(super) fn take_cost(&mut self) -> SolveCost {
        self.direct.take_cost()
    }

    /// The next solve begins with the whole.
    pub(super) fn expect_motion(&mut self) {
        self.calm = 0;
    }

    /// Forgets the pattern: the terms of the next solve couple other points.
    pub fn reset(&mut self) {
        *self = Self::default();
    }
}

/// The farthest that a point which is not held goes from what all of those do on average [m].
fn spread(d: &[Vec3], held: &[bool]) -> f64 {
    let free = || d.iter().zip(held).filter(|(_, held)| !**held).map(|(d, _)| d);
    let mean = free().sum::<Vec3>() / free().count().max(1) as f64;
    free().map(|d| (d - mean).norm()).fold(0.0, f64::max)
}

/// The middle between two places of the points.
fn half_way(from: &[Vec3], to: &[Vec3]) -> Vec<Vec3> {
    from.iter().zip(to).map(|(from, to)| (from + to) * 0.5).collect()
}

/// The right-hand side of a Newton direction: the gradient `g`, turned, over the rows of `matrix`.
fn downhill(matrix: &BlockMatrix, g: &[Vec3]) -> Vec<Vec3> {
    matrix.gather(g).into_iter().map(|g| -g).collect()
}

/// Rows counted over the points that are not held.
fn rows_of_free(held: &[bool]) -> Vec<u32> {
    let mut next = 0;
    held.iter()
        .map(|held| {
            let row = if *held { FIXED_ROW } else { next };
            next += u32::from(!*held);
            row
        })
        .collect()
}

/// What a direction asks for.
pub(super) struct Asked {
    /// The farthest that a point went from the mean before it was cut [m].
    pub spread: f64,
    /// The gain it promises to first order [J].
    pub decrement: f64,
}

/// phi at one place.
#[derive(Debug, Clone, Copy)]
pub(super) struct Value {
    /// phi [J].
    pub sum: f64,
    /// Sum of the magnitudes of its terms [J]: they may cancel, their rounding does not.
    pub size: f64,
}

impl Value {
    fn add(&mut self, term: f64) {
        self.sum += term;
        self.size += term.abs();
    }
}

impl Problem<'_> {
    pub(super) fn value(&self, x: &[Vec3], contact: &Contact) -> Value {
        let mut value = Value { sum: 0.0, size: 0.0 };
        if let Some(Inertia { mass, inertial, effective_dt: span }) = self.inertia {
            let moved: f64 = x
                .iter()
                .zip(inertial)
                .zip(mass)
                .zip(self.fixed)
                .filter(|(_, held)| !**held)
                .map(|(((x, y), m), _)| m * (x - y).norm_squared())
                .sum();
            value.add(moved / (2.0 * span * span));
        }
        let terms = || self.terms.par_iter().map(|term| term.value(x)).collect::<Vec<f64>>();
        let (terms, contact) = rayon::join(terms, || contact.value(x));
        terms.into_iter().for_each(|term| value.add(term));
        value.add(contact);
        value
    }

    pub(super) fn gradient(&self, x: &[Vec3], contact: &Contact) -> Vec<Vec3> {
        let mut g = vec![Vec3::zeros(); x.len()];
        if let Some(Inertia { mass, inertial, effective_dt: span }) = self.inertia {
            for (((g, x), y), m) in g.iter_mut().zip(x).zip(inertial).zip(mass) {
                *g += (x - y) * (m / (span * span));
            }
        }
        let none = || vec![Vec3::zeros(); x.len()];
        let of_term = |term: &&dyn Energy| {
            let mut g = none();
            term.add_gradient(x, &mut g);
            g
        };
        let of_contact = || {
            let mut g = none();
            contact.add_gradient(x, &mut g);
            g
        };
        let (terms, contact) =
            rayon::join(|| self.terms.par_iter().map(of_term).collect::<Vec<_>>(), of_contact);
        for term in terms.iter().chain([&contact]) {
            g.iter_mut().zip(term).for_each(|(g, term)| *g += term);
        }
        g.iter_mut().zip(self.fixed).filter(|(_, held)| **held).for_each(|(g, _)| *g = Vec3::zeros());
        g
    }

    /// Slope of phi at `x` along `d` [J].
    pub(super) fn slope(&self, x: &[Vec3], d: &[Vec3], contact: &Contact) -> f64 {
        self.gradient(x, contact).iter().zip(d).map(|(g, d)| g.dot(d)).sum()
    }

    /// Assembles the system at `x`, for a way with its middle at `half` (or `x` itself).
    pub(super) fn assemble(&self, x: &[Vec3], half: &[Vec3], contact: &Contact, work: &mut Workspace) {
        work.altered = false;
        // The pattern looks ahead, and grows by what comes into contact later.
        let anew = !work.matrix.has_fixed_set(self.fixed) || work.matrix.should_rebuild();
        if anew {
            work.matrix = BlockMatrix::with_pattern(rows_of_free(self.fixed), &mut |visit| {
                self.terms.iter().for_each(|t| t.visit_stencils(visit));
                contact.visit_stencils(x, PATTERN_MARGIN, visit);
            });
        }
        let grew = work.matrix.fill(&|out| {
            self.terms.iter().for_each(|term| term.add_secant_hessian(x, half, out));
            contact.add_hessian(x, out);
        });
        debug_assert!(!(anew && grew), "a term adds a block that it did not announce");
        if let Some(Inertia { mass, effective_dt: span, .. }) = self.inertia {
            for (p, m) in mass.iter().enumerate() {
                work.matrix.add_diagonal(p, m / (span * span));
            }
        }
    }

    /// Assembles the system at `x`, for a way with its middle at `half`; the gradient [N].
    pub(super) fn linearise(
        &self,
        x: &[Vec3],
        half: &[Vec3],
        contact: &Contact,
        work: &mut Workspace,
        report: &mut NewtonReport,
    ) -> Vec<Vec3> {
        let clock = std::time::Instant::now();
        let g = self.gradient(x, contact);
        report.residual = g.iter().map(|g| g.amax()).fold(0.0, f64::max);
        self.assemble(x, half, contact, work);
        report.seconds.assembly += clock.elapsed().as_secs_f64();
        g
    }

    /// Newton direction from the factor that is there, of an older system; none where too much has changed since.
    fn direction_from_older(&self, g: &[Vec3], enough: f64, work: &mut Workspace) -> Option<Vec<Vec3>> {
        if work.factorised_for != self.fixed {
            return None;
        }
        let wary = work.pause > 0;
        let mut rhs = downhill(&work.matrix, g);
        if work.direct.solve_with_stale_factor(&work.matrix, &mut rhs, enough, wary) {
            (work.pause, work.next_pause) = (0, 1);
            return Some(work.matrix.scatter(&rhs));
        }
        if wary {
            work.pause -= 1;
            return None;
        }
        work.pause = work.next_pause;
        work.next_pause = (2 * work.next_pause).clamp(1, LONGEST_PAUSE);
        None
    }

    /// Newton direction at `x` for gradient `g`.
    pub(super) fn direction(&self, x: &[Vec3], g: &[Vec3], work: &mut Workspace) -> Option<Vec<Vec3>> {
        let mut rhs = downhill(&work.matrix, g);
        let mut shift = 0.0;
        work.factorised_for.clear();
        for _ in 0..12 {
            let factorised = work.direct.factorise(&work.matrix, x);
            match factorised.and_then(|()| work.direct.solve(&work.matrix, &mut rhs)) {
                Ok(()) => {
                    work.factorised_for.extend_from_slice(self.fixed);
                    return Some(work.matrix.scatter(&rhs));
                }
                Err(FactorError::TooLarge) => {
                    let solution = conjugate_gradient(&work.matrix, &rhs, 1e-6, 20_000);
                    return Some(work.matrix.scatter(&solution.x));
                }
                Err(FactorError::NotPositive) => {
                    // Rounding can push a nearly singular matrix below zero: a growing shift mends it.
                    let largest = work.matrix.largest_diagonal();
                    if !largest.is_finite() {
                        return None;
                    }
                    let more = if shift == 0.0 { 1e-10 * largest } else { 9.0 * shift };
                    shift += more;
                    work.altered = true;
                    (0..x.len()).for_each(|p| work.matrix.add_diagonal(p, more));
                }
            }
        }
        None
    }

    /// Cuts the direction `d` where it throws a point too far, and notes the largest move it asked for; what it promises for gradient
    /// `g`. `None` if it is not finite.
    pub(super) fn rein_in(&self, g: &[Vec3], d: &mut [Vec3], report: &mut NewtonReport) -> Option<Asked> {
        report.max_displacement = d.iter().map(|d| d.norm()).fold(0.0, f64::max);
        if !report.max_displacement.is_finite() {
            return None;
        }
        let spread = spread(d, self.fixed);
        if spread > FARTHEST {
            d.iter_mut().for_each(|d| *d *= FARTHEST / spread);
        }
        let decrement = -g.iter().zip(d.iter()).map(|(g, d)| g.dot(d)).sum::<f64>();
        Some(Asked { spread, decrement })
    }

    /// Whether the last look at the whole found so little to gain that single places may settle first.
    fn begins_with_places(&self, work: &mut Workspace) -> bool {
        let short = self.inertia.is_some_and(|inertia| inertia.effective_dt <= CALM_SPAN);
        let calm = work.calm > 0 && short && !work.altered && work.matrix.has_fixed_set(self.fixed);
        work.calm = work.calm.saturating_sub(1);
        calm
    }

    /// Minimises phi from `x`, in place, where `contact` has begun its step. Every intermediate position keeps layers apart if the first did.
    pub fn solve(
        &self,
        x: &mut [Vec3],
        contact: &mut Contact,
        options: &NewtonOptions,
        work: &mut Workspace,
    ) -> NewtonReport {
        let mut report = NewtonReport::default();
        if self.fixed.iter().all(|held| *held) {
            report.converged = true;
            return report;
        }
        let mut settling = Settling { energy: options.decrement_tol, spread: 0.0, few: FEW };
        if self.begins_with_places(work) {
            let clock = std::time::Instant::now();
            let g = self.gradient(x, contact);
            report.seconds.assembly += clock.elapsed().as_secs_f64();
            if let Peace::Everywhere = self.settle_places(x, &g, contact, settling, work, &mut report) {
                report.converged = true;
                return report;
            }
        }
        let mut value = self.value(x, contact);
        let mut whole_went = 0.0;
        let mut damping = Damping::default();
        // Local iterations are cheap: they count for less.
        let spent =
            |report: &NewtonReport| report.global_iterations + report.local_iterations / LOCAL_FOR_WHOLE;
        while spent(&report) < options.max_iterations {
            let half = self
                .predicted_positions
                .filter(|_| report.global_iterations == 0)
                .map(|ahead| half_way(x, ahead));
            let g = self.linearise(x, half.as_deref().unwrap_or(x), contact, work, &mut report);
            if whole_went >= WENT && !damping.acts() {
                match self.settle_places(x, &g, contact, settling, work, &mut report) {
                    Peace::Everywhere if whole_went == 1.0 => {
                        report.converged = true;
                        break;
                    }
                    // What is left of a direction that was cut short no single place can tell.
                    Peace::Everywhere | Peace::Nearer => {
                        value = self.value(x, contact);
                        whole_went = 0.0;
                        continue;
                    }
                    Peace::Nowhere => {}
                }
            }
            let clock = std::time::Instant::now();
            if let Some(Inertia { mass, effective_dt: span, .. }) = self.inertia.filter(|_| damping.acts()) {
                damping.add_to(&mut work.matrix, mass, span);
                work.altered = true;
            }
            let older = self.direction_from_older(&g, options.decrement_tol, work);
            let direction = older.or_else(|| self.direction(x, &g, work));
            report.cost += work.take_cost();
            report.seconds.linear_solve += clock.elapsed().as_secs_f64();
            let Some(mut d) = direction else { break };
            report.global_iterations += 1;
            let Some(Asked { spread, decrement }) = self.rein_in(&g, &mut d, &mut report) else { break };
            report.newton_decrement = decrement;
            if report.global_iterations == 1 {
                work.calm = if decrement <= options.decrement_tol { CALM_SOLVES } else { 0 };
                if options.decrement_tol > 0.0 && self.inertia.is_some() {
                    settling.spread = options.rel_decrement_tol * decrement;
                }
            }
            // What a direction of the whole promises is spread out.
            let enough = options.decrement_tol.max(settling.spread);
            // Where layers are jammed moves are short although much is left to gain.
            let jammed = enough > 0.0 && decrement > JAMMED * enough;
            let done = !damping.acts()
                && (report.max_displacement <= options.displacement_tol && !jammed || decrement <= enough);
            let before = value.sum;
            let moved = self.move_whole(x, &g, &d, &mut value, contact, (enough, work), &mut report);
            whole_went = moved;
            if damping.acts() && decrement <= enough {
                damping.relieve();
                continue;
            }
            if moved == 0.0 && damping.tighten() {
                continue;
            }
            if self.inertia.is_some() {
                damping.learn((before - value.sum) / decrement.max(f64::MIN_POSITIVE), spread);
            }
            if done || moved == 0.0 {
                // A direction along which phi no longer falls to rounding is as good as converged.
                report.converged = done || decrement.abs() <= 1e-12 * value.size.max(f64::MIN_POSITIVE);
                break;
            }
        }
        report
    }
}
