//! Time integrators, one file each; `--method` selects from them.
//!
//! An integrator answers three questions (the division of PolyFEM): the positions without forces, the effective time
//! step with which forces act, and the velocity that belongs to new positions. The solver of a stage needs nothing
//! else:
//!
//! ```text
//! v = (x - base) / effective_dt
//! minimise |x - inertial|²_M / (2 effective_dt²) + E(x),   inertial = base_positions + effective_dt * base_velocities
//! ```
//!
//! A step has one stage or several, each such a problem; energies, contact and memory are the same for all. To add a
//! method: `NAME.rs` with its `SPEC`, and its line in `method_list!`. A method is data ([`MethodSpec`]): other crates
//! describe theirs for comparison ([`Method::Custom`]).

mod spec;
mod stage;

pub use crate::sim::integrator::spec::{InnerSolver, MAX_DT_GROWTH, MethodSpec, StageSolve, StepAttempt};
pub use crate::sim::integrator::stage::Stage;
use crate::sim::state::State;
use crease_geometry::math::Vec3;

macro_rules! method_list {
    ($($(#[$doc:meta])* $variant:ident $module:ident,)*) => {
        $(mod $module;)*

        /// The time integrators.
        #[derive(Debug, Clone, Copy, PartialEq, Eq)]
        #[non_exhaustive]
        pub enum Method {
            $($(#[$doc])* $variant,)*
            /// A method that another crate describes, for comparison.
            Custom(&'static MethodSpec),
        }

        impl Method {
            /// All methods of the library in the order of the help text.
            pub const ALL: &[Self] = &[$(Self::$variant),*];

            /// Description of the method.
            pub const fn spec(self) -> &'static MethodSpec {
                match self {
                    $(Self::$variant => &$module::SPEC,)*
                    Self::Custom(spec) => spec,
                }
            }
        }
    };
}

method_list! {
    /// Backward Euler: first order, strong numerical damping.
    BackwardEuler backward_euler,
    /// BDF2 with variable steps: second order; starts, and restarts after a discontinuity, with one step of backward
    /// Euler.
    Bdf2 bdf2,
    /// Two-stage SDIRK: L-stable, second order, one-step.
    Sdirk2 sdirk2,
}

impl Method {
    /// Returns the method of the library with that name on the command line.
    ///
    /// ```
    /// use crease_solver::sim::Method;
    /// assert_eq!(Method::from_name("bdf2"), Some(Method::Bdf2));
    /// ```
    pub fn from_name(name: &str) -> Option<Self> {
        Self::ALL.iter().copied().find(|m| m.name() == name)
    }

    /// Name on the command line and in tables.
    pub fn name(self) -> &'static str {
        self.spec().name
    }

    /// One line on the method and its purpose.
    pub fn description(self) -> &'static str {
        self.spec().description
    }

    /// Order of convergence.
    pub fn order(self) -> u32 {
        self.spec().order
    }

    /// Solver of its stages.
    pub fn solver(self) -> InnerSolver {
        self.spec().solver
    }

    /// Whether its stages are solved until convergence.
    pub fn converges(self) -> bool {
        matches!(self.solver(), InnerSolver::Newton)
    }

    /// End times of its stages as fractions of the step; the last is 1.
    pub fn stage_times(self) -> &'static [f64] {
        self.spec().stage_times
    }

    /// Returns the first stage of a step of `h` seconds from `state`.
    pub fn stage(self, state: &State, h: f64) -> Stage {
        (self.spec().stage)(state, h, None)
    }

    /// Returns a later stage, after one that ended at `stage_positions` [m].
    pub fn later_stage(self, state: &State, h: f64, stage_positions: &[Vec3]) -> Stage {
        (self.spec().stage)(state, h, Some(stage_positions))
    }

    /// Estimates the local error of the step `attempt`, root mean square over the points [m].
    pub(super) fn error(self, attempt: &StepAttempt) -> f64 {
        (self.spec().error)(attempt)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sim::state::PreviousState;

    #[test]
    fn names_are_distinct_and_the_last_stage_ends_with_the_step() {
        for method in Method::ALL {
            assert_eq!(Method::from_name(method.name()), Some(*method));
            assert_eq!(method.stage_times().last(), Some(&1.0), "{}", method.name());
            assert!(method.converges(), "{}", method.name());
        }
        assert_eq!(Method::from_name("BDF2"), None);
    }

    #[test]
    fn the_base_is_the_documented_sum() {
        let mut state = State::at_rest(vec![Vec3::new(0.3, 0.1, -0.2)], Vec::new());
        state.v[0] = Vec3::new(1.0, -2.0, 0.5);
        let before = Vec3::new(0.28, 0.15, -0.21);
        let previous = PreviousState { dt: 0.02, x: vec![before], v: vec![Vec3::x()] };
        state.previous = Some(previous);
        for method in Method::ALL {
            let inner = [Vec3::new(0.31, 0.08, -0.19)];
            let later = (method.stage_times().len() > 1).then(|| method.later_stage(&state, 0.03, &inner));
            for stage in [method.stage(&state, 0.03)].into_iter().chain(later) {
                let sum = stage.base_of(state.x.clone(), <[Vec3]>::to_vec, |x| [x.x, x.y, x.z], Vec3::from);
                assert!((sum[0] - stage.base_positions[0]).norm() < 1e-15, "{}", method.name());
            }
        }
    }
}
