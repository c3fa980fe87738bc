//! Cloth that was exported with its thickness: an outer and an inner side some millimetres apart, with a rim along every border or
//! without one.
//!
//! A shell with a rim has no open border at all, which tells it from the front and the back of a garment that lies flat: these are joined
//! at the sides and have openings. The two sides of one without a rim are parts that run along one another at a constant distance, and
//! are curved: flat ones may as well be front and back. One side of a shell is simulated; each point of the other and of the rim is
//! carried by the cloth it lies on, and the hinges of the other side remember what the cloth there remembers.

use crate::garment::tuning::TUNING;
use crate::garment::{Garment, RestState, changed_curvature};
use crease_geometry::math::{Vec3, bounds};
use crease_geometry::mesh::triangle_bvh::TriangleBvh;
use crease_geometry::mesh::{Groups, Hinge, PointIndex, Topology, point_rotations, triangle, turned};
use rustc_hash::FxHashSet;

/// A mesh in which shells are looked for.
#[derive(Debug, Clone, Copy)]
pub(super) struct ShellMesh<'a> {
    /// Positions of the points \[m\].
    pub points: &'a [Vec3],
    /// Corners of the triangles, counter-clockwise from outside.
    pub triangles: &'a [[PointIndex; 3]],
    /// Edges and hinges of the triangles.
    pub topology: &'a Topology,
    /// Per triangle: connected part it belongs to, counted from 0.
    pub part: &'a [u32],
}

impl<'a> From<&'a Garment> for ShellMesh<'a> {
    fn from(garment: &'a Garment) -> Self {
        let Garment { points, triangles, topology, triangle_part: part, .. } = garment;
        Self { points, triangles, topology, part }
    }
}

impl ShellMesh<'_> {
    fn corners(&self, f: usize) -> [Vec3; 3] {
        triangle::corners(self.points, &self.triangles[f])
    }
}

/// Normals of the triangles of `mesh`, zero without area.
fn normals(mesh: ShellMesh) -> Vec<Vec3> {
    let normal = |f: usize| triangle::normal(&mesh.corners(f)).unwrap_or_else(Vec3::zeros);
    (0..mesh.triangles.len()).map(normal).collect()
}

fn centroid(corners: [Vec3; 3]) -> Vec3 {
    corners.iter().sum::<Vec3>() / 3.0
}

/// What is known of the shells of a garment.
#[derive(Debug, Clone, Default)]
pub(super) struct Shells {
    /// Per triangle: whether it belongs to the inner side or the rim of a shell.
    pub inner: Vec<bool>,
    /// Thickness of the thickest of those with a rim; 0 without any \[m\].
    pub thickness: f64,
    /// Thicknesses of parts that are closed all around and as thin as cloth, but whose sides cannot be told apart \[m\].
    pub doubtful: Vec<f64>,
}

impl Shells {
    /// The shells of `mesh`.
    pub fn find(mesh: ShellMesh) -> Self {
        let mut shells = Self { inner: vec![false; mesh.triangles.len()], ..Self::default() };
        let count = mesh.part.iter().max().map_or(0, |&last| last as usize + 1);
        let mut parts: Vec<Vec<usize>> = vec![Vec::new(); count];
        mesh.part.iter().enumerate().for_each(|(f, part)| parts[*part as usize].push(f));
        let measures: Vec<PartMeasure> = parts.iter().map(|part| PartMeasure::new(mesh, part)).collect();
        let pairs = pairs_of_like_size(&measures);
        if pairs.is_empty() && measures.iter().all(|measure| measure.thickness().is_none()) {
            return shells;
        }
        let search = Search::new(mesh);
        for (part, measure) in parts.iter().zip(&measures) {
            let Some(thickness) = measure.thickness() else { continue };
            match search.outer_side(part, thickness) {
                Some(outer) => {
                    shells.thickness = shells.thickness.max(thickness);
                    part.iter().for_each(|f| shells.inner[*f] = true);
                    outer.iter().for_each(|f| shells.inner[*f] = false);
                }
                None => shells.doubtful.push(thickness),
            }
        }
        let mut is_paired = vec![false; count];
        for [outer, inner] in pairs {
            let runs_along = |a: usize, b: usize| search.runs_along(&parts[a], b);
            if !is_paired[outer] && !is_paired[inner] && runs_along(outer, inner) && runs_along(inner, outer)
            {
                (is_paired[outer], is_paired[inner]) = (true, true);
                parts[inner].iter().for_each(|f| shells.inner[*f] = true);
            }
        }
        shells
    }
}

/// Size and shape of a connected part.
#[derive(Debug, Clone, Copy)]
struct PartMeasure {
    /// Whether every edge joins two triangles.
    is_closed: bool,
    /// Enclosed volume, without sign \[m³\].
    volume: f64,
    /// \[m²\].
    area: f64,
    /// Length of the sum of the area vectors \[m²\]: that of the area for a flat sheet, 0 for a closed shape.
    net_area: f64,
    /// Diagonal of the bounding box \[m\].
    diagonal: f64,
}

impl PartMeasure {
    fn new(mesh: ShellMesh, part: &[usize]) -> Self {
        let on_hinge = |e: &u32| mesh.topology.edge_hinge[*e as usize].is_some();
        let is_closed = part.iter().all(|f| mesh.topology.triangle_edges[*f].iter().all(on_hinge));
        let origin = part.first().map_or_else(Vec3::zeros, |f| mesh.corners(*f)[0]);
        let (mut volume, mut area, mut net) = (0.0, 0.0, Vec3::zeros());
        let mut points: Vec<Vec3> = Vec::new();
        for x in part.iter().map(|f| mesh.corners(*f)) {
            let [a, b, c] = x.map(|p| p - origin);
            volume += a.dot(&b.cross(&c)) / 6.0;
            area += triangle::area(&x);
            net += 0.5 * triangle::area_vector(&x);
            points.extend(x);
        }
        let (low, high) = bounds(&points);
        Self {
            is_closed,
            volume: f64::abs(volume),
            area,
            net_area: net.norm(),
            diagonal: (high - low).norm(),
        }
    }

    fn is_trim(&self) -> bool {
        self.diagonal <= TUNING.max_trim_diagonal
    }

    /// The thickness of the part if it is closed all around, as thin as cloth and larger than a trim \[m\].
    fn thickness(&self) -> Option<f64> {
        let thickness = 2.0 * self.volume / self.area.max(f64::MIN_POSITIVE);
        let is_cloth = (TUNING.min_cloth_thickness..=TUNING.max_cloth_thickness).contains(&thickness);
        (self.is_closed && is_cloth && !self.is_trim()).then_some(thickness)
    }

    /// Whether it may be one side of a shell without a rim: it has an opening and is curved. Two flat sheets over one another may as well
    /// be front and back of a garment.
    fn may_be_side(&self) -> bool {
        !self.is_closed && !self.is_trim() && self.net_area < TUNING.max_side_flatness * self.area
    }
}

/// Pairs of parts that may be the two sides of a shell without a rim, the larger first.
fn pairs_of_like_size(measures: &[PartMeasure]) -> Vec<[usize; 2]> {
    let mut sides: Vec<usize> = (0..measures.len()).filter(|part| measures[*part].may_be_side()).collect();
    sides.sort_by(|a, b| measures[*b].area.total_cmp(&measures[*a].area).then(a.cmp(b)));
    let is_like = |a: usize, b: usize| measures[b].area >= TUNING.min_side_area_ratio * measures[a].area;
    (0..sides.len())
        .flat_map(|k| {
            let a = sides[k];
            sides[k + 1..].iter().take_while(move |b| is_like(a, **b)).map(move |b| [a, *b])
        })
        .collect()
}

struct Search<'a> {
    mesh: ShellMesh<'a>,
    normals: Vec<Vec3>,
    areas: Vec<f64>,
    bvh: TriangleBvh,
}

impl<'a> Search<'a> {
    fn new(mesh: ShellMesh<'a>) -> Self {
        Self {
            normals: normals(mesh),
            areas: (0..mesh.triangles.len()).map(|f| triangle::area(&mesh.corners(f))).collect(),
            bvh: TriangleBvh::new(mesh.points, mesh.triangles, 0.0),
            mesh,
        }
    }

    fn area(&self, triangles: &[usize]) -> f64 {
        triangles.iter().map(|f| self.areas[*f]).sum()
    }

    /// The sheets of `part`: triangles that are joined by hinges for which `joins` holds.
    fn sheets(&self, part: &[usize], joins: impl Fn(&Hinge) -> bool) -> Vec<Vec<usize>> {
        let mut groups = Groups::new(self.mesh.triangles.len());
        for hinge in self.mesh.topology.hinges.iter().filter(|hinge| joins(hinge)) {
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
        // A triangle of a side has the other side behind it; one of the rim has not, nor one that is long and as narrow as the rim.
        let mut is_side = vec![false; self.mesh.triangles.len()];
        for &f in part {
            let corners = self.mesh.corners(f);
            let [a, b, c] = corners;
            let shortest =
                [a - b, b - c, c - a].map(|side| side.norm()).into_iter().fold(f64::INFINITY, f64::min);
            if shortest
                < (TUNING.rim_width * thickness).min(TUNING.rim_shape * triangle::longest_side(&corners))
            {
                continue;
            }
            let x = centroid(corners);
            let opposite = |g: u32| {
                let g = g as usize;
                members.contains(&g) && self.normals[f].dot(&self.normals[g]) < -TUNING.min_opposite_cosine
            };
            let reach = TUNING.thickness_reach * thickness;
            is_side[f] = self
                .bvh
                .nearest_where(self.mesh.points, x, reach, opposite)
                .is_some_and(|found| found.closest.vector.dot(&self.normals[f]) > 0.0);
        }
        let of_one_kind = |is_side: &[bool], hinge: &Hinge| {
            let [a, b] = hinge.triangles.map(|f| f as usize);
            is_side[a] == is_side[b]
        };
        // What looks like a rim and touches one side only, such as a fold, belongs to that side.
        let pieces = self.sheets(part, |hinge| of_one_kind(&is_side, hinge));
        let mut piece_of = vec![0; self.mesh.triangles.len()];
        pieces.iter().enumerate().for_each(|(k, piece)| piece.iter().for_each(|f| piece_of[*f] = k));
        let mut touched = vec![FxHashSet::default(); pieces.len()];
        for hinge in &self.mesh.topology.hinges {
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

    /// Whether the triangles `part` run along the part `other` at a constant distance that is a thickness of cloth.
    fn runs_along(&self, part: &[usize], other: usize) -> bool {
        let mut distances: Vec<(f64, f64)> = Vec::with_capacity(part.len());
        let whole = self.area(part);
        for &f in part {
            let is_along = |g: u32| {
                let g = g as usize;
                self.mesh.part[g] as usize == other
                    && self.normals[f].dot(&self.normals[g]).abs() > TUNING.min_side_cosine
            };
            let x = centroid(self.mesh.corners(f));
            let found = self.bvh.nearest_where(self.mesh.points, x, TUNING.max_cloth_thickness, is_along);
            distances.extend(found.map(|found| (found.closest.vector.norm(), self.areas[f])));
        }
        distances.sort_unstable_by(|a, b| a.0.total_cmp(&b.0));
        let mut sum = 0.0;
        let median = distances.iter().find(|(_, area)| {
            sum += area;
            sum >= 0.5 * whole
        });
        let Some(&(median, _)) = median.filter(|(d, _)| *d >= TUNING.min_cloth_thickness) else {
            return false;
        };
        let is_near = |d: f64| (d - median).abs() <= TUNING.thickness_tol * median;
        let near: f64 = distances.iter().filter(|(d, _)| is_near(*d)).map(|(_, area)| area).sum();
        near >= TUNING.min_constant_fraction * whole
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
        let mesh = ShellMesh::from(garment);
        let (own, under) = (normals(mesh), normals(cloth.into()));
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
                let found = nearest(centroid(mesh.corners(f as usize)), Some(normal))?;
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
