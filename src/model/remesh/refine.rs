//! Refinement during the wear: triangles are bisected at their longest edges (Rivara 1984), so that angles stay bounded.
//!
//! New points lie in the middle of edges, in the source pose and wherever the cloth is: the surface does not change, so no
//! layers cross by it. Every half of a hinge keeps its angle and its memory; hinges inside a bisected triangle are flat and new.

use crate::garment::Garment;
use crate::remesh::simulation_mesh::SimulationMesh;
use crate::remesh::surface_mesh::SurfacePoint;
use crease_geometry::math::{Vec2, Vec3};
use crease_geometry::mesh::{Hinge, PointIndex, Topology, edge_key};
use rustc_hash::FxHashMap;
use std::collections::hash_map::Entry;

/// A simulation mesh after splits of edges, with the origin of its elements.
#[derive(Debug, Clone)]
pub struct Refinement {
    /// The refined mesh: the points of the coarser one first, then one per split.
    pub mesh: SimulationMesh,
    /// Ends of every split edge, in order: a later split may name the point of an earlier one.
    pub splits: Vec<[u32; 2]>,
    /// Per hinge of the refined mesh: the hinge of the coarser one that it is a part of; `None` inside of a triangle of that.
    pub hinge_parent: Vec<Option<u32>>,
    /// Per triangle of the refined mesh: the triangle of the coarser one that it is a part of.
    pub triangle_parent: Vec<u32>,
}

impl SimulationMesh {
    /// Bisects the triangles `marked`, and others as far as that needs them bisected first.
    pub fn bisect(&self, marked: &[u32]) -> Refinement {
        let mut bisection = Bisection::of(self);
        for &f in marked {
            // Triangle f keeps its number while one half of it is left.
            let area = bisection.area2(f);
            while bisection.area2(f) > 0.75 * area {
                let edge = bisection.terminal_edge(f);
                bisection.split(edge);
            }
        }
        bisection.finish(self)
    }

    /// Splits edges at their middles, in order. `None` if an edge is not one of the mesh at its turn.
    pub fn split(&self, splits: &[[u32; 2]]) -> Option<Refinement> {
        let mut bisection = Bisection::of(self);
        for &[a, b] in splits {
            let edge = edge_key(a, b);
            if !bisection.on_edge.contains_key(&edge) {
                return None;
            }
            bisection.split(edge);
        }
        Some(bisection.finish(self))
    }
}

impl Refinement {
    /// Values of all points [m] from those of the points of the coarser mesh.
    pub fn points(&self, coarse: &[Vec3]) -> Vec<Vec3> {
        let mut all = coarse.to_vec();
        for [a, b] in &self.splits {
            all.push(0.5 * (all[*a as usize] + all[*b as usize]));
        }
        all
    }

    /// Flags of all points from those of the points of the coarser mesh: those of a new point if both of its ends have it.
    pub fn flags(&self, coarse: &[bool]) -> Vec<bool> {
        flags_with_middles(&self.splits, coarse)
    }
}

/// Flags of all points after `splits` from those before: those of a new point if both ends of its edge have it.
fn flags_with_middles(splits: &[[u32; 2]], coarse: &[bool]) -> Vec<bool> {
    let mut all = coarse.to_vec();
    for [a, b] in splits {
        all.push(all[*a as usize] && all[*b as usize]);
    }
    all
}

/// A mesh in the course of splits.
struct Bisection {
    /// Source positions [m].
    points: Vec<Vec3>,
    triangles: Vec<[u32; 3]>,
    material: Vec<[Vec2; 3]>,
    triangle_parent: Vec<u32>,
    on_edge: FxHashMap<[u32; 2], Vec<u32>>,
    splits: Vec<[u32; 2]>,
    /// Per new edge along an old one: an edge of the coarser mesh.
    edge_parent: FxHashMap<[u32; 2], u32>,
    /// Bisections of every triangle, in order.
    cuts: Vec<Vec<Cut>>,
}

/// Bisection of a triangle: one half keeps its number, the other gets a new one.
#[derive(Debug, Clone, Copy)]
struct Cut {
    /// Number of the other half.
    other: u32,
    /// Corners at the ends of the bisected edge: of the half that keeps the number, and of the other.
    ends: [usize; 2],
}

impl Bisection {
    fn of(mesh: &SimulationMesh) -> Self {
        let garment = &mesh.garment;
        let triangles: Vec<[u32; 3]> = garment.triangles.iter().map(|t| t.map(|p| p.0)).collect();
        let mut on_edge: FxHashMap<[u32; 2], Vec<u32>> = FxHashMap::default();
        for (f, t) in triangles.iter().enumerate() {
            for k in 0..3 {
                on_edge.entry(edge_key(t[k], t[(k + 1) % 3])).or_default().push(f as u32);
            }
        }
        let edges = garment.topology.edges.iter().enumerate();
        Self {
            points: garment.points.clone(),
            material: garment.material.clone(),
            triangle_parent: (0..triangles.len() as u32).collect(),
            cuts: vec![Vec::new(); triangles.len()],
            triangles,
            on_edge,
            splits: Vec::new(),
            edge_parent: edges.map(|(e, [a, b])| (edge_key(a.0, b.0), e as u32)).collect(),
        }
    }

    /// Twice the area of triangle `f` [m²].
    fn area2(&self, f: u32) -> f64 {
        let m = &self.material[f as usize];
        (m[1] - m[0]).perp(&(m[2] - m[0])).abs()
    }

    /// The longest edge of triangle `f`; of two, the one of the lower number.
    fn longest_edge(&self, f: u32) -> [u32; 2] {
        let t = self.triangles[f as usize];
        let length = |edge: &[u32; 2]| (self.points[edge[0] as usize] - self.points[edge[1] as usize]).norm();
        let mut edges = [0, 1, 2].map(|k| edge_key(t[k], t[(k + 1) % 3]));
        edges.sort_by(|a, b| length(b).total_cmp(&length(a)).then(a.cmp(b)));
        edges[0]
    }

    /// The edge at the end of the path over longest edges from triangle `f`: the longest of all of its triangles.
    fn terminal_edge(&self, f: u32) -> [u32; 2] {
        let mut edge = self.longest_edge(f);
        // Every step leads to a longer edge, or to one as long with a lower number: there is an end.
        loop {
            let around = self.on_edge.get(&edge).into_iter().flatten();
            match around.map(|&g| self.longest_edge(g)).filter(|longest| *longest != edge).min() {
                Some(longer) => edge = longer,
                None => return edge,
            }
        }
    }

    fn split(&mut self, edge: [u32; 2]) {
        let [a, b] = edge;
        let new = self.points.len() as u32;
        self.points.push(0.5 * (self.points[a as usize] + self.points[b as usize]));
        self.splits.push(edge);
        if let Some(parent) = self.edge_parent.remove(&edge) {
            self.edge_parent.insert(edge_key(a, new), parent);
            self.edge_parent.insert(edge_key(b, new), parent);
        }
        let mut on = self.on_edge.remove(&edge).unwrap_or_default();
        // The same numbers come out whether the splits so far were made at once or in several refinements.
        on.sort_unstable();
        for f in on {
            let g = self.triangles.len() as u32;
            let (t, m) = (self.triangles[f as usize], self.material[f as usize]);
            let middle: Vec2 = 0.5 * (0..3).filter(|&k| t[k] == a || t[k] == b).map(|k| m[k]).sum::<Vec2>();
            let half = |gone: u32| {
                let (mut t, mut m) = (t, m);
                for k in (0..3).filter(|&k| t[k] == gone).collect::<Vec<_>>() {
                    (t[k], m[k]) = (new, middle);
                }
                (t, m)
            };
            // One half keeps the number and the end `a`.
            (self.triangles[f as usize], self.material[f as usize]) = half(b);
            let (other, other_material) = half(a);
            self.triangles.push(other);
            self.material.push(other_material);
            self.triangle_parent.push(self.triangle_parent[f as usize]);
            self.cuts.push(Vec::new());
            let corner = |p: u32| t.iter().position(|q| *q == p).unwrap_or(0);
            self.cuts[f as usize].push(Cut { other: g, ends: [corner(a), corner(b)] });
            let Some(&c) = t.iter().find(|&&p| p != a && p != b) else { continue };
            // The edge from b to c belongs to the other half now.
            if let Entry::Occupied(mut on) = self.on_edge.entry(edge_key(b, c)) {
                on.get_mut().iter_mut().filter(|h| **h == f).for_each(|h| *h = g);
            }
            self.on_edge.entry(edge_key(a, new)).or_default().push(f);
            self.on_edge.entry(edge_key(b, new)).or_default().push(g);
            self.on_edge.insert(edge_key(c, new), vec![f, g]);
        }
    }

    fn finish(self, coarse: &SimulationMesh) -> Refinement {
        let source = &coarse.garment;
        let triangles: Vec<[PointIndex; 3]> = self.triangles.iter().map(|t| t.map(PointIndex)).collect();
        let with_middles = |mask: &[f64]| {
            let mut mask = mask.to_vec();
            for [a, b] in &self.splits {
                mask.push(0.5 * (mask[*a as usize] + mask[*b as usize]));
            }
            mask
        };
        let (memory_mask, sewing_mask) =
            (with_middles(&source.memory_mask), with_middles(&source.sewing_mask));
        let topology = Topology::new(self.points.len(), &triangles);
        let parent = |hinge: &Hinge| {
            let edge = self.edge_parent.get(&edge_key(hinge.points[0].0, hinge.points[1].0))?;
            source.topology.edge_hinge[*edge as usize]
        };
        let hinge_parent = topology.hinges.iter().map(parent).collect();
        let mut source_triangle = coarse.source_triangle.clone();
        for [a, _] in &self.splits {
            source_triangle.push(source_triangle[*a as usize]);
        }
        let on_fold_line = source.on_fold_line.as_ref().map(|on| flags_with_middles(&self.splits, on));
        let inherited =
            |of: &[u32]| -> Vec<u32> { self.triangle_parent.iter().map(|&f| of[f as usize]).collect() };
        let located = coarse.source_location.iter().map(|at| self.locate(at)).collect();
        let garment = Garment {
            points: self.points,
            material: self.material,
            material_from_uv: source.material_from_uv,
            source_point: Vec::new(),
            memory_mask,
            sewing_mask,
            triangle_part: inherited(&source.triangle_part),
            triangle_panel: inherited(&source.triangle_panel),
            inner_side: vec![false; triangles.len()],
            file_triangles: Vec::new(),
            on_fold_line,
            topology,
            triangles,
        };
        Refinement {
            mesh: SimulationMesh { garment, is_source: false, source_location: located, source_triangle },
            splits: self.splits,
            hinge_parent,
            triangle_parent: self.triangle_parent,
        }
    }

    /// The location `at` of the coarser mesh, on the refined one: cut by cut in the half that holds it. The same numbers come out
    /// whether the cuts were made at once or in several refinements.
    fn locate(&self, at: &SurfacePoint) -> SurfacePoint {
        let SurfacePoint { mut face, mut weights } = *at;
        let mut next = 0;
        while let Some(&Cut { other, ends: [a, b] }) = self.cuts[face as usize].get(next) {
            // With m = (a + b) / 2: w_a a + w_b b = (w_a - w_b) a + 2 w_b m.
            let (wa, wb) = (weights[a], weights[b]);
            if wa >= wb {
                (weights[a], weights[b]) = (wa - wb, 2.0 * wb);
                next += 1;
            } else {
                (weights[a], weights[b]) = (2.0 * wa, wb - wa);
                (face, next) = (other, 0);
            }
        }
        SurfacePoint { face, weights }
    }
}
