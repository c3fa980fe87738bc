//! Welding: joins vertices that a file keeps apart (at texture borders, hard edges, between pieces) into points.
//!
//! Vertices join only if they coincide *and* either both lie on an open edge, as both sides of a seam do, or end the
//! same edge, which then has no length; on request also the nearest vertices of borders that are apart. So two layers that touch or lie on each other stay two layers: a vertex
//! in the middle of a layer, closed all around, is never joined to another layer's, unless the file itself gives it the
//! position of a vertex on an open edge. What else belongs together
//! (copies of a triangle) the caller joins. Only positions count, not texture or material.

use crate::math::Vec3;
use crate::mesh::PointIndex;
use rustc_hash::{FxHashMap, FxHashSet};
use std::cmp::Reverse;
use std::collections::BinaryHeap;

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

    /// Joins open edges of `triangles` to the inner edges of another connected part that lie in the same place: a pocket that is sewn onto
    /// the middle of a panel. Parts that only lie on one another have no edge in common.
    pub fn join_borders_onto_panels(&mut self, triangles: &[[u32; 3]]) {
        let mut parts = Groups::new(self.sites.len());
        let mut edges: Vec<([u32; 2], [u32; 2])> = Vec::with_capacity(3 * triangles.len());
        for &corners in triangles {
            let [a, b, c] = corners.map(|v| self.groups.find(v));
            parts.join(a, b);
            parts.join(a, c);
            for (from, to) in [(a, b), (b, c), (c, a)] {
                // The end with the lower site comes first.
                let ends = if self.site(from) <= self.site(to) { [from, to] } else { [to, from] };
                edges.push((ends.map(|v| self.site(v)), ends));
            }
        }
        edges.sort_unstable();
        for in_place in edges.chunk_by(|a, b| a.0 == b.0) {
            let runs: Vec<&[([u32; 2], [u32; 2])]> = in_place.chunk_by(|a, b| a.1 == b.1).collect();
            let Some(panel) = runs.iter().find(|run| run.len() > 1).map(|run| run[0].1) else { continue };
            for ends in runs.iter().filter(|run| run.len() == 1).map(|run| run[0].1) {
                if parts.find(ends[0]) != parts.find(panel[0]) {
                    ends.iter().zip(panel).for_each(|(&own, of)| self.groups.join(own, of));
                }
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

    /// Sews borders: joins vertices of `triangles` on open edges up to `distance` \[m\] apart, the nearest first. Vertices that the mesh
    /// connects within twice the distance stay apart, so that no edge loses its length and no border is gathered.
    pub fn join_borders(&mut self, positions: &[Vec3], triangles: &[[u32; 3]], distance: f64) {
        let mut joined: Vec<[u32; 3]> =
            triangles.iter().map(|corners| corners.map(|v| self.groups.find(v))).collect();
        joined.retain(|[a, b, c]| a != b && b != c && c != a);
        let open = open_vertices(&joined);
        let mesh = EdgeGraph::new(positions, &joined);
        let local: Vec<FxHashSet<u32>> = open
            .iter()
            .map(|&vertex| {
                let near = mesh.within(vertex, PATH_OVER_DISTANCE * distance);
                open.iter().copied().filter(|other| near.contains(other)).collect()
            })
            .collect();
        let is_local = |a: usize, b: u32| local.get(a).is_some_and(|near| near.contains(&b));
        let mut members: Vec<Vec<usize>> = (0..open.len()).map(|k| vec![k]).collect();
        let mut group: Vec<usize> = (0..open.len()).collect();
        for (a, b) in pairs_within(positions, &open, distance) {
            let (a_group, b_group) = (group[a], group[b]);
            let is_kept_apart = members[a_group]
                .iter()
                .any(|&one| members[b_group].iter().any(|&other| is_local(one, open[other])));
            if a_group == b_group || is_kept_apart {
                continue;
            }
            self.groups.join(open[a], open[b]);
            let moved = std::mem::take(&mut members[b_group]);
            moved.iter().for_each(|&member| group[member] = a_group);
            members[a_group].extend(moved);
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

/// Path along the edges within which two vertices on a border are neighbours, over the distance of sewing \[-\].
const PATH_OVER_DISTANCE: f64 = 2.0;

/// Nearest vertices of a border, at most, that one of its vertices may be sewn to: bounds the pairs at a large distance.
const MAX_SEWN_NEIGHBOURS: usize = 64;

/// Edges of a mesh with their lengths \[m\], by their ends.
struct EdgeGraph {
    neighbours: FxHashMap<u32, Vec<(u32, f64)>>,
}

impl EdgeGraph {
    fn new(positions: &[Vec3], triangles: &[[u32; 3]]) -> Self {
        let at = |v: u32| positions.get(v as usize).copied().unwrap_or_default();
        let mut neighbours: FxHashMap<u32, Vec<(u32, f64)>> = FxHashMap::default();
        for &[a, b, c] in triangles {
            for (from, to) in [(a, b), (b, c), (c, a)] {
                let length = (at(from) - at(to)).norm();
                neighbours.entry(from).or_default().push((to, length));
                neighbours.entry(to).or_default().push((from, length));
            }
        }
        Self { neighbours }
    }

    /// Returns the vertices that a path of at most `length` \[m\] along the edges connects with `start`.
    fn within(&self, start: u32, length: f64) -> FxHashSet<u32> {
        // Lengths of at least 0 have the order of their bits.
        let mut front = BinaryHeap::from([Reverse((0_u64, start))]);
        let mut reached: FxHashSet<u32> = FxHashSet::default();
        while let Some(Reverse((so_far, vertex))) = front.pop() {
            if !reached.insert(vertex) {
                continue;
            }
            for &(next, edge) in self.neighbours.get(&vertex).map_or(&[][..], Vec::as_slice) {
                let path = f64::from_bits(so_far) + edge;
                if path <= length && !reached.contains(&next) {
                    front.push(Reverse((path.to_bits(), next)));
                }
            }
        }
        reached
    }
}

/// Returns the pairs of entries of `vertices` up to `distance` \[m\] apart, the nearest first.
fn pairs_within(positions: &[Vec3], vertices: &[u32], distance: f64) -> Vec<(usize, usize)> {
    let at = |k: usize| positions.get(vertices[k] as usize).copied().unwrap_or_default();
    let mut along_x: Vec<usize> = (0..vertices.len()).collect();
    along_x.sort_by(|&a, &b| at(a).x.total_cmp(&at(b).x).then(a.cmp(&b)));
    let mut pairs: Vec<(f64, usize, usize)> = Vec::new();
    for (rank, &a) in along_x.iter().enumerate() {
        let near = along_x[rank + 1..].iter().take_while(|&&b| at(b).x - at(a).x <= distance);
        let mut of_one: Vec<(f64, usize, usize)> = near
            .map(|&b| ((at(a) - at(b)).norm(), a.min(b), a.max(b)))
            .filter(|pair| pair.0 <= distance)
            .collect();
        of_one.sort_by(|a, b| a.0.total_cmp(&b.0).then((a.1, a.2).cmp(&(b.1, b.2))));
        of_one.truncate(MAX_SEWN_NEIGHBOURS);
        pairs.extend(of_one);
    }
    pairs.sort_by(|a, b| a.0.total_cmp(&b.0).then((a.1, a.2).cmp(&(b.1, b.2))));
    pairs.into_iter().map(|(_, a, b)| (a, b)).collect()
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

    /// `cells` x `cells` squares of `edge` [m] from `x` on.
    fn sheet(cells: u32, edge: f64, x: f64) -> (Vec<Vec3>, Vec<[u32; 3]>) {
        let row = cells + 1;
        let at = |k: u32| Vec3::new(x + edge * f64::from(k % row), edge * f64::from(k / row), 0.0);
        let squares = (0..row * cells).filter(|k| k % row < cells);
        let halves = squares.flat_map(|k| [[k, k + 1, k + row], [k + 1, k + row + 1, k + row]]);
        ((0..row * row).map(at).collect(), halves.collect())
    }

    fn sew(positions: &[Vec3], triangles: &[[u32; 3]], distance: f64) -> (Vec<PointIndex>, usize) {
        let mut welder = Welder::new(positions, 1e-6);
        welder.join_open_edges(triangles);
        welder.join_short_edges(triangles);
        welder.join_borders(positions, triangles, distance);
        welder.points()
    }

    #[test]
    fn sewing_collapses_no_edge_however_short() {
        for distance in [0.001, 0.004, 0.05] {
            let (positions, triangles) = sheet(16, 0.003, 0.0);
            assert_eq!(sew(&positions, &triangles, distance).1, positions.len(), "{distance}");
        }
    }

    /// Two sheets with edges of 3 mm and a gap of 1 mm; then a strip of three, the ends of which lie on each other's height.
    #[test]
    fn borders_apart_are_sewn_vertex_by_vertex() {
        for distance in [0.0015, 0.004, 0.007] {
            let (mut positions, mut triangles) = sheet(16, 0.003, 0.0);
            let first = positions.len() as u32;
            let (more, others) = sheet(16, 0.003, 0.049);
            positions.extend(more);
            triangles.extend(others.into_iter().map(|corners| corners.map(|v| v + first)));
            let (points, count) = sew(&positions, &triangles, distance);
            assert_eq!(count, positions.len() - 17, "{distance}");
            for row in 0..17 {
                assert_eq!(points[17 * row + 16], points[first as usize + 17 * row], "{distance}: {row}");
            }
        }
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
