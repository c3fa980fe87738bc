//! The numbers of the energy terms that are choices.

/// Tuning of the energy terms; see [`EnergyTuning::DEFAULT`].
pub(super) struct EnergyTuning {
    /// Minimum ratio of a triangle's rest altitude to its longest edge [-], default 1e-3. A thinner triangle is as
    /// stiff as one of this ratio: the material derivative of a sliver grows without bound.
    pub min_altitude_ratio: f64,
    /// Hinge angle beyond which an angle is unwrapped even where layers never pass through each other [rad], default
    /// 179.5 degrees: the two triangles of such a hinge may overlap in the imported mesh itself.
    pub max_principal_angle: f64,
    /// Angle beyond which two wings of a junction do not continue in one another [rad], default 120 degrees: one is folded back.
    pub max_junction_angle: f64,
    /// Minimum number of hinges per parallel task, default 512: fewer cost more to distribute than to compute.
    pub min_hinges_per_task: usize,
    /// Number of elements per parallel task of a sum, default 1024. It fixes the order of the sum and so its last bits.
    pub elements_per_task: usize,
}

impl EnergyTuning {
    /// The values in use.
    pub const DEFAULT: Self = Self {
        min_altitude_ratio: 1e-3,
        max_principal_angle: 179.5 * std::f64::consts::PI / 180.0,
        max_junction_angle: 120.0 * std::f64::consts::PI / 180.0,
        min_hinges_per_task: 512,
        elements_per_task: 1024,
    };
}

pub(super) const TUNING: EnergyTuning = EnergyTuning::DEFAULT;
