//! A patch of cloth that flies at a sheet held by its border: at 20 m/s it moves by 83 thicknesses in
//! a step of 1/240 s.

use crate::chart::scenes::{Actors, Kind, Scene, Sheet, spaced};
use crate::error::Result;
use crate::math::{Vec2, Vec3};
use crate::sim::Loads;

const SIDE: f64 = 0.1;
const QUADS: usize = 8;
const THICKNESS: f64 = 1e-3;
/// Quads of the patch, of half the size.
const PATCH: usize = 4;

/// The scene.
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

    /// Cloth that is hit hard is drawn out by physics: only what no cloth does is a failure.
    fn strain_bound(&self) -> f64 {
        2.0
    }

    fn begin(&self) -> Result<Actors> {
        let held = Sheet::strip(&spaced(-0.5 * SIDE, 0.5 * SIDE, QUADS), SIDE, QUADS);
        let patch = Sheet::strip(&spaced(-0.125 * SIDE, 0.125 * SIDE, PATCH), 0.25 * SIDE, PATCH);
        let count = held.flat.len() as u32;
        let shifted = patch.flat.iter().map(|p| p + Vec2::new(2.0 * SIDE, 0.0));
        let sheet = Sheet {
            flat: held.flat.iter().copied().chain(shifted).collect(),
            triangles: held
                .triangles
                .iter()
                .copied()
                .chain(patch.triangles.iter().map(|t| t.map(|p| p + count)))
                .collect(),
        };
        let low = held.flat.iter().map(|p| Vec3::new(p.x, 0.0, -p.y));
        // Askew, so that a corner comes first.
        let high = patch.flat.iter().map(|p| Vec3::new(p.x + 1e-3, 0.02 + 0.3 * p.x + 0.2 * p.y, -p.y));
        let garment = sheet.garment(low.chain(high).collect());
        let kind = Kind { density: 0.2, stretch: 500.0, bend: 1e-5, damping: [0.002, 0.02] };
        let cloth = kind.cloth(&sheet, &garment);
        let contact = kind.contact(&garment, &cloth, THICKNESS, 0.3, 4.0);
        let mut actors = Actors::new(garment, cloth, contact);
        actors.state.v.iter_mut().skip(count as usize).for_each(|v| *v = Vec3::new(0.0, -self.speed, 0.0));
        Ok(actors)
    }

    fn drive(&self, _t: f64, x: &[Vec3]) -> Loads {
        let border = |p: usize| {
            let (i, j) = (p / (QUADS + 1), p % (QUADS + 1));
            p < (QUADS + 1).pow(2) && (i == 0 || j == 0 || i == QUADS || j == QUADS)
        };
        let held = (0..x.len()).map(border).collect();
        Loads { fixed: held, drag: 0.0, gravity: Vec3::zeros(), ..Loads::gravity_only(None) }
    }
}
