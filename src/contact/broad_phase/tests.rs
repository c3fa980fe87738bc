use super::*;
use crate::math::Rng;
use std::collections::BTreeSet;
use std::time::Instant;

struct Mesh {
    points: Vec<Vec3>,
    triangles: Vec<[PointIndex; 3]>,
    topology: Topology,
}

impl Mesh {
    /// `layers` sheets of nearly equilateral triangles with sides of 8 mm, `nx` by `ny` cells, `apart` \[m\] above
    /// each other, each shifted by part of a cell and shaken by `shake` \[m\].
    fn pile(layers: usize, nx: usize, ny: usize, apart: f64, shake: f64) -> Self {
        let (mut points, mut triangles) = (Vec::new(), Vec::new());
        let mut rng = Rng::from_state(31);
        for layer in 0..layers {
            let base = points.len() as u32;
            for i in 0..(nx + 1) * (ny + 1) {
                let (column, row) = ((i % (nx + 1)) as f64, (i / (nx + 1)) as f64);
                let x = 8e-3 * (column + 0.5 * (row % 2.0) + 0.37 * layer as f64);
                let flat = Vec3::new(x, 8e-3 * 0.866 * row, apart * layer as f64);
                points.push(flat + rng.in_cube() * shake);
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

fn shaken(points: &[Vec3], by: f64, rng: &mut Rng) -> Vec<Vec3> {
    points.iter().map(|x| x + rng.in_cube() * by).collect()
}

/// Every pair that comes within the reach for any fractions must be there; tried at random fractions.
fn assert_complete(mesh: &Mesh, end: &[Vec3], reach: f64, found: &Candidates, rng: &mut Rng) {
    let finder = mesh.finder();
    let quads: BTreeSet<PrimitivePair> = found.quads(&finder).collect();
    assert_eq!(quads.len(), found.len(), "no pair twice");
    let mut near = 0;
    for _ in 0..4 {
        let now: Vec<Vec3> =
            mesh.points.iter().zip(end).map(|(x, y)| x + (y - x) * rng.uniform().sqrt()).collect();
        let mut check = |quad: PrimitivePair| {
            let shared = (0..4).any(|i| (0..i).any(|j| quad.points[i] == quad.points[j]));
            if !shared && quad.gap(&now).distance <= reach {
                near += 1;
                assert!(quads.contains(&quad), "{quad:?} is missing");
            }
        };
        for p in 0..mesh.points.len() as u32 {
            (0..mesh.triangles.len() as u32).for_each(|f| check(finder.quad_point_triangle(p, f)));
        }
        for e in 0..mesh.topology.edges.len() as u32 {
            (0..e).for_each(|f| check(finder.quad_edge_edge(f, e)));
        }
    }
    assert!(near > 100, "only {near} pairs are near");
}

#[test]
fn no_pair_that_may_come_near_is_missing() {
    let mesh = Mesh::pile(3, 6, 5, 1e-3, 2e-4);
    let mut rng = Rng::from_state(5);
    for (way, reach) in [(0.0, 3e-3), (1e-3, 2e-3), (8e-3, 1e-3), (2e-2, 0.0)] {
        let end = shaken(&mesh.points, way, &mut rng);
        let found = mesh.finder().find(&mesh.points, &end, reach, false, &|_| false);
        if way < 1e-2 {
            assert_complete(&mesh, &end, reach, &found, &mut rng);
        }
        assert!(found.point_triangle.is_sorted() && found.edge_edge.is_sorted());
        assert!(found.edge_edge.iter().all(|[e, f]| e < f));
    }
}

/// Around a portion that moves while the rest does not: the same pairs as a search of everything, less those that rest.
#[test]
fn around_a_portion_no_pair_is_missing_and_none_too_many() {
    let mesh = Mesh::pile(4, 6, 5, 1e-3, 2e-4);
    let mut rng = Rng::from_state(9);
    let moving: Vec<bool> = (0..mesh.points.len()).map(|p| p % 11 < 2).collect();
    for way in [0.0, 1e-3, 8e-3] {
        let all = shaken(&mesh.points, way, &mut rng);
        let ends = mesh.points.iter().zip(&all).zip(&moving);
        let end: Vec<Vec3> = ends.map(|((x, y), moving)| if *moving { *y } else { *x }).collect();
        let rests = |quad: PrimitivePair| quad.points.iter().all(|p| !moving[p.at()]);
        for together in [false, true] {
            let wanted = mesh.finder().find(&mesh.points, &end, 2e-3, together, &rests);
            let mut finder = mesh.finder();
            let portion = finder.portion(&moving, &mesh.points, 2e-3);
            // What is found does not depend on where the portion went before.
            let elsewhere = shaken(&mesh.points, 4e-3, &mut rng);
            for (target, told) in [(&elsewhere, false), (&all, true)] {
                let to = |p: usize| if moving[p] { target[p] } else { mesh.points[p] };
                let end: Vec<Vec3> = (0..moving.len()).map(to).collect();
                let found = finder.find_around(&portion, &mesh.points, &end, 2e-3, together, &rests);
                assert!(!told || found == wanted, "{way} {together}");
            }
            assert!(wanted.len() > 100, "{}", wanted.len());
        }
    }
}

#[test]
fn what_is_kept_gives_the_same_answers() {
    let mesh = Mesh::pile(3, 12, 10, 1.2e-3, 3e-4);
    let (mut kept, mut anew) = (mesh.finder(), mesh.finder());
    let mut rng = Rng::from_state(3);
    let reach = 1.5e-3;
    let skip = |quad: PrimitivePair| quad.points.iter().all(|p| p.at() % 3 == 0);
    let mut x = mesh.points.clone();
    let mut served = [0; 3];
    for round in 0..60 {
        let mut end = x.clone();
        if round % 2 == 1 {
            // Everything a little, or a corner far as well, or all of it.
            let few = if round % 6 == 5 { x.len() } else { x.len() / 20 * (round % 4) };
            end = shaken(&x, 2e-5, &mut rng);
            end[..few].iter_mut().for_each(|x| *x += rng.in_cube() * 2e-3);
        }
        let together = round % 3 == 0;
        let found = kept.find_again(&x, &end, reach, together, &skip);
        assert_eq!(found, anew.find(&x, &end, reach, together, &skip), "round {round}");
        match kept.far(&x, &end, reach) {
            None => served[0] += 1,
            Some(far) => served[1 + usize::from(far.contains(&true))] += 1,
        }
        x = end;
        let moving: Vec<bool> = (0..x.len()).map(|p| p % 90 < 20).collect();
        let portion = kept.portion(&moving, &x, reach);
        let some = |by: f64, rng: &mut Rng| -> Vec<Vec3> {
            x.iter().zip(&moving).map(|(x, m)| if *m { x + rng.in_cube() * by } else { *x }).collect()
        };
        for by in [1e-5, 1e-3] {
            let end = some(by, &mut rng);
            let found = kept.find_around(&portion, &x, &end, reach, false, &skip);
            let fresh = anew.portion(&moving, &x, reach);
            assert!(fresh.known.is_none());
            assert_eq!(found, anew.find_around(&fresh, &x, &end, reach, false, &skip), "round {round}");
        }
    }
    assert!(served.iter().all(|count| *count > 5), "without, with and partly with the list: {served:?}");
}

#[test]
fn at_rest_the_candidates_are_exactly_the_pairs_within_reach() {
    let mesh = Mesh::pile(3, 6, 5, 1e-3, 2e-4);
    let mut finder = mesh.finder();
    for reach in [1.2e-3, 3e-3, 6e-3] {
        let found = finder.find(&mesh.points, &mesh.points, reach, false, &|_| false);
        assert!(found.quads(&finder).all(|q| q.gap(&mesh.points).distance <= reach * (1.0 + 2.0 * ROUNDING)));
        let mut rng = Rng::from_state(6);
        assert_complete(&mesh, &mesh.points, reach, &found, &mut rng);
    }
}

#[test]
fn the_answer_knows_no_history_and_no_threads() {
    let mesh = Mesh::pile(3, 12, 12, 1e-3, 2e-4);
    let mut rng = Rng::from_state(8);
    let (mut old, mut at) = (mesh.finder(), mesh.points.clone());
    for _ in 0..5 {
        let start = shaken(&at, 6e-3, &mut rng);
        let end = shaken(&start, 2e-3, &mut rng);
        let expected = mesh.finder().find(&start, &end, 2e-3, false, &|_| false);
        for threads in [1, 3] {
            let Ok(pool) = rayon::ThreadPoolBuilder::new().num_threads(threads).build() else {
                panic!("no threads")
            };
            let found = pool.install(|| old.find(&start, &end, 2e-3, false, &|_| false));
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
    let all = finder.find(&mesh.points, &mesh.points, 2e-3, false, &|_| false);
    assert!(all.point_triangle.iter().all(|pair| pair[0] != lone));
    let without = |quad: &PrimitivePair| !quad.points.contains(&PointIndex(6));
    let some = finder.find(&mesh.points, &mesh.points, 2e-3, false, &|q| q.points.contains(&PointIndex(6)));
    assert!(all.quads(&finder).filter(without).eq(some.quads(&finder)) && some.len() < all.len());
    mesh.points[6].x = f64::NAN;
    // Its triangles are left out whole, and with them the pairs of what belongs to them.
    let finite = finder.find(&mesh.points, &mesh.points, 2e-3, false, &|_| false);
    assert!(finite.quads(&finder).all(|quad| without(&quad)) && finite.len() > all.len() / 2);
}

#[test]
fn rest_distance_is_that_of_the_rest_shape() {
    let mesh = Mesh::pile(1, 4, 4, 1e-3, 0.0);
    let points = [0, 1, 6, 7].map(PointIndex);
    assert_eq!(rest_distance(PairKind::EdgeEdge, [0, 1, 3, 4].map(PointIndex), &mesh.points), 16e-3);
    assert!(rest_distance(PairKind::PointTriangle, points, &mesh.points) > 0.0);
}

/// Seconds of a whole garment of 14,000 points. Run by: cargo test --release --lib speed -- --ignored --nocapture
#[test]
#[ignore = "a measurement"]
fn speed() {
    let time = |what: &str, run: &mut dyn FnMut() -> usize| {
        let mut best = f64::INFINITY;
        let mut count = 0;
        for _ in 0..30 {
            let begin = Instant::now();
            count = run();
            best = best.min(begin.elapsed().as_secs_f64());
        }
        println!("  {what}: {:.1} ms, {count}", best * 1e3);
    };
    for (name, mesh) in [
        ("2 layers 5 mm apart", Mesh::pile(2, 82, 82, 5e-3, 2e-4)),
        ("2 layers 1 mm apart", Mesh::pile(2, 82, 82, 1e-3, 1e-4)),
        ("8 layers 1 mm apart", Mesh::pile(8, 41, 41, 1e-3, 1e-4)),
        ("8 layers 0.5 mm apart", Mesh::pile(8, 41, 41, 5e-4, 5e-5)),
    ] {
        println!("{name}: {} points, {} triangles", mesh.points.len(), mesh.triangles.len());
        let mut rng = Rng::from_state(1);
        let mut finder = mesh.finder();
        let x = mesh.points.clone();
        time("candidates, reach 3 mm, at rest", &mut || finder.find(&x, &x, 3e-3, false, &|_| false).len());
        time("candidates, reach 1 mm, at rest", &mut || finder.find(&x, &x, 1e-3, false, &|_| false).len());
        let end = shaken(&x, 1e-3, &mut rng);
        time("candidates, reach 1 mm, way 1 mm", &mut || {
            finder.find(&x, &end, 1e-3, false, &|_| false).len()
        });
        let found = finder.find(&x, &end, 1e-3, false, &|_| false);
        println!("    {} + {}", found.point_triangle.len(), found.edge_edge.len());
        let mut quads: Vec<PrimitivePair> = Vec::new();
        time("quads", &mut || {
            quads.clear();
            quads.extend(found.quads(&finder));
            quads.len()
        });
        let d: Vec<Vec3> = x.iter().zip(&end).map(|(x, y)| y - x).collect();
        let floors = vec![2e-4; quads.len()];
        time("local step fractions (rounds)", &mut || {
            crate::contact::step_bounds::local_step_fractions(&quads, &floors, &x, &d).rounds
        });
        time("distances", &mut || quads.iter().filter(|q| q.gap(&x).distance < 1e-3).count());
        time("crossings", &mut || crate::mesh::intersections::self_intersections(&x, &mesh.triangles).len());
    }
}
