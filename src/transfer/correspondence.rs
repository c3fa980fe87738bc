//! Correspondence between two garments: the source point that belongs to a point of the target, and the map of
//! directions between both.
//!
//! There are three match modes. By texture: the same texture coordinates. Closest point, where both garments have depth:
//! the nearest surface point whose normal agrees. Front projection, where one of them is flat: the nearest point seen from
//! the front, on the same side of the garment. Where several islands of the source lie on one another in the texture, the
//! one nearest in space counts. A point beyond an open border of the source, or farther off than a small
//! fraction of the garment, has no match: sleeves receive nothing from a vest.
//!
//! The map of directions `J` takes tangents of the source to tangents of the target (3 x 3, meaningful on the source's
//! plane only): by texture the quotient of both texture gradients, in front view the lift onto the target's plane, else the
//! smallest rotation between the normals.

use crate::transfer::limbs::Region;
use crate::transfer::tuning::TUNING;
use crease_geometry::math::{Mat3, Vec2, Vec3, bounds};
use crease_geometry::mesh::triangle_bvh::{NearestTriangle, TriangleBvh};
use crease_geometry::mesh::{Groups, PointIndex};
use crease_model::remesh::{
    Correspondence, GarmentSurface, Match, Query, smallest_rotation, texture_gradient,
};
use nalgebra::Matrix3x2;

/// How matches are found.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum MatchMode {
    /// Equal texture coordinates.
    Uv,
    /// NearestTriangle point in front view, on the same side of the garment.
    FrontProjection,
    /// NearestTriangle point in space whose normal agrees.
    ClosestPoint,
}

/// Correspondence with a source surface that is aligned with the target.
pub(super) struct CorrespondenceFinder<'a> {
    source: &'a GarmentSurface,
    mode: MatchMode,
    /// Points of the tree: in texture space, in front view or in space.
    points: Vec<Vec3>,
    tree: TriangleBvh,
    /// Per source triangle: outward unit normal.
    normals: Vec<Vec3>,
    /// Per source triangle: whether each of its sides is open.
    open: Vec<[bool; 3]>,
    /// Per source triangle: texture gradient; empty unless matches are found by texture.
    gradients: Vec<Option<Matrix3x2<f64>>>,
    /// Per source triangle: its texture island, if several lie on one another; else empty.
    islands: Vec<u32>,
    /// Largest distance of a match, in the space of `points`.
    max_distance: f64,
    /// Largest distance past an open border, in the same space.
    border_slack: f64,
    /// Region of every triangle of the source and of the target, if cloth belongs to that of its own region only.
    regions: Option<&'a [Vec<Region>; 2]>,
}

impl<'a> CorrespondenceFinder<'a> {
    /// A finder on `source`, aligned with a target whose box has the diagonal `size` [m]. The mode [`MatchMode::Uv`] needs
    /// texture coordinates on the source; without them the closest point is taken.
    pub fn new(source: &'a GarmentSurface, mode: MatchMode, size: f64) -> Self {
        let outward = source.orientation_sign();
        let count = source.triangles.len();
        let normals =
            (0..count).map(|f| outward * source.normal(f).try_normalize(0.0).unwrap_or_else(Vec3::z));
        let edges = &source.topology;
        let open = edges.triangle_edges.iter().map(|t| t.map(|e| edges.edge_valence[e as usize] == 1));
        let front_distance = TUNING.max_front_distance_fraction * size;
        let closest_distance = TUNING.max_closest_distance_fraction * size;
        let (points, triangles, max_distance, gradients) = match (mode, &source.uvs) {
            (MatchMode::Uv, Some(uvs)) => {
                let points: Vec<Vec3> = uvs.iter().flatten().map(|uv| Vec3::new(uv.x, uv.y, 0.0)).collect();
                let triangles = (0..count as u32).map(|f| [0, 1, 2].map(|k| PointIndex(3 * f + k)));
                let (low, high) = bounds(&points);
                let side =
                    ((high - low).norm() / (count.max(1) as f64).sqrt()) * TUNING.max_uv_distance_triangles;
                let gradients = (0..count).map(|f| texture_gradient(&source.corners(f), &uvs[f])).collect();
                (points, triangles.collect(), side, gradients)
            }
            (MatchMode::FrontProjection, _) => {
                let points = source.points.iter().map(|p| Vec3::new(p.x, p.y, 0.0)).collect();
                (points, source.triangles.clone(), front_distance, Vec::new())
            }
            _ => (source.points.clone(), source.triangles.clone(), closest_distance, Vec::new()),
        };
        let tree = TriangleBvh::new(&points, &triangles, 0.0);
        let islands = match (mode, &source.uvs) {
            (MatchMode::Uv, Some(uvs)) => overlapping_islands(source, uvs, &tree, &points),
            _ => Vec::new(),
        };
        Self {
            source,
            mode,
            tree,
            points,
            islands,
            normals: normals.collect(),
            open: open.collect(),
            gradients,
            max_distance,
            border_slack: if mode == MatchMode::Uv { max_distance } else { front_distance },
            regions: None,
        }
    }

    /// The same finder that matches cloth with that of its own region only: of every triangle of the source and of the target.
    pub fn within_regions(self, regions: &'a [Vec<Region>; 2]) -> Self {
        Self { regions: Some(regions), ..self }
    }

    /// Whether cloth of the source's triangle `f` can belong to cloth of `region`.
    fn is_within(&self, region: Region, f: u32) -> bool {
        self.regions.is_none_or(|[own, _]| own[f as usize].fits(region))
    }

    /// The places of the source with the texture coordinates `uv`: one, or one per island of those that lie on one another
    /// there.
    pub fn places_of_uv(&self, uv: &Vec2) -> Vec<NearestTriangle> {
        let at = Vec3::new(uv.x, uv.y, 0.0);
        let Some(found) = self.tree.nearest(&self.points, at, self.max_distance) else { return Vec::new() };
        let mut places = vec![found];
        // Next to the nearest one; islands side by side are told apart by the texture.
        let limit = found.closest.distance + TUNING.uv_overlap_fraction * self.max_distance;
        let island = |f: u32| self.islands.get(f as usize).copied();
        while !self.islands.is_empty() && places.len() < TUNING.max_places_of_uv {
            let fresh = |f: u32| places.iter().all(|place| island(place.triangle) != island(f));
            let Some(more) = self.tree.nearest_where(&self.points, at, limit, fresh) else { break };
            places.push(more);
        }
        places
    }

    fn match_uv(&self, query: &Query) -> Option<Match> {
        let distance =
            |place: &NearestTriangle| (position_of_place(self.source, place) - query.position).norm();
        let places = self.places_of_uv(&query.uv?);
        let found = places.into_iter().min_by(|a, b| distance(a).total_cmp(&distance(b)))?;
        let triangle = found.triangle as usize;
        let map = query.gradient? * pseudo_inverse(&self.gradients[triangle]?)?;
        Some(Match {
            triangle,
            position: position_of_place(self.source, &found),
            quality: 1.0 - 0.5 * found.closest.distance / self.max_distance,
            map,
        })
    }

    fn match_front(&self, query: &Query, region: Region) -> Option<Match> {
        let from = Vec3::new(query.position.x, query.position.y, 0.0);
        let same_side =
            |f: u32| self.normals[f as usize].z * query.normal.z > 0.0 && self.is_within(region, f);
        let found = self.tree.nearest_where(&self.points, from, self.max_distance, same_side)?;
        let triangle = found.triangle as usize;
        let own = &self.normals[triangle];
        let facing = query.normal.z.abs().min(own.z.abs());
        let map = if facing < TUNING.edge_on_cosine {
            smallest_rotation(own, &query.normal)
        } else {
            lift(&query.normal)
        };
        let quality = proximity(&found, self.max_distance) * linear_ramp(facing, 0.0, TUNING.edge_on_cosine);
        Some(Match { triangle, position: position_of_place(self.source, &found), quality, map })
    }

    fn match_closest(&self, query: &Query, region: Region) -> Option<Match> {
        let agrees = |f: u32| {
            self.normals[f as usize].dot(&query.normal) > TUNING.min_normal_cosine
                && self.is_within(region, f)
        };
        let found = self.tree.nearest_where(&self.points, query.position, self.max_distance, agrees)?;
        let triangle = found.triangle as usize;
        let own = &self.normals[triangle];
        if self.is_beyond_border(&found, own) {
            return None;
        }
        let agreement =
            linear_ramp(own.dot(&query.normal), TUNING.min_normal_cosine, TUNING.full_normal_cosine);
        let quality = proximity(&found, self.max_distance) * agreement;
        let position = position_of_place(self.source, &found);
        Some(Match { triangle, position, quality, map: smallest_rotation(own, &query.normal) })
    }

    /// Whether the nearest point lies on an open side of its triangle and the query well past that side.
    fn is_beyond_border(&self, found: &NearestTriangle, normal: &Vec3) -> bool {
        let sideways = found.closest.vector - normal * normal.dot(&found.closest.vector);
        if sideways.norm() <= self.border_slack {
            return false;
        }
        // Side k runs from corner k to k + 1; on it, the weight of the third corner is 0.
        let weights = &found.closest.weights;
        let open = &self.open[found.triangle as usize];
        (0..3).any(|k| open[k] && weights[1 + (k + 2) % 3].abs() < 1e-9)
    }
}

impl Correspondence for CorrespondenceFinder<'_> {
    fn source(&self) -> &GarmentSurface {
        self.source
    }

    fn find(&self, f: usize, query: &Query) -> Option<Match> {
        let region = self.regions.map_or(Region::Any, |[_, target]| target[f]);
        match self.mode {
            MatchMode::Uv => self.match_uv(query),
            MatchMode::FrontProjection => self.match_front(query, region),
            MatchMode::ClosestPoint => self.match_closest(query, region),
        }
    }
}

/// Position on `surface` of a place that was found in texture space [m].
pub(super) fn position_of_place(surface: &GarmentSurface, place: &NearestTriangle) -> Vec3 {
    surface.corners(place.triangle as usize).iter().zip(place.weights()).map(|(x, w)| x * w).sum()
}

/// Returns the texture island of every triangle of `source`, if two of them lie on one another; else nothing.
fn overlapping_islands(
    source: &GarmentSurface,
    uvs: &[[Vec2; 3]],
    tree: &TriangleBvh,
    points: &[Vec3],
) -> Vec<u32> {
    let islands = texture_islands(source, uvs);
    let overlaps = |f: usize| {
        let centre = (uvs[f][0] + uvs[f][1] + uvs[f][2]) / 3.0;
        let other = |g: u32| islands[g as usize] != islands[f];
        tree.nearest_where(points, Vec3::new(centre.x, centre.y, 0.0), TUNING.uv_continuity_tol, other)
            .is_some()
    };
    if (0..uvs.len()).any(overlaps) { islands } else { Vec::new() }
}

/// Returns the texture island of every triangle of `source`. Triangles of one island continue each other in texture space, on the same
/// side of it.
pub(super) fn texture_islands(source: &GarmentSurface, uvs: &[[Vec2; 3]]) -> Vec<u32> {
    let turn = |f: usize| (uvs[f][1] - uvs[f][0]).perp(&(uvs[f][2] - uvs[f][0]));
    let uv_of =
        |f: usize, p: PointIndex| source.triangles[f].iter().position(|own| *own == p).map(|k| uvs[f][k]);
    let mut groups = Groups::new(uvs.len());
    for hinge in &source.topology.hinges {
        let [a, b] = hinge.triangles.map(|f| f as usize);
        let continues = |p: PointIndex| match (uv_of(a, p), uv_of(b, p)) {
            (Some(x), Some(y)) => (x - y).norm() <= TUNING.uv_continuity_tol,
            _ => false,
        };
        if continues(hinge.points[0]) && continues(hinge.points[1]) && turn(a) * turn(b) > 0.0 {
            groups.join(a as u32, b as u32);
        }
    }
    groups.numbered().0.iter().map(|island| island.0).collect()
}

/// 1 at distance 0, falling linearly to 0 at `max_distance`.
fn proximity(found: &NearestTriangle, max_distance: f64) -> f64 {
    (1.0 - found.closest.distance / max_distance).clamp(0.0, 1.0)
}

/// 0 below `low`, 1 above `high`, linear between.
fn linear_ramp(x: f64, low: f64, high: f64) -> f64 {
    ((x - low) / (high - low)).clamp(0.0, 1.0)
}

/// P^+ = (P^T P)^-1 P^T.
fn pseudo_inverse(p: &Matrix3x2<f64>) -> Option<nalgebra::Matrix2x3<f64>> {
    Some((p.transpose() * p).try_inverse()? * p.transpose())
}

/// Lift of tangents in front view onto the plane of `normal`: x and y are kept, z follows.
fn lift(normal: &Vec3) -> Mat3 {
    let (a, b) = (-normal.x / normal.z, -normal.y / normal.z);
    Mat3::new(1.0, 0.0, 0.0, 0.0, 1.0, 0.0, a, b, 0.0)
}
