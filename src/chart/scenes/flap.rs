//! A flap that is folded by 160 degrees, held and let go: what is baked, in small.
//!
//! A strip of 40 x 15 mm of KOW's T-shirt, half of it held; its free end is led over in half a second, held for two, and
//! let go for one, without weight, in still air. Events of memory happen at their own times on the way, so that rest angles
//! say how well a method follows angles in time.

use crate::chart::scenes::{Actors, Kind, Scene, Sheet, smoothstep, spaced};
use crate::contact::Contact;
use crate::energy::TargetSpring;
use crate::error::Result;
use crate::fabric::{DEFAULT_FABRIC, Fabric};
use crate::math::Vec3;
use crate::memory::MemoryModel;
use crate::sim::Loads;

/// Length and width [m], quads along and across.
const STRIP: (f64, f64, usize, usize) = (0.040, 0.015, 16, 6);
/// Fold [rad].
const FOLD: f64 = 160.0 / 180.0 * std::f64::consts::PI;
/// Ends of fold, hold and release [s].
const TIMES: [f64; 3] = [0.5, 2.5, 3.5];
/// Stiffness of the hand per point [N/m].
const HAND: f64 = 5.0;

/// The scene.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Flap;

impl Flap {
    fn sheet() -> Sheet {
        Sheet::strip(&spaced(-0.5 * STRIP.0, 0.5 * STRIP.0, STRIP.2), STRIP.1, STRIP.3)
    }
}

impl Scene for Flap {
    fn name(&self) -> &'static str {
        "fold-hold-release"
    }

    fn until(&self) -> f64 {
        TIMES[2]
    }

    fn size(&self) -> f64 {
        STRIP.0
    }

    fn breaks(&self) -> Vec<f64> {
        TIMES[..2].into()
    }

    fn begin(&self) -> Result<Actors> {
        let fabric = Fabric::preset(DEFAULT_FABRIC)?;
        let sheet = Self::sheet();
        let garment = sheet.flat_garment();
        let kind = Kind {
            density: fabric.area_density(),
            stretch: 100.0,
            bend: fabric.bend_mean(),
            damping: [fabric.stretch_damping_s, fabric.bend_damping_s],
        };
        let cloth = kind.cloth(&sheet, &garment);
        let law = MemoryModel::new(&garment, &fabric, cloth.bending.width());
        let contact = Contact::none(garment.points.len());
        Ok(Actors { law: Some(law), ..Actors::new(garment, cloth, contact) })
    }

    fn drive(&self, t: f64, _x: &[Vec3]) -> Loads {
        let sheet = Self::sheet();
        let held = sheet.flat.iter().map(|p| p.x < 1e-9 - 0.1 * STRIP.0).collect();
        let angle = FOLD * smoothstep(t, 0.0, TIMES[0]);
        let led = |(i, p): (usize, &crate::math::Vec2)| {
            let target = Vec3::new(p.x * angle.cos(), p.x * angle.sin(), -p.y);
            (p.x > 0.42 * STRIP.0).then(|| TargetSpring::isotropic(i as u32, target, HAND))
        };
        let guides = if t <= TIMES[1] + 1e-9 {
            sheet.flat.iter().enumerate().filter_map(led).collect()
        } else {
            Vec::new()
        };
        Loads { fixed: held, springs: guides, gravity: Vec3::zeros(), drag: 1.0, ..Loads::gravity_only(None) }
    }
}
