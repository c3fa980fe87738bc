//! Which place of the source belongs to a place of the target, and how directions go over from one to the other.
//!
//! Three ways. MatchBy texture: the same texture coordinates. MatchBy surface, both garments with depth: the nearest place whose
//! normal agrees. MatchBy surface, one of them flat: what lies behind one another seen from the front, on the same side of
//! the garment. A place that lands beyond an open border of the source, or farther off than a small part of the garment,
//! has no source: sleeves do not get what a vest remembers.
//! The map of directions `J` takes tangents of the source to tangents of the target (3 x 3, of use on the source's
//! plane only): by texture the quotient of both texture gradients, seen from the front the lift onto the target's
//! plane, else the smallest rotation between the normals.

use crate::math::{Mat3, Vec2, Vec3, bounds};
use crate::mesh::triangle_bvh::{NearestTriangle, TriangleBvh};
use crate::transfer::GarmentSurface;
use nalgebra::{Matrix2, Matrix3x2, Rotation3};

/// Farthest landing, as a share of the target's box diagonal: seen from the front, and by nearest place.
const REACH: [f64; 2] = [0.03, 0.12];
/// Landing by texture reaches this many mean source triangles (outlines are cut differently).
const REACH_TRIANGLES: f64 = 0.75;
/// Cosine between normals from which they agree, and from which they agree fully.
const AGREE: [f64; 2] = [0.2, 0.7];
/// Seen edge-on (cosine below this), the lift onto the target's plane would stretch without bound, and a source triangle shrink
/// to one without area, whose angles would be so much curvature.
const EDGE_ON: f64 = 0.3;

/// A place of the target, in the standing frame.
#[derive(Debug, Clone, Copy)]
pub(super) struct Place {
    pub(super) position: Vec3,
    pub(super) uv: Option<Vec2>,
    /// Outward unit normal of its triangle.
    pub(super) normal: Vec3,
    /// The triangle's texture gradient dX/d(u, v).
    pub(super) gradient: Option<Matrix3x2<f64>>,
}

/// Where a place of the target lands.
#[derive(Debug, Clone, Copy)]
pub(super) struct Landing {
    /// TransferSource triangle.
    pub(super) triangle: usize,
    /// 0..1: how near, and how well the normals agree.
    pub(super) quality: f64,
    /// Takes source tangents to target tangents.
    pub(super) map: Mat3,
}

/// Finds where places of a target land.
pub(super) trait Lands: Sync {
    /// What they land on.
    fn source(&self) -> &GarmentSurface;

    /// Where `place` lands, of triangle `f` of the target, if anywhere.
    fn land(&self, f: usize, place: &Place) -> Option<Landing>;
}

/// How places are found.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Way {
    Texture,
    Front,
    Nearest,
}

/// Finds landings on one source sheet.
pub(super) struct Finder<'a> {
    source: &'a GarmentSurface,
    way: Way,
    /// What the tree stands on: texture, front view or space.
    points: Vec<Vec3>,
    tree: TriangleBvh,
    /// Per source triangle: outward unit normal.
    normals: Vec<Vec3>,
    /// Per source triangle: which of its sides are open.
    open: Vec<[bool; 3]>,
    gradients: Vec<Option<Matrix3x2<f64>>>,
    reach: f64,
    /// Landing past an open border is forgiven up to here.
    slack: f64,
}

impl<'a> Finder<'a> {
    /// For a `source` that stands aligned with the target, whose box has the diagonal `size` [m]. MatchBy texture only if
    /// the source has it, else by nearest place.
    pub(super) fn new(source: &'a GarmentSurface, way: Way, size: f64) -> Self {
        let outward = source.outward();
        let count = source.triangles.len();
        let normals =
            (0..count).map(|f| outward * source.normal(f).try_normalize(0.0).unwrap_or_else(Vec3::z));
        let edges = &source.topology;
        let open = edges.triangle_edges.iter().map(|t| t.map(|e| edges.edge_valence[e as usize] == 1));
        let (points, triangles, reach, gradients) = match (way, &source.uvs) {
            (Way::Texture, Some(uvs)) => {
                let points: Vec<Vec3> = uvs.iter().flatten().map(|uv| Vec3::new(uv.x, uv.y, 0.0)).collect();
                let triangles =
                    (0..count as u32).map(|f| [0, 1, 2].map(|k| crate::mesh::PointIndex(3 * f + k)));
                let (low, high) = bounds(&points);
                let side = ((high - low).norm() / (count.max(1) as f64).sqrt()) * REACH_TRIANGLES;
                let gradients = (0..count).map(|f| texture_gradient(&source.corners(f), &uvs[f])).collect();
                (points, triangles.collect(), side, gradients)
            }
            (Way::Front, _) => {
                let points = source.points.iter().map(|p| Vec3::new(p.x, p.y, 0.0)).collect();
                (points, source.triangles.clone(), REACH[0] * size, Vec::new())
            }
            _ => (source.points.clone(), source.triangles.clone(), REACH[1] * size, Vec::new()),
        };
        let tree = TriangleBvh::new(&points, &triangles, 0.0);
        let slack = if way == Way::Texture { reach } else { REACH[0] * size };
        Self {
            source,
            way,
            tree,
            points,
            normals: normals.collect(),
            open: open.collect(),
            gradients,
            reach,
            slack,
        }
    }

    /// Where `place` lands, if anywhere.
    pub(super) fn land(&self, place: &Place) -> Option<Landing> {
        match self.way {
            Way::Texture => self.by_texture(place),
            Way::Front => self.by_front(place),
            Way::Nearest => self.by_nearest(place),
        }
    }

    fn by_texture(&self, place: &Place) -> Option<Landing> {
        let uv = place.uv?;
        let found = self.tree.nearest(&self.points, Vec3::new(uv.x, uv.y, 0.0), self.reach)?;
        let triangle = found.triangle as usize;
        let map = place.gradient? * pseudo_inverse(&self.gradients[triangle]?)?;
        Some(Landing { triangle, quality: 1.0 - 0.5 * found.gap.distance / self.reach, map })
    }

    fn by_front(&self, place: &Place) -> Option<Landing> {
        let from = Vec3::new(place.position.x, place.position.y, 0.0);
        let same_side = |f: u32| self.normals[f as usize].z * place.normal.z > 0.0;
        let found = self.tree.nearest_where(&self.points, from, self.reach, same_side)?;
        let triangle = found.triangle as usize;
        let own = &self.normals[triangle];
        let steep = place.normal.z.abs().min(own.z.abs());
        let map = if steep < EDGE_ON { smallest_rotation(own, &place.normal) } else { lift(&place.normal) };
        let quality = nearness(&found, self.reach) * ramp(steep, [0.0, EDGE_ON]);
        Some(Landing { triangle, quality, map })
    }

    fn by_nearest(&self, place: &Place) -> Option<Landing> {
        let agrees = |f: u32| self.normals[f as usize].dot(&place.normal) > AGREE[0];
        let found = self.tree.nearest_where(&self.points, place.position, self.reach, agrees)?;
        let triangle = found.triangle as usize;
        let own = &self.normals[triangle];
        if self.beyond_border(&found, own) {
            return None;
        }
        let quality = nearness(&found, self.reach) * ramp(own.dot(&place.normal), AGREE);
        Some(Landing { triangle, quality, map: smallest_rotation(own, &place.normal) })
    }

    /// Whether the landing lies on an open side of its triangle, and the place well past it.
    fn beyond_border(&self, found: &NearestTriangle, normal: &Vec3) -> bool {
        let sideways = found.gap.vector - normal * normal.dot(&found.gap.vector);
        if sideways.norm() <= self.slack {
            return false;
        }
        // Side k runs from corner k to k + 1; on it, the weight of the third corner is 0.
        let weights = &found.gap.weights;
        let open = &self.open[found.triangle as usize];
        (0..3).any(|k| open[k] && weights[1 + (k + 2) % 3].abs() < 1e-9)
    }
}

impl Lands for Finder<'_> {
    fn source(&self) -> &GarmentSurface {
        self.source
    }

    fn land(&self, _f: usize, place: &Place) -> Option<Landing> {
        self.land(place)
    }
}

/// Where on the source a place lands, for judging a way: position in the standing frame.
pub(super) fn landed_at(finder: &Finder, landing: &Landing) -> Vec3 {
    finder.source.corners(landing.triangle).iter().sum::<Vec3>() / 3.0
}

fn nearness(found: &NearestTriangle, reach: f64) -> f64 {
    (1.0 - found.gap.distance / reach).clamp(0.0, 1.0)
}

/// 0 below, 1 above, straight between.
fn ramp(x: f64, [low, high]: [f64; 2]) -> f64 {
    ((x - low) / (high - low)).clamp(0.0, 1.0)
}

/// dX/d(u, v) of a triangle; `None` where the texture has no area.
pub(super) fn texture_gradient(x: &[Vec3; 3], uv: &[Vec2; 3]) -> Option<Matrix3x2<f64>> {
    let edges = Matrix3x2::from_columns(&[x[1] - x[0], x[2] - x[0]]);
    let texture = Matrix2::from_columns(&[uv[1] - uv[0], uv[2] - uv[0]]);
    let gradient = edges * texture.try_inverse()?;
    gradient.iter().all(|g| g.is_finite()).then_some(gradient)
}

/// P^+ = (P^T P)^-1 P^T.
fn pseudo_inverse(p: &Matrix3x2<f64>) -> Option<nalgebra::Matrix2x3<f64>> {
    Some((p.transpose() * p).try_inverse()? * p.transpose())
}

/// Tangents seen from the front, lifted onto the plane of `normal`: x and y stay, z follows.
fn lift(normal: &Vec3) -> Mat3 {
    let (a, b) = (-normal.x / normal.z, -normal.y / normal.z);
    Mat3::new(1.0, 0.0, 0.0, 0.0, 1.0, 0.0, a, b, 0.0)
}

pub(super) fn smallest_rotation(from: &Vec3, to: &Vec3) -> Mat3 {
    Rotation3::rotation_between(from, to).map_or_else(Mat3::identity, Rotation3::into_inner)
}
