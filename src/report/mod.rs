//! What a run has to tell: the report file of a bake, pictures, the viewer page.

mod also;
mod detail_report;
mod portrait;
pub mod render;
mod report_file;
mod swatch;
mod transfer_report;
mod viewer;

pub use also::{Also, AlsoFile, AlsoReport};
pub use detail_report::DetailReport;
pub use portrait::{PointMemory, Portrait, Show};
pub use report_file::{CrossingCounts, EventCounts, ModelChoice, Report, StageTimes, crossing_counts};
pub use swatch::{overhang, swatch_page};
pub use transfer_report::{CarriedSource, TransferReport};
pub use viewer::{Exhibit, HingeLabel, escaped, viewer_page};
