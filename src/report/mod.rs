//! Results in readable form: report files, pictures, the viewer page, fabric swatches, and files for other programs.

mod detail_report;
mod export;
mod fine_report;
#[cfg(feature = "render")]
mod focus;
#[cfg(feature = "render")]
mod garment_view;
mod html;
#[cfg(feature = "render")]
pub mod render;
mod report_file;
mod swatch;
mod transfer_report;
#[cfg(feature = "viewer")]
mod viewer;
#[cfg(feature = "render")]
mod worn_view;

pub use detail_report::DetailReport;
pub use export::{Export, ExportCheck, ExportFile};
pub use fine_report::{FineReport, WrittenFile};
#[cfg(feature = "render")]
pub use garment_view::{ColorBy, GarmentView, PointMemory, own_triangles_message};
pub use html::escaped;
pub use report_file::{
    CrossingCounts, EventCounts, ModelChoice, Report, ShownReport, StageTimes, crossing_counts,
    source_crossings,
};
pub use swatch::{overhang, swatch_page};
pub use transfer_report::{CarriedSource, TransferReport};
#[cfg(feature = "viewer")]
pub use viewer::{HingeLabel, ViewerItem, ViewerPiece, viewer_page};
#[cfg(feature = "render")]
pub use worn_view::{WornView, fine_worn_glb};
