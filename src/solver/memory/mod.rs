//! Memory: the change of rest angles, rest lengths and stiffness with use, after every accepted step.
//!
//! [`Memory::commit`] changes a [`crease_model::garment::RestState`] after an accepted step, and [`Memory::soften`] does where the cloth
//! is hot or wet; energies and the solver read it, and a rejected step never reaches it. The law itself, [`MemoryLaw`], is made from the numbers of a fabric. [`MemoryModel`] applies
//! it to every hinge (condition: angle beyond the rest angle, measured against a reference length on fine meshes) and, where
//! the fabric has length ratios, to both axes of every triangle (condition: strain beyond the rest stretch).
//!
//! An event changes the rest state at once, but enters the forces smoothly: energies read [`Memory::effective_rest`], which
//! follows [`Memory::rest`] with a time constant of a fifth of a second. Results and files hold `rest`.

mod bend_window;
mod garment_memory;
mod law;
mod model;
mod rest_smoothing;
mod softening;
mod tuning;

pub use garment_memory::Memory;
pub use law::{Band, BandParams, ElementParams, EventCount, HysteresisState, MemoryLaw};
pub use model::{MemoryModel, Strains};
pub use softening::Softening;
