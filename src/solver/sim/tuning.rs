//! The numbers of the time stepping that are choices.

/// Tuning of step control and of the detection of violations; see [`StepControlTuning::DEFAULT`].
pub(super) struct StepControlTuning {
    /// A step counts as quasi-static when it is at most this fraction of what its error and the loads allow [-],
    /// default 0.6: its length is then limited by memory events, hardly anything moves, and a local solve is likely to
    /// suffice.
    pub quasi_static_dt_fraction: f64,
    /// Factor on the energy tolerance below which a step that ran out of iterations is accepted as solved [-], default
    /// 10: the remaining decrease is small enough to be left to the next step.
    pub nearly_converged_factor: f64,
    /// Factor on the tolerance of the local error above which a step is rejected [-], default 4: rejecting at 1 costs
    /// more steps than the error is worth.
    pub reject_error_factor: f64,
    /// Safety factor on the tolerance of the local error when the next step is chosen [-], default 0.8.
    pub error_safety_factor: f64,
    /// Minimum ratio of the next step to this one [-], default 0.3.
    pub min_dt_ratio: f64,
    /// Maximum ratio of the next step to this one [-], default 1.9; below the stability limit of BDF2.
    pub max_dt_ratio: f64,
    /// Solves of a step that are repeated with contacts that were missing or too weak, at most, default 2.
    pub max_contact_revisions: usize,
    /// Smallest tolerance of such a solve over that of the solve before, where the predicted decrease is diffuse [-], default
    /// 0.3.
    pub revision_tol_factor: f64,
    /// Smallest step over the minimum step, where the cloth crosses a body that it did not cross before [-], default 0.1.
    pub min_crossing_dt_fraction: f64,
    /// Minimum ratio of a gap to its activation distance [-], default 0.02: layers that are nearer are reported as
    /// pressed, as the contact stiffness is not made for it.
    pub min_gap_ratio: f64,
    /// Maximum strain along warp or weft [-], default 0.3: more is reported as stretched, as no fabric bears it in
    /// wear.
    pub max_strain: f64,
    /// Motion of a point in a step below which it stands still [m], default 1e-12: rounding.
    pub min_motion: f64,
    /// Strain that cloth does not bear [-], default 1: twice its length.
    pub max_cloth_strain: f64,
    /// Fraction of the cloth's area beyond that strain from which it counts as torn [-], default 0.002.
    pub min_torn_fraction: f64,
}

impl StepControlTuning {
    /// The values in use.
    pub const DEFAULT: Self = Self {
        quasi_static_dt_fraction: 0.6,
        nearly_converged_factor: 10.0,
        reject_error_factor: 4.0,
        error_safety_factor: 0.8,
        min_dt_ratio: 0.3,
        max_dt_ratio: 1.9,
        max_contact_revisions: 2,
        revision_tol_factor: 0.3,
        min_crossing_dt_fraction: 0.1,
        min_gap_ratio: 0.02,
        max_strain: 0.3,
        min_motion: 1e-12,
        max_cloth_strain: 1.0,
        min_torn_fraction: 0.002,
    };
}

pub(super) const TUNING: StepControlTuning = StepControlTuning::DEFAULT;
