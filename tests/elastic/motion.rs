//! Integrators on an oscillator, a falling and a free particle, and a tumbling hinge.

use crate::reference::{self, figures};
use crate::rest::forces;
use crate::sheet::SheetModels;
use crease_chart::TestSheet;
use crease_geometry::math::{Vec2, Vec3};
use crease_model::garment::RestState;
use crease_solver::contact::Contact;
use crease_solver::energy::{Bending, Energy, Gravity, Membrane, TargetSpring, TargetSprings};
use crease_solver::sim::{Inertia, Method, NewtonOptions, PreviousState, Problem, State, Workspace};
use test_attributes::needs_data;

/// Newton iterates to rounding: the tests measure the integrator, not the tolerance of the solver.
const NEWTON: NewtonOptions =
    NewtonOptions { displacement_tol: 1e-13, decrement_tol: 0.0, rel_decrement_tol: 0.0, max_iterations: 30 };

/// One step of `h` seconds under `terms`; the state's angles are left as they were.
fn advance(
    method: Method,
    state: &State,
    mass: &[f64],
    terms: &[&dyn Energy],
    h: f64,
    work: &mut Workspace,
) -> State {
    let stage = method.stage(state, h);
    let x = minimise(mass, &stage.inertial(), stage.effective_dt, terms, &state.x, work);
    let v = stage.velocity(&x);
    follow(state, x, v, h)
}

/// One step of the trapezoid rule, the first step of the reference table of BDF2.
fn trapezoid(state: &State, mass: &[f64], terms: &[&dyn Energy], h: f64, work: &mut Workspace) -> State {
    let gradient = forces(terms, &state.x);
    let inertial: Vec<Vec3> = (0..mass.len())
        .map(|i| state.x[i] + state.v[i] * h - gradient[i] * (0.25 * h * h / mass[i]))
        .collect();
    let x = minimise(mass, &inertial, 0.5 * h, terms, &state.x, work);
    let v = (0..mass.len()).map(|i| (x[i] - state.x[i]) * (2.0 / h) - state.v[i]).collect();
    follow(state, x, v, h)
}

fn minimise(
    mass: &[f64],
    inertial: &[Vec3],
    span: f64,
    terms: &[&dyn Energy],
    from: &[Vec3],
    work: &mut Workspace,
) -> Vec<Vec3> {
    let fixed = vec![false; mass.len()];
    let problem = Problem {
        inertia: Some(Inertia { mass, inertial, effective_dt: span }),
        terms,
        fixed: &fixed,
        predicted_positions: None,
    };
    let mut x = from.to_vec();
    let report = problem.solve(&mut x, &mut Contact::none(mass.len()), &NEWTON, work);
    assert!(report.converged, "a step did not converge: {report:?}");
    x
}

fn follow(state: &State, x: Vec<Vec3>, v: Vec<Vec3>, h: f64) -> State {
    let previous = Some(PreviousState { dt: h, x: state.x.clone(), v: state.v.clone() });
    State { time: state.time + h, x, v, angle: state.angle.clone(), previous }
}

/// A particle at `x` that moves with `v`.
fn particle(x: Vec3, v: Vec3) -> State {
    let mut state = State::at_rest(vec![x], Vec::new());
    state.v[0] = v;
    state
}

/// Halving orders of a list of errors, coarse to fine.
fn orders(errors: &[f64]) -> Vec<f64> {
    errors.windows(2).map(|e| (e[0] / e[1]).log2()).collect()
}

// ---- Oscillator ----

const OMEGA: f64 = std::f64::consts::TAU;

/// A linear spring to the origin, of `OMEGA` for 1 kg.
const SPRING: [TargetSpring; 1] = [TargetSpring {
    point: 0,
    target: Vec3::new(0.0, 0.0, 0.0),
    normal: Vec3::new(0.0, 1.0, 0.0),
    stiffness: OMEGA * OMEGA,
    tangential_stiffness: OMEGA * OMEGA,
}];

/// x + i v / omega of an oscillator that starts at x = 1, after each of `steps` steps of omega h = `z`.
fn oscillate(method: Method, z: f64, steps: usize) -> Vec<[f64; 2]> {
    let mut state = particle(Vec3::x(), Vec3::zeros());
    let mut work = Workspace::default();
    (0..steps)
        .map(|_| {
            state = advance(method, &state, &[1.0], &[&TargetSprings(&SPRING)], z / OMEGA, &mut work);
            [state.x[0].x, state.v[0].x / OMEGA]
        })
        .collect()
}

/// Property: numerical damping is that of the method (`numerical_damping.csv`): amplitude after one period within 1e-4.
#[test]
fn oscillator_amplitude_per_period_is_that_of_the_method() {
    const TABLE: [(f64, f64, f64); 3] = [
        (0.1, 0.731_543_302_7, 0.998_468_645),
        (0.314_159_265_358_979_3, 0.390_143_514_7, 0.961_631_148),
        (0.628_318_530_717_958_6, 0.189_437_058_7, 0.821_788_214_6),
    ];
    for (z, euler, bdf2) in TABLE {
        for (method, expected) in [(Method::BackwardEuler, euler), (Method::Bdf2, bdf2)] {
            // The second root of BDF2 decays by a factor of three per step: after 40 steps only the first is left.
            let path = oscillate(method, z, 60);
            let amplitude = |p: &[f64; 2]| p[0].hypot(p[1]);
            let per_step = (amplitude(&path[59]) / amplitude(&path[39])).powf(1.0 / 20.0);
            let per_period = per_step.powf(std::f64::consts::TAU / z);
            println!("{} z {z:.4}: {per_period:.8} (reference {expected:.8})", method.name());
            assert!((per_period - expected).abs() <= 1e-4);
        }
    }
}

/// Property: the orders on an oscillator are 0.9 to 1.05 for backward Euler and at least 1.95 for BDF2, whose first
/// step of backward Euler does not lower it; errors are those of `oscillator_convergence.csv` to 1e-5 of their size.
#[test]
fn oscillator_converges_with_the_order_of_the_method() {
    const STEPS: [usize; 4] = [160, 320, 640, 1280];
    const EULER: [f64; 4] = [0.116_019_18, 0.059_814_975, 0.030_370_945, 0.015_302_857];
    const BDF2: [f64; 4] = [0.003_426_111_3, 0.000_857_607_49, 0.000_214_440_78, 5.360_911_8e-5];
    for (method, expected, bounds) in
        [(Method::BackwardEuler, EULER, [0.9, 1.05]), (Method::Bdf2, BDF2, [1.95, 2.05])]
    {
        let errors = STEPS.map(|n| {
            let end = oscillate(method, std::f64::consts::TAU / n as f64, n)[n - 1];
            (end[0] - 1.0).hypot(end[1])
        });
        let orders = orders(&errors);
        println!("{} oscillator: errors {}, orders {orders:.3?}", method.name(), figures(&errors));
        assert!(errors.iter().zip(&expected).all(|(e, r)| (e / r - 1.0).abs() <= 1e-5), "{errors:?}");
        assert!(orders.iter().all(|o| (bounds[0]..bounds[1]).contains(o)));
    }
}

// ---- Particles ----

/// Property: after one second of free fall backward Euler is g h / 2 too low and BDF2, started with one step of it,
/// 0.75 g h² too low, both to 1e-6 of that.
#[test]
fn free_fall_errors_are_those_of_the_method() {
    const G: f64 = 9.81;
    let acceleration = Vec3::new(0.0, 0.0, -G);
    for (method, expected) in
        [(Method::BackwardEuler, -G * 0.02 / 2.0), (Method::Bdf2, -0.75 * G * 0.02 * 0.02)]
    {
        let mut state = particle(Vec3::zeros(), Vec3::zeros());
        let mut work = Workspace::default();
        for _ in 0..50 {
            let weight = Gravity { mass: &[0.3], acceleration };
            state = advance(method, &state, &[0.3], &[&weight], 0.02, &mut work);
        }
        let error = state.x[0].z + G / 2.0;
        let off = error / expected - 1.0;
        println!("{} free fall: error {error:.9} m, off by {off:.1e} of itself", method.name());
        assert!(off.abs() <= 1e-6);
    }
}

/// Property: steps that double twenty times keep the velocity of a free particle to 1e-12.
#[test]
fn doubling_steps_keep_the_velocity_of_a_free_particle() {
    let start = Vec3::new(0.3, -0.2, 0.1);
    let velocity = Vec3::new(1.0, 2.0, -0.5);
    let mut state = particle(start, velocity);
    let mut work = Workspace::default();
    let mut h = 1e-3;
    let mut worst: f64 = 0.0;
    for _ in 0..=20 {
        state = advance(Method::Bdf2, &state, &[0.2], &[], h, &mut work);
        worst = worst.max((state.v[0] - velocity).norm() / velocity.norm());
        h *= 2.0;
    }
    println!("ratio 2 for 20 steps: velocity error {worst:.1e}");
    assert!(worst <= 1e-12);
    assert!((state.x[0] - start - velocity * state.time).norm() <= 1e-12 * state.time);
}

/// Property: BDF2 restarts with backward Euler where a step is three times the last, as it would be unstable (root
/// 9/7). A ratio of two is stable.
#[test]
fn a_forced_ratio_of_three_restarts_with_backward_euler() {
    let mut state = particle(Vec3::new(0.3, 0.0, 0.0), Vec3::x());
    state = advance(Method::Bdf2, &state, &[1.0], &[], 0.01, &mut Workspace::default());
    let (three, euler) = (Method::Bdf2.stage(&state, 0.03), Method::BackwardEuler.stage(&state, 0.03));
    assert_eq!(three.effective_dt, euler.effective_dt);
    assert_eq!((three.base_positions, three.base_velocities), (euler.base_positions, euler.base_velocities));
    let two = Method::Bdf2.stage(&state, 0.02);
    assert!((two.effective_dt - 0.6 * 0.02).abs() < 1e-15, "(1 + r) h / (1 + 2 r) with r = 2");

    // A disturbance of 1e-12 m/s, which BDF2 would amplify to 2e-8 in 40 steps.
    let velocity = Vec3::new(1.0 + 1e-12, 0.0, 0.0);
    state.v[0] = velocity;
    let mut work = Workspace::default();
    let mut h = 0.01;
    for _ in 0..40 {
        h *= 3.0;
        state = advance(Method::Bdf2, &state, &[1.0], &[], h, &mut work);
    }
    assert!((state.v[0] - velocity).norm() <= 1e-11, "{:e}", (state.v[0] - velocity).norm());
}

// ---- Tumbling hinge ----

/// `hinge_free_flight` of `dynamics_reference.json`: two triangles, no weight, spinning and flapping.
const FLAT: [[f64; 2]; 4] = [[0.0, 0.0], [0.1, 0.0], [0.03, 0.08], [0.06, -0.05]];
const VELOCITY: [[f64; 3]; 4] = [
    [0.38, -0.277_435_897_435_897_47, 0.664_102_564_102_564_1],
    [0.38, 0.522_564_102_564_102_6, 1.164_102_564_102_564],
    [-0.260_000_000_000_000_06, -0.037_435_897_435_897_45, 2.414_102_564_102_564_4],
    [0.78, 0.202_564_102_564_102_56, 1.264_102_564_102_564],
];
/// Positions at 0.1 s [m], DOP853 and Radau agreeing to 2e-14.
const AT_100_MS: [[f64; 3]; 4] = [
    [0.048529884393896244, -0.007072312857304199, 0.09905569159899708],
    [0.12050767072993271, 0.048864035737663666, 0.13978537167599808],
    [0.02954176885258277, 0.01096056055722635, 0.17994076726665506],
    [0.11523552651391253, 0.029804623619502854, 0.07910800785836453],
];
/// Steps in 0.1 s, and the error columns of `hinge_free_flight_convergence.csv` [m]. Backward Euler has the same first
/// step here and in the table; BDF2 of the table starts with a step of the trapezoid rule.
const STEPS: [usize; 6] = [50, 100, 200, 400, 800, 1600];
const EULER_COLUMN: [f64; 6] =
    [3.142_829_01e-3, 1.651_619_56e-3, 8.543_979_27e-4, 4.373_416_08e-4, 2.225_383_24e-4, 1.123_453_16e-4];
const BDF2_COLUMN: [f64; 6] =
    [4.895_534_76e-4, 1.362_764_71e-4, 3.384_169_36e-5, 8.387_991_99e-6, 2.087_703_37e-6, 5.208_116_68e-7];

struct Flight {
    mass: Vec<f64>,
    membrane: Membrane,
    bending: Bending,
    memory: RestState,
}

/// First step of a flight.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Start {
    Own,
    Trapezoid,
}

impl Flight {
    fn new() -> Self {
        let flat = FLAT.map(|p| Vec2::new(p[0], p[1]));
        let sheet = TestSheet { flat: flat.into(), triangles: vec![[0, 1, 2], [1, 0, 3]] };
        let bending = sheet.bending(1e-4);
        // The reference has an edge hinge of k = B l² / (A1 + A2); the face operator of a lone hinge has another
        // constant, which the stiffness ratio compensates.
        let mut memory = sheet.memory();
        let bent = [[0.0, 0.0, 0.0], [0.1, 0.0, 0.0], [0.03, 0.08, 0.01], [0.06, -0.05, 0.0]].map(Vec3::from);
        let angle = bending.angles(&bent, &[]);
        let unit = bending.term(&memory, &angle, f64::INFINITY).torques(&bent)[0] / angle[0];
        memory.stiffness_ratio[0] = 1e-4 * 0.01 / 0.0065 / unit;
        memory.rest_angle[0] = 0.25;
        Self { mass: sheet.mass(0.2), membrane: sheet.membrane([20.0, 20.0, 5.0]), bending, memory }
    }

    /// Integrates 0.1 s in `count` steps.
    fn run(&self, method: Method, start: Start, count: usize) -> State {
        let x: Vec<Vec3> = FLAT.iter().map(|p| Vec3::new(p[0], p[1], 0.0)).collect();
        let mut state = State::at_rest(x, vec![0.0]);
        state.v = VELOCITY.map(Vec3::from).into();
        let mut work = Workspace::default();
        let h = 0.1 / count as f64;
        for step in 0..count {
            let last = state.angle.clone();
            let membrane = self.membrane.term(&self.memory, &[], f64::INFINITY);
            let bending = self.bending.term(&self.memory, &last, f64::INFINITY);
            let terms: [&dyn Energy; 2] = [&membrane, &bending];
            state = if step == 0 && start == Start::Trapezoid {
                trapezoid(&state, &self.mass, &terms, h, &mut work)
            } else {
                advance(method, &state, &self.mass, &terms, h, &mut work)
            };
            state.angle = self.bending.angles(&state.x, &last);
        }
        state
    }

    fn momentum(&self, v: &[Vec3]) -> Vec3 {
        self.mass.iter().zip(v).map(|(m, v)| v * *m).sum()
    }

    fn angular_momentum(&self, x: &[Vec3], v: &[Vec3]) -> Vec3 {
        self.mass.iter().zip(x.iter().zip(v)).map(|(m, (x, v))| x.cross(v) * *m).sum()
    }

    /// Largest error of a coordinate at 0.1 s [m].
    fn error(state: &State) -> f64 {
        let truth = AT_100_MS.map(Vec3::from);
        state.x.iter().zip(&truth).map(|(x, t)| (x - t).amax()).fold(0.0, f64::max)
    }
}

#[needs_data("reference/hinge_free_flight_convergence.csv")]
#[test]
fn columns_of_the_tumbling_hinge_are_those_of_the_reference() {
    let rows = reference::table("hinge_free_flight_convergence.csv");
    let column = |name: &str| -> Vec<f64> {
        rows.iter().filter(|r| r[0] == name).filter_map(|r| r[2].parse().ok()).collect()
    };
    assert_eq!((column("BE"), column("BDF2")), (EULER_COLUMN.into(), BDF2_COLUMN.into()));
}

/// Property: the same energies give the same errors as an independent integration of them, within 1 % of the error,
/// at every step length; backward Euler has order 0.9 to 1.05.
#[test]
fn tumbling_hinge_has_the_errors_of_the_reference_integrators() {
    let flight = Flight::new();
    for (method, start, column) in
        [(Method::BackwardEuler, Start::Own, EULER_COLUMN), (Method::Bdf2, Start::Trapezoid, BDF2_COLUMN)]
    {
        let errors = STEPS.map(|count| Flight::error(&flight.run(method, start, count)));
        let ratio: Vec<f64> = errors.iter().zip(&column).map(|(e, r)| e / r - 1.0).collect();
        println!(
            "{} ({start:?} start): errors {}, off the column by {}",
            method.name(),
            figures(&errors),
            figures(&ratio)
        );
        assert!(ratio.iter().all(|r| r.abs() <= 0.01));
        if method == Method::BackwardEuler {
            assert!(orders(&errors).iter().all(|o| (0.9..1.05).contains(o)), "{:?}", orders(&errors));
        }
    }
}

/// Property: BDF2 as it is used, started with one step of backward Euler, is of order 1.95 or better.
#[test]
fn tumbling_hinge_shows_order_two_for_bdf2_started_with_backward_euler() {
    let flight = Flight::new();
    let errors = STEPS.map(|count| Flight::error(&flight.run(Method::Bdf2, Start::Own, count)));
    let orders = orders(&errors);
    println!("bdf2 (own start): errors {}, orders {orders:.3?}", figures(&errors));
    assert!(orders[2..].iter().all(|o| *o >= 1.95), "{orders:?}");
}

/// Property: linear momentum is conserved to 1e-12 (steps of 0.25 ms and more); angular momentum drifts with the order
/// of the method.
#[test]
fn tumbling_hinge_keeps_linear_momentum() {
    let flight = Flight::new();
    let before = flight.momentum(&VELOCITY.map(Vec3::from));
    let x: Vec<Vec3> = FLAT.iter().map(|p| Vec3::new(p[0], p[1], 0.0)).collect();
    let turning = flight.angular_momentum(&x, &VELOCITY.map(Vec3::from));
    for (method, bounds) in [(Method::BackwardEuler, [0.9, 1.05]), (Method::Bdf2, [1.9, 2.1])] {
        let ends = [200, 400, 800].map(|count| flight.run(method, Start::Own, count));
        let drift = ends
            .each_ref()
            .map(|end| (flight.angular_momentum(&end.x, &end.v) - turning).norm() / turning.norm());
        // Velocities are differences of positions over the step: below 0.25 ms the rounding of positions dominates.
        let lost = ends.each_ref().map(|end| (flight.momentum(&end.v) - before).norm() / before.norm());
        let orders = orders(&drift);
        println!(
            "{}: momentum {}, angular drift {}, orders {orders:.2?}",
            method.name(),
            figures(&lost),
            figures(&drift)
        );
        assert!(lost[..2].iter().all(|l| *l <= 1e-12));
        assert!(orders.iter().all(|o| (bounds[0]..bounds[1]).contains(o)));
    }
}
