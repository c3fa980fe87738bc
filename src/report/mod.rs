//! What a run has to tell: the report file of a bake, and pictures.

pub mod render;
mod report_file;

pub use report_file::{CrossingCounts, EventCounts, ModelChoice, Report, StageTimes, crossing_counts};
