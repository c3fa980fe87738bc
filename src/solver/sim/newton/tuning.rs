//! The numbers of Newton's method that are choices.

/// Tuning of Newton's method; see [`NewtonTuning::DEFAULT`].
pub(super) struct NewtonTuning {
    /// Maximum deviation of a point's displacement from the mean of all points in one iteration [m], default 0.25:
    /// longer directions are scaled down. A point that moves far sweeps all others on its path, and the contact search
    /// grows with it.
    pub max_point_deviation: f64,
    /// Factor on the energy tolerance above which a solve with small displacements counts as stalled instead of
    /// converged [-], default 100: where layers are jammed, displacements are small although much energy can still
    /// decrease.
    pub stall_energy_factor: f64,
    /// Minimum step size of a global iteration after which a local solve follows [-], default 0.2.
    pub min_step_before_local: f64,
    /// Number of solves that begin with a local solve after a first global iteration that was already converged,
    /// default 4.
    pub local_first_solves: u32,
    /// Maximum effective time step of such a solve [s], default 0.5.
    pub local_first_max_dt: f64,
    /// Number of local iterations that count as one global iteration towards the maximum, default 8: they are cheap.
    pub local_per_global_iterations: usize,
    /// Maximum number of solves in a row in which the stale factor is used under the strict criterion only, default 8;
    /// doubles with each failure (exponential back-off).
    pub max_stale_backoff: u32,
    /// Factor on the activation distance within which contacts get an entry in a new sparsity pattern [-], default 1.5,
    /// so that the pattern lasts.
    pub pattern_dhat_factor: f64,
    /// Linear solve of one iteration.
    pub linear_solve: LinearSolveTuning,
    /// Line search.
    pub line_search: LineSearchTuning,
    /// Local solves.
    pub local: LocalSolveTuning,
    /// Levenberg-Marquardt damping.
    pub damping: DampingTuning,
}

/// Tuning of the linear solve of one iteration.
pub(super) struct LinearSolveTuning {
    /// Maximum number of factorisations with a growing diagonal shift, default 12.
    pub max_factorisations: usize,
    /// First diagonal shift relative to the largest diagonal entry [-], default 1e-10: rounding can make a nearly
    /// singular matrix indefinite.
    pub initial_shift: f64,
    /// Factor by which the total shift grows [-], default 10.
    pub shift_growth: f64,
    /// Relative residual of conjugate gradients, used where the factor does not fit in memory [-], default 1e-6.
    pub cg_tol: f64,
    /// Maximum number of conjugate gradient iterations, default 20000.
    pub max_cg_iterations: usize,
}

/// Tuning of the line search.
pub(super) struct LineSearchTuning {
    /// Fraction of the predicted decrease that a step must reach [-], default 1e-4 (Armijo).
    pub armijo: f64,
    /// Allowed increase for rounding relative to the sum of the magnitudes of the terms [-], default 1e-13.
    pub rounding: f64,
    /// Change of the potential relative to the sum of the magnitudes of its terms below which the slope decides as well
    /// [-], default 1e-10. The terms are sums themselves and may lose some digits inside (the weight of cloth on both
    /// sides of height zero).
    pub rounding_band: f64,
    /// Maximum slope at the trial position relative to the negative slope at the start [-], default 0.9 (approximate
    /// Wolfe condition).
    pub max_slope_ratio: f64,
    /// Maximum number of trial steps, default 24; each halves the step size.
    pub max_trials: usize,
    /// Minimum step size of a line search along individually limited displacements [-], default 0.01.
    pub min_step: f64,
    /// Maximum fraction of the free points that may be eliminated by local solves [-], default 0.5.
    pub max_eliminated_fraction: f64,
    /// Fraction of the predicted decrease that a step with eliminated points must reach [-], default 0.1.
    pub armijo_after_elimination: f64,
    /// Minimum step size at which points are eliminated [-], default 0.1.
    pub min_step_to_eliminate: f64,
}

/// Tuning of local solves.
pub(super) struct LocalSolveTuning {
    /// Fraction of the energy tolerance that points outside the active set may have as predicted decrease [-], default
    /// 0.5; the local iterations stop at the same fraction.
    pub omitted_energy_fraction: f64,
    /// Maximum predicted decrease of one omitted point, as a fraction of the energy tolerance, where the diffuse
    /// tolerance applies [-], default 0.05.
    pub max_point_energy_fraction: f64,
    /// Rings of neighbours around the selected points that belong to the active set, default 2.
    pub neighbour_rings: usize,
    /// Maximum active fraction of the free points of a local solve between global iterations [-], default 0.3.
    pub max_active_fraction: f64,
    /// Maximum number of active sets between two global iterations, default 4.
    pub max_rounds: usize,
    /// Maximum number of entries of a factor that is kept for the next local solve, default 2^20: most have fewer, few
    /// a hundred times as many.
    pub max_kept_factor_entries: usize,
    /// Maximum number of iterations on one active set, default 8.
    pub max_iterations: usize,
}

/// Tuning of Levenberg-Marquardt damping.
pub(super) struct DampingTuning {
    /// Minimum gain ratio of an undamped direction [-], default 0.05; one below counts as rejected.
    pub min_gain_ratio: f64,
    /// Number of rejected directions in a row that start the damping, default 3: single ones are often followed by a
    /// good one.
    pub rejects_before_damping: usize,
    /// Displacement to which the first damping limits cloth without stiffness [m], default 5e-3.
    pub initial_step: f64,
    /// Gain ratio below which damping increases [-], default 0.2.
    pub increase_below_gain_ratio: f64,
    /// Gain ratio above which damping decreases [-], default 0.6.
    pub decrease_above_gain_ratio: f64,
    /// Factor of an increase [-], default 4; differs from that of a decrease, so that damping does not alternate
    /// between two values.
    pub increase_factor: f64,
    /// Factor of a decrease [-], default 3.
    pub decrease_factor: f64,
    /// Factor of a decrease once damped iterations have converged [-], default 100.
    pub decrease_at_convergence: f64,
    /// Damping relative to the inertia below which it is turned off [-], default 0.5.
    pub min_damping: f64,
    /// Damping relative to the inertia beyond which it does not help [-], default 1e8.
    pub max_damping: f64,
}

impl NewtonTuning {
    /// The values in use.
    pub const DEFAULT: Self = Self {
        max_point_deviation: 0.25,
        stall_energy_factor: 100.0,
        min_step_before_local: 0.2,
        local_first_solves: 4,
        local_first_max_dt: 0.5,
        local_per_global_iterations: 8,
        max_stale_backoff: 8,
        pattern_dhat_factor: 1.5,
        linear_solve: LinearSolveTuning {
            max_factorisations: 12,
            initial_shift: 1e-10,
            shift_growth: 10.0,
            cg_tol: 1e-6,
            max_cg_iterations: 20_000,
        },
        line_search: LineSearchTuning {
            armijo: 1e-4,
            rounding: 1e-13,
            rounding_band: 1e-10,
            max_slope_ratio: 0.9,
            max_trials: 24,
            min_step: 0.01,
            max_eliminated_fraction: 0.5,
            armijo_after_elimination: 0.1,
            min_step_to_eliminate: 0.1,
        },
        local: LocalSolveTuning {
            omitted_energy_fraction: 0.5,
            max_point_energy_fraction: 0.05,
            neighbour_rings: 2,
            max_active_fraction: 0.3,
            max_rounds: 4,
            max_kept_factor_entries: 1 << 20,
            max_iterations: 8,
        },
        damping: DampingTuning {
            min_gain_ratio: 0.05,
            rejects_before_damping: 3,
            initial_step: 5e-3,
            increase_below_gain_ratio: 0.2,
            decrease_above_gain_ratio: 0.6,
            increase_factor: 4.0,
            decrease_factor: 3.0,
            decrease_at_convergence: 100.0,
            min_damping: 0.5,
            max_damping: 1e8,
        },
    };
}

pub(super) const TUNING: NewtonTuning = NewtonTuning::DEFAULT;
