//! What a run has to tell: the report file of a bake, and pictures.

mod portrait;
pub mod render;
mod report_file;
mod transfer_report;

pub use portrait::{PointMemory, Portrait, Show};
pub use report_file::{CrossingCounts, EventCounts, ModelChoice, Report, StageTimes, crossing_counts};
pub use transfer_report::{AlsoReport, CarriedSource, TransferReport};
