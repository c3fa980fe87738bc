//! Buffers and statistics that are kept between solves.

use crease_linear::{BlockMatrix, Cholesky, SolveCost};

/// Buffers and statistics that are kept between solves, for speed only.
#[derive(Default)]
pub struct Workspace {
    /// System as last assembled.
    pub(super) matrix: BlockMatrix,
    pub(super) direct: Cholesky,
    /// Workspace of local solves.
    pub(super) local: Option<Box<Self>>,
    /// Fixed points of the last global factorisation, one flag per point; empty without a factor.
    pub(super) factorised_for: Vec<bool>,
    /// Number of solves to come that may begin with a local solve.
    pub(super) local_first_budget: u32,
    /// Whether inertia or a shift was added to the system after it was assembled.
    pub(super) is_shifted: bool,
    /// Number of solves to come in which the stale factor is used under the strict criterion.
    pub(super) stale_backoff: u32,
    /// The same after its next failure.
    pub(super) next_backoff: u32,
}

impl Workspace {
    /// Exchanges the buffers of factorisations with `other`; only one of the two factorises at a time.
    pub(super) fn swap_buffers_with(&mut self, other: &mut Self) {
        self.direct.swap_buffers(&mut other.direct);
    }

    /// Releases the factor if it has more than `entries` entries.
    pub(super) fn release_if_larger_than(&mut self, entries: usize) {
        self.direct.release_if_larger_than(entries);
    }

    /// Returns the work of linear solves since the last call.
    pub(super) fn take_cost(&mut self) -> SolveCost {
        self.direct.take_cost()
    }

    /// Makes the next solve begin with a global iteration.
    pub(in crate::sim) fn disable_local_first(&mut self) {
        self.local_first_budget = 0;
    }

    /// Clears everything: the terms of the next solve may couple other points.
    pub fn reset(&mut self) {
        *self = Self::default();
    }
}
