//! crease: garments that remember how they were worn.
//!
//! A garment mesh comes in, a wear script is run through a cloth solver whose rest angles, rest lengths and
//! stiffness change with use (Kim, Oh, Wohn, "Persistent Wrinkles and Folds of Clothes", below: KOW), and the
//! garment goes out with its wrinkles baked. The modules stand in the order data flows through them; a module
//! uses its own folder and the ones above it, never one below (`docs/architecture.md`).

#![warn(missing_docs)]
// Units are written [m], [s], [rad] all over: rustdoc would take each for a link.
#![allow(rustdoc::broken_intra_doc_links)]

pub mod error;
pub mod json;
pub mod math;

pub mod fabric;
pub mod mesh;

pub mod body;
pub mod garment;

pub mod energy;
pub mod io;
pub mod sim;
pub mod wear;

pub mod contact;

pub mod memory;

pub mod transfer;

pub mod bake;
pub mod report;

pub mod files;

#[cfg(feature = "charts")]
pub mod chart;

pub use error::{Diagnostic, Error, Result};

#[doc(inline)]
pub use bake::{
    Bake, BakeOptions, BakeProgress, BakeReport, BakeResult, Checkpoint, GarmentMotion, ModelPlan, Observer,
    Quality, RelaxResult, memory_from_motion, relax,
};
#[doc(inline)]
pub use fabric::{Fabric, FabricMemory};
#[doc(inline)]
pub use files::GarmentFile;
#[doc(inline)]
pub use garment::{Garment, RestState, WornGarment};
#[doc(inline)]
pub use io::{ReadOptions, Sidecar};
#[doc(inline)]
pub use memory::{
    Band, BandParams, ElementParams, EventCount, HysteresisState, Memory, MemoryLaw, MemoryModel, Strains,
};
