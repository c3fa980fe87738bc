//! The exact Hessian of the hinge angle: the gradient of `crease_geometry::mesh::hinge_gradient` differentiated once more. The
//! solver uses a Gauss-Newton Hessian instead.

use crease_geometry::math::{Mat3, Vec3};
use crease_geometry::mesh::hinge_gradient;

/// Hessian of the angle [rad/m²] as 4 x 4 blocks; `None` where a wing has no area.
pub fn hinge_hessian(x: &[Vec3; 4]) -> Option<[[Mat3; 4]; 4]> {
    let g = hinge_gradient(x)?;
    let e = x[1] - x[0];
    let (a, b) = (x[2] - x[0], x[3] - x[0]);
    let (na, nb) = (e.cross(&a), b.cross(&e));
    let ee = e.norm_squared();
    let length = ee.sqrt();
    let unit = e / length;
    let inverse = |n: &Vec3| {
        // n / |n|² and its derivative by n.
        let nn = n.norm_squared();
        (n / nn, (Mat3::identity() - 2.0 * n * n.transpose() / nn) / nn)
    };
    let (fa, dfa) = inverse(&na);
    let (fb, dfb) = inverse(&nb);
    let cross = |v: &Vec3| v.cross_matrix();
    // g2 = -l f(nA), nA = e x a ; g3 = -l f(nB), nB = b x e
    let g2_a = -length * dfa * cross(&e);
    let g2_e = -fa * unit.transpose() + length * dfa * cross(&a);
    let g3_b = length * dfb * cross(&e);
    let g3_e = -fb * unit.transpose() - length * dfb * cross(&b);
    let (s2, s3) = (a.dot(&e) / ee, b.dot(&e) / ee);
    let (s2_e, s3_e) = ((a - 2.0 * s2 * e) / ee, (b - 2.0 * s3 * e) / ee);
    // g1 = -s2 g2 - s3 g3
    let g1_a = -g[2] * (e / ee).transpose() - s2 * g2_a;
    let g1_b = -g[3] * (e / ee).transpose() - s3 * g3_b;
    let g1_e = -g[2] * s2_e.transpose() - s2 * g2_e - g[3] * s3_e.transpose() - s3 * g3_e;
    let zero = Mat3::zeros();
    let rows = [
        [-g1_a - g2_a, -g1_b - g3_b, -g1_e - g2_e - g3_e],
        [g1_a, g1_b, g1_e],
        [g2_a, zero, g2_e],
        [zero, g3_b, g3_e],
    ];
    Some(rows.map(|[by_a, by_b, by_e]| [-(by_a + by_b + by_e), by_e, by_a, by_b]))
}

/// A generic pose: no two edges are equal or parallel.
fn generic() -> [Vec3; 4] {
    [
        Vec3::new(0.013, -0.021, 0.034),
        Vec3::new(0.97, 0.055, -0.028),
        Vec3::new(0.28, 0.71, 0.19),
        Vec3::new(0.65, -0.33, 0.41),
    ]
}

#[test]
fn hessian_is_symmetric_and_matches_differences_of_the_gradient() {
    let x = generic();
    let h = hinge_hessian(&x).expect("the pose is not degenerate");
    let eps = 1e-6;
    for j in 0..4 {
        for c in 0..3 {
            let (mut up, mut down) = (x, x);
            up[j][c] += eps;
            down[j][c] -= eps;
            let (gu, gd) = (
                hinge_gradient(&up).expect("the pose is not degenerate"),
                hinge_gradient(&down).expect("the pose is not degenerate"),
            );
            for i in 0..4 {
                let column = (gu[i] - gd[i]) / (2.0 * eps);
                for r in 0..3 {
                    assert!((column[r] - h[i][j][(r, c)]).abs() < 1e-7);
                    assert!((h[i][j][(r, c)] - h[j][i][(c, r)]).abs() < 1e-12);
                }
            }
        }
    }
}

#[test]
fn scale_translation_and_rotation_identities_hold() {
    let x = generic();
    let (g, h) = (
        hinge_gradient(&x).expect("the pose is not degenerate"),
        hinge_hessian(&x).expect("the pose is not degenerate"),
    );
    let spin = Vec3::new(0.3, -1.1, 0.7);
    for i in 0..4 {
        let (mut along, mut sum, mut turned) = (Vec3::zeros(), Mat3::zeros(), Vec3::zeros());
        for j in 0..4 {
            along += h[i][j] * x[j];
            sum += h[i][j];
            turned += h[i][j] * spin.cross(&x[j]);
        }
        assert!((along + g[i]).norm() < 1e-12);
        assert!(sum.norm() < 1e-12);
        assert!((turned - spin.cross(&g[i])).norm() < 1e-12);
    }
}
