//! The main job of the library: a wear script is simulated on a garment and its wrinkles are baked into the mesh.
//!
//! [`Bake`] runs two phases. `simulate` performs the script action by action and step by step: loads (`wear`) -> solve
//! (`sim`) -> memory (`memory`). `relax_to_source` then relaxes the garment to its source pose with the rest state that it
//! earned. [`memory_from_motion`] replaces the first phase by a motion that already exists; [`relax`] is the second alone.
//!
//! | place | subject |
//! |---|---|
//! | `builder` | [`Bake`], both phases in order |
//! | `options`, `quality`, `tuning` | what can be asked for, and the constants behind it |
//! | `plan`, `choose_mesh` | models and mesh that a script needs |
//! | `run/` | first phase: the script performed, its checkpoints and its findings |
//! | `body/` | the body under the cloth, and what holds a garment that is skinned in its file |
//! | `relax/` | second phase |
//! | `report` | what is reported |

mod bend_reach;
mod body;
mod builder;
mod choose_mesh;
mod options;
mod plan;
mod quality;
mod relax;
mod report;
mod run;
mod tuning;

pub use body::active_region::active_points;
pub use body::start::body_at_first_key;
pub use builder::Bake;
pub(crate) use choose_mesh::{EdgeLengths, crosses_elsewhere, make_mesh};
pub use choose_mesh::{MeshChoice, RefinementRule};
pub use options::BakeOptions;
pub use plan::{ModelDecision, ModelPlan};
pub use quality::Quality;
pub(crate) use relax::garment_reading::GarmentReading;
pub use relax::given_memory::{relax, rest_mesh};
pub(crate) use relax::given_memory::{relax_at_strength, relax_to_show};
pub(crate) use relax::relax_to_source::RelaxOptions;
pub use relax::relax_to_source::RelaxResult;
pub use report::{
    BakeReport, BakeResult, EarlyStop, SimulatedGarment, StageSeconds, StepConvergence, StopCause,
};
pub use run::checkpoint;
pub use run::checkpoint::{Checkpoint, fingerprint};
pub use run::from_motion::{GarmentMotion, memory_from_motion};
pub use run::observer::{BakeProgress, Observer};
