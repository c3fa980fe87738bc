//! Curvature spread in part over one ring of triangles: from triangles to points and back, weighted by area.
//!
//! A crease is narrower than the triangles of a coarse mesh. Where its line passes between their edges, hinge after hinge would
//! take all of it or nothing; spread over one ring, every triangle near the line has its part. The integral of the curvature
//! over the surface stays.

use crate::remesh::carry::hinge_fit::{FaceFrame, PlaneTensor};
use crate::remesh::carry::resample::ResampledFace;
use crate::remesh::carry::surface::GarmentSurface;
use crate::remesh::carry::tuning::TUNING;
use crease_geometry::math::{Mat3, Vec3};
use std::f64::consts::SQRT_2;

/// Spreads the curvature of `faces`, one per triangle of `surface`.
pub fn smooth_curvature(surface: &GarmentSurface, faces: &mut [ResampledFace]) {
    let tensors: Vec<PlaneTensor> = faces.iter().map(|face| face.curvature).collect();
    let spread = ring_mean(surface, &tensors, &vec![true; faces.len()]);
    for (face, spread) in faces.iter_mut().zip(&spread) {
        face.curvature += (spread - face.curvature) * TUNING.spread_fraction;
    }
}

/// The tensors of the triangles `counted` of `surface`, averaged over one ring of such triangles: their integral over the surface
/// stays. Others keep theirs. One tensor and one flag per triangle.
pub fn ring_mean(surface: &GarmentSurface, tensors: &[PlaneTensor], counted: &[bool]) -> Vec<PlaneTensor> {
    let frames: Vec<FaceFrame> = (0..tensors.len()).map(|f| FaceFrame::new(&surface.corners(f))).collect();
    let counted_area = |f: usize| if counted[f] { 0.5 * surface.normal(f).norm() } else { 0.0 };
    let areas: Vec<f64> = (0..tensors.len()).map(counted_area).collect();
    let mut point_area = vec![0.0; surface.points.len()];
    for (t, area) in surface.triangles.iter().zip(&areas) {
        t.iter().for_each(|p| point_area[p.at()] += area);
    }
    // Mean over the triangles at a point, in the frame of space.
    let mut at_points = vec![Mat3::zeros(); surface.points.len()];
    for (f, tensor) in tensors.iter().enumerate().filter(|(f, t)| counted[*f] && **t != PlaneTensor::zeros())
    {
        let tensor = to_space(&frames[f], tensor) * areas[f];
        for p in &surface.triangles[f] {
            at_points[p.at()] += tensor / point_area[p.at()].max(f64::MIN_POSITIVE);
        }
    }
    let mean = |(f, own): (usize, &PlaneTensor)| {
        let [a, b, c] = surface.triangles[f].map(|p| at_points[p.at()]);
        if counted[f] { to_plane(&frames[f], &((a + b + c) / 3.0)) } else { *own }
    };
    tensors.iter().enumerate().map(mean).collect()
}

fn to_space(frame: &FaceFrame, tensor: &PlaneTensor) -> Mat3 {
    let (x, y) = (&frame.x, &frame.y);
    let mixed = x * y.transpose() + y * x.transpose();
    x * x.transpose() * tensor[0] + y * y.transpose() * tensor[1] + mixed * (tensor[2] / SQRT_2)
}

pub fn to_plane(frame: &FaceFrame, tensor: &Mat3) -> PlaneTensor {
    let part = |a: &Vec3, b: &Vec3| a.dot(&(tensor * b));
    let (x, y) = (&frame.x, &frame.y);
    PlaneTensor::new(part(x, x), part(y, y), SQRT_2 * part(x, y))
}
