//! Crossings that are there at the start: left out of the response and of the bound until they come apart.
//!
//! Pushing apart two triangles that cross pushes them the wrong way as often as not, and a bound that keeps their
//! corners and edges from meeting keeps them hooked for ever. The same holds for what lies inside the line of crossing:
//! a patch of cloth that has come through is on the wrong side as a whole (Baraff, Witkin, Kass, "Untangling Cloth",
//! 2003). So a patch is grown from every group of crossing triangles by the parts of the mesh that it cuts off, but for
//! the largest; what lies in two patches that cross each other may pass freely, and all else is guarded as ever.
//!
//! That it does not get worse is not left to chance: no position is accepted at which more triangles cross than at
//! the start, counted exactly (`mesh::intersections`). What has come apart is guarded from the next step on.

use crate::math::Vec3;
use crate::mesh::PointIndex;
use crate::mesh::intersections::self_intersections;
use rustc_hash::FxHashSet;

/// Triangles that cross, and the patches that are therefore left alone.
#[derive(Debug, Clone, Default)]
pub(super) struct InitialIntersections {
    /// Pairs of triangles of the cloth, sorted.
    pub layers: Vec<[u32; 2]>,
    /// How many there may be: as many as at the start.
    allowed: usize,
    patches: Patches,
    /// Pairs of patches that cross, both ways round.
    cross: FxHashSet<[u32; 2]>,
}

/// A mesh as it is counted: positions [m], triangles, the edges of each triangle, and the number of edges.
#[derive(Clone, Copy)]
pub(super) struct Mesh<'a> {
    pub x: &'a [Vec3],
    pub triangles: &'a [[PointIndex; 3]],
    pub triangle_edges: &'a [[u32; 3]],
    pub edge_count: usize,
}

impl InitialIntersections {
    /// Counts at these places. `before` is the count of an earlier step, if there was one.
    pub fn find(cloth: Mesh, before: Option<&Self>) -> Self {
        let layers = self_intersections(cloth.x, cloth.triangles);
        let patches = Patches::around(cloth, layers.iter().flatten().copied().collect());
        let allowed = before.map_or(layers.len(), |before| before.allowed);
        let mut cross = FxHashSet::default();
        for &pair in &layers {
            let [a, b] = pair.map(|f| patches.seed[f as usize]);
            cross.extend([[a, b], [b, a]]);
        }
        Self { layers, allowed, patches, cross }
    }

    /// Whether nothing crosses.
    pub fn is_empty(&self) -> bool {
        self.layers.is_empty()
    }

    /// Whether a point and a triangle of the cloth are left alone.
    pub fn frees_point(&self, p: u32, f: u32) -> bool {
        crossing(&self.cross, self.patches.point(p), self.patches.triangle(f))
    }

    /// Whether two edges of the cloth are left alone.
    pub fn frees_edges(&self, e: u32, f: u32) -> bool {
        crossing(&self.cross, self.patches.edge(e), self.patches.edge(f))
    }

    /// Whether more triangles cross at these places than at the start.
    pub fn is_worse_at(&self, cloth: Mesh) -> bool {
        !self.is_empty() && self_intersections(cloth.x, cloth.triangles).len() > self.allowed
    }
}

fn crossing(cross: &FxHashSet<[u32; 2]>, first: &[u32], second: &[u32]) -> bool {
    first.iter().any(|&a| second.iter().any(|&b| cross.contains(&[a, b])))
}

/// Patches of one mesh: what belongs to which. A triangle may belong to several.
#[derive(Debug, Clone, Default)]
struct Patches {
    /// Per triangle: the patch that grew from it, or [`NONE`]. Empty when nothing crosses.
    seed: Vec<u32>,
    of_triangle: Vec<Vec<u32>>,
    of_point: Vec<Vec<u32>>,
    of_edge: Vec<Vec<u32>>,
}

/// No patch, no part.
const NONE: u32 = u32::MAX;

impl Patches {
    /// Patches grown from `crossing` triangles.
    fn around(mesh: Mesh, crossing: Vec<u32>) -> Self {
        if crossing.is_empty() {
            return Self::default();
        }
        let count = mesh.triangles.len();
        let mut crosses = vec![false; count];
        crossing.iter().for_each(|&f| crosses[f as usize] = true);
        let around = Around::new(mesh);
        let every = vec![true; count];
        let quiet: Vec<bool> = crosses.iter().map(|c| !c).collect();
        // Crossing triangles hang together at points, the parts they cut off at edges.
        let seed = around.parts(&crosses, false);
        let cut_off = around.parts(&quiet, true);
        let whole = around.parts(&every, true);
        let largest = largest_of_each(&cut_off, &whole);
        let mut of_triangle = vec![Vec::new(); count];
        let mut taken: FxHashSet<[u32; 2]> = FxHashSet::default();
        for (f, &patch) in seed.iter().enumerate().filter(|(_, patch)| **patch != NONE) {
            of_triangle[f].push(patch);
            for g in around.at_points(f) {
                let part = cut_off[g as usize];
                if part != NONE && !largest[part as usize] {
                    taken.insert([part, patch]);
                }
            }
        }
        let mut taken: Vec<[u32; 2]> = taken.into_iter().collect();
        taken.sort_unstable();
        for (f, &part) in cut_off.iter().enumerate().filter(|(_, part)| **part != NONE) {
            let from = taken.partition_point(|t| t[0] < part);
            of_triangle[f].extend(taken[from..].iter().take_while(|t| t[0] == part).map(|t| t[1]));
        }
        let (mut of_point, mut of_edge) = (vec![Vec::new(); mesh.x.len()], vec![Vec::new(); mesh.edge_count]);
        for (f, patches) in of_triangle.iter().enumerate() {
            for &patch in patches {
                let corners = mesh.triangles[f].map(|p| p.at());
                let sides = mesh.triangle_edges[f].map(|e| e as usize);
                let owners = corners.map(|p| (p, false)).into_iter().chain(sides.map(|e| (e, true)));
                for (k, is_edge) in owners {
                    let list: &mut Vec<u32> = if is_edge { &mut of_edge[k] } else { &mut of_point[k] };
                    if !list.contains(&patch) {
                        list.push(patch);
                    }
                }
            }
        }
        Self { seed, of_triangle, of_point, of_edge }
    }

    fn triangle(&self, f: u32) -> &[u32] {
        self.of_triangle.get(f as usize).map_or(&[], Vec::as_slice)
    }

    fn point(&self, p: u32) -> &[u32] {
        self.of_point.get(p as usize).map_or(&[], Vec::as_slice)
    }

    fn edge(&self, e: u32) -> &[u32] {
        self.of_edge.get(e as usize).map_or(&[], Vec::as_slice)
    }
}

/// Per part of `cut_off`: whether it is the largest within its part of `whole`.
fn largest_of_each(cut_off: &[u32], whole: &[u32]) -> Vec<bool> {
    let count = cut_off.iter().filter(|p| **p != NONE).map(|p| *p as usize + 1).max().unwrap_or(0);
    let mut size = vec![(0usize, NONE); count];
    for (part, home) in cut_off.iter().zip(whole).filter(|(part, _)| **part != NONE) {
        size[*part as usize].0 += 1;
        size[*part as usize].1 = *home;
    }
    let mut best: Vec<Option<usize>> = vec![None; whole.iter().map(|h| *h as usize + 1).max().unwrap_or(0)];
    for (part, (triangles, home)) in size.iter().enumerate() {
        let best = &mut best[*home as usize];
        if best.is_none_or(|b| size[b].0 < *triangles) {
            *best = Some(part);
        }
    }
    let mut largest = vec![false; count];
    best.into_iter().flatten().for_each(|part| largest[part] = true);
    largest
}

/// Which triangles are around a point or an edge.
struct Around<'a> {
    mesh: Mesh<'a>,
    point: Vec<Vec<u32>>,
    edge: Vec<Vec<u32>>,
}

impl<'a> Around<'a> {
    fn new(mesh: Mesh<'a>) -> Self {
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

    /// Connected parts of the triangles in question, counted from 0 in the order of their first triangle; [`NONE`] for
    /// the others.
    fn parts(&self, of: &[bool], by_edges: bool) -> Vec<u32> {
        let mut part = vec![NONE; of.len()];
        let mut count = 0;
        let mut open = Vec::new();
        for first in 0..of.len() {
            if !of[first] || part[first] != NONE {
                continue;
            }
            part[first] = count;
            open.push(first);
            while let Some(f) = open.pop() {
                let mut reach = |g: u32| {
                    let g = g as usize;
                    if of[g] && part[g] == NONE {
                        part[g] = count;
                        open.push(g);
                    }
                };
                if by_edges {
                    self.at_edges(f).for_each(&mut reach)
                } else {
                    self.at_points(f).for_each(&mut reach)
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
    use crate::mesh::Topology;

    /// A level sheet of n x n quads of 1 cm, with a bump of `height` [m] in the middle.
    fn sheet(n: u32, base: u32, height: f64) -> (Vec<Vec3>, Vec<[PointIndex; 3]>) {
        let at = |i: u32, j: u32| PointIndex(base + j * (n + 1) + i);
        let middle = f64::from(n) / 2.0;
        let place = |k: u32| {
            let (x, z) = (f64::from(k % (n + 1)) - middle, f64::from(k / (n + 1)) - middle);
            Vec3::new(0.01 * x, height * (-(x * x + z * z) / 8.0).exp(), 0.0101 * z)
        };
        let points = (0..(n + 1) * (n + 1)).map(place).collect();
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
        let mesh = Mesh {
            x: &x,
            triangles: &triangles,
            triangle_edges: &topology.triangle_edges,
            edge_count: topology.edges.len(),
        };
        let found = InitialIntersections::find(mesh, None);
        assert!(found.layers.len() > 20);
        // The bump's top is on the wrong side of the other sheet's middle; the corners are where they should be.
        let middle = (n / 2) * (n + 1) + n / 2;
        let over = (triangles.len() / 2 + triangles.len() / 4) as u32 + n;
        assert!(found.frees_point(middle, over));
        assert!(!found.frees_point(0, over) && !found.frees_point(middle, triangles.len() as u32 - 1));
        assert!(!found.is_worse_at(mesh));
        let mut worse = x.clone();
        worse[..half as usize].iter_mut().for_each(|p| p.y += 2e-3);
        let now = InitialIntersections::find(Mesh { x: &worse, ..mesh }, Some(&found));
        assert_eq!(found.is_worse_at(Mesh { x: &worse, ..mesh }), now.layers.len() > found.layers.len());
        worse[..half as usize].iter_mut().for_each(|p| p.y -= 0.05);
        assert!(InitialIntersections::find(Mesh { x: &worse, ..mesh }, Some(&found)).is_empty());
    }
}
