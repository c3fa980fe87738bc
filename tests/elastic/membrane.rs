//! Stretch and shear: patch tests, the area factor, a hanging strip, extension on the bias.

use crate::hessian_shift::HessianShift;
use crate::reference::figures;
use crate::rest::{balance, forces, residual};
use crate::sheet::{SheetModels, quads, spaced};
use crease_chart::TestSheet;
use crease_geometry::math::{Vec2, Vec3};
use crease_geometry::mesh::PointIndex;
use crease_solver::energy::{Energy, Gravity, Membrane};
use crease_solver::sim::NewtonOptions;
use nalgebra::{Matrix3x2, Rotation3};

const NEWTON: NewtonOptions = NewtonOptions {
    displacement_tol: 1e-14,
    decrement_tol: 0.0,
    rel_decrement_tol: 0.0,
    max_iterations: 100,
};

fn undamped<'a>(membrane: &'a Membrane, sheet: &TestSheet) -> crease_solver::energy::MembraneTerm<'a> {
    membrane.term(&sheet.memory(), &[], f64::INFINITY)
}

/// Returns whether each point is on the border.
fn border(sheet: &TestSheet) -> Vec<bool> {
    let mut on_border = vec![false; sheet.flat.len()];
    for loops in boundary(sheet) {
        loops.iter().for_each(|p| on_border[p.at()] = true);
    }
    on_border
}

fn boundary(sheet: &TestSheet) -> Vec<Vec<PointIndex>> {
    let triangles: Vec<_> = sheet.triangles.iter().map(|t| t.map(PointIndex)).collect();
    sheet.topology().boundary_loops(&triangles)
}

/// Puts a point into triangle `f`, a hundredth of an edge from the middle of its first edge: one cap-shaped and two
/// needle-shaped slivers.
fn pierce(sheet: &mut TestSheet, f: usize) {
    let [a, b, c] = sheet.triangles[f];
    let [p, q, r] = [a, b, c].map(|i| sheet.flat[i as usize]);
    let middle = (p + q) / 2.0;
    let new = sheet.flat.len() as u32;
    sheet.flat.push(middle + (r - middle) * 0.01);
    sheet.triangles[f] = [a, b, new];
    sheet.triangles.extend([[b, c, new], [c, a, new]]);
}

/// Meshes for patch tests with edges of about 0.1 m: regular, alternating, irregular, with slivers of 1:100.
fn meshes() -> Vec<(&'static str, TestSheet)> {
    let (xs, ys) = (spaced(0.0, 0.8, 8), spaced(0.0, 0.5, 5));
    let regular = quads(&xs, &ys, false);
    let mut irregular = regular.clone();
    let inner: Vec<usize> =
        (0..irregular.flat.len()).zip(border(&regular)).filter(|(_, b)| !b).map(|(i, _)| i).collect();
    for i in inner {
        let phase = i as f64;
        irregular.flat[i] += Vec2::new((12.9 * phase).sin(), (7.3 * phase).cos()) * 0.025;
    }
    let thin = |at: &[f64], by: f64| {
        let mut lines = at.to_vec();
        lines.insert(3, lines[2] + by);
        lines
    };
    let mut slivers = quads(&thin(&xs, 1e-3), &thin(&ys, 1e-3), false);
    for f in [3, 20, 47] {
        pierce(&mut slivers, f);
    }
    vec![
        ("one diagonal", regular),
        ("union jack", quads(&xs, &ys, true)),
        ("irregular", irregular),
        ("slivers 1:100", slivers),
    ]
}

/// Deformation gradients without compression in any direction (shear below the geometric mean of the tensions, as the
/// sheet would wrinkle otherwise), the last two rotated in space.
fn gradients() -> [Matrix3x2<f64>; 3] {
    let turn = Rotation3::new(Vec3::new(0.7, -0.4, 1.1));
    [
        Matrix3x2::new(1.01, 0.0, 0.0, 1.0, 0.0, 0.0),
        turn * Matrix3x2::new(1.02, 0.03, -0.01, 1.015, 0.0, 0.0),
        turn * Matrix3x2::new(1.05, 0.0, 0.06, 1.02, 0.0, 0.0),
    ]
}

const STIFFNESS: [f64; 3] = [1000.0, 800.0, 40.0];
const EDGE: f64 = 0.1;

/// First Piola stress of the membrane, from its energy density [N/m].
fn stress(f: &Matrix3x2<f64>) -> Matrix3x2<f64> {
    let (u, v) = (f.column(0).into_owned(), f.column(1).into_owned());
    let shear = STIFFNESS[2] * u.dot(&v);
    Matrix3x2::from_columns(&[
        u * (STIFFNESS[0] * (1.0 - 1.0 / u.norm())) + v * shear,
        v * (STIFFNESS[1] * (1.0 - 1.0 / v.norm())) + u * shear,
    ])
}

/// Property: with an affine deformation of the border the interior follows it, to 1e-10 of an edge, without forces
/// (1e-12 Y l), on any mesh; the reaction at the border is the stress times its normal.
#[test]
fn patch_of_constant_strain() {
    for (name, sheet) in meshes() {
        let membrane = sheet.membrane(STIFFNESS);
        let term = undamped(&membrane, &sheet);
        let fixed = border(&sheet);
        let mut worst = [0.0f64; 3];
        for f in gradients() {
            let affine: Vec<Vec3> = sheet.flat.iter().map(|p| f * p).collect();
            let exact = residual(&[&term], &affine, &fixed) / (STIFFNESS[0] * EDGE);
            let mut x = affine.clone();
            for (i, (x, _)) in x.iter_mut().zip(&fixed).enumerate().filter(|(_, (_, fixed))| !**fixed) {
                let phase = i as f64;
                *x += Vec3::new((3.1 * phase).sin(), (5.7 * phase).cos(), (1.3 * phase).sin()) * 2e-4;
            }
            let report = balance(&[&term], &mut x, &fixed, NEWTON);
            assert!(report.converged, "{name}: {report:?}");
            let moved = x.iter().zip(&affine).map(|(x, a)| (x - a).norm()).fold(0.0, f64::max) / EDGE;
            let left = residual(&[&term], &x, &fixed) / (STIFFNESS[0] * EDGE);
            worst = [
                worst[0].max(moved),
                worst[1].max(exact).max(left),
                worst[2].max(reaction_error(&sheet, &term, &x, &f)),
            ];
        }
        println!(
            "{name}: interior off by {:.1e} l, force {:.1e} Y l, reaction off by {:.1e} Y l",
            worst[0], worst[1], worst[2]
        );
        assert!(worst[0] <= 1e-10 && worst[1] <= 1e-12 && worst[2] <= 1e-12, "{name}: {worst:?}");
    }
}

/// Largest difference between the reaction at a border point and the stress on its half edges, over Y l.
fn reaction_error(sheet: &TestSheet, term: &dyn Energy, x: &[Vec3], f: &Matrix3x2<f64>) -> f64 {
    let mut expected = vec![Vec3::zeros(); x.len()];
    for loops in boundary(sheet) {
        for (k, a) in loops.iter().enumerate() {
            let b = loops[(k + 1) % loops.len()];
            let edge = sheet.flat[b.at()] - sheet.flat[a.at()];
            let half = stress(f) * Vec2::new(edge.y, -edge.x) / 2.0;
            expected[a.at()] += half;
            expected[b.at()] += half;
        }
    }
    let reactions = forces(&[term], x);
    let off = reactions.iter().zip(&expected).zip(border(sheet)).filter(|(_, on_border)| *on_border);
    off.map(|((a, b), _)| (a - b).norm()).fold(0.0, f64::max) / (STIFFNESS[0] * EDGE)
}

/// Property: the stiffness does not depend on the mesh: the same patch with elements half as long has the same force,
/// to 1e-10. (The original scaling of Baraff and Witkin would give half.)
#[test]
fn force_does_not_depend_on_the_element_size() {
    let pull = |count: usize| {
        let sheet = quads(&spaced(0.0, 0.8, 8 * count), &spaced(0.0, 0.5, 5 * count), false);
        let membrane = sheet.membrane(STIFFNESS);
        let x: Vec<Vec3> = sheet.flat.iter().map(|p| gradients()[0] * p).collect();
        let force = forces(&[&undamped(&membrane, &sheet)], &x);
        force.iter().zip(&sheet.flat).filter(|(_, p)| p.x > 0.8 - 1e-9).map(|(f, _)| f.x).sum::<f64>()
    };
    let (coarse, fine) = (pull(1), pull(2));
    println!("force at h {coarse:.12} N, at h/2 {fine:.12} N, Y 0.01 w {:.12} N", 1000.0 * 0.01 * 0.5);
    assert!((fine / coarse - 1.0).abs() <= 1e-10);
    assert!((coarse / 5.0 - 1.0).abs() <= 1e-10);
}

/// Property: a strip hanging under its own weight lengthens by a L / 2, a = rho g L / Y, to 1e-6 (linear law; exact at
/// every point, when half of an element's mass hangs at the tip).
#[test]
fn hanging_strip_lengthens_by_half_its_weight_over_its_stiffness() {
    let (length, along, across) = (0.5, 10, 2);
    let h = length / along as f64;
    let sheet = quads(&spaced(0.0, length, along), &spaced(0.0, h * across as f64, across), false);
    let stretch = 200.0;
    let membrane = sheet.membrane([stretch, stretch, 0.5 * stretch]);
    let fixed: Vec<bool> = sheet.flat.iter().map(|p| p.x < 1e-9).collect();
    let mut worst: f64 = 0.0;
    for a in [1e-3, 1e-2, 0.1, 0.3] {
        let density = a * stretch / (9.81 * length);
        // A quarter of each quad to each of its corners: a third of each triangle would load the two tip corners by one
        // and two thirds, and rotate the tip.
        let half = |at: f64, end: f64| if at < 1e-9 || at > end - 1e-9 { 0.5 } else { 1.0 };
        let mass: Vec<f64> = sheet
            .flat
            .iter()
            .map(|p| density * h * h * half(p.x, length) * half(p.y, h * across as f64))
            .collect();
        let weight = Gravity { mass: &mass, acceleration: Vec3::new(9.81, 0.0, 0.0) };
        let mut x = sheet.laid();
        let shift = HessianShift(1e-6 * stretch);
        balance(&[&undamped(&membrane, &sheet), &weight, &shift], &mut x, &fixed, NEWTON);
        for (x, p) in x.iter().zip(&sheet.flat).filter(|(_, p)| p.x > 1e-9) {
            let s = p.x / length;
            worst = worst.max(((x.x - p.x) / (a * length * (s - s * s / 2.0)) - 1.0).abs());
        }
    }
    println!("hanging strip: u(x) off by {worst:.1e} of itself");
    assert!(worst <= 1e-6);
}

/// Stretch and width of a patch cut at `degrees` to the warp under `tension` [N/m] along its length.
fn extend(degrees: f64, tension: f64) -> [f64; 2] {
    let (count, side) = (4, 0.1);
    let laid = quads(&spaced(0.0, side, count), &spaced(0.0, side, count), false);
    let (s, c) = f64::to_radians(degrees).sin_cos();
    let flat = laid.flat.iter().map(|p| Vec2::new(c * p.x + s * p.y, c * p.y - s * p.x)).collect();
    let cut = TestSheet { flat, triangles: laid.triangles.clone() };
    let membrane = cut.membrane(STIFFNESS);
    // A dead load on both ends, written as weights along the length.
    let width = side / count as f64;
    let load: Vec<f64> = laid
        .flat
        .iter()
        .map(|p| {
            let along = if p.y < 1e-9 || p.y > side - 1e-9 { 0.5 } else { 1.0 };
            let end = if p.x < 1e-9 {
                -1.0
            } else if p.x > side - 1e-9 {
                1.0
            } else {
                0.0
            };
            tension * width * along * end
        })
        .collect();
    let pull = Gravity { mass: &load, acceleration: Vec3::x() };
    let mut fixed = vec![false; laid.flat.len()];
    fixed[0] = true;
    let mut x = laid.laid();
    let newton = NewtonOptions {
        displacement_tol: 1e-13,
        decrement_tol: 0.0,
        rel_decrement_tol: 0.0,
        max_iterations: 400,
    };
    balance(&[&undamped(&membrane, &cut), &pull, &HessianShift(1e-5)], &mut x, &fixed, newton);
    let last = x.len() - 1;
    let along = x[last - count].x - x[0].x;
    let across = x[count].y - x[0].y;
    [along / side, across / side]
}

/// Property: extension on the bias agrees with the closed form (`bias_extension.csv`), small-strain modulus and stretch
/// under 5 N/m within 1e-3.
#[test]
fn extension_on_the_bias_matches_the_law() {
    let modulus = 1e-3 / (extend(45.0, 1e-3)[0] - 1.0);
    println!("bias modulus {modulus:.4} N/m (146.7890)");
    assert!((modulus / 146.788_991 - 1.0).abs() <= 1e-3);
    for (degrees, stretch, width) in [
        (15.0, 1.012_006_316, 0.992_654_254_5),
        (30.0, 1.025_660_852, 0.978_700_426_1),
        (45.0, 1.032_475_104, 0.972_078_287_3),
        (60.0, 1.026_247_957, 0.978_739_971_2),
    ] {
        let [along, across] = extend(degrees, 5.0);
        // Relative to the strain, not to the length.
        let off = [(along - 1.0) / (stretch - 1.0) - 1.0, (across - 1.0) / (width - 1.0) - 1.0];
        println!(
            "{degrees} degrees: stretch {along:.9}, width {across:.9}, strains off by {}",
            figures(&off)
        );
        assert!(off.iter().all(|o| o.abs() <= 1e-3));
    }
}
