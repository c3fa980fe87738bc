//! Tuning constants of reading and writing files.

use std::ops::RangeInclusive;

/// Limits and tolerances of the folder.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct IoTuning {
    /// Longest side of a body over that of its garment \[-\] that is possible: a torso under a wide skirt, a person with a
    /// glove.
    pub(crate) body_ratio: RangeInclusive<f64>,
    /// The same for a shirt on a person.
    pub(crate) usual_body_ratio: f64,
    /// Fraction of a garment on its body up to which another unit may be meant \[-\].
    pub(crate) max_misfit_fraction: f64,
    /// Units that differ by less than this factor are one \[-\]; the least between two of them is 2.54.
    pub(crate) min_unit_ratio: f64,
    /// Fraction of a garment that lies on its body in the unit that is meant \[-\]: half of it hangs free, as a skirt does.
    pub(crate) min_fitting_fraction: f64,
    /// Sizes that differ from a unit by less than this factor are taken for it \[-\].
    pub(crate) unit_ratio_tol: f64,
    /// Mean edge length of frames over that of their garment that is one of motion, not of unit \[-\].
    pub(crate) frame_ratio: RangeInclusive<f64>,
    /// Largest coordinate of an OBJ file \[file units\].
    pub(crate) max_obj_coordinate: f64,
    /// Corners of a face; no drawn face has more, and the limit of the polygon clipper is higher.
    pub(crate) max_face_corners: usize,
    /// Unknown keywords of an OBJ file reported one by one; a binary file taken for text has a new one on every line.
    pub(crate) max_skipped_keywords: usize,
    /// Area of a triangle relative to its quad's below which a diagonal counts as outside the quad \[-\].
    pub(crate) min_quad_area_fraction: f64,
    /// Relative difference of length below which both diagonals of a quad are equal \[-\]: rounding must not decide how
    /// the quads of a regular grid are cut.
    pub(crate) equal_diagonal_tol: f64,
    /// Errors of one file reported in full; the rest are counted. A file with a wrong header easily has one per line.
    pub(crate) max_listed_errors: usize,
    /// Frames named in one message.
    pub(crate) max_listed_frames: usize,
    /// Names of parts listed in a message.
    pub(crate) max_listed_names: usize,
    /// Vertices and triangles allowed for a glTF file of any size; larger files may have as many as their buffers have
    /// bytes. Primitives may refer to the same accessors, and a short file could otherwise ask for the same million
    /// vertices a million times.
    pub(crate) min_element_budget: usize,
    /// Numbers of keys and morph targets allowed for a glTF file of any size; see `min_element_budget`.
    pub(crate) min_number_budget: usize,
    /// Ancestors of a node whose names call its mesh; a chain of many thousand nodes, each with a mesh, would name each by all.
    pub(crate) max_named_ancestors: usize,
    /// Nodes besides the first that may show one mesh, each with a copy; of one that more nodes show, the first is read.
    pub(crate) max_mesh_copies: usize,
    /// Vertices that copies of meshes may have together, where several nodes show one mesh.
    pub(crate) max_copied_vertices: usize,
    /// Rows allowed for an accessor without data, whatever the size of the buffers.
    pub(crate) max_empty_rows: usize,
    /// Skin weights whose sum differs from one by more than this are reported \[-\]; quantised ones differ by less.
    pub(crate) weight_sum_tol: f64,
    /// A joint moves a piece if one of its vertices has a weight above this for it \[-\].
    pub(crate) min_joint_weight: f64,
    /// A transform whose volume is below this fraction of its size cubed flattens space \[-\].
    pub(crate) min_volume_fraction: f64,
    /// Landmarks nearer to each other than this are one \[m\].
    pub(crate) landmark_tol_m: f64,
    /// Vertices of a sidecar and of its mesh closer than this fraction of the garment's diagonal are equal \[-\]: a hundred
    /// times the rounding error of single precision, and the distance that welding may move one.
    pub(crate) vertex_position_tol: f64,
    /// Distance by which an import may move points of layers that lie in one place \[m\].
    pub(crate) layer_position_tol_m: f64,
    /// Passes over all vertices of fitting a rest-angle map; each can only lower the error, and few vertices change after
    /// the first.
    pub(crate) max_rest_angle_passes: usize,
    /// Texels that a detail map is padded beyond its borders: enough to keep eight mip levels apart.
    pub(crate) padding_texels: usize,
    /// Two directions of one texel that differ by more than this conflict \[rad\].
    pub(crate) max_texel_deviation: f64,
    /// Distance from the middle of a crease up to which its mask may reach \[m\]: the widths of thick cloth, twice.
    pub(crate) crease_mask_reach: f64,
    /// Fraction of a detail map's texels that may conflict before the map is not used \[-\].
    pub(crate) max_conflicting_fraction: f64,
    /// Texture coordinates may leave a square of one picture's size by this much \[pictures\].
    pub(crate) uv_border_tol: f64,
    /// Extent of texture coordinates below which a detail map is not drawn in their corner of the picture \[pictures\].
    pub(crate) min_uv_extent: f64,
    /// Decoded size of a normal map \[bytes\]; larger ones are not read.
    pub(crate) max_picture_bytes: usize,
    /// Length of a compressed sidecar's content over that of its file \[-\]; those of garments are 3 times as long, that of a flat
    /// sheet without memory 20 times.
    pub(crate) max_gzip_ratio: usize,
    /// Length of the content allowed for a compressed sidecar of any size \[bytes\].
    pub(crate) min_gzip_budget: usize,
}

/// Values in use.
pub(crate) const TUNING: IoTuning = IoTuning {
    body_ratio: 0.66..=15.0,
    usual_body_ratio: 2.5,
    max_misfit_fraction: 0.05,
    min_unit_ratio: 1.5,
    min_fitting_fraction: 0.4,
    unit_ratio_tol: 1.6,
    frame_ratio: 0.66..=1.5,
    max_obj_coordinate: 1e12,
    max_face_corners: 1_000_000,
    max_skipped_keywords: 20,
    min_quad_area_fraction: 1e-6,
    equal_diagonal_tol: 1e-6,
    max_listed_errors: 20,
    max_listed_frames: 5,
    max_listed_names: 40,
    min_element_budget: 4_000_000,
    min_number_budget: 4_000_000,
    max_named_ancestors: 256,
    max_mesh_copies: 64,
    max_copied_vertices: 1_000_000,
    max_empty_rows: 65_536,
    weight_sum_tol: 0.01,
    min_joint_weight: 0.01,
    min_volume_fraction: 1e-9,
    landmark_tol_m: 1e-5,
    vertex_position_tol: 2e-5,
    layer_position_tol_m: 1e-3,
    max_rest_angle_passes: 30,
    padding_texels: 16,
    max_texel_deviation: 0.17,
    crease_mask_reach: 0.01,
    max_conflicting_fraction: 0.05,
    uv_border_tol: 1e-3,
    min_uv_extent: 0.05,
    max_picture_bytes: 1 << 30,
    max_gzip_ratio: 100,
    min_gzip_budget: 1 << 20,
};
