//! A single hinge against 50-digit differentiation of its energy (`r04_hinge.py`).

use crate::hinge_hessian::hinge_hessian;
use crate::reference;
use crate::sheet::SheetModels;
use crease_chart::TestSheet;
use crease_geometry::math::{Vec2, Vec3};
use crease_geometry::mesh::{hinge_angle, hinge_gradient};
use crease_solver::energy::Energy;
use nalgebra::DMatrix;
use test_attributes::needs_data;

/// One pose: points, and E = k/2 (theta - 0.25)² with its derivatives to 50 digits.
struct Pose {
    name: String,
    x: [Vec3; 4],
    theta: f64,
    energy: f64,
    gradient: Vec<f64>,
    /// Increasing [N/m].
    eigenvalues: Vec<f64>,
}

const REST_ANGLE: f64 = 0.25;
/// B l² / (A1 + A2) for B = 1e-5, l = 1, A1 + A2 = 0.65 [N·m].
const STIFFNESS: f64 = 1e-5 / 0.65;

fn points(flat: &[f64]) -> [Vec3; 4] {
    std::array::from_fn(|i| Vec3::new(flat[3 * i], flat[3 * i + 1], flat[3 * i + 2]))
}

/// Two poses of `hinge_reference.json`, for clones without that file.
fn embedded_poses() -> Vec<Pose> {
    NAILED
        .into_iter()
        .map(|(name, x, theta, energy, gradient, eigenvalues)| Pose {
            name: name.into(),
            x: points(&x),
            theta,
            energy,
            gradient: gradient.into(),
            eigenvalues: eigenvalues.into(),
        })
        .collect()
}

type Row = (&'static str, [f64; 12], f64, f64, [f64; 12], [f64; 12]);
const NAILED: [Row; 2] = [
    (
        "theta=-2",
        [0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.3, 0.8, 0.0, 0.6, 0.2080734182735712, -0.45464871341284085],
        2.0,
        2.355769230769231e-05,
        [
            0.0,
            -1.958486765470699e-05,
            1.4594529674369242e-05,
            0.0,
            -2.9377301482060484e-05,
            -3.348590103830754e-06,
            0.0,
            0.0,
            -3.365384615384615e-05,
            0.0,
            4.8962169136767475e-05,
            2.2407906583307666e-05,
        ],
        [
            -0.00012615550358398286,
            -9.885724966374693e-05,
            -5.2155619399299013e-05,
            -4.262470868855208e-05,
            0.0,
            0.0,
            0.0,
            0.0,
            4.0577572615187323e-05,
            7.092002619124365e-05,
            0.0001184071799265687,
            0.00020668233761706695,
        ],
    ),
    (
        "generic",
        [0.013, -0.021, 0.034, 0.97, 0.055, -0.028, 0.28, 0.71, 0.19, 0.65, -0.33, 0.41],
        -1.1023886071223683,
        1.4068884189802919e-05,
        [
            -1.3022183911956535e-06,
            -6.719626848833641e-06,
            -2.833733291750963e-05,
            -3.448624492146176e-07,
            -1.5289815273006828e-05,
            -2.4065472978175937e-05,
            2.325232405116954e-06,
            -6.744385838242442e-06,
            2.762377561274999e-05,
            -6.78151564706683e-07,
            2.8753827960082914e-05,
            2.4779030282935577e-05,
        ],
        [
            -0.00011146098684242648,
            -6.375753621038337e-05,
            -3.534784975370481e-05,
            -2.128383590862895e-05,
            0.0,
            0.0,
            0.0,
            0.0,
            5.242472386531538e-05,
            6.938391919414044e-05,
            8.889729860355777e-05,
            0.00016039153042573354,
        ],
    ),
];

/// Poses of the reference file, which has more of them.
fn reference_poses() -> Vec<Pose> {
    let file = reference::json("hinge_reference.json");
    let list = |v: &serde_json::Value| -> Vec<f64> {
        v.as_array().into_iter().flatten().filter_map(serde_json::Value::as_f64).collect()
    };
    let poses = file["poses"].as_array().into_iter().flatten().map(|p| Pose {
        name: p["name"].as_str().unwrap_or_default().into(),
        x: points(&list(&p["X"])),
        theta: p["theta"].as_f64().unwrap_or(f64::NAN),
        energy: p["energy"].as_f64().unwrap_or(f64::NAN),
        gradient: list(&p["dE_dX"]),
        eigenvalues: list(&p["hess_eigs"]),
    });
    poses.collect()
}

/// Largest |a - b| over the largest |b|.
fn relative(a: &[f64], b: &[f64]) -> f64 {
    assert_eq!(a.len(), b.len());
    let scale = b.iter().fold(0.0, |s: f64, b| s.max(b.abs()));
    a.iter().zip(b).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max) / scale
}

fn flatten(g: &[Vec3; 4]) -> Vec<f64> {
    g.iter().flat_map(|v| [v.x, v.y, v.z]).collect()
}

/// k g g^T + k (theta - rest) d2theta.
fn full_hessian(x: &[Vec3; 4]) -> DMatrix<f64> {
    let g = hinge_gradient(x).expect("the pose is not degenerate");
    let second = hinge_hessian(x).expect("the pose is not degenerate");
    let torque = STIFFNESS * (hinge_angle(x) - REST_ANGLE);
    DMatrix::from_fn(12, 12, |i, j| {
        STIFFNESS * g[i / 3][i % 3] * g[j / 3][j % 3] + torque * second[i / 3][j / 3][(i % 3, j % 3)]
    })
}

/// Property: energy and gradient of a hinge to 1e-10 of their size, in every reference pose.
fn check_energy_and_gradient(poses: &[Pose]) {
    let mut worst = [0.0f64; 3];
    for pose in poses {
        let strain = hinge_angle(&pose.x) - REST_ANGLE;
        let energy = 0.5 * STIFFNESS * strain * strain;
        let gradient = hinge_gradient(&pose.x).expect("the pose is not degenerate");
        let gradient = flatten(&gradient.map(|g| g * (STIFFNESS * strain)));
        let errors = [
            (strain + REST_ANGLE - pose.theta).abs(),
            (energy / pose.energy - 1.0).abs(),
            relative(&gradient, &pose.gradient),
        ];
        assert!(errors.iter().all(|e| *e <= 1e-10), "{}: {errors:?}", pose.name);
        worst = std::array::from_fn(|k| worst[k].max(errors[k]));
    }
    println!("hinge: angle {:.1e} rad, energy {:.1e}, gradient {:.1e}", worst[0], worst[1], worst[2]);
}

/// Property: the full Hessian has the reference's twelve eigenvalues to 1e-10 of the largest, four of them negative
/// (which is why the solver uses a Gauss-Newton Hessian).
fn check_eigenvalues(poses: &[Pose]) {
    let mut worst: f64 = 0.0;
    for pose in poses {
        let mut eigenvalues: Vec<f64> =
            full_hessian(&pose.x).symmetric_eigenvalues().iter().copied().collect();
        eigenvalues.sort_by(f64::total_cmp);
        let error = relative(&eigenvalues, &pose.eigenvalues);
        assert!(error <= 1e-10, "{}: {error:e}", pose.name);
        assert!(eigenvalues[3] < 0.0 && eigenvalues[4].abs() < 1e-10 * eigenvalues[11], "{}", pose.name);
        worst = worst.max(error);
    }
    println!("hinge: Hessian eigenvalues {worst:.1e}");
}

/// Property: the bending term of the solver, on a lone hinge of the same stiffness, has the same energy and forces.
/// (On a lone hinge the face operator is the hinge energy times a constant, which the stiffness ratio compensates.)
fn check_bending_term(poses: &[Pose]) {
    let flat = [[0.0, 0.0], [1.0, 0.0], [0.3, 0.8], [0.6, -0.5]].map(|p| Vec2::new(p[0], p[1]));
    let sheet = TestSheet { flat: flat.into(), triangles: vec![[0, 1, 2], [1, 0, 3]] };
    let bending = sheet.bending(1e-5);
    let mut memory = sheet.memory();
    let mut worst: f64 = 0.0;
    for pose in poses {
        let angle = bending.angles(&pose.x, &[]);
        memory.rest_angle[0] = REST_ANGLE;
        memory.stiffness_ratio[0] = 1.0;
        let unit = bending.term(&memory, &angle, f64::INFINITY).torques(&pose.x)[0] / (angle[0] - REST_ANGLE);
        memory.stiffness_ratio[0] = STIFFNESS / unit;
        let term = bending.term(&memory, &angle, f64::INFINITY);
        let mut gradient = [Vec3::zeros(); 4];
        term.add_gradient(&pose.x, &mut gradient);
        let errors =
            [(term.value(&pose.x) / pose.energy - 1.0).abs(), relative(&flatten(&gradient), &pose.gradient)];
        assert!(errors.iter().all(|e| *e <= 1e-10), "{}: {errors:?}", pose.name);
        worst = errors.iter().fold(worst, |w, e| w.max(*e));
    }
    println!("bending term of a lone hinge: energy and gradient {worst:.1e}");
}

#[test]
fn hinge_energy_and_gradient_match_fifty_digits() {
    check_energy_and_gradient(&embedded_poses());
}

#[test]
fn hinge_hessian_eigenvalues_match_fifty_digits() {
    check_eigenvalues(&embedded_poses());
}

#[test]
fn bending_term_of_a_lone_hinge_matches_fifty_digits() {
    check_bending_term(&embedded_poses());
}

#[needs_data("reference/hinge_reference.json")]
#[test]
fn all_reference_poses_match_fifty_digits() {
    let poses = reference_poses();
    assert_eq!(poses.len(), 6);
    check_energy_and_gradient(&poses);
    check_eigenvalues(&poses);
    check_bending_term(&poses);
}
