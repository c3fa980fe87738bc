//! What a run has to tell: the report file of a bake, pictures, the viewer page.

mod detail_report;
mod export;
mod garment_view;
pub mod render;
mod report_file;
mod swatch;
mod transfer_report;
mod viewer;

pub use detail_report::DetailReport;
pub use export::{Export, ExportCheck, ExportFile};
pub use garment_view::{ColorBy, GarmentView, PointMemory};
pub use report_file::{CrossingCounts, EventCounts, ModelChoice, Report, StageTimes, crossing_counts};
pub use swatch::{overhang, swatch_page};
pub use transfer_report::{CarriedSource, TransferReport};
pub use viewer::{HingeLabel, ViewerItem, escaped, viewer_page};
