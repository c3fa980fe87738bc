//! Names that crease writes into glTF documents, and extensions that it handles.

/// Name of the morph target that holds the worn shape.
pub const WORN_TARGET: &str = "worn";
/// Name of the morph target that leads back to the source shape, where the worn shape is the base.
pub const UNWORN_TARGET: &str = "unworn";
/// Vertex attribute: change of rest angle (rest minus source angle) of largest magnitude among the hinges whose edge
/// ends at the vertex, in degrees, signed; 0 without memory.
pub const REST_ANGLE_CHANGE_ATTRIBUTE: &str = "_CREASE_REST_ANGLE_CHANGE";
/// Name of [`REST_ANGLE_CHANGE_ATTRIBUTE`] in files written by earlier versions; read, never written.
pub const FORMER_REST_ANGLE_ATTRIBUTE: &str = "_CREASE_REST_ANGLE";
/// Vertex attribute: mean stiffness ratio of the hinges whose edge ends at the vertex [-]; 1 where there is none.
pub const STIFFNESS_ATTRIBUTE: &str = "_CREASE_STIFFNESS";
/// Vertex attribute of a rest-angle map: rest angle in degrees.
pub const REST_ANGLE_DEG_ATTRIBUTE: &str = "_REST_ANGLE_DEG";
/// Key in a mesh's extras under which the sidecar is named; it marks meshes worn by crease.
pub(super) const EXTRAS_KEY: &str = "crease";
/// Key beside the sidecar's that marks a mesh whose base shape is the worn one.
pub(super) const APPLIED_KEY: &str = "applied";
/// Extension that holds a compressed second copy of a primitive.
pub(super) const DRACO_EXTENSION: &str = "KHR_draco_mesh_compression";
/// Help beside "export it without": a program that decodes.
pub(super) const DRACO_CURE: &str = ", or decode it: npx @gltf-transform/cli copy IN.glb OUT.glb";
/// Extension that draws a mesh many times.
pub(super) const INSTANCING_EXTENSION: &str = "EXT_mesh_gpu_instancing";

/// Name of the picture and the texture that hold the normal map of what was worn.
pub const WRINKLES_NAME: &str = "wrinkles";
