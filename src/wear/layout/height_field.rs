//! Height field under a flap.
//!
//! A stack of folded cloth is not a plane: older folds bulge at their edges. A flap is not pressed into such a bulge but
//! laid over it: `fold` raises every column of the flap by the height of what lies under its final position.

use crate::wear::tuning::TUNING;
use crease_geometry::math::Vec3;
use std::collections::BTreeMap;

/// Largest heights over the ground plane, on square cells.
#[derive(Debug, Clone, Default)]
pub(crate) struct HeightField {
    /// Height by cell [m].
    heights: BTreeMap<[i32; 2], f64>,
}

impl HeightField {
    /// The field over `points` [m], y up.
    pub fn over(points: impl Iterator<Item = Vec3>) -> Self {
        let mut own: BTreeMap<[i32; 2], f64> = BTreeMap::new();
        for p in points {
            let height = own.entry(cell_of(&p)).or_insert(f64::NEG_INFINITY);
            *height = height.max(p.y);
        }
        let mut heights: BTreeMap<[i32; 2], f64> = BTreeMap::new();
        for (cell, own_height) in own {
            for near in neighbourhood(cell, TUNING.height_field.dilation) {
                let height = heights.entry(near).or_insert(f64::NEG_INFINITY);
                *height = height.max(own_height);
            }
        }
        Self { heights }
    }

    /// Height of the field above `level` at a position [m], averaged over the cells around it.
    pub fn rise(&self, position: &Vec3, level: f64) -> f64 {
        let cells = neighbourhood(cell_of(position), TUNING.height_field.smoothing);
        let sum: f64 = cells
            .clone()
            .map(|cell| self.heights.get(&cell).map_or(0.0, |height| (height - level).max(0.0)))
            .sum();
        sum / cells.count() as f64
    }
}

fn cell_of(p: &Vec3) -> [i32; 2] {
    // A garment is at most some metres wide; positions that are not finite fall into one cell.
    [(p.x / TUNING.height_field.cell).floor() as i32, (p.z / TUNING.height_field.cell).floor() as i32]
}

/// The cells up to `radius` cells away from `cell` in each direction, itself included.
fn neighbourhood(cell: [i32; 2], radius: i32) -> impl Iterator<Item = [i32; 2]> + Clone {
    (-radius..=radius).flat_map(move |i| {
        (-radius..=radius).map(move |k| [cell[0].saturating_add(i), cell[1].saturating_add(k)])
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_bulge_raises_its_surroundings_and_nothing_else() {
        let field = HeightField::over([Vec3::new(0.005, 0.03, 0.005)].into_iter());
        let at = |x: f64| field.rise(&Vec3::new(x, 0.0, 0.005), 0.01);
        assert!((at(0.005) - 0.02).abs() < 1e-12);
        assert!(at(0.025) > 0.009 && at(0.025) < 0.02);
        assert_eq!(at(0.08), 0.0);
    }
}
