//! What a run has to tell: for now the report file of a bake.

mod report_file;

pub use report_file::{EventCounts, ModelChoice, Report, StageTimes};
//! (see lib.rs)
pub mod render;
