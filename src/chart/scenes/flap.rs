//! A flap that is folded by 160 degrees, held and released: a bake in miniature.
//!
//! A strip of 40 x 15 mm of KOW's T-shirt, half of it fixed; its free end is guided over within half a second, held
//! for two, and released for one, without gravity, in still air. Memory events depend on the history of the angles,
//! so that rest angles show how accurately an integrator follows the angles in time.

use crate::scenes::scene::{ClothMaterial, Scene, SceneState, smoothstep, spaced};
use crate::test_sheet::TestSheet;
use crease_geometry::math::Vec3;
use crease_model::error::Result;
use crease_model::fabric::{Fabric, PAPER_FABRIC};
use crease_solver::contact::Contact;
use crease_solver::energy::TargetSpring;
use crease_solver::memory::MemoryModel;
use crease_solver::sim::Loads;

/// Length of the strip [m].
const LENGTH: f64 = 0.040;
/// Width of the strip [m].
const WIDTH: f64 = 0.015;
/// Quads along the strip.
const QUADS_ALONG: usize = 16;
/// Quads across the strip.
const QUADS_ACROSS: usize = 6;
/// Fold angle [rad].
const FOLD_ANGLE: f64 = 160.0 / 180.0 * std::f64::consts::PI;
/// End of the fold [s].
const FOLD_END: f64 = 0.5;
/// End of the hold [s].
const HOLD_END: f64 = 2.5;
/// End of the scene [s].
const UNTIL: f64 = 3.5;
/// Stiffness of the target spring of each guided point [N/m].
const SPRING_STIFFNESS: f64 = 5.0;
/// Part of the strip that is guided, from its middle, over its length [-].
const GUIDED_FROM: f64 = 0.42;
/// Part of the strip that is fixed, up to its middle, over its length [-].
const FIXED_UP_TO: f64 = 0.1;

/// The folded, held and released flap.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Flap;

impl Flap {
    fn sheet() -> TestSheet {
        TestSheet::strip(&spaced(-0.5 * LENGTH, 0.5 * LENGTH, QUADS_ALONG), WIDTH, QUADS_ACROSS)
    }
}

impl Scene for Flap {
    fn name(&self) -> &'static str {
        "fold-hold-release"
    }

    fn until(&self) -> f64 {
        UNTIL
    }

    fn size(&self) -> f64 {
        LENGTH
    }

    fn event_times(&self) -> Vec<f64> {
        vec![FOLD_END, HOLD_END]
    }

    fn initial_state(&self) -> Result<SceneState> {
        let fabric = Fabric::preset(PAPER_FABRIC)?;
        let sheet = Self::sheet();
        let garment = sheet.flat_garment();
        let material = ClothMaterial {
            density: fabric.area_density(),
            stretch: 100.0,
            bend: fabric.bend_mean(),
            stretch_damping: fabric.stretch_damping_s,
            bend_damping: fabric.bend_damping_s,
        };
        let cloth = material.cloth(&sheet, &garment);
        let law =
            MemoryModel::new(&garment, &fabric, cloth.bending.width(), fabric.memory.reference_length());
        let contact = Contact::none(garment.points.len());
        Ok(SceneState { law: Some(law), ..SceneState::new(garment, cloth, contact) })
    }

    fn loads(&self, t: f64, _x: &[Vec3]) -> Loads {
        let sheet = Self::sheet();
        let fixed = sheet.flat.iter().map(|p| p.x < 1e-9 - FIXED_UP_TO * LENGTH).collect();
        let angle = FOLD_ANGLE * smoothstep(t, 0.0, FOLD_END);
        let spring = |(i, p): (usize, &crease_geometry::math::Vec2)| {
            let target = Vec3::new(p.x * angle.cos(), p.x * angle.sin(), -p.y);
            (p.x > GUIDED_FROM * LENGTH).then(|| TargetSpring::isotropic(i as u32, target, SPRING_STIFFNESS))
        };
        let springs = if t <= HOLD_END + 1e-9 {
            sheet.flat.iter().enumerate().filter_map(spring).collect()
        } else {
            Vec::new()
        };
        Loads { fixed, springs, gravity: Vec3::zeros(), drag: 1.0, ..Loads::gravity_only(None) }
    }
}
