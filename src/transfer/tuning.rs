//! Tuning constants of the transfer, all in one place.

/// Limits and tolerances of the transfer. Lengths named "fraction" are relative to the diagonal of the target's bounding
/// box unless the field says otherwise.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct TransferTuning {
    /// Smallest box side that takes part in a scale [m], default 1e-6: avoids division by zero.
    pub min_box_side: f64,
    /// Largest distance of a match in front view [fraction], default 0.03: outlines of two cuts differ by that much.
    pub max_front_distance_fraction: f64,
    /// Largest distance of a closest-point match [fraction], default 0.12: looser garments of one body still match.
    pub max_closest_distance_fraction: f64,
    /// Largest distance of a match in texture space [mean source triangle sizes], default 0.75: outlines of panels are
    /// tessellated differently.
    pub max_uv_distance_triangles: f64,
    /// Cosine between normals below which two surface points never match [-], default 0.2.
    pub min_normal_cosine: f64,
    /// Cosine between normals from which a match has full quality [-], default 0.7.
    pub full_normal_cosine: f64,
    /// Cosine between a normal and the view direction below which a triangle counts as edge-on [-], default 0.3: the
    /// lift onto its plane would stretch without bound, and a source triangle would shrink to one without area.
    pub edge_on_cosine: f64,
    /// Distance up to which a target triangle lies close to a source in place [fraction], default 0.02.
    pub close_distance_fraction: f64,
    /// Fraction of the target's triangles that must lie close for an alignment in place [-], default 0.6.
    pub min_close_fraction: f64,
    /// Distance between the matches by texture and by position up to which both agree [fraction], default 0.05.
    pub uv_agreement_distance_fraction: f64,
    /// Fraction of the target's triangles that must agree for a match by texture [-], default 0.9.
    pub min_uv_agreement_fraction: f64,
    /// Distance in texture space beyond the nearest island within which another one lies on it [largest match distances],
    /// default 0.1.
    pub uv_overlap_fraction: f64,
    /// Islands on one another that are told apart, default 8; more are damage.
    pub max_places_of_uv: usize,
    /// Fraction of the target's triangles with a single place in the texture that a map by texture needs [-], default 0.5.
    pub min_unambiguous_fraction: f64,
    /// Distance of a corner in the texture from where the triangle of the file under the centroid has it, relative to its distance from the
    /// centroid [-], default 0.5.
    pub max_texture_deviation: f64,
    /// Texture coordinates closer than this continue across an edge [-], default 1e-5.
    pub uv_continuity_tol: f64,
    /// Confidence below which a transfer warns [-], default 0.5.
    pub min_confidence: f64,
    /// Fraction of the crease lost above which a transfer warns [-], default 0.2.
    pub max_lost_crease_fraction: f64,
    /// Fraction of the target matched in several places of the source above which a transfer warns [-], default 0.05.
    pub max_ambiguous_fraction: f64,
    /// Change of rest angle [rad] and rest stretch [-] below which nothing was transferred, default 1e-3.
    pub min_change: f64,
    /// Logarithm of the ratio between the scale of a side of the boxes and that of the bodies above which the box misleads [-],
    /// default 0.25: garments of one kind differ by less in fit.
    pub max_box_scale_deviation: f64,
    /// Length of a border from which it is an opening, relative to the box diagonal [-], default 0.08: buttonholes are shorter.
    pub min_opening_fraction: f64,
    /// Openings that a garment may have, default 16: more are those of lace or of pieces that are not sewn.
    pub max_openings: usize,
    /// Distance between the lines around a limb that are measured, relative to the box diagonal [-], default 0.02.
    pub limb_step_fraction: f64,
    /// Growth of the length of these lines per distance that ends a limb [-], default 2: sleeves widen by less than 1, and the lines
    /// that run on over the torso from an armpit or a crotch grow by 2.5 and more.
    pub max_limb_growth: f64,
    /// Distance from the root of a limb within which cloth may belong to it or not, relative to the box diagonal [-], default 0.03.
    pub limb_margin_fraction: f64,
    /// Distance of an opening from the middle from which it is that of an arm or a leg, relative to the width [-], default 0.2.
    pub min_lateral_fraction: f64,
    /// Logarithm of the ratio of two bodies below which both are of grown people, whose limbs are as long [-], default 0.3.
    pub max_person_deviation: f64,
    /// Rings between root and opening at which two limbs are laid on one another, default 4.
    pub limb_rings: u32,
    /// Half width of a ring below which it has no extent in that direction, relative to its length [-], default 0.02.
    pub min_ring_fraction: f64,
    /// Cosine between the directions of two limbs from which their boxes say as much [-], default 0.85.
    pub min_limb_cosine: f64,
    /// Length of a tube relative to its longer opening from which it is a sleeve or a leg [-], default 0.75.
    pub min_tube_ratio: f64,
    /// Difference of two ratios of widths (logarithms) below which left and right are as good [-], default 0.05.
    pub max_side_difference: f64,
    /// Logarithm of the ratio of a tube's openings above which the wider one is at the torso [-], default 0.08.
    pub min_end_difference: f64,
    /// Ratio of the second to the first extent of a point set below which it counts as collinear [-], default 0.05: it
    /// then determines no rotation.
    pub max_collinear_ratio: f64,
    /// Distance of the points beside a joint that carry its rotation, relative to the source's box diagonal [-],
    /// default 0.05.
    pub joint_offset_fraction: f64,
    /// Smallest number of joints of equal names that make two skeletons the same, default 3: any two rigs may have equal
    /// roots.
    pub min_shared_joints: usize,
    /// Length of a bone between two joints from which these two suffice, relative to the source's box diagonal [-], default 0.1.
    pub min_bone_fraction: f64,
    /// Logarithm of the ratio of sides of the boxes above which garments of one kind are two sizes [-], default 0.03.
    pub max_size_deviation: f64,
    /// Scale from a piece of cloth to another one inside it up to which that is cut out of it [-], default 0.5: sizes of one garment
    /// differ by less.
    pub max_cut_out_scale: f64,
    /// Distance between the roots of limbs of one role on one body [fraction], default 0.04.
    pub max_root_distance_fraction: f64,
    /// Strength above which a transfer warns [-], default 4: a memory is rarely too weak by more.
    pub max_usual_strength: f64,
    /// Positions along a bone that also carry its rotation, relative to its length [-], default thirds.
    pub bone_fractions: [f64; 2],
    /// Largest coordinate of a landmark [m], default 1e6: squares of larger numbers leave the range in which rotations
    /// are found.
    pub max_coordinate_m: f64,
    /// Largest number of point pairs from joints, default 1500: enough for any skeleton; the work grows with their cube.
    pub max_joint_points: usize,
    /// Smallest distance between two such points, relative to `joint_offset_fraction` [-], default 0.2.
    pub min_joint_point_spacing: f64,
    /// Mean change of rest angle, with that of the rows beside it, from which a crease is a crease line [rad], default 0.5.
    pub min_crease_line_angle: f64,
    /// Length of a crease line [fraction], default 0.05: a fold goes across a garment, wrinkles do not.
    pub min_crease_line_fraction: f64,
    /// Distance of a point of a crease from straight, where the source lies, from which it has a kink there [m], default 8e-3: the distance of a row.
    pub max_straight_deviation: f64,
    /// Length of a straight part of a crease, at least [m], default 0.06.
    pub min_straight_crease: f64,
    /// Part of a crease that is straight between kinks, at least, else it is a curve [-], default 0.8.
    pub min_straight_fraction: f64,
    /// Distance of the ends of a crease from the line of a fold up to which it belongs to that [m], default 0.016: layers slide where they lie.
    pub max_fold_deviation: f64,
    /// Distance of the matches of a fold from where the source has it as it lies, up to which it goes there [m], default 0.06: more cloth lies so differently
    /// that fractions of its box say nothing.
    pub max_fold_shift: f64,
    /// Distance between a matched crease and a straight one from which it says less about where that lies [m], default 4e-3.
    pub straight_scale: f64,
    /// Root mean square of that distance above which a crease is not drawn straight [m], default 0.03.
    pub max_straight_rms: f64,
    /// Stretches of a straight line over which the place on the source's is averaged [m], default 0.04.
    pub straight_knot_spacing: f64,
    /// Rounds in which a straight line is fitted, default 5.
    pub straight_rounds: usize,
    /// Smallest distance of the row of edges beside a crease line [m], default 4e-3.
    pub min_crease_row: f64,
    /// Largest distance of that row [m], default 0.025.
    pub max_crease_row: f64,
    /// Distance along the source within which a crease line is looked for, relative to its row and the edges of the target [-],
    /// default 2.5: both corners of every edge across the line or its rows have a distance.
    pub crease_line_reach: f64,
    /// Length by which a line goes on past its ends, relative to its row [-], default 1.5: up to the border of the cloth.
    pub crease_line_overhang: f64,
    /// Distance from a point of another curve at which a line goes through it, relative to its row [-], default 0.15.
    pub crease_line_snap: f64,
    /// Distance from a line within which a point lies on it, relative to its row [-], default 0.12: mesh points between two of the file
    /// are only about as far from it as both.
    pub crease_line_tol: f64,
    /// Length of edges along a line, relative to its own, from which it is drawn there [-], default 0.5.
    pub min_crease_line_coverage: f64,
    /// Distance from another line within which a row is left out, relative to itself [-], default 0.6.
    pub crease_row_clearance: f64,
}

/// The constants in use.
pub(super) const TUNING: TransferTuning = TransferTuning {
    min_box_side: 1e-6,
    max_front_distance_fraction: 0.03,
    max_closest_distance_fraction: 0.12,
    max_uv_distance_triangles: 0.75,
    min_normal_cosine: 0.2,
    full_normal_cosine: 0.7,
    edge_on_cosine: 0.3,
    close_distance_fraction: 0.02,
    min_close_fraction: 0.6,
    uv_agreement_distance_fraction: 0.05,
    min_uv_agreement_fraction: 0.9,
    uv_overlap_fraction: 0.1,
    max_places_of_uv: 8,
    min_unambiguous_fraction: 0.5,
    max_texture_deviation: 0.5,
    uv_continuity_tol: 1e-5,
    min_confidence: 0.5,
    max_lost_crease_fraction: 0.2,
    max_ambiguous_fraction: 0.05,
    min_change: 1e-3,
    max_box_scale_deviation: 0.25,
    min_opening_fraction: 0.08,
    max_openings: 16,
    limb_step_fraction: 0.02,
    max_limb_growth: 2.0,
    limb_margin_fraction: 0.03,
    min_lateral_fraction: 0.2,
    max_person_deviation: 0.3,
    limb_rings: 4,
    min_ring_fraction: 0.02,
    min_limb_cosine: 0.85,
    min_tube_ratio: 0.75,
    max_side_difference: 0.05,
    min_end_difference: 0.08,
    max_collinear_ratio: 0.05,
    joint_offset_fraction: 0.05,
    min_shared_joints: 3,
    min_bone_fraction: 0.1,
    max_size_deviation: 0.03,
    max_cut_out_scale: 0.5,
    max_root_distance_fraction: 0.04,
    max_usual_strength: 4.0,
    bone_fractions: [1.0 / 3.0, 2.0 / 3.0],
    max_coordinate_m: 1e6,
    max_joint_points: 1500,
    min_joint_point_spacing: 0.2,
    min_crease_line_angle: 0.5,
    min_crease_line_fraction: 0.05,
    max_straight_deviation: 8e-3,
    min_straight_crease: 0.06,
    min_straight_fraction: 0.8,
    max_fold_deviation: 0.016,
    max_fold_shift: 0.06,
    straight_scale: 4e-3,
    max_straight_rms: 0.03,
    straight_knot_spacing: 0.04,
    straight_rounds: 5,
    min_crease_row: 4e-3,
    max_crease_row: 0.025,
    crease_line_reach: 2.5,
    crease_line_overhang: 1.5,
    crease_line_snap: 0.15,
    crease_line_tol: 0.12,
    min_crease_line_coverage: 0.5,
    crease_row_clearance: 0.6,
};
