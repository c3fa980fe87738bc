//! One garment laid over another by places that belong together: landmarks that a person marked, or the joints of a
//! skeleton that both follow.
//!
//! First a similarity (turn, one scale, shift) in the sense of least squares (Umeyama 1991), then a spline that takes every place exactly to
//! where it belongs: displacements in between are sums of distances to the places, the biharmonic spline of three dimensions
//! (Duchon 1977, Bookstein 1989). So an arm that hangs here and is raised there goes along with its joints.

use crate::garment::SourceJoint;
use crate::math::{Mat3, Vec3};
use crate::transfer::GarmentSurface;
use nalgebra::DMatrix;

/// Places on a line, or nearly (second extent below this share of the first), say nothing of a turn.
const LINE: f64 = 0.05;
/// A joint also says how it is turned: by places this share of the garment's size away from it along its axes.
const BESIDE: f64 = 0.05;
/// Joints of one name, so many or more, are of one skeleton.
const FEW: usize = 3;
/// And so do its bones, at these shares of their lengths.
const ALONG: [f64; 2] = [1.0 / 3.0, 2.0 / 3.0];
/// No garment has a place farther away [m]: squares of larger numbers leave the range in which turns are found.
const FARTHEST: f64 = 1e6;
/// So many places are enough for any skeleton: the work grows with their cube.
const MOST: usize = 1500;
/// Places nearer than this share of that distance to one before are left out.
const CROWDED: f64 = 0.2;

/// A map of space.
#[derive(Debug, Clone)]
pub(super) struct Registration {
    /// Linear part and shift of the similarity.
    turn: Mat3,
    shift: Vec3,
    /// Where the similarity takes the places [m].
    centres: Vec<Vec3>,
    /// Displacement per metre of distance to each, and to all.
    weights: Vec<Vec3>,
    constant: Vec3,
}

impl Registration {
    /// The map that takes the first of each pair to the second [m]. Without three places off a line the spline goes over `rough`,
    /// a map that brings the garments together as well as is known without. `None` if no such map can be found.
    pub(super) fn fit(pairs: &[[Vec3; 2]], rough: (Mat3, Vec3)) -> Option<Self> {
        // Not written as `beyond`: what is no number is no place either.
        if !pairs.iter().flatten().all(|x| x.amax() < FARTHEST) {
            return None;
        }
        let (turn, shift) = similarity(pairs).unwrap_or(rough);
        let centres: Vec<Vec3> = pairs.iter().map(|[from, _]| turn * from + shift).collect();
        let n = pairs.len();
        let mut system = DMatrix::zeros(n + 1, n + 1);
        let mut rest = DMatrix::zeros(n + 1, 3);
        for i in 0..n {
            for j in 0..n {
                system[(i, j)] = (centres[i] - centres[j]).norm();
            }
            system[(i, n)] = 1.0;
            system[(n, i)] = 1.0;
            rest.fixed_view_mut::<1, 3>(i, 0).copy_from(&(pairs[i][1] - centres[i]).transpose());
        }
        let solution = system.lu().solve(&rest)?;
        let row = |i: usize| Vec3::new(solution[(i, 0)], solution[(i, 1)], solution[(i, 2)]);
        solution.iter().all(|w| w.is_finite()).then(|| Self {
            turn,
            shift,
            centres,
            weights: (0..n).map(row).collect(),
            constant: row(n),
        })
    }

    /// Where `point` goes [m].
    pub(super) fn place(&self, point: &Vec3) -> Vec3 {
        let near = self.turn * point + self.shift;
        let bent: Vec3 = self.centres.iter().zip(&self.weights).map(|(c, w)| w * (near - c).norm()).sum();
        near + bent + self.constant
    }

    /// `sheet` with its points where the map takes them; the warp goes along with its triangle.
    pub(super) fn apply(&self, sheet: &GarmentSurface) -> GarmentSurface {
        let points: Vec<Vec3> = sheet.points.iter().map(|p| self.place(p)).collect();
        let carried = |(t, w): (&[crate::mesh::PointIndex; 3], &Vec3)| {
            let sides = |x: &[Vec3]| {
                let [a, b, c] = t.map(|p| x[p.at()]);
                [b - a, c - a]
            };
            let ([u, v], [to_u, to_v]) = (sides(&sheet.points), sides(&points));
            // The warp as a sum of both sides.
            let normal = u.cross(&v);
            let size = normal.norm_squared().max(f64::MIN_POSITIVE);
            let (of_u, of_v) = (w.cross(&v).dot(&normal) / size, u.cross(w).dot(&normal) / size);
            (to_u * of_u + to_v * of_v).try_normalize(0.0).unwrap_or_else(Vec3::x)
        };
        let warp = sheet.warp.as_ref().map(|all| sheet.triangles.iter().zip(all).map(carried).collect());
        GarmentSurface { points, warp, ..sheet.clone() }
    }
}

/// Turn times scale, and shift, that bring the first of each pair nearest to the second. `None` for places on a line.
fn similarity(pairs: &[[Vec3; 2]]) -> Option<(Mat3, Vec3)> {
    let count = pairs.len().max(1) as f64;
    let mean = |k: usize| pairs.iter().map(|pair| pair[k]).sum::<Vec3>() / count;
    let [from, to] = [mean(0), mean(1)];
    let mut mixed = Mat3::zeros();
    let mut spread = [Mat3::zeros(); 2];
    for [a, b] in pairs {
        let (a, b) = (a - from, b - to);
        mixed += b * a.transpose();
        spread[0] += a * a.transpose();
        spread[1] += b * b.transpose();
    }
    for spread in &spread {
        let mut extents: Vec<f64> =
            spread.symmetric_eigenvalues().iter().map(|e| e.max(0.0).sqrt()).collect();
        extents.sort_unstable_by(|a, b| b.total_cmp(a));
        if extents[1] <= LINE * extents[0] {
            return None;
        }
    }
    let svd = mixed.try_svd(true, true, f64::EPSILON, 0)?;
    let (u, v_t) = (svd.u?, svd.v_t?);
    // A turn, no mirror: the least of the three directions gives way.
    let mut signs = Vec3::repeat(1.0);
    if (u * v_t).determinant() < 0.0 {
        signs[svd.singular_values.imin()] = -1.0;
    }
    let scale = svd.singular_values.dot(&signs) / spread[0].trace();
    let turn = u * Mat3::from_diagonal(&signs) * v_t * scale;
    Some((turn, to - turn * from))
}

/// The places that joints of one name give: themselves, and beside them along their axes, so that they also turn.
/// None for fewer than three: any two rigs may share a root. `size` of the source [m].
pub(super) fn joint_places(source: &[SourceJoint], target: &[SourceJoint], size: f64) -> Vec<[Vec3; 2]> {
    let shared: Vec<[&SourceJoint; 2]> = source
        .iter()
        .filter_map(|joint| Some([joint, target.iter().find(|other| other.name == joint.name)?]))
        .collect();
    if shared.len() < FEW {
        return Vec::new();
    }
    // As much larger as the skeleton is, so much farther away.
    let spread = |k: usize| {
        let middle = shared.iter().map(|pair| pair[k].position).sum::<Vec3>() / shared.len().max(1) as f64;
        shared.iter().map(|pair| (pair[k].position - middle).norm()).sum::<f64>()
    };
    let scale = if spread(0) > 0.0 { spread(1) / spread(0) } else { 1.0 };
    let beside = BESIDE * size;
    let mut places: Vec<[Vec3; 2]> = Vec::new();
    let mut add = |pair: [Vec3; 2]| {
        if places.len() < MOST && places.iter().all(|known| (known[0] - pair[0]).norm() > CROWDED * beside) {
            places.push(pair);
        }
    };
    shared.iter().for_each(|pair| add(pair.map(|joint| joint.position)));
    for pair in &shared {
        // Its bones, to the joints below it, turn as it does.
        let below = |other: &&[&SourceJoint; 2]| {
            other.iter().zip(pair).all(|(o, own)| o.parent.as_ref() == Some(&own.name))
        };
        let ends: Vec<[Vec3; 2]> =
            shared.iter().filter(below).map(|other| other.map(|joint| joint.position)).collect();
        let along = ends
            .iter()
            .flat_map(|end| ALONG.map(|share| [0, 1].map(|k| pair[k].position.lerp(&end[k], share))));
        for middle in std::iter::once(pair.map(|joint| joint.position)).chain(along) {
            for axis in 0..3 {
                for way in [beside, -beside] {
                    let step = |k: usize, way: f64| middle[k] + pair[k].axes.column(axis) * way;
                    add([step(0, way), step(1, way * scale)]);
                }
            }
        }
    }
    places
}

#[cfg(test)]
mod tests {
    use super::*;

    const ROUGH: (Mat3, Vec3) =
        (Mat3::new(1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0), Vec3::new(0.0, 0.0, 0.0));

    fn places() -> Vec<Vec3> {
        [[0.0, 0.0, 0.0], [1.0, 0.1, 0.0], [0.2, 0.9, 0.1], [0.3, 0.2, 0.8], [-0.5, 0.4, -0.3]]
            .map(Vec3::from)
            .to_vec()
    }

    #[test]
    fn a_turned_scaled_and_shifted_garment_is_met_everywhere() {
        let turn = nalgebra::Rotation3::new(Vec3::new(0.3, -1.1, 0.4));
        let there = |x: &Vec3| turn * x * 1.7 + Vec3::new(0.2, 3.0, -1.0);
        for few in [3, 5] {
            let pairs: Vec<[Vec3; 2]> = places()[..few].iter().map(|x| [*x, there(x)]).collect();
            let map = Registration::fit(&pairs, ROUGH).unwrap();
            for x in [Vec3::new(2.0, -1.0, 0.5), Vec3::new(-3.0, 0.0, 4.0)] {
                assert!((map.place(&x) - there(&x)).norm() < 1e-12, "{few}");
            }
        }
    }

    #[test]
    fn every_place_goes_exactly_to_its_own_and_one_alone_shifts() {
        let mut pairs: Vec<[Vec3; 2]> = places().iter().map(|x| [*x, *x]).collect();
        pairs[1][1] += Vec3::new(-0.3, 0.6, 0.1);
        let map = Registration::fit(&pairs, ROUGH).unwrap();
        for [from, to] in &pairs {
            assert!((map.place(from) - to).norm() < 1e-12);
        }
        let one = Registration::fit(&[[Vec3::x(), Vec3::y()]], ROUGH).unwrap();
        assert!((one.place(&Vec3::z()) - Vec3::new(-1.0, 1.0, 1.0)).norm() < 1e-15);
        let line =
            Registration::fit(&[[Vec3::zeros(), Vec3::zeros()], [Vec3::x(), Vec3::y()]], ROUGH).unwrap();
        assert!((line.place(&Vec3::x()) - Vec3::y()).norm() < 1e-12);
    }

    #[test]
    fn a_place_given_twice_is_refused_and_not_a_crash() {
        let twice = [[Vec3::zeros(), Vec3::zeros()], [Vec3::zeros(), Vec3::x()]];
        assert!(Registration::fit(&twice, ROUGH).is_none());
        let far =
            [[Vec3::x() * 1e300, Vec3::zeros()], [Vec3::y() * 1e300, Vec3::x()], [Vec3::z(), Vec3::z()]];
        assert!(Registration::fit(&far, ROUGH).is_none());
    }

    #[test]
    fn joints_of_a_bent_arm_carry_what_is_beside_them() {
        let joint = |name: &str, place: Vec3, axes: Mat3| {
            let parent = match name {
                "elbow" => Some("shoulder".into()),
                "wrist" => Some("elbow".into()),
                _ => None,
            };
            SourceJoint { name: name.into(), position: place, axes, parent }
        };
        let straight = Mat3::identity();
        let quarter = nalgebra::Rotation3::new(Vec3::z() * std::f64::consts::FRAC_PI_2).into_inner();
        let arm = |turn: Mat3| {
            let elbow = Vec3::new(0.3, 0.0, 0.0);
            vec![
                joint("shoulder", Vec3::zeros(), straight),
                joint("elbow", elbow, turn),
                joint("wrist", elbow + turn * Vec3::new(0.3, 0.0, 0.0), turn),
                joint("unlike", Vec3::new(9.0, turn[(0, 0)], 9.0), straight),
            ]
        };
        let mut target = arm(quarter);
        target[3].name = "other".into();
        let pairs = joint_places(&arm(straight), &target, 0.8);
        assert!(pairs.iter().all(|[from, _]| from.x < 1.0), "only joints of one name");
        let map = Registration::fit(&pairs, ROUGH).unwrap();
        // The skin above the middle of the lower arm.
        let there = map.place(&Vec3::new(0.45, 0.04, 0.0));
        let meant = Vec3::new(0.3 - 0.04, 0.15, 0.0);
        assert!((there - meant).norm() < 0.02, "{there} for {meant}");
    }
}
