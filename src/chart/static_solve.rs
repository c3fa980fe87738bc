//! Static equilibria of membrane, bending and weight, without contact and memory.
//!
//! Plain Newton converges slowly from flat to bent where the membrane is stiff. Pseudo-transient continuation
//! (inertia without velocity, whose time step doubles from round to round) leads to its region of convergence.

use crate::test_sheet::TestSheet;
use crease_geometry::math::{Vec2, Vec3};
use crease_model::garment::RestState;
use crease_solver::contact::Contact;
use crease_solver::energy::{Bending, Energy, Gravity, Membrane};
use crease_solver::sim::{GRAVITY, Inertia, NewtonOptions, NewtonReport, Problem, Workspace};

/// Rounds of pseudo-transient continuation.
const ROUNDS: usize = 24;
/// Newton iterations per round.
const MAX_ITERATIONS_PER_ROUND: usize = 3;
/// Newton iterations of the final solve without inertia.
const MAX_FINAL_ITERATIONS: usize = 200;
/// Displacement tolerance of a round over that of the final solve [-].
const ROUND_TOL_FACTOR: f64 = 1e3;

/// A clamped specimen.
pub(super) struct StaticProblem {
    membrane: Membrane,
    bending: Bending,
    memory: RestState,
    mass: Vec<f64>,
    fixed: Vec<bool>,
}

impl StaticProblem {
    /// Specimen of `sheet` with stiffness `stretch` (warp, weft, shear) [N/m], bending `rigidity` [N·m] and `density`
    /// [kg/m²], half clamped where `clamped` holds.
    pub(super) fn new(
        sheet: &TestSheet,
        stretch: [f64; 3],
        rigidity: f64,
        density: f64,
        clamped: impl Fn(&Vec2) -> bool,
    ) -> Self {
        let garment = sheet.flat_garment();
        let membrane = Membrane::from_parts(&sheet.triangles, &garment.material, stretch, 0.0);
        let bending = Bending::from_parts(&garment.topology, &garment.material, [rigidity; 2], 0.0);
        let mut mass = vec![0.0; sheet.flat.len()];
        for (t, area) in sheet.triangles.iter().zip(membrane.area()) {
            t.iter().for_each(|&p| mass[p as usize] += density * area / 3.0);
        }
        let mut memory = RestState::flat(garment.topology.hinges.len(), sheet.triangles.len());
        let fixed: Vec<bool> = sheet.flat.iter().map(clamped).collect();
        memory.stiffness_ratio = sheet.half_clamp(&fixed);
        Self { membrane, bending, memory, mass, fixed }
    }

    /// Solves for equilibrium from `x` [m], with the first `pseudo_time` step [s] and the displacement `tolerance`
    /// [m].
    pub(super) fn solve(&self, x: &mut [Vec3], pseudo_time: f64, tolerance: f64) -> NewtonReport {
        let mut work = Workspace::default();
        let mut contact = Contact::none(x.len());
        let mut span = pseudo_time;
        let mut total = NewtonReport::default();
        for round in 0..=ROUNDS {
            let start = x.to_vec();
            let angle = self.bending.angles(&start, &[]);
            let membrane = self.membrane.term(&self.memory, &[], f64::INFINITY);
            let bending = self.bending.term(&self.memory, &angle, f64::INFINITY);
            let gravity = Gravity { mass: &self.mass, acceleration: Vec3::new(0.0, -GRAVITY, 0.0) };
            let terms: [&dyn Energy; 3] = [&membrane, &bending, &gravity];
            let last = round == ROUNDS;
            let inertia =
                (!last).then_some(Inertia { mass: &self.mass, inertial: &start, effective_dt: span });
            let problem = Problem { inertia, terms: &terms, fixed: &self.fixed, predicted_positions: None };
            let (factor, max_iterations) =
                if last { (1.0, MAX_FINAL_ITERATIONS) } else { (ROUND_TOL_FACTOR, MAX_ITERATIONS_PER_ROUND) };
            let newton = NewtonOptions {
                displacement_tol: factor * tolerance,
                decrement_tol: 0.0,
                rel_decrement_tol: 0.0,
                max_iterations,
            };
            total.add(&problem.solve(x, &mut contact, &newton, &mut work));
            span *= 2.0;
        }
        total
    }
}
