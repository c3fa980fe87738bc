//! Wear simulation for garment meshes: a script of folds, presses or body motion is run through an implicit cloth solver
//! whose rest angles, rest lengths and stiffness adapt with use, and the wrinkles are baked into the mesh.
//!
//! The memory law is that of Kim, Oh, Wohn, "Persistent Wrinkles and Folds of Clothes". Contact is intersection-free, results
//! are bit-identical for any number of threads, and glTF files keep everything that is not the garment's shape.
//!
//! ```no_run
//! use crease::{Bake, Fabric, GarmentFile, Load, Quality, ReadOptions, Save, WearScript};
//! let shirt = GarmentFile::load("shirt.glb", &ReadOptions::default())?;
//! let (fabric, script) = (Fabric::preset("denim")?, WearScript::load("fold-thrice.json")?);
//! let result = Bake::new(&shirt.garment, &fabric, &script).quality(Quality::Draft).run()?;
//! shirt.save_glb(&result.worn, "worn.glb")?;
//! shirt.sidecar(&result.worn, &fabric, &script)?.save("worn.crease.json")?;
//! # Ok::<(), crease::Error>(())
//! ```
//!
//! The same in memory, on a generated sheet that is folded once, held and opened:
//!
//! ```
//! use crease::{Bake, Fabric, GarmentFile, Quality, WearScript};
//! let sheet = GarmentFile::sheet([0.2, 0.2], [4, 4])?;
//! let script = WearScript::parse("fold.json", r#"{"format": "crease-wear/1", "actions": [
//!     {"lay": {"facing": "front", "over": 0.2}},
//!     {"fold": {"line": [[0.5, 0], [0.5, 1]], "side": "left", "over": 0.5, "hold": 3}},
//!     {"unfold": {"all": true, "over": 0.5}}]}"#)?;
//! let fabric = Fabric::preset("kow-tshirt")?;
//! let result = Bake::new(&sheet.garment, &fabric, &script).quality(Quality::Draft).run()?;
//! assert!(result.report.events.critical > 0);
//! let glb = sheet.to_glb_bytes(&result.worn)?;
//! assert!(glb.starts_with(b"glTF"));
//! # Ok::<(), crease::Error>(())
//! ```
//!
//! | you want to | start at |
//! |---|---|
//! | bake a script | [`Bake`], [`WearScript`], [`Fabric`] |
//! | load a garment and save the worn one | [`GarmentFile`] |
//! | make a garment from positions and triangles | [`GarmentFile::from_mesh`], [`MeshOptions`] |
//! | watch a bake, stop and resume it | [`Observer`], [`Checkpoint`] |
//! | put the garment on an animated body | [`AnimatedBody`], [`Bake::body`] |
//! | make wrinkles from an existing animation | [`memory_from_motion`] |
//! | transfer wrinkles to another garment | [`Transfer`] |
//! | read or write the memory in full precision | [`Sidecar`], [`RestState`] |
//! | apply the memory law in your own simulator | [`law::MemoryModel`], or [`law::MemoryLaw`] for one hinge |
//! | check a mesh before a bake | [`inspect()`] |
//! | draw a picture of a worn garment | [`picture`] |
//!
//! # Pipeline
//!
//! ```text
//! .glb .gltf .obj .usd --io--> SourceAsset --garment--> Garment   (welded points, hinges, material coordinates)
//! crease-wear/1   --wear--> WearScript                       (actions: lay, fold, press, bend, ...)
//! crease-fabric/1 --fabric--> Fabric                         (stiffnesses, friction, numbers of the memory law)
//!
//! bake, phase 1: per step   wear: loads  ->  sim: Newton on energies and contact  ->  memory: rest state
//! bake, phase 2:            relaxation to the source pose with that rest state  ->  WornGarment
//!
//! WornGarment --io--> .glb with morph target and attributes, sidecar .crease.json, report
//! Sidecar + another Garment --transfer--> RestState --bake::relax--> WornGarment
//! ```
//!
//! # Conventions
//!
//! SI units: \[m\], \[s\], \[kg\], \[N\]; angles in \[rad\], 0 for flat. y is up. A *point* belongs to the simulation (welded at
//! seams), a *vertex* to the file. A *hinge* is an interior edge with its two triangles; warp is +u, weft +v of the texture
//! coordinates. Every error of an input names the file, the location in it, the problem, and how to fix it ([`Diagnostic`]).
//!
//! # Features
//!
//! `render` (pictures), `viewer` (viewer page) and `usd` (garments and bodies from USD files): all on by default; the library
//! compiles without any. The tool is the package `crease-cli`, the validation charts are `crease-chart`.

mod bake;
mod files;
mod job;
mod report;
mod transfer;
mod wear;

/// Modules for the tools and tests of this workspace; no part of the stable interface.
#[doc(hidden)]
pub mod internal {
    /// Bakes.
    pub mod bake {
        pub use crate::bake::*;
    }
    /// Files by path.
    pub mod files {
        pub use crate::files::*;
    }
    /// Jobs, from sources to outputs.
    pub mod job {
        pub use crate::job::*;
    }
    /// Reports, pictures and pages.
    pub mod report {
        pub use crate::report::*;
    }
    /// Transfers.
    pub mod transfer {
        pub use crate::transfer::*;
    }
    /// Wear scripts and their actions.
    pub mod wear {
        pub use crate::wear::*;
    }
}

/// The memory law, to be used in another simulator: for a mesh, or hinge by hinge.
pub mod law {
    pub use crease_solver::memory::{
        Band, BandParams, ElementParams, EventCount, HysteresisState, Memory, MemoryLaw, MemoryModel,
        Softening, Strains,
    };
}

/// Meshes: topology, angles of hinges, exact intersections.
pub mod mesh {
    pub use crease_geometry::math::{Mat3, Mat4};
    pub use crease_geometry::mesh::intersections::self_intersections;
    pub use crease_geometry::mesh::{
        Hinge, PointIndex, Topology, VertexIndex, hinge_angle, hinge_gradient, unwrap_angle,
    };
    pub use crease_model::garment::RefinedMesh;
}

/// Bodies that wear the garment, and the skin of a garment that is bound to one.
pub mod body {
    pub use crease_io::{read_body, read_body_frames, read_garment_skin};
    pub use crease_model::body::{BodyMotion, BodyPose, GarmentSkin, Sequence};
}

/// Fabrics: what their numbers are and where they come from.
pub mod fabric {
    pub use crease_model::fabric::{DEFAULT_FABRIC, FabricMemory, PAPER_FABRIC, Provenance};
}

/// Files as bytes: meshes, sidecars, landmarks, and files for other programs.
pub mod format {
    pub use crate::files::ready_memory_names;
    pub use crease_io::gltf::{read_worn, write_worn_glb};
    pub use crease_io::{Landmark, Landmarks, read_asset, read_sidecar, write_sidecar};
    pub use crease_model::garment::{ImportDiagnostic, Severity, SourceAsset, SourcePiece};
}

/// What a transfer is made of: sources, alignment, losses.
pub mod carry {
    pub use crate::transfer::{
        AlignedBy, DrawnCreases, MeshMaker, PointPair, RegionConfidence, SourceOutcome, TransferLosses,
        TransferSource,
    };
    pub use crease_model::remesh::{Channels, GarmentSurface};
}

/// Words of a front end for the settings and operations that messages name.
pub mod wording {
    pub use crease_model::error::{Operation, Setting, SettingValue, Vocabulary};
}

/// Settings of the solver.
pub mod solver {
    pub use crease_solver::sim::{Method, NewtonOptions, Sewing, StepOptions, StepRelaxation};
}

/// Pictures and pages of worn garments.
pub mod picture {
    pub use crate::report::swatch_page;
    #[cfg(feature = "render")]
    pub use crate::report::{
        ColorBy, GarmentView,
        render::{Camera, Colouring, Image, encode_png, render},
    };
    #[cfg(feature = "viewer")]
    pub use crate::report::{ViewerItem, viewer_page};
}

#[doc(inline)]
pub use bake::{
    Bake, BakeOptions, BakeProgress, BakeReport, BakeResult, Checkpoint, GarmentMotion, ModelDecision,
    ModelPlan, Observer, Quality, RelaxResult, memory_from_motion, relax,
};
#[doc(inline)]
pub use crease_geometry::math::{Vec2, Vec3};
#[doc(inline)]
pub use crease_io::{ReadOptions, Sidecar};
#[doc(inline)]
pub use crease_model::body::AnimatedBody;
#[doc(inline)]
pub use crease_model::error::{Diagnostic, Error, Message, Result};
#[doc(inline)]
pub use crease_model::fabric::Fabric;
#[doc(inline)]
pub use crease_model::garment::{Garment, Inspection, MeshOptions, RestState, UpAxis, WornGarment, inspect};
#[doc(inline)]
pub use files::{GarmentFile, Load, Save, load_body, ready_memory, transfer_source};
#[doc(inline)]
pub use report::{Export, Report};
#[doc(inline)]
pub use transfer::{Align, MatchBy, Transfer, TransferResult};
#[doc(inline)]
pub use wear::{Action, WearScript};
