//! The tuning constants of the memory, each with quantity, unit and reason. The numbers of the law itself belong to the
//! fabric ([`crease_model::fabric::FabricMemory`]).

/// Tuning constants of the memory law and of its effect on the energies.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct MemoryTuning {
    /// Events of one element in one step at most: more mean a band duration near zero, and are left to the next step.
    pub max_events_per_step: usize,
    /// Time after release from which decades of recovery are counted [s].
    pub recovery_start: f64,
    /// Condition as a fraction of the gradual threshold [-] beyond which an element counts as held and does not recover.
    pub held_fraction: f64,
    /// Time constant with which the effective rest state follows the rest state [s].
    pub smoothing_time: f64,
    /// Difference below which the effective rest state takes the value of the rest state [rad, -].
    pub smoothing_tol: f64,
}

impl MemoryTuning {
    /// The values that every memory uses.
    const DEFAULT: Self = Self {
        max_events_per_step: 10_000,
        recovery_start: 1.0,
        held_fraction: 0.5,
        smoothing_time: 0.2,
        smoothing_tol: 1e-9,
    };
}

/// The values in use.
pub(super) const TUNING: MemoryTuning = MemoryTuning::DEFAULT;
