//! Tuning constants of the simulation mesh, all in one place.

/// Constants of local operations and of the rounds that use them.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct RemeshTuning {
    /// Smallest cosine between a triangle's normal before and after an operation [-], default 0.94.
    pub min_normal_cosine: f64,
    /// Smallest cosine between a triangle's normal and the one it was made with [-], default 0.87.
    pub min_drift_cosine: f64,
    /// Smallest cosine of the bend of a curve at a point that a collapse removes [-], default 0.94.
    pub min_curve_cosine: f64,
    /// Largest distance of a removed point of a curve from the edge that replaces it [m], default 1e-3.
    pub max_curve_deviation: f64,
    /// Length of an edge between two curves below which its ends become one point [m], default 1.5e-3.
    pub weld_length: f64,
    /// Largest distance of a point from the chord of its neighbours on a straight line, relative to it [-], default 1e-4.
    pub max_line_bend: f64,
    /// Level below which a point lies on a line [m], default 1e-9.
    pub on_line: f64,
    /// Shape below which the normal of a triangle says nothing [-], default 1e-3.
    pub degenerate_shape: f64,
    /// Parts along a side into which a triangle of the garment is cut to project a displacement onto it, default 4.
    pub projection_parts: u32,
    /// Weight of kinks in the projection [-], default 0.07: creases that run across triangles of 18 mm are straight, and 0.72 of what is
    /// remembered is seen (0.03: 0.79, but the ridge is a row of teeth; 0.1: 0.69; 0.3: 0.55).
    pub kink_weight: f64,
    /// Change of rest angle, with that of the edges beside it, from which a hinge can be part of a crease of the worn surface [rad], default 0.2.
    pub min_crease_angle: f64,
    /// Smallest part of that angle at one of the edges [-], default 0.36: where three edges bend alike, each has a third.
    pub min_crease_concentration: f64,
    /// Cosine of the bend of a crease from one edge to the next [-], default 0.87: 30 degrees.
    pub min_crease_cosine: f64,
    /// Length of the part of a crease with a small angle between others that belong to it, at most [m], default 0.05.
    pub max_crease_gap: f64,
    /// Cosine of the bend of a crease from one edge to the next along such a part [-], default 0.95: 18 degrees.
    pub min_traced_cosine: f64,
    /// Length of a crease of the worn surface, at least [m], default 0.04: some edges.
    pub min_crease_length: f64,
    /// Cosine of the angle between the edges of a crease and of the row beside it [-], default 0.95: 18 degrees.
    pub min_row_cosine: f64,
    /// Distance of a row from its crease, at most [m], default 0.012: 1.5 times that at which rows are drawn.
    pub max_row_distance: f64,
    /// Distance over which the turn of a panel is averaged where it is carried to a crease [m], default 6e-3.
    pub strip_reach: f64,
    /// Distance from a triangle up to which a place above it belongs to it without a search, per root of its area [-], default 0.1.
    pub max_rise: f64,
    /// Smallest cosine between a triangle of the garment and that of the mesh in which it is found [-], default 0.2.
    pub min_start_cosine: f64,
    /// Largest distance between them [m], default 0.02: the height of a chord of the longest edges over a sleeve.
    pub max_start_distance: f64,
    /// Residual of the projection [m], default 1e-6.
    pub projection_tol: f64,
    /// Largest number of iterations of the projection, default 60: a fifth of that is usual.
    pub max_projection_iterations: usize,
    /// Largest number of triangles crossed in search of a closest point, default 400.
    pub max_walk: usize,
    /// An edge is split above this multiple of the requested length [-], default 1.5.
    pub split_ratio: f64,
    /// An edge is collapsed below this multiple of the requested length [-], default 0.7: halves of a split edge stay.
    pub collapse_ratio: f64,
    /// Shape of a triangle (1 for equal sides) that a collapse must leave, unless it was worse before [-], default 0.45.
    pub min_shape: f64,
    /// Shape below which a triangle is repaired whatever its edge lengths [-], default 0.4.
    pub bad_shape: f64,
    /// Shape that a move along a line must leave, unless it was worse before [-], default 0.3.
    pub min_line_shape: f64,
    /// Largest number of rounds of splits and collapses, default 16.
    pub max_rounds: usize,
    /// Rounds in which edges are split, default 10: later ones only collapse, so that both do not alternate for ever.
    pub splitting_rounds: usize,
    /// Rounds before points move, default 3: before, collapses leave few of them.
    pub rounds_before_moves: usize,
    /// Rounds of flips and moves at the end, default 10.
    pub smoothing_rounds: usize,
    /// Fraction of the way to the centroid that a point moves per round [-], default 0.7.
    pub relaxation: f64,
    /// Distance from the middle of a crease up to which it is known, at least [m], default 8e-3.
    pub fine_reach: f64,
    /// Length of an edge of the finer mesh above which it is halved, relative to the wanted one [-], default 1.5.
    pub fine_split_ratio: f64,
    /// Largest distance of the worn surface from an edge of the finer mesh that is not halved [m], default 2.5e-4.
    pub max_fine_deviation: f64,
    /// Largest difference of the turn of the worn surface from that between the ends of such an edge [-], default 0.07: 3 degrees.
    pub max_fine_turn: f64,
    /// Distance of a line of a crease from the end of an edge below which it goes through the end, relative to half of the width of the
    /// crease [-], default 0.2.
    pub fine_snap: f64,
    /// Pieces of the middle of a crease that are tried for one edge, default 4.
    pub max_fine_tries: usize,
    /// Halvings of the interval in which a border crosses an edge, default 20.
    pub fine_bisections: usize,
    /// Rounds in which triangles that intersect are moved back, default 16.
    pub max_fine_rounds: usize,
    /// Part of the way to the worn surface below which a point that moves back is moved to the end [-], default 0.2.
    pub min_fine_part: f64,
    /// Points of a finer mesh, at most, default 2,000,000.
    pub max_fine_points: usize,
    /// Spacing of the seeds of a size field relative to the length there [-], default 0.3.
    pub seed_spacing: f64,
}

/// The constants in use.
pub(super) const TUNING: RemeshTuning = RemeshTuning {
    min_normal_cosine: 0.94,
    min_drift_cosine: 0.87,
    min_curve_cosine: 0.94,
    max_curve_deviation: 1e-3,
    weld_length: 1.5e-3,
    max_line_bend: 1e-4,
    on_line: 1e-9,
    degenerate_shape: 1e-3,
    projection_parts: 4,
    kink_weight: 0.07,
    min_crease_angle: 0.2,
    min_crease_concentration: 0.36,
    min_crease_cosine: 0.87,
    max_crease_gap: 0.05,
    min_traced_cosine: 0.95,
    min_crease_length: 0.04,
    min_row_cosine: 0.95,
    max_row_distance: 0.012,
    strip_reach: 6e-3,
    max_rise: 0.1,
    min_start_cosine: 0.2,
    max_start_distance: 0.02,
    projection_tol: 1e-6,
    max_projection_iterations: 60,
    max_walk: 400,
    split_ratio: 1.5,
    collapse_ratio: 0.7,
    min_shape: 0.45,
    bad_shape: 0.4,
    min_line_shape: 0.3,
    max_rounds: 16,
    splitting_rounds: 10,
    rounds_before_moves: 3,
    smoothing_rounds: 10,
    relaxation: 0.7,
    fine_reach: 8e-3,
    fine_split_ratio: 1.5,
    max_fine_deviation: 2.5e-4,
    max_fine_turn: 0.07,
    fine_snap: 0.2,
    max_fine_tries: 4,
    fine_bisections: 20,
    max_fine_rounds: 16,
    min_fine_part: 0.2,
    max_fine_points: 2_000_000,
    seed_spacing: 0.3,
};
