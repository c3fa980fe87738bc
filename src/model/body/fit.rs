//! How a garment lies on a body: which of its points are near the outer side, and which are inside.

use crate::body::animated_body::{AnimatedBody, BodyPose};
use crease_geometry::math::Vec3;
use crease_geometry::mesh::point_in_solid::Solid;
use crease_geometry::mesh::triangle_bvh::TriangleBvh;

/// Points of a garment that are looked at; a fraction needs no more.
const MAX_SAMPLES: usize = 500;
/// Distance from the body within which a point of a garment is near it, over the longest side of the garment's box [-].
const NEAR_FRACTION: f64 = 0.1;
/// Depth from which a point is inside [m]: a fitted garment lies in its body by less.
const MIN_DEPTH: f64 = 5e-3;
/// Depth at which the search for the surface ends [m].
const MAX_DEPTH: f64 = 0.5;
/// Fraction of the points of a garment inside the pose of the file from which another pose may be meant [-].
const MIN_INSIDE: f64 = 0.02;
/// Fraction of those that may be inside the other pose [-].
const MAX_STILL_INSIDE: f64 = 0.25;

impl AnimatedBody {
    /// Returns the fraction of `garment` \[m\] that lies on the body in the pose that it starts in, if the body is `scale` times as large:
    /// near its surface and not inside.
    pub fn worn_fraction(&self, garment: &[Vec3], scale: f64) -> f64 {
        let points: Vec<Vec3> = self.rest_points().iter().map(|p| p * scale).collect();
        self.fit(&points, &samples(garment)).worn
    }

    /// Returns the fractions of `garment` \[m\] inside the pose that the body starts in and inside `pose`, if it fits `pose` and not the
    /// former: hardly any of it lies inside, and at least as much near the surface.
    pub fn fits_better_in(&self, garment: &[Vec3], pose: &BodyPose) -> Option<[f64; 2]> {
        let samples = samples(garment);
        let start = self.fit(self.rest_points(), &samples);
        if start.inside < MIN_INSIDE {
            return None;
        }
        let other = self.fit(&self.points(pose), &samples);
        let fits = other.inside <= MAX_STILL_INSIDE * start.inside && other.worn >= start.worn;
        fits.then_some([start.inside, other.inside])
    }

    /// How `samples` of a garment lie on the body with its points at `points` [m].
    fn fit(&self, points: &[Vec3], samples: &[Vec3]) -> Fit {
        let corners =
            samples.iter().map(|p| (*p, *p)).reduce(|(low, high), (p, _)| (low.inf(&p), high.sup(&p)));
        let Some((low, high)) = corners else { return Fit { inside: 0.0, worn: 0.0 } };
        let near = NEAR_FRACTION * (high - low).max();
        let bvh = TriangleBvh::new(points, self.triangles(), 0.0);
        let depths = Solid::new(points, self.triangles()).depths(samples, MAX_DEPTH);
        let is_near = |p: &Vec3| bvh.nearest(points, *p, near).is_some();
        let inside = depths.iter().filter(|depth| **depth >= MIN_DEPTH).count();
        let worn = samples.iter().zip(&depths).filter(|(p, depth)| **depth < MIN_DEPTH && is_near(p)).count();
        let fraction = |count: usize| count as f64 / samples.len() as f64;
        Fit { inside: fraction(inside), worn: fraction(worn) }
    }
}

/// How a garment lies on a body.
struct Fit {
    /// Fraction of its points inside [-].
    inside: f64,
    /// Fraction of its points near the surface and not inside [-].
    worn: f64,
}

/// Returns some of `points`, evenly spread over the list.
fn samples(points: &[Vec3]) -> Vec<Vec3> {
    points.iter().step_by(points.len().div_ceil(MAX_SAMPLES).max(1)).copied().collect()
}
