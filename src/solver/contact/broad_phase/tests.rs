use super::search_query::ROUNDING;
use super::*;

use crease_geometry::math::{Rng, Vec3};

use crease_geometry::mesh::{PointIndex, Topology};
use std::collections::BTreeSet;

struct Mesh {
    points: Vec<Vec3>,
    triangles: Vec<[PointIndex; 3]>,
    topology: Topology,
}

impl Mesh {
    /// `layers` sheets of nearly equilateral triangles with sides of 8 mm, `nx` by `ny` cells, `apart` \[m\] above
    /// each other, each shifted by part of a cell and jittered by `jitter` \[m\].
    fn pile(layers: usize, nx: usize, ny: usize, apart: f64, jitter: f64) -> Self {
        let (mut points, mut triangles) = (Vec::new(), Vec::new());
        let mut rng = Rng::from_state(31);
        for layer in 0..layers {
            let base = points.len() as u32;
            for i in 0..(nx + 1) * (ny + 1) {
                let (column, row) = ((i % (nx + 1)) as f64, (i / (nx + 1)) as f64);
                let x = 8e-3 * (column + 0.5 * (row % 2.0) + 0.37 * layer as f64);
                let flat = Vec3::new(x, 8e-3 * 0.866 * row, apart * layer as f64);
                points.push(flat + rng.in_cube() * jitter);
            }
            for i in 0..nx * ny {
                let (column, row) = (i % nx, i / nx);
                let a = base + (row * (nx + 1) + column) as u32;
                let (b, c, d) = (a + 1, a + nx as u32 + 1, a + nx as u32 + 2);
                let two = if row % 2 == 0 { [[a, b, c], [b, d, c]] } else { [[a, b, d], [a, d, c]] };
                triangles.extend(two.map(|t| t.map(PointIndex)));
            }
        }
        let topology = Topology::new(points.len(), &triangles);
        Self { points, triangles, topology }
    }

    fn finder(&self) -> CandidateFinder {
        CandidateFinder::new(&self.points, &self.triangles, &self.topology)
    }
}

/// A query for a motion.
fn query<'a>(
    start: &'a [Vec3],
    end: &'a [Vec3],
    distance: f64,
    uniform_step: bool,
    skip: &'a (dyn Fn(PrimitivePair) -> bool + Sync),
) -> SearchQuery<'a> {
    SearchQuery { start, end, distance, uniform_step, skip }
}

fn jittered(points: &[Vec3], by: f64, rng: &mut Rng) -> Vec<Vec3> {
    points.iter().map(|x| x + rng.in_cube() * by).collect()
}

/// Asserts that every pair that comes within `distance` for any fractions is there, tried at random fractions.
fn assert_complete(mesh: &Mesh, end: &[Vec3], distance: f64, found: &Candidates, rng: &mut Rng) {
    let finder = mesh.finder();
    let pairs: BTreeSet<PrimitivePair> = finder.pairs(found).collect();
    assert_eq!(pairs.len(), found.len(), "no pair twice");
    let mut near = 0;
    for _ in 0..4 {
        let now: Vec<Vec3> =
            mesh.points.iter().zip(end).map(|(x, y)| x + (y - x) * rng.uniform().sqrt()).collect();
        let mut check = |pair: PrimitivePair| {
            let shared = (0..4).any(|i| (0..i).any(|j| pair.points[i] == pair.points[j]));
            if !shared && pair.distance(&now) <= distance {
                near += 1;
                assert!(pairs.contains(&pair), "{pair:?} is missing");
            }
        };
        for p in 0..mesh.points.len() as u32 {
            (0..mesh.triangles.len() as u32).for_each(|f| check(finder.mesh.point_triangle_pair(p, f)));
        }
        for e in 0..mesh.topology.edges.len() as u32 {
            (0..e).for_each(|f| check(finder.mesh.edge_edge_pair(f, e)));
        }
    }
    assert!(near > 100, "only {near} pairs are near");
}

#[test]
fn no_pair_that_may_come_near_is_missing() {
    let mesh = Mesh::pile(3, 6, 5, 1e-3, 2e-4);
    let mut rng = Rng::from_state(5);
    for (length, distance) in [(0.0, 3e-3), (1e-3, 2e-3), (8e-3, 1e-3), (2e-2, 0.0)] {
        let end = jittered(&mesh.points, length, &mut rng);
        let found = mesh.finder().find(query(&mesh.points, &end, distance, false, &|_| false));
        if length < 1e-2 {
            assert_complete(&mesh, &end, distance, &found, &mut rng);
        }
        assert!(found.point_triangle.is_sorted() && found.edge_edge.is_sorted());
        assert!(found.edge_edge.iter().all(|[e, f]| e < f));
    }
}

/// Around a subset that moves while the rest does not: the same pairs as a search of everything, less those that rest.
#[test]
fn around_a_subset_no_pair_is_missing_and_none_too_many() {
    let mesh = Mesh::pile(4, 6, 5, 1e-3, 2e-4);
    let mut rng = Rng::from_state(9);
    let moving: Vec<bool> = (0..mesh.points.len()).map(|p| p % 11 < 2).collect();
    for length in [0.0, 1e-3, 8e-3] {
        let all = jittered(&mesh.points, length, &mut rng);
        let ends = mesh.points.iter().zip(&all).zip(&moving);
        let end: Vec<Vec3> = ends.map(|((x, y), moving)| if *moving { *y } else { *x }).collect();
        let rests = |pair: PrimitivePair| pair.points.iter().all(|p| !moving[p.at()]);
        for uniform in [false, true] {
            let wanted = mesh.finder().find(query(&mesh.points, &end, 2e-3, uniform, &rests));
            let mut finder = mesh.finder();
            let subset = finder.moving_subset(&moving, &mesh.points, 2e-3);
            // The result does not depend on where the subset went before.
            let elsewhere = jittered(&mesh.points, 4e-3, &mut rng);
            for (target, last) in [(&elsewhere, false), (&all, true)] {
                let to = |p: usize| if moving[p] { target[p] } else { mesh.points[p] };
                let end: Vec<Vec3> = (0..moving.len()).map(to).collect();
                let found = finder.find_around(&subset, query(&mesh.points, &end, 2e-3, uniform, &rests));
                assert!(!last || found == wanted, "{length} {uniform}");
            }
            assert!(wanted.len() > 100, "{}", wanted.len());
        }
    }
}

#[test]
fn a_verlet_list_gives_the_same_answers() {
    let mesh = Mesh::pile(3, 12, 10, 1.2e-3, 3e-4);
    let (mut cached, mut anew) = (mesh.finder(), mesh.finder());
    let mut rng = Rng::from_state(3);
    let distance = 1.5e-3;
    let skip = |pair: PrimitivePair| pair.points.iter().all(|p| p.at() % 3 == 0);
    let mut x = mesh.points.clone();
    let mut served = [0; 3];
    for round in 0..60 {
        let mut end = x.clone();
        if round % 2 == 1 {
            // Everything a little, or a corner far as well, or all of it.
            let few = if round % 6 == 5 { x.len() } else { x.len() / 20 * (round % 4) };
            end = jittered(&x, 2e-5, &mut rng);
            end[..few].iter_mut().for_each(|x| *x += rng.in_cube() * 2e-3);
        }
        let uniform = round % 3 == 0;
        let found = cached.find_cached(query(&x, &end, distance, uniform, &skip));
        assert_eq!(found, anew.find(query(&x, &end, distance, uniform, &skip)), "round {round}");
        match cached.verlet_list.outside_skin(&cached.mesh, &x, &end, distance) {
            None => served[0] += 1,
            Some(outside) => served[1 + usize::from(outside.contains(&true))] += 1,
        }
        x = end;
        let moving: Vec<bool> = (0..x.len()).map(|p| p % 90 < 20).collect();
        let subset = cached.moving_subset(&moving, &x, distance);
        let some = |by: f64, rng: &mut Rng| -> Vec<Vec3> {
            x.iter().zip(&moving).map(|(x, m)| if *m { x + rng.in_cube() * by } else { *x }).collect()
        };
        for by in [1e-5, 1e-3] {
            let end = some(by, &mut rng);
            let found = cached.find_around(&subset, query(&x, &end, distance, false, &skip));
            let fresh = anew.moving_subset(&moving, &x, distance);
            assert!(fresh.cached.is_none());
            assert_eq!(
                found,
                anew.find_around(&fresh, query(&x, &end, distance, false, &skip)),
                "round {round}"
            );
        }
    }
    assert!(served.iter().all(|count| *count > 5), "without, with and partly with the list: {served:?}");
}

#[test]
fn at_rest_the_candidates_are_exactly_the_pairs_within_the_distance() {
    let mesh = Mesh::pile(3, 6, 5, 1e-3, 2e-4);
    let mut finder = mesh.finder();
    for distance in [1.2e-3, 3e-3, 6e-3] {
        let found = finder.find(query(&mesh.points, &mesh.points, distance, false, &|_| false));
        assert!(finder.pairs(&found).all(|q| q.distance(&mesh.points) <= distance * (1.0 + 2.0 * ROUNDING)));
        let mut rng = Rng::from_state(6);
        assert_complete(&mesh, &mesh.points, distance, &found, &mut rng);
    }
}

#[test]
fn candidates_depend_neither_on_history_nor_on_threads() {
    let mesh = Mesh::pile(3, 12, 12, 1e-3, 2e-4);
    let mut rng = Rng::from_state(8);
    let (mut old, mut at) = (mesh.finder(), mesh.points.clone());
    for _ in 0..5 {
        let start = jittered(&at, 6e-3, &mut rng);
        let end = jittered(&start, 2e-3, &mut rng);
        let expected = mesh.finder().find(query(&start, &end, 2e-3, false, &|_| false));
        for threads in [1, 3] {
            let Ok(pool) = rayon::ThreadPoolBuilder::new().num_threads(threads).build() else {
                panic!("no threads")
            };
            let found = pool.install(|| old.find(query(&start, &end, 2e-3, false, &|_| false)));
            assert!(found == expected);
        }
        at = end;
    }
}

#[test]
fn skipped_pairs_isolated_points_and_points_not_finite_are_left_out() {
    let mut mesh = Mesh::pile(2, 4, 4, 1e-3, 0.0);
    let lone = mesh.points.len() as u32;
    mesh.points.push(Vec3::new(0.01, 0.01, 5e-4));
    mesh.topology = Topology::new(mesh.points.len(), &mesh.triangles);
    let mut finder = mesh.finder();
    let all = finder.find(query(&mesh.points, &mesh.points, 2e-3, false, &|_| false));
    assert!(all.point_triangle.iter().all(|pair| pair[0] != lone));
    let without = |pair: &PrimitivePair| !pair.points.contains(&PointIndex(6));
    let some =
        finder.find(query(&mesh.points, &mesh.points, 2e-3, false, &|q| q.points.contains(&PointIndex(6))));
    assert!(finder.pairs(&all).filter(without).eq(finder.pairs(&some)) && some.len() < all.len());
    mesh.points[6].x = f64::NAN;
    // Its triangles are left out whole, and with them the pairs of what belongs to them.
    let finite = finder.find(query(&mesh.points, &mesh.points, 2e-3, false, &|_| false));
    assert!(finder.pairs(&finite).all(|pair| without(&pair)) && finite.len() > all.len() / 2);
}
