//! Places of a garment's surface where it lies flat, front up: a fold is one straight line there, through all layers.

use crate::transfer::registration::moved;
use crate::wear::lying_places;
use crease_geometry::math::{Vec2, Vec3, bounds};
use crease_model::garment::is_flat_across;
use crease_model::remesh::GarmentSurface;

/// A surface as it lies.
pub(super) struct LyingPlane {
    /// One per point [m].
    pub places: Vec<Vec2>,
    /// One per triangle.
    pub looks_up: Vec<bool>,
}

/// Depth of what lies relative to that of what stands: enough to tell the front from the back.
const LYING_DEPTH: f64 = 0.01;

/// The surface `canonical`, which stands upright with its front along z, as it lies: its height is then the length of the cloth. `None` where its points
/// are not finite.
pub(super) fn lying(canonical: &GarmentSurface) -> Option<GarmentSurface> {
    let plane = LyingPlane::of(canonical)?;
    let places = plane.places.iter().zip(&canonical.points);
    Some(moved(canonical, places.map(|(place, x)| Vec3::new(place.x, place.y, LYING_DEPTH * x.z)).collect()))
}

impl LyingPlane {
    /// The surface `canonical`, which stands upright with its front along z; `None` where its points are not finite.
    pub fn of(canonical: &GarmentSurface) -> Option<Self> {
        let (low, high) = bounds(&canonical.points);
        let upright: Vec<Vec3> = canonical.points.iter().map(|x| Vec3::new(x.x, x.z, -x.y)).collect();
        let laid = match is_flat_across(&(high - low), 2) {
            true => upright,
            false => lying_places(&upright, &canonical.triangles)?,
        };
        // Seen from above, so that what looks up runs counter-clockwise.
        let places: Vec<Vec2> = laid.iter().map(|x| Vec2::new(x.x, -x.z)).collect();
        let looks_up = canonical.triangles.iter().map(|t| {
            let [a, b, c] = t.map(|p| places[p.at()]);
            (b - a).perp(&(c - a)) > 0.0
        });
        Some(Self { looks_up: looks_up.collect(), places })
    }

    /// Lowest and highest place [m].
    pub fn bounds(&self) -> [Vec2; 2] {
        let all = self.places.iter();
        all.fold([Vec2::repeat(f64::INFINITY), Vec2::repeat(f64::NEG_INFINITY)], |[low, high], x| {
            [low.inf(x), high.sup(x)]
        })
    }

    /// Corners of the triangle `face` of `surface` [m].
    pub fn corners(&self, surface: &GarmentSurface, face: u32) -> [Vec2; 3] {
        surface.triangles[face as usize].map(|p| self.places[p.at()])
    }
}
