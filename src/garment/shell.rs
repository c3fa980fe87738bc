//! Cloth that was exported with its thickness: an outer and an inner side some millimetres apart, joined by a rim along every border.
//!
//! Such a shell has no open border at all, which tells it from the front and the back of a garment that lies flat: these are joined
//! at the sides and have openings. One side of a shell is simulated; each point of the other and of the rim is carried by the cloth it
//! lies on, and the hinges of the other side remember what the cloth there remembers.

use crate::garment::changed_curvature;
use crate::garment::tuning::TUNING;
use crate::garment::{Garment, RestState};
use crate::math::{Vec3, bounds};
use crate::mesh::triangle_bvh::TriangleBvh;
use crate::mesh::{Groups, Hinge, PointIndex, point_rotations, triangle, turned};
use rustc_hash::FxHashSet;

/// Normals of the triangles of `garment`, zero without area.
fn normals(garment: &Garment) -> Vec<Vec3> {
    let normal = |t: &[PointIndex; 3]| triangle::normal(&triangle::corners(&garment.points, t));
    garment.triangles.iter().map(|t| normal(t).unwrap_or_else(Vec3::zeros)).collect()
}

fn centroid(garment: &Garment, f: usize) -> Vec3 {
    triangle::corners(&garment.points, &garment.triangles[f]).iter().sum::<Vec3>() / 3.0
}

/// What is known of the shells of a garment.
#[derive(Debug, Clone, Default)]
pub(super) struct Shells {
    /// Per triangle: whether it belongs to the inner side or the rim of a shell.
    pub inner: Vec<bool>,
    /// Thicknesses of parts that are closed all around and as thin as cloth, but whose sides cannot be told apart [m].
    pub doubtful: Vec<f64>,
}

impl Shells {
    /// The shells of `garment`.
    pub fn find(garment: &Garment) -> Self {
        let mut shells = Self { inner: vec![false; garment.triangles.len()], doubtful: Vec::new() };
        let count = garment.triangle_part.iter().max().map_or(0, |&last| last as usize + 1);
        let mut parts: Vec<Vec<usize>> = vec![Vec::new(); count];
        garment.triangle_part.iter().enumerate().for_each(|(f, part)| parts[*part as usize].push(f));
        let thin: Vec<(Vec<usize>, f64)> = parts
            .into_iter()
            .filter_map(|part| thickness(garment, &part).map(|thickness| (part, thickness)))
            .collect();
        if thin.is_empty() {
            return shells;
        }
        let search = Search::new(garment);
        for (part, thickness) in thin {
            match search.outer_side(&part, thickness) {
                Some(outer) => {
                    part.iter().for_each(|f| shells.inner[*f] = true);
                    outer.iter().for_each(|f| shells.inner[*f] = false);
                }
                None => shells.doubtful.push(thickness),
            }
        }
        shells
    }
}

/// The thickness of `part` of `garment` if it is closed all around, as thin as cloth and larger than a trim [m].
fn thickness(garment: &Garment, part: &[usize]) -> Option<f64> {
    let topology = &garment.topology;
    let on_hinge = |e: &u32| topology.edge_hinge[*e as usize].is_some();
    if part.is_empty() || !part.iter().all(|f| topology.triangle_edges[*f].iter().all(on_hinge)) {
        return None;
    }
    let corners = |f: &usize| triangle::corners(&garment.points, &garment.triangles[*f]);
    let origin = corners(&part[0])[0];
    let (mut volume, mut area) = (0.0, 0.0);
    let mut points: Vec<Vec3> = Vec::new();
    for x in part.iter().map(corners) {
        let [a, b, c] = x.map(|p| p - origin);
        volume += a.dot(&b.cross(&c)) / 6.0;
        area += triangle::area(&x);
        points.extend(x);
    }
    let (low, high) = bounds(&points);
    let thickness = 2.0 * f64::abs(volume) / area.max(f64::MIN_POSITIVE);
    let is_cloth = (TUNING.min_cloth_thickness..=TUNING.max_cloth_thickness).contains(&thickness);
    (is_cloth && (high - low).norm() > TUNING.max_trim_diagonal).then_some(thickness)
}

struct Search<'a> {
    garment: &'a Garment,
    normals: Vec<Vec3>,
    areas: Vec<f64>,
    bvh: TriangleBvh,
}

impl<'a> Search<'a> {
    fn new(garment: &'a Garment) -> Self {
        let area = |t: &[PointIndex; 3]| triangle::area(&triangle::corners(&garment.points, t));
        Self {
            normals: normals(garment),
            areas: garment.triangles.iter().map(area).collect(),
            bvh: TriangleBvh::new(&garment.points, &garment.triangles, 0.0),
            garment,
        }
    }

    fn area(&self, triangles: &[usize]) -> f64 {
        triangles.iter().map(|f| self.areas[*f]).sum()
    }

    /// The sheets of `part`: triangles that are joined by hinges for which `joins` holds.
    fn sheets(&self, part: &[usize], joins: impl Fn(&Hinge) -> bool) -> Vec<Vec<usize>> {
        let mut groups = Groups::new(self.garment.triangles.len());
        for hinge in self.garment.topology.hinges.iter().filter(|hinge| joins(hinge)) {
            groups.join(hinge.triangles[0], hinge.triangles[1]);
        }
        let mut sheet_of: Vec<(u32, usize)> = part.iter().map(|&f| (groups.find(f as u32), f)).collect();
        sheet_of.sort_unstable();
        sheet_of.chunk_by(|a, b| a.0 == b.0).map(|own| own.iter().map(|(_, f)| *f).collect()).collect()
    }

    /// The larger side of `part`, a solid of that `thickness` [m]; `None` if it does not have two sides of one size with a rim between
    /// them.
    fn outer_side(&self, part: &[usize], thickness: f64) -> Option<Vec<usize>> {
        let members: FxHashSet<usize> = part.iter().copied().collect();
        // A triangle of a side has the other side behind it; one of the rim has not.
        let mut is_side = vec![false; self.garment.triangles.len()];
        for &f in part {
            let x = centroid(self.garment, f);
            let opposite = |g: u32| {
                let g = g as usize;
                members.contains(&g) && self.normals[f].dot(&self.normals[g]) < -TUNING.min_side_cosine
            };
            let reach = TUNING.thickness_reach * thickness;
            is_side[f] = self
                .bvh
                .nearest_where(&self.garment.points, x, reach, opposite)
                .is_some_and(|found| found.closest.vector.dot(&self.normals[f]) > 0.0);
        }
        let of_one_kind = |is_side: &[bool], hinge: &Hinge| {
            let [a, b] = hinge.triangles.map(|f| f as usize);
            is_side[a] == is_side[b]
        };
        // What looks like a rim and touches one side only, such as a fold, belongs to that side.
        let pieces = self.sheets(part, |hinge| of_one_kind(&is_side, hinge));
        let mut piece_of = vec![0; self.garment.triangles.len()];
        pieces.iter().enumerate().for_each(|(k, piece)| piece.iter().for_each(|f| piece_of[*f] = k));
        let mut touched = vec![FxHashSet::default(); pieces.len()];
        for hinge in &self.garment.topology.hinges {
            let [a, b] = hinge.triangles.map(|f| piece_of[f as usize]);
            if a != b {
                touched[a].insert(b);
                touched[b].insert(a);
            }
        }
        for (piece, touched) in pieces.iter().zip(&touched) {
            if touched.len() == 1 && !is_side[piece[0]] {
                piece.iter().for_each(|f| is_side[*f] = true);
            }
        }
        let mut sheets = self.sheets(part, |hinge| of_one_kind(&is_side, hinge));
        sheets.sort_by(|a, b| self.area(b).total_cmp(&self.area(a)).then(a[0].cmp(&b[0])));
        let mut sides = sheets.into_iter().filter(|sheet| is_side[sheet[0]]);
        let (first, second) = (sides.next()?, sides.next()?);
        let is_large = |side: &[usize]| self.area(side) >= TUNING.min_side_area_fraction * self.area(part);
        let has_rim = part.iter().any(|f| !is_side[*f]);
        (is_large(&first) && is_large(&second) && has_rim).then_some(first)
    }
}

/// A point of an inner side and the place of the cloth that carries it.
#[derive(Debug, Clone)]
struct CarriedPoint {
    /// The point, counted in the garment.
    point: PointIndex,
    /// Corners of the triangle of the cloth, counted in the cloth.
    corners: [PointIndex; 3],
    weights: [f64; 3],
    /// From that place to the point in the source pose \[m\].
    offset: Vec3,
}

/// A hinge of an inner side and the cloth under its triangles.
#[derive(Debug, Clone)]
struct CarriedHinge {
    /// The hinge, counted in the garment.
    hinge: u32,
    /// Triangles of the cloth under its two triangles, and whether they face the other side (-1) or the same.
    under: [(u32, f64); 2],
    /// Unit vector across its edge, in the plane of its first triangle.
    across: Vec3,
    /// Width of cloth that it represents \[m\].
    width: f64,
}

/// The inner sides and rims of the shells of a garment, carried by its cloth.
#[derive(Debug, Clone, Default)]
pub(super) struct InnerSides {
    points: Vec<CarriedPoint>,
    hinges: Vec<CarriedHinge>,
}

impl InnerSides {
    /// The triangles `left_out` of `garment`, which are not trims, on `cloth` with the hierarchy `bvh`; `None` if a point has no cloth near
    /// it. `is_cloth` flags the points of the garment that belong to the cloth.
    pub fn on(
        garment: &Garment,
        left_out: &[u32],
        cloth: &Garment,
        bvh: &TriangleBvh,
        is_cloth: &[bool],
    ) -> Option<Self> {
        if left_out.is_empty() {
            return Some(Self::default());
        }
        let (own, under) = (normals(garment), normals(cloth));
        let nearest = |x: Vec3, normal: Option<Vec3>| {
            bvh.nearest_where(&cloth.points, x, 2.0 * TUNING.max_cloth_thickness, |g| {
                normal.is_none_or(|n| n.dot(&under[g as usize]).abs() > TUNING.min_side_cosine)
            })
        };
        let mut points: Vec<PointIndex> = left_out
            .iter()
            .flat_map(|&f| garment.triangles[f as usize])
            .filter(|p| !is_cloth[p.at()])
            .collect();
        points.sort_unstable();
        points.dedup();
        let carried = |point: PointIndex| {
            let x = garment.points[point.at()];
            let found = nearest(x, None)?;
            let corners = cloth.triangles[found.triangle as usize];
            Some(CarriedPoint { point, corners, weights: found.weights(), offset: found.closest.vector })
        };
        let points: Option<Vec<CarriedPoint>> = points.into_iter().map(carried).collect();
        let is_left_out: FxHashSet<u32> = left_out.iter().copied().collect();
        let mut hinges = Vec::new();
        for (hinge, h) in garment.topology.hinges.iter().zip(0..) {
            if !hinge.triangles.iter().all(|f| is_left_out.contains(f)) {
                continue;
            }
            let place = |f: u32| {
                let normal = own[f as usize];
                let found = nearest(centroid(garment, f as usize), Some(normal))?;
                Some((found.triangle, normal.dot(&under[found.triangle as usize]).signum()))
            };
            // A rim, which no cloth faces, remembers nothing.
            let [Some(a), Some(b)] = hinge.triangles.map(place) else { continue };
            let x = hinge.points.map(|p| garment.points[p.at()]);
            let edge = x[1] - x[0];
            let area: f64 = hinge
                .triangles
                .iter()
                .map(|&f| triangle::area(&triangle::corners(&garment.points, &garment.triangles[f as usize])))
                .sum();
            let across = own[hinge.triangles[0] as usize].cross(&edge).try_normalize(0.0);
            hinges.push(CarriedHinge {
                hinge: h,
                under: [a, b],
                across: across.unwrap_or_else(Vec3::zeros),
                // Over edges of all directions the angles then make the curvature they come from.
                width: 2.0 / 3.0 * area / edge.norm().max(f64::MIN_POSITIVE),
            });
        }
        Some(Self { points: points?, hinges })
    }

    /// Number of points that are carried.
    pub fn point_count(&self) -> usize {
        self.points.len()
    }

    /// Sets the positions of the carried points in `all`, one per point of the garment, where `cloth` has the positions `x`.
    pub fn carry(&self, cloth: &Garment, x: &[Vec3], all: &mut [Vec3]) {
        if self.points.is_empty() {
            return;
        }
        let rotations = point_rotations(&cloth.points, &cloth.triangles, x);
        for carried in &self.points {
            let place: Vec3 = carried.corners.iter().zip(carried.weights).map(|(p, w)| x[p.at()] * w).sum();
            all[carried.point.at()] =
                place + turned(&rotations, &carried.corners, &carried.weights, &carried.offset);
        }
    }

    /// Adds what `cloth` remembers under the carried hinges to `memory` of the garment: the curvature there, over their width.
    pub fn remember(&self, cloth: &Garment, own: &RestState, memory: &mut RestState) {
        if self.hinges.is_empty() {
            return;
        }
        let curvature = changed_curvature(cloth, own);
        for carried in &self.hinges {
            let across = |(f, side): &(u32, f64)| {
                side * carried.across.dot(&(curvature[*f as usize] * carried.across))
            };
            let change = 0.5 * carried.under.iter().map(across).sum::<f64>() * carried.width;
            memory.rest_angle[carried.hinge as usize] +=
                change.clamp(-TUNING.max_carried_angle, TUNING.max_carried_angle);
        }
    }
}
