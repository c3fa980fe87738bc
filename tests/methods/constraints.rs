//! Fixed points, dependent constraints, and the unconverged strain of vertex block descent.

use crease_chart::comparison::{METHODS, VERTEX_BLOCK_DESCENT, is_visual};
use crease_chart::scenes;
use crease_chart::scenes::{SceneSetting, Swing};
use crease_geometry::math::{Vec2, Vec3};
use crease_model::garment::RestState;
use crease_solver::contact::Contact;
use crease_solver::energy::{Energy, Gravity, Membrane, TargetSpring, TargetSprings};
use crease_solver::sim::{Inertia, Method, NewtonOptions, Problem, Workspace};

/// One row of `count` quads of `side` [m] along x, points two by two.
fn strip(count: usize, side: f64) -> (Vec<Vec2>, Vec<[u32; 3]>) {
    let flat = (0..=count).flat_map(|i| [0.0, side].map(|y| Vec2::new(i as f64 * side, y))).collect();
    let triangles = (0..count as u32)
        .flat_map(|i| {
            let [a, b, c, d] = [2 * i, 2 * i + 2, 2 * i + 3, 2 * i + 1];
            [[a, b, c], [a, c, d]]
        })
        .collect();
    (flat, triangles)
}

fn membrane(flat: &[Vec2], triangles: &[[u32; 3]], stretch: f64) -> Membrane {
    let material: Vec<[Vec2; 3]> = triangles.iter().map(|t| t.map(|p| flat[p as usize])).collect();
    Membrane::from_parts(triangles, &material, [stretch, stretch, 0.5 * stretch], 0.0)
}

const EXACT: NewtonOptions = NewtonOptions {
    displacement_tol: 1e-14,
    decrement_tol: 0.0,
    rel_decrement_tol: 0.0,
    max_iterations: 100,
};

/// Property: a strip pinned at 1.1 of its length bears Y 0.1 per width and stores Y/2 0.01 per area, to 1e-8.
#[test]
fn a_strip_pinned_too_long_bears_the_tension() {
    let (flat, triangles) = strip(10, 0.01);
    let membrane = membrane(&flat, &triangles, 500.0);
    let memory = RestState::flat(flat.len(), triangles.len());
    let term = membrane.term(&memory, &[], f64::INFINITY);
    let held: Vec<bool> = (0..flat.len()).map(|p| p < 2 || p >= flat.len() - 2).collect();
    let mut x: Vec<Vec3> = flat.iter().map(|p| Vec3::new(p.x, p.y, 0.0)).collect();
    x.iter_mut().rev().take(2).for_each(|x| x.x *= 1.1);
    let problem = Problem { inertia: None, terms: &[&term], fixed: &held, predicted_positions: None };
    problem.solve(&mut x, &mut Contact::none(flat.len()), &EXACT, &mut Workspace::default());
    let mut gradient = vec![Vec3::zeros(); x.len()];
    term.add_gradient(&x, &mut gradient);
    let force: f64 = gradient[..2].iter().map(|g| -g.x).sum();
    let energy = term.value(&x);
    println!("tension {force:.12} N (0.5), energy {energy:.12} J (0.0025)");
    assert!((force / (500.0 * 0.1 * 0.01) - 1.0).abs() < 1e-8);
    assert!((energy / (0.5 * 500.0 * 0.01 * 0.1 * 0.01) - 1.0).abs() < 1e-8);
}

/// Property: a fixed point stays bit-identical under any force, and a point held by two parallel springs moves the
/// cloth like one of twice the stiffness: dependent constraints count once.
#[test]
fn held_points_stay_and_dependent_constraints_count_once() {
    let (flat, triangles) = strip(4, 0.05);
    let membrane = membrane(&flat, &triangles, 300.0);
    let memory = RestState::flat(flat.len(), triangles.len());
    let mass = vec![1e-3; flat.len()];
    let gravity = Gravity { mass: &mass, acceleration: Vec3::new(0.0, -9.81, 0.0) };
    let start: Vec<Vec3> = flat.iter().map(|p| Vec3::new(p.x, 0.0, p.y)).collect();
    let held: Vec<bool> = (0..flat.len()).map(|p| p < 3).collect();
    let solve = |guides: &[TargetSpring]| {
        let term = membrane.term(&memory, &[], f64::INFINITY);
        let guides = TargetSprings(guides);
        let terms: [&dyn Energy; 3] = [&term, &gravity, &guides];
        let inertia = Some(Inertia { mass: &mass, inertial: &start, effective_dt: 0.05 });
        let problem = Problem { inertia, terms: &terms, fixed: &held, predicted_positions: None };
        let mut x = start.clone();
        problem.solve(&mut x, &mut Contact::none(flat.len()), &EXACT, &mut Workspace::default());
        x
    };
    let wall = |stiffness: f64| TargetSpring {
        point: 9,
        target: start[9] + Vec3::new(0.0, -0.01, 0.0),
        normal: Vec3::y(),
        stiffness,
        tangential_stiffness: 0.0,
    };
    let (twice, once) = (solve(&[wall(2e4), wall(2e4)]), solve(&[wall(4e4)]));
    let apart = twice.iter().zip(&once).map(|(a, b)| (a - b).norm()).fold(0.0, f64::max);
    println!("two parallel constraints and one: {apart:.1e} m apart");
    assert!(apart < 1e-12);
    assert!((0..3).all(|p| twice[p] == start[p]));
    // A fixed point with a spring stays fixed.
    let pinned = solve(&[TargetSpring { point: 1, ..wall(1e6) }]);
    assert_eq!(pinned[1], start[1]);
}

/// Property: the elongation of a hanging strip is off by more than 2 % with vertex block descent, which is labelled
/// visual, and not with converged steps.
#[test]
fn vertex_block_descent_overstretches_and_is_labelled_visual() {
    // It starts straight down at its rest length: the elongation in equilibrium is rho g L / 2 Y.
    let hanging = Swing { degrees: 0.0, name: "hanging", ..Swing::SWING_30 };
    let expected = 0.2 * 9.81 * 0.5 / 200.0 / 2.0;
    let elongation = |method| {
        let setting = SceneSetting::fixed(method, 1.0 / 60.0, 1e-9);
        let outcome = scenes::run(&hanging, &setting).expect("runs");
        let low = outcome.x.iter().map(|x| x.y).fold(0.0, f64::min);
        -low / 0.5 - 1.0
    };
    for &method in METHODS {
        let found = elongation(method);
        println!("{}: elongation {:.4} % (at rest {:.4} %)", method.name(), 100.0 * found, 100.0 * expected);
    }
    let off = |method| (elongation(method) / expected - 1.0).abs();
    assert!(off(Method::BackwardEuler) < 0.02);
    assert!(is_visual(VERTEX_BLOCK_DESCENT));
}
