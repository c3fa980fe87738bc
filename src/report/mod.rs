//! What a run has to tell: the report file of a bake, and pictures.

mod portrait;
pub mod render;
mod report_file;

pub use portrait::{PointMemory, Portrait, Show};
pub use report_file::{CrossingCounts, EventCounts, ModelChoice, Report, StageTimes, crossing_counts};
