//! A patch of cloth that hits a sheet fixed at its border: at 20 m/s it moves by 83 thicknesses in a step of 1/240 s.

use crate::scenes::scene::{ClothMaterial, Scene, SceneState, spaced};
use crate::test_sheet::TestSheet;
use crease_geometry::math::{Vec2, Vec3};
use crease_model::error::Result;
use crease_solver::sim::Loads;

/// Side of the sheet [m].
const SIDE: f64 = 0.1;
/// Quads along a side of the sheet.
const QUADS: usize = 8;
/// Activation distance of contact [m].
const THICKNESS: f64 = 1e-3;
/// Quads along a side of the patch, of half the size.
const PATCH_QUADS: usize = 4;
/// Largest strain by the impact itself [-].
const MAX_IMPACT_STRAIN: f64 = 2.0;

/// The flying patch.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Flight {
    /// Speed of approach [m/s].
    pub speed: f64,
}

impl Scene for Flight {
    fn name(&self) -> &'static str {
        "approach"
    }

    fn until(&self) -> f64 {
        0.05
    }

    fn size(&self) -> f64 {
        SIDE
    }

    /// The impact itself strains the cloth: only larger strains are a failure.
    fn max_strain(&self) -> f64 {
        MAX_IMPACT_STRAIN
    }

    fn initial_state(&self) -> Result<SceneState> {
        let target = TestSheet::strip(&spaced(-0.5 * SIDE, 0.5 * SIDE, QUADS), SIDE, QUADS);
        let patch =
            TestSheet::strip(&spaced(-0.125 * SIDE, 0.125 * SIDE, PATCH_QUADS), 0.25 * SIDE, PATCH_QUADS);
        let count = target.flat.len() as u32;
        let shifted = patch.flat.iter().map(|p| p + Vec2::new(2.0 * SIDE, 0.0));
        let sheet = TestSheet {
            flat: target.flat.iter().copied().chain(shifted).collect(),
            triangles: target
                .triangles
                .iter()
                .copied()
                .chain(patch.triangles.iter().map(|t| t.map(|p| p + count)))
                .collect(),
        };
        let low = target.flat.iter().map(|p| Vec3::new(p.x, 0.0, -p.y));
        // Tilted, so that a corner arrives first.
        let high = patch.flat.iter().map(|p| Vec3::new(p.x + 1e-3, 0.02 + 0.3 * p.x + 0.2 * p.y, -p.y));
        let garment = sheet.garment(low.chain(high).collect());
        let material = ClothMaterial {
            density: 0.2,
            stretch: 500.0,
            bend: 1e-5,
            stretch_damping: 0.002,
            bend_damping: 0.02,
        };
        let cloth = material.cloth(&sheet, &garment);
        let contact = material.contact(&garment, &cloth, THICKNESS, 0.3, 4.0);
        let mut scene_state = SceneState::new(garment, cloth, contact);
        scene_state
            .state
            .v
            .iter_mut()
            .skip(count as usize)
            .for_each(|v| *v = Vec3::new(0.0, -self.speed, 0.0));
        Ok(scene_state)
    }

    fn loads(&self, _t: f64, x: &[Vec3]) -> Loads {
        let border = |p: usize| {
            let (i, j) = (p / (QUADS + 1), p % (QUADS + 1));
            p < (QUADS + 1).pow(2) && (i == 0 || j == 0 || i == QUADS || j == QUADS)
        };
        let fixed = (0..x.len()).map(border).collect();
        Loads { fixed, drag: 0.0, gravity: Vec3::zeros(), ..Loads::gravity_only(None) }
    }
}
