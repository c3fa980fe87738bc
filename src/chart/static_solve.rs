//! Specimens that hang still: equilibria of membrane, bending and weight, without contact and memory, for charts whose
//! references are equilibria.
//!
//! From flat to bent is far for a stiff membrane, and plain Newton would creep: inertia without velocity, whose pseudo time
//! doubles from round to round, leads to where plain Newton converges.

use crate::chart::test_sheet::Sheet;
use crate::contact::Contact;
use crate::energy::{Bending, Energy, Gravity, Membrane};
use crate::garment::RestState;
use crate::math::{Vec2, Vec3};
use crate::sim::GRAVITY;
use crate::sim::{Inertia, NewtonOptions, NewtonReport, Problem, Workspace};

/// Rounds with inertia, and iterations of each.
const ROUNDS: (usize, usize) = (24, 3);
/// Iterations at most without.
const MOST_ITERATIONS: usize = 200;

/// A specimen held by a clamp.
pub(super) struct Still {
    membrane: Membrane,
    bending: Bending,
    memory: RestState,
    mass: Vec<f64>,
    held: Vec<bool>,
}

impl Still {
    /// `sheet` of `stretch` (warp, weft, shear) [N/m], bending `rigidity` [N·m] and `density` [kg/m²], half clamped where
    /// `clamped` holds.
    pub(super) fn new(
        sheet: &Sheet,
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
        memory.stiffness_ratio = sheet.half_clamp(&clamped);
        Self { membrane, bending, memory, mass, held: sheet.flat.iter().map(clamped).collect() }
    }

    /// Comes to rest from `x` [m]; the first pseudo time [s], the tolerance [m].
    pub(super) fn settle(&self, x: &mut [Vec3], pseudo_time: f64, tolerance: f64) -> NewtonReport {
        let mut work = Workspace::default();
        let mut contact = Contact::none(x.len());
        let mut span = pseudo_time;
        let mut total = NewtonReport::default();
        for round in 0..=ROUNDS.0 {
            let start = x.to_vec();
            let angle = self.bending.angles(&start, &[]);
            let membrane = self.membrane.term(&self.memory, &[], f64::INFINITY);
            let bending = self.bending.term(&self.memory, &angle, f64::INFINITY);
            let gravity = Gravity { mass: &self.mass, acceleration: Vec3::new(0.0, -GRAVITY, 0.0) };
            let terms: [&dyn Energy; 3] = [&membrane, &bending, &gravity];
            let last = round == ROUNDS.0;
            let inertia =
                (!last).then_some(Inertia { mass: &self.mass, inertial: &start, effective_dt: span });
            let problem = Problem { inertia, terms: &terms, fixed: &self.held, predicted_positions: None };
            let (share, most_iterations) = if last { (1.0, MOST_ITERATIONS) } else { (1e3, ROUNDS.1) };
            let newton = NewtonOptions {
                displacement_tol: share * tolerance,
                decrement_tol: 0.0,
                rel_decrement_tol: 0.0,
                max_iterations: most_iterations,
            };
            total.add(&problem.solve(x, &mut contact, &newton, &mut work));
            span *= 2.0;
        }
        total
    }
}
