//! The numbers of the sparse Cholesky factorisation that are choices.

/// Tuning of the factorisation; see [`CholeskyTuning::DEFAULT`]. Work is measured in multiplications.
pub(super) struct CholeskyTuning {
    /// Maximum number of entries of a factor, default 512 Mi: 4 GiB in double precision. A larger one is refused.
    pub max_factor_entries: usize,
    /// Work below which a factorisation is made in double precision at once, default 2e7: it takes a millisecond.
    pub direct_double_max_flops: f64,
    /// Number of factorisations that stay in double precision after a factor in single precision was not good enough,
    /// default 16.
    pub double_precision_holdoff: u32,
    /// Iterative refinement.
    pub refinement: RefinementTuning,
    /// Nested dissection.
    pub dissection: DissectionTuning,
    /// Parallel execution.
    pub parallel: ParallelTuning,
}

/// Tuning of conjugate gradients with a factor as preconditioner.
pub(super) struct RefinementTuning {
    /// Residual relative to the right-hand side [-], default 1e-8: Newton's own error is far above it, and a third
    /// iteration costs as much as a tenth of a factorisation.
    pub residual_tol: f64,
    /// Maximum number of iterations, default 30.
    pub max_iterations: usize,
    /// Minimum number of iterations with a stale factor, default 2. They are always made, and suffice where the
    /// predicted decrease is below the energy tolerance.
    pub min_stale_iterations: usize,
    /// Decrease left by iterations with a stale factor, relative to the first prediction [-], default 1e-3.
    pub stale_rel_tol: f64,
    /// Decrease left by iterations with a stale factor, relative to the energy tolerance [-], default 0.3.
    pub stale_energy_fraction: f64,
    /// Maximum contraction of the decrease left per iteration with a stale factor [-], default 0.3.
    pub max_contraction: f64,
    /// Factor on the tolerance up to which a slow contraction is accepted [-], default 30: there the measure of the
    /// stale factor is noisy, as it takes contacts that have become stiff since for soft.
    pub noise_floor_factor: f64,
    /// Budget of iterations with a stale factor: work of a factorisation per entry of the factor and iteration [-], default
    /// 200. One iteration takes as long as about 100, so that all of them take at most half a factorisation.
    pub flops_per_entry_budget: f64,
    /// Factor on the energy tolerance above which the strict criterion refuses a stale factor [-], default 3.
    pub strict_energy_factor: f64,
}

/// Tuning of nested dissection.
pub(super) struct DissectionTuning {
    /// Maximum number of points of a leaf, default 16: from 4 to 24 the work grows by 2 to 6 %, and there are fewer
    /// fronts.
    pub max_leaf_points: usize,
    /// Number of planes tried per axis, default 64.
    pub planes_per_axis: usize,
    /// Minimum fraction of the points on either side of a plane [-], default 0.25.
    pub min_side_fraction: f32,
    /// Weight of imbalance on the size of a separator [-], default 10: a quarter on one side counts as a separator 1.6
    /// times as large.
    pub imbalance_weight: f32,
    /// Minimum extent of a part along an axis relative to its largest extent, for planes across that axis [-], default
    /// 0.1.
    pub min_extent_fraction: f32,
    /// Distance from the origin over the extent beyond which positions are taken relative to their middle [-], default 1000: single
    /// precision then has 4 digits left for the extent.
    pub max_offset_ratio: f64,
}

/// Tuning of parallel execution; tile sizes also fix the order of sums and so the last bits.
pub(super) struct ParallelTuning {
    /// Minimum work of the smaller half of a forest that is split between threads, default 1e6.
    pub min_forest_flops: f64,
    /// Minimum number of rows of the smaller half of a forest that a triangular solve splits between threads, default
    /// 400.
    pub min_forest_rows: usize,
    /// Minimum work of a dense product that is split between threads, default 2^21.
    pub min_product_flops: usize,
    /// Maximum number of rows of a tile of a dense solve or product, default 192.
    pub max_tile_rows: usize,
    /// Number of columns that are eliminated at a time, default 96: products of this depth run at full rate.
    pub columns_per_elimination: usize,
    /// Number of columns of one stripe of a diagonal tile, default 48.
    pub columns_per_stripe: usize,
    /// Number of columns of one step of a triangular solve, default 48.
    pub columns_per_substitution: usize,
}

impl CholeskyTuning {
    /// The values in use.
    pub const DEFAULT: Self = Self {
        max_factor_entries: 512 << 20,
        direct_double_max_flops: 2e7,
        double_precision_holdoff: 16,
        refinement: RefinementTuning {
            residual_tol: 1e-8,
            max_iterations: 30,
            min_stale_iterations: 2,
            stale_rel_tol: 1e-3,
            stale_energy_fraction: 0.3,
            max_contraction: 0.3,
            noise_floor_factor: 30.0,
            flops_per_entry_budget: 200.0,
            strict_energy_factor: 3.0,
        },
        dissection: DissectionTuning {
            max_leaf_points: 16,
            planes_per_axis: 64,
            min_side_fraction: 0.25,
            imbalance_weight: 10.0,
            min_extent_fraction: 0.1,
            max_offset_ratio: 1e3,
        },
        parallel: ParallelTuning {
            min_forest_flops: 1e6,
            min_forest_rows: 400,
            min_product_flops: 1 << 21,
            max_tile_rows: 192,
            columns_per_elimination: 96,
            columns_per_stripe: 48,
            columns_per_substitution: 48,
        },
    };
}

pub(super) const TUNING: CholeskyTuning = CholeskyTuning::DEFAULT;
