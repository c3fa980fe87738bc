//! Tuning constants of contact: each with its quantity, unit and reason. None of them is a property of a fabric.

/// All tuning constants of this folder.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct ContactTuning {
    /// Search for pairs and activation distances.
    pub search: SearchTuning,
    /// Limits on displacements.
    pub step: StepTuning,
    /// Coulomb friction.
    pub friction: FrictionTuning,
    /// One-sided contact with a body.
    pub body: BodyContactTuning,
}

/// Search for pairs and activation distances of single pairs.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct SearchTuning {
    /// Search distance over d-hat [-]. More than 1, so that the pattern of the linear system covers pairs that are about to become active.
    pub candidate_margin: f64,
    /// Activation distance over rest distance for pairs that are near in the rest shape [-]. Less than 1, so that nothing pushes at
    /// rest.
    pub max_dhat_over_rest_distance: f64,
    /// Rest distance over d-hat below which joined primitives touch [-].
    pub touching_fraction: f64,
    /// Time in which a reduced activation distance grows to d-hat [s].
    pub dhat_growth_time: f64,
    /// Largest activation distance over distance while it grows [-]: the barrier pushes gently there.
    pub max_growing_dhat_over_distance: f64,
    /// Distance of a far query over that of other queries [-].
    pub far_query_factor: f64,
    /// Steps between two far queries after one that found a pair.
    pub far_query_period: u32,
    /// Skin of the Verlet list over the search distance [-].
    pub verlet_skin: f64,
    /// Fraction of triangles outside the skin above which the Verlet list is not used [-].
    pub max_outside_skin_fraction: f64,
    /// Searches at rest that are made without a Verlet list after one that served no other search.
    pub verlet_rebuild_pause: u32,
    /// Height above the centre of a triangle at which its upward ray starts [m], so that the ray misses the triangle.
    pub upward_ray_offset: f64,
    /// Height up to which cloth counts as covering [m].
    pub max_cover_height: f64,
}

/// Limits on displacements.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct StepTuning {
    /// Smallest distance over d-hat of a pair that becomes active in this displacement [-].
    pub new_contact_gap_fraction: f64,
    /// Smallest distance after a displacement over the one before for an active pair [-]. The barrier must act before layers come
    /// really near.
    pub kept_gap_fraction: f64,
    /// Displacement over search distance above which one step size for all points is tried first [-].
    pub long_step_distances: f64,
    /// Smallest common step size that is accepted for a long displacement [-]. Single points cut short limit all around them, most of
    /// all where layers move along with one another.
    pub min_uniform_step: f64,
    /// Smallest distance over d-hat to which cloth that is carried presses layers [-].
    pub carry_min_gap: f64,
    /// Largest distance kept over present distance where layers are nearer already [-]. Less than 1, so that they can part.
    pub max_carry_gap_kept: f64,
    /// Largest difference of the step sizes of two neighbouring points that are carried [-].
    pub neighbour_step_limit: f64,
    /// Rounds of limiting and testing again before a connected part falls back to one step size. Piles of layers need about as many
    /// rounds as they have layers.
    pub max_rounds: usize,
    /// Fraction of the predicted decrease below which zones are tried in place of step sizes of single points [-].
    pub min_decrease_fraction: f64,
    /// Rounds in which impact zones may grow, before single points are limited instead.
    pub max_zone_rounds: usize,
}

/// Coulomb friction.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct FrictionTuning {
    /// Speed below which a contact counts as sticking (eps_v of IPC) [m/s].
    pub slip_velocity_tol: f64,
    /// Largest stretch at which a contact begins to slide [m]. The tolerance grows with the step, so that what sticks stays at rest for
    /// Newton; in a step of seconds it would be millimetres, and wrinkles that friction holds would slide flat.
    pub max_slip_tolerance: f64,
    /// Stretch over slip tolerance above which a contact counts as sliding [-].
    pub sliding_ratio: f64,
}

/// One-sided contact with a body.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct BodyContactTuning {
    /// Distance up to which the surface nearest to a point of the cloth is searched [m].
    pub search_distance: f64,
    /// Depth up to which a body folds into itself [m].
    pub max_self_fold_depth: f64,
    /// Largest cosine between the normals of two parts that face each other [-].
    pub max_facing_cosine: f64,
    /// Distance from a self fold within which cloth is caught in it, too [m].
    pub self_fold_margin: f64,
    /// Distance between two parts of a body that touch, over d-hat [-]: two layers on each and one to move.
    pub self_fold_gap: f64,
    /// Growth of the offset of a point that intersects the body, per step, over d-hat [-].
    pub offset_step: f64,
    /// Largest offset of a point of the cloth over d-hat [-].
    pub max_offset: f64,
    /// Decrease of an offset per step in which the body moves, over the offset [-].
    pub offset_decay: f64,
    /// Height up to which cloth over a point of the body is searched [m].
    pub max_height_over_vertex: f64,
    /// Distance up to which an edge of the cloth across an edge of the body is searched [m].
    pub max_edge_distance: f64,
    /// Depth up to which cloth inside the body is pushed out [m]. Deeper cloth is caught between two parts of the body.
    pub max_penetration: f64,
    /// Smallest cosine between the line of two edges and the normal [-]: edges side by side do not touch.
    pub min_edge_cosine: f64,
    /// Barycentric coordinate of an edge below which a position belongs to its end [-].
    pub edge_end_fraction: f64,
    /// Gap over d-hat below which a point or edge of the body pushes from farther in the next step [-].
    pub min_edge_gap: f64,
    /// Stiffness of points and edges of the body over that of points of the cloth [-]: one may carry all of the cloth around it.
    pub edge_stiffness_factor: f64,
    /// Largest offset of a point of the body over d-hat [-].
    pub max_edge_offset: f64,
}

impl ContactTuning {
    /// The values in use.
    pub const DEFAULT: Self = Self {
        search: SearchTuning {
            candidate_margin: 1.5,
            max_dhat_over_rest_distance: 0.9,
            touching_fraction: 1e-4,
            dhat_growth_time: 0.25,
            max_growing_dhat_over_distance: 2.0,
            far_query_factor: 4.0,
            far_query_period: 16,
            verlet_skin: 0.2,
            max_outside_skin_fraction: 0.3,
            verlet_rebuild_pause: 8,
            upward_ray_offset: 1e-6,
            max_cover_height: 10.0,
        },
        step: StepTuning {
            new_contact_gap_fraction: 0.5,
            kept_gap_fraction: 0.25,
            long_step_distances: 4.0,
            min_uniform_step: 0.3,
            carry_min_gap: 0.3,
            max_carry_gap_kept: 1.0 - 0.02,
            neighbour_step_limit: 0.1,
            max_rounds: 48,
            min_decrease_fraction: 0.9,
            max_zone_rounds: 8,
        },
        friction: FrictionTuning {
            slip_velocity_tol: 1e-3,
            max_slip_tolerance: 1e-4,
            sliding_ratio: 1.0 - 1e-9,
        },
        body: BodyContactTuning {
            search_distance: 0.03,
            max_self_fold_depth: 0.03,
            max_facing_cosine: -0.2,
            self_fold_margin: 0.015,
            self_fold_gap: 5.0,
            offset_step: 0.25,
            max_offset: 6.0,
            offset_decay: 0.02,
            max_height_over_vertex: 0.01,
            max_edge_distance: 6e-3,
            max_penetration: 2.5e-3,
            min_edge_cosine: 0.5,
            edge_end_fraction: 0.02,
            min_edge_gap: 0.5,
            edge_stiffness_factor: 4.0,
            max_edge_offset: 3.0,
        },
    };
}

/// The constants that contact reads.
pub(crate) const TUNING: ContactTuning = ContactTuning::DEFAULT;
