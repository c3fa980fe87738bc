//! The body under the cloth during a bake.
//!
//! `active_region`, `creases` and `start` say before the run which points and lines a moving body asks for and where it begins.
//! `coupling` moves the body with the steps; `static_contact` is its contact where it does not move. `penetration`, `watch` and
//! `depenetration` judge and mend a garment that began or ended inside it. `leash` and `held_points` hold a garment that is skinned
//! in its file.

pub(super) mod active_region;
pub(super) mod coupling;
pub(super) mod creases;
pub(super) mod depenetration;
pub(super) mod held_points;
pub(super) mod leash;
pub(super) mod penetration;
pub(super) mod start;
pub(super) mod static_contact;
pub(super) mod watch;
