//! Coarsens the mesh of a garment: fewer points where a scene needs few.
//!
//! Edges shorter than wanted are collapsed onto one of their ends, so that the remaining points are points of the garment
//! at unchanged positions, and results carry over without interpolation (half-edge collapse, Hoppe and others 1993, "Mesh
//! optimization"; the link condition keeps the surface's topology: Dey and others 1999). Between the passes edges are
//! flipped where that improves the triangles. Feature edges (open borders, seams at which the warp turns, sharp edges of
//! the source shape, borders between parts) keep their line; triangles without removed points stay unchanged.

use crate::garment::Garment;
use crate::garment::coarse_mesh::{BarycentricPosition, CoarseMesh};
use crate::garment::material_coords::{flatten_triangle, project_to_plane};
use crate::garment::tuning::TUNING;
use crate::math::Vec3;
use crate::mesh::distance::{barycentric, point_triangle_squared};
use crate::mesh::{Hinge, INVALID, PointIndex, Topology, triangle};
use rustc_hash::{FxHashMap, FxHashSet};

impl Garment {
    /// Returns the mesh with points removed until edges are about as long as `wanted` (one length per point [m]; a point
    /// that wants no longer edges than it has stays).
    ///
    /// ```
    /// let sheet = crease::GarmentFile::sheet([0.1, 0.1], [10, 10])?.garment;
    /// let coarse = sheet.coarsen(&vec![0.05; sheet.points.len()]);
    /// assert!(coarse.garment.points.len() < sheet.points.len());
    /// assert_eq!(coarse.interpolate(&coarse.garment.points).len(), sheet.points.len());
    /// # Ok::<(), crease::Error>(())
    /// ```
    pub fn coarsen(&self, wanted: &[f64]) -> CoarseMesh {
        let mut work = EdgeCollapse::new(self, wanted);
        for _ in 0..TUNING.max_coarsen_passes {
            let collapsed = work.collapse_pass();
            let flipped = work.flip_pass();
            if collapsed + flipped == 0 {
                break;
            }
        }
        work.finish()
    }
}

/// State of a mesh whose edges are being collapsed.
struct EdgeCollapse<'a> {
    source: &'a Garment,
    wanted: &'a [f64],
    triangles: Vec<[u32; 3]>,
    alive: Vec<bool>,
    /// Triangles that differ from those of the source.
    modified: Vec<bool>,
    /// Per triangle: unit warp in its plane.
    warp: Vec<Vec3>,
    /// Per triangle: unit normal in the source.
    source_normal: Vec<Vec3>,
    /// Triangles around every point.
    around: Vec<Vec<u32>>,
    /// Per triangle: removed points that it contains.
    contained_points: Vec<Vec<u32>>,
    /// Edges that keep their line, and whether each is an open border.
    feature_edges: FxHashMap<[u32; 2], bool>,
    /// Per point: number of feature edges that meet there.
    feature_degree: Vec<u32>,
}

/// Feature edge at a point.
struct FeatureEdge {
    /// Other end.
    end: u32,
    is_border: bool,
}

/// Returns the ends of an edge in increasing order.
pub(crate) fn edge_key(a: u32, b: u32) -> [u32; 2] {
    if a < b { [a, b] } else { [b, a] }
}

/// Returns the quality of a triangle: 1 for equal sides, 0 for no area.
pub(crate) fn triangle_quality(x: &[Vec3; 3]) -> f64 {
    let [a, b, c] = [x[1] - x[0], x[2] - x[1], x[0] - x[2]];
    let sides = a.norm_squared() + b.norm_squared() + c.norm_squared();
    if sides > 0.0 { 2.0 * 3f64.sqrt() * a.cross(&b).norm() / sides } else { 0.0 }
}

fn normal(x: &[Vec3; 3]) -> Vec3 {
    triangle::normal(x).unwrap_or_else(Vec3::zeros)
}

impl<'a> EdgeCollapse<'a> {
    fn new(source: &'a Garment, wanted: &'a [f64]) -> Self {
        let triangles: Vec<[u32; 3]> = source.triangles.iter().map(|t| t.map(|p| p.0)).collect();
        let mut around = vec![Vec::new(); source.points.len()];
        for (f, t) in triangles.iter().enumerate() {
            t.iter().for_each(|&p| around[p as usize].push(f as u32));
        }
        let corners = |t: &[u32; 3]| t.map(|p| source.points[p as usize]);
        let warp = triangles.iter().zip(&source.material).map(|(t, flat)| {
            let x = corners(t);
            let (side, edge) = (x[1] - x[0], flat[1] - flat[0]);
            let along = side.try_normalize(0.0).unwrap_or_else(Vec3::x);
            let angle = edge.y.atan2(edge.x);
            along * angle.cos() - normal(&x).cross(&along) * angle.sin()
        });
        let topology = &source.topology;
        let mut feature_edges = FxHashMap::default();
        for (e, edge) in topology.edges.iter().enumerate() {
            let is_border = topology.edge_valence[e] == 1;
            let hinge = topology.edge_hinge[e].map(|h| &topology.hinges[h as usize]);
            if hinge.is_none_or(|hinge| is_feature_hinge(source, hinge)) {
                feature_edges.insert([edge[0].0, edge[1].0], is_border);
            }
        }
        let mut feature_degree = vec![0; source.points.len()];
        feature_edges.keys().flatten().for_each(|&p| feature_degree[p as usize] += 1);
        Self {
            source,
            wanted,
            alive: vec![true; triangles.len()],
            contained_points: vec![Vec::new(); triangles.len()],
            modified: vec![false; triangles.len()],
            warp: warp.collect(),
            source_normal: triangles.iter().map(|t| normal(&corners(t))).collect(),
            triangles,
            around,
            feature_edges,
            feature_degree,
        }
    }

    fn position(&self, p: u32) -> Vec3 {
        self.source.points[p as usize]
    }

    fn corners(&self, t: &[u32; 3]) -> [Vec3; 3] {
        t.map(|p| self.position(p))
    }

    /// Returns the length of an edge over the length wanted at its ends.
    fn relative_length(&self, a: u32, b: u32) -> f64 {
        let wanted = self.wanted[a as usize].min(self.wanted[b as usize]);
        (self.position(a) - self.position(b)).norm() / wanted.max(f64::MIN_POSITIVE)
    }

    fn neighbours(&self, p: u32) -> FxHashSet<u32> {
        let corners = self.around[p as usize].iter().flat_map(|&f| self.triangles[f as usize]);
        corners.filter(|&q| q != p).collect()
    }

    /// Returns every edge once, ends in increasing order, sorted.
    fn edges(&self) -> Vec<[u32; 2]> {
        let living = self.triangles.iter().zip(&self.alive).filter(|(_, alive)| **alive);
        let mut edges: Vec<[u32; 2]> =
            living.flat_map(|(t, _)| [0, 1, 2].map(|k| edge_key(t[k], t[(k + 1) % 3]))).collect();
        edges.sort_unstable();
        edges.dedup();
        edges
    }

    /// Collapses short edges, the shortest first, no two of them neighbours. Returns the number of collapses.
    fn collapse_pass(&mut self) -> usize {
        let mut short: Vec<(f64, [u32; 2])> =
            self.edges().into_iter().map(|edge| (self.relative_length(edge[0], edge[1]), edge)).collect();
        short.retain(|(length, _)| *length < TUNING.collapse_length_fraction);
        short.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        let mut busy = vec![false; self.source.points.len()];
        let mut count = 0;
        for (_, [a, b]) in short {
            if busy[a as usize] || busy[b as usize] {
                continue;
            }
            let directions = [(a, b), (b, a)].map(|(from, to)| (self.collapsed_quality(from, to), from, to));
            let best = directions.into_iter().filter_map(|(quality, from, to)| Some((quality?, from, to)));
            let Some((_, from, to)) = best.max_by(|x, y| x.0.total_cmp(&y.0)) else { continue };
            for p in self.neighbours(from) {
                busy[p as usize] = true;
            }
            self.collapse(from, to);
            count += 1;
        }
        count
    }

    /// Returns the minimum quality of the triangles that a collapse of `from` onto `to` leaves; `None` if the collapse is
    /// not allowed.
    fn collapsed_quality(&self, from: u32, to: u32) -> Option<f64> {
        let edge = edge_key(from, to);
        match self.feature_degree[from as usize] {
            0 => {}
            2 => {
                let is_border = *self.feature_edges.get(&edge)?;
                let other = self.other_feature_edge(from, to)?;
                let (ahead, back) =
                    (self.position(to) - self.position(from), self.position(from) - self.position(other.end));
                let is_bent = ahead.dot(&back) < TUNING.min_feature_line_cos * ahead.norm() * back.norm();
                let is_closed = self.feature_edges.contains_key(&edge_key(to, other.end));
                if is_bent || is_border != other.is_border || is_closed {
                    return None;
                }
            }
            _ => return None,
        }
        let shared = self.around[from as usize].iter().filter(|&&f| self.triangles[f as usize].contains(&to));
        let shared = shared.count();
        let common = self.neighbours(from).intersection(&self.neighbours(to)).count();
        // The link condition; and a triangle must remain.
        if common != shared || shared == 0 || shared > 2 || self.around[from as usize].len() <= shared {
            return None;
        }
        let (mut min_quality, mut min_before) = (f64::INFINITY, f64::INFINITY);
        for &f in &self.around[from as usize] {
            let t = self.triangles[f as usize];
            let old = self.corners(&t);
            min_before = min_before.min(triangle_quality(&old));
            if t.contains(&to) {
                continue;
            }
            let new = t.map(|p| if p == from { to } else { p });
            let x = self.corners(&new);
            let new_normal = normal(&x);
            if new_normal.dot(&normal(&old)) < TUNING.min_step_normal_cos
                || new_normal.dot(&self.source_normal[f as usize]) < TUNING.min_total_normal_cos
            {
                return None;
            }
            min_quality = min_quality.min(triangle_quality(&x));
            let is_too_long = |p: &u32| *p != to && self.relative_length(*p, to) > TUNING.max_length_factor;
            if new.iter().any(is_too_long) {
                return None;
            }
        }
        (min_quality >= TUNING.min_collapse_quality.min(min_before)).then_some(min_quality)
    }

    /// Returns the feature edge that continues the edge from `to` to `from` beyond `from`.
    fn other_feature_edge(&self, from: u32, to: u32) -> Option<FeatureEdge> {
        self.neighbours(from).into_iter().filter(|&end| end != to).find_map(|end| {
            let is_border = *self.feature_edges.get(&edge_key(from, end))?;
            Some(FeatureEdge { end, is_border })
        })
    }

    fn collapse(&mut self, from: u32, to: u32) {
        if self.feature_degree[from as usize] == 2
            && let Some(FeatureEdge { end, is_border }) = self.other_feature_edge(from, to)
        {
            self.feature_edges.remove(&edge_key(from, to));
            self.feature_edges.remove(&edge_key(from, end));
            self.feature_edges.insert(edge_key(end, to), is_border);
            self.feature_degree[from as usize] = 0;
        }
        let ring = std::mem::take(&mut self.around[from as usize]);
        let mut removed = vec![from];
        ring.iter().for_each(|&f| removed.append(&mut self.contained_points[f as usize]));
        for &f in &ring {
            let t = &mut self.triangles[f as usize];
            if t.contains(&to) {
                self.alive[f as usize] = false;
                for p in t.iter().filter(|&&p| p != from) {
                    self.around[*p as usize].retain(|&g| g != f);
                }
                continue;
            }
            *t = t.map(|p| if p == from { to } else { p });
            self.around[to as usize].push(f);
            self.mark_modified(f);
        }
        self.assign_points(&removed, &ring);
    }

    /// Assigns removed points to the nearest of the remaining `triangles`.
    fn assign_points(&mut self, points: &[u32], triangles: &[u32]) {
        for &p in points {
            let position = self.position(p);
            let distance = |f: u32| {
                let [a, b, c] = self.corners(&self.triangles[f as usize]);
                point_triangle_squared(&position, &a, &b, &c)
            };
            let remaining = triangles.iter().copied().filter(|&f| self.alive[f as usize]);
            if let Some(f) = remaining.min_by(|&f, &g| distance(f).total_cmp(&distance(g))) {
                self.contained_points[f as usize].push(p);
            }
        }
    }

    /// Marks a triangle as modified and projects its warp into its plane.
    fn mark_modified(&mut self, f: u32) {
        let f = f as usize;
        self.modified[f] = true;
        let x = self.corners(&self.triangles[f]);
        self.warp[f] = project_to_plane(&x, self.warp[f]).unwrap_or(self.warp[f]);
    }

    /// Flips edges between modified triangles where both improve. Returns the number of flips.
    fn flip_pass(&mut self) -> usize {
        self.edges().into_iter().filter(|edge| self.flip_edge(*edge)).count()
    }

    fn flip_edge(&mut self, [a, b]: [u32; 2]) -> bool {
        if self.feature_edges.contains_key(&[a, b]) {
            return false;
        }
        let on: Vec<u32> = self.around[a as usize]
            .iter()
            .copied()
            .filter(|&f| self.triangles[f as usize].contains(&b))
            .collect();
        let &[f, g] = on.as_slice() else { return false };
        if !self.modified[f as usize] || !self.modified[g as usize] {
            return false;
        }
        // f = (p, q, c), g = (q, p, d).
        let t = self.triangles[f as usize];
        let Some(k) = (0..3).find(|&k| edge_key(t[k], t[(k + 1) % 3]) == [a, b]) else { return false };
        let (p, q, c) = (t[k], t[(k + 1) % 3], t[(k + 2) % 3]);
        let Some(&d) = self.triangles[g as usize].iter().find(|&&x| x != p && x != q) else { return false };
        if c == d || self.neighbours(c).contains(&d) || self.relative_length(c, d) > TUNING.max_length_factor
        {
            return false;
        }
        let new = [[c, d, q], [d, c, p]];
        let old = [f, g].map(|f| self.corners(&self.triangles[f as usize]));
        let flipped = new.map(|t| self.corners(&t));
        let min_quality = |x: &[[Vec3; 3]; 2]| triangle_quality(&x[0]).min(triangle_quality(&x[1]));
        let is_smooth = flipped.iter().all(|x| {
            let own = normal(x);
            old.iter().all(|y| own.dot(&normal(y)) > TUNING.min_step_normal_cos)
                && [f, g]
                    .iter()
                    .all(|f| own.dot(&self.source_normal[*f as usize]) > TUNING.min_total_normal_cos)
        });
        if !is_smooth || min_quality(&flipped) <= min_quality(&old) + 1e-9 {
            return false;
        }
        let mut warp = [self.warp[f as usize], self.warp[g as usize]];
        if warp[0].dot(&warp[1]) < 0.0 {
            warp[1] = -warp[1];
        }
        let mean_normal =
            (self.source_normal[f as usize] + self.source_normal[g as usize]).try_normalize(0.0);
        for (f, t) in [f, g].into_iter().zip(new) {
            self.triangles[f as usize] = t;
            self.warp[f as usize] = warp[0] + warp[1];
            self.source_normal[f as usize] = mean_normal.unwrap_or(self.source_normal[f as usize]);
            self.mark_modified(f);
        }
        self.around[p as usize].retain(|&x| x != f);
        self.around[q as usize].retain(|&x| x != g);
        // f was on c already, g on d.
        self.around[c as usize].push(g);
        self.around[d as usize].push(f);
        let mut removed = std::mem::take(&mut self.contained_points[f as usize]);
        removed.append(&mut self.contained_points[g as usize]);
        self.assign_points(&removed, &[f, g]);
        true
    }

    fn finish(self) -> CoarseMesh {
        let mut number = vec![PointIndex(INVALID); self.source.points.len()];
        let mut source_point = Vec::new();
        for (p, on) in self.around.iter().enumerate() {
            if !on.is_empty() {
                number[p] = PointIndex(source_point.len() as u32);
                source_point.push(PointIndex(p as u32));
            }
        }
        let remaining: Vec<usize> = (0..self.triangles.len()).filter(|&f| self.alive[f]).collect();
        let garment = self.coarse_garment(&remaining, &source_point, &number);
        let mut containing_triangle = vec![0; self.source.points.len()];
        for (new, &f) in remaining.iter().enumerate() {
            let points = self.contained_points[f].iter().chain(&self.triangles[f]);
            points.for_each(|&p| containing_triangle[p as usize] = new as u32);
        }
        let barycentric = |(p, &f): (usize, &u32)| {
            let corners = garment.triangles[f as usize];
            let weights = match corners.iter().position(|c| *c == number[p]) {
                Some(k) => [0, 1, 2].map(|j| if j == k { 1.0 } else { 0.0 }),
                None => {
                    let x = self.corners(&self.triangles[remaining[f as usize]]);
                    let inside = barycentric(&self.source.points[p], &x).map(|w| w.max(0.0));
                    inside.map(|w| w / inside.iter().sum::<f64>())
                }
            };
            BarycentricPosition { corners, weights }
        };
        let barycentric = containing_triangle.iter().enumerate().map(barycentric).collect();
        let unchanged_from = remaining.iter().map(|&f| (!self.modified[f]).then_some(f as u32)).collect();
        CoarseMesh { garment, source_point, unchanged_from, containing_triangle, barycentric }
    }

    /// Returns the garment of the `remaining` triangles; `number` is the coarse point of every source point.
    fn coarse_garment(
        &self,
        remaining: &[usize],
        source_point: &[PointIndex],
        number: &[PointIndex],
    ) -> Garment {
        let triangles: Vec<[PointIndex; 3]> =
            remaining.iter().map(|&f| self.triangles[f].map(|p| number[p as usize])).collect();
        let material = remaining.iter().map(|&f| {
            if self.modified[f] {
                flatten_triangle(&self.corners(&self.triangles[f]), self.warp[f])
            } else {
                self.source.material[f]
            }
        });
        Garment {
            points: source_point.iter().map(|p| self.source.points[p.at()]).collect(),
            material: material.collect(),
            material_from_uv: self.source.material_from_uv,
            source_point: Vec::new(),
            memory_mask: source_point.iter().map(|p| self.source.memory_mask[p.at()]).collect(),
            triangle_part: remaining.iter().map(|&f| self.source.triangle_part[f]).collect(),
            topology: Topology::new(source_point.len(), &triangles),
            triangles,
        }
    }
}

/// Returns whether the source shape has a sharp edge at a hinge, or the warp turns there.
pub(crate) fn is_feature_hinge(source: &Garment, hinge: &Hinge) -> bool {
    let x = hinge.points.map(|p| source.points[p.at()]);
    let direction = |f: u32| {
        let at = |p: PointIndex| source.triangles[f as usize].iter().position(|&q| q == p).unwrap_or(0);
        let flat = source.material[f as usize];
        let edge = flat[at(hinge.points[1])] - flat[at(hinge.points[0])];
        edge.y.atan2(edge.x)
    };
    let between = direction(hinge.triangles[0]) - direction(hinge.triangles[1]);
    // Cloth is the same along +warp and -warp.
    let is_seam = between.sin().abs() > TUNING.min_seam_angle.sin();
    is_seam || crate::mesh::hinge_angle(&x).abs() > TUNING.min_sharp_angle
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::Vec2;

    const EDGE: f64 = 5e-3;

    /// A level sheet of 0.3 x 0.2 m in a lattice of equilateral triangles, the warp along x; `bent` lifts its points.
    fn sheet(bent: impl Fn(f64) -> f64) -> Garment {
        let (columns, rows) = (61u32, 47u32);
        let position = |k: u32| {
            let (i, j) = (f64::from(k % columns), f64::from(k / columns));
            let x = EDGE * (i + 0.5 * (j % 2.0));
            Vec3::new(x, bent(x), EDGE * 0.75f64.sqrt() * j)
        };
        let points: Vec<Vec3> = (0..columns * rows).map(position).collect();
        let cells = (0..rows - 1).flat_map(|j| (0..columns - 1).map(move |i| (i, j)));
        let triangles: Vec<[PointIndex; 3]> = cells
            .flat_map(|(i, j)| {
                let at = |di: u32, dj: u32| PointIndex((j + dj) * columns + i + di);
                if j % 2 == 0 {
                    [[at(0, 0), at(0, 1), at(1, 0)], [at(1, 0), at(0, 1), at(1, 1)]]
                } else {
                    [[at(0, 0), at(0, 1), at(1, 1)], [at(0, 0), at(1, 1), at(1, 0)]]
                }
            })
            .collect();
        let flat = |t: &[PointIndex; 3]| {
            let x = t.map(|p| points[p.at()]);
            flatten_triangle(&x, project_to_plane(&x, Vec3::x()).expect("is not steep"))
        };
        Garment {
            material: triangles.iter().map(flat).collect(),
            material_from_uv: true,
            source_point: Vec::new(),
            memory_mask: vec![1.0; points.len()],
            triangle_part: vec![0; triangles.len()],
            topology: Topology::new(points.len(), &triangles),
            triangles,
            points,
        }
    }

    fn corners(garment: &Garment, t: &[PointIndex; 3]) -> [Vec3; 3] {
        t.map(|p| garment.points[p.at()])
    }

    fn area(garment: &Garment) -> f64 {
        let one = |t| triangle::area(&corners(garment, t));
        garment.triangles.iter().map(one).sum()
    }

    /// Fine up to x = 0.1 m, then ever coarser.
    fn wanted(garment: &Garment) -> Vec<f64> {
        let one = |p: &Vec3| if p.x < 0.1 { 0.0 } else { (EDGE + (p.x - 0.1)).min(4.0 * EDGE) };
        garment.points.iter().map(one).collect()
    }

    #[test]
    fn edges_become_as_long_as_wanted_and_what_wants_none_stays() {
        let whole = sheet(|_| 0.0);
        let CoarseMesh { garment, source_point, unchanged_from, .. } = whole.coarsen(&wanted(&whole));
        assert!(garment.points.len() < 6 * whole.points.len() / 10, "{} points", garment.points.len());
        assert!(source_point.iter().zip(&garment.points).all(|(p, x)| whole.points[p.at()] == *x));
        // The sheet is whole: no hole, one border, the same area and outline but for its zigzag.
        assert_eq!(garment.topology.boundary_loops(&garment.triangles).len(), 1);
        assert!((area(&garment) / area(&whole) - 1.0).abs() < 0.01);
        let euler = |g: &Garment| g.points.len() + g.triangles.len() - g.topology.edges.len();
        assert_eq!(euler(&garment), euler(&whole));
        assert!(garment.topology.misoriented.is_empty());
        let (mut kept, mut long) = (0, 0);
        for (t, same) in garment.triangles.iter().zip(&unchanged_from) {
            let x = corners(&garment, t);
            assert!(triangle_quality(&x) > 0.39, "{x:?}");
            assert!((0..3).all(|k| (x[k] - x[(k + 1) % 3]).norm() < TUNING.max_length_factor * 4.0 * EDGE));
            long += usize::from((0..3).any(|k| (x[k] - x[(k + 1) % 3]).norm() > 2.5 * EDGE));
            if let Some(f) = same {
                kept += 1;
                assert_eq!(corners(&whole, &whole.triangles[*f as usize]), x);
            } else {
                assert!(x.iter().any(|p| p.x >= 0.1 - EDGE), "taken away where nothing was wanted: {x:?}");
            }
        }
        let fine = whole.triangles.iter().filter(|t| corners(&whole, t).iter().all(|p| p.x < 0.1 - EDGE));
        assert!(kept >= fine.count() && long > 100, "{kept} kept, {long} long");
    }

    #[test]
    fn triangles_keep_their_warp_and_size_and_points_their_positions() {
        // A quarter of a tube: chords are shorter than arcs, by little.
        let whole = sheet(|x| 0.3 - (0.09 - (x - 0.15).powi(2)).sqrt());
        let coarse = whole.coarsen(&wanted(&whole));
        assert!(coarse.garment.points.len() < whole.points.len());
        for (t, flat) in coarse.garment.triangles.iter().zip(&coarse.garment.material) {
            let x = corners(&coarse.garment, t);
            let (side, edge) = (x[1] - x[0], flat[1] - flat[0]);
            assert!((side.norm() - edge.norm()).abs() < 0.02 * side.norm());
            // z does not change along the warp.
            assert!((side.z.abs() - edge.y.abs()).abs() < 0.05 * side.norm(), "{side} {edge}");
        }
        let interpolated = coarse.interpolate(&coarse.garment.points);
        for (x, there) in whole.points.iter().zip(&interpolated) {
            assert!((x - there).norm() < 0.15 * EDGE, "{x} {there}");
        }
    }

    #[test]
    fn nothing_wanted_is_nothing_done() {
        let whole = sheet(|_| 0.0);
        let coarse = whole.coarsen(&vec![0.0; whole.points.len()]);
        assert_eq!(
            (coarse.garment.points, coarse.garment.triangles),
            (whole.points.clone(), whole.triangles.clone())
        );
        assert_eq!(coarse.garment.material, whole.material);
        assert!(coarse.unchanged_from.iter().enumerate().all(|(f, same)| *same == Some(f as u32)));
    }

    /// The rim of a garment that lies, and a seam where the warp turns, stay where they are.
    #[test]
    fn sharp_edges_and_seams_keep_their_line() {
        let fold = 0.15;
        let roof = sheet(|x| (x - fold).abs());
        let mut seam = sheet(|_| 0.0);
        for (t, flat) in seam.triangles.iter().zip(&mut seam.material) {
            let middle = t.iter().map(|p| seam.points[p.at()].x).sum::<f64>() / 3.0;
            if middle > fold {
                *flat = flat.map(|p| Vec2::new(-p.y, p.x));
            }
        }
        for whole in [roof, seam] {
            let feature_line = |g: &Garment| {
                let on = |h: &&Hinge| is_feature_hinge(g, h);
                let hinges: Vec<&Hinge> = g.topology.hinges.iter().filter(on).collect();
                let ends = |h: &&Hinge| h.points.map(|p| g.points[p.at()]);
                let length: f64 = hinges.iter().map(ends).map(|x| (x[1] - x[0]).norm()).sum();
                (hinges.len(), length)
            };
            let coarse = whole.coarsen(&vec![4.0 * EDGE; whole.points.len()]);
            let ((many, length), (few, left)) = (feature_line(&whole), feature_line(&coarse.garment));
            assert!(few > 0 && few <= many, "{few} of {many}");
            assert!((left / length - 1.0).abs() < 0.2, "{left} of {length} m");
        }
    }
}
