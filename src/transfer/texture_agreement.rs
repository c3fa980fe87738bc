//! Whether the textures of two garments agree: equal texture coordinates lie at about equal positions, as the garments are
//! aligned, or after one of them is turned, scaled and shifted as a whole.

use crate::transfer::correspondence::{CorrespondenceFinder, MatchMode, position_of_place};
use crease_geometry::math::{Vec2, Vec3};

use crate::transfer::registration::{AffineMap, PointPair, fit_similarity};
use crate::transfer::tuning::TUNING;
use crease_model::remesh::GarmentSurface;

/// Agreement of the textures of a source and a target.
pub(super) struct TextureAgreement {
    /// Whether they agree as the garments are aligned.
    pub in_place: bool,
    /// The map of the source under which they agree, where they do not in place.
    pub similarity: Option<AffineMap>,
}

impl TextureAgreement {
    /// The agreement of `source` with `target`, whose box has the diagonal `size` [m]. `unscaled` is the source in its own
    /// proportions, which the map is for.
    pub fn of(
        source: &GarmentSurface,
        unscaled: &GarmentSurface,
        target: &GarmentSurface,
        size: f64,
    ) -> Self {
        let finder = CorrespondenceFinder::new(source, MatchMode::Uv, size);
        let max_distance = TUNING.uv_agreement_distance_fraction * size;
        // Ambiguous texture coordinates agree if one of their places does, and say nothing about a map.
        let (mut pairs, mut near, mut matched) = (Vec::new(), 0, 0);
        for (f, uv) in centre_uvs(target) {
            let position = target.centroid(f);
            let places = finder.places_of_uv(&uv);
            let is_near = |at: Vec3| (at - position).norm() < max_distance;
            near += usize::from(places.iter().any(|place| is_near(position_of_place(source, place))));
            matched += usize::from(!places.is_empty());
            if let [place] = places.as_slice() {
                pairs.push(PointPair { source: position_of_place(unscaled, place), target: position });
            }
        }
        let count = target.triangles.len() as f64;
        let enough = TUNING.min_uv_agreement_fraction * count;
        if near as f64 >= enough {
            return Self { in_place: true, similarity: None };
        }
        let agrees = |map: &AffineMap| {
            let close = |pair: &&PointPair| (map.apply(&pair.source) - pair.target).norm() < max_distance;
            let fitting = pairs.iter().filter(close).count() as f64;
            fitting >= TUNING.min_uv_agreement_fraction * pairs.len() as f64
                && fitting >= TUNING.min_unambiguous_fraction * count
        };
        let similarity = (matched as f64 >= enough).then(|| fit_similarity(&pairs)).flatten().filter(agrees);
        Self { in_place: false, similarity }
    }
}

/// Whether at least half of the triangles of `surface` have an area in its texture.
pub(super) fn has_texture(surface: &GarmentSurface) -> bool {
    let Some(uvs) = &surface.uvs else { return false };
    let has_area = |uv: &&[Vec2; 3]| (uv[1] - uv[0]).perp(&(uv[2] - uv[0])).abs() > 0.0;
    2 * uvs.iter().filter(has_area).count() >= uvs.len()
}

/// Fraction of the triangles of `target` whose texture coordinates belong to several places of the source [-].
pub(super) fn ambiguous_fraction(finder: &CorrespondenceFinder, target: &GarmentSurface) -> f64 {
    let ambiguous = centre_uvs(target).filter(|(_, uv)| finder.places_of_uv(uv).len() > 1).count();
    ambiguous as f64 / target.triangles.len().max(1) as f64
}

/// Triangles of `target` with the texture coordinates of their centroids.
fn centre_uvs(target: &GarmentSurface) -> impl Iterator<Item = (usize, Vec2)> {
    let uvs = target.uvs.as_deref().unwrap_or(&[]);
    uvs.iter().map(|uv| (uv[0] + uv[1] + uv[2]) / 3.0).enumerate()
}
