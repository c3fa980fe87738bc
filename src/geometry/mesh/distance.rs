//! Distances of primitives: point and triangle, edge and edge.
//!
//! Each function returns [`ClosestPoints`]: the vector between the two closest points, its length, and that vector as signed
//! weights of the corner points, so that a force along the gap spreads over the points by the same weights. These
//! are the primitive pairs of Li et al., "Incremental Potential Contact" (2020). The
//! closest feature is found by looking only at the sides that face the other primitive, with cross products instead
//! of differences of dot products, which keeps needles and nearly parallel edges accurate.
//!
//! Degenerate primitives (zero length, zero area) are treated as the point or edge they have shrunk to. Coordinates
//! that are not finite give a distance that is not finite. For barriers see `contact`.

use crate::math::Vec3;
use crate::mesh::tuning::TUNING;

/// Closest points of two primitives.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ClosestPoints {
    /// Vector from the closest point of the second primitive to the closest point of the first \[m\].
    pub vector: Vec3,
    /// Length of `vector` \[m\].
    pub distance: f64,
    /// Signed barycentric weights: `vector` = sum of `weights[i] * x[i]`, in the order of the arguments. The
    /// gradient of `distance` by `x[i]` is `weights[i] * vector / distance`.
    pub weights: [f64; 4],
}

impl ClosestPoints {
    #[inline]
    fn new(vector: Vec3, weights: [f64; 4]) -> Self {
        Self { vector, distance: vector.norm(), weights }
    }
}

/// Returns the coordinate along the edge `a` to `b` of the point closest to `p`, 0 to 1; 0 on an edge without length.
#[inline]
pub fn along_edge(p: &Vec3, a: &Vec3, b: &Vec3) -> f64 {
    let edge = b - a;
    let length_squared = edge.norm_squared();
    let t = (p - a).dot(&edge) / length_squared;
    // Written so that 0/0 gives 0.
    if t > 0.0 { t.min(1.0) } else { 0.0 }
}

/// Returns the barycentric coordinates in a triangle of `p`, which lies in its plane; those of the first corner where it has no area.
pub fn barycentric(p: &Vec3, [a, b, c]: &[Vec3; 3]) -> [f64; 3] {
    let (u, v, w) = (b - a, c - a, p - a);
    let (uu, uv, vv, wu, wv) = (u.dot(&u), u.dot(&v), v.dot(&v), w.dot(&u), w.dot(&v));
    let determinant = uu * vv - uv * uv;
    if determinant <= 0.0 {
        return [1.0, 0.0, 0.0];
    }
    let (s, t) = ((vv * wu - uv * wv) / determinant, (uu * wv - uv * wu) / determinant);
    [1.0 - s - t, s, t]
}

/// Returns the closest points of the point `p` and the triangle `a b c`; weights `[1, -wa, -wb, -wc]`.
#[inline]
pub fn point_triangle(p: &Vec3, a: &Vec3, b: &Vec3, c: &Vec3) -> ClosestPoints {
    let (v, w) = foot_on_triangle(p, a, b, c);
    ClosestPoints::new((p - a) - (b - a) * v - (c - a) * w, [1.0, v + w - 1.0, -v, -w])
}

/// Returns the squared distance \[m²\] of the point `p` and the triangle `a b c`, where nothing else is needed.
#[inline(always)]
pub fn point_triangle_squared(p: &Vec3, a: &Vec3, b: &Vec3, c: &Vec3) -> f64 {
    let (v, w) = foot_on_triangle(p, a, b, c);
    ((p - a) - (b - a) * v - (c - a) * w).norm_squared()
}

/// Returns the closest point of the triangle, as barycentric coordinates of b and c.
#[inline(always)]
fn foot_on_triangle(p: &Vec3, a: &Vec3, b: &Vec3, c: &Vec3) -> (f64, f64) {
    let (ab, ac, ap) = (b - a, c - a, p - a);
    let normal = ab.cross(&ac);
    let area_squared = normal.norm_squared();
    let has_area = area_squared > TUNING.max_sliver_squared_sine * ab.norm_squared() * ac.norm_squared();
    if !has_area {
        return foot_on_sliver(p, [a, b, c]);
    }
    // Barycentric coordinates of the foot of p, times area_squared.
    let wb = ap.dot(&ac.cross(&normal));
    let wc = ap.dot(&normal.cross(&ab));
    let wa = area_squared - wb - wc;
    if wa >= 0.0 && wb >= 0.0 && wc >= 0.0 {
        return (wb / area_squared, wc / area_squared);
    }
    // Outside: the closest point lies on a side that faces p, and those are the sides with a negative coordinate.
    nearest_side(p, [a, b, c], [wc < 0.0, wa < 0.0, wb < 0.0])
}

/// Returns the closest point of a triangle without area: on any of its sides. Corners that are not finite end here, too, and stay so.
#[cold]
fn foot_on_sliver(p: &Vec3, corners: [&Vec3; 3]) -> (f64, f64) {
    if corners.iter().map(|x| x.sum()).sum::<f64>().is_finite() {
        nearest_side(p, corners, [true; 3])
    } else {
        (f64::NAN, f64::NAN)
    }
}

/// Returns the closest point on those of the sides ab, bc, ca for which `asked` is set.
fn nearest_side(p: &Vec3, corners: [&Vec3; 3], asked: [bool; 3]) -> (f64, f64) {
    let (mut best, mut foot) = (f64::INFINITY, (f64::NAN, f64::NAN));
    for (k, asked) in asked.into_iter().enumerate() {
        if asked {
            let (a, b) = (corners[k], corners[(k + 1) % 3]);
            let t = along_edge(p, a, b);
            let squared = ((p - a) - (b - a) * t).norm_squared();
            if squared < best {
                best = squared;
                foot = [(t, 0.0), (1.0 - t, t), (0.0, 1.0 - t)][k];
            }
        }
    }
    foot
}

/// Returns the closest points of the edges `a0 a1` and `b0 b1`; weights `[1-s, s, -(1-t), -t]`. Parallel edges that run side
/// by side are joined in the middle of their overlap.
#[inline]
pub fn edge_edge(a0: &Vec3, a1: &Vec3, b0: &Vec3, b1: &Vec3) -> ClosestPoints {
    let (s, t) = feet_on_edges(a0, a1, b0, b1);
    let vector = (a0 - b0) + (a1 - a0) * s - (b1 - b0) * t;
    ClosestPoints::new(vector, [1.0 - s, s, t - 1.0, -t])
}

/// Returns the squared distance \[m²\] of the edges `a0 a1` and `b0 b1`, where nothing else is needed.
#[inline(always)]
pub fn edge_edge_squared(a0: &Vec3, a1: &Vec3, b0: &Vec3, b1: &Vec3) -> f64 {
    let (s, t) = feet_on_edges(a0, a1, b0, b1);
    ((a0 - b0) + (a1 - a0) * s - (b1 - b0) * t).norm_squared()
}

/// Returns the coordinates of the closest points along each edge, 0 to 1.
#[inline(always)]
fn feet_on_edges(a0: &Vec3, a1: &Vec3, b0: &Vec3, b1: &Vec3) -> (f64, f64) {
    let (u, v, w) = (a1 - a0, b1 - b0, b0 - a0);
    let normal = u.cross(&v);
    let scale = normal.norm_squared();
    let have_angle = scale > TUNING.max_parallel_squared_sine * u.norm_squared() * v.norm_squared();
    if !have_angle {
        return feet_on_parallels(a0, a1, b0, b1);
    }
    // Feet of the common perpendicular of the two lines, times scale.
    let s = w.dot(&v.cross(&normal));
    let t = w.dot(&u.cross(&normal));
    if s >= 0.0 && s <= scale && t >= 0.0 && t <= scale {
        return (s / scale, t / scale);
    }
    // The closest pair lies on a side of the parallelogram (s, t) that faces the origin.
    nearest_end([a0, a1, b0, b1], [s < 0.0, s > scale, t < 0.0, t > scale])
}

/// Returns the closest points among those for which `asked` is set: end a0 to edge b, a1 to b, b0 to a, b1 to a.
fn nearest_end(x: [&Vec3; 4], asked: [bool; 4]) -> (f64, f64) {
    let [a0, a1, b0, b1] = x;
    let (mut best, mut feet) = (f64::INFINITY, (f64::NAN, f64::NAN));
    for (k, asked) in asked.into_iter().enumerate() {
        if asked {
            let (s, t) = match k {
                0 => (0.0, along_edge(a0, b0, b1)),
                1 => (1.0, along_edge(a1, b0, b1)),
                2 => (along_edge(b0, a0, a1), 0.0),
                _ => (along_edge(b1, a0, a1), 1.0),
            };
            let squared = ((a0 - b0) + (a1 - a0) * s - (b1 - b0) * t).norm_squared();
            if squared < best {
                (best, feet) = (squared, (s, t));
            }
        }
    }
    feet
}

/// Returns the closest points of edges too parallel for a common perpendicular, or without length. Ends that are not finite end here, too,
/// and stay so.
#[cold]
fn feet_on_parallels(a0: &Vec3, a1: &Vec3, b0: &Vec3, b1: &Vec3) -> (f64, f64) {
    if !(a0 + a1 + b0 + b1).sum().is_finite() {
        return (f64::NAN, f64::NAN);
    }
    let (s0, s1) = (along_edge(b0, a0, a1), along_edge(b1, a0, a1));
    if s0 == s1 {
        return nearest_end([a0, a1, b0, b1], [true; 4]);
    }
    let s = 0.5 * (s0 + s1);
    (s, along_edge(&(a0 + (a1 - a0) * s), b0, b1))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::Rng;

    /// Four random points.
    fn four(rng: &mut Rng) -> [Vec3; 4] {
        [0; 4].map(|_| rng.in_cube() * 0.5)
    }

    type Pair = fn(&[Vec3; 4]) -> ClosestPoints;
    fn pairs() -> [(&'static str, Pair); 2] {
        [
            ("point-triangle", |x| point_triangle(&x[0], &x[1], &x[2], &x[3])),
            ("edge-edge", |x| edge_edge(&x[0], &x[1], &x[2], &x[3])),
        ]
    }

    #[test]
    fn vector_is_the_weighted_sum_of_the_points() {
        let mut rng = Rng::from_state(1);
        for (name, gap) in pairs() {
            for _ in 0..20_000 {
                let x = four(&mut rng);
                let g = gap(&x);
                let sum: Vec3 = (0..4).map(|i| x[i] * g.weights[i]).sum();
                assert!((sum - g.vector).norm() < 1e-14, "{name}: {x:?}");
                assert!((g.distance - g.vector.norm()).abs() < 1e-15);
                let squared = if name == "edge-edge" { edge_edge_squared } else { point_triangle_squared };
                assert!((squared(&x[0], &x[1], &x[2], &x[3]).sqrt() - g.distance).abs() < 1e-15);
                assert!(g.weights.iter().sum::<f64>().abs() < 1e-15, "{name}");
            }
        }
    }

    /// Optimality: a convex problem has found its minimum when no corner lies nearer along the gap.
    #[test]
    fn nothing_lies_nearer_than_the_closest_points() {
        let mut rng = Rng::from_state(2);
        for k in 0..100_000 {
            let mut x = four(&mut rng);
            if k % 3 == 0 {
                // Needles and nearly parallel edges.
                let bend = rng.in_cube() * 0.5 * 10f64.powf(-12.0 * rng.uniform());
                x[3] = x[1] + (x[2] - x[1]) * (3.0 * rng.uniform() - 1.0) + bend;
            }
            let g = point_triangle(&x[0], &x[1], &x[2], &x[3]);
            let n = g.vector / g.distance;
            let support = (1..4).map(|i| n.dot(&(x[0] - x[i]))).fold(f64::INFINITY, f64::min);
            assert!(support > g.distance - 1e-9, "point-triangle {k}: {support} {} {x:?}", g.distance);

            if k % 3 == 0 {
                let bend = rng.in_cube() * 0.5 * 10f64.powf(-12.0 * rng.uniform());
                x[3] = x[2] + (x[1] - x[0]) * (4.0 * rng.uniform() - 2.0) + bend;
            }
            let g = edge_edge(&x[0], &x[1], &x[2], &x[3]);
            let n = g.vector / g.distance;
            let support = [(0, 2), (0, 3), (1, 2), (1, 3)]
                .iter()
                .map(|&(i, j)| n.dot(&(x[i] - x[j])))
                .fold(f64::INFINITY, f64::min);
            assert!(support > g.distance - 3e-8, "edge-edge {k}: {support} {} {x:?}", g.distance);
        }
    }

    /// The interior of each feature region: three vertices, three sides, the face; ends and interiors of edges.
    #[test]
    fn gradient_is_weight_times_direction_in_every_region() {
        let (a, b, c) = (Vec3::new(0.0, 0.0, 0.0), Vec3::new(1.0, 0.1, 0.0), Vec3::new(0.2, 0.9, 0.3));
        let centre = (a + b + c) / 3.0;
        let lift = (b - a).cross(&(c - a)).normalize() * 0.3;
        let mut scenes: Vec<(usize, [Vec3; 4])> = Vec::new();
        for foot in [a, b, c, (a + b) / 2.0, (b + c) / 2.0, (c + a) / 2.0] {
            scenes.push((0, [centre + (foot - centre) * 1.8 + lift, a, b, c]));
        }
        scenes.push((0, [centre + lift, a, b, c]));
        let (b0, b1) = (Vec3::new(0.1, 0.2, 0.5), Vec3::new(0.3, 1.0, 0.7));
        for start in [-1.5, -0.45, 0.5, 1.9] {
            for shift in [-2.0, -0.6, 0.0, 1.0, 3.0] {
                let a0 = Vec3::new(start - 0.5, shift * 0.5 + 0.5, 0.0);
                scenes.push((1, [a0, a0 + Vec3::new(1.0, -0.2, 0.1), b0, b1]));
            }
        }
        let mut kinds = std::collections::BTreeSet::new();
        for (kind, x) in scenes {
            let gap = pairs()[kind].1;
            let g = gap(&x);
            kinds.insert((kind, g.weights.map(|w| w == 0.0)));
            for i in 0..4 {
                for axis in 0..3 {
                    let h = 1e-6;
                    let (mut up, mut down) = (x, x);
                    up[i][axis] += h;
                    down[i][axis] -= h;
                    let slope = (gap(&up).distance - gap(&down).distance) / (2.0 * h);
                    let expected = g.weights[i] * g.vector[axis] / g.distance;
                    assert!((slope - expected).abs() < 1e-8, "{x:?} point {i} axis {axis}");
                }
            }
        }
        assert_eq!(kinds.len(), 16, "7 regions of a triangle, 9 of two edges: {kinds:?}");
    }

    #[test]
    fn degenerate_primitives_are_the_point_or_edge_they_shrank_to() {
        let (p, a, b) = (Vec3::new(0.3, 1.0, 0.0), Vec3::zeros(), Vec3::new(1.0, 0.0, 0.0));
        for (x, y, z) in [(a, b, b), (a, a, b), (b, a, a), (a, b, a), (a, b, (a + b) / 2.0), (a, b * 0.5, b)]
        {
            let g = point_triangle(&p, &x, &y, &z);
            assert!((g.distance - 1.0).abs() < 1e-15, "{g:?}");
        }
        assert!((point_triangle(&p, &a, &a, &a).distance - p.norm()).abs() < 1e-15);
        assert!((edge_edge(&p, &p, &a, &b).distance - 1.0).abs() < 1e-15);
        assert!((edge_edge(&a, &b, &p, &p).distance - 1.0).abs() < 1e-15);
        assert!((edge_edge(&p, &p, &a, &a).distance - p.norm()).abs() < 1e-15);
        assert_eq!(edge_edge(&a, &b, &(b * 0.5), &p).distance, 0.0);
    }

    #[test]
    fn parallel_edges_meet_in_the_middle_of_their_overlap() {
        let at = |x: f64, y: f64| Vec3::new(x, y, 0.0);
        let g = edge_edge(&at(0.0, 1.0), &at(4.0, 1.0), &at(2.0, 0.0), &at(8.0, 0.0));
        assert_eq!(g.weights, [0.25, 0.75, -(5.0 / 6.0), -(1.0 / 6.0)]);
        assert_eq!(g.vector, at(0.0, 1.0));
        let back = edge_edge(&at(0.0, 1.0), &at(4.0, 1.0), &at(8.0, 0.0), &at(2.0, 0.0));
        assert_eq!(back.vector, at(0.0, 1.0));
        let apart = edge_edge(&at(0.0, 1.0), &at(1.0, 1.0), &at(2.0, 0.0), &at(3.0, 0.0));
        assert_eq!(apart.vector, at(-1.0, 1.0));
    }

    #[test]
    fn not_finite_in_gives_not_finite_out() {
        let nan = Vec3::new(f64::NAN, 0.0, 0.0);
        let (a, b, c) = (Vec3::zeros(), Vec3::x(), Vec3::y());
        assert!(!point_triangle(&nan, &a, &b, &c).distance.is_finite());
        assert!(!point_triangle(&c, &a, &nan, &b).distance.is_finite());
        assert!(!edge_edge(&a, &nan, &b, &c).distance.is_finite());
        assert!(!edge_edge(&a, &b, &c, &nan).distance.is_finite());
    }
}
