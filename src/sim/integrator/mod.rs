//! Time integrators: what `--method` chooses from, one file each.
//!
//! An integrator is three answers (PolyFEM's cut): where the points would go without forces, how strongly forces
//! count, and what velocity belongs to a new position. What solves a step knows nothing more of it:
//!
//! ```text
//! v = (x - base) / span            minimise |x - inertial|²_M / (2 span²) + E(x),   inertial = base + span * drift
//! ```
//!
//! A step has one part or several, each such a problem; energies, contact and memory are the same for all. To add a
//! method: `NAME.rs` with its `SPEC`, and its line in `method_list!`.

use crate::math::Vec3;
use crate::sim::State;

/// One implicit problem of a step.
#[derive(Debug, Clone)]
pub struct Stage {
    /// Positions that the new velocity is measured from, one per point [m].
    pub base_positions: Vec<Vec3>,
    /// Velocities that the new velocity is compared with, one per point [m/s].
    pub base_velocities: Vec<Vec3>,
    /// beta h: share of the step that forces count for [s].
    pub effective_dt: f64,
    /// `base` = `now` x_n + (1 - `now`) `other`: whatever else has a rate (a strain, an angle) has its base by the same sum.
    pub current_weight: f64,
    /// Positions beside x_n that the base is made of [m]; `None` where it is x_n alone.
    pub previous_positions: Option<Vec<Vec3>>,
}

impl Stage {
    /// Where the points would go without forces [m].
    pub fn inertial(&self) -> Vec<Vec3> {
        self.base_positions
            .iter()
            .zip(&self.base_velocities)
            .map(|(b, d)| b + d * self.effective_dt)
            .collect()
    }

    /// Velocity of new positions [m/s].
    pub fn velocity(&self, x: &[Vec3]) -> Vec<Vec3> {
        x.iter().zip(&self.base_positions).map(|(x, b)| (x - b) / self.effective_dt).collect()
    }

    /// What the rate of a quantity is measured from that is `at` at x_n and `there` at [`Self::other`]; neither is
    /// asked for twice.
    pub(super) fn base_of<T: Clone, const N: usize>(
        &self,
        at: Vec<T>,
        there: impl FnOnce(&[Vec3]) -> Vec<T>,
        parts: impl Fn(&T) -> [f64; N],
        whole: impl Fn([f64; N]) -> T,
    ) -> Vec<T> {
        let Some(other) = &self.previous_positions else { return at };
        let mix = |(a, b): (&T, &T)| {
            let (a, b) = (parts(a), parts(b));
            whole(std::array::from_fn(|k| self.current_weight * a[k] + (1.0 - self.current_weight) * b[k]))
        };
        at.iter().zip(&there(other)).map(mix).collect()
    }
}

/// `share` a + (1 - `share`) b.
fn mixed(share: f64, a: &[Vec3], b: &[Vec3]) -> Vec<Vec3> {
    a.iter().zip(b).map(|(a, b)| a * share + b * (1.0 - share)).collect()
}

/// How the problem of a part is solved.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum InnerSolver {
    /// Newton, until it has converged.
    Newton,
    /// One Newton iteration.
    SingleNewton,
    /// A fixed number of sweeps over single points: not converged, for looks only.
    Vbd,
}

/// A step that was tried: what its error is estimated from.
pub(super) struct StepAttempt<'a> {
    pub(super) state: &'a State,
    pub(super) next: &'a State,
    /// Positions at the end of the part before the last, where there is one [m].
    pub(super) stage_positions: Option<&'a [Vec3]>,
    /// Length [s].
    pub(super) h: f64,
}

/// Stage of a step of h seconds from a state; for later parts with the positions the part before led to.
type MakeStage = fn(&State, f64, Option<&[Vec3]>) -> Stage;

/// What a method is.
#[derive(Clone, Copy)]
struct MethodSpec {
    /// On the command line.
    name: &'static str,
    /// One line: what it is, and what for.
    description: &'static str,
    /// Order of convergence.
    order: u32,
    /// Times of its parts as shares of the step.
    stage_times: &'static [f64],
    solver: InnerSolver,
    stage: MakeStage,
    /// Error of one step, root mean square over the points [m].
    error: fn(&StepAttempt) -> f64,
}

macro_rules! method_list {
    ($($(#[$doc:meta])* $variant:ident $module:ident,)*) => {
        $(mod $module;)*

        /// The list of integrators.
        #[derive(Debug, Clone, Copy, PartialEq, Eq)]
        pub enum Method { $($(#[$doc])* $variant,)* }

        impl Method {
            /// Every method, in the order they are listed to people.
            pub const ALL: &[Self] = &[$(Self::$variant),*];

            fn spec(self) -> &'static MethodSpec {
                match self { $(Self::$variant => &$module::SPEC,)* }
            }
        }
    };
}

method_list! {
    /// Backward Euler with one Newton iteration.
    BackwardEulerOnce be1,
    /// Backward Euler: first order, damps strongly.
    BackwardEuler backward_euler,
    /// BDF2 with one Newton iteration.
    Bdf2Once bdf2_once,
    /// BDF2 with variable steps: second order; starts, and restarts after a jump, with one step of backward Euler.
    Bdf2 bdf2,
    /// Two-stage, L-stable, second order, one-step.
    Sdirk2 sdirk2,
    /// Vertex block descent: visual.
    VertexBlockDescent vbd,
}

/// Steps may grow by this factor at most: variable-step BDF2 is unstable beyond 1 + sqrt 2.
pub const MAX_DT_GROWTH: f64 = 2.0;

impl Method {
    /// The method of that name.
    pub fn from_name(name: &str) -> Option<Self> {
        Self::ALL.iter().copied().find(|m| m.name() == name)
    }

    /// Its name on the command line.
    pub fn name(self) -> &'static str {
        self.spec().name
    }

    /// What it is and what for, in one line.
    pub fn description(self) -> &'static str {
        self.spec().description
    }

    /// Order of convergence.
    pub fn order(self) -> u32 {
        self.spec().order
    }

    /// How the problems of its steps are solved.
    pub fn solver(self) -> InnerSolver {
        self.spec().solver
    }

    /// Whether it does not converge to the physics and is for looks only.
    pub fn is_visual(self) -> bool {
        self.solver() == InnerSolver::Vbd
    }

    /// When the parts of a step end, as shares of it; the last is 1.
    pub fn stage_times(self) -> &'static [f64] {
        self.spec().stage_times
    }

    /// The stage of the first part of a step of `h` seconds from `state`.
    pub fn stage(self, state: &State, h: f64) -> Stage {
        (self.spec().stage)(state, h, None)
    }

    /// The stage of a later part, after one that led to `inner` [m].
    pub fn later_stage(self, state: &State, h: f64, inner: &[Vec3]) -> Stage {
        (self.spec().stage)(state, h, Some(inner))
    }

    /// Error of the step `tried` [m], root mean square over the points.
    pub(super) fn error(self, tried: &StepAttempt) -> f64 {
        (self.spec().error)(tried)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_told_apart_and_parts_end_with_the_step() {
        for method in Method::ALL {
            assert_eq!(Method::from_name(method.name()), Some(*method));
            assert_eq!(method.stage_times().last(), Some(&1.0), "{}", method.name());
            assert_eq!(method.is_visual(), method.description().contains("VISUAL"), "{}", method.name());
        }
        assert_eq!(Method::from_name("BDF2"), None);
    }

    #[test]
    fn the_base_is_the_sum_it_says() {
        let mut state = State::at_rest(vec![Vec3::new(0.3, 0.1, -0.2)], Vec::new());
        state.v[0] = Vec3::new(1.0, -2.0, 0.5);
        let before = Vec3::new(0.28, 0.15, -0.21);
        let previous = crate::sim::PreviousState { step: 0.02, x: vec![before], v: vec![Vec3::x()] };
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
