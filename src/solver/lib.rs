//! The cloth solver: energies with gradients and Hessians (`energy`), contact and friction (`contact`), the memory law and its
//! state (`memory`), and one time step (`sim`). Energies read the rest state; only `memory` writes it.
//!
//! A crate of the workspace of `crease`; its interface follows the needs of that library.

#![warn(missing_docs)]
// Units are written [m], [s], [rad] in doc comments: rustdoc would take each for a link.
#![allow(rustdoc::broken_intra_doc_links)]

pub mod contact;
pub mod energy;
pub mod memory;
pub mod sim;
