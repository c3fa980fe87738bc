//! Exact intersections of triangles: the count that reports give and that contact never raises.
//!
//! Two triangles intersect when each has corners strictly on both sides of the other's plane and the two segments they
//! cut from the line of both planes overlap by more than a point (Guigue and Devillers, "Fast and robust
//! triangle-triangle overlap test using orientation predicates", 2003). Every decision is the sign of a determinant,
//! found exactly (Shewchuk's predicates, package `robust`), so the answer has no tolerance. Touching, lying in one
//! plane, and sharing a point do not count.
//!
//! This module is independent of the code that prevents intersections, but for the bounding-volume hierarchy, and can therefore judge it.

use crate::math::Vec3;
use crate::mesh::PointIndex;
use crate::mesh::triangle::corners;
use crate::mesh::triangle_bvh::TriangleBvh;
use rayon::prelude::*;
use robust::{Coord3D, orient3d};

/// Returns the pairs of triangles of one mesh that intersect, lower index first, sorted. Pairs with a common point and triangles with a
/// corner that is not finite are left out.
///
/// ```
/// use crease_geometry::math::Vec3;
/// use crease_geometry::mesh::PointIndex;
/// use crease_geometry::mesh::intersections::self_intersections;
/// let points = [[-1.0, 0.0, -1.0], [1.0, 0.0, -1.0], [0.0, 0.0, 1.0], [0.0, -1.0, 0.0], [-1.0, 2.0, 0.0], [1.0, 2.0, 0.0]];
/// let triangles = [[0, 1, 2], [3, 4, 5]].map(|t| t.map(PointIndex));
/// assert_eq!(self_intersections(&points.map(Vec3::from), &triangles), [[0, 1]]);
/// ```
pub fn self_intersections(points: &[Vec3], triangles: &[[PointIndex; 3]]) -> Vec<[u32; 2]> {
    let intersecting = |(a, b): (u32, u32)| {
        let (first, second) = (&triangles[a as usize], &triangles[b as usize]);
        let shared = first.iter().any(|p| second.contains(p));
        let intersect = !shared && triangles_intersect(&corners(points, first), &corners(points, second));
        intersect.then(|| [a.min(b), a.max(b)])
    };
    let near = TriangleBvh::new(points, triangles, 0.0).overlaps();
    let mut found: Vec<_> = near.into_par_iter().filter_map(intersecting).collect();
    found.sort_unstable();
    found
}

/// Returns the triangles of one mesh that intersect another, as [`self_intersections`] finds them, each once, sorted.
pub fn self_intersecting_triangles(points: &[Vec3], triangles: &[[PointIndex; 3]]) -> Vec<u32> {
    let mut found: Vec<u32> = self_intersections(points, triangles).into_iter().flatten().collect();
    found.sort_unstable();
    found.dedup();
    found
}

/// Returns the pairs (triangle of the first mesh, triangle of the second) that intersect, sorted.
pub fn intersections_between(
    points: &[Vec3],
    triangles: &[[PointIndex; 3]],
    other_points: &[Vec3],
    other_triangles: &[[PointIndex; 3]],
) -> Vec<[u32; 2]> {
    IntersectionSearch::default().pairs([(points, triangles), (other_points, other_triangles)]).to_vec()
}

/// Search for the intersections of two meshes that move between searches: its hierarchies are refitted, and where nothing has moved the last
/// result is returned.
#[derive(Default)]
pub struct IntersectionSearch {
    hierarchies: [Option<TriangleBvh>; 2],
    /// Positions of the points at the last search [m].
    points: [Vec<Vec3>; 2],
    pairs: Vec<[u32; 2]>,
}

impl IntersectionSearch {
    /// Returns the pairs (triangle of the first mesh, triangle of the second) that intersect, sorted. A mesh is positions of its points \[m\]
    /// and triangles; those of the last search may be others.
    pub fn pairs(&mut self, meshes: [(&[Vec3], &[[PointIndex; 3]]); 2]) -> &[[u32; 2]] {
        let is_known = self.hierarchies.iter().zip(&self.points).zip(meshes).all(|((bvh, known), mesh)| {
            bvh.as_ref().is_some_and(|bvh| bvh.is_over(mesh.1)) && known == mesh.0
        });
        if !is_known {
            self.search(meshes);
        }
        &self.pairs
    }

    fn search(&mut self, meshes: [(&[Vec3], &[[PointIndex; 3]]); 2]) {
        let [(x, triangles), (other_x, other_triangles)] = meshes;
        let [bvh, other] = &mut self.hierarchies;
        let other = TriangleBvh::fitted(other, other_x, other_triangles, 0.0);
        let near = TriangleBvh::fitted(bvh, x, triangles, 0.0).overlapping_pairs_with(other);
        let intersects = |[a, b]: &[u32; 2]| {
            let first = corners(x, &triangles[*a as usize]);
            triangles_intersect(&first, &corners(other_x, &other_triangles[*b as usize]))
        };
        self.pairs = near.into_par_iter().filter(intersects).collect();
        self.points = meshes.map(|(points, _)| points.to_vec());
    }
}

/// Returns the side of the plane a b c on which the point d lies, exactly: 1, 0 or -1.
fn side(a: &Vec3, b: &Vec3, c: &Vec3, d: &Vec3) -> i8 {
    let at = |v: &Vec3| Coord3D { x: v.x, y: v.y, z: v.z };
    let determinant = orient3d(at(a), at(b), at(c), at(d));
    i8::from(determinant > 0.0) - i8::from(determinant < 0.0)
}

/// Whether two triangles intersect, exactly.
pub fn triangles_intersect(a: &[Vec3; 3], b: &[Vec3; 3]) -> bool {
    let of_a = [0, 1, 2].map(|i| side(&b[0], &b[1], &b[2], &a[i]));
    if !both_sides(&of_a) {
        return false;
    }
    let of_b = [0, 1, 2].map(|i| side(&a[0], &a[1], &a[2], &b[i]));
    if !both_sides(&of_b) {
        return false;
    }
    let (mut a, of_a) = lone_corner_first(a, of_a);
    let (mut b, of_b) = lone_corner_first(b, of_b);
    // Flip each triangle so that the lone corner of the other lies on its positive side.
    if of_b[0] < 0 {
        a.swap(1, 2);
    }
    if of_a[0] < 0 {
        b.swap(1, 2);
    }
    // The cuts of the sides 0-1 and 0-2 now follow each other forward along the common line for a, backward for b:
    // a's first cut must come before b's first, and b's second before a's second.
    side(&a[0], &a[1], &b[0], &b[1]) < 0 && side(&a[0], &a[2], &b[2], &b[0]) < 0
}

fn both_sides(sides: &[i8; 3]) -> bool {
    sides.contains(&1) && sides.contains(&-1)
}

/// Returns the corners rotated so that the first is alone on its side (the others on the other side or in the plane).
fn lone_corner_first(corners: &[Vec3; 3], sides: [i8; 3]) -> ([Vec3; 3], [i8; 3]) {
    let sum: i8 = sides.iter().sum();
    // Two against one: the one opposes the sum. One each and one in the plane: either may be taken.
    let lone = if sum > 0 { -1 } else { 1 };
    let k = sides.iter().position(|&s| s == lone).unwrap_or(0);
    let turn = [k, (k + 1) % 3, (k + 2) % 3];
    (turn.map(|i| corners[i]), turn.map(|i| sides[i]))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::Rng;

    fn triangle(rng: &mut Rng) -> [Vec3; 3] {
        [0; 3].map(|_| rng.in_unit_cube())
    }

    /// Does the segment p q pass through the inside of the triangle? The plain definition, as an oracle.
    fn pierces(p: &Vec3, q: &Vec3, t: &[Vec3; 3]) -> bool {
        let (from, to) = (side(&t[0], &t[1], &t[2], p), side(&t[0], &t[1], &t[2], q));
        let turns = [0, 1, 2].map(|k| side(p, q, &t[k], &t[(k + 1) % 3]));
        from * to < 0 && turns[0] != 0 && turns.iter().all(|&s| s == turns[0])
    }

    fn some_edge_pierces(a: &[Vec3; 3], b: &[Vec3; 3]) -> bool {
        (0..3).any(|k| pierces(&a[k], &a[(k + 1) % 3], b) || pierces(&b[k], &b[(k + 1) % 3], a))
    }

    #[test]
    fn agrees_with_edges_that_pierce_in_every_order_of_corners() {
        let mut rng = Rng::from_state(9);
        let mut count = 0;
        for _ in 0..20_000 {
            let (a, b) = (triangle(&mut rng), triangle(&mut rng));
            let expected = some_edge_pierces(&a, &b);
            count += usize::from(expected);
            for i in 0..3 {
                let mut turned = [a[i], a[(i + 1) % 3], a[(i + 2) % 3]];
                assert_eq!(triangles_intersect(&turned, &b), expected);
                turned.swap(0, 2);
                assert_eq!(triangles_intersect(&turned, &b), expected);
                assert_eq!(triangles_intersect(&b, &turned), expected);
            }
        }
        assert!(count > 2_000 && count < 18_000, "{count}");
    }

    #[test]
    fn touching_and_coplanar_do_not_count_and_edge_through_edge_does() {
        let at = Vec3::new;
        let floor = [at(-1.0, -1.0, 0.0), at(2.0, -1.0, 0.0), at(-1.0, 2.0, 0.0)];
        let flap = |low: f64| [at(0.0, 0.0, low), at(0.3, 0.1, 1.0), at(-0.3, 0.1, 1.0)];
        assert!(!triangles_intersect(&floor, &flap(0.0)), "a corner touches");
        assert!(!triangles_intersect(&floor, &flap(1e-300)));
        assert!(triangles_intersect(&floor, &flap(-1e-300)), "no tolerance");
        let stands = [at(0.0, 0.0, 0.0), at(0.3, 0.1, 0.0), at(0.0, 0.0, 1.0)];
        assert!(!triangles_intersect(&floor, &stands), "an edge touches");
        assert!(!triangles_intersect(&floor, &floor.map(|x| x + at(0.1, 0.1, 0.0))), "one plane");
        assert!(!triangles_intersect(&floor, &[floor[0]; 3]), "no area");
        // A fin whose edges pass exactly through two sides of the floor: no edge pierces an inside.
        let (p, q) = (at(-1.0, 0.0, 0.0), at(0.0, -1.0, 0.0));
        let fin = [at(-0.5, -0.5, 2.0), p * 2.0 - at(-0.5, -0.5, 2.0), q * 2.0 - at(-0.5, -0.5, 2.0)];
        assert!(!some_edge_pierces(&floor, &fin));
        assert!(triangles_intersect(&floor, &fin));
        // A fin shifted so that the segments only touch end to end.
        let beside = fin.map(|x| x + (q - p));
        assert!(!triangles_intersect(&floor, &beside));
    }

    #[test]
    fn one_mesh_against_itself_and_two_meshes() {
        let mut rng = Rng::from_state(10);
        let points: Vec<Vec3> =
            (0..120).flat_map(|_| triangle(&mut rng).map(|x| x * 0.3).map(|x| x + Vec3::z())).collect();
        let triangles: Vec<[PointIndex; 3]> =
            (0..120u32).map(|f| [0, 1, 2].map(|k| PointIndex((3 * f + k * 5) % 360))).collect();
        let cross = |i: usize, j: usize| {
            triangles_intersect(&corners(&points, &triangles[i]), &corners(&points, &triangles[j]))
        };
        let all = (0..120).flat_map(|i| (0..120).map(move |j| (i, j))).filter(|&(i, j)| cross(i, j));
        let every: Vec<[u32; 2]> = all.map(|(i, j)| [i as u32, j as u32]).collect();
        assert_eq!(intersections_between(&points, &triangles, &points, &triangles), every);
        let have_common_point =
            |p: &[u32; 2]| triangles[p[0] as usize].iter().any(|c| triangles[p[1] as usize].contains(c));
        let own: Vec<_> = every.into_iter().filter(|p| p[0] < p[1] && !have_common_point(p)).collect();
        assert!(own.len() > 100);
        assert_eq!(self_intersections(&points, &triangles), own);
    }

    #[test]
    fn a_search_finds_in_meshes_that_move_what_it_would_find_anew() {
        let mut rng = Rng::from_state(13);
        let mut mesh = || -> Vec<Vec3> { (0..40).flat_map(|_| triangle(&mut rng)).collect() };
        let [mut points, other_points] = [mesh(), mesh()];
        let triangles: Vec<_> = (0..40u32).map(|f| [0, 1, 2].map(|k| PointIndex(3 * f + k))).collect();
        let mut search = IntersectionSearch::default();
        // Also without a motion, and with fewer triangles from one search to the next.
        for (step, count) in [(0.0, 40), (0.05, 40), (0.0, 40), (0.0, 25), (0.8, 25), (0.05, 40)] {
            points.iter_mut().for_each(|x| x.y += step);
            let anew = intersections_between(&points, &triangles[..count], &other_points, &triangles);
            assert!(step > 0.5 || !anew.is_empty());
            assert_eq!(search.pairs([(&points, &triangles[..count]), (&other_points, &triangles)]), anew);
        }
    }

    #[test]
    fn triangles_that_are_not_finite_intersect_nothing() {
        let mut rng = Rng::from_state(12);
        let mut points: Vec<Vec3> = (0..40).flat_map(|_| triangle(&mut rng)).collect();
        let triangles: Vec<_> = (0..40u32).map(|f| [0, 1, 2].map(|k| PointIndex(3 * f + k))).collect();
        let before = self_intersections(&points, &triangles);
        points[0].x = f64::NAN;
        points[4].x = f64::INFINITY;
        let without: Vec<_> = before.into_iter().filter(|p| p[0] > 1).collect();
        assert_eq!(self_intersections(&points, &triangles), without);
    }
}
