//! How high things lie: the height field that a flap is laid over.
//!
//! A stack of folded cloth is not a plane: older folds bulge at their edges. Hands do not ram a flap into such a
//! bulge, they lay it over; so `fold` raises every column of the flap by what lies under the place where it lands.

use crate::math::Vec3;
use std::collections::BTreeMap;

/// Width of a cell [m].
const CELL: f64 = 0.01;
/// A point makes this many cells around its own as high as it is: meshes have no points between their points.
const SPREAD: i32 = 2;
/// Heights are averaged over this many cells on each side: the flap must not get steps.
const SMOOTH: i32 = 2;

/// Greatest heights over the ground plane, on cells of equal width.
#[derive(Debug, Clone, Default)]
pub(super) struct HeightField {
    top: BTreeMap<[i32; 2], f64>,
}

impl HeightField {
    /// The field over `points` [m], y up.
    pub fn over(points: impl Iterator<Item = Vec3>) -> Self {
        let mut own: BTreeMap<[i32; 2], f64> = BTreeMap::new();
        for p in points {
            let top = own.entry(cell(&p)).or_insert(f64::NEG_INFINITY);
            *top = top.max(p.y);
        }
        let mut spread: BTreeMap<[i32; 2], f64> = BTreeMap::new();
        for (c, height) in own {
            for near in around(c, SPREAD) {
                let top = spread.entry(near).or_insert(f64::NEG_INFINITY);
                *top = top.max(height);
            }
        }
        Self { top: spread }
    }

    /// How far the field rises above `level` at a place [m], averaged over the cells around it.
    pub fn rise(&self, place: &Vec3, level: f64) -> f64 {
        let cells = around(cell(place), SMOOTH);
        let sum: f64 =
            cells.clone().map(|c| self.top.get(&c).map_or(0.0, |top| (top - level).max(0.0))).sum();
        sum / cells.count() as f64
    }
}

fn cell(p: &Vec3) -> [i32; 2] {
    // A garment is at most some metres wide; what is not finite ends in one cell.
    [(p.x / CELL).floor() as i32, (p.z / CELL).floor() as i32]
}

fn around(c: [i32; 2], reach: i32) -> impl Iterator<Item = [i32; 2]> + Clone {
    (-reach..=reach)
        .flat_map(move |i| (-reach..=reach).map(move |k| [c[0].saturating_add(i), c[1].saturating_add(k)]))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_bulge_is_felt_around_it_and_nowhere_else() {
        let field = HeightField::over([Vec3::new(0.005, 0.03, 0.005)].into_iter());
        let at = |x: f64| field.rise(&Vec3::new(x, 0.0, 0.005), 0.01);
        assert!((at(0.005) - 0.02).abs() < 1e-12);
        assert!(at(0.025) > 0.009 && at(0.025) < 0.02);
        assert_eq!(at(0.08), 0.0);
    }
}
