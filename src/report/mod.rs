//! What a run has to tell: the report file of a bake, and pictures.

mod also;
mod portrait;
pub mod render;
mod report_file;
mod transfer_report;

pub use also::{Also, AlsoFile, AlsoReport};
pub use portrait::{PointMemory, Portrait, Show};
pub use report_file::{CrossingCounts, EventCounts, ModelChoice, Report, StageTimes, crossing_counts};
pub use transfer_report::{CarriedSource, TransferReport};
