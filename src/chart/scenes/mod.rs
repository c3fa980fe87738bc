//! Validation scenes: small cloth scenes that one integrator runs with one setting, through the stepper of a bake.
//!
//! ```text
//! Scene + SceneSetting -> run -> SceneOutcome        compared with a reference -> error
//! ```
//!
//! The scenes (one file each) use fixed steps, so that a setting is a step size and a tolerance; energies, contact
//! and memory are those of a bake. The charts `accuracy` and `stability` and the tests of `tests/methods.rs` consist
//! of them. Wall time is that of the steps alone, without the measurements between them.

mod cantilever;
mod flap;
mod flight;
mod run;
mod scene;
mod stack;
mod swing;

pub use cantilever::Cantilever;
pub use flap::Flap;
pub use flight::Flight;
pub use run::{SceneOutcome, SceneSetting, run};
pub use scene::{Scene, SceneState};
pub use stack::Stack;
pub use swing::Swing;
