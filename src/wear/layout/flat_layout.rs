//! A garment laid out flat, front over back, as hands do it: without a simulation.
//!
//! Triangles that look up lie in one plane, the others in a plane below; between them runs the rim, where the cloth turns over.
//! In the plane every triangle is as close to its own shape as its neighbours let it be: as rigid as possible (Sorkine and Alexa
//! 2007, in the plane as Liu and others 2008), in turn the best rotation of every triangle and the positions for these rotations.
//! The shape in a file is that of a garment on a body, and its cut is not known: the shape that a triangle has in the plane counts as
//! its cut, up to a strain ([`MAX_CUT_STRAIN`]). What exceeds that makes the wrinkles once the cloth is free. Pieces sewn on along their
//! borders (pockets, plackets, facings) are layers of their own, outside of the cloth they lie on ([`stack_ranks`]).

use crate::wear::layout::layer_gap::{separate, touching};
use crate::wear::layout::sewn_layers::{patches, stack_ranks};
use crate::wear::tuning::TUNING;
use crease_geometry::math::{PlaneStretch, Rng, Vec3, bounds};
use crease_geometry::mesh::intersections::self_intersecting_triangles;
use crease_geometry::mesh::{PointIndex, Topology, triangle};
use crease_linear::ScalarCholesky;
use rustc_hash::FxHashMap;

/// A garment laid out flat. y points up; the lower layer lies at y = 0.
#[derive(Debug, Clone)]
pub(crate) struct FlatLayout {
    /// One per point [m].
    pub positions: Vec<Vec3>,
    /// Per point: by how much it looks up before it is laid, from -1 to 1; the rim is at 0.
    pub level: Vec<f64>,
    /// Strain between the shape in the file and the cut: root mean square over the area [-].
    pub strain: f64,
    /// Fraction of the cloth that does not fit into the plane beyond that and makes wrinkles, by area [-].
    pub excess: f64,
}

/// Largest principal strain between the shape of a triangle in the file and in the cut of the garment [-]: an assumption
/// (`docs/theory/method.md`).
pub const MAX_CUT_STRAIN: f64 = 0.2;

/// Height of the rim between the layers, relative to their distance.
const RIM_HEIGHT: f64 = 0.5;

/// Factor and shapes of the triangles in the plane.
struct Plane<'a> {
    triangles: &'a [[PointIndex; 3]],
    /// Per triangle and corner: cotangent of its angle.
    weights: Vec<[f64; 3]>,
    /// Per triangle: its corners (y = 0), turned over where it looks down [m].
    shapes: Vec<[Vec3; 3]>,
    factor: ScalarCholesky,
}

impl FlatLayout {
    /// Lays out the cloth at `source` [m] (y up), with `gap` [m] between its layers; parts that are not joined are stacked in the order in
    /// which they lie over one another there, others with the largest below. `None` where layers of a part would cross or lie in one
    /// plane: where more than two lie on one another.
    pub fn new(source: &[Vec3], triangles: &[[PointIndex; 3]], gap: f64) -> Option<Self> {
        let topology = Topology::new(source.len(), triangles);
        let parts = patches(&topology, &|_, _, _| true);
        if parts.len() == 1 {
            return Self::of_part(source, triangles, &topology, gap);
        }
        let parts = stacked(parts, source, triangles);
        let mut whole =
            Self { positions: source.to_vec(), level: vec![0.0; source.len()], strain: 0.0, excess: 0.0 };
        let mut base = 0.0;
        for part in &parts {
            let mut members: Vec<usize> = part.iter().flat_map(|f| triangles[*f].map(|p| p.at())).collect();
            members.sort_unstable();
            members.dedup();
            let index = |p: PointIndex| PointIndex(members.partition_point(|q| *q < p.at()) as u32);
            let own: Vec<[PointIndex; 3]> = part.iter().map(|f| triangles[*f].map(index)).collect();
            let points: Vec<Vec3> = members.iter().map(|p| source[*p]).collect();
            let laid = Self::of_part(&points, &own, &Topology::new(points.len(), &own), gap)?;
            for (k, p) in members.iter().enumerate() {
                whole.positions[*p] = laid.positions[k] + Vec3::y() * base;
                whole.level[*p] = laid.level[k];
            }
            let weight = part.len() as f64 / triangles.len() as f64;
            whole.excess += weight * laid.excess;
            whole.strain = whole.strain.hypot(weight.sqrt() * laid.strain);
            base = laid.positions.iter().map(|p| p.y + base).fold(base, f64::max) + gap;
        }
        Some(whole)
    }

    /// Lays out one part.
    fn of_part(
        source: &[Vec3],
        triangles: &[[PointIndex; 3]],
        topology: &Topology,
        gap: f64,
    ) -> Option<Self> {
        let mut weights: Vec<[f64; 3]> =
            triangles.iter().map(|t| cotangents(&triangle::corners(source, t))).collect();
        let level = level_of(source, triangles, topology, &weights)?;
        let mut up = sides(source, triangles, topology, &level);
        let ranks = stack_ranks(source, triangles, topology)?;
        let mut flat: Vec<Vec3> = source.iter().map(|p| Vec3::new(p.x, 0.0, p.z)).collect();
        for round in 0..TUNING.lay.max_layout_rounds {
            let layers = Layers::new(source.len(), triangles, &up, &ranks);
            flat = Plane::new(source, triangles, topology, &weights, &up)?.positions(&flat);
            let (positions, mut crossing) = layers.at(&flat, triangles, gap);
            if crossing.is_empty() {
                return Some(Self::new_of(source, triangles, &flat, positions, level));
            }
            // What is folded over is drawn out between the points around it.
            let mut folded = vec![false; source.len()];
            crossing.iter().for_each(|f| triangles[*f as usize].iter().for_each(|p| folded[p.at()] = true));
            for _ in 0..=round {
                folded = with_neighbours(&folded, topology);
            }
            let drawn_out = drawn_out(&flat, &folded, topology);
            let (positions, left) = layers.at(&drawn_out, triangles, gap);
            if left.is_empty() {
                return Some(Self::new_of(source, triangles, &drawn_out, positions, level));
            }
            crossing.extend(left);
            // Triangles that are folded over are made stiffer, with those around them, until they open. One whose corners all lie on
            // the rim may belong to either layer.
            let mut marked = vec![false; source.len()];
            for f in crossing {
                if round > 0 && triangles[f as usize].iter().all(|p| layers.heights[p.at()] == RIM_HEIGHT) {
                    up[f as usize] = !up[f as usize];
                }
                triangles[f as usize].iter().for_each(|p| marked[p.at()] = true);
            }
            for (t, w) in triangles.iter().zip(&mut weights) {
                if t.iter().any(|p| marked[p.at()]) {
                    w.iter_mut().for_each(|w| *w *= TUNING.lay.stiffening);
                }
            }
        }
        None
    }

    /// The layout of the cloth at `source` with points at `flat` in the plane and at `positions` in layers [m].
    fn new_of(
        source: &[Vec3],
        triangles: &[[PointIndex; 3]],
        flat: &[Vec3],
        positions: Vec<Vec3>,
        level: Vec<f64>,
    ) -> Self {
        let area = |x: &[Vec3], t| triangle::area(&triangle::corners(x, t));
        let (mut excess, mut squares, mut all) = (0.0, 0.0, 0.0);
        for t in triangles {
            let (own, cut) = (area(source, t), stretch_to_cut(source, flat, t));
            excess += (own * cut.area_ratio() - area(flat, t)).max(0.0);
            squares += own * cut.rms_strain().powi(2);
            all += own;
        }
        Self { positions, level, strain: (squares / all).sqrt(), excess: excess / all }
    }
}

/// Returns the parts of a garment at `source` [m], each a list of triangles, from the lowest to the highest: by how much higher than the
/// others they reach where they lie over one another, then by their areas, the largest first.
fn stacked(parts: Vec<Vec<usize>>, source: &[Vec3], triangles: &[[PointIndex; 3]]) -> Vec<Vec<usize>> {
    let cell = |x: &Vec3| [x.x, x.z].map(|along| (along / TUNING.lay.part_cell).floor() as i64);
    let corners = |f: usize| triangle::corners(source, &triangles[f]);
    // Per cell: the parts in it, each with its highest point.
    let mut tops: FxHashMap<[i64; 2], Vec<(usize, f64)>> = FxHashMap::default();
    for (k, part) in parts.iter().enumerate() {
        for x in part.iter().flat_map(|f| corners(*f)) {
            let tops = tops.entry(cell(&x)).or_default();
            match tops.last_mut() {
                Some((last, top)) if *last == k => *top = top.max(x.y),
                _ => tops.push((k, x.y)),
            }
        }
    }
    let mut rise = vec![(0.0, 0.0f64); parts.len()];
    for tops in tops.values().filter(|tops| tops.len() > 1) {
        let mut heights: Vec<f64> = tops.iter().map(|(_, top)| *top).collect();
        heights.sort_unstable_by(|a, b| b.total_cmp(a));
        for (k, top) in tops {
            let highest_other = if *top == heights[0] { heights[1] } else { heights[0] };
            // Counted in whole micrometres, so that the sum does not depend on the order of the cells.
            rise[*k].0 += ((top - highest_other) * 1e6).round();
            rise[*k].1 += 1.0;
        }
    }
    let area = |part: &[usize]| part.iter().map(|f| triangle::area(&corners(*f))).sum::<f64>();
    let key = |(part, (sum, count)): (Vec<usize>, (f64, f64))| (sum / count.max(1.0), area(&part), part);
    let mut keyed: Vec<(f64, f64, Vec<usize>)> = parts.into_iter().zip(rise).map(key).collect();
    keyed.sort_by(|a, b| a.0.total_cmp(&b.0).then(b.1.total_cmp(&a.1)));
    keyed.into_iter().map(|(_, _, part)| part).collect()
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

/// Layers of a garment that lies.
struct Layers {
    /// Per triangle: number of its layer, counted from below.
    of_triangle: Vec<u32>,
    /// Per point: height of its layer, in distances of layers. What looks down without anything sewn on lies at 0, what looks up at
    /// 1; a point that belongs to several layers is in the middle of them.
    heights: Vec<f64>,
    /// Per point: whether it belongs to several layers.
    shared: Vec<bool>,
}

impl Layers {
    /// Layers of triangles that look `up` or down and are stacked outward by `ranks`.
    fn new(point_count: usize, triangles: &[[PointIndex; 3]], up: &[bool], ranks: &[u32]) -> Self {
        let top = ranks.iter().copied().max().unwrap_or(0);
        let layer = |(up, rank): (&bool, &u32)| if *up { top + 1 + rank } else { top - rank };
        let of_triangle: Vec<u32> = up.iter().zip(ranks).map(layer).collect();
        let mut span = vec![[u32::MAX, 0]; point_count];
        for (t, layer) in triangles.iter().zip(&of_triangle) {
            for p in t {
                let [low, high] = span[p.at()];
                span[p.at()] = [low.min(*layer), high.max(*layer)];
            }
        }
        let height = |[low, high]: &[u32; 2]| 0.5 * (f64::from(*low) + f64::from(*high)) - f64::from(top);
        Self {
            of_triangle,
            heights: span.iter().map(height).collect(),
            shared: span.iter().map(|[low, high]| low < high).collect(),
        }
    }

    /// Positions of points at `flat` in the plane, in layers that are `gap` apart [m], and the triangles that cross or touch there.
    fn at(&self, flat: &[Vec3], triangles: &[[PointIndex; 3]], gap: f64) -> (Vec<Vec3>, Vec<u32>) {
        let mut positions: Vec<Vec3> =
            flat.iter().zip(&self.heights).map(|(p, h)| p + Vec3::y() * (gap * h)).collect();
        separate(&mut positions, triangles, &self.of_triangle, &self.shared, 0.5 * gap);
        let mut crossing = crossing_triangles(&positions, triangles, &self.shared, gap);
        crossing.extend(touching(&positions, triangles, TUNING.lay.touch_fraction * gap));
        crossing.sort_unstable();
        crossing.dedup();
        (positions, crossing)
    }
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

/// Cotangents of the angles of a triangle, bounded.
fn cotangents(x: &[Vec3; 3]) -> [f64; 3] {
    [0, 1, 2].map(|k| {
        let (a, b) = (x[(k + 1) % 3] - x[k], x[(k + 2) % 3] - x[k]);
        let cotangent = a.dot(&b) / a.cross(&b).norm().max(f64::MIN_POSITIVE);
        cotangent.clamp(TUNING.lay.min_cotangent, TUNING.lay.max_cotangent)
    })
}

/// Factor of D + L: `diagonal` is D, L the cotangent Laplacian times `factor`. Every edge is one entry: of a fine file a list by triangles
/// would be the largest piece of memory of the whole bake.
fn laplacian(
    topology: &Topology,
    weights: &[[f64; 3]],
    diagonal: &[f64],
    factor: f64,
) -> Option<ScalarCholesky> {
    let mut of_edge = vec![0.0; topology.edges.len()];
    for (edges, w) in topology.triangle_edges.iter().zip(weights) {
        // Edge k runs from corner k to the next: across from it is the third.
        for (k, edge) in edges.iter().enumerate() {
            of_edge[*edge as usize] += factor * w[(k + 2) % 3];
        }
    }
    let mut sums = diagonal.to_vec();
    let mut entries = Vec::with_capacity(sums.len() + of_edge.len());
    for ([a, b], weight) in topology.edges.iter().zip(&of_edge) {
        sums[a.at()] += weight;
        sums[b.at()] += weight;
        entries.push((a.0.max(b.0), a.0.min(b.0), -weight));
    }
    entries.extend((0..).zip(&sums).map(|(p, sum)| (p, p, *sum)));
    ScalarCholesky::new(diagonal.len(), &entries)
}

/// Per point: the upward part of the normal, averaged over the surface nearby.
fn level_of(
    positions: &[Vec3],
    triangles: &[[PointIndex; 3]],
    topology: &Topology,
    weights: &[[f64; 3]],
) -> Option<Vec<f64>> {
    let mut normal = vec![Vec3::zeros(); positions.len()];
    let mut area = vec![0.0; positions.len()];
    for t in triangles {
        let n = triangle::area_vector(&triangle::corners(positions, t));
        for p in t {
            normal[p.at()] += n;
            area[p.at()] += n.norm() / 3.0;
        }
    }
    let (low, high) = bounds(positions);
    let reach = TUNING.lay.side_smoothing * (high - low).max();
    let factor = laplacian(topology, weights, &area, 0.5 * reach * reach)?;
    let upward = |(n, a): (&Vec3, &f64)| a * n.y / n.norm().max(f64::MIN_POSITIVE);
    let mut level: Vec<f64> = normal.iter().zip(&area).map(upward).collect();
    factor.solve(&mut level);
    Some(level)
}

/// Per triangle: whether it belongs to the upper layer. Patches of one side that are small join the other.
fn sides(positions: &[Vec3], triangles: &[[PointIndex; 3]], topology: &Topology, level: &[f64]) -> Vec<bool> {
    let mut up: Vec<bool> =
        triangles.iter().map(|t| t.iter().map(|p| level[p.at()]).sum::<f64>() > 0.0).collect();
    let area = |f: &usize| triangle::area(&triangle::corners(positions, &triangles[*f]));
    let total: f64 = (0..triangles.len()).map(|f| area(&f)).sum();
    let before = up.clone();
    for patch in patches(topology, &|_, f, g| before[f] == before[g]) {
        if patch.iter().map(area).sum::<f64>() < TUNING.lay.min_side_fraction * total {
            patch.iter().for_each(|f| up[*f] = !up[*f]);
        }
    }
    up
}

impl<'a> Plane<'a> {
    fn new(
        positions: &[Vec3],
        triangles: &'a [[PointIndex; 3]],
        topology: &Topology,
        weights: &[[f64; 3]],
        up: &[bool],
    ) -> Option<Self> {
        let shape = |(t, up): (&[PointIndex; 3], &bool)| {
            let x = triangle::corners(positions, t);
            let along = x[1] - x[0];
            let across = x[2] - x[0];
            let length = along.norm().max(f64::MIN_POSITIVE);
            let foot = along.dot(&across) / length;
            let height = (across.norm_squared() - foot * foot).max(0.0).sqrt();
            // Counter-clockwise from above (x to -z) where it looks up.
            let side = if *up { -height } else { height };
            [Vec3::zeros(), Vec3::new(length, 0.0, 0.0), Vec3::new(foot, 0.0, side)]
        };
        // So weak that it only fixes the place.
        let held = vec![TUNING.lay.place_weight; positions.len()];
        let factor = laplacian(topology, weights, &held, 1.0)?;
        let shapes = triangles.iter().zip(up).map(shape).collect();
        Some(Self { triangles, weights: weights.to_vec(), shapes, factor })
    }

    /// Positions in the plane (y = 0) [m], from the projection of `start`.
    fn positions(&self, start: &[Vec3]) -> Vec<Vec3> {
        let count = start.len();
        let mut x: Vec<Vec3> = start.iter().map(|p| Vec3::new(p.x, 0.0, p.z)).collect();
        let home: Vec<Vec3> = x.iter().map(|p| p * TUNING.lay.place_weight).collect();
        for _ in 0..TUNING.lay.max_layout_iterations {
            // The coordinates of all points along x, then along z.
            let mut rhs: Vec<f64> = home.iter().map(|p| p.x).chain(home.iter().map(|p| p.z)).collect();
            for ((t, w), shape) in self.triangles.iter().zip(&self.weights).zip(&self.shapes) {
                // Rotation in the plane that brings the shape closest to its place.
                let (mut cos, mut sin) = (0.0, 0.0);
                for (k, w) in w.iter().enumerate() {
                    let (i, j) = ((k + 1) % 3, (k + 2) % 3);
                    let (at, own) = (x[t[i].at()] - x[t[j].at()], shape[i] - shape[j]);
                    cos += w * (at.x * own.x + at.z * own.z);
                    sin += w * (at.z * own.x - at.x * own.z);
                }
                let length = cos.hypot(sin).max(f64::MIN_POSITIVE);
                let (cos, sin) = (cos / length, sin / length);
                for (k, w) in w.iter().enumerate() {
                    let (i, j) = ((k + 1) % 3, (k + 2) % 3);
                    let own = (shape[i] - shape[j]) * *w;
                    let (along, across) = (cos * own.x - sin * own.z, sin * own.x + cos * own.z);
                    for (p, sign) in [(t[i].at(), 1.0), (t[j].at(), -1.0)] {
                        rhs[p] += sign * along;
                        rhs[count + p] += sign * across;
                    }
                }
            }
            self.factor.solve(&mut rhs);
            let next: Vec<Vec3> = (0..count).map(|p| Vec3::new(rhs[p], 0.0, rhs[count + p])).collect();
            let change = x.iter().zip(&next).map(|(a, b)| (a - b).norm()).fold(0.0, f64::max);
            x = next;
            if change < TUNING.lay.layout_tol {
                break;
            }
        }
        x
    }
}

/// Triangles that cross others or lie in one plane with them: that cross once the heights of points of a single layer are
/// changed at random by less than the gap.
fn crossing_triangles(
    positions: &[Vec3],
    triangles: &[[PointIndex; 3]],
    shared: &[bool],
    gap: f64,
) -> Vec<u32> {
    let mut random = Rng::from_seed(1);
    let mut shake = |shared: bool| {
        let by = TUNING.lay.shake * (random.uniform() - 0.5);
        if shared { 0.0 } else { gap * by }
    };
    let perturbed: Vec<Vec3> =
        positions.iter().zip(shared).map(|(p, shared)| p + Vec3::y() * shake(*shared)).collect();
    self_intersecting_triangles(&perturbed, triangles)
}

#[cfg(test)]
mod tests {
    use super::*;
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
            assert!(laid.excess < 0.08, "a tube is flat but for its rim: {}", laid.excess);
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
        assert!(straight.strain < 1e-3 && straight.excess < 1e-12, "{} {}", straight.strain, straight.excess);
        // A waist fits by strains that a cut may have, a barrel four times as wide as its ends does not.
        assert!(waisted.strain > 0.01 && waisted.excess < 1e-12, "{} {}", waisted.strain, waisted.excess);
        assert!(
            barrel.strain > waisted.strain && barrel.excess > 5e-3,
            "{} {}",
            barrel.strain,
            barrel.excess
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

    #[test]
    fn parts_are_stacked() {
        let (mut points, mut triangles) = tube(0.0, 0.0);
        let count = points.len() as u32;
        points.extend_from_within(..);
        let second: Vec<_> = triangles.iter().map(|t| t.map(|p| PointIndex(p.0 + count))).collect();
        triangles.extend(second);
        let laid = FlatLayout::new(&points, &triangles, 1e-3).expect("can lie");
        let [lower, upper] = [&laid.positions[..count as usize], &laid.positions[count as usize..]];
        let top = lower.iter().map(|p| p.y).fold(0.0, f64::max);
        assert!(upper.iter().all(|p| p.y > top), "copies in one place are laid on one another");
        assert!(self_intersections(&laid.positions, &triangles).is_empty());
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
