//! How a garment lies on a body: which of its points are near the outer side, and which are inside.

use crate::body::animated_body::AnimatedBody;
use crate::math::Vec3;
use crate::mesh::point_in_solid::Solid;
use crate::mesh::triangle_bvh::TriangleBvh;

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
    /// Returns the fraction of `garment` \[m\] that lies on the body in the pose of the file, if the body is `scale` times as large:
    /// near its surface and not inside.
    pub fn worn_fraction(&self, garment: &[Vec3], scale: f64) -> f64 {
        let points: Vec<Vec3> = self.rest_points().iter().map(|p| p * scale).collect();
        let samples = samples(garment);
        let corners =
            samples.iter().map(|p| (*p, *p)).reduce(|(low, high), (p, _)| (low.inf(&p), high.sup(&p)));
        let Some((low, high)) = corners else { return 0.0 };
        let near = NEAR_FRACTION * (high - low).max();
        let bvh = TriangleBvh::new(&points, self.triangles(), 0.0);
        let depths = Solid::new(&points, self.triangles()).depths(&samples, MAX_DEPTH);
        let is_worn =
            |(p, depth): &(&Vec3, &f64)| **depth < MIN_DEPTH && bvh.nearest(&points, **p, near).is_some();
        samples.iter().zip(&depths).filter(is_worn).count() as f64 / samples.len() as f64
    }

    /// Returns the fractions of `garment` \[m\] inside the pose of the file and inside the first key of `clip`, if it fits that one and
    /// not the former: the garment was modelled on the first key then.
    pub fn fits_first_key(&self, garment: &[Vec3], clip: usize) -> Option<[f64; 2]> {
        let root = self.root_motion(clip);
        let first = self.points(&self.clip_pose(clip, 0.0, root.as_ref()));
        let samples = samples(garment);
        let inside = |points: &[Vec3]| {
            let depths = Solid::new(points, self.triangles()).depths(&samples, MAX_DEPTH);
            depths.iter().filter(|depth| **depth > MIN_DEPTH).count() as f64 / samples.len().max(1) as f64
        };
        let at_rest = inside(self.rest_points());
        if at_rest < MIN_INSIDE {
            return None;
        }
        let at_first = inside(&first);
        (at_first <= MAX_STILL_INSIDE * at_rest).then_some([at_rest, at_first])
    }

    /// Returns the body that starts in the first key of `clip` instead of the pose of its file.
    pub fn starting_at(&self, clip: usize) -> Self {
        let root = self.root_motion(clip);
        self.with_start(self.clip_pose(clip, 0.0, root.as_ref()))
    }
}

/// Returns some of `points`, evenly spread over the list.
fn samples(points: &[Vec3]) -> Vec<Vec3> {
    points.iter().step_by(points.len().div_ceil(MAX_SAMPLES).max(1)).copied().collect()
}
