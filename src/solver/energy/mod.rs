//! Energy terms of the cloth, one file each: value [J], gradient [N] and Hessian [N/m] over the points of the mesh.
//!
//! Terms work on plain arrays of points; files, threads and time integration are outside their scope, and the rest
//! state is read-only. Every Hessian is positive semi-definite (projected analytically or Gauss-Newton), so that a
//! Newton direction is a descent direction. A new term is one file here; its unit tests call the shared checks of
//! `energy_checks` (finite differences, rigid motion, eigenvalues).

mod bending;
mod drag;
mod edge_contact;
#[cfg(test)]
pub(crate) mod energy_checks;
mod even_tether;
mod gravity;
mod junction;
mod leash;
mod membrane;
mod plane_contact;
mod pose_tether;
mod pressure;
mod shrinking_sphere;
mod target_spring;
mod term;
mod tuning;

pub use bending::{Bending, BendingTerm};
pub use drag::Drag;
pub use edge_contact::{EdgeContact, EdgeContacts};
pub use even_tether::EvenTether;
pub use gravity::Gravity;
pub use junction::Junctions;
pub use leash::{Leash, Leashes};
pub use membrane::{Membrane, MembraneTerm};
pub use plane_contact::{PlaneContact, PlaneContacts};
pub use pose_tether::PoseTether;
pub use pressure::Pressure;
pub use shrinking_sphere::ShrinkingSphere;
pub use target_spring::{TargetSpring, TargetSprings};
pub use term::Energy;
pub(crate) use term::RestrictedTerms;
