//! The garment as the solver sees it: welded points, triangles, material directions. Nothing changes it after import.

use crease_geometry::math::{Vec2, Vec3};
use crease_geometry::mesh::{PointIndex, Topology};

/// Garment after import: SI units, y up, welded at seams.
#[derive(Debug, Clone)]
pub struct Garment {
    /// Source position of every point \[m\], y up.
    pub points: Vec<Vec3>,
    /// Corners of every triangle, no point repeated within one.
    pub triangles: Vec<[PointIndex; 3]>,
    /// Per triangle: its corners flattened \[m\] at true size, x along warp (+u), y along weft (+v).
    pub material: Vec<[Vec2; 3]>,
    /// Whether `material` directions come from texture coordinates (else from the source shape).
    pub material_from_uv: bool,
    /// Per source vertex of the worn pieces: its point.
    pub source_point: Vec<PointIndex>,
    /// Per point: factor 0..1 of how much the point's hinges and triangles remember.
    pub memory_mask: Vec<f64>,
    /// Per point: factor 0..1 of how much of its hem and its seam allowances there is; 0 for single cloth.
    pub sewing_mask: Vec<f64>,
    /// Per triangle: connected part it belongs to, counted from 0.
    pub triangle_part: Vec<u32>,
    /// Per triangle: panel it belongs to, counted from 0: an island of the texture coordinates where they follow the panels, else a
    /// piece of the file. Seams lie between panels.
    pub triangle_panel: Vec<u32>,
    /// Per triangle: whether it belongs to the inner side or the rim of cloth that was exported with its thickness, which follow the
    /// outer side ([`crate::garment::RigidParts`]).
    pub inner_side: Vec<bool>,
    /// Triangles of the file, if the garment has been refined ([`Garment::refine`]); empty if `triangles` are they.
    pub file_triangles: Vec<[PointIndex; 3]>,
    /// Edges and hinges of `triangles`.
    pub topology: Topology,
}

impl Garment {
    /// Returns the triangles of the file, which are what is exported: those before the garment was refined, if it was.
    pub fn exported_triangles(&self) -> &[[PointIndex; 3]] {
        if self.file_triangles.is_empty() { &self.triangles } else { &self.file_triangles }
    }

    /// Returns per point the connected part that it belongs to; the largest number for a point without triangles.
    pub fn point_parts(&self) -> Vec<u32> {
        let mut parts = vec![u32::MAX; self.points.len()];
        for (t, part) in self.triangles.iter().zip(&self.triangle_part) {
            t.iter().for_each(|p| parts[p.at()] = *part);
        }
        parts
    }
}
