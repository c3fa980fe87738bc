//! The mesh that a garment is simulated on, and where each of both finds itself on the other.

use crate::garment::Garment;
use crate::garment::material_coords::flatten_triangle;
use crate::remesh::surface_finder::SurfaceFinder;
use crate::remesh::surface_mesh::{SurfaceMesh, SurfacePoint, interpolate};
use crease_geometry::math::Vec3;
use crease_geometry::mesh::{INVALID, PointIndex, Topology};
use std::collections::VecDeque;

/// A mesh that is simulated for a garment: its own triangles, or others on the same surface.
#[derive(Debug, Clone)]
pub struct SimulationMesh {
    /// The mesh as a garment of its own. No source vertex has a point of it unless it [is the source](Self::is_source).
    pub garment: Garment,
    /// Whether the mesh is the source garment itself.
    pub is_source: bool,
    /// Per point of the source garment: its location on the mesh.
    pub source_location: Vec<SurfacePoint>,
    /// Per point: the triangle of the source garment that it lies in, or one beside that.
    pub source_triangle: Vec<u32>,
}

impl SimulationMesh {
    /// The own triangles of `garment`.
    ///
    /// ```
    /// let sheet = crease_model::garment::Garment::sheet([0.2, 0.2], [2, 2])?;
    /// let mesh = crease_model::remesh::SimulationMesh::of_source(&sheet);
    /// assert!(mesh.is_source && mesh.to_source(&sheet.points) == sheet.points);
    /// # Ok::<(), crease_model::error::Error>(())
    /// ```
    pub fn of_source(garment: &Garment) -> Self {
        let mut source_location = vec![SurfacePoint { face: 0, weights: [0.0; 3] }; garment.points.len()];
        for (f, t) in garment.triangles.iter().enumerate() {
            for (k, p) in t.iter().enumerate() {
                source_location[p.at()] = SurfacePoint::corner(f as u32, k);
            }
        }
        let mut source_triangle = vec![0; garment.points.len()];
        for (f, t) in garment.triangles.iter().enumerate() {
            t.iter().for_each(|p| source_triangle[p.at()] = f as u32);
        }
        Self { garment: garment.clone(), is_source: true, source_location, source_triangle }
    }

    /// Numbers the triangles of `mesh` that are left.
    pub(super) fn of(mesh: &SurfaceMesh) -> Self {
        let source = mesh.source;
        let mut number = vec![PointIndex(u32::MAX); mesh.x.len()];
        let mut kept = Vec::new();
        for (p, around) in mesh.around.iter().enumerate() {
            if !around.is_empty() {
                number[p] = PointIndex(kept.len() as u32);
                kept.push(p);
            }
        }
        let faces: Vec<u32> = (0..mesh.triangles.len() as u32).filter(|&f| mesh.alive[f as usize]).collect();
        let triangles: Vec<[PointIndex; 3]> =
            faces.iter().map(|&f| mesh.triangles[f as usize].map(|p| number[p as usize])).collect();
        let location: Vec<SurfacePoint> = kept.iter().map(|&p| mesh.location[p]).collect();
        let mean = |mask: &[f64], at: &SurfacePoint| -> f64 {
            let t = source.triangles[at.face as usize];
            (0..3).map(|k| mask[t[k].at()] * at.weights[k]).sum()
        };
        let masked = |mask: &[f64]| -> Vec<f64> { location.iter().map(|at| mean(mask, at)).collect() };
        let garment = Garment {
            points: kept.iter().map(|&p| mesh.x[p]).collect(),
            material: faces.iter().map(|&f| flatten_triangle(&mesh.corners(f), mesh.warp(f))).collect(),
            material_from_uv: source.material_from_uv,
            source_point: Vec::new(),
            memory_mask: masked(&source.memory_mask),
            sewing_mask: masked(&source.sewing_mask),
            triangle_part: faces.iter().map(|&f| source.triangle_part[mesh.home(f) as usize]).collect(),
            triangle_panel: faces.iter().map(|&f| source.triangle_panel[mesh.home(f) as usize]).collect(),
            inner_side: vec![false; faces.len()],
            file_triangles: Vec::new(),
            on_fold_line: Some(kept.iter().map(|&p| mesh.is_on_line(p as u32)).collect()),
            topology: Topology::new(kept.len(), &triangles),
            triangles,
        };
        let homes: Vec<u32> = faces.iter().map(|&f| mesh.home(f)).collect();
        let source_location = locate_source(source, &garment, &location, &homes);
        let source_triangle = location.iter().map(|at| at.face).collect();
        Self { garment, is_source: false, source_location, source_triangle }
    }

    /// Values of the points of the source garment from those of the points of the mesh `x`, linear on its triangles.
    pub fn to_source(&self, x: &[Vec3]) -> Vec<Vec3> {
        self.source_location.iter().map(|at| interpolate(x, &self.garment.triangles, at)).collect()
    }

    /// Per point of the source garment: the triangle of the mesh it lies in.
    pub fn containing_triangles(&self) -> Vec<u32> {
        self.source_location.iter().map(|at| at.face).collect()
    }
}

/// Location of every point of `source` on `mesh`, found from point to point along the edges of the source, so that layers in one
/// place are not taken for one another.
fn locate_source(
    source: &Garment,
    mesh: &Garment,
    location: &[SurfacePoint],
    homes: &[u32],
) -> Vec<SurfacePoint> {
    // The triangle of the mesh from which the search begins, where one is known.
    let mut start = vec![INVALID; source.points.len()];
    for (f, (t, &home)) in mesh.triangles.iter().zip(homes).enumerate() {
        source.triangles[home as usize].iter().for_each(|p| start[p.at()] = start[p.at()].min(f as u32));
        // Corners inside the same sheet say more than the triangle's home.
        for p in t {
            let at = location[p.at()];
            if at.weights.iter().all(|w| *w > 1e-6) {
                source.triangles[at.face as usize].iter().for_each(|q| start[q.at()] = f as u32);
            }
        }
    }
    let mut neighbours = vec![Vec::new(); source.points.len()];
    for [a, b] in &source.topology.edges {
        neighbours[a.at()].push(b.at());
        neighbours[b.at()].push(a.at());
    }
    let mut found = vec![SurfacePoint { face: INVALID, weights: [1.0, 0.0, 0.0] }; source.points.len()];
    let mut queue: VecDeque<usize> = (0..source.points.len()).filter(|&p| start[p] != INVALID).collect();
    let finder = SurfaceFinder::new(mesh);
    while let Some(p) = queue.pop_front() {
        if found[p].face != INVALID {
            continue;
        }
        found[p] = finder.locate(start[p], &source.points[p]);
        for &q in &neighbours[p] {
            if start[q] == INVALID {
                start[q] = found[p].face;
                queue.push_back(q);
            }
        }
    }
    for at in &mut found {
        at.face = if at.face == INVALID { 0 } else { at.face };
    }
    found
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;
    use crate::remesh::{Curve, Seed, SizeField, improve};
    use crease_geometry::mesh::triangle::{area, longest_side};

    /// A level sheet of 0.3 x 0.2 m of triangles with a diagonal; `sliver` makes columns of two widths.
    pub fn sheet(step: f64, sliver: f64) -> Garment {
        let columns: Vec<f64> = {
            let mut x = vec![0.0];
            while *x.last().unwrap_or(&0.0) < 0.3 - 1e-9 {
                let last = x[x.len() - 1];
                x.push((last + if x.len() % 2 == 0 { step * sliver } else { step }).min(0.3));
            }
            x
        };
        let rows = (0.2 / step).round() as usize;
        let mut points = Vec::new();
        for j in 0..=rows {
            points.extend(columns.iter().map(|x| Vec3::new(*x, 0.0, 0.2 * j as f64 / rows as f64)));
        }
        let at = |i: usize, j: usize| (j * columns.len() + i) as u32;
        let mut triangles = Vec::new();
        for j in 0..rows {
            for i in 0..columns.len() - 1 {
                triangles.push([at(i, j), at(i, j + 1), at(i + 1, j)]);
                triangles.push([at(i + 1, j), at(i, j + 1), at(i + 1, j + 1)]);
            }
        }
        let sheet = Garment::of_triangles(points, &triangles);
        let shape = |t: &[PointIndex; 3]| t.map(|p| sheet.points[p.at()]);
        let material = sheet.triangles.iter().map(|t| flatten_triangle(&shape(t), Vec3::x())).collect();
        Garment { material, material_from_uv: true, ..sheet }
    }

    /// The sheet with a line along x = 0.13 and edges of 12 mm there, up to 40 mm elsewhere.
    fn aligned(source: &Garment) -> SimulationMesh {
        let mut mesh = SurfaceMesh::new(source);
        let mut level: Vec<f64> = mesh.x.iter().map(|p| p.x - 0.13).collect();
        mesh.cut(&mut level);
        let line = mesh.edges_on_line(&level);
        line.iter().for_each(|[a, b]| mesh.draw(*a, *b, Curve::Line(0)));
        let seeds: Vec<Seed> = line
            .iter()
            .flat_map(|[a, b]| Seed::along(mesh.x[*a as usize], mesh.x[*b as usize], 0.012))
            .collect();
        improve(&mut mesh, &SizeField::new(&seeds, 0.012, 1.0, 0.04));
        mesh.finish()
    }

    #[test]
    fn edges_lie_on_the_line_whatever_the_triangles_are() {
        for (step, sliver) in [(0.005, 1.0), (0.02, 1.0), (0.02, 0.05), (0.011, 0.3)] {
            let source = sheet(step, sliver);
            let mesh = aligned(&source);
            let garment = &mesh.garment;
            let area_of =
                |g: &Garment| -> f64 { g.triangles.iter().map(|t| area(&t.map(|p| g.points[p.at()]))).sum() };
            assert!((area_of(garment) - 0.06).abs() < 1e-9, "{step} {sliver}");
            assert_eq!(garment.topology.boundary_loops(&garment.triangles).len(), 1);
            let on_line = |p: PointIndex| (garment.points[p.at()].x - 0.13).abs() < 1e-9;
            let length: f64 = garment
                .topology
                .edges
                .iter()
                .filter(|edge| edge.iter().all(|p| on_line(*p)))
                .map(|[a, b]| (garment.points[a.at()] - garment.points[b.at()]).norm())
                .sum();
            assert!((length - 0.2).abs() < 1e-9, "{length} m of the line are edges ({step}, {sliver})");
            let shapes = garment.triangles.iter().map(|t| {
                let x = t.map(|p| garment.points[p.at()]);
                2.0 * area(&x) / longest_side(&x).powi(2)
            });
            let flattest = shapes.fold(f64::INFINITY, f64::min);
            assert!(flattest > 0.1, "{flattest} ({step}, {sliver})");
            assert!(garment.points.len() < 600, "{} points", garment.points.len());
        }
    }

    #[test]
    fn points_of_the_source_find_themselves_on_the_mesh() {
        let source = sheet(0.007, 1.0);
        let mesh = aligned(&source);
        let there = mesh.to_source(&mesh.garment.points);
        for (x, y) in source.points.iter().zip(&there) {
            assert!((x - y).norm() < 1e-9, "{x} {y}");
        }
    }
}
