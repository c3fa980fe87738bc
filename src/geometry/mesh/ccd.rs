//! Continuous collision detection of a point and a triangle and of two edges.
//!
//! The method is conservative advancement after Li et al., "Codimensional Incremental Potential Contact" (2021; ACCD):
//! step by a time in which the pair cannot meet, measure again, repeat until the gap has shrunk to a small
//! fraction. The bound on each step is sharper than ACCD's (the sum of the largest speeds): the closest points
//! give a direction n, and along n the primitives stay apart at least by the smallest n·(x_i − x_j) over the corners i
//! of the first and j of the second. Each of these is linear in time, so the first to reach the level is known
//! exactly. Layers that slide along each other therefore cost one step instead of hundreds, and the answer stays
//! conservative even where the closest points are inexact: any n gives a valid bound.
//!
//! Each point moves in a straight line. The time of impact is not found to the last digit. For whole meshes see `contact::step_bounds`.

use crate::math::Vec3;
use crate::mesh::distance::{ClosestPoints, edge_edge, point_triangle};
use crate::mesh::tuning::TUNING;

/// Corners (first primitive, second primitive) that bound the gap of a point and a triangle.
const POINT_TRIANGLE: [(usize, usize); 3] = [(0, 1), (0, 2), (0, 3)];
/// Ends (first edge, second edge) that bound the gap of two edges.
const EDGE_EDGE: [(usize, usize); 4] = [(0, 2), (0, 3), (1, 2), (1, 3)];

/// Returns the largest safe fraction of the motion `dx` \[m\] of a point `x[0]` and a triangle `x[1..4]` \[m\]: 1 when free,
/// otherwise t such that at every time up to t the distance stays above `min_distance` \[m\], with at least 3 % of the present
/// gap to spare.
///
/// A pair that starts at or below the minimum distance may close to half its distance, so that it is never stuck when it
/// parts. The result is 0 when anything is not finite, or when a pair that touches already moves within itself.
#[inline]
pub fn point_triangle_step(x: [Vec3; 4], dx: [Vec3; 4], min_distance: f64) -> f64 {
    safe_fraction(x, dx, min_distance, &POINT_TRIANGLE, |x| point_triangle(&x[0], &x[1], &x[2], &x[3]))
}

/// Returns the same for the edges `x[0] x[1]` and `x[2] x[3]`.
#[inline]
pub fn edge_edge_step(x: [Vec3; 4], dx: [Vec3; 4], min_distance: f64) -> f64 {
    safe_fraction(x, dx, min_distance, &EDGE_EDGE, |x| edge_edge(&x[0], &x[1], &x[2], &x[3]))
}

#[inline(always)]
fn safe_fraction<const N: usize>(
    x: [Vec3; 4],
    dx: [Vec3; 4],
    min_distance: f64,
    corners: &[(usize, usize); N],
    gap: impl Fn(&[Vec3; 4]) -> ClosestPoints,
) -> f64 {
    if stay_apart_on_an_axis(&x, &dx, min_distance, N == 3) {
        return 1.0;
    }
    // Common motion cannot make the primitives meet, and far from the origin it only costs digits.
    let mean = (dx[0] + dx[1] + dx[2] + dx[3]) * 0.25;
    let dx = dx.map(|d| d - mean);
    let x = [Vec3::zeros(), x[1] - x[0], x[2] - x[0], x[3] - x[0]];
    let size = x.iter().chain(&dx).map(|v| v.norm_squared()).sum::<f64>() + min_distance;
    if !size.is_finite() {
        return 0.0;
    }
    let start = gap(&x);
    let clearance = clearance(&x, &(start.vector / start.distance), corners);
    let apart = clearance > 0.0;
    if !apart {
        let still = corners.iter().all(|&(i, j)| dx[i] == dx[j]);
        return if still { 1.0 } else { 0.0 };
    }
    let min_distance = if clearance > min_distance { min_distance } else { 0.5 * clearance };
    let margin = clearance - min_distance;
    let run = |kept: f64| {
        advance(&x, &dx, min_distance + kept * margin, TUNING.ccd_gap_tol * margin, corners, &gap)
    };
    let reached = run(TUNING.ccd_kept_gap);
    if reached >= 1.0 || run(TUNING.ccd_free_gap) >= 1.0 { 1.0 } else { reached }
}

/// Whether the boxes swept by the two primitives are more than `min_distance` apart along an axis: most pairs end here.
#[inline(always)]
pub fn stay_apart_on_an_axis(x: &[Vec3; 4], dx: &[Vec3; 4], min_distance: f64, first_is_point: bool) -> bool {
    for axis in 0..3 {
        let low = |i: usize| x[i][axis] + dx[i][axis].min(0.0);
        let high = |i: usize| x[i][axis] + dx[i][axis].max(0.0);
        let (first, second) = if first_is_point {
            ((low(0), high(0)), (low(1).min(low(2)).min(low(3)), high(1).max(high(2)).max(high(3))))
        } else {
            ((low(0).min(low(1)), high(0).max(high(1))), (low(2).min(low(3)), high(2).max(high(3))))
        };
        let apart = (second.0 - first.1).max(first.0 - second.1);
        // A coordinate that is not finite must not pass: min and max drop it, the sum does not.
        if apart > min_distance && (0..4).all(|i| (x[i] + dx[i]).sum().is_finite()) {
            return true;
        }
    }
    false
}

/// Returns a lower bound on the distance of the two primitives: their separation along the unit vector `n`.
#[inline(always)]
fn clearance<const N: usize>(x: &[Vec3; 4], n: &Vec3, corners: &[(usize, usize); N]) -> f64 {
    let mut lowest = f64::INFINITY;
    for &(i, j) in corners {
        let along = n.dot(&(x[i] - x[j]));
        // Not `min`, which would drop a NaN.
        lowest = if along >= lowest { lowest } else { along };
    }
    lowest
}

/// Returns the time up to which the primitives stay at least `level` apart; 1 when they do to the end.
#[inline(always)]
fn advance<const N: usize>(
    x: &[Vec3; 4],
    dx: &[Vec3; 4],
    level: f64,
    gap_tol: f64,
    corners: &[(usize, usize); N],
    gap: &impl Fn(&[Vec3; 4]) -> ClosestPoints,
) -> f64 {
    let mut time = 0.0;
    for _ in 0..TUNING.ccd_max_steps {
        let now = [0, 1, 2, 3].map(|i| x[i] + dx[i] * time);
        let g = gap(&now);
        let n = g.vector / g.distance;
        let mut lowest = f64::INFINITY;
        let mut step = f64::INFINITY;
        for &(i, j) in corners {
            let along = n.dot(&(now[i] - now[j]));
            let speed = n.dot(&(dx[i] - dx[j]));
            lowest = if along >= lowest { lowest } else { along };
            if speed < 0.0 {
                step = step.min((along - level) / -speed);
            }
        }
        let is_above = lowest > level + gap_tol;
        if !is_above {
            return time;
        }
        time += step;
        if time >= 1.0 {
            return 1.0;
        }
    }
    time
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::Rng;

    fn four(rng: &mut Rng, size: f64) -> [Vec3; 4] {
        [0; 4].map(|_| rng.in_cube() * size)
    }

    fn moved(x: &[Vec3; 4], dx: &[Vec3; 4], t: f64) -> [Vec3; 4] {
        [0, 1, 2, 3].map(|i| x[i] + dx[i] * t)
    }

    type Step = fn([Vec3; 4], [Vec3; 4], f64) -> f64;
    type Measure = fn(&[Vec3; 4]) -> ClosestPoints;
    fn kinds() -> [(&'static str, Step, Measure); 2] {
        [
            ("point-triangle", point_triangle_step, |x| point_triangle(&x[0], &x[1], &x[2], &x[3])),
            ("edge-edge", edge_edge_step, |x| edge_edge(&x[0], &x[1], &x[2], &x[3])),
        ]
    }

    fn flat_triangle() -> [Vec3; 3] {
        [Vec3::new(-1.0, -1.0, 0.0), Vec3::new(2.0, -1.0, 0.0), Vec3::new(-1.0, 2.0, 0.0)]
    }

    fn point_over(height: f64) -> [Vec3; 4] {
        let [a, b, c] = flat_triangle();
        [Vec3::new(0.0, 0.0, height), a, b, c]
    }

    fn only_first(d: Vec3) -> [Vec3; 4] {
        [d, Vec3::zeros(), Vec3::zeros(), Vec3::zeros()]
    }

    #[test]
    fn head_on_stops_with_the_kept_fraction_of_the_gap() {
        let t = point_triangle_step(point_over(1.0), only_first(Vec3::new(0.0, 0.0, -2.0)), 0.2);
        assert!((t - 0.4 * (1.0 - TUNING.ccd_kept_gap)).abs() < 1e-12, "{t}");
        let cross =
            [Vec3::new(-1.0, 0.0, 1.0), Vec3::new(1.0, 0.0, 1.0), Vec3::new(0.0, -1.0, 0.0), Vec3::y()];
        let down = Vec3::new(0.0, 0.0, -2.0);
        let t = edge_edge_step(cross, [down, down, Vec3::zeros(), Vec3::zeros()], 0.2);
        assert!((t - 0.4 * (1.0 - TUNING.ccd_kept_gap)).abs() < 1e-12, "{t}");
    }

    /// A garment in fast motion: 167 thicknesses in one step, and far beyond the other layer.
    #[test]
    fn no_tunnelling_at_167_thicknesses_a_step() {
        let thickness = 3e-4;
        let down = Vec3::new(0.0, 0.0, -167.0 * thickness);
        for scale in [1.0, 10.0, 1e4] {
            let x = point_over(2.0 * thickness / 8e-3).map(|v| v * 8e-3);
            let t = point_triangle_step(x, only_first(down * scale), thickness);
            let height = (x[0] + down * scale * t).z;
            assert!(height > thickness && height < 1.13 * thickness, "{scale}: {height}");
        }
    }

    #[test]
    fn sliding_and_parting_and_common_motion_are_free() {
        let along = Vec3::new(500.0, 300.0, 0.0);
        assert_eq!(point_triangle_step(point_over(0.01), only_first(along), 0.005), 1.0);
        assert_eq!(point_triangle_step(point_over(0.01), only_first(Vec3::z()), 0.005), 1.0);
        let together = [Vec3::new(3e6, -2e6, 1e6); 4];
        assert_eq!(point_triangle_step(point_over(0.01), together, 0.0099), 1.0);
        assert_eq!(point_triangle_step(point_over(0.01), [Vec3::zeros(); 4], 0.005), 1.0);
        assert_eq!(point_triangle_step(point_over(0.0), [Vec3::zeros(); 4], 0.005), 1.0);
    }

    #[test]
    fn a_pair_below_the_minimum_distance_may_part_but_only_close_to_half() {
        assert_eq!(point_triangle_step(point_over(0.01), only_first(Vec3::z()), 0.1), 1.0);
        let t = point_triangle_step(point_over(0.01), only_first(-Vec3::z()), 0.1);
        assert!(t > 0.0 && t < 0.005, "{t}");
        assert_eq!(point_triangle_step(point_over(0.0), only_first(Vec3::z()), 0.1), 0.0);
    }

    #[test]
    fn motion_within_one_plane_stops_at_the_side() {
        let mut x = point_over(0.0);
        x[0] = Vec3::new(-3.0, 0.0, 0.0);
        let t = point_triangle_step(x, only_first(Vec3::new(4.0, 0.0, 0.0)), 0.1);
        let toi = 1.9 / 4.0;
        assert!(t <= toi && t > 0.9 * toi, "{t}");
        let flat = [Vec3::zeros(), Vec3::x(), Vec3::new(3.0, 0.1, 0.0), Vec3::new(4.0, 0.0, 0.0)];
        let t = edge_edge_step(flat, [Vec3::x() * 5.0, Vec3::x() * 5.0, Vec3::zeros(), Vec3::zeros()], 0.1);
        assert!(t > 0.3 && t < 0.38, "{t}");
    }

    #[test]
    fn anything_not_finite_gives_zero() {
        for (_, step, _) in kinds() {
            for bad in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
                for i in 0..4 {
                    for axis in 0..3 {
                        for offset in [0.0, 1e3] {
                            let mut x = point_over(1.0);
                            x[3].y += offset;
                            let mut dx = only_first(-Vec3::z());
                            let mut broken = x;
                            broken[i][axis] = bad;
                            assert_eq!(step(broken, dx, 0.1), 0.0, "{bad} x {i} {axis}");
                            dx[i][axis] = bad;
                            assert_eq!(step(x, dx, 0.1), 0.0, "{bad} dx {i} {axis}");
                        }
                    }
                }
                assert_eq!(step(point_over(1.0), only_first(-Vec3::z()), f64::NAN), 0.0);
            }
        }
    }

    /// First time at which the pair is within `min_distance`, by walking in small steps: never longer than the gap allows at
    /// the sum of all speeds, and accurate to about 2e-5. `None` when it never is.
    fn sampled_impact(x: &[Vec3; 4], dx: &[Vec3; 4], min_distance: f64, measure: Measure) -> Option<f64> {
        let speed: f64 = dx.iter().map(|d| d.norm()).sum();
        let mut t = 0.0;
        while t < 1.0 {
            let margin = measure(&moved(x, dx, t)).distance - min_distance;
            if margin <= 1e-5 * speed {
                return Some(t + 2e-5);
            }
            t += margin / speed;
        }
        None
    }

    /// 100,000 random pairs against dense sampling in time: never late, seldom much too early.
    #[test]
    fn never_late_and_seldom_early_against_dense_sampling() {
        for (name, step, measure) in kinds() {
            let mut rng = Rng::from_state(7);
            let (mut hits, mut tight, mut needless) = (0, 0, 0);
            let mut tried = 0;
            while tried < 50_000 {
                let x = four(&mut rng, 1.0);
                let size = 10f64.powf(2.0 * rng.uniform() - 1.0);
                let dx = four(&mut rng, size);
                let distance = measure(&x).distance;
                let min_distance = distance * [0.0, 1e-3, 0.3, 0.9][tried % 4];
                tried += 1;
                let t = step(x, dx, min_distance);
                assert!((0.0..=1.0).contains(&t));
                // Within each of these steps the gap cannot close, so that the whole motion up to t is covered.
                let speed: f64 = dx.iter().map(|d| d.norm()).sum();
                let mut time = 0.0;
                while time < t {
                    let margin = measure(&moved(&x, &dx, time)).distance - min_distance;
                    assert!(
                        margin > 0.02 * (distance - min_distance),
                        "{name}: late, {margin} at {time} of {t}: {x:?} {dx:?}"
                    );
                    time += margin / speed;
                }
                match sampled_impact(&x, &dx, min_distance, measure) {
                    Some(toi) => {
                        hits += 1;
                        tight += usize::from(t >= 0.9 * toi - 1e-6);
                    }
                    None => needless += usize::from(t < 1.0),
                }
            }
            let fraction = tight as f64 / hits as f64;
            assert!(hits > 1_000, "{name}: {hits} hits");
            assert!(fraction > 0.75, "{name}: only {fraction} of the hits are tight");
            assert!((needless as f64) < 0.05 * tried as f64, "{name}: {needless} stopped without need");
            println!("{name}: hits {hits}, tight {fraction:.3}, needless {needless}");
        }
    }

    /// A motion cut short by the answer is free when tested again, also after rounding: `contact::step_bounds` ends by it.
    #[test]
    fn a_motion_cut_short_is_free() {
        for (name, step, _) in kinds() {
            let mut rng = Rng::from_state(11);
            for k in 0..50_000 {
                let (x, dx) = (four(&mut rng, 1.0), four(&mut rng, 2.0));
                let min_distance = [0.0, 0.05][k % 2];
                let t = step(x, dx, min_distance);
                assert_eq!(step(x, dx.map(|d| d * t), min_distance), 1.0, "{name}: {t} {x:?} {dx:?}");
            }
        }
    }

    /// The step cap must be a net, not the rule: long thin slivers that spin past each other.
    #[test]
    fn slivers_that_spin_are_never_late() {
        for (name, step, measure) in kinds() {
            let mut rng = Rng::from_state(13);
            for _ in 0..5_000 {
                let mut x = four(&mut rng, 1.0);
                x[3] = x[2] + rng.in_cube() * 1e-3;
                x[1] = x[0] + rng.in_cube() * 0.05;
                let dx = four(&mut rng, 1.0);
                let t = step(x, dx, 1e-3);
                let begin = measure(&x).distance;
                let min_distance = if begin > 1e-3 { 1e-3 } else { 0.45 * begin };
                for k in 0..=200 {
                    let d = measure(&moved(&x, &dx, t * k as f64 / 200.0)).distance;
                    assert!(d > min_distance, "{name}: {d}");
                }
            }
        }
    }
}
