//! Sheets that fall on the ground on top of one another: contact between many layers.

use crate::scenes::scene::{ClothMaterial, Scene, SceneState, spaced};
use crate::test_sheet::TestSheet;
use crease_geometry::math::{Vec2, Vec3};
use crease_model::error::Result;
use crease_solver::sim::Loads;

/// Side of a sheet [m].
const SIDE: f64 = 0.1;
/// Quads along a side.
const QUADS: usize = 6;
/// Activation distance of contact [m].
const THICKNESS: f64 = 1e-3;

/// The stack of sheets.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Stack {
    /// Number of sheets.
    pub layers: usize,
}

impl Stack {
    /// Mean heights of the sheets at `x` [m], lowest first [m].
    pub fn heights(&self, x: &[Vec3]) -> Vec<f64> {
        let each = (QUADS + 1).pow(2);
        x.chunks(each).map(|sheet| sheet.iter().map(|x| x.y).sum::<f64>() / each as f64).collect()
    }
}

impl Scene for Stack {
    fn name(&self) -> &'static str {
        "layers"
    }

    fn until(&self) -> f64 {
        1.0
    }

    fn size(&self) -> f64 {
        SIDE
    }

    fn initial_state(&self) -> Result<SceneState> {
        let one = TestSheet::strip(&spaced(-0.5 * SIDE, 0.5 * SIDE, QUADS), SIDE, QUADS);
        let count = one.flat.len();
        // Side by side in the material plane, above one another in space; slightly rotated, so that edges meet edges.
        let flat = (0..self.layers)
            .flat_map(|k| one.flat.iter().map(move |p| p + Vec2::new(2.0 * SIDE * k as f64, 0.0)));
        let sheet = TestSheet {
            flat: flat.collect(),
            triangles: (0..self.layers)
                .flat_map(|k| one.triangles.iter().map(move |t| t.map(|p| p + (k * count) as u32)))
                .collect(),
        };
        let points = (0..self.layers).flat_map(|k| {
            let (sin, cos) = (0.1 * k as f64).sin_cos();
            let height = 2.0 * THICKNESS * (k + 1) as f64;
            one.flat.iter().map(move |p| Vec3::new(cos * p.x - sin * p.y, height, sin * p.x + cos * p.y))
        });
        let garment = sheet.garment(points.collect());
        let material = ClothMaterial {
            density: 0.2,
            stretch: 120.0,
            bend: 1e-5,
            stretch_damping: 0.002,
            bend_damping: 0.02,
        };
        let cloth = material.cloth(&sheet, &garment);
        let contact = material.contact(&garment, &cloth, THICKNESS, 0.3, self.layers as f64);
        Ok(SceneState::new(garment, cloth, contact))
    }

    fn loads(&self, _t: f64, _x: &[Vec3]) -> Loads {
        Loads { drag: 2.0, ..Loads::gravity_only(Some(0.0)) }
    }
}
