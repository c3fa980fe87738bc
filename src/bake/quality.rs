//! How finely a bake is made: three points on the front of `crease chart accuracy` (docs/validation/accuracy.md says what error each
//! leaves, and how they were chosen).

use crate::sim::{Method, NewtonOptions, StepOptions, StepRelaxation};

/// A point between speed and accuracy.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Quality {
    /// To see whether a script does what was meant.
    Draft,
    /// The knee of the front: what a bake does unless told otherwise.
    Standard,
    /// To compare others with.
    Reference,
}

impl Quality {
    /// Every quality, from fast to accurate.
    pub const ALL: [Self; 3] = [Self::Draft, Self::Standard, Self::Reference];

    /// Its name on the command line.
    pub fn name(self) -> &'static str {
        match self {
            Self::Draft => "draft",
            Self::Standard => "standard",
            Self::Reference => "reference",
        }
    }

    /// The quality of that name.
    pub fn from_name(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|quality| quality.name() == name)
    }

    /// What it is, in one line.
    pub fn description(self) -> &'static str {
        match self {
            Self::Draft => "to see whether the script does what was meant",
            Self::Standard => "the knee between speed and accuracy",
            Self::Reference => "to compare others with",
        }
    }

    /// How steps are made.
    pub fn step(self) -> StepOptions {
        let standard = StepOptions::default();
        match self {
            // Rejected steps cost more than coarse ones save: with looser errors and four iterations a bake took as many
            // solves as the standard. One iteration is never rejected for not converging.
            Self::Draft => {
                StepOptions { method: Method::BackwardEulerOnce, relaxation: StepRelaxation::OFF, ..standard }
            }
            Self::Standard => standard,
            Self::Reference => StepOptions {
                local_error_tol: 1e-4,
                min_dt: 1.0 / 120.0,
                relaxation: StepRelaxation::OFF,
                newton: NewtonOptions {
                    displacement_tol: 1e-5,
                    rel_decrement_tol: 0.0,
                    max_iterations: 100,
                    ..standard.newton
                },
                ..standard
            },
        }
    }

    /// The same for cloth of so much `weight` [N], each step solved as far as this quality solves it.
    pub fn step_for(self, weight: f64) -> StepOptions {
        let step = self.step();
        StepOptions {
            newton: NewtonOptions { decrement_tol: self.energy_tol() * weight, ..step.newton },
            ..step
        }
    }

    /// A step is converged, too, when what energy is left to gain would not lift the garment by this [m].
    pub fn energy_tol(self) -> f64 {
        match self {
            Self::Draft | Self::Standard => 1e-5,
            Self::Reference => 3e-6,
        }
    }

    /// Strain under the garment's own weight that a lower stretch stiffness than the fabric's may cost [-]. Softer
    /// membranes take up as stretch what stiffer ones throw into wrinkles (docs/validation/accuracy.md has what that changes).
    pub fn max_weight_strain(self) -> f64 {
        match self {
            Self::Draft => 5e-3,
            Self::Standard => 1e-3,
            Self::Reference => 0.0,
        }
    }

    /// Share of the time from event to event that the step after one may take [-]: a quarter still misses an eighth of
    /// what cloth that is pressed for half a minute remembers, a tenth nothing that can be told (docs/validation/accuracy.md).
    pub fn event_dt_fraction(self) -> f64 {
        match self {
            Self::Draft => 0.25,
            Self::Standard => 0.1,
            Self::Reference => 0.025,
        }
    }
}
