//! Refines the mesh of a garment: `--resolution`.
//!
//! Edges longer than wanted are halved, longest first, with the triangles on them (longest-edge bisection, Rivara 1984:
//! no angle falls below half of the smallest one before). Every point keeps its number and position, new ones follow, so
//! that results at the source's points are read off without interpolation. New points lie on the source's flat triangles:
//! the source shape is that of the file, its curvature as coarse as the file's. Never coarsens: a finer file stays as it
//! is.

use crate::garment::Garment;
use crate::garment::tuning::TUNING;
use crease_geometry::math::{Vec2, Vec3};
use crease_geometry::mesh::{LongEdge, PointIndex, Topology, edge_key};
use rustc_hash::FxHashMap;
use std::collections::BinaryHeap;

/// Finer mesh of a garment.
#[derive(Debug, Clone)]
pub struct RefinedMesh {
    /// Fine garment, with the points of the source first.
    pub garment: Garment,
    /// Per fine triangle: the triangle of the source it is part of.
    pub parent: Vec<u32>,
}

impl Garment {
    /// Returns the mesh with edges halved until no triangle around the flagged points (one flag per point; empty for all)
    /// has an edge much longer than `edge` [m].
    pub fn refine(&self, edge: f64, wanted: &[bool]) -> RefinedMesh {
        let mut work = Bisection::new(self, edge.max(f64::MIN_POSITIVE));
        work.run(wanted);
        let Bisection { points, masks: [memory_mask, sewing_mask], triangles, material, parent, .. } = work;
        let inherited = |of: &[u32]| -> Vec<u32> {
            parent.iter().map(|f| of.get(*f as usize).copied().unwrap_or(0)).collect()
        };
        let topology = Topology::new(points.len(), &triangles);
        RefinedMesh {
            garment: Self {
                points,
                triangles,
                material,
                material_from_uv: self.material_from_uv,
                source_point: self.source_point.clone(),
                memory_mask,
                sewing_mask,
                triangle_part: inherited(&self.triangle_part),
                triangle_panel: inherited(&self.triangle_panel),
                inner_side: parent
                    .iter()
                    .map(|f| self.inner_side.get(*f as usize).copied().unwrap_or(false))
                    .collect(),
                file_triangles: self.exported_triangles().to_vec(),
                on_fold_line: None,
                topology,
            },
            parent,
        }
    }

    /// Returns the mean edge length of the source shape [m].
    ///
    /// ```
    /// let sheet = crease_model::garment::Garment::sheet([0.1, 0.1], [10, 10])?;
    /// assert!((0.01..0.0142).contains(&sheet.mean_edge()));
    /// # Ok::<(), crease_model::error::Error>(())
    /// ```
    pub fn mean_edge(&self) -> f64 {
        let length = |e: &[PointIndex; 2]| (self.points[e[0].at()] - self.points[e[1].at()]).norm();
        self.topology.edges.iter().map(length).sum::<f64>() / self.topology.edges.len().max(1) as f64
    }
}

/// State of a mesh whose edges are being halved.
struct Bisection {
    points: Vec<Vec3>,
    masks: [Vec<f64>; 2],
    triangles: Vec<[PointIndex; 3]>,
    material: Vec<[Vec2; 3]>,
    parent: Vec<u32>,
    /// Per triangle of the source: whether it is to be fine.
    wanted: Vec<bool>,
    /// Triangles on every edge.
    on_edge: FxHashMap<[PointIndex; 2], Vec<u32>>,
    /// Edges longer than this are halved [m].
    max_length: f64,
}

/// Side `k` of the triangle `t`.
fn side(t: &[PointIndex; 3], k: usize) -> [PointIndex; 2] {
    edge_key(t[k], t[(k + 1) % 3])
}

impl Bisection {
    fn new(garment: &Garment, edge: f64) -> Self {
        let mut on_edge: FxHashMap<[PointIndex; 2], Vec<u32>> = FxHashMap::default();
        for (f, t) in garment.triangles.iter().enumerate() {
            (0..3).for_each(|k| on_edge.entry(side(t, k)).or_default().push(f as u32));
        }
        Self {
            points: garment.points.clone(),
            masks: [garment.memory_mask.clone(), garment.sewing_mask.clone()],
            triangles: garment.triangles.clone(),
            material: garment.material.clone(),
            parent: (0..garment.triangles.len() as u32).collect(),
            wanted: Vec::new(),
            on_edge,
            max_length: TUNING.max_length_factor * edge,
        }
    }

    fn length(&self, [a, b]: [PointIndex; 2]) -> f64 {
        (self.points[a.at()] - self.points[b.at()]).norm()
    }

    fn long(&self, ends: [PointIndex; 2]) -> Option<LongEdge<PointIndex>> {
        let length = self.length(ends);
        (length > self.max_length).then_some(LongEdge { length, ends })
    }

    fn run(&mut self, wanted: &[bool]) {
        let is_wanted = |t: &[PointIndex; 3]| {
            wanted.is_empty() || t.iter().any(|p| wanted.get(p.at()).copied().unwrap_or(false))
        };
        self.wanted = self.triangles.iter().map(is_wanted).collect();
        let around = self.triangles.iter().zip(&self.wanted).filter(|(_, wanted)| **wanted);
        let mut open: BinaryHeap<LongEdge<PointIndex>> =
            around.flat_map(|(t, _)| (0..3).map(|k| side(t, k))).filter_map(|edge| self.long(edge)).collect();
        while let Some(LongEdge { length, ends }) = open.pop() {
            if self.points.len() >= TUNING.max_points {
                break;
            }
            let Some(on) = self.on_edge.get(&ends).cloned() else { continue };
            // Unwanted triangles may have longer edges: halving a shorter one first would leave slivers.
            if let Some(longer) = self.longest_on(&on).filter(|long| *long > (LongEdge { length, ends })) {
                open.push(LongEdge { length, ends });
                open.push(longer);
                continue;
            }
            self.halve(ends, &on, &mut open);
        }
    }

    /// Returns the longest edge of some triangles.
    fn longest_on(&self, triangles: &[u32]) -> Option<LongEdge<PointIndex>> {
        let edges = triangles.iter().flat_map(|f| (0..3).map(|k| side(&self.triangles[*f as usize], k)));
        edges.map(|ends| LongEdge { length: self.length(ends), ends }).max()
    }

    fn halve(&mut self, edge: [PointIndex; 2], on: &[u32], open: &mut BinaryHeap<LongEdge<PointIndex>>) {
        let middle = PointIndex(self.points.len() as u32);
        for mask in &mut self.masks {
            mask.push(0.5 * (mask[edge[0].at()] + mask[edge[1].at()]));
        }
        self.points.push(0.5 * (self.points[edge[0].at()] + self.points[edge[1].at()]));
        self.on_edge.remove(&edge);
        for &f in on {
            let t = self.triangles[f as usize];
            let Some(k) = (0..3).find(|&k| side(&t, k) == edge) else { continue };
            let (a, b, c) = (k, (k + 1) % 3, (k + 2) % 3);
            let flat = self.material[f as usize];
            let half = 0.5 * (flat[a] + flat[b]);
            let new = self.triangles.len() as u32;
            (0..3).for_each(|k| {
                if let Some(list) = self.on_edge.get_mut(&side(&t, k)) {
                    list.retain(|other| *other != f);
                }
            });
            self.triangles[f as usize] = [t[a], middle, t[c]];
            self.material[f as usize] = [flat[a], half, flat[c]];
            self.triangles.push([middle, t[b], t[c]]);
            self.material.push([half, flat[b], flat[c]]);
            self.parent.push(self.parent[f as usize]);
            for part in [f, new] {
                let t = self.triangles[part as usize];
                for k in 0..3 {
                    self.on_edge.entry(side(&t, k)).or_default().push(part);
                }
            }
            if self.wanted[self.parent[f as usize] as usize] {
                open.extend(self.long(edge_key(middle, t[c])));
            }
        }
        // Halves of edges that only unwanted triangles have stay as long as they are.
        if on.iter().any(|f| self.wanted[self.parent[*f as usize] as usize]) {
            open.extend(edge.iter().filter_map(|end| self.long([*end, middle])));
        }
    }
}
