//! The edge length that the wear asks for at a point: short at the lines that crease, growing away from them.

use crate::remesh::tuning::TUNING;
use crease_geometry::math::Vec3;
use rustc_hash::{FxHashMap, FxHashSet};

/// A stretch of a curve at which edges are short.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Seed {
    /// Its position [m].
    pub position: Vec3,
    /// Edge length there [m].
    pub length: f64,
}

/// Edge lengths over a surface.
#[derive(Debug, Clone)]
pub struct SizeField {
    cells: FxHashMap<[i32; 3], Vec<Seed>>,
    cell: f64,
    growth: f64,
    flat: f64,
    max: f64,
}

impl Seed {
    /// Seeds of `length` [m] along the edge from `a` to `b`.
    pub fn along(a: Vec3, b: Vec3, length: f64) -> impl Iterator<Item = Self> {
        let count = ((b - a).norm() / (TUNING.seed_spacing * length)).ceil().max(1.0);
        (0..=count as usize).map(move |k| {
            let t = k as f64 / count;
            Self { position: a * (1.0 - t) + b * t, length }
        })
    }
}

impl SizeField {
    /// Edges of the length of the nearest seed within `flat` [m] of it, longer by `growth` for every metre farther away, never
    /// longer than `max` [m].
    pub fn new(seeds: &[Seed], flat: f64, growth: f64, max: f64) -> Self {
        let shortest = seeds.iter().map(|s| s.length).fold(max, f64::min);
        let cell = (flat + (max - shortest) / growth).max(1e-6);
        let mut field = Self { cells: FxHashMap::default(), cell, growth, flat, max };
        // One seed of a length per cell of its spacing is enough.
        let mut seen: FxHashSet<([i64; 3], u64)> = FxHashSet::default();
        for seed in seeds {
            let step = TUNING.seed_spacing * seed.length;
            let key = [seed.position.x, seed.position.y, seed.position.z].map(|c| (c / step).round() as i64);
            if seen.insert((key, seed.length.to_bits())) {
                field.cells.entry(field.cell_of(&seed.position)).or_default().push(*seed);
            }
        }
        field
    }

    fn cell_of(&self, x: &Vec3) -> [i32; 3] {
        [x.x, x.y, x.z].map(|c| (c / self.cell).floor() as i32)
    }

    /// Edge length at `x` [m].
    pub fn at(&self, x: &Vec3) -> f64 {
        let [i, j, k] = self.cell_of(x);
        let mut length = self.max;
        for cell in
            (-1..=1).flat_map(|a| (-1..=1).flat_map(move |b| (-1..=1).map(move |c| [i + a, j + b, k + c])))
        {
            for seed in self.cells.get(&cell).into_iter().flatten() {
                let beyond = ((x - seed.position).norm() - self.flat).max(0.0);
                length = length.min(seed.length + self.growth * beyond);
            }
        }
        length
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lengths_grow_away_from_the_nearest_seed() {
        let seeds =
            [Seed { position: Vec3::zeros(), length: 0.01 }, Seed { position: Vec3::x(), length: 0.005 }];
        let field = SizeField::new(&seeds, 0.02, 0.5, 0.03);
        for (x, expected) in [(0.0, 0.01), (0.019, 0.01), (0.03, 0.015), (0.5, 0.03), (1.03, 0.01)] {
            assert!((field.at(&Vec3::new(x, 0.0, 0.0)) - expected).abs() < 1e-12, "{x}");
        }
        assert_eq!(SizeField::new(&[], 0.02, 0.5, 0.03).at(&Vec3::zeros()), 0.03);
    }

    /// Cells of seeds are as large as their lengths ask for, so that those of two lengths have the same number in different places.
    #[test]
    fn seeds_of_one_length_leave_those_of_another() {
        let seed = |x: f64, length: f64| Seed { position: Vec3::new(x, 0.0, 0.0), length };
        let field = SizeField::new(&[seed(0.1, 0.008), seed(0.15, 0.012)], 0.0, 1.0, 0.04);
        assert_eq!(field.at(&Vec3::new(0.15, 0.0, 0.0)), 0.012);
    }
}
