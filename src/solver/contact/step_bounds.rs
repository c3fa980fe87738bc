//! Collision-free step sizes: how far each point may move along its displacement so that no pair comes too near.
//!
//! One step size for the whole garment, as in Li et al., "Incremental Potential Contact" (2020), lets a single tight fold stop
//! everything. Here each point has its own: every pair that would come below its minimum distance limits its own four points, pairs that
//! have a limited point are tested again with the motion as it is then, and so on until every pair is free with the motion it really
//! makes. (Chen et al., "Offset Geometric Contact", 2025, have bounds for each point, too, found by another method.) Where that does not
//! converge, the connected part concerned falls back to one step size.
//!
//! The pairs must include every pair that any fractions of the motion could bring near, which is what `contact::broad_phase` finds for
//! the same motion. The result depends neither on the number of threads nor on the order of the pairs: fractions are combined by the
//! minimum only.

use crate::contact::broad_phase::{PairKind, PrimitivePair};
use crate::contact::tuning::TUNING;
use crease_geometry::math::Vec3;
use crease_geometry::mesh::Groups;
use crease_geometry::mesh::aabb::SweptBox;
use rayon::prelude::*;

/// Pairs that one task tests.
const PAIRS_PER_TASK: usize = 512;

/// Fraction of its displacement that each point may move.
#[derive(Debug, Clone, PartialEq)]
pub struct StepFractions {
    /// Fractions in (0, 1], one per point; 0 only for a point that is not finite (or moves by what is not finite) and for those of a pair
    /// that touches already.
    pub fraction: Vec<f64>,
    /// The smallest of them.
    pub min_fraction: f64,
    /// Step size that all points may take together [-].
    pub uniform_step: f64,
    /// Number of points below 1.
    pub limited_points: usize,
    /// Rounds of testing; 1 when every pair was free at once.
    pub rounds: usize,
    /// Number of points that had to take the one step size of their connected part.
    pub fallback_points: usize,
}

impl StepFractions {
    /// Returns the limited displacement \[m\], one per point; zero for what is not finite.
    #[must_use]
    pub fn apply(&self, displacement: &[Vec3]) -> Vec<Vec3> {
        self.fraction
            .iter()
            .zip(displacement)
            .map(|(&f, d)| if f > 0.0 { d * f } else { Vec3::zeros() })
            .collect()
    }
}

/// A pair that would come to its minimum distance.
#[derive(Debug, Clone, Copy)]
pub struct Hit {
    /// Index into the pairs.
    pub pair: u32,
    /// Fraction of the tested motion that keeps the pair apart [-].
    pub fraction: f64,
}

/// Returns fractions such that no pair comes to its minimum distance while every point i moves straight by
/// `fraction[i] * displacement[i]` \[m\] from `positions[i]` \[m\]. `min_distances[k]` \[m\] belongs to `pairs[k]`. What `mesh::ccd` says of
/// pairs that start below their minimum distance holds here, too.
pub fn local_step_fractions(
    pairs: &[PrimitivePair],
    min_distances: &[f64],
    positions: &[Vec3],
    displacement: &[Vec3],
) -> StepFractions {
    fractions_within(TUNING.step.max_rounds, pairs, min_distances, positions, displacement)
}

fn fractions_within(
    max_rounds: usize,
    pairs: &[PrimitivePair],
    min_distances: &[f64],
    positions: &[Vec3],
    displacement: &[Vec3],
) -> StepFractions {
    let finite: Vec<bool> =
        positions.iter().zip(displacement).map(|(x, d)| (x.sum() + d.sum()).is_finite()).collect();
    let mut fraction: Vec<f64> = finite.iter().map(|&finite| if finite { 1.0 } else { 0.0 }).collect();
    let zero = Vec3::zeros();
    let mut motion: Vec<Vec3> =
        displacement.iter().zip(&finite).map(|(d, &finite)| if finite { *d } else { zero }).collect();
    // Displacements only ever become shorter: pairs whose swept boxes are apart at first stay so.
    let near = near_pairs(pairs, min_distances, positions, &motion);
    let mut active = near.clone();
    let mut first_hits = Vec::new();
    let mut fallback_points = 0;
    let mut rounds = 0;
    let mut factor = vec![1.0f64; positions.len()];
    while !active.is_empty() {
        rounds += 1;
        let hits = find_hits(&active, pairs, min_distances, positions, &motion);
        if hits.is_empty() {
            break;
        }
        if rounds == 1 {
            first_hits.clone_from(&hits);
        }
        if rounds >= max_rounds {
            fallback_points = fall_back(&hits, &first_hits, pairs, &finite, &mut fraction);
            break;
        }
        let limited = limit_points(&hits, pairs, displacement, &mut factor, &mut fraction, &mut motion);
        let concerned = |k: &u32| pairs[*k as usize].points.iter().any(|p| limited[p.at()]);
        active = near.iter().copied().filter(concerned).collect();
    }
    let min_fraction = fraction.iter().copied().fold(1.0, f64::min);
    let uniform_step = first_hits.iter().map(|hit| hit.fraction).fold(1.0, f64::min);
    let limited_points = fraction.iter().filter(|&&f| f < 1.0).count();
    StepFractions { fraction, min_fraction, uniform_step, limited_points, rounds, fallback_points }
}

/// Returns the boxes that all points sweep.
pub fn swept_boxes(positions: &[Vec3], motion: &[Vec3]) -> Vec<SweptBox> {
    let swept = |(x, d): (&Vec3, &Vec3)| {
        let known = x.sum().is_finite();
        if known { SweptBox::of_point(x, &(x + d)) } else { SweptBox::EVERYWHERE }
    };
    positions.iter().zip(motion).map(swept).collect()
}

/// Returns the pairs whose swept boxes come as near as their minimum distance, in order.
fn near_pairs(
    pairs: &[PrimitivePair],
    min_distances: &[f64],
    positions: &[Vec3],
    motion: &[Vec3],
) -> Vec<u32> {
    let boxes = swept_boxes(positions, motion);
    let pairs = pairs.par_iter().zip(min_distances).enumerate();
    let near = pairs.filter(|(_, (pair, min_distance))| !stay_apart(pair, &boxes, **min_distance));
    near.map(|(k, _)| k as u32).collect()
}

/// Returns those of the `active` pairs that are not free, in the order of `active`.
pub fn find_hits(
    active: &[u32],
    pairs: &[PrimitivePair],
    min_distances: &[f64],
    positions: &[Vec3],
    motion: &[Vec3],
) -> Vec<Hit> {
    let test = |&pair: &u32| {
        let k = pair as usize;
        let fraction = pairs[k].collision_free_step_size(positions, motion, min_distances[k]);
        (fraction < 1.0).then_some(Hit { pair, fraction })
    };
    let parts: Vec<Vec<Hit>> =
        active.par_chunks(PAIRS_PER_TASK).map(|chunk| chunk.iter().filter_map(test).collect()).collect();
    parts.concat()
}

/// Whether the boxes swept by the two primitives of a pair are farther apart than `min_distance` [m].
#[inline]
pub fn stay_apart(pair: &PrimitivePair, boxes: &[SweptBox], min_distance: f64) -> bool {
    let [a, b, c, d] = pair.points.map(|p| &boxes[p.at()]);
    let (first, second) = match pair.kind {
        PairKind::PointTriangle => (*a, b.joined(c).joined(d)),
        PairKind::EdgeEdge => (a.joined(b), c.joined(d)),
    };
    !min_distance.is_nan() && !first.near(&second, SweptBox::limit(min_distance))
}

/// Limits the points of every pair that was hit, each by the smallest of its pairs' fractions. Returns whether a point was limited, one
/// flag per point.
fn limit_points(
    hits: &[Hit],
    pairs: &[PrimitivePair],
    displacement: &[Vec3],
    factor: &mut [f64],
    fraction: &mut [f64],
    motion: &mut [Vec3],
) -> Vec<bool> {
    factor.fill(1.0);
    for hit in hits {
        for p in pairs[hit.pair as usize].points {
            factor[p.at()] = factor[p.at()].min(hit.fraction);
        }
    }
    let mut limited = vec![false; factor.len()];
    for p in 0..factor.len() {
        // A point that stands still already changes nothing for its pairs.
        if factor[p] < 1.0 && fraction[p] > 0.0 {
            fraction[p] *= factor[p];
            motion[p] = displacement[p] * fraction[p];
            limited[p] = true;
        }
    }
    limited
}

/// Gives every connected part that still has a hit one step size: the smallest that any of its pairs got in the first round. Returns the
/// number of points concerned.
///
/// That this is safe: in the first round every pair was tested with all four points at fraction 1 and found safe up to its t. When the
/// points of a part all have the fraction g, a pair of that part moves, from time 0 to 1, exactly as it did in the first round from time 0
/// to g; and g <= t for each of them, so it stays above its minimum distance. (Points that are not finite stood still then and still do.)
/// Pairs of other parts have no point in common with it, keep their own motion, and were found free with it in the round they were last tested.
fn fall_back(
    hits: &[Hit],
    first_hits: &[Hit],
    pairs: &[PrimitivePair],
    finite: &[bool],
    fraction: &mut [f64],
) -> usize {
    let mut parts = Groups::new(fraction.len());
    for pair in pairs {
        for p in &pair.points[1..] {
            parts.join(pair.points[0].0, p.0);
        }
    }
    let mut part_of = |hit: &Hit| parts.find(pairs[hit.pair as usize].points[0].0) as usize;
    let mut unresolved = vec![false; fraction.len()];
    for hit in hits {
        unresolved[part_of(hit)] = true;
    }
    let mut step_size = vec![1.0f64; fraction.len()];
    for hit in first_hits {
        let part = part_of(hit);
        step_size[part] = step_size[part].min(hit.fraction);
    }
    let mut concerned = 0;
    for p in 0..fraction.len() {
        let part = parts.find(p as u32) as usize;
        if unresolved[part] {
            concerned += 1;
            if finite[p] {
                fraction[p] = step_size[part];
            }
        }
    }
    concerned
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;
    use crate::contact::broad_phase::{CandidateFinder, SearchQuery};
    use crease_geometry::math::Rng;
    use crease_geometry::mesh::intersections::self_intersections;
    use crease_geometry::mesh::{PointIndex, Topology};

    /// `layers` sheets of n x n squares of 8 mm, `apart` \[m\] above each other, each rotated a little.
    pub fn pile(layers: usize, n: usize, apart: f64) -> (Vec<Vec3>, Vec<[PointIndex; 3]>) {
        let (mut points, mut triangles) = (Vec::new(), Vec::new());
        for layer in 0..layers {
            let base = points.len() as u32;
            let (sin, cos) = (0.3 * layer as f64).sin_cos();
            for i in 0..(n + 1) * (n + 1) {
                let (x, y) = (8e-3 * (i % (n + 1)) as f64, 8e-3 * (i / (n + 1)) as f64);
                points.push(Vec3::new(x * cos - y * sin, x * sin + y * cos, apart * layer as f64));
            }
            for i in 0..n * n {
                let a = base + (i / n * (n + 1) + i % n) as u32;
                let (b, c, d) = (a + 1, a + n as u32 + 1, a + n as u32 + 2);
                triangles.push([a, b, d].map(PointIndex));
                triangles.push([a, d, c].map(PointIndex));
            }
        }
        (points, triangles)
    }

    /// The candidates of a motion as pairs.
    pub fn pairs(
        points: &[Vec3],
        triangles: &[[PointIndex; 3]],
        displacement: &[Vec3],
    ) -> Vec<PrimitivePair> {
        let topology = Topology::new(points.len(), triangles);
        let mut finder = CandidateFinder::new(points, triangles, &topology);
        let end: Vec<Vec3> = points.iter().zip(displacement).map(|(x, d)| x + d).collect();
        let query =
            SearchQuery { start: points, end: &end, distance: 1e-3, uniform_step: false, skip: &|_| false };
        let found = finder.find(query);
        finder.pairs(&found).collect()
    }

    /// Asserts that each pair stays apart during its motion, in steps within which its gap cannot close.
    pub fn assert_apart(pairs: &[PrimitivePair], min_distances: &[f64], points: &[Vec3], motion: &[Vec3]) {
        for (pair, &min_distance) in pairs.iter().zip(min_distances) {
            let (x, dx) = (pair.gather(points), pair.gather(motion));
            let min_distance = min_distance.min(0.5 * pair.distance(points));
            let speed: f64 = dx.iter().map(|d| d.norm()).sum();
            let mut time = 0.0;
            while time < 1.0 && speed > 0.0 {
                let now = [0, 1, 2, 3].map(|i| x[i] + dx[i] * time);
                let margin = pair.kind.closest_points(&now).distance - min_distance;
                assert!(margin > 0.0, "{pair:?} at {time}: {margin}");
                time += margin / speed;
            }
        }
    }

    /// A pile whose layers are thrown through each other, each point in its own direction, 20 gaps a step.
    pub fn thrown(layers: usize) -> (Vec<Vec3>, Vec<[PointIndex; 3]>, Vec<Vec3>) {
        let (points, triangles) = pile(layers, 6, 1e-3);
        let mut rng = Rng::from_state(21);
        let mut displacement: Vec<Vec3> = points.iter().map(|_| rng.in_cube() * 4e-3).collect();
        for (d, x) in displacement.iter_mut().zip(&points) {
            d.z -= 5.0 * x.z;
        }
        (points, triangles, displacement)
    }

    #[test]
    fn a_free_motion_is_left_alone_in_one_round() {
        let (points, triangles) = pile(3, 5, 1e-3);
        let displacement = vec![Vec3::new(1e-4, 0.0, -0.02); points.len()];
        let pairs = pairs(&points, &triangles, &displacement);
        assert!(pairs.len() > 1000);
        let found = local_step_fractions(&pairs, &vec![5e-4; pairs.len()], &points, &displacement);
        assert_eq!(
            (found.min_fraction, found.limited_points, found.rounds, found.fallback_points),
            (1.0, 0, 1, 0)
        );
        assert!(local_step_fractions(&[], &[], &points, &displacement).min_fraction == 1.0);
    }

    #[test]
    fn layers_thrown_through_each_other_stay_apart() {
        let (points, triangles, displacement) = thrown(8);
        let pairs = pairs(&points, &triangles, &displacement);
        let min_distances = vec![2e-4; pairs.len()];
        let found = local_step_fractions(&pairs, &min_distances, &points, &displacement);
        assert!(found.fraction.iter().all(|&f| f > 0.0 && f <= 1.0));
        let motion = found.apply(&displacement);
        assert_apart(&pairs, &min_distances, &points, &motion);
        let together: Vec<Vec3> = displacement.iter().map(|d| d * found.uniform_step).collect();
        assert!(found.uniform_step > 0.0 && found.uniform_step < 1.0);
        assert_apart(&pairs, &min_distances, &points, &together);
        let end: Vec<Vec3> = points.iter().zip(&motion).map(|(x, d)| x + d).collect();
        assert!(self_intersections(&end, &triangles).is_empty());
        let whole: Vec<Vec3> = points.iter().zip(&displacement).map(|(x, d)| x + d).collect();
        assert!(self_intersections(&whole, &triangles).len() > 100, "the motion must be one that crosses");
        println!(
            "rounds {} min_fraction {} limited_points {}",
            found.rounds, found.min_fraction, found.limited_points
        );
        assert_eq!(found.fallback_points, 0);
    }

    /// One tight spot must not stop the rest of the garment.
    #[test]
    fn only_points_near_a_hit_are_limited() {
        let (points, triangles) = pile(2, 12, 1e-3);
        let mut displacement = vec![Vec3::new(0.0, 0.0, 2e-3); points.len()];
        displacement[0].z = 40e-3;
        let pairs = pairs(&points, &triangles, &displacement);
        let found = local_step_fractions(&pairs, &vec![1e-4; pairs.len()], &points, &displacement);
        assert!(found.fraction[0] < 0.1, "{}", found.fraction[0]);
        assert!(found.limited_points < 30, "{} of {}", found.limited_points, points.len());
    }

    /// For any number of rounds the answer is safe: one step size for each connected part.
    #[test]
    fn falling_back_is_safe_and_keeps_to_its_part() {
        let (mut points, mut triangles, mut displacement) = thrown(4);
        // A second pile far away, that is free.
        let (far, far_triangles) = pile(2, 2, 1e-3);
        let base = points.len() as u32;
        points.extend(far.iter().map(|x| x + Vec3::x() * 10.0));
        triangles.extend(far_triangles.iter().map(|t| t.map(|p| PointIndex(p.0 + base))));
        displacement.resize(points.len(), Vec3::new(0.0, 0.0, 1e-3));
        let pairs = pairs(&points, &triangles, &displacement);
        let min_distances = vec![3e-4; pairs.len()];
        for rounds in 1..4 {
            let found = fractions_within(rounds, &pairs, &min_distances, &points, &displacement);
            assert_eq!(found.rounds, rounds);
            assert!(found.fallback_points > 50 && found.fallback_points <= base as usize);
            assert!(found.min_fraction > 0.0);
            assert!(found.fraction[base as usize..].iter().all(|&f| f == 1.0));
            assert_apart(&pairs, &min_distances, &points, &found.apply(&displacement));
        }
    }

    #[test]
    fn the_same_for_any_number_of_threads_and_any_order_of_pairs() {
        let (points, triangles, displacement) = thrown(5);
        let mut pairs = pairs(&points, &triangles, &displacement);
        let min_distances = vec![2e-4; pairs.len()];
        let run = |pairs: &[PrimitivePair], threads: usize| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build();
            let Ok(pool) = pool else { panic!("no threads") };
            pool.install(|| local_step_fractions(pairs, &min_distances, &points, &displacement))
        };
        let one = run(&pairs, 1);
        assert_eq!(run(&pairs, 3), one);
        pairs.reverse();
        assert_eq!(run(&pairs, 2), one);
    }

    #[test]
    fn points_that_are_not_finite_stand_still_and_stop_only_points_that_would_hit_them() {
        let (points, triangles) = pile(2, 4, 1e-3);
        let mut displacement = vec![Vec3::new(0.0, 0.0, -2e-3); points.len()];
        displacement[30] = Vec3::new(0.0, f64::NAN, 0.0);
        displacement[31].x = f64::INFINITY;
        let pairs = pairs(&points, &triangles, &displacement);
        let min_distances = vec![1e-4; pairs.len()];
        let found = local_step_fractions(&pairs, &min_distances, &points, &displacement);
        assert_eq!((found.fraction[30], found.fraction[31]), (0.0, 0.0));
        assert!(found.fraction.iter().enumerate().all(|(i, &f)| f > 0.0 || i == 30 || i == 31));
        let motion = found.apply(&displacement);
        assert!(motion.iter().all(|d| d.sum().is_finite()));
        assert_apart(&pairs, &min_distances, &points, &motion);
    }

    #[test]
    fn pairs_below_their_minimum_distance_may_part() {
        let points = [Vec3::new(0.2, 0.2, 1e-4), Vec3::zeros(), Vec3::x(), Vec3::y()];
        let pair = PrimitivePair { kind: PairKind::PointTriangle, points: [0, 1, 2, 3].map(PointIndex) };
        let mut displacement = [Vec3::zeros(); 4];
        displacement[0].z = 1.0;
        let found = local_step_fractions(&[pair], &[1e-3], &points, &displacement);
        assert_eq!(found.min_fraction, 1.0);
        displacement[0].z = -1.0;
        let found = local_step_fractions(&[pair], &[1e-3], &points, &displacement);
        assert!(found.min_fraction > 0.0 && found.min_fraction < 5e-5);
    }
}
