//! The numbers of the block matrix that are choices.

/// Tuning of the block matrix; see [`MatrixTuning::DEFAULT`].
pub(super) struct MatrixTuning {
    /// Minimum number of rows per thread of an assembly, default 256: fewer cost more to distribute than to fill.
    pub min_rows_per_thread: usize,
    /// Growth of the sparsity pattern beyond which it is rebuilt [-], default 0.1: blocks that are no longer used cost
    /// time in every factorisation.
    pub max_pattern_growth: f64,
}

impl MatrixTuning {
    /// The values in use.
    pub const DEFAULT: Self = Self { min_rows_per_thread: 256, max_pattern_growth: 0.1 };
}

pub(super) const TUNING: MatrixTuning = MatrixTuning::DEFAULT;
