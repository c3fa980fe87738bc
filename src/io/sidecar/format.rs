//! Fields of the sidecar, format `crease-sidecar/1`.
//!
//! Units stand in the names; points are in metres, y up; hinges are numbered as in [`crease_geometry::mesh::Topology`] (x0 x1 the
//! shared edge, x2 x3 opposite; 0 rad is flat). Fields unknown to this version are kept and written again, so that data
//! of later tools survive.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use serde_json::{Map, Value};

/// Format and version that is written and read.
pub const SIDECAR_FORMAT: &str = "crease-sidecar/1";

/// Memory of a worn garment, with the mesh it belongs to and its origin.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Sidecar {
    /// Always `crease-sidecar/1`.
    pub format: String,
    /// Source file of the garment.
    pub source: SidecarSource,
    /// Welded mesh that the solver used.
    pub mesh: SidecarMesh,
    /// Memory of the hinges.
    pub hinges: SidecarHinges,
    /// Memory of the triangles.
    pub triangles: SidecarTriangles,
    /// Displacement of the points.
    pub points: SidecarPoints,
    /// Checksums of the numbers as they were written. A tool that changes a number on purpose leaves this out.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub checksums: Option<SidecarChecksums>,
    /// Fabric, as `crease schema fabric` describes it.
    #[serde(default)]
    pub fabric: Value,
    /// Wear script, as `crease schema wear` describes it.
    #[serde(default)]
    pub wear: Value,
    /// Settings of the run: tool, method, options.
    #[serde(default)]
    pub run: Value,
    /// The mesh that was simulated, with the memory that it earned, where that was asked for: a sidecar of its own, whose mesh
    /// has no vertices of the file.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub simulated: Option<Box<Self>>,
    /// Creases along which the garment was folded, the strongest first; left out where they are not known.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub creases: Option<Vec<SidecarCrease>>,
    /// Fields unknown to this version.
    #[serde(flatten)]
    pub extra: Map<String, Value>,
}

/// Crease: a curve on the surface of the mesh.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct SidecarCrease {
    /// One per place along it: the triangle of `mesh` that it lies in.
    pub triangles: Vec<u32>,
    /// One per place: barycentric weights of the corners of that triangle.
    pub weights: Vec<[f64; 3]>,
    /// One per two places that follow one another: change of the rest angle, in radians.
    pub angle_rad: Vec<f64>,
    /// One per two places that follow one another: bend stiffness over that of new cloth [-].
    pub stiffness_ratio: Vec<f64>,
    /// Width of cloth over which it bends [m].
    pub width_m: f64,
    /// Fields unknown to this version.
    #[serde(flatten)]
    pub extra: Map<String, Value>,
}

/// Source of the garment.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct SidecarSource {
    /// File name as the user gave it.
    pub file: String,
    /// SHA-256 of its bytes, lower-case hex.
    pub sha256: String,
    /// Metres per unit of that file.
    pub unit_m: f64,
    /// Axis that points up in that file.
    pub up: SidecarUp,
    /// Fields unknown to this version.
    #[serde(flatten)]
    pub extra: Map<String, Value>,
}

/// Up axis of a source file.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum SidecarUp {
    /// y up.
    Y,
    /// z up: (x, y, z) of the file is (x, z, -y) here.
    Z,
}

/// Welded mesh in its source pose.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct SidecarMesh {
    /// One per point: position in metres, y up.
    pub points_m: Vec<[f64; 3]>,
    /// One per triangle: its three points.
    pub triangles: Vec<[u32; 3]>,
    /// One per vertex of the worn pieces of the source file, in file order: its point.
    pub source_point: Vec<u32>,
    /// One per vertex like `source_point`: first texture coordinates, v downward as in glTF. Left out when a worn piece
    /// has none.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub source_uv: Option<Vec<[f64; 2]>>,
    /// One per triangle: the source vertices at its corners, which give its texture coordinates at seams. Left out where the
    /// mesh is finer than its file, and by versions before 0.1.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub triangle_vertices: Option<Vec<[u32; 3]>>,
    /// Points on the lines that were drawn for folds, and on the rows beside them, where creases are sharp. Left out for meshes that were not
    /// made for folds.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub fold_line_points: Option<Vec<u32>>,
    /// Joints of the skeleton that moves the worn pieces, in the pose of the file: garments bound to joints of the same
    /// names can be aligned by them. Left out without any.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub joints: Option<Vec<SidecarJoint>>,
    /// Fields unknown to this version.
    #[serde(flatten)]
    pub extra: Map<String, Value>,
}

/// Joint of a skeleton.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct SidecarJoint {
    /// Name of its node.
    pub name: String,
    /// Position in metres, y up.
    pub position_m: [f64; 3],
    /// Unit vectors along its own x, y and z, y up.
    pub axes: [[f64; 3]; 3],
    /// Name of the nearest joint above it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub parent: Option<String>,
    /// Fields unknown to this version.
    #[serde(flatten)]
    pub extra: Map<String, Value>,
}

/// Memory of the hinges; all lists have one entry per hinge.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct SidecarHinges {
    /// Points x0 x1 of the shared edge, x2 and x3 opposite.
    pub points: Vec<[u32; 4]>,
    /// Angle in the source shape, in radians; 0 is flat.
    pub source_angle_rad: Vec<f64>,
    /// Rest angle after wear, in radians.
    pub rest_angle_rad: Vec<f64>,
    /// Bend stiffness over that of new cloth [-], 1 when new.
    pub stiffness_ratio: Vec<f64>,
    /// Fields unknown to this version.
    #[serde(flatten)]
    pub extra: Map<String, Value>,
}

/// Memory of the triangles; all lists have one entry per triangle.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct SidecarTriangles {
    /// Rest length over that of new cloth along warp (+u) [-], 1 when new.
    pub rest_stretch_warp: Vec<f64>,
    /// Rest length over that of new cloth along weft (+v) [-], 1 when new.
    pub rest_stretch_weft: Vec<f64>,
    /// Angle from the warp to the side between the first two corners, in radians, counter-clockwise seen from the
    /// side where the corners run counter-clockwise.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub warp_angle_rad: Option<Vec<f64>>,
    /// After a transfer: confidence that the memory belongs there, 0 to 1.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub confidence: Option<Vec<f64>>,
    /// Fields unknown to this version.
    #[serde(flatten)]
    pub extra: Map<String, Value>,
}

/// Displacement of the points; one entry per point.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct SidecarPoints {
    /// Displacement from `points_m` in metres, y up, as in the morph target `worn`.
    pub displacement_m: Vec<[f64; 3]>,
    /// Fields unknown to this version.
    #[serde(flatten)]
    pub extra: Map<String, Value>,
}

/// SHA-256 over numbers, lower-case hex. Each list enters as its length (64 bits), then its numbers row by row: indices in
/// 32 bits, all others as 64-bit floats, little-endian. White space and the order of fields do not matter.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
pub struct SidecarChecksums {
    /// Checksum of `mesh.points_m`, `mesh.triangles`.
    pub mesh_sha256: String,
    /// Checksum of `hinges.points`, `.source_angle_rad`, `.rest_angle_rad`, `.stiffness_ratio`, `triangles.rest_stretch_warp`,
    /// `.rest_stretch_weft`, `points.displacement_m`.
    pub memory_sha256: String,
    /// Fields unknown to this version.
    #[serde(flatten)]
    pub extra: Map<String, Value>,
}
