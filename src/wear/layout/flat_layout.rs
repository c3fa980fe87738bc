//! A garment laid out flat, front over back, as hands do it: without a simulation.
//!
//! Triangles that look up and those that look down are told apart ([`LayoutSides`]), the cloth is mapped into the plane, turned over where
//! sides change ([`PlaneMap`]), triangles that lie on one another there get an order ([`ordered_overlaps`]), and the order gives heights
//! ([`layer_heights`]). The map may fold cloth over anywhere and as often as it likes: that is a pleat, which has an order as any other
//! layers have. The shape in a file is that of a garment on a body, and its cut is not known: the shape that a triangle has in the plane
//! counts as its cut, up to a strain ([`MAX_CUT_STRAIN`]). What exceeds that makes the wrinkles once the cloth is free.

use crate::wear::layout::layer_heights::{layer_count, layer_heights};
use crate::wear::layout::layout_sides::{LayoutSides, Neighbours, neighbours};
use crate::wear::layout::overlap_order::{Overlap, ordered_overlaps};
use crate::wear::layout::plane_map::{PlaneMap, cotangents};
use crate::wear::tuning::TUNING;
use crease_geometry::math::{PlaneStretch, Rng, Vec3};
use crease_geometry::mesh::intersections::self_intersecting_triangles;
use crease_geometry::mesh::{Groups, PointIndex, Topology, triangle};
use crease_model::error::{Message, Operation};
use rustc_hash::FxHashSet;
use std::fmt;

/// Largest principal strain between the shape of a triangle in the file and in the cut of the garment [-]: an assumption
/// (`docs/theory/method.md`).
pub const MAX_CUT_STRAIN: f64 = 0.2;

/// A garment laid out flat. y points up; the lowest layer lies at y = 0.
#[derive(Debug, Clone)]
pub(crate) struct FlatLayout {
    /// One per point [m].
    pub positions: Vec<Vec3>,
    /// Per point: by how much it looks up before it is laid, from -1 to 1; the cloth turns over at 0.
    pub level: Vec<f64>,
    /// How good it is.
    pub quality: LayoutQuality,
}

/// How well a garment lies in a layout.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LayoutQuality {
    /// Strain between the shape in the file and the cut: root mean square over the area [-].
    pub strain: f64,
    /// Fraction of the cloth that does not fit into the plane beyond that and makes wrinkles, by area [-].
    pub excess: f64,
    /// Fraction of the cloth that is folded over where it looked to one side in the file, by area [-].
    pub folded: f64,
    /// Parts that are not joined.
    pub parts: usize,
    /// Most layers on one another.
    pub layers: u32,
    /// Triangles that cross others.
    pub crossing: usize,
}

impl LayoutQuality {
    /// What a user should know of a layout that is not free of faults.
    pub fn warning(&self) -> Option<Message> {
        (self.crossing > 0).then(|| {
            let faults = format!(
                "{} triangles cross others where the garment lies: contact leaves them alone, and they hold what is around them; ",
                self.crossing
            );
            Message::from(faults) + Operation::Inspect + " tells what crosses in the file"
        })
    }
}

impl fmt::Display for LayoutQuality {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        write!(
            f,
            "{} parts in up to {} layers, in a cut that differs from the file's shape by {:.1} % (rms strain); {:.1} % of the cloth does not fit \
             into the plane beyond that and makes wrinkles, {:.1} % is folded over; {} triangles cross",
            self.parts,
            self.layers,
            100.0 * self.strain,
            100.0 * self.excess,
            100.0 * self.folded,
            self.crossing
        )
    }
}

/// Where cloth at `source` [m] (y up) lies when it is laid out flat [m]; `None` only where positions are not finite.
pub fn lying_places(source: &[Vec3], triangles: &[[PointIndex; 3]]) -> Option<Vec<Vec3>> {
    let topology = &Topology::new(source.len(), triangles);
    let sides = LayoutSides::new(source, triangles, topology, &neighbours(source, triangles, topology))?;
    let weights: Vec<[f64; 3]> =
        triangles.iter().map(|t| cotangents(&triangle::corners(source, t))).collect();
    Some(PlaneMap::new(source, triangles, topology, &weights, &sides.up)?.positions(source))
}

/// What does not change from round to round.
struct Cloth<'a> {
    source: &'a [Vec3],
    triangles: &'a [[PointIndex; 3]],
    topology: &'a Topology,
    neighbours: &'a [Neighbours],
    sides: &'a LayoutSides,
    gap: f64,
}

impl FlatLayout {
    /// Lays out the cloth at `source` [m] (y up), with `gap` [m] between its layers. `None` only where positions are not finite.
    pub fn new(source: &[Vec3], triangles: &[[PointIndex; 3]], gap: f64) -> Option<Self> {
        let topology = &Topology::new(source.len(), triangles);
        let neighbours = &neighbours(source, triangles, topology);
        let sides = &LayoutSides::new(source, triangles, topology, neighbours)?;
        let cloth = Cloth { source, triangles, topology, neighbours, sides, gap };
        let mut weights: Vec<[f64; 3]> =
            triangles.iter().map(|t| cotangents(&triangle::corners(source, t))).collect();
        let mut flat: Vec<Vec3> = source.to_vec();
        let mut best: Option<Placed> = None;
        for round in 0..TUNING.lay.max_layout_rounds {
            flat = PlaneMap::new(source, triangles, topology, &weights, &sides.up)?.positions(&flat);
            let placed = cloth.placed(&flat);
            let mut folded = vec![false; source.len()];
            let crossing = placed.crossing.clone();
            keep_better(&mut best, placed);
            if crossing.is_empty() {
                break;
            }
            // What crosses is drawn out between the points around it.
            crossing.iter().for_each(|f| triangles[*f as usize].iter().for_each(|p| folded[p.at()] = true));
            let marked = folded.clone();
            for _ in 0..=round {
                folded = with_neighbours(&folded, topology);
            }
            let placed = cloth.placed(&drawn_out(&flat, &folded, topology));
            let is_free = placed.crossing.is_empty();
            keep_better(&mut best, placed);
            if is_free {
                break;
            }
            for (t, w) in triangles.iter().zip(&mut weights) {
                if t.iter().any(|p| marked[p.at()]) {
                    w.iter_mut().for_each(|w| *w *= TUNING.lay.stiffening);
                }
            }
        }
        best.map(|placed| cloth.layout(placed))
    }
}

/// Keeps the one of two in which fewer triangles cross; of equals the first.
fn keep_better(best: &mut Option<Placed>, other: Placed) {
    if best.as_ref().is_none_or(|best| other.crossing.len() < best.crossing.len()) {
        *best = Some(other);
    }
}

/// Points in the plane with their layers.
struct Placed {
    flat: Vec<Vec3>,
    /// In layers [m].
    positions: Vec<Vec3>,
    overlaps: Vec<Overlap>,
    /// Triangles that cross others.
    crossing: Vec<u32>,
}

impl Cloth<'_> {
    /// Layers of points at `flat` in the plane [m].
    fn placed(&self, flat: &[Vec3]) -> Placed {
        // Copies of a sheet would lie on one another point by point: which lies over which is told of points apart only.
        let mut random = Rng::from_seed(1);
        let by = TUNING.lay.shift;
        let mut shifted = |p: &Vec3| {
            let cube = random.in_cube();
            Vec3::new(p.x + by * cube.x, 0.0, p.z + by * cube.z)
        };
        let flat: Vec<Vec3> = flat.iter().map(&mut shifted).collect();
        let Self { source, triangles, topology, neighbours, sides, gap } = *self;
        let overlaps = ordered_overlaps(source, &flat, triangles, sides, neighbours, &topology.edges);
        let heights = layer_heights(&flat, triangles, topology, neighbours, &overlaps, gap);
        let positions: Vec<Vec3> = flat.iter().zip(&heights).map(|(p, y)| Vec3::new(p.x, *y, p.z)).collect();
        let crossing = self_intersecting_triangles(&positions, triangles);
        Placed { flat, positions, overlaps, crossing }
    }

    /// The layout with points in their layers.
    fn layout(&self, placed: Placed) -> FlatLayout {
        let Self { source, triangles, .. } = *self;
        let Placed { flat, positions, overlaps, crossing } = placed;
        let area = |x: &[Vec3], t| triangle::area(&triangle::corners(x, t));
        let (mut excess, mut squares, mut folded, mut all) = (0.0, 0.0, 0.0, 0.0);
        for (t, up) in triangles.iter().zip(&self.sides.up) {
            let (own, cut) = (area(source, t), stretch_to_cut(source, &flat, t));
            let looks_up = triangle::area_vector(&triangle::corners(&flat, t)).y > 0.0;
            folded += if looks_up == *up { 0.0 } else { own };
            excess += (own * cut.area_ratio() - area(&flat, t)).max(0.0);
            squares += own * cut.rms_strain().powi(2);
            all += own;
        }
        let quality = LayoutQuality {
            strain: (squares / all).sqrt(),
            excess: excess / all,
            folded: folded / all,
            parts: part_count(source.len(), triangles),
            layers: layer_count(&flat, triangles, &overlaps),
            crossing: crossing.len(),
        };
        FlatLayout { positions, level: self.point_levels(), quality }
    }

    /// Per point: by how much it looks up, 0 where the cloth turns over on an edge.
    fn point_levels(&self) -> Vec<f64> {
        let mut sums = vec![(0.0, 0.0); self.source.len()];
        for (t, level) in self.triangles.iter().zip(&self.sides.level) {
            let area = triangle::area(&triangle::corners(self.source, t));
            for p in t {
                sums[p.at()].0 += area * level;
                sums[p.at()].1 += area;
            }
        }
        let mut levels: Vec<f64> = sums.iter().map(|(sum, area)| sum / area.max(f64::MIN_POSITIVE)).collect();
        for pair in self.neighbours.iter().filter(|pair| pair.cosine < 0.0 && self.sides.turns_over(pair)) {
            self.topology.edges[pair.edge].iter().for_each(|p| levels[p.at()] = 0.0);
        }
        levels
    }
}

/// Number of parts that are not joined.
fn part_count(point_count: usize, triangles: &[[PointIndex; 3]]) -> usize {
    let mut groups = Groups::new(point_count);
    for [a, b, c] in triangles {
        groups.join(a.0, b.0);
        groups.join(b.0, c.0);
    }
    let used: FxHashSet<u32> = triangles.iter().flatten().map(|p| groups.find(p.0)).collect();
    used.len()
}

/// Stretch of a triangle from its shape at `source` to that in the cut of a garment that lies at `flat` [m].
fn stretch_to_cut(source: &[Vec3], flat: &[Vec3], t: &[PointIndex; 3]) -> PlaneStretch {
    let [[a, b, c], [d, e, f]] = [source, flat].map(|x| triangle::corners(x, t));
    let (along, across) = (b - a, c - a);
    let length = along.norm().max(f64::MIN_POSITIVE);
    let foot = across.dot(&along) / length;
    let height = along.cross(&across).norm() / length;
    let u = (e - d) / length;
    let v = (f - d - u * foot) / height.max(f64::MIN_POSITIVE);
    PlaneStretch::of_axes(&u, &v, MAX_CUT_STRAIN)
}

/// `marked` points and their neighbours.
fn with_neighbours(marked: &[bool], topology: &Topology) -> Vec<bool> {
    let mut wider = marked.to_vec();
    for [a, b] in &topology.edges {
        wider[a.at()] |= marked[b.at()];
        wider[b.at()] |= marked[a.at()];
    }
    wider
}

/// Points at `flat` in the plane [m], the `marked` ones in the middle of their neighbours.
fn drawn_out(flat: &[Vec3], marked: &[bool], topology: &Topology) -> Vec<Vec3> {
    let mut x = flat.to_vec();
    for _ in 0..TUNING.lay.draw_out_rounds {
        let mut sum = vec![(Vec3::zeros(), 0.0); x.len()];
        for [a, b] in &topology.edges {
            for (p, q) in [(a.at(), b.at()), (b.at(), a.at())] {
                sum[p].0 += x[q];
                sum[p].1 += 1.0;
            }
        }
        for (p, (sum, count)) in sum.into_iter().enumerate().filter(|(p, _)| marked[*p]) {
            x[p] = sum / count;
        }
    }
    x
}

#[cfg(test)]
mod tests {
    use super::*;
    use crease_geometry::math::bounds;
    use crease_geometry::mesh::intersections::self_intersections;
    use std::f64::consts::{PI, TAU};

    const RADIUS: f64 = 0.1;
    const LENGTH: f64 = 0.4;

    /// A tube along z, open at both ends, thinner in its middle by `waist`; `bias` turns its points round its axis.
    fn tube(waist: f64, bias: f64) -> (Vec<Vec3>, Vec<[PointIndex; 3]>) {
        let (around, along) = (36u32, 24u32);
        let mut points = Vec::new();
        for k in 0..around * (along + 1) {
            let z = f64::from(k / around) / f64::from(along);
            let angle = bias + TAU * f64::from(k % around) / f64::from(around);
            let radius = RADIUS * (1.0 - waist * (PI * z).sin());
            points.push(Vec3::new(radius * angle.cos(), radius * angle.sin(), LENGTH * z));
        }
        let mut triangles = Vec::new();
        for (i, j) in (0..around).flat_map(|i| (0..along).map(move |j| (i, j))) {
            let corner = |i: u32, j: u32| PointIndex(j * around + i % around);
            let [a, b, c, d] = [corner(i, j), corner(i + 1, j), corner(i + 1, j + 1), corner(i, j + 1)];
            triangles.extend([[a, b, c], [a, c, d]]);
        }
        (points, triangles)
    }

    #[test]
    fn a_tube_lies_in_two_layers() {
        for bias in [0.0, 0.07] {
            let (points, triangles) = tube(0.0, bias);
            let laid = FlatLayout::new(&points, &triangles, 1e-3).expect("can lie");
            let (low, high) = bounds(&laid.positions);
            let size = high - low;
            assert!((size.x - PI * RADIUS).abs() < 0.02, "half its girth wide: {size}");
            assert!((size.z - LENGTH).abs() < 0.01 && size.y < 3e-3, "{size}");
            // The rim runs through two of 36 columns of triangles.
            assert!(laid.quality.excess < 0.08, "a tube is flat but for its rim: {}", laid.quality.excess);
            assert!(self_intersections(&laid.positions, &triangles).is_empty());
        }
    }

    #[test]
    fn what_does_not_fit_into_the_plane_is_told() {
        let laid = |waist: f64| {
            let (points, triangles) = tube(waist, 0.0);
            FlatLayout::new(&points, &triangles, 1e-3).expect("can lie")
        };
        let (straight, waisted, barrel) = (laid(0.0), laid(0.3), laid(-3.0));
        assert!(
            straight.quality.strain < 1e-3 && straight.quality.excess < 1e-12,
            "{} {}",
            straight.quality.strain,
            straight.quality.excess
        );
        // A waist fits by strains that a cut may have, a barrel four times as wide as its ends does not.
        assert!(
            waisted.quality.strain > 0.01 && waisted.quality.excess < 1e-12,
            "{} {}",
            waisted.quality.strain,
            waisted.quality.excess
        );
        assert!(
            barrel.quality.strain > waisted.quality.strain && barrel.quality.excess > 5e-3,
            "{} {}",
            barrel.quality.strain,
            barrel.quality.excess
        );
    }

    /// The tube with a second sheet `apart` [m] outside of the cloth at columns `around` and rows `along`, sewn on along its borders but
    /// for those at the ends of the tube. Also the number of points of the tube.
    fn with_patch(
        around: std::ops::Range<u32>,
        along: std::ops::Range<u32>,
        apart: f64,
    ) -> (Vec<Vec3>, Vec<[PointIndex; 3]>, usize) {
        let (mut points, mut triangles) = tube(0.0, 0.07);
        let count = points.len();
        let mut sewn = |i: u32, j: u32| {
            let on_side = i == around.start || i == around.end;
            let inner_end = |end: u32| j == end && end != 0 && end != 24;
            let below = PointIndex(j * 36 + i % 36);
            if on_side || inner_end(along.start) || inner_end(along.end) {
                return below;
            }
            let x = points[below.at()];
            let lifted = x + Vec3::new(x.x, x.y, 0.0).normalize() * apart;
            let known = points[count..].iter().position(|p| (p - lifted).norm() < 1e-12);
            PointIndex(known.map_or_else(
                || {
                    points.push(lifted);
                    points.len() as u32 - 1
                },
                |k| (count + k) as u32,
            ))
        };
        for (i, j) in around.clone().flat_map(|i| along.clone().map(move |j| (i, j))) {
            let [a, b, c, d] = [sewn(i, j), sewn(i + 1, j), sewn(i + 1, j + 1), sewn(i, j + 1)];
            triangles.extend([[a, b, c], [a, c, d]]);
        }
        (points, triangles, count)
    }

    #[test]
    fn what_is_sewn_on_lies_outside_of_the_cloth() {
        // Pockets on either side, a placket to the border, a facing inside.
        for (around, along, apart) in
            [(6..12, 6..14, 2e-3), (24..30, 6..14, 2e-3), (8..11, 0..20, 2e-3), (6..12, 6..14, -2e-3)]
        {
            let what = format!("{around:?} {along:?} {apart}");
            let (points, triangles, count) = with_patch(around.clone(), along, apart);
            let laid = FlatLayout::new(&points, &triangles, 1e-3).unwrap_or_else(|| panic!("{what} lies"));
            assert!(self_intersections(&laid.positions, &triangles).is_empty(), "{what}");
            let (low, high) = bounds(&laid.positions);
            assert!(high.y - low.y < 6e-3, "{what}: {}", high.y - low.y);
            // The middle of a patch is over or under the cloth of its own side.
            let middle = (points.len() + count) / 2;
            let nearest = |p: usize| {
                let flat = |q: &usize| (points[*q] - points[p]).norm();
                (0..count).min_by(|a, b| flat(a).total_cmp(&flat(b))).expect("there are some")
            };
            let over = laid.positions[middle].y - laid.positions[nearest(middle)].y;
            let looks_up = points[middle].y > 0.0;
            assert_eq!(over > 0.0, looks_up == (apart > 0.0), "{what}: {over}");
        }
    }

    /// The tube with the profile `extra` continued from its first ring: distances outward and along its axis [m].
    fn continued(extra: &[[f64; 2]]) -> (Vec<Vec3>, Vec<[PointIndex; 3]>, usize) {
        let (mut points, mut triangles) = tube(0.0, 0.07);
        let count = points.len();
        let ring: Vec<Vec3> = points[..36].to_vec();
        let mut before: Vec<u32> = (0..36).collect();
        for [out, along] in extra {
            let first = points.len() as u32;
            let moved = |p: &Vec3| p + Vec3::new(p.x, p.y, 0.0).normalize() * *out + Vec3::z() * *along;
            points.extend(ring.iter().map(moved));
            let next: Vec<u32> = (first..first + 36).collect();
            for i in 0..36 {
                let k = (i + 1) % 36;
                let [a, b, c, d] = [before[i], before[k], next[k], next[i]].map(PointIndex);
                triangles.extend([[a, c, b], [a, d, c]]);
            }
            before = next;
        }
        (points, triangles, count)
    }

    /// Heights of the points at `x` [m] that lie near `place` in the plane [m], in the order of their numbers.
    fn heights_near(x: &[Vec3], place: [f64; 2]) -> Vec<(usize, f64)> {
        let near = |p: &Vec3| (p.x - place[0]).hypot(p.z - place[1]) < 0.015;
        x.iter().enumerate().filter(|(_, p)| near(p)).map(|(k, p)| (k, p.y)).collect()
    }

    #[test]
    fn a_cuff_that_is_turned_up_lies_outside_on_both_sides() {
        let (points, triangles, count) = continued(&[[3e-3, 0.0], [4e-3, 0.02], [4e-3, 0.04], [4e-3, 0.06]]);
        let laid = FlatLayout::new(&points, &triangles, 1e-3).expect("lies");
        assert!(self_intersections(&laid.positions, &triangles).is_empty());
        assert_eq!(laid.quality.crossing, 0);
        let (low, high) = bounds(&laid.positions);
        assert!(high.y - low.y < 0.02, "{}", high - low);
        // In the middle of the cuff its own points are the lowest and the highest.
        let place = [0.5 * (low.x + high.x), low.z + 0.035];
        let mut found = heights_near(&laid.positions, place);
        found.sort_by(|a, b| a.1.total_cmp(&b.1));
        let ends = [found[0].0, found[found.len() - 1].0];
        assert!(ends.iter().all(|p| *p >= count), "{found:?}");
    }

    #[test]
    fn a_box_pleat_lies_in_three_layers() {
        // A sheet with a profile that runs forth, back and forth.
        let profile: Vec<[f64; 2]> = (0..=10)
            .map(|k| [0.01 * f64::from(k), 0.02])
            .chain((1..=5).map(|k| [0.1 - 0.01 * f64::from(k), 0.01]))
            .chain((1..=10).map(|k| [0.05 + 0.01 * f64::from(k), 0.0]))
            .collect();
        let across = profile.len() as u32;
        let point = |j: u32, [x, y]: &[f64; 2]| Vec3::new(*x, *y, 0.01 * f64::from(j));
        let points: Vec<Vec3> = (0..11).flat_map(|j| profile.iter().map(move |at| point(j, at))).collect();
        let mut triangles = Vec::new();
        for (j, i) in (0..10).flat_map(|j| (0..across - 1).map(move |i| (j, i))) {
            let [a, b] = [j * across + i, (j + 1) * across + i];
            triangles.extend([[a, b, b + 1], [a, b + 1, a + 1]].map(|t| t.map(PointIndex)));
        }
        let laid = FlatLayout::new(&points, &triangles, 1e-3).expect("lies");
        assert_eq!((laid.quality.layers, laid.quality.crossing), (3, 0), "{:?}", laid.quality);
        let [first, last] = [5 * across + 8, 6 * across - 8].map(|p| laid.positions[p as usize].y);
        assert!(first > last, "the outer part of the pleat lies on top: {first} {last}");
        assert!(laid.quality.strain < 0.05, "{:?}", laid.quality);
    }

    #[test]
    fn copies_in_one_place_are_told_apart() {
        let (mut points, mut triangles) = tube(0.0, 0.0);
        let count = points.len() as u32;
        points.extend_from_within(..);
        let second: Vec<_> = triangles.iter().map(|t| t.map(|p| PointIndex(p.0 + count))).collect();
        triangles.extend(second);
        let laid = FlatLayout::new(&points, &triangles, 1e-3).expect("can lie");
        assert!(self_intersections(&laid.positions, &triangles).is_empty());
        assert_eq!((laid.quality.parts, laid.quality.layers), (2, 4));
    }

    #[test]
    fn what_cannot_be_flat_is_folded_and_told() {
        // A closed egg that stands on its end: its sides have no place in its shadow.
        let rings = 20u32;
        let at = |j: u32, i: u32| {
            let [polar, angle] = [PI * f64::from(j) / f64::from(rings), TAU * f64::from(i) / 40.0];
            0.1 * Vec3::new(polar.sin() * angle.cos(), 3.0 * polar.cos(), polar.sin() * angle.sin())
        };
        let mut points = vec![at(0, 0), at(rings, 0)];
        points.extend((1..rings).flat_map(|j| (0..40).map(move |i| at(j, i))));
        let id = |j: u32, i: u32| match j {
            0 => 0,
            j if j == rings => 1,
            _ => 2 + (j - 1) * 40 + i % 40,
        };
        let mut triangles = Vec::new();
        for (j, i) in (0..rings).flat_map(|j| (0..40).map(move |i| (j, i))) {
            let [a, b, c, d] = [id(j, i), id(j, i + 1), id(j + 1, i + 1), id(j + 1, i)];
            let both = [[a, b, c], [a, c, d]].map(|t| t.map(PointIndex));
            triangles.extend(both.into_iter().filter(|t| t[0] != t[1] && t[1] != t[2] && t[2] != t[0]));
        }
        let laid = FlatLayout::new(&points, &triangles, 1e-3).expect("lies");
        println!("{}", laid.quality);
        assert!(laid.quality.excess > 0.05, "{:?}", laid.quality);
        let (low, high) = bounds(&laid.positions);
        assert!(high.y - low.y < 0.03, "{}", high - low);
        let crossing =
            crease_geometry::mesh::intersections::self_intersecting_triangles(&laid.positions, &triangles);
        assert_eq!(crossing.len(), laid.quality.crossing, "what is told is so");
    }

    #[test]
    fn the_part_that_is_worn_outside_lies_on_top() {
        let (tube, own) = tube(0.0, 0.0);
        let count = tube.len() as u32;
        let wide: Vec<Vec3> = tube.iter().map(|p| Vec3::new(1.1 * p.x, 1.1 * p.y, 0.5 * p.z)).collect();
        let shifted = own.iter().map(|t| t.map(|p| PointIndex(p.0 + count)));
        let triangles: Vec<_> = own.iter().copied().chain(shifted).collect();
        for wide_is_first in [false, true] {
            let [first, second] = if wide_is_first { [&wide, &tube] } else { [&tube, &wide] };
            let points: Vec<Vec3> = first.iter().chain(second).copied().collect();
            let laid = FlatLayout::new(&points, &triangles, 1e-3).expect("can lie");
            let top = |of: &[Vec3]| of.iter().map(|p| p.y).fold(0.0, f64::max);
            let (one, other) = laid.positions.split_at(count as usize);
            assert_eq!(top(one) > top(other), wide_is_first);
        }
    }
}
