//! A coarser mesh of the same garment: fewer points where a scene needs none.
//!
//! Edges shorter than wanted are collapsed onto one of their ends, so that the points left are points of the garment, in
//! their own places, and what becomes of them is known there without carrying anything over (half-edge collapse, Hoppe and
//! others 1993, "Mesh optimization"; the link condition keeps the surface's topology: Dey and others 1999). Between rounds
//! edges are turned where that makes triangles rounder. Open borders, seams at which the warp turns, sharp edges of the
//! source shape and borders between parts keep their course; triangles of which nothing was taken away stay as they are.

use crate::garment::Garment;
use crate::garment::material_coords::{flatten, in_plane};
use crate::math::Vec3;
use crate::mesh::distance::{barycentric, point_triangle_squared};
use crate::mesh::{Hinge, PointIndex, Topology};
use rustc_hash::{FxHashMap, FxHashSet};

/// Edges are collapsed below this share of the wanted length, and none becomes longer than this many times it.
const LENGTHS: [f64; 2] = [0.8, 4.0 / 3.0];
/// Shape of a triangle (1 for equal sides, 0 for none) that a collapse must leave, unless it was worse before.
const SHAPE: f64 = 0.4;
/// Cosine between a triangle's normal before and after a collapse, and between now and as it was made, at least.
const NORMAL: [f64; 2] = [0.94, 0.87];
/// Cosine up to which the course of a border may bend at a point that is taken away.
const STRAIGHT: f64 = 0.94;
/// Angle of the source shape from which an edge is sharp [rad]: the side of a garment that lies.
const SHARP: f64 = 0.7;
/// Angle between the warps of two triangles from which their edge is a seam [rad].
const SEAM: f64 = 0.2;
/// Rounds at most; each takes away a quarter of the points that may go, or so.
const MOST_ROUNDS: usize = 40;

/// A coarser garment.
#[derive(Debug, Clone)]
pub struct CoarseMesh {
    /// What is left. No source vertex has a point of it.
    pub garment: Garment,
    /// Per point: the point of the source it is.
    pub source_point: Vec<PointIndex>,
    /// Per triangle: the triangle of the source it is, number for number, if nothing of it was taken away.
    pub unchanged_from: Vec<Option<u32>>,
    /// Per point of the source: the triangle it lies in, or one of those at it if it was left.
    pub containing_triangle: Vec<u32>,
    /// Per point of the source: the corners of that triangle and their weights, 0 to 1.
    barycentric: Vec<([PointIndex; 3], [f64; 3])>,
}

impl CoarseMesh {
    /// Places of all points of the source [m] when those that are left are at `x`: on the triangles they lie in.
    pub fn interpolate(&self, x: &[Vec3]) -> Vec<Vec3> {
        self.barycentric.iter().map(|(t, w)| (0..3).map(|k| x[t[k].at()] * w[k]).sum()).collect()
    }
}

impl Garment {
    /// Points taken away until edges are about as long as `wanted` (one length per point [m]; a point that wants no longer
    /// edges than it has stays).
    pub fn coarsen(&self, wanted: &[f64]) -> CoarseMesh {
        let mut work = Collapsing::new(self, wanted);
        for _ in 0..MOST_ROUNDS {
            let collapsed = work.collapse_round();
            let turned = work.turn_round();
            if collapsed + turned == 0 {
                break;
            }
        }
        work.finish()
    }
}

/// A mesh whose edges are being collapsed.
struct Collapsing<'a> {
    source: &'a Garment,
    wanted: &'a [f64],
    triangles: Vec<[u32; 3]>,
    alive: Vec<bool>,
    /// Triangles that are no longer those of the source.
    touched: Vec<bool>,
    /// Per triangle: unit warp in its plane, and unit normal as the source has it.
    warp: Vec<Vec3>,
    made: Vec<Vec3>,
    /// Triangles on every point.
    around: Vec<Vec<u32>>,
    /// Points that were taken away, by the triangle they lie in.
    inside: Vec<Vec<u32>>,
    /// Edges that keep their course, and whether each is an open border.
    course: FxHashMap<[u32; 2], bool>,
    /// Per point: how many of them meet there.
    courses: Vec<u32>,
}

fn ends(a: u32, b: u32) -> [u32; 2] {
    if a < b { [a, b] } else { [b, a] }
}

/// 1 for a triangle of equal sides, 0 for one without area.
fn shape(x: &[Vec3; 3]) -> f64 {
    let [a, b, c] = [x[1] - x[0], x[2] - x[1], x[0] - x[2]];
    let sides = a.norm_squared() + b.norm_squared() + c.norm_squared();
    if sides > 0.0 { 2.0 * 3f64.sqrt() * a.cross(&b).norm() / sides } else { 0.0 }
}

fn normal(x: &[Vec3; 3]) -> Vec3 {
    (x[1] - x[0]).cross(&(x[2] - x[0])).try_normalize(0.0).unwrap_or_else(Vec3::zeros)
}

impl<'a> Collapsing<'a> {
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
        let mut course = FxHashMap::default();
        for (e, edge) in topology.edges.iter().enumerate() {
            let border = topology.edge_valence[e] == 1;
            let keeps = topology.edge_hinge[e].is_none_or(|h| turns(source, &topology.hinges[h as usize]));
            if keeps {
                course.insert([edge[0].0, edge[1].0], border);
            }
        }
        let mut courses = vec![0; source.points.len()];
        course.keys().flatten().for_each(|&p| courses[p as usize] += 1);
        Self {
            source,
            wanted,
            alive: vec![true; triangles.len()],
            inside: vec![Vec::new(); triangles.len()],
            touched: vec![false; triangles.len()],
            warp: warp.collect(),
            made: triangles.iter().map(|t| normal(&corners(t))).collect(),
            triangles,
            around,
            course,
            courses,
        }
    }

    fn place(&self, p: u32) -> Vec3 {
        self.source.points[p as usize]
    }

    fn corners(&self, t: &[u32; 3]) -> [Vec3; 3] {
        t.map(|p| self.place(p))
    }

    /// Length of an edge over that which its ends want.
    fn relative(&self, a: u32, b: u32) -> f64 {
        let wanted = self.wanted[a as usize].min(self.wanted[b as usize]);
        (self.place(a) - self.place(b)).norm() / wanted.max(f64::MIN_POSITIVE)
    }

    fn neighbours(&self, p: u32) -> FxHashSet<u32> {
        let corners = self.around[p as usize].iter().flat_map(|&f| self.triangles[f as usize]);
        corners.filter(|&q| q != p).collect()
    }

    /// Every edge once, ends in increasing order, sorted.
    fn edges(&self) -> Vec<[u32; 2]> {
        let living = self.triangles.iter().zip(&self.alive).filter(|(_, alive)| **alive);
        let mut edges: Vec<[u32; 2]> =
            living.flat_map(|(t, _)| [0, 1, 2].map(|k| ends(t[k], t[(k + 1) % 3]))).collect();
        edges.sort_unstable();
        edges.dedup();
        edges
    }

    /// Collapses short edges, the shortest first, no two of neighbours. Returns how many.
    fn collapse_round(&mut self) -> usize {
        let mut short: Vec<(f64, [u32; 2])> =
            self.edges().into_iter().map(|edge| (self.relative(edge[0], edge[1]), edge)).collect();
        short.retain(|(length, _)| *length < LENGTHS[0]);
        short.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        let mut busy = vec![false; self.source.points.len()];
        let mut count = 0;
        for (_, [a, b]) in short {
            if busy[a as usize] || busy[b as usize] {
                continue;
            }
            let ways = [(a, b), (b, a)].map(|(from, to)| (self.collapsed_shape(from, to), from, to));
            let best = ways.into_iter().filter_map(|(shape, from, to)| Some((shape?, from, to)));
            let Some((_, from, to)) = best.max_by(|x, y| x.0.total_cmp(&y.0)) else { continue };
            for p in self.neighbours(from) {
                busy[p as usize] = true;
            }
            self.collapse(from, to);
            count += 1;
        }
        count
    }

    /// The least shape of the triangles that a collapse of `from` onto `to` leaves, or `None` if it may not be made.
    fn collapsed_shape(&self, from: u32, to: u32) -> Option<f64> {
        let edge = ends(from, to);
        match self.courses[from as usize] {
            0 => {}
            2 => {
                let border = *self.course.get(&edge)?;
                let (other, other_border) = self.other_course(from, to)?;
                let (ahead, back) = (self.place(to) - self.place(from), self.place(from) - self.place(other));
                let bent = ahead.dot(&back) < STRAIGHT * ahead.norm() * back.norm();
                if bent || border != other_border || self.course.contains_key(&ends(to, other)) {
                    return None;
                }
            }
            _ => return None,
        }
        let shared = self.around[from as usize].iter().filter(|&&f| self.triangles[f as usize].contains(&to));
        let shared = shared.count();
        let common = self.neighbours(from).intersection(&self.neighbours(to)).count();
        // The link condition; and a triangle must be left.
        if common != shared || shared == 0 || shared > 2 || self.around[from as usize].len() <= shared {
            return None;
        }
        let (mut least, mut before) = (f64::INFINITY, f64::INFINITY);
        for &f in &self.around[from as usize] {
            let t = self.triangles[f as usize];
            let was = self.corners(&t);
            before = before.min(shape(&was));
            if t.contains(&to) {
                continue;
            }
            let new = t.map(|p| if p == from { to } else { p });
            let x = self.corners(&new);
            let turned = normal(&x);
            if turned.dot(&normal(&was)) < NORMAL[0] || turned.dot(&self.made[f as usize]) < NORMAL[1] {
                return None;
            }
            least = least.min(shape(&x));
            let longer = new.iter().any(|&p| p != to && self.relative(p, to) > LENGTHS[1]);
            if longer {
                return None;
            }
        }
        (least >= SHAPE.min(before)).then_some(least)
    }

    /// The other end of the course that runs through `from`, away from `to`, and whether it is an open border.
    fn other_course(&self, from: u32, to: u32) -> Option<(u32, bool)> {
        self.neighbours(from)
            .into_iter()
            .filter(|&p| p != to)
            .find_map(|p| self.course.get(&ends(from, p)).map(|border| (p, *border)))
    }

    fn collapse(&mut self, from: u32, to: u32) {
        if self.courses[from as usize] == 2
            && let Some((other, border)) = self.other_course(from, to)
        {
            self.course.remove(&ends(from, to));
            self.course.remove(&ends(from, other));
            self.course.insert(ends(other, to), border);
            self.courses[from as usize] = 0;
        }
        let ring = std::mem::take(&mut self.around[from as usize]);
        let mut loose = vec![from];
        ring.iter().for_each(|&f| loose.append(&mut self.inside[f as usize]));
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
            self.changed(f);
        }
        self.settle_in(&loose, &ring);
    }

    /// Gives points that lost their triangle to the nearest of those that are left of `triangles`.
    fn settle_in(&mut self, points: &[u32], triangles: &[u32]) {
        for &p in points {
            let place = self.place(p);
            let distance = |f: u32| {
                let [a, b, c] = self.corners(&self.triangles[f as usize]);
                point_triangle_squared(&place, &a, &b, &c)
            };
            let left = triangles.iter().copied().filter(|&f| self.alive[f as usize]);
            if let Some(f) = left.min_by(|&f, &g| distance(f).total_cmp(&distance(g))) {
                self.inside[f as usize].push(p);
            }
        }
    }

    /// Brings the warp of a triangle back into its plane.
    fn changed(&mut self, f: u32) {
        let f = f as usize;
        self.touched[f] = true;
        let x = self.corners(&self.triangles[f]);
        self.warp[f] = in_plane(&x, self.warp[f]).unwrap_or(self.warp[f]);
    }

    /// Turns edges between triangles that are not the source's where both become rounder. Returns how many.
    fn turn_round(&mut self) -> usize {
        self.edges().into_iter().filter(|edge| self.turn(*edge)).count()
    }

    fn turn(&mut self, [a, b]: [u32; 2]) -> bool {
        if self.course.contains_key(&[a, b]) {
            return false;
        }
        let on: Vec<u32> = self.around[a as usize]
            .iter()
            .copied()
            .filter(|&f| self.triangles[f as usize].contains(&b))
            .collect();
        let &[f, g] = on.as_slice() else { return false };
        if !self.touched[f as usize] || !self.touched[g as usize] {
            return false;
        }
        // f = (p, q, c), g = (q, p, d).
        let t = self.triangles[f as usize];
        let Some(k) = (0..3).find(|&k| ends(t[k], t[(k + 1) % 3]) == [a, b]) else { return false };
        let (p, q, c) = (t[k], t[(k + 1) % 3], t[(k + 2) % 3]);
        let Some(&d) = self.triangles[g as usize].iter().find(|&&x| x != p && x != q) else { return false };
        if c == d || self.neighbours(c).contains(&d) || self.relative(c, d) > LENGTHS[1] {
            return false;
        }
        let new = [[c, d, q], [d, c, p]];
        let old = [f, g].map(|f| self.corners(&self.triangles[f as usize]));
        let made = new.map(|t| self.corners(&t));
        let least = |x: &[[Vec3; 3]; 2]| shape(&x[0]).min(shape(&x[1]));
        let smooth = made.iter().all(|x| {
            let own = normal(x);
            old.iter().all(|y| own.dot(&normal(y)) > NORMAL[0])
                && [f, g].iter().all(|f| own.dot(&self.made[*f as usize]) > NORMAL[1])
        });
        if !smooth || least(&made) <= least(&old) + 1e-9 {
            return false;
        }
        let mut warp = [self.warp[f as usize], self.warp[g as usize]];
        if warp[0].dot(&warp[1]) < 0.0 {
            warp[1] = -warp[1];
        }
        let made_normal = (self.made[f as usize] + self.made[g as usize]).try_normalize(0.0);
        for (f, t) in [f, g].into_iter().zip(new) {
            self.triangles[f as usize] = t;
            self.warp[f as usize] = warp[0] + warp[1];
            self.made[f as usize] = made_normal.unwrap_or(self.made[f as usize]);
            self.changed(f);
        }
        self.around[p as usize].retain(|&x| x != f);
        self.around[q as usize].retain(|&x| x != g);
        // f was on c already, g on d.
        self.around[c as usize].push(g);
        self.around[d as usize].push(f);
        let mut loose = std::mem::take(&mut self.inside[f as usize]);
        loose.append(&mut self.inside[g as usize]);
        self.settle_in(&loose, &[f, g]);
        true
    }

    fn finish(self) -> CoarseMesh {
        let mut number = vec![PointIndex(u32::MAX); self.source.points.len()];
        let mut source = Vec::new();
        for (p, on) in self.around.iter().enumerate() {
            if !on.is_empty() {
                number[p] = PointIndex(source.len() as u32);
                source.push(PointIndex(p as u32));
            }
        }
        let left: Vec<usize> = (0..self.triangles.len()).filter(|&f| self.alive[f]).collect();
        let triangles: Vec<[PointIndex; 3]> =
            left.iter().map(|&f| self.triangles[f].map(|p| number[p as usize])).collect();
        let material = left.iter().map(|&f| {
            if self.touched[f] {
                flatten(&self.corners(&self.triangles[f]), self.warp[f])
            } else {
                self.source.material[f]
            }
        });
        let garment = Garment {
            points: source.iter().map(|p| self.source.points[p.at()]).collect(),
            material: material.collect(),
            material_from_uv: self.source.material_from_uv,
            source_point: Vec::new(),
            memory_mask: source.iter().map(|p| self.source.memory_mask[p.at()]).collect(),
            triangle_part: left.iter().map(|&f| self.source.triangle_part[f]).collect(),
            topology: Topology::new(source.len(), &triangles),
            triangles,
        };
        let mut containing_triangle = vec![0; self.source.points.len()];
        for (new, &f) in left.iter().enumerate() {
            let points = self.inside[f].iter().chain(&self.triangles[f]);
            points.for_each(|&p| containing_triangle[p as usize] = new as u32);
        }
        let weights = |(p, &f): (usize, &u32)| {
            let corners = garment.triangles[f as usize];
            let weights = match corners.iter().position(|c| *c == number[p]) {
                Some(k) => [0, 1, 2].map(|j| if j == k { 1.0 } else { 0.0 }),
                None => {
                    let x = self.corners(&self.triangles[left[f as usize]]);
                    let inside = barycentric(&self.source.points[p], &x).map(|w| w.max(0.0));
                    inside.map(|w| w / inside.iter().sum::<f64>())
                }
            };
            (corners, weights)
        };
        let within = containing_triangle.iter().enumerate().map(weights).collect();
        let same = left.iter().map(|&f| (!self.touched[f]).then_some(f as u32)).collect();
        CoarseMesh {
            garment,
            source_point: source,
            unchanged_from: same,
            containing_triangle,
            barycentric: within,
        }
    }
}

/// Whether the source shape has a sharp edge at a hinge, or the warp turns there.
fn turns(source: &Garment, hinge: &Hinge) -> bool {
    let x = hinge.points.map(|p| source.points[p.at()]);
    let direction = |f: u32| {
        let at = |p: PointIndex| source.triangles[f as usize].iter().position(|&q| q == p).unwrap_or(0);
        let flat = source.material[f as usize];
        let edge = flat[at(hinge.points[1])] - flat[at(hinge.points[0])];
        edge.y.atan2(edge.x)
    };
    let between = direction(hinge.triangles[0]) - direction(hinge.triangles[1]);
    // Cloth is the same along +warp and -warp.
    let turned = between.sin().abs() > SEAM.sin();
    turned || crate::mesh::hinge_angle(&x).abs() > SHARP
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::Vec2;

    const EDGE: f64 = 5e-3;

    /// A level sheet of 0.3 x 0.2 m in a lattice of equilateral triangles, the warp along x; `bent` lifts its points.
    fn sheet(bent: impl Fn(f64) -> f64) -> Garment {
        let (columns, rows) = (61u32, 47u32);
        let place = |k: u32| {
            let (i, j) = (f64::from(k % columns), f64::from(k / columns));
            let x = EDGE * (i + 0.5 * (j % 2.0));
            Vec3::new(x, bent(x), EDGE * 0.75f64.sqrt() * j)
        };
        let points: Vec<Vec3> = (0..columns * rows).map(place).collect();
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
            flatten(&x, in_plane(&x, Vec3::x()).expect("is not steep"))
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
        let one = |t| {
            let [a, b, c] = corners(garment, t);
            0.5 * (b - a).cross(&(c - a)).norm()
        };
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
        let CoarseMesh { garment, source_point: source, unchanged_from: same, .. } =
            whole.coarsen(&wanted(&whole));
        assert!(garment.points.len() < 6 * whole.points.len() / 10, "{} points", garment.points.len());
        assert!(source.iter().zip(&garment.points).all(|(p, x)| whole.points[p.at()] == *x));
        // The sheet is whole: no hole, one border, the same area and outline but for its zigzag.
        assert_eq!(garment.topology.boundary_loops(&garment.triangles).len(), 1);
        assert!((area(&garment) / area(&whole) - 1.0).abs() < 0.01);
        let euler = |g: &Garment| g.points.len() + g.triangles.len() - g.topology.edges.len();
        assert_eq!(euler(&garment), euler(&whole));
        assert!(garment.topology.misoriented.is_empty());
        let (mut kept, mut long) = (0, 0);
        for (t, same) in garment.triangles.iter().zip(&same) {
            let x = corners(&garment, t);
            assert!(shape(&x) > 0.39, "{x:?}");
            assert!((0..3).all(|k| (x[k] - x[(k + 1) % 3]).norm() < LENGTHS[1] * 4.0 * EDGE));
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
    fn triangles_keep_their_warp_and_size_and_points_their_place() {
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
        let placed = coarse.interpolate(&coarse.garment.points);
        for (x, there) in whole.points.iter().zip(&placed) {
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
    fn sharp_edges_and_seams_keep_their_course() {
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
            let course = |g: &Garment| {
                let on = |h: &&Hinge| turns(g, h);
                let hinges: Vec<&Hinge> = g.topology.hinges.iter().filter(on).collect();
                let ends = |h: &&Hinge| h.points.map(|p| g.points[p.at()]);
                let length: f64 = hinges.iter().map(ends).map(|x| (x[1] - x[0]).norm()).sum();
                (hinges.len(), length)
            };
            let coarse = whole.coarsen(&vec![4.0 * EDGE; whole.points.len()]);
            let ((many, length), (few, left)) = (course(&whole), course(&coarse.garment));
            assert!(few > 0 && few <= many, "{few} of {many}");
            assert!((left / length - 1.0).abs() < 0.2, "{left} of {length} m");
        }
    }
}
