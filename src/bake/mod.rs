//! The main job of the library: a wear script is simulated on a garment and its wrinkles are baked into the mesh.
//!
//! [`Bake`] runs two phases. `simulate` performs the script action by action and step by step: loads (`wear`) -> solve
//! (`sim`) -> memory (`memory`). `relax_to_source` then relaxes the garment to its source pose with the rest state that it
//! earned. [`memory_from_motion`] replaces the first phase by a motion that already exists; [`relax`] is the second alone.
//!
//! | file | subject |
//! |---|---|
//! | `builder` | [`Bake`], both phases in order |
//! | `options`, `quality`, `tuning` | what can be asked for, and the constants behind it |
//! | `plan`, `choose_mesh`, `body_creases`, `active_region` | models, mesh and points that a script needs |
//! | `setup`, `run`, `action_loop`, `refinement`, `simulate`, `lay_first` | first phase |
//! | `trims` | buttons and other small solids, which follow the cloth |
//! | `body_coupling`, `body_penetration`, `body_watch`, `static_contact`, `depenetration` | the body under the cloth |
//! | `leash`, `held_points` | what holds a garment that is skinned in its file |
//! | `relax_to_source`, `relax`, `uncross` | second phase |
//! | `observer`, `frames`, `report`, `findings`, `violation_log`, `initial_intersections` | what is reported |
//! | `checkpoint` | interrupted runs |

mod action_loop;
mod active_region;
mod body_coupling;
mod body_creases;
mod body_penetration;
mod body_start;
mod body_watch;
mod builder;

pub mod checkpoint;
mod choose_mesh;
mod depenetration;
mod findings;
mod frames;
mod from_motion;
mod held_points;
mod initial_intersections;
mod lay_first;
mod leash;
mod observer;
mod options;
mod plan;
mod quality;
mod refinement;
mod relax;
mod relax_to_source;
mod report;
mod run;
mod setup;
mod simulate;
mod static_contact;
mod trims;
mod tuning;
mod uncross;
mod violation_log;

pub use active_region::active_points;
pub use body_start::body_at_first_key;
pub use builder::Bake;

pub use checkpoint::{Checkpoint, fingerprint};
pub(crate) use choose_mesh::{EdgeLengths, crosses_elsewhere, make_mesh};
pub use choose_mesh::{MeshChoice, RefinementRule};
pub use from_motion::{GarmentMotion, memory_from_motion};
pub use observer::{BakeProgress, Observer};
pub use options::BakeOptions;
pub use plan::{ModelDecision, ModelPlan};
pub use quality::Quality;
pub(crate) use relax::relax_to_show;
pub use relax::{relax, rest_mesh};
pub(crate) use relax_to_source::RelaxOptions;
pub use relax_to_source::RelaxResult;
pub use report::{
    BakeReport, BakeResult, EarlyStop, SimulatedGarment, StageSeconds, StepConvergence, StopCause,
};
pub(crate) use uncross::GarmentReading;
