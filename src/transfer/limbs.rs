//! Limbs of a garment: the sleeves and legs that lead to its openings, and the openings of its torso.
//!
//! From every opening the lengths of the lines of equal distance to it are measured. Along a sleeve or a leg they grow slowly; at the
//! armpit or the crotch, where the line runs on over the torso, they grow by more than twice the distance. There the limb has its
//! root. Openings beside the middle are those of arms and legs; arms have their roots above the middle, legs below the waist.

use crate::transfer::tuning::TUNING;
use crease_geometry::math::{Mat3, Vec3, bounds};
use crease_geometry::mesh::{Groups, PointIndex, edge_distances};
use crease_model::remesh::GarmentSurface;

/// Opening of a garment by where it is on a body; left and right are those of the person in it.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum LimbRole {
    /// Upper opening of an upper garment.
    Neck,
    /// Lower opening of an upper garment.
    Hem,
    /// Upper opening of a lower garment.
    Waist,
    /// Sleeve.
    LeftArm,
    /// Sleeve.
    RightArm,
    /// Leg.
    LeftLeg,
    /// Leg.
    RightLeg,
}

impl LimbRole {
    /// Name in messages.
    pub fn name(self) -> &'static str {
        match self {
            Self::Neck => "neck",
            Self::Hem => "hem",
            Self::Waist => "waist",
            Self::LeftArm => "left sleeve",
            Self::RightArm => "right sleeve",
            Self::LeftLeg => "left leg",
            Self::RightLeg => "right leg",
        }
    }

    /// Whether it is a sleeve or a leg.
    pub fn is_lateral(self) -> bool {
        !matches!(self, Self::Neck | Self::Hem | Self::Waist)
    }
}

/// Opening and the tube that leads to it.
#[derive(Debug, Clone)]
pub(super) struct Limb {
    /// Its place on a body.
    pub role: LimbRole,
    /// Distance from the opening to the root [m].
    pub length: f64,
    /// Per point of the garment: distance from the opening [m].
    distance: Vec<f64>,
    /// Outline of the opening.
    opening: Ring,
    /// Connected part of the garment.
    part: u32,
}

/// Line around a limb, by its moments.
#[derive(Debug, Clone, Copy)]
pub(super) struct Ring {
    /// Centre [m].
    pub centre: Vec3,
    /// Length [m].
    pub length: f64,
    /// Products of the coordinates around the centre, mean over the length [m²].
    scatter: Mat3,
}

impl Ring {
    /// Half of the width in the unit direction `along` [m]: exact for a circle.
    pub fn half_width(&self, along: &Vec3) -> f64 {
        (2.0 * along.dot(&(self.scatter * along)).max(0.0)).sqrt()
    }

    fn of_segments(segments: impl Iterator<Item = [Vec3; 2]> + Clone) -> Option<Self> {
        let weighted = segments.map(|[a, b]| ((b - a).norm(), 0.5 * (a + b)));
        let length: f64 = weighted.clone().map(|(l, _)| l).sum();
        if length <= 0.0 {
            return None;
        }
        let centre = weighted.clone().map(|(l, x)| x * l).sum::<Vec3>() / length;
        let scatter = weighted.map(|(l, x)| (x - centre) * (x - centre).transpose() * (l / length)).sum();
        Some(Self { centre, length, scatter })
    }
}

/// Openings of a garment in its canonical pose.
#[derive(Debug, Clone)]
pub(super) struct Anatomy {
    /// Limbs with a role, each role once.
    pub limbs: Vec<Limb>,
    /// The garment is one tube, with its two openings.
    pub tube: Option<[Limb; 2]>,
    /// Openings of any role or none.
    opening_count: usize,
    /// Per triangle: connected part.
    part: Vec<u32>,
}

/// Region of a garment, for the question whether points of two garments can belong together.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Region {
    /// Sleeve or leg.
    Limb(LimbRole),
    /// Part around the torso.
    Torso,
    /// Near the root of a limb, or unknown.
    Any,
}

impl Region {
    /// Whether cloth of both can belong together.
    pub fn fits(self, other: Self) -> bool {
        self == other || self == Self::Any || other == Self::Any
    }
}

impl Limb {
    /// The line around the limb at `outward` [m] from its root; at its opening for more than its length.
    pub fn ring(&self, surface: &GarmentSurface, outward: f64) -> Ring {
        level_line(surface, &self.distance, self.length - outward).unwrap_or(self.opening)
    }

    /// Directions of the limb at `outward` [m] from its root: away from it, to the front, and across both.
    pub fn frame(&self, surface: &GarmentSurface, outward: f64) -> [Vec3; 3] {
        let step = (0.15 * self.length).max(TUNING.limb_step_fraction * extent(surface));
        let [inner, outer] = [-step, step].map(|by| self.ring(surface, (outward + by).max(-step)).centre);
        let along = (outer - inner).try_normalize(1e-9).unwrap_or_else(Vec3::y);
        let reference = if along.z.abs() < 0.9 { Vec3::z() } else { Vec3::y() };
        let front = (reference - along * along.dot(&reference)).try_normalize(0.0).unwrap_or_else(Vec3::x);
        [along, front, along.cross(&front)]
    }
}

impl Anatomy {
    /// The openings of `surface`, which is in its canonical pose.
    pub fn of(surface: &GarmentSurface) -> Self {
        let part = parts(surface);
        let loops = surface.topology.boundary_loops(&surface.triangles);
        let size = extent(surface);
        let outline = |border: &Vec<PointIndex>| {
            let points = border.iter().map(|p| surface.points[p.at()]);
            let next = points.clone().cycle().skip(1);
            let outline = Ring::of_segments(points.zip(next).map(|(a, b)| [a, b]))?;
            // Buttonholes and cuts are no openings.
            (outline.length >= TUNING.min_opening_fraction * size).then_some(outline)
        };
        let outlines: Vec<(&Vec<PointIndex>, Ring)> =
            loops.iter().filter_map(|border| Some((border, outline(border)?))).collect();
        // Lace, or pieces that are not sewn: their borders say nothing of a body.
        if outlines.len() > TUNING.max_openings {
            return Self { limbs: Vec::new(), tube: None, opening_count: outlines.len(), part };
        }
        let mut openings = Vec::new();
        for (border, outline) in outlines {
            let mut from = vec![false; surface.points.len()];
            border.iter().for_each(|p| from[p.at()] = true);
            let distance = edge_distances(&surface.points, &surface.topology, &from, f64::INFINITY);
            let length = root_distance(surface, &distance, outline.length);
            let own = border.first().map_or(0, |p| p.0);
            let triangle = surface.triangles.iter().position(|t| t.iter().any(|q| q.0 == own));
            let part = triangle.map_or(0, |f| part[f]);
            openings.push(Limb { role: LimbRole::Hem, length, distance, opening: outline, part });
        }
        let tube = tube_of(&openings);
        let count = part.iter().max().map_or(0, |&last| last + 1);
        let mut limbs = Vec::new();
        for own in 0..count {
            let of_part = openings.iter().filter(|limb| limb.part == own).cloned().collect();
            limbs.extend(with_roles(surface, &part, own, of_part));
        }
        let is_single = |limb: &Limb| limbs.iter().filter(|other| other.role == limb.role).count() == 1;
        let limbs = if limbs.iter().all(is_single) { limbs } else { Vec::new() };
        Self { limbs, tube, opening_count: openings.len(), part }
    }

    /// Whether limbs are known.
    pub fn has_roles(&self) -> bool {
        !self.limbs.is_empty()
    }

    /// Whether both garments have the same limbs, or, where none are known, as many openings.
    pub fn is_of_kind(&self, other: &Self) -> bool {
        let has = |all: &[Limb], role: LimbRole| all.iter().any(|limb| limb.role == role);
        self.limbs.iter().all(|limb| has(&other.limbs, limb.role))
            && other.limbs.iter().all(|limb| has(&self.limbs, limb.role))
            && self.tube.is_some() == other.tube.is_some()
            && self.opening_count == other.opening_count
    }

    /// The limb of a role.
    pub fn limb(&self, role: LimbRole) -> Option<&Limb> {
        self.limbs.iter().find(|limb| limb.role == role)
    }

    /// Region of every triangle of `surface`, whose anatomy this is.
    pub fn regions(&self, surface: &GarmentSurface) -> Vec<Region> {
        let margin = TUNING.limb_margin_fraction * extent(surface);
        let laterals: Vec<&Limb> = self.limbs.iter().filter(|limb| limb.role.is_lateral()).collect();
        let known: Vec<u32> = laterals.iter().map(|limb| limb.part).collect();
        let region = |(t, part): (&[PointIndex; 3], &u32)| {
            if !known.contains(part) {
                return Region::Any;
            }
            for limb in &laterals {
                let inward = t.iter().map(|p| limb.distance[p.at()]).fold(0.0, f64::max) - limb.length;
                if limb.length > margin && inward <= -margin {
                    return Region::Limb(limb.role);
                }
                if inward < margin {
                    return Region::Any;
                }
            }
            Region::Torso
        };
        surface.triangles.iter().zip(&self.part).map(region).collect()
    }
}

/// Diagonal of the box [m].
fn extent(surface: &GarmentSurface) -> f64 {
    let (low, high) = bounds(&surface.points);
    (high - low).norm()
}

/// Per triangle: number of its connected part.
fn parts(surface: &GarmentSurface) -> Vec<u32> {
    let mut groups = Groups::new(surface.triangles.len());
    for hinge in &surface.topology.hinges {
        groups.join(hinge.triangles[0], hinge.triangles[1]);
    }
    groups.numbered().0.iter().map(|part| part.0).collect()
}

/// The line on which `distance`, one per point, is `at`; `None` where there is none.
fn level_line(surface: &GarmentSurface, distance: &[f64], at: f64) -> Option<Ring> {
    let crossing = |t: &[PointIndex; 3]| {
        let ends = (0..3).filter_map(|k| {
            let [p, q] = [t[k].at(), t[(k + 1) % 3].at()];
            let (a, b) = (distance[p], distance[q]);
            // Infinite on parts that do not reach the opening.
            let crosses = (a < at) != (b < at) && a.is_finite() && b.is_finite();
            crosses
                .then(|| surface.points[p] + (surface.points[q] - surface.points[p]) * ((at - a) / (b - a)))
        });
        let ends: Vec<Vec3> = ends.collect();
        (ends.len() == 2).then(|| [ends[0], ends[1]])
    };
    let segments: Vec<[Vec3; 2]> = surface.triangles.iter().filter_map(crossing).collect();
    Ring::of_segments(segments.iter().copied())
}

/// Distance from an opening of the length `opening` [m] to the root of its limb [m]; the farthest point for a tube without one.
fn root_distance(surface: &GarmentSurface, distance: &[f64], opening: f64) -> f64 {
    let edges = surface.topology.edges.len().max(1) as f64;
    let mean =
        surface.topology.edges.iter().map(|[a, b]| (surface.points[a.at()] - surface.points[b.at()]).norm());
    let step = (TUNING.limb_step_fraction * extent(surface)).max(1.5 * mean.sum::<f64>() / edges);
    let (mut at, mut last) = (0.5 * step, opening);
    while let Some(ring) = level_line(surface, distance, at) {
        if ring.length - last > TUNING.max_limb_growth * step {
            // The line before the last lies on the limb for certain.
            return (at - 1.5 * step).max(0.0);
        }
        (at, last) = (at + step, ring.length);
    }
    at - step
}

/// The two openings of a garment that is one tube.
fn tube_of(openings: &[Limb]) -> Option<[Limb; 2]> {
    let [a, b] = openings else { return None };
    let across = |limb: &Limb, other: &Limb| {
        let far = other.distance.iter().zip(&limb.distance).filter(|(d, _)| **d == 0.0).map(|(_, d)| *d);
        far.fold(f64::INFINITY, f64::min)
    };
    let length = across(a, b);
    let is_tube = a.part == b.part
        && length.is_finite()
        && [a, b].iter().all(|limb| limb.length >= 0.9 * length)
        && length >= TUNING.min_tube_ratio * a.opening.length.max(b.opening.length);
    // The other end need not be level: a line just before it goes all the way around.
    is_tube.then(|| [a, b].map(|limb| Limb { length: 0.95 * length, ..limb.clone() }))
}

/// Gives the openings of one connected part their roles; none where sleeves or legs cannot be told.
fn with_roles(surface: &GarmentSurface, part: &[u32], own: u32, openings: Vec<Limb>) -> Vec<Limb> {
    let corners = surface.triangles.iter().zip(part).filter(|(_, part)| **part == own).flat_map(|(t, _)| t);
    let points: Vec<Vec3> = corners.map(|p| surface.points[p.at()]).collect();
    if points.is_empty() {
        return Vec::new();
    }
    let (low, high) = bounds(&points);
    let middle = 0.5 * (low.x + high.x);
    let beside = |limb: &Limb| (limb.opening.centre.x - middle) / (high.x - low.x).max(1e-9);
    let (lateral, mut central): (Vec<Limb>, Vec<Limb>) =
        openings.into_iter().partition(|limb| beside(limb).abs() > TUNING.min_lateral_fraction);
    central.sort_by(|a, b| b.opening.centre.y.total_cmp(&a.opening.centre.y));
    let root_height = |limb: &Limb| limb.ring(surface, 0.0).centre.y;
    let mut sides: [Vec<Limb>; 2] = [Vec::new(), Vec::new()];
    for limb in lateral {
        sides[usize::from(beside(&limb) < 0.0)].push(limb);
    }
    sides.iter_mut().for_each(|side| side.sort_by(|a, b| root_height(b).total_cmp(&root_height(a))));
    let [left, right] = &sides;
    if left.len() != right.len() || left.is_empty() || left.len() > 2 || central.is_empty() {
        return Vec::new();
    }
    let has_both = left.len() == 2;
    let hangs = central.len() == 1 && root_height(&left[0]) < central[0].opening.centre.y;
    let arms = [LimbRole::LeftArm, LimbRole::RightArm];
    let legs = [LimbRole::LeftLeg, LimbRole::RightLeg];
    let mut limbs = Vec::new();
    for (k, side) in sides.into_iter().enumerate() {
        for (rank, limb) in side.into_iter().enumerate() {
            let role = if rank == 1 || (hangs && !has_both) { legs[k] } else { arms[k] };
            limbs.push(Limb { role, ..limb });
        }
    }
    let last = central.len() - 1;
    for (rank, limb) in central.into_iter().enumerate() {
        let role = match (rank, last) {
            (0, 0) if hangs && !has_both => LimbRole::Waist,
            (0, 0) if has_both => LimbRole::Neck,
            // The outline of an open jacket is neck, front and hem at once.
            (0, 0) => continue,
            (0, _) => LimbRole::Neck,
            (rank, last) if rank == last => LimbRole::Hem,
            _ => continue,
        };
        limbs.push(Limb { role, ..limb });
    }
    limbs
}
