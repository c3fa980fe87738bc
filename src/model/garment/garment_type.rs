//! The garment as the solver sees it: welded points, triangles, material directions. Nothing changes it after import.

use crate::garment::build::connect;
use crate::garment::material_coords::flatten_triangles;
use crate::garment::wedges::TriangleWedges;
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
    /// Per point: whether it lies on a line that was drawn for a fold, or on a row beside one; `None` where triangles were not made for folds.
    pub on_fold_line: Option<Vec<bool>>,
    /// Edges and hinges of `triangles`.
    pub topology: Topology,
}

impl Garment {
    /// A garment of `points` \[m\], y up, and `triangles` as they are, without the checks and repairs of [`Garment::from_mesh`]: for
    /// meshes that the program itself makes.
    ///
    /// # Panics
    /// If a triangle names a point that is not there.
    #[doc(hidden)]
    pub fn of_triangles(points: Vec<Vec3>, triangles: &[[u32; 3]]) -> Self {
        let wedge = |t: &[u32; 3]| TriangleWedges { points: t.map(PointIndex), vertices: None };
        let wedges: Vec<TriangleWedges> = triangles.iter().map(wedge).collect();
        let (triangles, topology, triangle_part) = connect(points.len(), &wedges);
        let part_count = triangle_part.iter().max().map_or(0, |&last| last as usize + 1);
        let flat = flatten_triangles(&points, &wedges, &[], &[], &topology, part_count);
        Self {
            material: flat.material,
            material_from_uv: flat.from_uv,
            source_point: (0..points.len() as u32).map(PointIndex).collect(),
            memory_mask: vec![1.0; points.len()],
            sewing_mask: vec![1.0; points.len()],
            triangle_part,
            triangle_panel: vec![0; triangles.len()],
            inner_side: vec![false; triangles.len()],
            file_triangles: Vec::new(),
            on_fold_line: None,
            topology,
            triangles,
            points,
        }
    }

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
