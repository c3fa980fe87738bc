//! Morph target `worn` of the finer mesh: positions and normals of the worn surface, relative to the shape that the file shows.

use crate::gltf::detail::DetailInput;
use crate::gltf::fine::FinePiece;
use crate::gltf::fine::rows::{AttributeRows, PrimitiveRows};
use crate::gltf::json_cursor::Cursor;
use crate::gltf::morph::default_weights;
use crate::gltf::read_worn::worn_target_index;
use crate::gltf::worn_target::LinearParts;
use crease_geometry::math::{Mat3, Mat4, Vec3};
use crease_model::error::{Error, Result};
use crease_model::garment::{GltfDocument, Placement};
use crease_model::remesh::{FinePoint, FineVertex};

/// Displacement below which a vertex stays where it is [m]: rounding.
const MIN_DISPLACEMENT: f64 = 1e-8;

/// Vertex after the wear.
pub(super) struct WornVertex {
    /// Transform from own coordinates to the scene.
    placement: Mat4,
    /// Unit normal in the scene that the wear turns.
    normal: Vec3,
    point: FinePoint,
}

impl WornVertex {
    /// The vertices of `piece`, those of the file first, then the new `vertices`; `points` are those of the finer mesh.
    pub(super) fn all(
        piece: &FinePiece,
        detail: &DetailInput,
        vertices: &[&FineVertex],
        points: &[FinePoint],
    ) -> Vec<Self> {
        let source = piece.source;
        let placement = |v: usize| *source.placement.matrix(v);
        let up = |n: &Vec3| n.try_normalize(f64::MIN_POSITIVE).unwrap_or_else(Vec3::y);
        let unworn = (0..piece.points.len()).map(|v| {
            let inverse = linear(&placement(v)).try_inverse().unwrap_or_else(Mat3::identity);
            source.normals.as_ref().map_or_else(Vec3::y, |normals| up(&(inverse.transpose() * normals[v])))
        });
        let unworn: Vec<Vec3> = unworn.collect();
        let normals = detail.unworn_normals(piece.points, &unworn, &source.triangles);
        let of_file = piece.points.iter().enumerate().map(|(v, p)| Self {
            placement: placement(v),
            normal: normals[v],
            point: points[p.at()],
        });
        let new = vertices.iter().map(|vertex| {
            let parts = || vertex.of.iter().map(|v| *v as usize - piece.first).zip(vertex.weights);
            let placement = match &source.placement {
                Placement::Rigid(one) => *one,
                Placement::Skinned(all) => parts().map(|(v, part)| all[v] * part).sum(),
            };
            let normal: Vec3 = parts().map(|(v, part)| normals[v] * part).sum();
            Self { placement, normal: up(&normal), point: points[vertex.point as usize] }
        });
        of_file.chain(new).collect()
    }
}

impl PrimitiveRows {
    /// Sets the rows of the target `worn` to those of `vertices`; `file` is its name in messages. What has no place on the worn surface keeps what it has.
    pub(super) fn set_worn(
        &mut self,
        file: &str,
        document: &GltfDocument,
        piece: &FinePiece,
        vertices: &[WornVertex],
    ) -> Result<()> {
        let source = piece.source;
        let Some(worn) = worn_target_index(document, source).filter(|k| *k < self.targets.len()) else {
            return Ok(());
        };
        let weights = default_weights(&Cursor::root(&document.json), source.mesh, source.node);
        let placements: Vec<Mat4> = vertices.iter().map(|vertex| vertex.placement).collect();
        let parts = LinearParts::new(&placements).map_err(|v| {
            let message = format!("the transform of vertex {v} flattens it");
            Error::input(file, &source.name, message, "give every node and joint a scale other than 0")
        })?;
        let shown = |name: &str| self.shown(name, &weights);
        let (positions, normals, tangents) = (shown("POSITION"), shown("NORMAL"), shown("TANGENT"));
        let mut rows: [Vec<Vec3>; 3] = ["POSITION", "NORMAL", "TANGENT"].map(|name| self.target(worn, name));
        for (v, vertex) in vertices.iter().enumerate() {
            let Some(turn) = vertex.point.turn else { continue };
            let linear = parts.at(v);
            if let (Some(own), Some(row)) = (positions.get(v), rows[0].get_mut(v)) {
                let origin = (vertex.placement * own.push(1.0)).xyz();
                let moved = vertex.point.position - origin;
                *row = if moved.norm() < MIN_DISPLACEMENT { Vec3::zeros() } else { linear.inverse * moved };
            }
            let normal = (turn * vertex.normal).try_normalize(f64::MIN_POSITIVE);
            let Some(normal) = normal else { continue };
            if let (Some(own), Some(row)) = (normals.get(v), rows[1].get_mut(v)) {
                *row = (linear.forward.transpose() * normal)
                    .try_normalize(f64::MIN_POSITIVE)
                    .map_or(*row, |n| n - own);
            }
            if let (Some(own), Some(row)) = (tangents.get(v), rows[2].get_mut(v)) {
                let turned = turn * (linear.forward * own);
                let turned = linear.inverse * (turned - normal * normal.dot(&turned));
                *row = turned.try_normalize(f64::MIN_POSITIVE).map_or(*row, |t| t - own);
            }
        }
        for (name, rows) in ["POSITION", "NORMAL", "TANGENT"].into_iter().zip(rows) {
            self.set_target(worn, name, &rows);
        }
        Ok(())
    }

    /// Vectors of `attribute` as the file shows them: with its morph targets by their `weights`; none without the attribute.
    fn shown(&self, attribute: &str, weights: &[f64]) -> Vec<Vec3> {
        let own = self.attributes.iter().find(|rows| rows.name == attribute && rows.width >= 3);
        let mut shown = own.map_or_else(Vec::new, AttributeRows::vectors);
        for (target, weight) in self.targets.iter().zip(weights).filter(|(_, weight)| **weight != 0.0) {
            let delta = target.iter().find(|rows| rows.name == attribute && rows.width == 3);
            let delta = delta.map_or_else(Vec::new, AttributeRows::vectors);
            shown.iter_mut().zip(delta).for_each(|(own, delta)| *own += delta * *weight);
        }
        shown
    }

    /// Vectors of an attribute of target `k`; none without it.
    fn target(&self, k: usize, name: &str) -> Vec<Vec3> {
        let rows = self.targets[k].iter().find(|rows| rows.name == name && rows.width == 3);
        rows.map_or_else(Vec::new, AttributeRows::vectors)
    }

    fn set_target(&mut self, k: usize, name: &str, rows: &[Vec3]) {
        if let Some(own) = self.targets[k].iter_mut().find(|own| own.name == name && own.width == 3) {
            own.values = rows.iter().flat_map(|row| [row.x, row.y, row.z]).collect();
        }
    }
}

impl AttributeRows {
    /// The first three numbers of every row.
    pub(super) fn vectors(&self) -> Vec<Vec3> {
        self.values.chunks_exact(self.width.max(3)).map(|row| Vec3::new(row[0], row[1], row[2])).collect()
    }
}

fn linear(placement: &Mat4) -> Mat3 {
    placement.fixed_view::<3, 3>(0, 0).into_owned()
}
