//! Welding: joins vertices that a file keeps apart (at texture borders, hard edges, between pieces) into points.
//!
//! Vertices join only if they coincide *and* either both lie on an open edge, as both sides of a seam do, or end the
//! same edge, which then has no length. So two layers that touch or lie on each other stay two layers: a vertex
//! in the middle of a layer, closed all around, is never joined to another layer's, unless the file itself gives it the
//! position of a vertex on an open edge. What else belongs together
//! (copies of a triangle) the caller joins. Only positions count, not texture or material.

use crate::math::Vec3;
use crate::mesh::PointIndex;
use rustc_hash::{FxHashMap, FxHashSet};

/// Vertices to be joined into points.
#[derive(Debug, Clone)]
pub struct Welder {
    /// First vertex at the position of each vertex.
    sites: Vec<u32>,
    groups: Groups,
}

impl Welder {
    /// Vertices at `positions` \[m\]; those closer than `tolerance` \[m\], directly or by a chain of others, coincide.
    pub fn new(positions: &[Vec3], tolerance: f64) -> Self {
        let sites = find_sites(positions, tolerance);
        Self { sites, groups: Groups::new(positions.len()) }
    }

    /// Returns the first vertex at the position of `vertex`.
    pub fn site(&self, vertex: u32) -> u32 {
        self.sites.get(vertex as usize).copied().unwrap_or(vertex)
    }

    /// Joins two vertices, whatever their positions.
    pub fn join(&mut self, a: u32, b: u32) {
        self.groups.join(a, b);
    }

    /// Joins coincident vertices that both lie on open edges of `triangles`.
    pub fn join_open_edges(&mut self, triangles: &[[u32; 3]]) {
        let mut first_at: FxHashMap<u32, u32> = FxHashMap::default();
        for vertex in open_vertices(triangles) {
            let site = self.site(vertex);
            let first = *first_at.entry(site).or_insert(vertex);
            self.groups.join(first, vertex);
        }
    }

    /// Joins vertices with the same position of the file, one `id` per vertex, if one of them lies on an open edge of
    /// `triangles`: a seam that the file closes itself, also onto the middle of a panel.
    pub fn join_seams(&mut self, triangles: &[[u32; 3]], ids: &[Option<u32>]) {
        let id_of = |vertex: u32| ids.get(vertex as usize).copied().flatten();
        let open: FxHashSet<u32> = open_vertices(triangles).into_iter().filter_map(id_of).collect();
        let mut first_with: FxHashMap<u32, u32> = FxHashMap::default();
        for &vertex in triangles.iter().flatten() {
            if let Some(id) = id_of(vertex).filter(|id| open.contains(id)) {
                let first = *first_with.entry(id).or_insert(vertex);
                self.groups.join(first, vertex);
            }
        }
    }

    /// Joins the ends of edges of `triangles` that have no length.
    pub fn join_short_edges(&mut self, triangles: &[[u32; 3]]) {
        for &[a, b, c] in triangles {
            for (from, to) in [(a, b), (b, c), (c, a)] {
                if self.site(from) == self.site(to) {
                    self.groups.join(from, to);
                }
            }
        }
    }

    /// Returns the point of each vertex, points counted in order of their first vertex, and the number of points.
    pub fn points(&mut self) -> (Vec<PointIndex>, usize) {
        self.groups.numbered()
    }
}

/// Disjoint sets of members counted from 0 (union-find with path halving). The lowest member stands for its group, so that nothing depends
/// on the order of joining.
#[derive(Debug, Clone)]
pub struct Groups {
    parent: Vec<u32>,
}

impl Groups {
    /// `count` groups of one.
    pub fn new(count: usize) -> Self {
        Self { parent: (0..count as u32).collect() }
    }

    /// Returns the lowest member of the group of `member`.
    pub fn find(&mut self, member: u32) -> u32 {
        let mut at = member;
        while let Some(&up) = self.parent.get(at as usize).filter(|&&up| up != at) {
            let above = self.parent.get(up as usize).copied().unwrap_or(up);
            if let Some(slot) = self.parent.get_mut(at as usize) {
                *slot = above;
            }
            at = above;
        }
        at
    }

    /// Joins the groups of two members.
    pub fn join(&mut self, a: u32, b: u32) {
        let (a, b) = (self.find(a), self.find(b));
        if let Some(slot) = self.parent.get_mut(a.max(b) as usize) {
            *slot = a.min(b);
        }
    }

    /// Returns the number of each member's group, groups counted in order of their lowest member, and the number of groups.
    pub fn numbered(&mut self) -> (Vec<PointIndex>, usize) {
        let mut count = 0;
        let mut numbers: Vec<PointIndex> = Vec::with_capacity(self.parent.len());
        for member in 0..self.parent.len() as u32 {
            let first = self.find(member);
            let number = match numbers.get(first as usize) {
                Some(&number) => number,
                None => {
                    count += 1;
                    PointIndex(count - 1)
                }
            };
            numbers.push(number);
        }
        (numbers, count as usize)
    }
}

/// Width of the cells in which coinciding vertices are looked for, over the tolerance \[-\]. Of cells this wide one or two along each
/// axis are within the tolerance of a vertex.
const CELL_WIDTH_FACTOR: f64 = 4.0;

/// Returns the first vertex at the position of each vertex, by a grid of cells.
fn find_sites(positions: &[Vec3], tolerance: f64) -> Vec<u32> {
    let width = if tolerance > 0.0 { CELL_WIDTH_FACTOR * tolerance } else { f64::MIN_POSITIVE.sqrt() };
    let cell = |p: &Vec3| [0, 1, 2].map(|k| (p[k] / width).floor() as i64);
    // A little more than the tolerance, which rounding must not cut off.
    let reach = Vec3::repeat(1.001 * tolerance);
    let mut cells: FxHashMap<[i64; 3], Vec<u32>> = FxHashMap::default();
    let mut groups = Groups::new(positions.len());
    for (vertex, p) in positions.iter().enumerate() {
        let own = cell(p);
        let (low, high) = (cell(&(p - reach)), cell(&(p + reach)));
        let near = (low[0]..=high[0]).flat_map(|x| (low[1]..=high[1]).map(move |y| [x, y]));
        for near in near.flat_map(|[x, y]| (low[2]..=high[2]).map(move |z| [x, y, z])) {
            for &other in cells.get(&near).map_or(&[][..], Vec::as_slice) {
                let q = positions.get(other as usize).unwrap_or(p);
                if (p - q).norm() <= tolerance {
                    groups.join(other, vertex as u32);
                }
            }
        }
        let members = cells.entry(own).or_default();
        // One vertex per exact position stands for all: a thousand copies of it would be compared with each other.
        match members.iter().find(|&&other| positions.get(other as usize) == Some(p)) {
            Some(&same) => groups.join(same, vertex as u32),
            None => members.push(vertex as u32),
        }
    }
    (0..positions.len() as u32).map(|vertex| groups.find(vertex)).collect()
}

/// Returns the ends of edges with one triangle, in increasing order.
fn open_vertices(triangles: &[[u32; 3]]) -> Vec<u32> {
    let mut edges: Vec<[u32; 2]> = triangles
        .iter()
        .flat_map(|&[a, b, c]| [[a, b], [b, c], [c, a]])
        .map(|[a, b]| [a.min(b), a.max(b)])
        .collect();
    edges.sort_unstable();
    let mut open: Vec<u32> =
        edges.chunk_by(|a, b| a == b).filter(|same| same.len() == 1).flat_map(|same| same[0]).collect();
    open.sort_unstable();
    open.dedup();
    open
}

#[cfg(test)]
mod tests {
    use super::*;

    fn weld(positions: &[Vec3], triangles: &[[u32; 3]]) -> Vec<u32> {
        let mut welder = Welder::new(positions, 1e-5);
        welder.join_open_edges(triangles);
        welder.join_short_edges(triangles);
        welder.points().0.iter().map(|p| p.0).collect()
    }

    #[test]
    fn a_seam_is_closed_and_its_neighbourhood_left_alone() {
        let at = |x: f64, y: f64| Vec3::new(x, y, 0.0);
        let positions = [
            at(0.0, 0.0),
            at(1.0, 0.0),
            at(0.0, 1.0),
            at(1.0, 0.0),
            at(1.0, 1.0),
            at(4e-6, 1.0),
            at(1.0, 1.00002),
        ];
        let points = weld(&positions, &[[0, 1, 2], [3, 4, 5], [4, 6, 5]]);
        assert_eq!(points, [0, 1, 2, 1, 3, 2, 4], "4 um are joined, 20 um are not");
    }

    /// Two closed fans whose centres coincide: two layers lying on each other.
    #[test]
    fn layers_that_touch_stay_apart() {
        let ring = |height: f64| {
            (0..6).map(move |k| {
                let angle = f64::from(k) * std::f64::consts::TAU / 6.0;
                Vec3::new(angle.cos(), height, angle.sin())
            })
        };
        let mut positions = vec![Vec3::zeros()];
        positions.extend(ring(0.1));
        positions.push(Vec3::zeros());
        positions.extend(ring(-0.1));
        let fan = |hub: u32| (0..6).map(move |k| [hub, hub + 1 + k, hub + 1 + (k + 1) % 6]);
        let triangles: Vec<[u32; 3]> = fan(0).chain(fan(7)).collect();
        assert_eq!(weld(&positions, &triangles), (0..14).collect::<Vec<_>>());
    }

    #[test]
    fn soup_of_triangles_becomes_a_sheet() {
        // 10 x 10 squares, every triangle with vertices of its own, in single precision far from the origin.
        let (mut positions, mut triangles) = (Vec::new(), Vec::new());
        let at = |x: u32, y: u32| Vec3::new(f64::from(0.1 * x as f32 + 7.0), f64::from(0.1 * y as f32), -3.0);
        for (x, y) in (0..10).flat_map(|x| (0..10).map(move |y| (x, y))) {
            for corners in [[(x, y), (x + 1, y), (x + 1, y + 1)], [(x, y), (x + 1, y + 1), (x, y + 1)]] {
                let first = positions.len() as u32;
                positions.extend(corners.map(|(x, y)| at(x, y)));
                triangles.push([first, first + 1, first + 2]);
            }
        }
        assert_eq!(weld(&positions, &triangles).into_iter().max(), Some(120));
    }

    #[test]
    fn edges_without_length_collapse() {
        let positions = [Vec3::zeros(), Vec3::x(), Vec3::x() * (1.0 + 1e-7), Vec3::y()];
        let points = weld(&positions, &[[0, 1, 3], [1, 2, 3], [0, 2, 1], [0, 3, 2]]);
        assert_eq!(points, [0, 1, 1, 2]);
    }

    #[test]
    fn any_tolerance_and_position_is_accepted() {
        for tolerance in [0.0, 1e-300, 1e300] {
            for far in [0.0, 1e300, -1e300] {
                let positions = [Vec3::repeat(far), Vec3::repeat(far)];
                assert_eq!(Welder::new(&positions, tolerance).site(1), 0);
            }
        }
    }
}
