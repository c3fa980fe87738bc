//! The bound that keeps layers apart: how far each point may go along its way so that no pair comes too near.
//!
//! One fraction for the whole garment, as in Li et al., "Incremental Potential Contact" (2020), lets a
//! single tight fold stop everything. Here each point has its own: every pair that would come below its floor
//! slows its own four points, pairs that share a slowed point are tested again with the motion as it is then, and so
//! on until every pair is free with the motion it really makes (bounds for each point also in Chen et al., "Offset
//! Geometric Contact", 2025, found there in another way). Where that does not settle, the connected part concerned falls back
//! to one fraction.
//!
//! The pairs must hold every pair that any fractions of the motion could bring near, which is what
//! `contact::candidates` finds for the same motion. The result depends neither on the number of threads nor on the
//! order of the pairs: fractions are combined by the minimum only.

use crate::contact::broad_phase::{PairKind, PrimitivePair};
use crate::math::Vec3;
use crate::mesh::aabb::SweptBox;
use rayon::prelude::*;

/// Rounds of slowing and testing again before a part falls back to one fraction. Piles of layers settle within
/// about as many rounds as they have layers.
const ROUNDS_MOST: usize = 48;
/// Pairs that one task tests.
const CHUNK: usize = 4096;

/// How far each point may go.
#[derive(Debug, Clone, PartialEq)]
pub struct StepFractions {
    /// One per point: in (0, 1]; 0 only for a point that is not finite (or moves by what is not finite) and for those
    /// of a pair that touches already.
    pub fraction: Vec<f64>,
    /// The smallest of them.
    pub least: f64,
    /// Number of points below 1.
    pub slowed: usize,
    /// Rounds of testing; 1 when every pair was free at once.
    pub rounds: usize,
    /// Number of points that had to take the one fraction of their connected part.
    pub fallen_back: usize,
}

impl StepFractions {
    /// The motion that may be made \[m\], one per point; none for what is not finite.
    #[must_use]
    pub fn apply(&self, displacement: &[Vec3]) -> Vec<Vec3> {
        self.fraction
            .iter()
            .zip(displacement)
            .map(|(&f, d)| if f > 0.0 { d * f } else { Vec3::zeros() })
            .collect()
    }
}

/// Fractions such that, while every point i moves straight by `fraction[i] * displacement[i]` \[m\] from `points[i]`
/// \[m\], no pair comes to its floor: `floors[k]` \[m\] belongs to `quads[k]`. What `mesh::motion` says of pairs that
/// start below their floor holds here too.
pub fn local_step_fractions(
    quads: &[PrimitivePair],
    floors: &[f64],
    points: &[Vec3],
    displacement: &[Vec3],
) -> StepFractions {
    fractions_within(ROUNDS_MOST, quads, floors, points, displacement)
}

fn fractions_within(
    rounds_most: usize,
    quads: &[PrimitivePair],
    floors: &[f64],
    points: &[Vec3],
    displacement: &[Vec3],
) -> StepFractions {
    let sound: Vec<bool> =
        points.iter().zip(displacement).map(|(x, d)| (x.sum() + d.sum()).is_finite()).collect();
    let mut fraction: Vec<f64> = sound.iter().map(|&sound| if sound { 1.0 } else { 0.0 }).collect();
    let still = Vec3::zeros();
    let mut motion: Vec<Vec3> =
        displacement.iter().zip(&sound).map(|(d, &sound)| if sound { *d } else { still }).collect();
    // Ways only ever become shorter: pairs whose swept boxes are apart at first stay so.
    let near = near(quads, floors, points, &motion);
    let mut active = near.clone();
    let mut first_hits = Vec::new();
    let mut fallen_back = 0;
    let mut rounds = 0;
    let mut factor = vec![1.0f64; points.len()];
    while !active.is_empty() {
        rounds += 1;
        let hits = hits(&active, quads, floors, points, &motion);
        if hits.is_empty() {
            break;
        }
        if rounds == 1 {
            first_hits.clone_from(&hits);
        }
        if rounds >= rounds_most {
            fallen_back = fall_back(&hits, &first_hits, quads, &sound, &mut fraction);
            break;
        }
        let slowed = slow_down(&hits, quads, displacement, &mut factor, &mut fraction, &mut motion);
        let concerned = |k: &u32| quads[*k as usize].points.iter().any(|p| slowed[p.at()]);
        active = near.iter().copied().filter(concerned).collect();
    }
    let least = fraction.iter().copied().fold(1.0, f64::min);
    let slowed = fraction.iter().filter(|&&f| f < 1.0).count();
    StepFractions { fraction, least, slowed, rounds, fallen_back }
}

/// Boxes around the ways of all points.
pub fn swept_boxes(points: &[Vec3], motion: &[Vec3]) -> Vec<SweptBox> {
    let swept = |(x, d): (&Vec3, &Vec3)| {
        let known = x.sum().is_finite();
        if known { SweptBox::of_point(x, &(x + d)) } else { SweptBox::EVERYWHERE }
    };
    points.iter().zip(motion).map(swept).collect()
}

/// The pairs whose swept boxes come as near as their floor, in order.
fn near(quads: &[PrimitivePair], floors: &[f64], points: &[Vec3], motion: &[Vec3]) -> Vec<u32> {
    let boxes = swept_boxes(points, motion);
    let pairs = quads.par_iter().zip(floors).enumerate();
    let near = pairs.filter(|(_, (quad, floor))| !stay_apart(quad, &boxes, **floor));
    near.map(|(k, _)| k as u32).collect()
}

/// Of the `active` pairs those that are not free, with the fraction each may go, in the order of `active`.
fn hits(
    active: &[u32],
    quads: &[PrimitivePair],
    floors: &[f64],
    points: &[Vec3],
    motion: &[Vec3],
) -> Vec<(u32, f64)> {
    let test = |&k: &u32| {
        let t = quads[k as usize].step(points, motion, floors[k as usize]);
        (t < 1.0).then_some((k, t))
    };
    let parts: Vec<Vec<(u32, f64)>> =
        active.par_chunks(CHUNK).map(|chunk| chunk.iter().filter_map(test).collect()).collect();
    parts.concat()
}

/// Whether the boxes swept by the two pieces of a pair are further apart than its floor [m].
#[inline]
pub fn stay_apart(quad: &PrimitivePair, boxes: &[SweptBox], floor: f64) -> bool {
    let [a, b, c, d] = quad.points.map(|p| &boxes[p.at()]);
    let (first, second) = match quad.kind {
        PairKind::PointTriangle => (*a, b.joined(c).joined(d)),
        PairKind::EdgeEdge => (a.joined(b), c.joined(d)),
    };
    !floor.is_nan() && !first.near(&second, SweptBox::reach(floor))
}

/// Slows the points of every pair that was hit, each by the smallest of its pairs' fractions; gives, one per point,
/// whether it was slowed.
fn slow_down(
    hits: &[(u32, f64)],
    quads: &[PrimitivePair],
    displacement: &[Vec3],
    factor: &mut [f64],
    fraction: &mut [f64],
    motion: &mut [Vec3],
) -> Vec<bool> {
    factor.fill(1.0);
    for &(k, t) in hits {
        for p in quads[k as usize].points {
            factor[p.at()] = factor[p.at()].min(t);
        }
    }
    let mut slowed = vec![false; factor.len()];
    for p in 0..factor.len() {
        // One that stands still already changes nothing for its pairs.
        if factor[p] < 1.0 && fraction[p] > 0.0 {
            fraction[p] *= factor[p];
            motion[p] = displacement[p] * fraction[p];
            slowed[p] = true;
        }
    }
    slowed
}

/// Gives every connected part that still has a hit one fraction: the smallest that any of its pairs got in the first
/// round. Returns the number of points concerned.
///
/// That this is safe: in the first round every pair was tested with all four points at fraction 1 and found safe up
/// to its t. When the points of a part all have the fraction g, a pair of that part moves, from time 0 to 1, exactly
/// as it did in the first round from time 0 to g; and g <= t for each of them, so it stays above its floor. (Points
/// that are not finite stayed still then and still do.) Pairs of other parts share no point with it, keep their own
/// motion, and were found free with it in the round they were last tested.
fn fall_back(
    hits: &[(u32, f64)],
    first_hits: &[(u32, f64)],
    quads: &[PrimitivePair],
    sound: &[bool],
    fraction: &mut [f64],
) -> usize {
    let mut parts = Parts::new(fraction.len());
    for quad in quads {
        for p in &quad.points[1..] {
            parts.join(quad.points[0].0, p.0);
        }
    }
    let mut unsettled = vec![false; fraction.len()];
    for &(k, _) in hits {
        unsettled[parts.of(quads[k as usize].points[0].0) as usize] = true;
    }
    let mut least = vec![1.0f64; fraction.len()];
    for &(k, t) in first_hits {
        let part = parts.of(quads[k as usize].points[0].0) as usize;
        least[part] = least[part].min(t);
    }
    let mut concerned = 0;
    for p in 0..fraction.len() {
        let part = parts.of(p as u32) as usize;
        if unsettled[part] {
            concerned += 1;
            if sound[p] {
                fraction[p] = least[part];
            }
        }
    }
    concerned
}

/// Connected parts of a graph over points (union-find with path halving); the lowest point stands for its part.
struct Parts(Vec<u32>);

impl Parts {
    fn new(count: usize) -> Self {
        Self((0..count as u32).collect())
    }

    fn of(&mut self, mut p: u32) -> u32 {
        while self.0[p as usize] != p {
            self.0[p as usize] = self.0[self.0[p as usize] as usize];
            p = self.0[p as usize];
        }
        p
    }

    fn join(&mut self, a: u32, b: u32) {
        let (a, b) = (self.of(a), self.of(b));
        self.0[a.max(b) as usize] = a.min(b);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::contact::broad_phase::CandidateFinder;
    use crate::math::Rng;
    use crate::mesh::intersections::self_intersections;
    use crate::mesh::{PointIndex, Topology};

    /// `layers` sheets of n x n squares of 8 mm, `apart` \[m\] above each other, each turned a little.
    fn pile(layers: usize, n: usize, apart: f64) -> (Vec<Vec3>, Vec<[PointIndex; 3]>) {
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

    /// The candidates of a motion as quads.
    fn quads(points: &[Vec3], triangles: &[[PointIndex; 3]], displacement: &[Vec3]) -> Vec<PrimitivePair> {
        let topology = Topology::new(points.len(), triangles);
        let mut finder = CandidateFinder::new(points, triangles, &topology);
        let end: Vec<Vec3> = points.iter().zip(displacement).map(|(x, d)| x + d).collect();
        let found = finder.find(points, &end, 1e-3, false, &|_| false);
        found.quads(&finder).collect()
    }

    /// Walks each pair through its motion in steps within which its gap cannot close.
    fn assert_apart(quads: &[PrimitivePair], floors: &[f64], points: &[Vec3], motion: &[Vec3]) {
        for (quad, &floor) in quads.iter().zip(floors) {
            let (x, dx) = (quad.gather(points), quad.gather(motion));
            let floor = floor.min(0.5 * quad.gap(points).distance);
            let speed: f64 = dx.iter().map(|d| d.norm()).sum();
            let mut time = 0.0;
            while time < 1.0 && speed > 0.0 {
                let now = [0, 1, 2, 3].map(|i| x[i] + dx[i] * time);
                let room = quad.kind.gap(&now).distance - floor;
                assert!(room > 0.0, "{quad:?} at {time}: {room}");
                time += room / speed;
            }
        }
    }

    /// A pile whose layers are thrown through each other, each point its own way, 20 gaps a step.
    fn thrown(layers: usize) -> (Vec<Vec3>, Vec<[PointIndex; 3]>, Vec<Vec3>) {
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
        let quads = quads(&points, &triangles, &displacement);
        assert!(quads.len() > 1000);
        let found = local_step_fractions(&quads, &vec![5e-4; quads.len()], &points, &displacement);
        assert_eq!((found.least, found.slowed, found.rounds, found.fallen_back), (1.0, 0, 1, 0));
        assert!(local_step_fractions(&[], &[], &points, &displacement).least == 1.0);
    }

    #[test]
    fn layers_thrown_through_each_other_stay_apart() {
        let (points, triangles, displacement) = thrown(8);
        let quads = quads(&points, &triangles, &displacement);
        let floors = vec![2e-4; quads.len()];
        let found = local_step_fractions(&quads, &floors, &points, &displacement);
        assert!(found.fraction.iter().all(|&f| f > 0.0 && f <= 1.0));
        let motion = found.apply(&displacement);
        assert_apart(&quads, &floors, &points, &motion);
        let end: Vec<Vec3> = points.iter().zip(&motion).map(|(x, d)| x + d).collect();
        assert!(self_intersections(&end, &triangles).is_empty());
        let whole: Vec<Vec3> = points.iter().zip(&displacement).map(|(x, d)| x + d).collect();
        assert!(self_intersections(&whole, &triangles).len() > 100, "the motion must be one that crosses");
        println!("rounds {} least {} slowed {}", found.rounds, found.least, found.slowed);
        assert_eq!(found.fallen_back, 0);
    }

    /// One tight spot must not hold the rest of the garment.
    #[test]
    fn only_points_near_a_hit_are_slowed() {
        let (points, triangles) = pile(2, 12, 1e-3);
        let mut displacement = vec![Vec3::new(0.0, 0.0, 2e-3); points.len()];
        displacement[0].z = 40e-3;
        let quads = quads(&points, &triangles, &displacement);
        let found = local_step_fractions(&quads, &vec![1e-4; quads.len()], &points, &displacement);
        assert!(found.fraction[0] < 0.1, "{}", found.fraction[0]);
        assert!(found.slowed < 30, "{} of {}", found.slowed, points.len());
    }

    /// However few rounds it gets, the answer is safe: then one fraction for each connected part.
    #[test]
    fn falling_back_is_safe_and_keeps_to_its_part() {
        let (mut points, mut triangles, mut displacement) = thrown(4);
        // A second pile far away, that is free.
        let (far, far_triangles) = pile(2, 2, 1e-3);
        let base = points.len() as u32;
        points.extend(far.iter().map(|x| x + Vec3::x() * 10.0));
        triangles.extend(far_triangles.iter().map(|t| t.map(|p| PointIndex(p.0 + base))));
        displacement.resize(points.len(), Vec3::new(0.0, 0.0, 1e-3));
        let quads = quads(&points, &triangles, &displacement);
        let floors = vec![3e-4; quads.len()];
        for rounds in 1..4 {
            let found = fractions_within(rounds, &quads, &floors, &points, &displacement);
            assert_eq!(found.rounds, rounds);
            assert!(found.fallen_back > 50 && found.fallen_back <= base as usize);
            assert!(found.least > 0.0);
            assert!(found.fraction[base as usize..].iter().all(|&f| f == 1.0));
            assert_apart(&quads, &floors, &points, &found.apply(&displacement));
        }
    }

    #[test]
    fn the_same_for_any_number_of_threads_and_any_order_of_pairs() {
        let (points, triangles, displacement) = thrown(5);
        let mut quads = quads(&points, &triangles, &displacement);
        let floors = vec![2e-4; quads.len()];
        let run = |quads: &[PrimitivePair], threads: usize| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build();
            let Ok(pool) = pool else { panic!("no threads") };
            pool.install(|| local_step_fractions(quads, &floors, &points, &displacement))
        };
        let one = run(&quads, 1);
        assert_eq!(run(&quads, 3), one);
        quads.reverse();
        assert_eq!(run(&quads, 2), one);
    }

    #[test]
    fn points_that_are_not_finite_stand_still_and_stop_only_who_would_hit_them() {
        let (points, triangles) = pile(2, 4, 1e-3);
        let mut displacement = vec![Vec3::new(0.0, 0.0, -2e-3); points.len()];
        displacement[30] = Vec3::new(0.0, f64::NAN, 0.0);
        displacement[31].x = f64::INFINITY;
        let quads = quads(&points, &triangles, &displacement);
        let floors = vec![1e-4; quads.len()];
        let found = local_step_fractions(&quads, &floors, &points, &displacement);
        assert_eq!((found.fraction[30], found.fraction[31]), (0.0, 0.0));
        assert!(found.fraction.iter().enumerate().all(|(i, &f)| f > 0.0 || i == 30 || i == 31));
        let motion = found.apply(&displacement);
        assert!(motion.iter().all(|d| d.sum().is_finite()));
        assert_apart(&quads, &floors, &points, &motion);
    }

    #[test]
    fn pairs_below_their_floor_may_part() {
        let points = [Vec3::new(0.2, 0.2, 1e-4), Vec3::zeros(), Vec3::x(), Vec3::y()];
        let quad = PrimitivePair { kind: PairKind::PointTriangle, points: [0, 1, 2, 3].map(PointIndex) };
        let mut displacement = [Vec3::zeros(); 4];
        displacement[0].z = 1.0;
        let found = local_step_fractions(&[quad], &[1e-3], &points, &displacement);
        assert_eq!(found.least, 1.0);
        displacement[0].z = -1.0;
        let found = local_step_fractions(&[quad], &[1e-3], &points, &displacement);
        assert!(found.least > 0.0 && found.least < 5e-5);
    }
}
