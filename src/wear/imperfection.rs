//! The imperfection of cloth that lies exactly in a plane.
//!
//! Forces in the plane of flat cloth keep it there for ever: a towel on a hook hangs as a board, and a fist squeezes it in its plane.
//! Real cloth is never so flat. Points that an action takes up in one plane are moved out of it by about a hundredth of a millimetre, by
//! the same random numbers in every run; what buckles then depends on the forces, not on them. Cloth that is not in one plane stays as
//! it is, bit for bit.

use crate::wear::tuning::TUNING;
use crease_geometry::math::{Mat3, Rng, Vec3, bounds};

/// Seed of the imperfection.
const SEED: u64 = 12;

/// Returns the points `x` [m] a little off their plane; `None` if they do not lie in one.
pub(super) fn off_the_plane(x: &[Vec3]) -> Option<Vec<Vec3>> {
    let normal = normal_of_plane(x)?;
    let mut rng = Rng::from_seed(SEED);
    let shift = |p: &Vec3| p + normal * (TUNING.other.imperfection * (2.0 * rng.uniform() - 1.0));
    Some(x.iter().map(shift).collect())
}

/// The message that says so of the action `name`.
pub(super) fn imperfection_note(name: &str) -> String {
    format!(
        "the garment lies exactly in a plane, which no force in the plane makes it leave: `{name}` begins with points up to {:.2} mm off it, \
         the same in every run",
        1e3 * TUNING.other.imperfection
    )
}

/// Unit normal of the plane in which the points lie, up to the rounding of a file; `None` without one.
fn normal_of_plane(x: &[Vec3]) -> Option<Vec3> {
    if x.len() < 3 {
        return None;
    }
    let (low, high) = bounds(x);
    let centre = x.iter().sum::<Vec3>() / x.len().max(1) as f64;
    let scatter: Mat3 = x.iter().map(|p| (p - centre) * (p - centre).transpose()).sum();
    let eigen = scatter.try_symmetric_eigen(f64::EPSILON, 1000)?;
    let least = (0..3).min_by(|&a, &b| eigen.eigenvalues[a].total_cmp(&eigen.eigenvalues[b]))?;
    let normal: Vec3 = eigen.eigenvectors.column(least).into_owned();
    let limit = TUNING.other.planar_fraction * (high - low).norm();
    let is_planar = limit > 0.0 && x.iter().all(|p| (p - centre).dot(&normal).abs() <= limit);
    is_planar.then_some(normal)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_cloth_in_a_plane_is_moved_and_always_alike() {
        let turn = nalgebra::Rotation3::new(Vec3::new(0.3, 0.2, -0.7));
        let sheet: Vec<Vec3> = (0..400)
            .map(|k| turn * Vec3::new(f64::from(k % 20) / 20.0, f64::from(k / 20) / 30.0, 0.0))
            // As a file has them.
            .map(|p| p.map(|x| f64::from(x as f32)))
            .collect();
        let moved = off_the_plane(&sheet).expect("lies in a plane");
        assert_eq!(off_the_plane(&sheet), Some(moved.clone()));
        let normal = turn * Vec3::z();
        for (a, b) in sheet.iter().zip(&moved) {
            assert!((b - a).norm() <= 1e-5 && (b - a).cross(&normal).norm() < 1e-10);
        }
        assert!(off_the_plane(&moved).is_none(), "it has left its plane");
        let mut waved = sheet.clone();
        waved[210] += normal * 1e-5;
        assert!(off_the_plane(&waved).is_none());
        assert!(off_the_plane(&[]).is_none() && off_the_plane(&[Vec3::x()]).is_none());
    }
}
