//! Tuning constants of importing and refining a garment mesh.

use std::ops::RangeInclusive;

/// Limits and tolerances of the folder. Lengths in metres, angles in radians.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct GarmentTuning {
    /// Vertices closer than this fraction of the garment's diagonal are one point \[-\]: a hundred times the rounding
    /// error of single precision, a hundredth of the finest edge worth simulating.
    pub(crate) weld_distance_fraction: f64,
    /// Upper bound of the weld distance \[m\]: a stray vertex far away must not weld the garment to a lump.
    pub(crate) max_weld_distance: f64,
    /// A triangle lower than this fraction of its longest side is a cap: it has no area \[-\].
    pub(crate) cap_height_fraction: f64,
    /// Passes of cap repair; a row of adjacent caps needs several.
    pub(crate) max_cap_passes: usize,
    /// Fraction of a sheet's triangles that must coincide with earlier ones for it to be the other side of a sheet \[-\].
    pub(crate) min_copied_fraction: f64,
    /// Texture coordinates closer than this are equal when copies of triangles are looked for \[-\].
    pub(crate) copy_uv_tol: f64,
    /// Texture coordinates closer than this continue across an edge \[-\]: OBJ files round to five or six decimals.
    pub(crate) island_uv_tol: f64,
    /// A texture triangle whose area is below this fraction of its longest side squared gives no warp direction \[-\].
    pub(crate) min_uv_area_fraction: f64,
    /// Fraction of the triangles that must have a warp direction from texture coordinates \[-\].
    pub(crate) min_directed_fraction: f64,
    /// Mean number of triangles per texture island, unless every part of the garment is one island. Automatic unwrappings
    /// that cut a mesh to scraps have one or two, and turn every scrap as it fits.
    pub(crate) min_island_triangles: usize,
    /// Area-weighted mean of |unit normal . y| above which a garment lies \[-\].
    pub(crate) lying_min_slope: f64,
    /// Ratio of its extent across an axis to its other extents below which a garment is flat \[-\]: garments with depth are at
    /// least a third as deep as wide.
    pub(crate) max_flat_ratio: f64,
    /// A reference direction gives a warp direction if the sine of its angle to the normal is above this \[-\].
    pub(crate) min_warp_sine: f64,
    /// Refinement halves edges longer than this multiple of the wanted length \[-\]: halves and wholes then lie around it.
    pub(crate) max_length_factor: f64,
    /// Hinge angle of the source shape above which an edge is sharp \[rad\]: the rim of a garment that lies.
    pub(crate) min_sharp_angle: f64,
    /// Angle between the warps of two triangles above which their edge is a seam \[rad\].
    pub(crate) min_seam_angle: f64,
    /// Distance within which two layers lie in one place \[m\]: below it contact has no side to push them to.
    pub(crate) max_layer_distance: f64,
    /// Distance by which layers that lie in one place are set apart \[m\]: about the thickness of cloth.
    pub(crate) layer_gap: f64,
    /// |cosine| between normals of layers that may lie in one place \[-\].
    pub(crate) layer_min_cosine: f64,
    /// Position within a triangle where other layers are looked for, from the corner to the centroid \[-\].
    pub(crate) layer_probe_fraction: f64,
    /// Layers in one place that are told apart; more are damage.
    pub(crate) max_coincident_layers: usize,
    /// Largest diagonal of a solid that is a trim and no garment, such as a button or a buckle \[m\].
    pub(crate) max_trim_diagonal: f64,
    /// Largest distance of a trim from the cloth that carries it \[its diagonals\].
    pub(crate) max_trim_distance: f64,
    /// Cloth within this distance of the point under a trim decides how the trim is turned \[its diagonals\].
    pub(crate) trim_carrier_radius: f64,
    /// The same at least, relative to the longest edge there \[-\]: the cloth on all sides of the point counts.
    pub(crate) trim_carrier_edges: f64,
    /// Smallest diagonal of a body \[m\].
    pub(crate) min_body_size: f64,
    /// Area of the openings of a part over that of its triangles up to which it is closed, but for cut wrists and eyes \[-\].
    pub(crate) max_open_fraction: f64,
    /// Volume over area from which a closed part is a solid and no flat double sheet \[m\].
    pub(crate) min_solid_thickness: f64,
    /// Thickness of a closed sheet from which it is cloth exported as a solid \[m\]: two sides nearer than that lie in one place.
    pub(crate) min_cloth_thickness: f64,
    /// The same at most \[m\]; what is thicker is padding, or no cloth.
    pub(crate) max_cloth_thickness: f64,
    /// |cosine| between the normals of both sides of cloth with a thickness at least \[-\].
    pub(crate) min_side_cosine: f64,
    /// The same of a triangle of one side and what lies behind it, which tells it from a slanted rim, at least \[-\].
    pub(crate) min_opposite_cosine: f64,
    /// Shortest side of a triangle of a rim at most \[thicknesses\].
    pub(crate) rim_width: f64,
    /// The same over its longest side \[-\].
    pub(crate) rim_shape: f64,
    /// Distance behind a triangle within which the other side of cloth with a thickness is looked for, relative to it \[-\].
    pub(crate) thickness_reach: f64,
    /// Fraction of the area of cloth with a thickness that one side of it has at least \[-\].
    pub(crate) min_side_area_fraction: f64,
    /// |Sum of the area vectors| over area below which a part is curved and may be one side of cloth without a rim \[-\].
    pub(crate) max_side_flatness: f64,
    /// Area of the smaller side of cloth without a rim over that of the larger at least \[-\].
    pub(crate) min_side_area_ratio: f64,
    /// Deviation from the median distance of two sides up to which it is constant \[medians\].
    pub(crate) thickness_tol: f64,
    /// Fraction of the area of two sides without a rim over which their distance is constant at least \[-\].
    pub(crate) min_constant_fraction: f64,
    /// Change of angle that a hinge of an inner side takes from the cloth under it at most \[rad\].
    pub(crate) max_carried_angle: f64,
    /// Difference of two bounding boxes up to which they are in the same place \[diagonals\].
    pub(crate) same_place_tol: f64,
    /// Difference of the area vectors of two pieces up to which they face the same side \[areas\].
    pub(crate) same_side_tol: f64,
    /// Area of a piece of cloth, relative to the largest, from which it is a garment of its own \[-\].
    pub(crate) min_garment_area_fraction: f64,
    /// Names listed in a warning.
    pub(crate) max_listed_things: usize,
    /// Distance between two borders up to which they look like an open seam \[m\].
    pub(crate) max_seam_gap: f64,
    /// Cosine between the outward directions of two borders below which they face each other \[-\].
    pub(crate) max_seam_cosine: f64,
    /// Points of a refined or generated mesh; no machine bakes more.
    pub(crate) max_points: usize,
    /// Longest side of a garment's bounding box \[m\] that is possible: from a sock to a wedding train.
    pub(crate) garment_side_m: RangeInclusive<f64>,
    /// Longest side of a garment's bounding box \[m\] that is usual; others are questioned.
    pub(crate) usual_garment_side_m: RangeInclusive<f64>,
    /// Metres per unit of a mesh that can be stated: from a micrometre to a thousand kilometres.
    pub(crate) unit_m: RangeInclusive<f64>,
    /// Largest coordinate in the scene \[m\]: larger ones are damage, and their products would overflow.
    pub(crate) max_coordinate_m: f64,
    /// Errors of one mesh that are listed; the others are counted.
    pub(crate) max_listed_errors: usize,
}

/// Values in use.
pub(crate) const TUNING: GarmentTuning = GarmentTuning {
    weld_distance_fraction: 1e-5,
    max_weld_distance: 1e-4,
    cap_height_fraction: 1e-5,
    max_cap_passes: 8,
    min_copied_fraction: 0.95,
    copy_uv_tol: 1e-6,
    island_uv_tol: 1e-5,
    min_uv_area_fraction: 1e-4,
    min_directed_fraction: 0.9,
    min_island_triangles: 8,
    lying_min_slope: 0.7,
    max_flat_ratio: 0.25,
    min_warp_sine: 0.05,
    max_length_factor: 4.0 / 3.0,
    min_sharp_angle: 0.7,
    min_seam_angle: 0.2,
    max_layer_distance: 5e-5,
    layer_gap: 3e-4,
    layer_min_cosine: 0.9,
    layer_probe_fraction: 0.1,
    max_coincident_layers: 6,
    max_trim_diagonal: 0.06,
    max_trim_distance: 1.0,
    trim_carrier_radius: 0.75,
    trim_carrier_edges: 1.2,
    min_body_size: 0.3,
    max_open_fraction: 0.02,
    min_solid_thickness: 0.01,
    min_cloth_thickness: 2e-4,
    max_cloth_thickness: 5e-3,
    min_side_cosine: 0.7,
    min_opposite_cosine: 0.9,
    rim_width: 1.5,
    rim_shape: 0.5,
    thickness_reach: 1.8,
    min_side_area_fraction: 0.35,
    max_side_flatness: 0.95,
    min_side_area_ratio: 0.8,
    thickness_tol: 0.5,
    min_constant_fraction: 0.95,
    max_carried_angle: 3.0,
    same_place_tol: 0.02,
    same_side_tol: 0.2,
    min_garment_area_fraction: 0.2,
    max_listed_things: 8,
    max_seam_gap: 1e-3,
    max_seam_cosine: -0.5,
    max_points: 2_000_000,
    garment_side_m: 0.05..=5.0,
    usual_garment_side_m: 0.1..=2.5,
    unit_m: 1e-6..=1e6,
    max_coordinate_m: 1e9,
    max_listed_errors: 20,
};
