//! The interface between a map of one surface to another and what is sampled through it.

use crate::remesh::carry::surface::GarmentSurface;
use crease_geometry::math::{Mat3, Vec2, Vec3};
use nalgebra::{Matrix3x2, Rotation3};

/// A point of the target in canonical coordinates.
#[derive(Debug, Clone, Copy)]
pub struct Query {
    /// Position [m].
    pub position: Vec3,
    /// Texture coordinates, if the target has any.
    pub uv: Option<Vec2>,
    /// Outward unit normal of its triangle.
    pub normal: Vec3,
    /// Texture gradient dX/d(u, v) of its triangle.
    pub gradient: Option<Matrix3x2<f64>>,
}

/// The source triangle that belongs to a query.
#[derive(Debug, Clone, Copy)]
pub struct Match {
    /// Source triangle.
    pub triangle: usize,
    /// Position on it [m], in canonical coordinates.
    pub position: Vec3,
    /// Quality 0..1 by distance and by how well the normals agree.
    pub quality: f64,
    /// Map from source tangents to target tangents.
    pub map: Mat3,
}

/// A rule that assigns source triangles to points of a target.
pub trait Correspondence: Sync {
    /// The source surface.
    fn source(&self) -> &GarmentSurface;

    /// The match of `query`, a point of target triangle `f`, if there is one.
    fn find(&self, f: usize, query: &Query) -> Option<Match>;
}

/// The smallest rotation that takes `from` to `to`.
pub fn smallest_rotation(from: &Vec3, to: &Vec3) -> Mat3 {
    let rotation = Rotation3::rotation_between(from, to).map(Rotation3::into_inner);
    // Between nearly opposite directions rounding may take the cosine beyond -1, which has no angle.
    rotation.filter(|r| r.iter().all(|x| x.is_finite())).unwrap_or_else(Mat3::identity)
}
