//! Registration of garments of different cut limb by limb: sleeve on sleeve, leg on leg, torso on torso.
//!
//! Limbs of one role are laid over one another from their roots outward: over their whole lengths where these agree, so that cuffs
//! meet; else by the scale of the bodies, so that a short sleeve covers the upper part of a long one and no more. Along each limb some
//! rings are paired, by centre and by half widths to the front and across; a spline interpolates them ([`Registration`]). Cloth of
//! a limb belongs to cloth of the same limb only, and what has no counterpart gets nothing.

use crate::transfer::limbs::{Anatomy, Limb, LimbRole, Region, Ring};
use crate::transfer::registration::{AffineMap, PointPair, Registration};
use crate::transfer::tuning::TUNING;
use crease_geometry::math::{Mat3, Vec3};
use crease_model::remesh::GarmentSurface;

/// A garment in its canonical pose with its anatomy.
#[derive(Clone, Copy)]
pub(super) struct Figure<'a> {
    /// Its surface.
    pub surface: &'a GarmentSurface,
    /// Its openings.
    pub anatomy: &'a Anatomy,
}

/// Limbs of a source and of a target that belong together.
struct LimbPair<'a> {
    source: &'a Limb,
    target: &'a Limb,
    /// Lengths from the roots that lie on one another [m].
    lengths: [f64; 2],
}

/// A source registered on a target.
pub(super) struct LimbAlignment {
    /// Map from the canonical pose of the source to that of the target.
    pub map: Registration,
    /// Region of every triangle of the source and of the target.
    pub regions: [Vec<Region>; 2],
    /// What has no counterpart, for the report.
    pub notes: Vec<String>,
}

/// Registers `source` on `target`, limb by limb; `None` where their openings say nothing, or nothing else than their boxes. `in_file`
/// maps the source to where its file has it, as the target is seen. The map adds to `fallback`.
pub(super) fn align_limbs(
    source: Figure,
    target: Figure,
    in_file: &AffineMap,
    fallback: AffineMap,
) -> Option<LimbAlignment> {
    tube_alignment(source, target, in_file, fallback).or_else(|| garment_alignment(source, target, fallback))
}

/// Registers two garments with sleeves or legs.
fn garment_alignment(source: Figure, target: Figure, fallback: AffineMap) -> Option<LimbAlignment> {
    let shared: Vec<[&Limb; 2]> = (source.anatomy.limbs.iter())
        .filter_map(|limb| Some([limb, target.anatomy.limb(limb.role)?]))
        .collect();
    if shared.iter().filter(|[limb, _]| limb.role.is_lateral()).count() < 2 {
        return None;
    }
    let scale = body_scale(source, target, &shared)?;
    let pairs: Vec<LimbPair> = shared.iter().map(|[a, b]| LimbPair::new(a, b, scale)).collect();
    let is_alike = source.anatomy.limbs.len() == target.anatomy.limbs.len()
        && pairs.len() == source.anatomy.limbs.len()
        && pairs.iter().all(|pair| pair.is_alike(source.surface, target.surface));
    if is_alike {
        return None;
    }
    let points: Vec<PointPair> =
        pairs.iter().flat_map(|pair| pair.point_pairs(source.surface, target.surface)).collect();
    let map = Registration::fit(&points, fallback)?;
    let regions = [source, target].map(|figure| figure.anatomy.regions(figure.surface));
    Some(LimbAlignment { map, regions, notes: notes(source, target, &pairs) })
}

/// Ratio of the sizes of the bodies, by the distances between the roots of limbs and the lines around these [-]. Cuts differ by more
/// than people do: for garments of people it is 1.
fn body_scale(source: Figure, target: Figure, shared: &[[&Limb; 2]]) -> Option<f64> {
    let size = |figure: Figure, k: usize| -> f64 {
        let laterals = shared.iter().map(|pair| pair[k]).filter(|limb| limb.role.is_lateral());
        let roots: Vec<Ring> = laterals.map(|limb| limb.ring(figure.surface, 0.0)).collect();
        let centre = roots.iter().map(|ring| ring.centre).sum::<Vec3>() / roots.len().max(1) as f64;
        let spread: f64 = roots.iter().map(|ring| (ring.centre - centre).norm()).sum();
        let around: f64 = roots.iter().map(|ring| ring.length).sum();
        (spread * around).sqrt()
    };
    let (from, to) = (size(source, 0), size(target, 1));
    let ratio = if from > 0.0 && to > 0.0 { to / from } else { return None };
    Some(if ratio.ln().abs() <= TUNING.max_person_deviation { 1.0 } else { ratio })
}

/// Whether the upper openings and the roots of the limbs of two garments of one kind lie where one body has them: distances are
/// compared with `size`, the diagonal of the target [m].
pub(super) fn hang_from_one_place(source: Figure, target: Figure, size: f64) -> bool {
    let max_distance = TUNING.max_root_distance_fraction * size;
    let is_near = |limb: &Limb| {
        let Some(other) = target.anatomy.limb(limb.role) else { return true };
        let distance = limb.ring(source.surface, 0.0).centre - other.ring(target.surface, 0.0).centre;
        distance.norm() <= max_distance
    };
    source.anatomy.limbs.iter().filter(|limb| limb.role != LimbRole::Hem).all(is_near)
}

impl<'a> LimbPair<'a> {
    fn new(source: &'a Limb, target: &'a Limb, scale: f64) -> Self {
        let own = scale * source.length;
        let is_zero = own.min(target.length) <= 0.0;
        let deviation = if is_zero { f64::INFINITY } else { (own / target.length).ln().abs() };
        let lengths = match deviation <= TUNING.max_box_scale_deviation {
            true => [source.length, target.length],
            false => [own.min(target.length) / scale, own.min(target.length)],
        };
        Self { source, target, lengths }
    }

    /// Whether the boxes of both garments say as much: limbs of one length and direction.
    fn is_alike(&self, source: &GarmentSurface, target: &GarmentSurface) -> bool {
        if !self.source.role.is_lateral() {
            return true;
        }
        let whole = self.lengths == [self.source.length, self.target.length];
        let towards = |limb: &Limb, surface: &GarmentSurface| {
            (limb.ring(surface, limb.length).centre - limb.ring(surface, 0.0).centre).try_normalize(1e-6)
        };
        let both = towards(self.source, source).zip(towards(self.target, target));
        whole && both.is_none_or(|(a, b)| a.dot(&b) > TUNING.min_limb_cosine)
    }

    /// Rings along both limbs, by their centres and four points around each.
    fn point_pairs(&self, source: &GarmentSurface, target: &GarmentSurface) -> Vec<PointPair> {
        let [own, other] = self.lengths;
        let count = if own <= 0.0 { 0 } else { TUNING.limb_rings };
        let mut pairs = Vec::new();
        for ring in 0..=count {
            let fraction = if count == 0 { 0.0 } else { f64::from(ring) / f64::from(count) };
            let at = [(self.source, source, own * fraction), (self.target, target, other * fraction)];
            let [from, to] = at.map(|(limb, surface, outward)| {
                let ring = limb.ring(surface, outward);
                let [_, front, across] = limb.frame(surface, outward);
                (ring, [front, across])
            });
            pairs.push(PointPair { source: from.0.centre, target: to.0.centre });
            for (a, b) in from.1.iter().zip(&to.1) {
                let widths = [from.0.half_width(a), to.0.half_width(b)];
                // A flat garment has no depth to be laid on another.
                if widths
                    .iter()
                    .any(|width| *width < TUNING.min_ring_fraction * from.0.length.min(to.0.length))
                {
                    continue;
                }
                for sign in [-1.0, 1.0] {
                    let source = from.0.centre + a * (sign * widths[0]);
                    pairs.push(PointPair { source, target: to.0.centre + b * (sign * widths[1]) });
                }
            }
        }
        pairs
    }
}

/// Lays a garment that is one tube, a sleeve or a leg of its own, over the limb of the other that it is like.
fn tube_alignment(
    source: Figure,
    target: Figure,
    in_file: &AffineMap,
    fallback: AffineMap,
) -> Option<LimbAlignment> {
    let (tube, figure, tube_first) = match (&source.anatomy.tube, &target.anatomy.tube) {
        (Some(tube), None) => (tube, target, true),
        (None, Some(tube)) => (tube, source, false),
        _ => return None,
    };
    let tube_figure = if tube_first { source } else { target };
    // Both in the coordinates of the target.
    let place = |of_source: bool, x: Vec3| if of_source { in_file.apply(&x) } else { x };
    let middle = 0.5 * tube[0].length;
    let own = tube[0].ring(tube_figure.surface, middle);
    let at = place(tube_first, own.centre);
    let laterals = figure.anatomy.limbs.iter().filter(|limb| limb.role.is_lateral() && limb.length > 0.0);
    let ring = |limb: &Limb| limb.ring(figure.surface, 0.5 * limb.length);
    let width_difference = |length: f64| (length / own.length).ln().abs();
    // A skirt is like the torso, not like a leg.
    let torso = [LimbRole::Hem, LimbRole::Waist].into_iter().filter_map(|role| figure.anatomy.limb(role));
    let of_torso = torso
        .map(|limb| width_difference(limb.ring(figure.surface, limb.length).length))
        .fold(f64::INFINITY, f64::min);
    let rank = |limb: &&Limb| {
        let near = (place(!tube_first, ring(limb).centre) - at).norm();
        (
            if limb.role < LimbRole::LeftLeg {
                width_difference(ring(limb).length)
            } else {
                width_difference(ring(limb).length) + 0.1
            },
            near,
        )
    };
    let limb = laterals.filter(|limb| width_difference(ring(limb).length) < of_torso).min_by(|a, b| {
        let ((by_width, near), (other_width, other_near)) = (rank(a), rank(b));
        // Left and right are as wide as one another: the nearer one counts.
        match (by_width - other_width).abs() < TUNING.max_side_difference {
            true => near.total_cmp(&other_near),
            false => by_width.total_cmp(&other_width),
        }
    })?;
    // The root is at the wider end, or where the torso is nearer.
    let root = place(!tube_first, limb.ring(figure.surface, 0.0).centre);
    let [a, b] = tube.each_ref().map(|end| end.ring(tube_figure.surface, end.length));
    let is_wider = (a.length / b.length).ln();
    let nearer_first =
        (place(tube_first, a.centre) - root).norm() < (place(tube_first, b.centre) - root).norm();
    let root_first = if is_wider.abs() > TUNING.min_end_difference { is_wider > 0.0 } else { nearer_first };
    let outer = &tube[usize::from(root_first)];
    let pair = match tube_first {
        true => LimbPair::new(outer, limb, 1.0),
        false => LimbPair::new(limb, outer, 1.0),
    };
    let map = Registration::fit(&pair.point_pairs(source.surface, target.surface), fallback)?;
    let all = |figure: Figure| vec![Region::Limb(limb.role); figure.surface.triangles.len()];
    let of_limb = figure.anatomy.regions(figure.surface);
    let regions = if tube_first { [all(source), of_limb] } else { [of_limb, all(target)] };
    let what = match tube_first {
        true => format!(
            "it is a tube, laid over the {} of the target; the rest of the target gets nothing",
            limb.role.name()
        ),
        false => format!(
            "the target is a tube, under which its {} is laid; the rest of it is left out",
            limb.role.name()
        ),
    };
    Some(LimbAlignment { map, regions, notes: vec![what] })
}

/// What has no counterpart on the other garment.
fn notes(source: Figure, target: Figure, pairs: &[LimbPair]) -> Vec<String> {
    let lacks = |figure: Figure, role: LimbRole| figure.anatomy.limb(role).is_none();
    let mut notes = Vec::new();
    let (mut bare, mut left, mut part) = (Vec::new(), Vec::new(), Vec::new());
    for limb in target.anatomy.limbs.iter().filter(|limb| limb.role.is_lateral() && lacks(source, limb.role))
    {
        bare.push(limb.role.name());
    }
    for limb in source.anatomy.limbs.iter().filter(|limb| limb.role.is_lateral() && lacks(target, limb.role))
    {
        left.push(limb.role.name());
    }
    let is_shorter = |a: f64, b: f64| a < 0.99 * b;
    for pair in pairs.iter().filter(|pair| pair.source.role.is_lateral()) {
        let name = pair.source.role.name();
        if is_shorter(pair.lengths[1], pair.target.length) {
            part.push(format!("{name} ({:.2} of {:.2} m)", pair.lengths[1], pair.target.length));
        }
    }
    if !bare.is_empty() {
        notes.push(format!("nothing goes to what it does not have: {}", bare.join(", ")));
    }
    if !left.is_empty() {
        notes.push(format!("left out, as the target does not have it: {}", left.join(", ")));
    }
    if !part.is_empty() {
        notes.push(format!("it covers only the upper part of the target's {}", part.join(", ")));
    }
    notes
}

/// Map of canonical coordinates that scales by `scale` per axis, as a registration adds to it.
pub(super) fn scaling(scale: Vec3) -> AffineMap {
    AffineMap { linear: Mat3::from_diagonal(&scale), shift: Vec3::zeros() }
}
