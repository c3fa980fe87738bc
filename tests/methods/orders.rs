//! Orders of convergence and stiff decay of every integrator, on oscillators with closed-form solutions.

use crate::reference::figures;
use crease_chart::comparison::{BDF2_ONCE, METHODS, is_visual};
use crease_geometry::math::Vec3;
use crease_solver::contact::Contact;
use crease_solver::energy::{Energy, TargetSpring, TargetSprings};
use crease_solver::sim::{
    Inertia, InnerSolver, Method, NewtonOptions, PreviousState, Problem, StageSolve, State, Workspace,
};
use std::f64::consts::TAU;

/// A linear spring of `stiffness` [N/m] to the origin, for 1 kg.
fn spring(stiffness: f64) -> [TargetSpring; 1] {
    [TargetSpring::isotropic(0, Vec3::zeros(), stiffness)]
}

/// One step of `h` seconds by `method`, all its parts.
fn advance(method: Method, state: &State, terms: &[&dyn Energy], h: f64) -> State {
    let mut x = state.x.clone();
    let mut stage = method.stage(state, h);
    for part in 0..method.stage_times().len() {
        if part > 0 {
            stage = method.later_stage(state, h, &x);
        }
        let inertial = stage.inertial();
        let held = [false];
        let problem = Problem {
            inertia: Some(Inertia { mass: &[1.0], inertial: &inertial, effective_dt: stage.effective_dt }),
            terms,
            fixed: &held,
            predicted_positions: None,
        };
        let options = NewtonOptions {
            displacement_tol: 1e-13,
            decrement_tol: 0.0,
            rel_decrement_tol: 0.0,
            max_iterations: 30,
        };
        let (contact, work) = (&mut Contact::none(1), &mut Workspace::default());
        match method.solver() {
            InnerSolver::Newton => problem.solve(&mut x, contact, &options, work),
            InnerSolver::FixedWork(solve) => {
                let problem = &problem;
                solve(StageSolve { problem, contact, options, min_diffuse_tol: 0.0, work }, &mut x)
            }
        };
    }
    let v = stage.velocity(&x);
    let previous = Some(PreviousState { dt: h, x: state.x.clone(), v: state.v.clone() });
    State { time: state.time + h, x, v, angle: Vec::new(), previous }
}

/// Error of x + i v / omega after one period in `count` steps.
fn error(method: Method, count: usize) -> f64 {
    let mut state = State::at_rest(vec![Vec3::x()], Vec::new());
    let spring = spring(TAU * TAU);
    for _ in 0..count {
        state = advance(method, &state, &[&TargetSprings(&spring)], 1.0 / count as f64);
    }
    (state.x[0].x - 1.0).hypot(state.v[0].x / TAU)
}

/// Property: on an oscillator of 160 to 640 steps a period backward Euler has order 0.9 to 1.05, BDF2 and the
/// two-stage method at least 1.95; one iteration is exact for a linear spring and changes nothing. (Vertex block
/// descent is exact for a single point, too: its error is the coupling between points.)
#[test]
fn every_method_has_its_order() {
    for &method in METHODS.iter().filter(|m| !is_visual(**m)) {
        let errors = [160, 320, 640].map(|count| error(method, count));
        let orders = [(errors[0] / errors[1]).log2(), (errors[1] / errors[2]).log2()];
        println!("{}: errors {}, orders {orders:.3?}", method.name(), figures(&errors));
        let bounds = if method.order() == 1 { [0.9, 1.05] } else { [1.95, 2.05] };
        assert!(orders.iter().all(|o| (bounds[0]..bounds[1]).contains(o)), "{}: {orders:?}", method.name());
    }
}

/// Property: stiff modes decay: on a spring of omega h = 100 the amplification per step is that of theory, to 1 %:
/// backward Euler 0.0100, BDF2 0.0781 (`numerical_damping.csv`), the two-stage method, as TR-BDF2, |R(100 i)| =
/// 0.0481 with R(z) = (1 + (1 - 2 g) z) / (1 - g z)².
#[test]
fn stiff_modes_decay() {
    let h: f64 = 0.01;
    let spring = spring((100.0 / h).powi(2));
    for &method in METHODS.iter().filter(|m| !is_visual(**m)) {
        let mut state = State::at_rest(vec![Vec3::x()], Vec::new());
        let mut sizes = vec![1.0];
        for _ in 0..60 {
            state = advance(method, &state, &[&TargetSprings(&spring)], h);
            sizes.push(state.x[0].x.hypot(state.v[0].x * h / 100.0));
        }
        // BDF2 has two roots of nearly one size here, which beat: over many steps.
        let per_step = (sizes[60] / sizes[20]).powf(1.0 / 40.0);
        let g = 1.0 - std::f64::consts::FRAC_1_SQRT_2;
        let z = nalgebra::Complex::new(0.0, 100.0);
        let exact = match method {
            Method::Sdirk2 => ((z * (1.0 - 2.0 * g) + 1.0) / ((-z * g + 1.0) * (-z * g + 1.0))).norm(),
            _ if [Method::Bdf2, BDF2_ONCE].contains(&method) => 0.078_1,
            _ => 1.0 / (1.0 + z.norm_sqr()).sqrt(),
        };
        println!("{}: keeps {per_step:.6} of a stiff mode per step ({exact:.6})", method.name());
        assert!((per_step / exact - 1.0).abs() < 1e-2, "{per_step} {exact}");
    }
}

/// Property: the two-stage method is exact in free fall, from the first step on.
#[test]
fn the_two_stage_method_falls_exactly() {
    let weight = crease_solver::energy::Gravity { mass: &[1.0], acceleration: Vec3::new(0.0, -9.81, 0.0) };
    let mut state = State::at_rest(vec![Vec3::zeros()], Vec::new());
    for _ in 0..50 {
        state = advance(Method::Sdirk2, &state, &[&weight], 0.02);
    }
    println!("fallen {:.12} m of 4.905", -state.x[0].y);
    assert!((state.x[0].y + 4.905).abs() < 1e-11);
}
