//! Sheets that fall on the ground on top of one another: layers that press layers.

use crate::chart::scenes::{Actors, Kind, Scene, Sheet, spaced};
use crate::error::Result;
use crate::math::{Vec2, Vec3};
use crate::sim::Loads;

const SIDE: f64 = 0.1;
const QUADS: usize = 6;
const THICKNESS: f64 = 1e-3;

/// The scene.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Stack {
    /// How many sheets.
    pub layers: usize,
}

impl Stack {
    /// Heights of the sheets, lowest first: mean over the points of each [m].
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

    fn begin(&self) -> Result<Actors> {
        let one = Sheet::strip(&spaced(-0.5 * SIDE, 0.5 * SIDE, QUADS), SIDE, QUADS);
        let count = one.flat.len();
        // Beside one another in the material, above one another in space; a little turned, so that edges meet edges.
        let flat = (0..self.layers)
            .flat_map(|k| one.flat.iter().map(move |p| p + Vec2::new(2.0 * SIDE * k as f64, 0.0)));
        let sheet = Sheet {
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
        let kind = Kind { density: 0.2, stretch: 120.0, bend: 1e-5, damping: [0.002, 0.02] };
        let cloth = kind.cloth(&sheet, &garment);
        let contact = kind.contact(&garment, &cloth, THICKNESS, 0.3, self.layers as f64);
        Ok(Actors::new(garment, cloth, contact))
    }

    fn drive(&self, _t: f64, _x: &[Vec3]) -> Loads {
        Loads { drag: 2.0, ..Loads::gravity_only(Some(0.0)) }
    }
}
