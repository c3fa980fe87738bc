//! Bending across edges of more than two triangles: where a collar, a placket or a pocket is sewn on.
//!
//! Every wing of such an edge is joined with the one it continues in best in the source pose, by a hinge of its own:
//!
//! ```text
//! E = 1/2 k (theta - source)²,     k = B_n l² / (A1 + A2)
//! ```
//!
//! with B_n the bending stiffness across the edge, l its length and A1, A2 the areas of the wings: the curvature theta / w of a strip
//! of the width w = (A1 + A2) / l. Junctions remember nothing. The Hessian is Gauss-Newton, which is positive by construction.

use crate::energy::term::Energy;
use crate::energy::tuning::TUNING;
use crease_geometry::math::Vec3;
use crease_geometry::mesh::{PointIndex, hinge_angle, hinge_gradient, triangle, unwrap_angle};
use crease_linear::{BlockSink, add_symmetric};
use crease_model::fabric::Fabric;
use crease_model::garment::Garment;

/// Two wings of a junction that continue in one another.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Junction {
    /// The edge, and the opposite points of both wings.
    points: [u32; 4],
    /// Both wings.
    triangles: [u32; 2],
    /// Angle in the source pose [rad].
    source_angle: f64,
    /// Bending stiffness k [N·m].
    stiffness: f64,
}

/// Bending across the junctions of a garment.
#[derive(Debug, Clone, Default)]
pub struct Junctions(Vec<Junction>);

impl Junctions {
    /// Returns the junctions of `garment` made of `fabric`.
    pub fn new(garment: &Garment, fabric: &Fabric) -> Self {
        let topology = &garment.topology;
        let mut found = Vec::new();
        for (f, edges) in topology.triangle_edges.iter().enumerate() {
            for (k, &e) in edges.iter().enumerate().filter(|(_, e)| topology.edge_valence[**e as usize] > 2) {
                found.push((e, f as u32, k));
            }
        }
        found.sort_unstable();
        let mut junctions = Vec::new();
        for wings in found.chunk_by(|a, b| a.0 == b.0) {
            let mut pairs: Vec<[usize; 2]> =
                (0..wings.len()).filter_map(|w| Some(ordered(w, best_partner(garment, wings, w)?))).collect();
            pairs.sort_unstable();
            pairs.dedup();
            junctions.extend(pairs.into_iter().map(|pair| junction(garment, fabric, pair.map(|w| wings[w]))));
        }
        Self(junctions)
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.0.is_empty()
    }

    /// Multiplies the stiffness of every junction by the mean of the `factors` of its wings, one per triangle [-].
    pub fn reinforce(&mut self, factors: &[f64]) {
        for junction in &mut self.0 {
            let [a, b] = junction.triangles.map(|f| factors[f as usize]);
            junction.stiffness *= 0.5 * (a + b);
        }
    }

    /// Angle of a junction at `x` beyond that of the source pose [rad].
    fn bend(junction: &Junction, x: &[Vec3]) -> f64 {
        let angle = hinge_angle(&junction.points.map(|p| x[p as usize]));
        unwrap_angle(angle, junction.source_angle) - junction.source_angle
    }
}

/// A wing: its edge, its triangle and the side of the triangle that the edge is.
type Wing = (u32, u32, usize);

fn ordered(a: usize, b: usize) -> [usize; 2] {
    if a < b { [a, b] } else { [b, a] }
}

/// The points of the hinge of two wings: the edge as it runs in the first, the opposite point of either.
fn hinge_points(garment: &Garment, [a, b]: [Wing; 2]) -> [PointIndex; 4] {
    let (t, u) = (garment.triangles[a.1 as usize], garment.triangles[b.1 as usize]);
    [t[a.2], t[(a.2 + 1) % 3], t[(a.2 + 2) % 3], u[(b.2 + 2) % 3]]
}

/// The wing that wing `w` of `wings` continues in best, `None` if all others are folded back on it.
fn best_partner(garment: &Garment, wings: &[Wing], w: usize) -> Option<usize> {
    let bend = |other: usize| {
        let points = hinge_points(garment, [wings[w], wings[other]]);
        hinge_angle(&points.map(|p| garment.points[p.at()])).abs()
    };
    let others = (0..wings.len()).filter(|&other| other != w).map(|other| (bend(other), other));
    let (angle, partner) = others.min_by(|a, b| a.0.total_cmp(&b.0))?;
    (angle < TUNING.max_junction_angle).then_some(partner)
}

fn junction(garment: &Garment, fabric: &Fabric, wings: [Wing; 2]) -> Junction {
    let points = hinge_points(garment, wings);
    let triangles = wings.map(|w| w.1);
    let x = points.map(|p| garment.points[p.at()]);
    let [a, b] = triangles
        .map(|f| triangle::area(&triangle::corners(&garment.points, &garment.triangles[f as usize])));
    let flat = &garment.material[triangles[0] as usize];
    let side = flat[(wings[0].2 + 1) % 3] - flat[wings[0].2];
    // Across the edge: the in-plane normal of the side (u, v) is (-v, u).
    let squared = side.norm_squared().max(f64::MIN_POSITIVE);
    let across =
        (side.y * side.y * fabric.bend_warp().sqrt() + side.x * side.x * fabric.bend_weft().sqrt()) / squared;
    let area = (a + b).max(f64::MIN_POSITIVE);
    // No stiffer than on wings as wide as a fraction of the edge: slivers are no cloth.
    let narrow = area.max(TUNING.min_altitude_ratio * squared);
    Junction {
        points: points.map(|p| p.0),
        triangles,
        source_angle: hinge_angle(&x),
        stiffness: across * across * squared / narrow,
    }
}

impl Energy for Junctions {
    fn name(&self) -> &'static str {
        "junctions"
    }

    fn value(&self, x: &[Vec3]) -> f64 {
        self.0.iter().map(|j| 0.5 * j.stiffness * Self::bend(j, x).powi(2)).sum()
    }

    fn add_gradient(&self, x: &[Vec3], out: &mut [Vec3]) {
        for junction in &self.0 {
            let Some(gradient) = hinge_gradient(&junction.points.map(|p| x[p as usize])) else { continue };
            let torque = junction.stiffness * Self::bend(junction, x);
            for (p, g) in junction.points.iter().zip(gradient) {
                out[*p as usize] += g * torque;
            }
        }
    }

    fn add_hessian(&self, x: &[Vec3], out: &mut dyn BlockSink) {
        for junction in self.0.iter().filter(|j| out.is_relevant(&j.points)).collect::<Vec<_>>() {
            let points = junction.points;
            let Some(gradient) = hinge_gradient(&points.map(|p| x[p as usize])) else { continue };
            for i in 0..4 {
                for j in 0..=i {
                    let block = gradient[i] * gradient[j].transpose() * junction.stiffness;
                    add_symmetric(out, points[i], points[j], &block);
                }
            }
        }
    }

    fn add_secant_hessian(&self, _x: &[Vec3], midpoint: &[Vec3], out: &mut dyn BlockSink) {
        self.add_hessian(midpoint, out);
    }

    fn visit_stencils(&self, visit: &mut dyn FnMut(&[u32])) {
        self.0.iter().for_each(|junction| visit(&junction.points));
    }

    fn restricted_to(&self, points: &[bool]) -> Option<Box<dyn Energy + '_>> {
        let near = self.0.iter().filter(|junction| junction.points.iter().any(|p| points[*p as usize]));
        Some(Box::new(Self(near.copied().collect())))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::energy::energy_checks::{
        check_gradient_and_hessian, check_restriction, check_rigid_motion, check_secant_of_a_rotation,
    };
    use crease_geometry::math::Vec2;

    /// A strip of two squares of 20 mm, left and right of z, and a flap of the size of one sewn onto the line between them and lying on
    /// the right one.
    fn strip_with_flap() -> Garment {
        let width = 0.02;
        let points: Vec<Vec3> = [
            [-width, 0.0, 0.0],
            [-width, 0.0, width],
            [0.0, 0.0, 0.0],
            [0.0, 0.0, width],
            [width, 0.0, 0.0],
            [width, 0.0, width],
            [width, 1e-3, 0.0],
            [width, 1e-3, width],
        ]
        .map(Vec3::from)
        .to_vec();
        let square = |[a, b, c, d]: [u32; 4]| [[a, b, c], [b, d, c]];
        let squares = [[0, 1, 2, 3], [2, 3, 4, 5], [2, 3, 6, 7]];
        let triangles: Vec<[u32; 3]> = squares.into_iter().flat_map(square).collect();
        let flat = |t: &[u32; 3]| t.map(|p| Vec2::new(points[p as usize].x, points[p as usize].z));
        let material = triangles.iter().map(flat).collect();
        Garment { material, ..Garment::of_triangles(points, &triangles) }
    }

    #[test]
    fn every_wing_is_joined_with_the_one_that_it_continues_in() {
        let (strip, fabric) = (strip_with_flap(), Fabric::preset("denim").expect("a preset"));
        assert_eq!(strip.topology.edge_valence.iter().filter(|valence| **valence == 3).count(), 1);
        let junctions = Junctions::new(&strip, &fabric);
        // Left with right and left with the flap; the flap is folded back on the right.
        assert_eq!(junctions.0.len(), 2);
        assert!(junctions.value(&strip.points) < 1e-20);
        // The flap alone is turned up by 0.3 about the line: one of the two bends.
        let turned = |turns: fn(usize) -> bool| -> Vec<Vec3> {
            let (sin, cos) = 0.3_f64.sin_cos();
            let turn = |x: &Vec3| Vec3::new(x.x * cos - x.y * sin, x.x * sin + x.y * cos, x.z);
            strip.points.iter().enumerate().map(|(p, x)| if turns(p) { turn(x) } else { *x }).collect()
        };
        let (flap, both) = (turned(|p| p >= 6), turned(|p| p >= 4));
        let [one, two] = [&flap, &both].map(|x| junctions.value(x));
        assert!(one > 0.0 && (two / one - 2.0).abs() < 0.15, "{one} {two}");
        // Cloth 20 mm long, bent across the line by 0.3 over 20 mm, along the warp.
        let expected = 0.5 * fabric.bend_warp() * 0.02 * 0.3 * 0.3 / 0.02;
        assert!((one / expected - 1.0).abs() < 0.02, "{one} {expected}");
    }

    #[test]
    fn gradient_and_hessian_match() {
        let (strip, fabric) = (strip_with_flap(), Fabric::preset("denim").expect("a preset"));
        let junctions = Junctions::new(&strip, &fabric);
        let bent: Vec<Vec3> = strip
            .points
            .iter()
            .enumerate()
            .map(|(p, x)| x + Vec3::new(0.001, 0.004, -0.003) * (1.7 * p as f64).sin())
            .collect();
        check_gradient_and_hessian(&junctions, &bent, 1e-8);
        check_rigid_motion(&junctions, &bent);
        check_secant_of_a_rotation(&junctions, &bent);
        let mut some = vec![false; bent.len()];
        some[bent.len() - 1] = true;
        check_restriction(&junctions, &bent, &some, 1e-4);
    }
}
