//! A mesh file, or arrays, as read: every piece in file order with its own vertices, and (for glTF) the whole document, so that export
//! can return everything else untouched. `io` reads it, `Garment` is built from its worn pieces, `io` writes it out again
//! with the worn pieces changed.

use crease_geometry::math::{Mat3, Mat4, Vec2, Vec3};
use serde_json::Value;

/// Format of a mesh file.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum SourceFormat {
    /// Wavefront OBJ.
    Obj,
    /// glTF 2.0, as .gltf or .glb.
    Gltf,
    /// USD, as .usda, .usdc, .usd or .usdz.
    Usd,
    /// Arrays in memory: no file.
    Arrays,
}

/// Axis of a file that points up.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub enum UpAxis {
    /// y up (glTF, most OBJ).
    #[default]
    Y,
    /// z up: (x, y, z) of the file is (x, z, -y) inside.
    Z,
}

impl UpAxis {
    /// Returns the transform to metres, y up, from units of `unit_m` \[m\] with this axis up.
    pub fn to_scene(self, unit_m: f64) -> Mat4 {
        let turned = match self {
            Self::Y => Mat4::identity(),
            Self::Z => Mat4::new(
                1.0, 0.0, 0.0, 0.0, //
                0.0, 0.0, 1.0, 0.0, //
                0.0, -1.0, 0.0, 0.0, //
                0.0, 0.0, 0.0, 1.0,
            ),
        };
        Mat4::new_scaling(unit_m) * turned
    }
}

/// glTF document: its raw JSON and its buffers.
#[derive(Debug, Clone)]
pub struct GltfDocument {
    /// JSON as read, keys in file order, nothing dropped.
    pub json: Value,
    /// Bytes of each entry of `buffers`.
    pub buffers: Vec<Vec<u8>>,
    /// Chunks of a GLB file besides those of JSON and of buffers.
    pub chunks: Vec<GlbChunk>,
}

/// Chunk of a GLB file that belongs to an extension or to another program.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct GlbChunk {
    /// Type.
    pub kind: [u8; 4],
    /// Content.
    pub data: Vec<u8>,
}

/// Transform from a piece's own coordinates to the scene (metres, y up).
#[derive(Debug, Clone)]
pub enum Placement {
    /// One transform for every vertex (node transform, unit and up axis).
    Rigid(Mat4),
    /// One transform per vertex: a skin in bind pose (weighted sum of joint matrices, with unit and up axis).
    Skinned(Vec<Mat4>),
}

impl Placement {
    /// Returns the transform of vertex `v` of the piece. Panics if there is no such vertex.
    pub fn matrix(&self, v: usize) -> &Mat4 {
        match self {
            Self::Rigid(m) => m,
            Self::Skinned(all) => &all[v],
        }
    }

    /// Returns whether the placement mirrors a triangle of the piece: the determinant of its linear part is negative, and
    /// the orientation of the triangle in the scene is opposite to that of its list of corners (glTF 2.0 specification,
    /// 3.7.4).
    pub fn mirrors(&self, triangle: &[u32; 3]) -> bool {
        let volume = |m: &Mat4| m.fixed_view::<3, 3>(0, 0).into_owned().determinant();
        match self {
            Self::Rigid(m) => volume(m) < 0.0,
            Self::Skinned(all) => {
                let corners = triangle.iter().filter_map(|&v| all.get(v as usize));
                corners.map(|m| volume(m).signum()).sum::<f64>() < 0.0
            }
        }
    }
}

/// Triangles with one material: a glTF primitive instance, one group-and-material of an OBJ, or one material of a USD mesh.
#[derive(Debug, Clone)]
pub struct SourcePiece {
    /// Node or group name, for `--garment` and for messages.
    pub name: String,
    /// Material name, if any.
    pub material: Option<String>,
    /// glTF: index into `meshes`; OBJ: 0; USD: number of the mesh.
    pub mesh: usize,
    /// glTF: index into the mesh's `primitives`; OBJ, USD: number of the piece.
    pub primitive: usize,
    /// glTF: index of the node that carries the mesh.
    pub node: Option<usize>,
    /// One per vertex, in the piece's own coordinates and the file's unit.
    pub positions: Vec<Vec3>,
    /// One per vertex: number of its position in the file, where vertices refer to a common list of positions (an OBJ's `v`, a USD mesh's points).
    pub position_ids: Option<Vec<u32>>,
    /// One per vertex, unit length, where the file has them.
    pub normals: Option<Vec<Vec3>>,
    /// One per vertex: first texture coordinate set, v growing downward as in glTF (that of OBJ and USD is flipped).
    pub uvs: Option<Vec<Vec2>>,
    /// One per vertex: factor of memory 0..1 from a colour channel or attribute, where asked for.
    pub mask: Option<Vec<f64>>,
    /// One per vertex: factor 0..1 of how much of hems and seams there is, from a colour channel or attribute, where asked for.
    pub sewing_mask: Option<Vec<f64>>,
    /// Corners into this piece's vertices, triangulated; counter-clockwise in the scene seen from outside, also where the
    /// placement mirrors the piece.
    pub triangles: Vec<[u32; 3]>,
    /// Transform from own coordinates to the scene.
    pub placement: Placement,
    /// Joints of its skin; none without one.
    pub joints: Vec<SourceJoint>,
    /// Whether the piece is part of the garment (chosen by `--garment`, else every piece).
    pub worn: bool,
}

impl SourcePiece {
    /// Returns the position of vertex `v` in the scene \[m\], y up; `None` if there is no such vertex.
    pub fn scene_position(&self, v: usize) -> Option<Vec3> {
        let own = self.positions.get(v)?;
        let transform = match &self.placement {
            Placement::Rigid(m) => m,
            Placement::Skinned(all) => all.get(v)?,
        };
        Some((transform * own.push(1.0)).xyz())
    }

    /// Orients `triangles` as they are in the scene, given as they are in the file, or the reverse.
    pub fn orient_by_placement(placement: &Placement, triangles: &mut [[u32; 3]]) {
        triangles.iter_mut().filter(|t| placement.mirrors(t)).for_each(|t| t.swap(1, 2));
    }

    /// Returns the triangles with the corners in the order of the file.
    pub fn file_triangles(&self) -> Vec<[u32; 3]> {
        let mut triangles = self.triangles.clone();
        Self::orient_by_placement(&self.placement, &mut triangles);
        triangles
    }
}

/// Joint that moves a piece, in the pose of the file.
#[derive(Debug, Clone, PartialEq)]
pub struct SourceJoint {
    /// Name of its node; empty when it has none.
    pub name: String,
    /// Position in the scene \[m\], y up.
    pub position: Vec3,
    /// Own axes in the scene: columns of unit length.
    pub axes: Mat3,
    /// Name of the nearest ancestor joint that moves the piece.
    pub parent: Option<String>,
}

/// Lines of an OBJ file, from which a second shape with the same lines can be written.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct ObjLines {
    /// Per `v` line: position in the file's unit.
    pub positions: Vec<Vec3>,
    /// Per `vt` line: texture coordinates, v growing downward.
    pub uvs: Vec<Vec2>,
    /// Faces in file order.
    pub faces: Vec<ObjFace>,
    /// Per piece of the asset and vertex of the piece: its `v` line, counted from 0.
    pub piece_positions: Vec<Vec<u32>>,
}

/// Face of an OBJ file, of any number of corners.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct ObjFace {
    /// Piece of the asset; `None` for a face of a piece that could not be read.
    pub piece: Option<usize>,
    /// Per corner: `v` line and `vt` line, counted from 0; [`crease_geometry::mesh::INVALID`] without texture coordinates.
    pub corners: Vec<[u32; 2]>,
}

/// Mesh file as read.
#[derive(Debug, Clone)]
pub struct SourceAsset {
    /// Name of the file as the user gave it.
    pub file: String,
    /// SHA-256 of the file's bytes, or of the arrays, lower-case hex.
    pub sha256: String,
    /// Format.
    pub format: SourceFormat,
    /// Metres per file unit.
    pub unit_m: f64,
    /// Whether the unit was given, or the file states it.
    pub unit_is_known: bool,
    /// Up axis of the file.
    pub up: UpAxis,
    /// Document, for glTF.
    pub document: Option<GltfDocument>,
    /// Lines, for OBJ.
    pub obj: Option<ObjLines>,
    /// Pieces in file order. Vertices of worn pieces, in this order, are counted by `VertexIndex`.
    pub pieces: Vec<SourcePiece>,
}

impl SourceAsset {
    /// Returns the pieces that are part of the garment, in file order.
    pub fn worn_pieces(&self) -> impl Iterator<Item = &SourcePiece> {
        self.pieces.iter().filter(|piece| piece.worn)
    }

    /// Returns the joints that move the worn pieces, each name once, in file order, without unnamed ones.
    pub fn worn_joints(&self) -> Vec<SourceJoint> {
        let mut all: Vec<SourceJoint> = Vec::new();
        for joint in self.worn_pieces().flat_map(|piece| &piece.joints) {
            if !joint.name.is_empty() && all.iter().all(|known| known.name != joint.name) {
                all.push(joint.clone());
            }
        }
        all
    }

    /// Returns the triangles of the worn pieces, vertices counted over all worn pieces.
    pub fn worn_triangles(&self) -> Vec<[u32; 3]> {
        let (mut all, mut first) = (Vec::new(), 0u32);
        for piece in self.worn_pieces() {
            all.extend(piece.triangles.iter().map(|t| t.map(|v| first.saturating_add(v))));
            first = first.saturating_add(piece.positions.len() as u32);
        }
        all
    }

    /// Returns the lowest and highest corner \[m\] of the bounding box of the worn vertices that carry triangles; `None`
    /// without any.
    pub fn worn_bounds(&self) -> Option<(Vec3, Vec3)> {
        let mut bounds: Option<(Vec3, Vec3)> = None;
        for piece in self.worn_pieces() {
            for &corner in piece.triangles.iter().flatten() {
                let Some(p) = piece.scene_position(corner as usize) else { continue };
                bounds = Some(bounds.map_or((p, p), |(low, high)| (low.inf(&p), high.sup(&p))));
            }
        }
        bounds
    }
}
