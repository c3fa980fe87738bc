//! Jobs: a bake, a transfer, or the memory of a motion, from sources and options to outputs. The tool, the Python package and
//! other programs run them.
//!
//! | job | sources | computation |
//! |---|---|---|
//! | [`BakeJob`] | garment, wear script, fabric, body | [`crate::bake`] |
//! | [`TransferJob`] | sidecars, garment, fabric | [`crate::transfer`], then the relaxation |
//! | [`MotionJob`] | animated garment or frames, fabric | the memory law along the motion |
//!
//! A job checks that every output can be written, reads its sources, and computes. It reports to a [`JobObserver`] and prints
//! nothing. [`JobOutputs::write`] writes all files or none. A bake can be described between reading and computing.

mod bake_input;
mod bake_job;
mod body_source;
mod garment_source;
mod memory_source;
mod motion_job;
mod observer;
mod output_options;
mod outputs;
mod transfer_job;

pub use bake_input::{BakeSources, WearSource};
pub use bake_job::{BakeJob, BakeJobOptions};
pub use body_source::{BodyHold, BodyOptions};
pub use garment_source::{GarmentSource, ReadGarment};
pub use memory_source::MemorySource;
pub use motion_job::MotionJob;
pub use observer::{JobNotice, JobObserver, JobPhase};
pub use output_options::{DetailOptions, FrameOptions, OutputOptions, ShapeOptions, WornPaths};
pub use outputs::{JobOutputs, JobReport};
pub use transfer_job::TransferJob;
