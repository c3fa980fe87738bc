//! Quality of a bake: three points on the Pareto front of `crease chart front`. `docs/validation/accuracy.md` has their
//! errors and the reasons for the choice.

use crease_solver::sim::{NewtonOptions, StepOptions, StepRelaxation};

/// Compromise between speed and accuracy.
///
/// ```
/// use crease::Quality;
/// assert_eq!(Quality::from_name("draft"), Some(Quality::Draft));
/// assert!(Quality::Reference.energy_tol() < Quality::Standard.energy_tol());
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum Quality {
    /// Fast preview of a script.
    Draft,
    /// The knee of the Pareto front: the default.
    Standard,
    /// Slow reference for comparisons.
    Reference,
}

impl Quality {
    /// Every quality, from fast to accurate.
    pub const ALL: [Self; 3] = [Self::Draft, Self::Standard, Self::Reference];

    /// Name on the command line.
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

    /// Description in one line.
    pub fn description(self) -> &'static str {
        match self {
            Self::Draft => {
                "edges of 20 mm along fold lines: memory errs by 21 % in three fifths of the standard time (T-shirt folded thrice)"
            }
            Self::Standard => {
                "edges of 12 mm: memory errs by 14 %, as much as two starts of the reference differ"
            }
            Self::Reference => {
                "edges of 8 mm, a third of the tolerances: what the errors are taken from, in three to four times the standard time"
            }
        }
    }

    /// Options of the time steps.
    pub fn step_options(self) -> StepOptions {
        let standard = StepOptions::default();
        match self {
            // Steps with looser errors or fewer iterations take as many solves in all: a draft has fewer points.
            Self::Draft | Self::Standard => standard,
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

    /// Options of the time steps of cloth of `weight` [N], with the energy tolerance of this quality.
    pub fn step_options_for(self, weight: f64) -> StepOptions {
        let step = self.step_options();
        StepOptions {
            newton: NewtonOptions { decrement_tol: self.energy_tol() * weight, ..step.newton },
            ..step
        }
    }

    /// Energy tolerance of a step, as the height by which it would lift the garment [m].
    pub fn energy_tol(self) -> f64 {
        match self {
            Self::Draft => 1e-4,
            Self::Standard => 1e-5,
            Self::Reference => 3e-6,
        }
    }

    /// Strain under the garment's own weight up to which a lower stretch stiffness than the fabric's may be used [-]. Softer
    /// membranes stretch where stiffer ones wrinkle (`docs/validation/accuracy.md` has the difference).
    pub fn max_weight_strain(self) -> f64 {
        match self {
            Self::Draft | Self::Standard => 1e-3,
            Self::Reference => 0.0,
        }
    }

    /// Length of edges where the script creases the cloth [m].
    pub fn finest_edge(self) -> f64 {
        match self {
            Self::Draft => 0.020,
            Self::Standard => 0.012,
            Self::Reference => 0.008,
        }
    }

    /// Step after a memory event as a fraction of the time to the next event [-]: a quarter misses an eighth of the memory of
    /// cloth that is pressed for half a minute, a tenth nothing measurable (`docs/validation/accuracy.md`).
    pub fn event_dt_fraction(self) -> f64 {
        match self {
            Self::Draft => 0.25,
            Self::Standard => 0.1,
            Self::Reference => 0.025,
        }
    }
}
