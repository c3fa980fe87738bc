//! The cloth solver: energies with gradients and Hessians (`energy`), contact and friction (`contact`), the memory law and its
//! state (`memory`), and one time step (`sim`). Energies read the rest state; only `memory` writes it.
//!
//! A crate of the workspace of `crease`; its interface follows the needs of that library.

pub mod contact;
pub mod energy;
pub mod memory;
pub mod sim;
