//! Places of a garment's surface where it lies flat, front up: a fold is one straight line there, through all layers.

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

    /// Corners of the triangle `t` [m].
    pub fn corners(&self, surface: &GarmentSurface, face: u32) -> [Vec2; 3] {
        surface.triangles[face as usize].map(|p| self.places[p.at()])
    }
}
