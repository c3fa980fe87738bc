//! Registration of one garment on another by point pairs: landmarks marked by a person, or the joints of a skeleton that
//! both follow.
//!
//! First a least-squares similarity (rotation, one scale, shift; Umeyama 1991), then a spline that interpolates every pair
//! exactly: displacements in between are sums of distances to the points, the biharmonic spline of three dimensions
//! (Duchon 1977, Bookstein 1989). An arm that hangs on the source and is raised on the target follows its joints.

use crate::transfer::tuning::TUNING;
use crease_geometry::math::{Mat3, NearestRotation, Vec3, nearest_rotation};
use crease_geometry::mesh::PointIndex;
use crease_model::garment::SourceJoint;
use crease_model::remesh::GarmentSurface;
use nalgebra::DMatrix;

/// A point of the source and the point of the target that belongs to it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PointPair {
    /// Position on the source [m].
    pub source: Vec3,
    /// Position on the target [m].
    pub target: Vec3,
}

impl From<[Vec3; 2]> for PointPair {
    fn from([source, target]: [Vec3; 2]) -> Self {
        Self { source, target }
    }
}

/// An affine map: x -> linear x + shift.
#[derive(Debug, Clone, Copy)]
pub(super) struct AffineMap {
    /// Linear part.
    pub linear: Mat3,
    /// Shift [m].
    pub shift: Vec3,
}

impl AffineMap {
    /// `surface` with its points mapped and its warp directions turned along.
    pub(super) fn apply_to(&self, surface: &GarmentSurface) -> GarmentSurface {
        let turned = |w: &Vec3| (self.linear * w).try_normalize(0.0).unwrap_or_else(Vec3::x);
        GarmentSurface {
            points: surface.points.iter().map(|p| self.apply(p)).collect(),
            warp: surface.warp.as_ref().map(|all| all.iter().map(turned).collect()),
            ..surface.clone()
        }
    }

    pub(super) fn apply(&self, point: &Vec3) -> Vec3 {
        self.linear * point + self.shift
    }
}

/// A map of space that interpolates point pairs.
#[derive(Debug, Clone)]
pub(super) struct Registration {
    similarity: AffineMap,
    /// Images of the source points under the similarity [m].
    centres: Vec<Vec3>,
    /// Displacement per metre of distance to each centre [-].
    weights: Vec<Vec3>,
    /// Constant displacement [m].
    constant: Vec3,
}

impl Registration {
    /// The map that takes the source of each pair to its target. Without three points off a line, the spline is added to
    /// `fallback`, a map that aligns the garments as well as is known without pairs. `None` if no such map exists.
    pub fn fit(pairs: &[PointPair], fallback: AffineMap) -> Option<Self> {
        let in_range = |x: &Vec3| x.amax() < TUNING.max_coordinate_m;
        // Positive logic, so that NaN is out of range, too.
        if !pairs.iter().all(|pair| in_range(&pair.source) && in_range(&pair.target)) {
            return None;
        }
        let similarity = fit_similarity(pairs).unwrap_or(fallback);
        let centres: Vec<Vec3> = pairs.iter().map(|pair| similarity.apply(&pair.source)).collect();
        let n = pairs.len();
        let mut system = DMatrix::zeros(n + 1, n + 1);
        let mut rest = DMatrix::zeros(n + 1, 3);
        for i in 0..n {
            for j in 0..n {
                system[(i, j)] = (centres[i] - centres[j]).norm();
            }
            system[(i, n)] = 1.0;
            system[(n, i)] = 1.0;
            rest.fixed_view_mut::<1, 3>(i, 0).copy_from(&(pairs[i].target - centres[i]).transpose());
        }
        let solution = system.lu().solve(&rest)?;
        let row = |i: usize| Vec3::new(solution[(i, 0)], solution[(i, 1)], solution[(i, 2)]);
        solution.iter().all(|w| w.is_finite()).then(|| Self {
            similarity,
            centres,
            weights: (0..n).map(row).collect(),
            constant: row(n),
        })
    }

    /// Image of `point` [m].
    pub fn map_point(&self, point: &Vec3) -> Vec3 {
        let near = self.similarity.apply(point);
        let bent: Vec3 = self.centres.iter().zip(&self.weights).map(|(c, w)| w * (near - c).norm()).sum();
        near + bent + self.constant
    }

    /// `surface` with its points mapped; the warp direction follows its triangle.
    pub fn apply(&self, surface: &GarmentSurface) -> GarmentSurface {
        moved(surface, surface.points.iter().map(|p| self.map_point(p)).collect())
    }
}

/// `surface` with its points at `points` [m]; the warp direction follows its triangle.
pub(super) fn moved(surface: &GarmentSurface, points: Vec<Vec3>) -> GarmentSurface {
    let map_warp = |(t, w): (&[PointIndex; 3], &Vec3)| {
        let sides = |x: &[Vec3]| {
            let [a, b, c] = t.map(|p| x[p.at()]);
            [b - a, c - a]
        };
        let ([u, v], [to_u, to_v]) = (sides(&surface.points), sides(&points));
        // The warp as a linear combination of both sides.
        let normal = u.cross(&v);
        let size = normal.norm_squared().max(f64::MIN_POSITIVE);
        let (of_u, of_v) = (w.cross(&v).dot(&normal) / size, u.cross(w).dot(&normal) / size);
        (to_u * of_u + to_v * of_v).try_normalize(0.0).unwrap_or_else(Vec3::x)
    };
    let warp = surface.warp.as_ref().map(|all| surface.triangles.iter().zip(all).map(map_warp).collect());
    GarmentSurface { points, warp, ..surface.clone() }
}

/// The least-squares similarity that takes sources to targets. `None` for collinear points.
pub(super) fn fit_similarity(pairs: &[PointPair]) -> Option<AffineMap> {
    let count = pairs.len().max(1) as f64;
    let from = pairs.iter().map(|pair| pair.source).sum::<Vec3>() / count;
    let to = pairs.iter().map(|pair| pair.target).sum::<Vec3>() / count;
    let mut mixed = Mat3::zeros();
    let (mut source_scatter, mut target_scatter) = (Mat3::zeros(), Mat3::zeros());
    for pair in pairs {
        let (a, b) = (pair.source - from, pair.target - to);
        mixed += b * a.transpose();
        source_scatter += a * a.transpose();
        target_scatter += b * b.transpose();
    }
    for scatter in [&source_scatter, &target_scatter] {
        let mut extents: Vec<f64> =
            scatter.symmetric_eigenvalues().iter().map(|e| e.max(0.0).sqrt()).collect();
        extents.sort_unstable_by(|a, b| b.total_cmp(a));
        if extents[1] <= TUNING.max_collinear_ratio * extents[0] {
            return None;
        }
    }
    let NearestRotation { rotation, signed_sum } = nearest_rotation(mixed)?;
    let linear = rotation * (signed_sum / source_scatter.trace());
    Some(AffineMap { linear, shift: to - linear * from })
}

/// Joints of one name on both garments.
#[derive(Clone, Copy)]
struct JointPair<'a> {
    source: &'a SourceJoint,
    target: &'a SourceJoint,
}

impl JointPair<'_> {
    fn points(&self) -> PointPair {
        PointPair { source: self.source.position, target: self.target.position }
    }

    fn is_parent_of(&self, other: &Self) -> bool {
        other.source.parent.as_ref() == Some(&self.source.name)
            && other.target.parent.as_ref() == Some(&self.target.name)
    }

    /// Whether a bone of at least `min_length` [m] on the source leads from one of both to the other.
    fn are_bone(a: &Self, b: &Self, min_length: f64) -> bool {
        let length = |from: Vec3, to: Vec3| (to - from).norm();
        (a.is_parent_of(b) || b.is_parent_of(a))
            && length(a.source.position, b.source.position) >= min_length
            && length(a.target.position, b.target.position) > 0.0
    }
}

/// The joint of `joints` that is called like `joint`; without prefixes of exporters ("mixamorig:LeftArm", "Armature|LeftArm")
/// if only one is called so.
fn joint_like<'a>(joint: &SourceJoint, joints: &'a [SourceJoint]) -> Option<&'a SourceJoint> {
    let bare = |name: &str| name.rsplit([':', '|']).next().unwrap_or(name).to_lowercase();
    let exact = joints.iter().find(|other| other.name == joint.name);
    exact.or_else(|| {
        let mut alike = joints.iter().filter(|other| bare(&other.name) == bare(&joint.name));
        alike.next().filter(|_| alike.next().is_none())
    })
}

/// Point pairs from joints of equal names: the joints themselves, and points beside them along their axes, which carry
/// their rotations. Empty for fewer than three, unless two are the ends of a bone of some length. `size` is the box diagonal of the
/// source [m].
pub(super) fn joint_point_pairs(source: &[SourceJoint], target: &[SourceJoint], size: f64) -> Vec<PointPair> {
    let shared: Vec<JointPair> = source
        .iter()
        .filter_map(|joint| Some(JointPair { source: joint, target: joint_like(joint, target)? }))
        .collect();
    let is_skeleton = match shared.as_slice() {
        [a, b] => JointPair::are_bone(a, b, TUNING.min_bone_fraction * size),
        all => all.len() >= TUNING.min_shared_joints,
    };
    if !is_skeleton {
        return Vec::new();
    }
    // The offset on the target scales with the size of the skeletons.
    let spread = |position: fn(&JointPair) -> Vec3| {
        let centre = shared.iter().map(position).sum::<Vec3>() / shared.len().max(1) as f64;
        shared.iter().map(|pair| (position(pair) - centre).norm()).sum::<f64>()
    };
    let source_spread = spread(|pair| pair.source.position);
    let scale = if source_spread > 0.0 { spread(|pair| pair.target.position) / source_spread } else { 1.0 };
    let offset = TUNING.joint_offset_fraction * size;
    let min_spacing = TUNING.min_joint_point_spacing * offset;
    let mut pairs: Vec<PointPair> = Vec::new();
    let mut add = |pair: PointPair| {
        let is_apart = |known: &PointPair| (known.source - pair.source).norm() > min_spacing;
        if pairs.len() < TUNING.max_joint_points && pairs.iter().all(is_apart) {
            pairs.push(pair);
        }
    };
    shared.iter().for_each(|pair| add(pair.points()));
    for pair in &shared {
        // The bones to the joints below it rotate with it.
        let joint = pair.points();
        let along_bone = |end: PointPair| {
            TUNING.bone_fractions.map(|s| PointPair {
                source: joint.source.lerp(&end.source, s),
                target: joint.target.lerp(&end.target, s),
            })
        };
        let bones = shared.iter().filter(|other| pair.is_parent_of(other));
        let along = bones.flat_map(|other| along_bone(other.points()));
        for middle in std::iter::once(joint).chain(along) {
            for axis in 0..3 {
                for distance in [offset, -offset] {
                    add(PointPair {
                        source: middle.source + pair.source.axes.column(axis) * distance,
                        target: middle.target + pair.target.axes.column(axis) * (distance * scale),
                    });
                }
            }
        }
    }
    pairs
}

#[cfg(test)]
mod tests {
    use super::*;

    fn identity() -> AffineMap {
        AffineMap { linear: Mat3::identity(), shift: Vec3::zeros() }
    }

    fn fit(pairs: &[PointPair]) -> Option<Registration> {
        Registration::fit(pairs, identity())
    }

    fn points() -> Vec<Vec3> {
        [[0.0, 0.0, 0.0], [1.0, 0.1, 0.0], [0.2, 0.9, 0.1], [0.3, 0.2, 0.8], [-0.5, 0.4, -0.3]]
            .map(Vec3::from)
            .to_vec()
    }

    #[test]
    fn a_rotated_scaled_and_shifted_garment_is_matched_everywhere() {
        let rotation = nalgebra::Rotation3::new(Vec3::new(0.3, -1.1, 0.4));
        let image = |x: &Vec3| rotation * x * 1.7 + Vec3::new(0.2, 3.0, -1.0);
        for count in [3, 5] {
            let pairs: Vec<PointPair> =
                points()[..count].iter().map(|x| PointPair { source: *x, target: image(x) }).collect();
            let map = fit(&pairs).unwrap();
            for x in [Vec3::new(2.0, -1.0, 0.5), Vec3::new(-3.0, 0.0, 4.0)] {
                assert!((map.map_point(&x) - image(&x)).norm() < 1e-12, "{count}");
            }
        }
    }

    #[test]
    fn every_pair_is_interpolated_and_a_single_one_shifts() {
        let mut pairs: Vec<PointPair> =
            points().iter().map(|x| PointPair { source: *x, target: *x }).collect();
        pairs[1].target += Vec3::new(-0.3, 0.6, 0.1);
        let map = fit(&pairs).unwrap();
        for pair in &pairs {
            assert!((map.map_point(&pair.source) - pair.target).norm() < 1e-12);
        }
        let one = fit(&[[Vec3::x(), Vec3::y()].into()]).unwrap();
        assert!((one.map_point(&Vec3::z()) - Vec3::new(-1.0, 1.0, 1.0)).norm() < 1e-15);
        let line = fit(&[[Vec3::zeros(), Vec3::zeros()].into(), [Vec3::x(), Vec3::y()].into()]).unwrap();
        assert!((line.map_point(&Vec3::x()) - Vec3::y()).norm() < 1e-12);
    }

    #[test]
    fn a_point_given_twice_is_refused_and_not_a_crash() {
        let twice = [[Vec3::zeros(), Vec3::zeros()].into(), [Vec3::zeros(), Vec3::x()].into()];
        assert!(fit(&twice).is_none());
        let far =
            [[Vec3::x() * 1e300, Vec3::zeros()], [Vec3::y() * 1e300, Vec3::x()], [Vec3::z(), Vec3::z()]];
        assert!(fit(&far.map(PointPair::from)).is_none());
    }

    #[test]
    fn joints_of_a_bent_arm_carry_what_is_beside_them() {
        let joint = |name: &str, position: Vec3, axes: Mat3| {
            let parent = match name {
                "elbow" => Some("shoulder".into()),
                "wrist" => Some("elbow".into()),
                _ => None,
            };
            SourceJoint { name: name.into(), position, axes, parent }
        };
        let straight = Mat3::identity();
        let quarter = nalgebra::Rotation3::new(Vec3::z() * std::f64::consts::FRAC_PI_2).into_inner();
        let arm = |rotation: Mat3| {
            let elbow = Vec3::new(0.3, 0.0, 0.0);
            vec![
                joint("shoulder", Vec3::zeros(), straight),
                joint("elbow", elbow, rotation),
                joint("wrist", elbow + rotation * Vec3::new(0.3, 0.0, 0.0), rotation),
                joint("unlike", Vec3::new(9.0, rotation[(0, 0)], 9.0), straight),
            ]
        };
        let mut target = arm(quarter);
        target[3].name = "other".into();
        let pairs = joint_point_pairs(&arm(straight), &target, 0.8);
        assert!(pairs.iter().all(|pair| pair.source.x < 1.0), "only joints of one name");
        let map = fit(&pairs).unwrap();
        // The skin above the middle of the lower arm.
        let image = map.map_point(&Vec3::new(0.45, 0.04, 0.0));
        let expected = Vec3::new(0.3 - 0.04, 0.15, 0.0);
        assert!((image - expected).norm() < 0.02, "{image} for {expected}");
    }
}
