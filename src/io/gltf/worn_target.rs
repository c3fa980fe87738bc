//! Computes the morph target `worn`: from displacement and memory per point to numbers per vertex of a piece.
//!
//! Wear is given per welded point, in metres, y up in the scene; a file needs it per vertex, in the piece's own
//! coordinates. With L the linear part of a vertex's placement: a displacement is transformed by L^-1, a normal by L^T
//! (the inverse of the inverse transpose that transforms it to the scene), a tangent by L^-1.
//!
//! Normals are not recomputed, which would smooth the file's hard edges and open its seams (but for flat-shaded vertices,
//! `flat_shading`): for each point of the welded mesh one rotation is computed, which is applied to the file's own normal. It maps the smooth normal before wear to the
//! one after, and its twist about the normal is that of the area-weighted mean of the triangles' deformation gradients
//! (polar decomposition in the plane). Tangents are transformed by that mean gradient itself, as texture coordinates
//! shear with the cloth, then made perpendicular to the new normal. Neither depends on the orientation of triangles.
//! A vertex whose triangles did not move gets exact zeros. Knows no JSON and no bytes.

use crate::gltf::flat_shading::{FlatNormals, SmoothShape, flat_vertices};
use crease_geometry::math::{Mat3, Mat4, Vec3};
use crease_geometry::mesh::PointIndex;
use crease_model::garment::{Garment, WornGarment};
use nalgebra::{Matrix2, Matrix3x2, Rotation3, Unit};

/// Length of the sum of two unit vectors below which they are opposite \[-\]: the sum is rounding error, not a direction.
const MIN_SUM_LENGTH: f64 = 1e-9;

/// Worn shape at every point of the welded mesh.
pub(super) struct WornShape<'a> {
    garment: &'a Garment,
    /// Smooth normals for flat-shaded vertices, if they are to get them.
    smooth: Option<SmoothShape>,
    displacement: &'a [Vec3],
    /// Per point: whether one of its triangles moved.
    moved: Vec<bool>,
    /// Per point: rotation of its surroundings, where they have a normal before and after.
    rotations: Vec<Option<Mat3>>,
    /// Per point: area-weighted sum of deformation gradients (only the direction of results is used).
    gradients: Vec<Mat3>,
    /// Per point: change of rest angle of largest magnitude among its hinges [degrees], signed.
    rest_change_deg: Vec<f32>,
    /// Per point: mean stiffness ratio of its hinges [-], 1 where it has none.
    stiffness: Vec<f32>,
}

/// Base shape of a piece, which its worn target is relative to; all lists are per vertex of the piece.
pub(super) struct PieceBase<'a> {
    /// Point of each vertex.
    pub(super) points: &'a [PointIndex],
    /// Linear parts of the transforms from own coordinates to the scene.
    pub(super) linear: LinearParts,
    /// Normals of the file in own coordinates, if there are any; readers add the target to these numbers.
    pub(super) normals: Option<Vec<Vec3>>,
    /// Normals to be written in place of those of the file, if any of those are no unit vectors or would be taken for flat shading.
    pub(super) mended_normals: Option<Vec<[f32; 3]>>,
    /// Tangents of the file in own coordinates, if there are any.
    pub(super) tangents: Option<Vec<Vec3>>,
    /// Triangles of the piece.
    pub(super) triangles: &'a [[u32; 3]],
}

/// Morph target and memory attributes of one piece; all lists are per vertex of the piece, own coordinates.
pub(super) struct WornTarget {
    /// Normals in place of those of the file, where some of those are no unit vectors or would be taken for flat shading.
    pub(super) base_normal: Option<Vec<[f32; 3]>>,
    pub(super) position: Vec<[f32; 3]>,
    pub(super) normal: Option<Vec<[f32; 3]>>,
    pub(super) tangent: Option<Vec<[f32; 3]>>,
    pub(super) rest_change_deg: Vec<f32>,
    pub(super) stiffness: Vec<f32>,
}

/// Linear part of a transform.
#[derive(Debug, Clone, Copy)]
pub(super) struct LinearPart {
    pub(super) forward: Mat3,
    pub(super) inverse: Mat3,
}

impl LinearPart {
    /// Identity.
    pub(super) fn identity() -> Self {
        Self { forward: Mat3::identity(), inverse: Mat3::identity() }
    }
}

/// Linear parts of placements: one for all vertices, or one for each.
pub(super) struct LinearParts(Vec<LinearPart>);

impl LinearParts {
    /// Creates them from `placements`, one or one per vertex; fails with the index of the first that has no inverse.
    pub(super) fn new(placements: &[Mat4]) -> Result<Self, usize> {
        let pair = |(i, m): (usize, &Mat4)| {
            let linear: Mat3 = m.fixed_view::<3, 3>(0, 0).into_owned();
            let inverse = linear.try_inverse().filter(|inverse| inverse.iter().all(|x| x.is_finite()));
            inverse.map(|inverse| LinearPart { forward: linear, inverse }).ok_or(i)
        };
        placements.iter().enumerate().map(pair).collect::<Result<_, _>>().map(Self)
    }

    /// Creates them for own coordinates equal to those of the scene.
    pub(super) fn identity() -> Self {
        Self(vec![LinearPart::identity()])
    }

    /// Returns the linear part at vertex `v`; the last entry counts for all beyond.
    pub(super) fn at(&self, v: usize) -> LinearPart {
        let last = self.0.len().saturating_sub(1);
        self.0.get(v.min(last)).copied().unwrap_or_else(LinearPart::identity)
    }
}

impl<'a> WornShape<'a> {
    /// Computes the worn shape of `worn`, whose lists belong to `garment` (the caller has checked their lengths).
    pub(super) fn new(garment: &'a Garment, worn: &'a WornGarment, flat_normals: FlatNormals) -> Self {
        let count = garment.points.len();
        let after: Vec<Vec3> = garment.points.iter().zip(&worn.displacement).map(|(p, d)| p + d).collect();
        let mut moved = vec![false; count];
        let mut normals = vec![[Vec3::zeros(); 2]; count];
        let mut gradients = vec![Mat3::zeros(); count];
        for t in &garment.triangles {
            let corners = t.map(PointIndex::at);
            let changed = corners.iter().any(|&p| worn.displacement[p] != Vec3::zeros());
            let (before, now) = (edges(&garment.points, corners), edges(&after, corners));
            let doubled_areas = [before, now].map(|e| e.column(0).cross(&e.column(1)));
            let gradient = weighted_gradient(&before, &now, doubled_areas[0].norm());
            for p in corners {
                moved[p] |= changed;
                normals[p][0] += doubled_areas[0];
                normals[p][1] += doubled_areas[1];
                gradients[p] += gradient;
            }
        }
        let rotations = normals.iter().zip(&gradients).map(|(normals, g)| rotation(*normals, g)).collect();
        let (rest_change_deg, stiffness) = memory_per_point(garment, worn);
        let smooth = (flat_normals == FlatNormals::Smoothed)
            .then(|| SmoothShape::new(&garment.points, &after, &garment.triangles));
        let displacement = &worn.displacement;
        Self { garment, smooth, displacement, moved, rotations, gradients, rest_change_deg, stiffness }
    }

    /// Computes the worn target of a piece; fails with the first vertex whose numbers do not fit 32-bit floats.
    pub(super) fn target(&self, base: &PieceBase) -> Result<WornTarget, usize> {
        let each = |row: &dyn Fn(usize, PointIndex) -> Vec3| -> Result<Vec<[f32; 3]>, usize> {
            base.points.iter().enumerate().map(|(v, &p)| narrow(row(v, p)).ok_or(v)).collect()
        };
        let position = each(&|v, p| base.linear.at(v).inverse * self.displacement[p.at()])?;
        let worn_normals = base.normals.as_ref().map(|normals| self.worn_normals(base, normals));
        let normal = base
            .normals
            .as_ref()
            .zip(worn_normals.as_ref())
            .map(|(normals, worn)| each(&|v, _| worn[v].map_or(Vec3::zeros(), |n| n - normals[v])));
        let tangent = base.tangents.as_ref().map(|tangents| {
            each(&|v, p| {
                let own = base.normals.as_ref().and_then(|normals| unit(normals[v]));
                let normal = worn_normals.as_ref().and_then(|worn| worn[v]).or(own);
                self.worn_tangent(p, normal, tangents[v], base.linear.at(v))
                    .map_or(Vec3::zeros(), |t| t - tangents[v])
            })
        });
        Ok(WornTarget {
            base_normal: base.mended_normals.clone(),
            position,
            normal: normal.transpose()?,
            tangent: tangent.transpose()?,
            rest_change_deg: base.points.iter().map(|p| self.rest_change_deg[p.at()]).collect(),
            stiffness: base.points.iter().map(|p| self.stiffness[p.at()]).collect(),
        })
    }

    /// Returns the unit normal after wear of `normal` (both in own coordinates); `None` where nothing moved or it vanishes.
    pub(super) fn worn_normal(&self, p: PointIndex, normal: Vec3, linear: LinearPart) -> Option<Vec3> {
        let rotation = self.rotations[p.at()].filter(|_| self.moved[p.at()])?;
        (linear.forward.transpose() * rotation * linear.inverse.transpose() * normal)
            .try_normalize(f64::MIN_POSITIVE)
    }

    /// Returns per vertex of a piece the unit normal after wear in own coordinates; `None` where nothing moved or it vanishes.
    fn worn_normals(&self, base: &PieceBase, normals: &[Vec3]) -> Vec<Option<Vec3>> {
        let in_scene = |v: usize| unit(base.linear.at(v).inverse.transpose() * normals[v]);
        let unworn: Vec<Vec3> = (0..normals.len()).map(|v| in_scene(v).unwrap_or_else(Vec3::zeros)).collect();
        let flat = self.flat_vertices(base.points, &unworn, base.triangles);
        let worn = |(v, &p): (usize, &PointIndex)| {
            let linear = base.linear.at(v);
            let smooth = flat[v].then(|| self.smooth_normal(p, unworn[v])).flatten();
            let own = smooth.and_then(|n| unit(linear.forward.transpose() * n));
            own.or_else(|| self.worn_normal(p, normals[v], linear))
        };
        base.points.iter().enumerate().map(worn).collect()
    }

    /// Returns per vertex whether it is flat-shaded and gets smooth normals: see [`flat_vertices`].
    pub(super) fn flat_vertices(
        &self,
        points: &[PointIndex],
        normals: &[Vec3],
        triangles: &[[u32; 3]],
    ) -> Vec<bool> {
        match self.smooth {
            Some(_) => flat_vertices(self.garment, points, normals, triangles),
            None => vec![false; normals.len()],
        }
    }

    /// Returns the smooth unit normal after wear, in the scene, of a flat-shaded surface whose unit normal was `before`;
    /// `None` where nothing moved.
    pub(super) fn smooth_normal(&self, p: PointIndex, before: Vec3) -> Option<Vec3> {
        self.smooth.as_ref().filter(|_| self.moved[p.at()])?.normal(p, before)
    }

    /// Returns the tangent after wear of `tangent` (both in own coordinates), unit and perpendicular to the worn normal.
    fn worn_tangent(
        &self,
        p: PointIndex,
        normal: Option<Vec3>,
        tangent: Vec3,
        linear: LinearPart,
    ) -> Option<Vec3> {
        if !self.moved[p.at()] {
            return None;
        }
        let sheared = linear.inverse * self.gradients[p.at()] * linear.forward * tangent;
        let perpendicular = normal.map_or(sheared, |n| sheared - n * n.dot(&sheared));
        perpendicular.try_normalize(f64::MIN_POSITIVE)
    }
}

/// Returns two edges of a triangle as columns, from its first corner [m].
fn edges(points: &[Vec3], [a, b, c]: [usize; 3]) -> Matrix3x2<f64> {
    Matrix3x2::from_columns(&[points[b] - points[a], points[c] - points[a]])
}

/// Returns the deformation gradient of a triangle times `weight`: E' (E^T E)^-1 E^T maps a vector in the plane of the old
/// edges E to the same combination of the new edges E'. Zero for a triangle without area.
fn weighted_gradient(before: &Matrix3x2<f64>, now: &Matrix3x2<f64>, weight: f64) -> Mat3 {
    let gram: Matrix2<f64> = before.transpose() * before;
    let gradient = gram.try_inverse().map(|inverse| now * inverse * before.transpose() * weight);
    gradient.filter(|g| g.iter().all(|x| x.is_finite())).unwrap_or_else(Mat3::zeros)
}

/// Returns the rotation of the neighbourhood of a point from its normals (of any length) before and after, and its mean
/// gradient.
fn rotation([before, after]: [Vec3; 2], gradient: &Mat3) -> Option<Mat3> {
    let (before, after) = unit(before).zip(unit(after))?;
    let tilt = smallest_rotation(before, after);
    // Gradient in the plane of the old normal, after the tilt is undone.
    let x = perpendicular_unit(before);
    let y = before.cross(&x);
    let plane = tilt.transpose() * gradient;
    let sine = y.dot(&(plane * x)) - x.dot(&(plane * y));
    let cosine = x.dot(&(plane * x)) + y.dot(&(plane * y));
    let twist = Rotation3::from_axis_angle(&Unit::new_unchecked(before), sine.atan2(cosine));
    Some(tilt * twist.matrix())
}

/// Returns the smallest rotation that maps unit `from` to unit `to`: half turns about `from` and then about the direction
/// halfway, (2 m m^T - I)(2 a a^T - I), which stays accurate where the usual formula divides by 1 + cos.
fn smallest_rotation(from: Vec3, to: Vec3) -> Mat3 {
    let half_turn = |axis: Vec3| axis * axis.transpose() * 2.0 - Mat3::identity();
    let sum = from + to;
    let halfway = if sum.norm() > MIN_SUM_LENGTH { sum.normalize() } else { perpendicular_unit(from) };
    half_turn(halfway) * half_turn(from)
}

/// Returns a unit vector perpendicular to unit `v`, computed with its smallest component, so that the product is never near
/// zero; any unit vector for a zero `v`, which files may hold.
pub(super) fn perpendicular_unit(v: Vec3) -> Vec3 {
    v.cross(&Vec3::ith(v.iamin(), 1.0)).try_normalize(0.0).unwrap_or_else(Vec3::x)
}

fn unit(v: Vec3) -> Option<Vec3> {
    v.try_normalize(f64::MIN_POSITIVE)
}

/// Returns per point, over the hinges whose edge ends there, the change of rest angle of largest magnitude [degrees] and the
/// mean stiffness ratio.
fn memory_per_point(garment: &Garment, worn: &WornGarment) -> (Vec<f32>, Vec<f32>) {
    let count = garment.points.len();
    let (mut change, mut sum, mut hinges) = (vec![0.0f64; count], vec![0.0; count], vec![0u32; count]);
    let memory = &worn.memory;
    for (h, hinge) in garment.topology.hinges.iter().enumerate() {
        let angle_change = memory.rest_angle[h] - memory.source_angle[h];
        for p in [hinge.points[0].at(), hinge.points[1].at()] {
            if angle_change.abs() > change[p].abs() {
                change[p] = angle_change;
            }
            sum[p] += memory.stiffness_ratio[h];
            hinges[p] += 1;
        }
    }
    let mean = |(sum, count): (&f64, &u32)| if *count == 0 { 1.0 } else { (sum / f64::from(*count)) as f32 };
    (change.iter().map(|c| c.to_degrees() as f32).collect(), sum.iter().zip(&hinges).map(mean).collect())
}

/// Converts to 32-bit floats, if they can hold the numbers. A negative zero becomes zero: files are compared by bytes.
fn narrow(v: Vec3) -> Option<[f32; 3]> {
    let row = [v.x as f32 + 0.0, v.y as f32 + 0.0, v.z as f32 + 0.0];
    row.iter().all(|x| x.is_finite()).then_some(row)
}

#[cfg(test)]
mod tests {
    use super::*;

    use crease_model::garment::RestState;

    /// A sheet of n x n squares in the plane z = 0, point (i, j) at index j (n + 1) + i, one unit wide.
    fn sheet(n: u32) -> Garment {
        let points = (0..=n).flat_map(|j| (0..=n).map(move |i| (i, j)));
        let points: Vec<Vec3> =
            points.map(|(i, j)| Vec3::new(f64::from(i), f64::from(j), 0.0) / f64::from(n)).collect();
        let squares = (0..n).flat_map(|j| (0..n).map(move |i| j * (n + 1) + i));
        let triangles: Vec<[u32; 3]> =
            squares.flat_map(|a| [[a, a + 1, a + n + 2], [a, a + n + 2, a + n + 1]]).collect();
        Garment::of_triangles(points, &triangles)
    }

    fn worn(garment: &Garment, shape: impl Fn(Vec3) -> Vec3) -> WornGarment {
        let hinges = garment.topology.hinges.len();
        WornGarment {
            displacement: garment.points.iter().map(|&p| shape(p) - p).collect(),
            memory: RestState {
                source_angle: vec![0.0; hinges],
                rest_angle: vec![0.0; hinges],
                stiffness_ratio: vec![1.0; hinges],
                rest_stretch_warp: vec![1.0; garment.triangles.len()],
                rest_stretch_weft: vec![1.0; garment.triangles.len()],
            },
        }
    }

    /// Base plus delta of every vertex, all with the same base normal and tangent.
    fn worn_directions(
        garment: &Garment,
        worn: &WornGarment,
        placement: Mat4,
        normal: Vec3,
        tangent: Vec3,
    ) -> (Vec<Vec3>, Vec<Vec3>) {
        let count = garment.points.len();
        let base = PieceBase {
            points: &garment.source_point,
            linear: LinearParts::new(&[placement]).unwrap(),
            normals: Some(vec![normal; count]),
            mended_normals: None,
            tangents: Some(vec![tangent; count]),
            triangles: &[],
        };
        let target = WornShape::new(garment, worn, FlatNormals::Kept).target(&base).unwrap();
        let sum = |base: Vec3, rows: Option<Vec<[f32; 3]>>| {
            rows.unwrap().into_iter().map(|d| base + Vec3::from(d.map(f64::from))).collect()
        };
        (sum(normal, target.normal), sum(tangent, target.tangent))
    }

    fn largest_error(found: &[Vec3], wanted: impl Fn(usize) -> Vec3) -> f64 {
        found.iter().enumerate().map(|(v, found)| (found - wanted(v)).norm()).fold(0.0, f64::max)
    }

    /// Hard-edged normals are not perpendicular to the smooth surface; they too must follow a rotation exactly, spin
    /// about the smooth normal and turning upside down included.
    #[test]
    fn a_rotated_sheet_has_rotated_normals_and_tangents() {
        let garment = sheet(3);
        let (normal, tangent) = (Vec3::new(0.6, 0.0, 0.8), Vec3::y());
        for angles in [[0.0, 0.0, 1.0], [0.3, -2.0, 0.5], [std::f64::consts::PI, 0.0, 0.0], [0.0, 3.1, 3.0]] {
            let r = Rotation3::from_euler_angles(angles[0], angles[1], angles[2]);
            let worn = worn(&garment, |p| r * p);
            let (n, t) = worn_directions(&garment, &worn, Mat4::identity(), normal, tangent);
            assert!(largest_error(&n, |_| r * normal) < 1e-6, "{angles:?}");
            assert!(largest_error(&t, |_| r * tangent) < 1e-6, "{angles:?}");
        }
    }

    /// z = x^2: inside the sheet the normal is (-2x, 0, 1) and dP/du is (1, 0, 2x), both up to length.
    #[test]
    fn a_curved_sheet_has_the_normals_of_the_curve() {
        let n = 40;
        let garment = sheet(n);
        let worn = worn(&garment, |p| Vec3::new(p.x, p.y, p.x * p.x));
        let (normals, tangents) = worn_directions(&garment, &worn, Mat4::identity(), Vec3::z(), Vec3::x());
        for (v, p) in garment.points.iter().enumerate() {
            if [p.x, p.y].iter().any(|x| *x < 0.02 || *x > 0.98) {
                continue;
            }
            let normal = Vec3::new(-2.0 * p.x, 0.0, 1.0).normalize();
            let tangent = Vec3::new(1.0, 0.0, 2.0 * p.x).normalize();
            assert!((normals[v] - normal).norm() < 1e-3, "{p:?}");
            assert!((tangents[v] - tangent).norm() < 1e-3, "{p:?}");
            assert!(normals[v].dot(&tangents[v]).abs() < 1e-6);
        }
    }

    /// In a sheared sheet the v direction leans, which a rotation alone would halve.
    #[test]
    fn tangents_shear_with_the_cloth() {
        let garment = sheet(4);
        let worn = worn(&garment, |p| Vec3::new(p.x + 0.5 * p.y, p.y, 0.0));
        let (n, t) = worn_directions(&garment, &worn, Mat4::identity(), Vec3::z(), Vec3::y());
        assert!(largest_error(&n, |_| Vec3::z()) < 1e-6);
        assert!(largest_error(&t, |_| Vec3::new(0.5, 1.0, 0.0).normalize()) < 1e-6);
    }

    /// Placed by any transform, the worn shape in the scene must be the one that was asked for; the triangles' facing
    /// must not matter.
    #[test]
    fn directions_go_through_a_skewed_and_mirrored_placement() {
        let placement =
            Mat4::new(0.02, 0.01, 0.0, 3.0, 0.0, -0.05, 0.0, 1.0, 0.004, 0.0, 0.03, 0.0, 0.0, 0.0, 0.0, 1.0);
        let linear: Mat3 = placement.fixed_view::<3, 3>(0, 0).into_owned();
        let r = Rotation3::from_euler_angles(0.4, 1.0, -0.7);
        let mut garment = sheet(2);
        garment.triangles.iter_mut().for_each(|t| t.swap(0, 1));
        let worn = worn(&garment, |p| r * p);
        let (normal, tangent) = (Vec3::new(0.1, 0.2, 1.0).normalize(), Vec3::new(1.0, -0.5, 0.0).normalize());
        let (n, t) = worn_directions(&garment, &worn, placement, normal, tangent);
        let inverse = linear.try_inverse().unwrap();
        let wanted = (linear.transpose() * (r * (inverse.transpose() * normal))).normalize();
        assert!(largest_error(&n, |_| wanted) < 1e-6);
        // Only the part of the tangent in the sheet's plane is carried; all of it lies across the new normal.
        assert!(t.iter().all(|t| t.dot(&wanted).abs() < 1e-6 && (t.norm() - 1.0).abs() < 1e-6));
    }

    #[test]
    fn what_did_not_move_has_exact_zeros() {
        let garment = sheet(6);
        let worn = worn(&garment, |p| if p.x > 0.8 { p + Vec3::new(0.0, 0.0, 0.1) } else { p });
        let normals = vec![Vec3::new(0.267, 0.534, 0.802); garment.points.len()];
        let base = PieceBase {
            points: &garment.source_point,
            linear: LinearParts::identity(),
            tangents: Some(vec![Vec3::x(); normals.len()]),
            normals: Some(normals),
            mended_normals: None,
            triangles: &[],
        };
        let target = WornShape::new(&garment, &worn, FlatNormals::Kept).target(&base).unwrap();
        for (v, p) in garment.points.iter().enumerate() {
            let still = p.x < 0.6;
            assert_eq!(target.position[v] == [0.0; 3], p.x <= 0.8);
            assert_eq!(target.normal.as_ref().unwrap()[v] == [0.0; 3], still, "{p:?}");
            assert!(!still || target.tangent.as_ref().unwrap()[v] == [0.0; 3]);
        }
    }

    /// Anchor values: the sign is that of rest angle minus source angle, and the larger magnitude wins.
    #[test]
    fn memory_of_a_point_is_that_of_the_hinges_that_end_there() {
        let garment = sheet(2);
        let mut worn = worn(&garment, |p| p);
        let middle = PointIndex(4);
        let ends_there: Vec<usize> = (0..garment.topology.hinges.len())
            .filter(|&h| garment.topology.hinges[h].points[..2].contains(&middle))
            .collect();
        assert_eq!(ends_there.len(), 6);
        worn.memory.source_angle[ends_there[0]] = 0.5;
        worn.memory.rest_angle[ends_there[0]] = -0.5;
        worn.memory.rest_angle[ends_there[1]] = 0.9;
        worn.memory.stiffness_ratio[ends_there[2]] = 4.0;
        let (change, stiffness) = memory_per_point(&garment, &worn);
        assert!((f64::from(change[4]) + 1f64.to_degrees()).abs() < 1e-5, "{}", change[4]);
        assert!((stiffness[4] - 1.5).abs() < 1e-6, "one of six hinges is four times as stiff");
        // A corner of a single triangle has no hinge.
        assert_eq!((change[2], stiffness[2]), (0.0, 1.0));
    }

    #[test]
    fn a_flattening_placement_is_named() {
        let flat = Mat4::new_nonuniform_scaling(&Vec3::new(1.0, 0.0, 1.0));
        assert_eq!(LinearParts::new(&[Mat4::identity(), flat]).err(), Some(1));
    }
}
