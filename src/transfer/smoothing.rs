//! Curvature spread in part over one ring of triangles: from triangles to points and back, weighted by area.
//!
//! A crease is narrower than the triangles of a coarse mesh. Where its line passes between their edges, hinge after hinge would
//! take all of it or nothing; spread over one ring, every triangle near the line has its part. The integral of the curvature
//! over the surface stays.

use crate::math::{Mat3, Vec3};
use crate::transfer::hinge_fit::{FaceFrame, PlaneTensor};
use crate::transfer::resample::ResampledFace;
use crate::transfer::surface::GarmentSurface;
use crate::transfer::tuning::TUNING;
use std::f64::consts::SQRT_2;

/// Spreads the curvature of `faces`, one per triangle of `surface`.
pub(super) fn smooth_curvature(surface: &GarmentSurface, faces: &mut [ResampledFace]) {
    let frames: Vec<FaceFrame> = (0..faces.len()).map(|f| FaceFrame::new(&surface.corners(f))).collect();
    let areas: Vec<f64> = (0..faces.len()).map(|f| 0.5 * surface.normal(f).norm()).collect();
    let mut point_area = vec![0.0; surface.points.len()];
    for (t, area) in surface.triangles.iter().zip(&areas) {
        t.iter().for_each(|p| point_area[p.at()] += area);
    }
    // Mean over the triangles at a point, in the frame of space.
    let mut at_points = vec![Mat3::zeros(); surface.points.len()];
    for (f, face) in faces.iter().enumerate() {
        if face.curvature == PlaneTensor::zeros() {
            continue;
        }
        let tensor = to_space(&frames[f], &face.curvature) * areas[f];
        for p in &surface.triangles[f] {
            at_points[p.at()] += tensor / point_area[p.at()].max(f64::MIN_POSITIVE);
        }
    }
    for (f, face) in faces.iter_mut().enumerate() {
        let [a, b, c] = surface.triangles[f].map(|p| at_points[p.at()]);
        let spread = to_plane(&frames[f], &((a + b + c) / 3.0));
        face.curvature += (spread - face.curvature) * TUNING.spread_fraction;
    }
}

fn to_space(frame: &FaceFrame, tensor: &PlaneTensor) -> Mat3 {
    let (x, y) = (&frame.x, &frame.y);
    let mixed = x * y.transpose() + y * x.transpose();
    x * x.transpose() * tensor[0] + y * y.transpose() * tensor[1] + mixed * (tensor[2] / SQRT_2)
}

fn to_plane(frame: &FaceFrame, tensor: &Mat3) -> PlaneTensor {
    let part = |a: &Vec3, b: &Vec3| a.dot(&(tensor * b));
    let (x, y) = (&frame.x, &frame.y);
    PlaneTensor::new(part(x, x), part(y, y), SQRT_2 * part(x, y))
}
