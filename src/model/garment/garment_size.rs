//! Sizes, units and positions that a garment may have. A wrong unit is the most common error of garment meshes, and would still
//! run, with wrong results.

use crate::garment::tuning::TUNING;
use crease_geometry::math::Vec3;

/// Units that a mesh may be in, and their lengths \[m\].
pub const LENGTH_UNITS: [(&str, f64); 5] =
    [("m", 1.0), ("dm", 0.1), ("cm", 0.01), ("mm", 0.001), ("in", 0.0254)];

/// Plausibility of the size of a garment.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum GarmentSize {
    /// Size that many garments have.
    Usual,
    /// Size that few garments have: a warning.
    Rare,
    /// Size that no garment has: an error, unless any size is allowed.
    Implausible,
}

impl GarmentSize {
    /// Returns the plausibility of a garment whose box has the longest side `side` \[m\].
    pub fn of_longest_side(side: f64) -> Self {
        match side {
            _ if TUNING.usual_garment_side_m.contains(&side) => Self::Usual,
            _ if TUNING.garment_side_m.contains(&side) => Self::Rare,
            _ => Self::Implausible,
        }
    }
}

/// Returns the units in which a garment with a longest side of `side` units has a usual size: name, and longest side \[m\].
pub fn usual_units(side: f64) -> impl Iterator<Item = (&'static str, f64)> {
    let in_units = LENGTH_UNITS.iter().map(move |(name, unit)| (*name, side * unit));
    in_units.filter(|(_, side)| GarmentSize::of_longest_side(*side) == GarmentSize::Usual)
}

/// Returns whether a mesh may be in units of `unit_m` \[m\].
pub fn is_plausible_unit(unit_m: f64) -> bool {
    TUNING.unit_m.contains(&unit_m)
}

/// Returns whether `position` \[m\] is finite and so near to the origin that lengths at it can be computed.
pub fn is_in_range(position: &Vec3) -> bool {
    position.iter().all(|x| x.abs() <= TUNING.max_coordinate_m)
}
