//! Parts of a garment that a simulation leaves out and that follow the cloth: the inner sides of shells (`shell`), and trims, small
//! solids of their own such as buttons, rivets and buckles. Trims do not bend; each follows the cloth under it rigidly.
//!
//! A trim is a connected part without any border that is small and lies near cloth. It is carried by the point of the cloth
//! nearest to its centre, and turned as the cloth around that point is.

use crate::garment::shell::InnerSides;
use crate::garment::tuning::TUNING;
use crate::garment::{Garment, RestState, WornGarment};
use crease_geometry::math::{Mat3, Vec3, bounds, nearest_rotation};
use crease_geometry::mesh::triangle_bvh::TriangleBvh;
use crease_geometry::mesh::{PointIndex, Topology, hinge_angle, triangle};
use rustc_hash::FxHashMap;

/// The cloth of a garment, and the trims and inner sides on it.
#[derive(Debug, Clone)]
pub struct RigidParts {
    cloth: Garment,
    /// Per point of the cloth: the point of the garment.
    points: Vec<PointIndex>,
    /// Per triangle of the cloth: the triangle of the garment.
    triangles: Vec<u32>,
    /// Per hinge of the cloth: the hinge of the garment, if it is one there.
    hinges: Vec<Option<u32>>,
    trims: Vec<Trim>,
    inner_sides: InnerSides,
    /// Source positions of the garment \[m\].
    source: Vec<Vec3>,
    /// Hinge angles of the garment in its source shape \[rad\].
    source_angle: Vec<f64>,
    triangle_count: usize,
}

/// A trim and the cloth that carries it; points of the cloth are counted in the cloth.
#[derive(Debug, Clone)]
struct Trim {
    /// Its points, counted in the garment.
    points: Vec<PointIndex>,
    /// Triangle of the cloth under its centre, and barycentric coordinates there.
    corners: [PointIndex; 3],
    weights: [f64; 3],
    /// Cloth that turns it, with weights \[-\].
    carriers: Vec<(PointIndex, f64)>,
}

impl RigidParts {
    /// The trims and inner sides of `garment`; `None` if it has none.
    ///
    /// ```
    /// use crease_model::garment::{Garment, RigidParts};
    /// assert!(RigidParts::find(&Garment::sheet([0.2, 0.2], [2, 2])?).is_none());
    /// # Ok::<(), crease_model::error::Error>(())
    /// ```
    pub fn find(garment: &Garment) -> Option<Self> {
        let parts = parts_of(garment);
        let small: Vec<bool> = parts.iter().map(Part::is_small_solid).collect();
        let is_trim = |f: usize| small[garment.triangle_part[f] as usize] && small.contains(&false);
        let layers = Self::leaving_out(garment, &parts, is_trim, |f| garment.inner_side[f] && !is_trim(f));
        layers.or_else(|| Self::leaving_out(garment, &parts, is_trim, |_| false))
    }

    /// The garment without the triangles for which `is_trim` or `is_inner` holds; `None` if there are none, or if one of these has no
    /// cloth near it.
    fn leaving_out(
        garment: &Garment,
        parts: &[Part],
        is_trim: impl Fn(usize) -> bool,
        is_inner: impl Fn(usize) -> bool,
    ) -> Option<Self> {
        let all = 0..garment.triangles.len();
        let left_out: Vec<bool> = all.clone().map(|f| is_trim(f) || is_inner(f)).collect();
        if !left_out.contains(&true) || !left_out.contains(&false) {
            return None;
        }
        let (cloth, points, triangles) = cloth_of(garment, &left_out);
        let bvh = TriangleBvh::new(&cloth.points, &cloth.triangles, 0.0);
        let neighbours = neighbours_of(&cloth);
        let mut trim_parts: Vec<u32> =
            all.clone().filter(|f| is_trim(*f)).map(|f| garment.triangle_part[f]).collect();
        trim_parts.sort_unstable();
        trim_parts.dedup();
        let mut trims = Vec::new();
        for part in trim_parts {
            // One trim far from any cloth makes the garment one of several solids: all of it is simulated.
            trims.push(Trim::on(&cloth, &bvh, &neighbours, &parts[part as usize])?);
        }
        let mut is_cloth = vec![false; garment.points.len()];
        points.iter().for_each(|p| is_cloth[p.at()] = true);
        let inner: Vec<u32> = all.filter(|f| is_inner(*f)).map(|f| f as u32).collect();
        let hinge_at: FxHashMap<[PointIndex; 2], u32> =
            garment.topology.hinges.iter().zip(0..).map(|(h, i)| (ends(&h.points), i)).collect();
        let own = |p: PointIndex| points[p.at()];
        let hinges = cloth.topology.hinges.iter();
        let angle = |h: &crease_geometry::mesh::Hinge| hinge_angle(&h.points.map(|p| garment.points[p.at()]));
        Some(Self {
            hinges: hinges.map(|h| hinge_at.get(&ends(&h.points.map(own))).copied()).collect(),
            inner_sides: InnerSides::on(garment, &inner, &cloth, &bvh, &is_cloth)?,
            points,
            triangles,
            trims,
            cloth,
            source: garment.points.clone(),
            source_angle: garment.topology.hinges.iter().map(angle).collect(),
            triangle_count: garment.triangles.len(),
        })
    }

    /// The garment without its trims and inner sides.
    pub fn cloth(&self) -> &Garment {
        &self.cloth
    }

    /// Those of `values`, one per point of the garment, that belong to the points of its cloth.
    pub fn at_cloth_points(&self, values: &[f64]) -> Vec<f64> {
        self.points.iter().map(|p| values[p.at()]).collect()
    }

    /// Per triangle of the cloth: the triangle of the garment.
    pub fn cloth_triangles(&self) -> &[u32] {
        &self.triangles
    }

    /// Descriptions for the report.
    pub fn notes(&self) -> Vec<String> {
        let mut notes = Vec::new();
        if !self.trims.is_empty() {
            let points: usize = self.trims.iter().map(|trim| trim.points.len()).sum();
            notes.push(format!(
                "{} small solids of {points} points (buttons and other trims) are not simulated: each follows the cloth under it as \
                 a rigid body",
                self.trims.len()
            ));
        }
        let points = self.inner_sides.point_count();
        if points > 0 {
            notes.push(format!(
                "the cloth was exported with its thickness: {points} points of its inner side and rim are not simulated and follow the \
                 outer side"
            ));
        }
        notes
    }

    /// Positions of the garment \[m\] where its cloth has the positions `cloth`.
    pub fn positions(&self, cloth: &[Vec3]) -> Vec<Vec3> {
        let mut all = self.source.clone();
        for (p, x) in self.points.iter().zip(cloth) {
            all[p.at()] = *x;
        }
        for trim in &self.trims {
            let (anchor, moved) = (trim.anchor(&self.cloth.points), trim.anchor(cloth));
            let rotation = trim.rotation(&self.cloth.points, cloth);
            for p in &trim.points {
                all[p.at()] = moved + rotation * (self.source[p.at()] - anchor);
            }
        }
        self.inner_sides.carry(&self.cloth, cloth, &mut all);
        all
    }

    /// Displacements of the garment from its source pose \[m\] where its cloth has the displacements `cloth`.
    pub fn displacement(&self, cloth: &[Vec3]) -> Vec<Vec3> {
        let moved: Vec<Vec3> = self.cloth.points.iter().zip(cloth).map(|(x, d)| x + d).collect();
        self.positions(&moved).iter().zip(&self.source).map(|(x, source)| x - source).collect()
    }

    /// The worn garment whose cloth is `cloth`; trims have no memory, inner sides that of the cloth they lie on.
    pub fn worn(&self, cloth: &WornGarment) -> WornGarment {
        let mut memory = RestState::new(self.source_angle.clone(), self.triangle_count);
        let own = &cloth.memory;
        copy_entries(own, &mut memory, self.hinge_pairs(), self.triangle_pairs());
        self.inner_sides.remember(&self.cloth, own, &mut memory);
        WornGarment { displacement: self.displacement(&cloth.displacement), memory }
    }

    /// The part of the garment's `memory` that belongs to its cloth.
    pub fn cloth_memory(&self, memory: &RestState) -> RestState {
        let angle =
            |h: &crease_geometry::mesh::Hinge| hinge_angle(&h.points.map(|p| self.cloth.points[p.at()]));
        let mut own = RestState::new(
            self.cloth.topology.hinges.iter().map(angle).collect(),
            self.cloth.triangles.len(),
        );
        let swapped = |[own, whole]: [usize; 2]| [whole, own];
        copy_entries(memory, &mut own, self.hinge_pairs().map(swapped), self.triangle_pairs().map(swapped));
        own
    }

    /// Hinges of the cloth, each with that of the garment.
    fn hinge_pairs(&self) -> impl Iterator<Item = [usize; 2]> {
        self.hinges.iter().enumerate().filter_map(|(own, whole)| whole.map(|whole| [own, whole as usize]))
    }

    /// Triangles of the cloth, each with that of the garment.
    fn triangle_pairs(&self) -> impl Iterator<Item = [usize; 2]> {
        self.triangles.iter().enumerate().map(|(own, whole)| [own, *whole as usize])
    }
}

/// Copies entries of the memory `from` to `to`, by pairs of their numbers in each.
fn copy_entries(
    from: &RestState,
    to: &mut RestState,
    hinges: impl Iterator<Item = [usize; 2]>,
    triangles: impl Iterator<Item = [usize; 2]>,
) {
    for [a, b] in hinges {
        to.source_angle[b] = from.source_angle[a];
        to.rest_angle[b] = from.rest_angle[a];
        to.stiffness_ratio[b] = from.stiffness_ratio[a];
    }
    for [a, b] in triangles {
        to.rest_stretch_warp[b] = from.rest_stretch_warp[a];
        to.rest_stretch_weft[b] = from.rest_stretch_weft[a];
    }
}

impl Trim {
    /// The trim `part` on `cloth`; `None` if no cloth is near.
    fn on(cloth: &Garment, bvh: &TriangleBvh, neighbours: &[Vec<PointIndex>], part: &Part) -> Option<Self> {
        let (low, high) = (part.low, part.high);
        let diagonal = (high - low).norm();
        let centre = (low + high) * 0.5;
        let found = bvh.nearest(&cloth.points, centre, (0.5 + TUNING.max_trim_distance) * diagonal)?;
        let corners = cloth.triangles[found.triangle as usize];
        let weights = found.weights();
        let mut trim = Self { points: part.points.clone(), corners, weights, carriers: Vec::new() };
        let anchor = trim.anchor(&cloth.points);
        let [a, b, c] = triangle::corners(&cloth.points, &corners);
        let edge = (b - a).norm().max((c - b).norm()).max((a - c).norm());
        let radius = (TUNING.trim_carrier_radius * diagonal).max(TUNING.trim_carrier_edges * edge);
        // Connected cloth only: another layer near by turns otherwise.
        let mut open: Vec<PointIndex> = corners.to_vec();
        let mut known = open.clone();
        while let Some(p) = open.pop() {
            let far = (cloth.points[p.at()] - anchor).norm() / radius;
            trim.carriers.push((p, (-far * far).exp().max(f64::MIN_POSITIVE)));
            for &next in &neighbours[p.at()] {
                if (cloth.points[next.at()] - anchor).norm() <= radius && !known.contains(&next) {
                    known.push(next);
                    open.push(next);
                }
            }
        }
        Some(trim)
    }

    /// Position of the point of the cloth that carries it, where the cloth has the positions `x`.
    fn anchor(&self, x: &[Vec3]) -> Vec3 {
        self.corners.iter().zip(self.weights).map(|(p, w)| x[p.at()] * w).sum()
    }

    /// Rotation of the cloth around its anchor from `before` to `after`.
    fn rotation(&self, before: &[Vec3], after: &[Vec3]) -> Mat3 {
        let total: f64 = self.carriers.iter().map(|(_, w)| w).sum();
        let mean = |x: &[Vec3]| self.carriers.iter().map(|(p, w)| x[p.at()] * *w).sum::<Vec3>() / total;
        let (from, to) = (mean(before), mean(after));
        let products = self.carriers.iter();
        let mixed: Mat3 = products
            .map(|(p, w)| (after[p.at()] - to) * (before[p.at()] - from).transpose() * (w / total))
            .sum();
        nearest_rotation(mixed).map_or_else(Mat3::identity, |nearest| nearest.rotation)
    }
}

/// A connected part of a garment.
struct Part {
    points: Vec<PointIndex>,
    low: Vec3,
    high: Vec3,
    /// Whether every edge joins two triangles.
    is_closed: bool,
    /// Signed volume that its triangles enclose \[m³\].
    volume: f64,
}

impl Part {
    fn is_small_solid(&self) -> bool {
        self.is_closed && (self.high - self.low).norm() <= TUNING.max_trim_diagonal && self.volume != 0.0
    }
}

fn parts_of(garment: &Garment) -> Vec<Part> {
    let count = garment.triangle_part.iter().max().map_or(0, |&last| last as usize + 1);
    let mut used = vec![false; garment.points.len()];
    let mut points: Vec<Vec<PointIndex>> = vec![Vec::new(); count];
    let mut closed = vec![true; count];
    let mut volume = vec![0.0; count];
    for (f, t) in garment.triangles.iter().enumerate() {
        let part = garment.triangle_part[f] as usize;
        for p in t {
            if !std::mem::replace(&mut used[p.at()], true) {
                points[part].push(*p);
            }
        }
        closed[part] &= garment.topology.triangle_edges[f]
            .iter()
            .all(|&e| garment.topology.edge_valence[e as usize] == 2);
        let [a, b, c] = triangle::corners(&garment.points, t);
        volume[part] += a.dot(&b.cross(&c)) / 6.0;
    }
    let part = |(k, points): (usize, Vec<PointIndex>)| {
        let (low, high) = bounds(&points.iter().map(|p| garment.points[p.at()]).collect::<Vec<_>>());
        Part { points, low, high, is_closed: closed[k], volume: volume[k] }
    };
    points.into_iter().enumerate().map(part).collect()
}

/// Returns the garment of the triangles that `left_out` does not flag, and its points and triangles in `garment`.
fn cloth_of(garment: &Garment, left_out: &[bool]) -> (Garment, Vec<PointIndex>, Vec<u32>) {
    let kept = |f: &u32| !left_out[*f as usize];
    let triangles: Vec<u32> = (0..garment.triangles.len() as u32).filter(kept).collect();
    let mut number: Vec<Option<PointIndex>> = vec![None; garment.points.len()];
    triangles.iter().flat_map(|&f| garment.triangles[f as usize]).for_each(|p| number[p.at()] = Some(p));
    let points: Vec<PointIndex> = number.iter().copied().flatten().collect();
    for (p, own) in points.iter().zip(0..) {
        number[p.at()] = Some(PointIndex(own));
    }
    let of = |f: &u32| garment.triangles[*f as usize].map(|p| number[p.at()].unwrap_or(PointIndex(0)));
    let own: Vec<[PointIndex; 3]> = triangles.iter().map(of).collect();
    let of_cloth = |t: &[PointIndex; 3]| {
        let [a, b, c] = t.map(|p| number[p.at()]);
        Some([a?, b?, c?])
    };
    let mut parts: Vec<u32> = triangles.iter().map(|&f| garment.triangle_part[f as usize]).collect();
    let mut names = parts.clone();
    names.sort_unstable();
    names.dedup();
    parts.iter_mut().for_each(|part| *part = names.binary_search(part).unwrap_or(0) as u32);
    let cloth = Garment {
        points: points.iter().map(|p| garment.points[p.at()]).collect(),
        material: triangles.iter().map(|&f| garment.material[f as usize]).collect(),
        material_from_uv: garment.material_from_uv,
        // Its vertices are those of the whole garment.
        source_point: Vec::new(),
        memory_mask: points.iter().map(|p| garment.memory_mask[p.at()]).collect(),
        sewing_mask: points.iter().map(|p| garment.sewing_mask[p.at()]).collect(),
        triangle_part: parts,
        triangle_panel: triangles.iter().map(|&f| garment.triangle_panel[f as usize]).collect(),
        inner_side: vec![false; triangles.len()],
        file_triangles: garment.file_triangles.iter().filter_map(of_cloth).collect(),
        on_fold_line: garment.on_fold_line.as_ref().map(|on| points.iter().map(|p| on[p.at()]).collect()),
        topology: Topology::new(points.len(), &own),
        triangles: own,
    };
    (cloth, points, triangles)
}

fn neighbours_of(cloth: &Garment) -> Vec<Vec<PointIndex>> {
    let mut neighbours = vec![Vec::new(); cloth.points.len()];
    for &[a, b] in &cloth.topology.edges {
        neighbours[a.at()].push(b);
        neighbours[b.at()].push(a);
    }
    neighbours
}

/// Ends of a hinge in increasing order.
fn ends(points: &[PointIndex; 4]) -> [PointIndex; 2] {
    crease_geometry::mesh::edge_key(points[0], points[1])
}
