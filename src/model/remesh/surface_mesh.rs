//! A triangle mesh that lies on the surface of a garment and is changed by local operations: split, collapse, flip.
//!
//! Every point knows its location on the garment (a triangle and barycentric weights), so that it stays on the
//! surface whatever is done. Curves are edges that keep their course: open borders, seams, sharp edges, non-manifold
//! junctions, borders between parts, and lines drawn on the surface by [`SurfaceMesh::cut`]. A collapse follows a curve
//! or ends on it and never leaves it; the link condition (Dey and others 1999) keeps the topology.
//!
//! Does not decide which edges are too long or too short (`sizing`, `improve`).

use crate::garment::material_coords::project_to_plane;
use crate::garment::{Garment, is_feature_hinge};
use crate::remesh::tuning::TUNING;
use crease_geometry::math::Vec3;
use crease_geometry::mesh::distance::{barycentric, point_triangle, point_triangle_squared};
use crease_geometry::mesh::triangle::{normal, quality as triangle_quality};
use crease_geometry::mesh::{INVALID, PointIndex, edge_key};
use rustc_hash::FxHashMap;

/// Kind of a curve of the mesh.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Curve {
    /// An open border of the garment.
    Border,
    /// A sharp edge, a seam, a junction of more than two triangles.
    Feature,
    /// A line drawn on the surface, by its number.
    Line(u32),
    /// The line along which the garment turns over where it is laid out flat.
    Rim,
}

/// A location on the garment's surface.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SurfacePoint {
    /// Triangle of the garment.
    pub face: u32,
    /// Barycentric weights of its corners, 0 to 1.
    pub weights: [f64; 3],
}

impl SurfacePoint {
    /// Corner `k` of triangle `face`.
    pub fn corner(face: u32, k: usize) -> Self {
        let mut weights = [0.0; 3];
        weights[k] = 1.0;
        Self { face, weights }
    }
}

/// A point that a cut has made.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CutPoint {
    /// Ends of the edge it was made on.
    pub ends: [u32; 2],
    /// Weight of the second end, 0 to 1.
    pub weight: f64,
}

/// The mesh under construction.
#[derive(Debug, Clone)]
pub struct SurfaceMesh<'a> {
    /// The garment whose surface it lies on.
    pub source: &'a Garment,
    /// Position of every point [m]; also of those that no triangle uses any more.
    pub x: Vec<Vec3>,
    /// Location of every point on the garment.
    pub location: Vec<SurfacePoint>,
    /// Corners of every triangle, dead ones included.
    pub triangles: Vec<[u32; 3]>,
    /// Whether a triangle is part of the mesh.
    pub alive: Vec<bool>,
    /// Per triangle: a number that both halves of a split triangle inherit; 0 at first.
    pub tag: Vec<u32>,
    /// Triangles at every point.
    pub around: Vec<Vec<u32>>,
    /// Per triangle: the one that it was split from; itself for those of the garment.
    parent: Vec<u32>,
    /// Per triangle: a triangle of the garment on the same sheet.
    home: Vec<u32>,
    /// Per triangle: unit warp.
    warp: Vec<Vec3>,
    /// Per triangle: unit normal it was made with.
    normal: Vec<Vec3>,
    curves: FxHashMap<[u32; 2], Curve>,
    /// Per point: number of curve edges that end there.
    curve_degree: Vec<u32>,
    /// Points that no operation removes.
    fixed: Vec<bool>,
    /// Per edge of the garment: whether a search for the closest point of the surface stops there.
    barrier: Vec<bool>,
}

/// Unit normal of a triangle, zero for one without area.
pub(super) fn unit_normal(x: &[Vec3; 3]) -> Vec3 {
    normal(x).unwrap_or_else(Vec3::zeros)
}

impl<'a> SurfaceMesh<'a> {
    /// The garment's own triangles.
    pub fn new(source: &'a Garment) -> Self {
        let triangles: Vec<[u32; 3]> = source.triangles.iter().map(|t| t.map(|p| p.0)).collect();
        let count = source.points.len();
        let mut around = vec![Vec::new(); count];
        let mut location = vec![SurfacePoint { face: 0, weights: [1.0, 0.0, 0.0] }; count];
        for (f, t) in triangles.iter().enumerate() {
            for (k, &p) in t.iter().enumerate() {
                around[p as usize].push(f as u32);
                location[p as usize] = SurfacePoint::corner(f as u32, k);
            }
        }
        let corners = |t: &[u32; 3]| t.map(|p| source.points[p as usize]);
        let warp = triangles.iter().zip(&source.material).map(|(t, flat)| {
            let x = corners(t);
            let (side, flat_side) = (x[1] - x[0], flat[1] - flat[0]);
            let along = side.try_normalize(0.0).unwrap_or_else(Vec3::x);
            let angle = flat_side.y.atan2(flat_side.x);
            along * angle.cos() - unit_normal(&x).cross(&along) * angle.sin()
        });
        let mut mesh = Self {
            x: source.points.clone(),
            location,
            parent: (0..triangles.len() as u32).collect(),
            home: (0..triangles.len() as u32).collect(),
            warp: warp.collect(),
            normal: triangles.iter().map(|t| unit_normal(&corners(t))).collect(),
            alive: vec![true; triangles.len()],
            tag: vec![0; triangles.len()],
            triangles,
            around,
            curves: FxHashMap::default(),
            curve_degree: vec![0; count],
            fixed: vec![false; count],
            barrier: vec![false; source.topology.edges.len()],
            source,
        };
        mesh.find_source_curves();
        mesh
    }

    fn find_source_curves(&mut self) {
        let topology = &self.source.topology;
        for (e, ends) in topology.edges.iter().enumerate() {
            let curve = match topology.edge_hinge[e] {
                None if topology.edge_valence[e] == 1 => Some(Curve::Border),
                None => Some(Curve::Feature),
                Some(h) => {
                    is_feature_hinge(self.source, &topology.hinges[h as usize]).then_some(Curve::Feature)
                }
            };
            if let Some(curve) = curve {
                self.barrier[e] = true;
                self.add_curve(ends[0].0, ends[1].0, curve);
            }
        }
        // A point that keeps the course of an irregular junction stays where it is.
        for (e, ends) in topology.edges.iter().enumerate() {
            if topology.edge_valence[e] > 2 {
                ends.iter().for_each(|p| self.fixed[p.at()] = true);
            }
        }
    }

    /// Keeps a point where it is.
    pub fn fix(&mut self, point: u32) {
        self.fixed[point as usize] = true;
    }

    fn add_curve(&mut self, a: u32, b: u32, curve: Curve) {
        if self.curves.insert(edge_key(a, b), curve).is_none() {
            self.curve_degree[a as usize] += 1;
            self.curve_degree[b as usize] += 1;
        }
    }

    fn remove_curve(&mut self, a: u32, b: u32) -> Option<Curve> {
        let curve = self.curves.remove(&edge_key(a, b))?;
        self.curve_degree[a as usize] -= 1;
        self.curve_degree[b as usize] -= 1;
        Some(curve)
    }

    /// The curve that an edge belongs to.
    pub fn curve(&self, a: u32, b: u32) -> Option<Curve> {
        self.curves.get(&edge_key(a, b)).copied()
    }

    /// Whether an edge at a point belongs to a line that was drawn.
    pub fn is_on_line(&self, p: u32) -> bool {
        self.neighbours(p).iter().any(|&q| matches!(self.curve(p, q), Some(Curve::Line(_))))
    }

    /// Number of curve edges at a point.
    pub fn curve_degree(&self, p: u32) -> u32 {
        self.curve_degree[p as usize]
    }

    /// Corner positions of a triangle [m].
    pub fn corners(&self, f: u32) -> [Vec3; 3] {
        self.triangles[f as usize].map(|p| self.x[p as usize])
    }

    /// Length of an edge [m].
    pub fn length(&self, a: u32, b: u32) -> f64 {
        (self.x[a as usize] - self.x[b as usize]).norm()
    }

    /// Points at the other ends of the edges at `p`, sorted.
    pub fn neighbours(&self, p: u32) -> Vec<u32> {
        let corners = self.around[p as usize].iter().flat_map(|&f| self.triangles[f as usize]);
        let mut all: Vec<u32> = corners.filter(|&q| q != p).collect();
        all.sort_unstable();
        all.dedup();
        all
    }

    /// Every edge once, ends in increasing order, sorted.
    pub fn edges(&self) -> Vec<[u32; 2]> {
        let living = self.triangles.iter().zip(&self.alive).filter(|(_, alive)| **alive);
        let mut edges: Vec<[u32; 2]> =
            living.flat_map(|(t, _)| [0, 1, 2].map(|k| edge_key(t[k], t[(k + 1) % 3]))).collect();
        edges.sort_unstable();
        edges.dedup();
        edges
    }

    /// Triangles on an edge.
    fn triangles_on(&self, a: u32, b: u32) -> Vec<u32> {
        let at = self.around[a as usize].iter().copied();
        at.filter(|&f| self.triangles[f as usize].contains(&b)).collect()
    }

    /// Location of the point of the surface closest to `target`, found by walking from triangle `start` of the garment
    /// without leaving its sheet.
    pub fn locate(&self, start: u32, target: &Vec3) -> (SurfacePoint, Vec3) {
        let source = self.source;
        let corners = |f: u32| source.triangles[f as usize].map(|p| source.points[p.at()]);
        let squared = |f: u32| {
            let [a, b, c] = corners(f);
            point_triangle_squared(target, &a, &b, &c)
        };
        let (mut face, mut best) = (start, squared(start));
        let mut last = u32::MAX;
        for _ in 0..TUNING.max_walk {
            let mut next = None;
            for &e in &source.topology.triangle_edges[face as usize] {
                if self.barrier[e as usize] {
                    continue;
                }
                for &g in &source.topology.edge_triangles[e as usize] {
                    if g == face || g == last || g == INVALID {
                        continue;
                    }
                    let d = squared(g);
                    if d < best {
                        (best, next) = (d, Some(g));
                    }
                }
            }
            // Around a corner both neighbours may be equally far while the second ring is nearer.
            if next.is_none() {
                next = self.second_ring(face, best, &squared);
                if let Some(g) = next {
                    best = squared(g);
                }
            }
            match next {
                Some(g) => (last, face) = (face, g),
                None => break,
            }
        }
        let [a, b, c] = corners(face);
        let gap = point_triangle(target, &a, &b, &c);
        let weights = [-gap.weights[1], -gap.weights[2], -gap.weights[3]].map(|w| w.max(0.0));
        let position = a * weights[0] + b * weights[1] + c * weights[2];
        (SurfacePoint { face, weights }, position)
    }

    fn second_ring(&self, face: u32, best: f64, squared: &impl Fn(u32) -> f64) -> Option<u32> {
        let topology = &self.source.topology;
        let across = |f: u32| {
            let sides =
                topology.triangle_edges[f as usize].into_iter().filter(|&e| !self.barrier[e as usize]);
            sides.flat_map(|e| topology.edge_triangles[e as usize]).filter(move |&g| g != f && g != INVALID)
        };
        let ring = across(face).flat_map(across).filter(|&g| g != face);
        ring.map(|g| (squared(g), g))
            .filter(|(d, _)| *d < best)
            .min_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)))
            .map(|(_, g)| g)
    }

    /// Splits the edge at `weight` of its second end. Returns the new point.
    pub fn split(&mut self, a: u32, b: u32, weight: f64) -> u32 {
        let on = self.triangles_on(a, b);
        let middle = self.x[a as usize] * (1.0 - weight) + self.x[b as usize] * weight;
        let start = on.first().map_or(0, |&f| self.home[f as usize]);
        let (location, position) = self.locate(start, &middle);
        let new = self.x.len() as u32;
        self.x.push(position);
        self.location.push(location);
        self.around.push(Vec::new());
        self.curve_degree.push(0);
        self.fixed.push(false);
        for f in on {
            let t = self.triangles[f as usize];
            let g = self.triangles.len() as u32;
            // One half keeps the number and the end `a`.
            self.triangles[f as usize] = t.map(|p| if p == b { new } else { p });
            self.triangles.push(t.map(|p| if p == a { new } else { p }));
            self.alive.push(true);
            self.tag.push(self.tag[f as usize]);
            self.parent.push(f);
            self.home.push(self.home[f as usize]);
            self.warp.push(self.warp[f as usize]);
            self.normal.push(self.normal[f as usize]);
            self.around[b as usize].retain(|&h| h != f);
            self.around[b as usize].push(g);
            if let Some(&c) = t.iter().find(|&&p| p != a && p != b) {
                self.around[c as usize].push(g);
            }
            self.around[new as usize].extend([f, g]);
        }
        if let Some(curve) = self.remove_curve(a, b) {
            self.add_curve(a, new, curve);
            self.add_curve(new, b, curve);
        }
        new
    }

    /// Cuts the mesh along the zero line of `level` (one value per point, linear on every triangle). Appends the level 0 of
    /// every new point to `level` and returns the new points in order.
    pub fn cut(&mut self, level: &mut Vec<f64>) -> Vec<CutPoint> {
        let crossed: Vec<[u32; 2]> = self
            .edges()
            .into_iter()
            .filter(|[a, b]| {
                let [a, b] = [level[*a as usize], level[*b as usize]];
                a.abs() > TUNING.on_line && b.abs() > TUNING.on_line && (a < 0.0) != (b < 0.0)
            })
            .collect();
        let mut made = Vec::with_capacity(crossed.len());
        for [a, b] in crossed {
            let [la, lb] = [level[a as usize], level[b as usize]];
            let weight = la / (la - lb);
            self.split(a, b, weight);
            level.push(0.0);
            made.push(CutPoint { ends: [a, b], weight });
        }
        made
    }

    /// Edges on the zero line of `level`.
    pub fn edges_on_line(&self, level: &[f64]) -> Vec<[u32; 2]> {
        let on = |p: u32| level[p as usize].abs() <= TUNING.on_line;
        self.edges().into_iter().filter(|[a, b]| on(*a) && on(*b)).collect()
    }

    /// Makes an edge part of `curve`, unless it belongs to another one already.
    pub fn draw(&mut self, a: u32, b: u32, curve: Curve) {
        if self.curve(a, b).is_none() {
            self.add_curve(a, b, curve);
        }
    }

    /// Quality (smallest shape) of the triangles that a collapse of `from` onto `to` leaves, with the smallest shape
    /// before; `None` if the collapse is not possible.
    pub fn collapse_quality(&self, from: u32, to: u32) -> Option<[f64; 2]> {
        if self.fixed[from as usize] {
            return None;
        }
        match self.curve_degree[from as usize] {
            0 => {}
            2 => self.curve_allows(from, to).or_else(|| self.welds(from, to))?,
            _ => self.welds(from, to)?,
        }
        let shared = self.triangles_on(from, to).len();
        let (own, other) = (self.neighbours(from), self.neighbours(to));
        let common = own.iter().filter(|p| other.binary_search(p).is_ok()).count();
        if common != shared || shared == 0 || self.around[from as usize].len() <= shared {
            return None;
        }
        let (mut after, mut before) = (f64::INFINITY, f64::INFINITY);
        for &f in &self.around[from as usize] {
            let t = self.triangles[f as usize];
            let old = self.corners(f);
            before = before.min(triangle_quality(&old));
            if t.contains(&to) {
                continue;
            }
            let new = t.map(|p| self.x[if p == from { to } else { p } as usize]);
            let normal = unit_normal(&new);
            let flat = triangle_quality(&old) < TUNING.degenerate_shape
                || normal.dot(&unit_normal(&old)) >= TUNING.min_normal_cosine;
            if !flat || normal.dot(&self.normal[f as usize]) < TUNING.min_drift_cosine {
                return None;
            }
            after = after.min(triangle_quality(&new));
        }
        Some([after, before])
    }

    /// Whether a point where curves meet may be drawn to another next to it: both are one place for all that a mesh can show. A point
    /// of a border or feature stays on it.
    fn welds(&self, from: u32, to: u32) -> Option<()> {
        let line = |curve: Option<Curve>| matches!(curve, None | Some(Curve::Line(_) | Curve::Rim));
        let on_lines = self.neighbours(from).into_iter().all(|q| line(self.curve(from, q)));
        let near = self.length(from, to) < TUNING.weld_length && self.curve_degree[to as usize] > 0;
        (near && (on_lines || !line(self.curve(from, to)))).then_some(())
    }

    fn curve_allows(&self, from: u32, to: u32) -> Option<()> {
        let curve = self.curve(from, to)?;
        let other = self.neighbours(from).into_iter().find(|&q| q != to && self.curve(from, q).is_some())?;
        if self.curve(from, other) != Some(curve) || self.curve(to, other).is_some() {
            return None;
        }
        let [x, a, b] = [from, to, other].map(|p| self.x[p as usize]);
        let (ahead, back) = (a - x, x - b);
        let straight = ahead.dot(&back) >= TUNING.min_curve_cosine * ahead.norm() * back.norm();
        let along = (a - b).try_normalize(0.0)?;
        let deviation = (x - b).cross(&along).norm();
        (straight && deviation <= TUNING.max_curve_deviation).then_some(())
    }

    /// Removes `from`, its triangles drawn to `to`.
    pub fn collapse(&mut self, from: u32, to: u32) {
        for q in self.neighbours(from) {
            let Some(curve) = self.remove_curve(from, q) else { continue };
            if q != to && self.curve(q, to).is_none() {
                self.add_curve(q, to, curve);
            }
        }
        for f in std::mem::take(&mut self.around[from as usize]) {
            let t = self.triangles[f as usize];
            if t.contains(&to) {
                self.alive[f as usize] = false;
                for p in t.into_iter().filter(|&p| p != from) {
                    self.around[p as usize].retain(|&g| g != f);
                }
                continue;
            }
            self.triangles[f as usize] = t.map(|p| if p == from { to } else { p });
            self.around[to as usize].push(f);
            self.turn_warp(f);
        }
    }

    /// Brings the warp of a triangle back into its plane.
    fn turn_warp(&mut self, f: u32) {
        let x = self.corners(f);
        let f = f as usize;
        self.warp[f] = project_to_plane(&x, self.warp[f]).unwrap_or(self.warp[f]);
    }

    /// Flips the edge where that makes the smaller shape of its two triangles larger. Returns whether it did.
    pub fn flip(&mut self, a: u32, b: u32) -> bool {
        if self.curve(a, b).is_some() {
            return false;
        }
        let &[f, g] = self.triangles_on(a, b).as_slice() else { return false };
        // f = (p, q, c), g = (q, p, d).
        let t = self.triangles[f as usize];
        let Some(k) = (0..3).find(|&k| edge_key(t[k], t[(k + 1) % 3]) == edge_key(a, b)) else {
            return false;
        };
        let (p, q, c) = (t[k], t[(k + 1) % 3], t[(k + 2) % 3]);
        let Some(&d) = self.triangles[g as usize].iter().find(|&&x| x != p && x != q) else { return false };
        if c == d || self.triangles_on(c, d).len() + usize::from(self.curve(c, d).is_some()) > 0 {
            return false;
        }
        let new = [[c, d, q], [d, c, p]];
        let old = [f, g].map(|f| self.corners(f));
        let made = new.map(|t| t.map(|p| self.x[p as usize]));
        let quality = |x: &[[Vec3; 3]; 2]| triangle_quality(&x[0]).min(triangle_quality(&x[1]));
        if quality(&made) <= quality(&old) + 1e-9 {
            return false;
        }
        let smooth = made.iter().all(|x| {
            let own = unit_normal(x);
            let like = |y: &[Vec3; 3]| {
                triangle_quality(y) < TUNING.degenerate_shape
                    || own.dot(&unit_normal(y)) > TUNING.min_normal_cosine
            };
            old.iter().all(like)
                && [f, g].iter().all(|f| own.dot(&self.normal[*f as usize]) > TUNING.min_drift_cosine)
        });
        if !smooth {
            return false;
        }
        let mut warp = [self.warp[f as usize], self.warp[g as usize]];
        if warp[0].dot(&warp[1]) < 0.0 {
            warp[1] = -warp[1];
        }
        let normal = (self.normal[f as usize] + self.normal[g as usize]).try_normalize(0.0);
        for (f, t) in [f, g].into_iter().zip(new) {
            self.triangles[f as usize] = t;
            self.warp[f as usize] = (warp[0] + warp[1]).try_normalize(0.0).unwrap_or(warp[0]);
            self.normal[f as usize] = normal.unwrap_or(self.normal[f as usize]);
            self.turn_warp(f);
        }
        self.around[p as usize].retain(|&h| h != f);
        self.around[q as usize].retain(|&h| h != g);
        self.around[c as usize].push(g);
        self.around[d as usize].push(f);
        true
    }

    /// Moves a point that is on no curve towards `target` along the surface, unless a triangle would become worse than
    /// `min_shape` and worse than it was. Returns whether it did.
    pub fn slide(&mut self, p: u32, target: &Vec3, min_shape: f64) -> bool {
        if self.curve_degree[p as usize] > 0 || self.fixed[p as usize] {
            return false;
        }
        self.move_to(p, target, min_shape)
    }

    fn move_to(&mut self, p: u32, target: &Vec3, min_shape: f64) -> bool {
        let (location, position) = self.locate(self.location[p as usize].face, target);
        let before =
            self.around[p as usize].iter().map(|&f| triangle_quality(&self.corners(f))).fold(1.0, f64::min);
        let old = self.x[p as usize];
        self.x[p as usize] = position;
        let fits = self.around[p as usize].iter().all(|&f| {
            let x = self.corners(f);
            unit_normal(&x).dot(&self.normal[f as usize]) > TUNING.min_drift_cosine
                && triangle_quality(&x) >= min_shape.min(before)
        });
        if fits {
            self.location[p as usize] = location;
        } else {
            self.x[p as usize] = old;
        }
        fits
    }

    /// Moves a point of a line towards the middle between its neighbours on the line, unless a triangle would become worse than
    /// `min_shape` and worse than it was. Points where lines meet or end stay.
    pub fn slide_along_line(&mut self, p: u32, min_shape: f64) -> bool {
        if self.curve_degree[p as usize] != 2 || self.fixed[p as usize] {
            return false;
        }
        let ends: Vec<u32> = self
            .neighbours(p)
            .into_iter()
            .filter(|&q| matches!(self.curve(p, q), Some(Curve::Line(_) | Curve::Rim)))
            .collect();
        let &[a, b] = ends.as_slice() else { return false };
        if self.curve(p, a) != self.curve(p, b) {
            return false;
        }
        let [x, a, b] = [p, a, b].map(|q| self.x[q as usize]);
        let target = 0.5 * (a + b);
        // Only where the line is straight is the middle on it.
        let across = (x - target)
            - (b - a) * ((x - target).dot(&(b - a)) / (b - a).norm_squared().max(f64::MIN_POSITIVE));
        if across.norm() > TUNING.max_line_bend * (b - a).norm() {
            return false;
        }
        self.move_to(p, &target, min_shape)
    }

    /// Triangle that triangle `f` was split from; itself for one of the garment.
    pub fn parent_of(&self, f: u32) -> u32 {
        self.parent[f as usize]
    }

    /// Triangle of the garment on the sheet of triangle `f`, for searches of the surface.
    pub(super) fn home(&self, f: u32) -> u32 {
        self.home[f as usize]
    }

    /// Unit warp of triangle `f`.
    pub(super) fn warp(&self, f: u32) -> Vec3 {
        self.warp[f as usize]
    }
}

/// Position at weights of the corners of a triangle of the garment [m].
pub fn interpolate(x: &[Vec3], topology: &[[PointIndex; 3]], at: &SurfacePoint) -> Vec3 {
    let t = topology[at.face as usize];
    (0..3).map(|k| x[t[k].at()] * at.weights[k]).sum()
}

/// Barycentric weights of the point of a triangle closest to `p`, 0 to 1, their sum 1.
pub(super) fn clamped_weights(p: &Vec3, x: &[Vec3; 3]) -> [f64; 3] {
    let inside = barycentric(p, x);
    if inside.iter().all(|w| *w >= 0.0) {
        return inside;
    }
    let gap = point_triangle(p, &x[0], &x[1], &x[2]);
    [-gap.weights[1], -gap.weights[2], -gap.weights[3]]
}
