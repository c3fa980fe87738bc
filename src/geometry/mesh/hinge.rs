//! The angle of a hinge and its gradient.
//!
//! ```text
//!          x2            e  = x1 - x0
//!         /  \           nA = e x (x2 - x0)
//!       x0 -- x1         nB = (x3 - x0) x e
//!         \  /           theta = atan2(e^ . (nA x nB), nA . nB)
//!          x3
//! ```
//!
//! theta is 0 when flat and grows when the wings fold *away* from the normals (nA, nB turning apart about +e).
//! `atan2`, not `acos`: the latter loses half the digits near flat and knows no sign. The gradient is the closed
//! form of Bridson, Marino, Fedkiw 2003 and of Tamstorf, Grinspun 2013.

use crate::math::Vec3;

/// Returns the angle of the hinge [rad] in (-pi, pi]; 0 for degenerate wings.
///
/// ```
/// use crease_geometry::math::Vec3;
/// use crease_geometry::mesh::hinge_angle;
/// // Two triangles on the edge from x0 to x1; the second one is turned up by a right angle.
/// let [x0, x1] = [Vec3::new(0.0, 0.0, 0.0), Vec3::new(0.0, 0.0, 1.0)];
/// let angle = hinge_angle(&[x0, x1, Vec3::new(-1.0, 0.0, 0.0), Vec3::new(0.0, 1.0, 0.0)]);
/// assert!((angle.abs() - std::f64::consts::FRAC_PI_2).abs() < 1e-15);
/// ```
#[inline]
pub fn hinge_angle(x: &[Vec3; 4]) -> f64 {
    let e = x[1] - x[0];
    let na = e.cross(&(x[2] - x[0]));
    let nb = (x[3] - x[0]).cross(&e);
    let length = e.norm();
    if length == 0.0 {
        return 0.0;
    }
    (e.dot(&na.cross(&nb)) / length).atan2(na.dot(&nb))
}

/// Returns the gradient of the angle by the four points [rad/m]; `None` where a wing has no area.
#[inline]
pub fn hinge_gradient(x: &[Vec3; 4]) -> Option<[Vec3; 4]> {
    let e = x[1] - x[0];
    let (a, b) = (x[2] - x[0], x[3] - x[0]);
    let (na, nb) = (e.cross(&a), b.cross(&e));
    let (ee, naa, nbb) = (e.norm_squared(), na.norm_squared(), nb.norm_squared());
    // Wings thinner than 1e-6 of the edge: the angle is noise.
    if naa <= 1e-12 * ee * ee || nbb <= 1e-12 * ee * ee || ee == 0.0 {
        return None;
    }
    let length = ee.sqrt();
    let g2 = na * (-length / naa);
    let g3 = nb * (-length / nbb);
    let (s2, s3) = (a.dot(&e) / ee, b.dot(&e) / ee);
    let g1 = -s2 * g2 - s3 * g3;
    Some([-g1 - g2 - g3, g1, g2, g3])
}

/// Returns the representative of `angle` (mod 2 pi) nearest to `last` [rad]: a fold passes +-pi without a jump.
///
/// ```
/// use std::f64::consts::PI;
/// assert!((crease_geometry::mesh::unwrap_angle(-3.1, 3.1) - (2.0 * PI - 3.1)).abs() < 1e-12);
/// ```
#[inline]
pub fn unwrap_angle(angle: f64, last: f64) -> f64 {
    let turn = std::f64::consts::TAU;
    let difference = angle - last;
    last + (difference - turn * (difference / turn).round())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A generic pose: no two of its edges are equal or parallel.
    fn generic() -> [Vec3; 4] {
        [
            Vec3::new(0.013, -0.021, 0.034),
            Vec3::new(0.97, 0.055, -0.028),
            Vec3::new(0.28, 0.71, 0.19),
            Vec3::new(0.65, -0.33, 0.41),
        ]
    }

    #[test]
    fn angle_and_gradient_of_the_generic_pose_match_fifty_digit_reference() {
        let x = generic();
        let theta = hinge_angle(&x);
        assert!((theta + 1.102_388_607_122_368_3).abs() < 1e-14, "{theta}");
        // dE/dx1.y / torque for E = k/2 (theta - 0.25)^2
        let torque = -2.080_597_857_111_335_7e-5;
        let g = hinge_gradient(&x).unwrap();
        assert!((g[1].y * torque + 1.528_981_527_300_682_8e-5).abs() < 1e-15);
    }

    #[test]
    fn the_unwrapped_angle_follows_a_wing_from_minus_190_to_190_degrees_and_back() {
        let mut last = 0.0;
        let sweep = (0..=190).chain((-190..190).rev()).chain(-190..=0);
        for degrees in sweep {
            let phi = f64::from(degrees).to_radians();
            let x = [
                Vec3::zeros(),
                Vec3::x(),
                Vec3::new(0.3, 0.8, 0.0),
                Vec3::new(0.6, -0.5 * phi.cos(), 0.5 * phi.sin()),
            ];
            last = unwrap_angle(hinge_angle(&x), last);
            assert!((last + phi).abs() < 1e-12, "{degrees}: {last}");
        }
        assert!(last.abs() < 1e-12);
    }
}
