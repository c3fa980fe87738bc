//! What cloth is made of.

mod law;

pub use law::{Band, EventCount, Law, Trace, Zone};

/// Stub until the fabric branch lands.
pub struct Fabric;
#[allow(missing_docs)]
impl Fabric {
    pub fn stretch_warp(&self) -> f64 { 1000.0 }
    pub fn stretch_weft(&self) -> f64 { 1000.0 }
    pub fn shear(&self) -> f64 { 40.0 }
    pub fn bend_warp(&self) -> f64 { 1e-5 }
    pub fn bend_weft(&self) -> f64 { 1e-5 }
    pub fn stretch_damping(&self) -> f64 { 0.0 }
    pub fn bend_damping(&self) -> f64 { 0.0 }
}
