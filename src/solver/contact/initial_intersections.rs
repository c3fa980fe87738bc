//! Intersections that exist at the start: left out of barrier and step bounds until they come apart.
//!
//! Pushing apart two triangles that intersect pushes them in the wrong direction as often as not, and a bound that keeps their corners and
//! edges from meeting keeps them hooked for ever. The same holds for what lies inside the line of intersection: a patch of cloth that has
//! come through is on the wrong side as a whole (Baraff, Witkin, Kass, "Untangling Cloth", 2003). So a patch is grown from every group of
//! intersecting triangles by the parts of the mesh that it cuts off, but for the largest. Pairs of two patches that intersect each other
//! are ignored; all others are guarded.
//!
//! The count never grows: no position is accepted at which more triangles intersect than at the start, counted exactly
//! (`mesh::intersections`). What has come apart is guarded from the next step on.

use crease_geometry::math::Vec3;
use crease_geometry::mesh::intersections::self_intersections;
use crease_geometry::mesh::{INVALID, PointIndex};
use rustc_hash::FxHashSet;

/// Intersecting triangles, and the patches whose pairs are ignored.
#[derive(Debug, Clone, Default)]
pub(super) struct InitialIntersections {
    /// Pairs of triangles, sorted.
    pairs: Vec<[u32; 2]>,
    /// Largest number of pairs allowed: that of the start.
    max_allowed: usize,
    patches: Patches,
    /// Pairs of patches that intersect, in both orders.
    intersecting: FxHashSet<[u32; 2]>,
}

/// A mesh at given positions.
#[derive(Clone, Copy)]
pub(super) struct MeshView<'a> {
    /// Positions [m], one per point.
    pub x: &'a [Vec3],
    pub triangles: &'a [[PointIndex; 3]],
    /// Edges of each triangle.
    pub triangle_edges: &'a [[u32; 3]],
    pub edge_count: usize,
}

impl InitialIntersections {
    /// Counts the intersections of `mesh`. `before` is the count of an earlier step, if there was one.
    pub fn find(mesh: MeshView, before: Option<&Self>) -> Self {
        let pairs = self_intersections(mesh.x, mesh.triangles);
        let patches = Patches::around(mesh, pairs.iter().flatten().copied().collect());
        let max_allowed = before.map_or(pairs.len(), |before| before.max_allowed);
        let mut intersecting = FxHashSet::default();
        for &pair in &pairs {
            let [a, b] = pair.map(|f| patches.seed[f as usize]);
            intersecting.extend([[a, b], [b, a]]);
        }
        Self { pairs, max_allowed, patches, intersecting }
    }

    /// Whether nothing intersects.
    pub fn is_empty(&self) -> bool {
        self.pairs.is_empty()
    }

    /// Whether the pair of a point and a triangle is ignored.
    pub fn ignores_point_triangle(&self, p: u32, f: u32) -> bool {
        self.ignores(self.patches.of_point(p), self.patches.of_triangle(f))
    }

    /// Whether the pair of two edges is ignored.
    pub fn ignores_edges(&self, e: u32, f: u32) -> bool {
        self.ignores(self.patches.of_edge(e), self.patches.of_edge(f))
    }

    /// Whether more triangles intersect in `mesh` than at the start.
    pub fn adds_intersections(&self, mesh: MeshView) -> bool {
        !self.is_empty() && self_intersections(mesh.x, mesh.triangles).len() > self.max_allowed
    }

    fn ignores(&self, first: &[u32], second: &[u32]) -> bool {
        first.iter().any(|&a| second.iter().any(|&b| self.intersecting.contains(&[a, b])))
    }
}

/// Patches of a mesh: which primitives belong to which. A triangle may belong to several.
#[derive(Debug, Clone, Default)]
struct Patches {
    /// Patch that grew from each triangle, or [`INVALID`]. Empty when nothing intersects.
    seed: Vec<u32>,
    triangles: Vec<Vec<u32>>,
    points: Vec<Vec<u32>>,
    edges: Vec<Vec<u32>>,
}

impl Patches {
    /// Grows patches from `intersecting` triangles.
    fn around(mesh: MeshView, intersecting: Vec<u32>) -> Self {
        if intersecting.is_empty() {
            return Self::default();
        }
        let count = mesh.triangles.len();
        let mut intersects = vec![false; count];
        intersecting.iter().for_each(|&f| intersects[f as usize] = true);
        let adjacency = Adjacency::new(mesh);
        let every = vec![true; count];
        let others: Vec<bool> = intersects.iter().map(|c| !c).collect();
        // Intersecting triangles are connected at points, the parts they cut off at edges.
        let seed = adjacency.parts(&intersects, false);
        let cut_off = adjacency.parts(&others, true);
        let whole = adjacency.parts(&every, true);
        let largest = largest_of_each(&cut_off, &whole);
        let mut triangles = vec![Vec::new(); count];
        let mut joined: FxHashSet<[u32; 2]> = FxHashSet::default();
        for (f, &patch) in seed.iter().enumerate().filter(|(_, patch)| **patch != INVALID) {
            triangles[f].push(patch);
            for g in adjacency.at_points(f) {
                let part = cut_off[g as usize];
                if part != INVALID && !largest[part as usize] {
                    joined.insert([part, patch]);
                }
            }
        }
        let mut joined: Vec<[u32; 2]> = joined.into_iter().collect();
        joined.sort_unstable();
        for (f, &part) in cut_off.iter().enumerate().filter(|(_, part)| **part != INVALID) {
            let from = joined.partition_point(|t| t[0] < part);
            triangles[f].extend(joined[from..].iter().take_while(|t| t[0] == part).map(|t| t[1]));
        }
        let (mut points, mut edges) = (vec![Vec::new(); mesh.x.len()], vec![Vec::new(); mesh.edge_count]);
        for (f, patches) in triangles.iter().enumerate() {
            for &patch in patches {
                mesh.triangles[f].iter().for_each(|p| add_once(&mut points[p.at()], patch));
                mesh.triangle_edges[f].iter().for_each(|&e| add_once(&mut edges[e as usize], patch));
            }
        }
        Self { seed, triangles, points, edges }
    }

    fn of_triangle(&self, f: u32) -> &[u32] {
        self.triangles.get(f as usize).map_or(&[], Vec::as_slice)
    }

    fn of_point(&self, p: u32) -> &[u32] {
        self.points.get(p as usize).map_or(&[], Vec::as_slice)
    }

    fn of_edge(&self, e: u32) -> &[u32] {
        self.edges.get(e as usize).map_or(&[], Vec::as_slice)
    }
}

fn add_once(list: &mut Vec<u32>, patch: u32) {
    if !list.contains(&patch) {
        list.push(patch);
    }
}

/// Returns whether a part of `cut_off` is the largest within its part of `whole`, one flag per part.
fn largest_of_each(cut_off: &[u32], whole: &[u32]) -> Vec<bool> {
    let count = cut_off.iter().filter(|p| **p != INVALID).map(|p| *p as usize + 1).max().unwrap_or(0);
    let mut size = vec![0usize; count];
    let mut container = vec![INVALID; count];
    for (part, whole) in cut_off.iter().zip(whole).filter(|(part, _)| **part != INVALID) {
        size[*part as usize] += 1;
        container[*part as usize] = *whole;
    }
    let mut best: Vec<Option<usize>> = vec![None; whole.iter().map(|h| *h as usize + 1).max().unwrap_or(0)];
    for part in 0..count {
        let best = &mut best[container[part] as usize];
        if best.is_none_or(|b| size[b] < size[part]) {
            *best = Some(part);
        }
    }
    let mut largest = vec![false; count];
    best.into_iter().flatten().for_each(|part| largest[part] = true);
    largest
}

/// Triangles around each point and edge.
struct Adjacency<'a> {
    mesh: MeshView<'a>,
    point: Vec<Vec<u32>>,
    edge: Vec<Vec<u32>>,
}

impl<'a> Adjacency<'a> {
    fn new(mesh: MeshView<'a>) -> Self {
        let (mut point, mut edge) = (vec![Vec::new(); mesh.x.len()], vec![Vec::new(); mesh.edge_count]);
        for (f, (corners, sides)) in mesh.triangles.iter().zip(mesh.triangle_edges).enumerate() {
            corners.iter().for_each(|p| point[p.at()].push(f as u32));
            sides.iter().for_each(|&e| edge[e as usize].push(f as u32));
        }
        Self { mesh, point, edge }
    }

    fn at_points(&self, f: usize) -> impl Iterator<Item = u32> + '_ {
        self.mesh.triangles[f].into_iter().flat_map(|p| self.point[p.at()].iter().copied())
    }

    fn at_edges(&self, f: usize) -> impl Iterator<Item = u32> + '_ {
        self.mesh.triangle_edges[f].into_iter().flat_map(|e| self.edge[e as usize].iter().copied())
    }

    /// Returns the connected part of each triangle that is set in `included`, parts counted from 0 in the order of their first triangle;
    /// [`INVALID`] for the others.
    fn parts(&self, included: &[bool], by_edges: bool) -> Vec<u32> {
        let mut part = vec![INVALID; included.len()];
        let mut count = 0;
        let mut open = Vec::new();
        for first in 0..included.len() {
            if !included[first] || part[first] != INVALID {
                continue;
            }
            part[first] = count;
            open.push(first);
            while let Some(f) = open.pop() {
                let mut visit = |g: u32| {
                    let g = g as usize;
                    if included[g] && part[g] == INVALID {
                        part[g] = count;
                        open.push(g);
                    }
                };
                if by_edges {
                    self.at_edges(f).for_each(&mut visit)
                } else {
                    self.at_points(f).for_each(&mut visit)
                }
            }
            count += 1;
        }
        part
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crease_geometry::mesh::Topology;

    /// A level sheet of n x n quads of 1 cm, with a bump of `height` [m] in the middle.
    fn sheet(n: u32, base: u32, height: f64) -> (Vec<Vec3>, Vec<[PointIndex; 3]>) {
        let at = |i: u32, j: u32| PointIndex(base + j * (n + 1) + i);
        let middle = f64::from(n) / 2.0;
        let position = |k: u32| {
            let (x, z) = (f64::from(k % (n + 1)) - middle, f64::from(k / (n + 1)) - middle);
            Vec3::new(0.01 * x, height * (-(x * x + z * z) / 8.0).exp(), 0.0101 * z)
        };
        let points = (0..(n + 1) * (n + 1)).map(position).collect();
        let quad = |k: u32| {
            let (i, j) = (k % n, k / n);
            [[at(i, j), at(i + 1, j), at(i + 1, j + 1)], [at(i, j), at(i + 1, j + 1), at(i, j + 1)]]
        };
        (points, (0..n * n).flat_map(quad).collect())
    }

    #[test]
    fn what_the_line_of_crossing_cuts_off_is_free_and_nothing_else() {
        let n = 20;
        let (mut x, mut triangles) = sheet(n, 0, 0.03);
        let half = x.len() as u32;
        let (flat, more) = sheet(n, half, 0.0);
        x.extend(flat.iter().map(|p| p + Vec3::new(1e-3, 0.01, 2e-3)));
        triangles.extend(more);
        let topology = Topology::new(x.len(), &triangles);
        let mesh = MeshView {
            x: &x,
            triangles: &triangles,
            triangle_edges: &topology.triangle_edges,
            edge_count: topology.edges.len(),
        };
        let found = InitialIntersections::find(mesh, None);
        assert!(found.pairs.len() > 20);
        // The bump's top is on the wrong side of the other sheet's middle; the corners are where they should be.
        let middle = (n / 2) * (n + 1) + n / 2;
        let over = (triangles.len() / 2 + triangles.len() / 4) as u32 + n;
        assert!(found.ignores_point_triangle(middle, over));
        assert!(
            !found.ignores_point_triangle(0, over)
                && !found.ignores_point_triangle(middle, triangles.len() as u32 - 1)
        );
        assert!(!found.adds_intersections(mesh));
        let mut worse = x.clone();
        worse[..half as usize].iter_mut().for_each(|p| p.y += 2e-3);
        let now = InitialIntersections::find(MeshView { x: &worse, ..mesh }, Some(&found));
        assert_eq!(
            found.adds_intersections(MeshView { x: &worse, ..mesh }),
            now.pairs.len() > found.pairs.len()
        );
        worse[..half as usize].iter_mut().for_each(|p| p.y -= 0.05);
        assert!(InitialIntersections::find(MeshView { x: &worse, ..mesh }, Some(&found)).is_empty());
    }
}
