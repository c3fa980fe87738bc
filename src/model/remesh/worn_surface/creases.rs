//! Creases as curves on a garment's surface: what its folds left, apart from the mesh that carried it.

use crate::garment::{Garment, RestState};
use crate::remesh::GarmentSurface;
use crate::remesh::surface_mesh::{SurfacePoint, clamped_weights};
use crate::remesh::worn_surface::crease_edges::CreaseEdges;
use crate::remesh::worn_surface::sided_search::SidedSearch;
use crease_geometry::math::Vec3;
use crease_geometry::mesh::triangle::corners;

/// Crease along which a garment was folded.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct Crease {
    /// Places along it on the garment, two at least.
    pub places: Vec<SurfacePoint>,
    /// Change of the rest angle between each two of them [rad], with that of the rows beside it.
    pub angle: Vec<f64>,
    /// Stiffness ratio between each two of them [-], 1 for new cloth.
    pub stiffness_ratio: Vec<f64>,
    /// Width of cloth over which it bends [m].
    pub width: f64,
}

impl Crease {
    /// The creases of `memory` on `mesh`, which lies on the surface of `garment`; they are `width` [m] wide.
    pub fn find(mesh: &GarmentSurface, memory: &RestState, garment: &Garment, width: f64) -> Vec<Self> {
        let changes: Vec<f64> = memory.angle_changes().collect();
        let edges = CreaseEdges::find(mesh, &changes);
        let angles = edges.net_angles(mesh, &changes);
        let places = Places::new(mesh, garment);
        let of_line = |line: &(Vec<u32>, Vec<u32>)| Self {
            places: line.0.iter().map(|p| places.at(*p)).collect(),
            angle: line.1.iter().map(|h| angles[*h as usize]).collect(),
            stiffness_ratio: line.1.iter().map(|h| memory.stiffness_ratio[*h as usize]).collect(),
            width,
        };
        edges.lines.iter().map(of_line).collect()
    }
}

/// Crease of a memory as hinges of the mesh that carries it.
#[derive(Debug, Clone, PartialEq)]
pub struct CreaseChain {
    /// Points along it, two at least.
    pub points: Vec<u32>,
    /// Hinge between each two of them.
    pub hinges: Vec<u32>,
    /// Change of the rest angle there [rad], with that of the rows beside it.
    pub angle: Vec<f64>,
    /// Hinges of the rows beside each of `hinges`.
    pub rows: Vec<Vec<u32>>,
}

impl CreaseChain {
    /// The creases of `memory` on `mesh`, the strongest first.
    pub fn all(mesh: &GarmentSurface, memory: &RestState) -> Vec<Self> {
        let changes: Vec<f64> = memory.angle_changes().collect();
        let edges = CreaseEdges::find(mesh, &changes);
        let angles = edges.net_angles(mesh, &changes);
        let mut rows: Vec<Vec<u32>> = vec![Vec::new(); changes.len()];
        edges.rows().for_each(|(row, centre)| rows[centre].push(row as u32));
        let of_line = |(points, hinges): &(Vec<u32>, Vec<u32>)| Self {
            points: points.clone(),
            hinges: hinges.clone(),
            angle: hinges.iter().map(|h| angles[*h as usize]).collect(),
            rows: hinges.iter().map(|h| rows[*h as usize].clone()).collect(),
        };
        edges.lines.iter().map(of_line).collect()
    }
}

/// Search for places of a mesh on a garment.
struct Places<'a> {
    garment: &'a Garment,
    mesh: &'a GarmentSurface,
    search: SidedSearch<'a>,
    /// Sum of the area vectors of the triangles at every point of the mesh [m²].
    facing: Vec<Vec3>,
}

impl<'a> Places<'a> {
    fn new(mesh: &'a GarmentSurface, garment: &'a Garment) -> Self {
        let mut facing = vec![Vec3::zeros(); mesh.points.len()];
        for (f, t) in mesh.triangles.iter().enumerate() {
            t.iter().for_each(|p| facing[p.at()] += mesh.normal(f));
        }
        Self { search: SidedSearch::new(&garment.points, &garment.triangles), facing, garment, mesh }
    }

    /// The place of the garment closest to point `p` of the mesh, on the same side of the cloth if there is one.
    fn at(&self, p: u32) -> SurfacePoint {
        let x = self.mesh.points[p as usize];
        let own = self.facing[p as usize].try_normalize(0.0);
        let found = self.search.nearest(x, f64::INFINITY, own);
        let face = found.or_else(|| self.search.nearest_of_any_side(x)).unwrap_or(0);
        let of_face = corners(&self.garment.points, &self.garment.triangles[face as usize]);
        SurfacePoint { face, weights: clamped_weights(&x, &of_face) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crease_geometry::mesh::hinge_angle;

    /// A sheet of squares of 8 mm with a memory of its edges along z: `change` [rad] by the distance from its middle in squares, and by the fraction
    /// of its length; and the x of that middle [m].
    fn folded(change: impl Fn(i32, f64) -> f64) -> (Garment, RestState, f64) {
        let garment = Garment::sheet([0.08, 0.16], [10, 20]).expect("is a sheet");
        let mesh = GarmentSurface::without_texture(&garment);
        let middle = mesh.points.iter().map(|x| x.x).sum::<f64>() / mesh.points.len() as f64;
        let low = mesh.points.iter().map(|x| x.z).fold(f64::INFINITY, f64::min);
        let angle = |h: &crease_geometry::mesh::Hinge| hinge_angle(&h.points.map(|p| mesh.points[p.at()]));
        let mut memory =
            RestState::new(mesh.topology.hinges.iter().map(angle).collect(), mesh.triangles.len());
        for (h, hinge) in mesh.topology.hinges.iter().enumerate() {
            let [a, b, ..] = hinge.points.map(|p| mesh.points[p.at()]);
            if (a.x - b.x).abs() < 1e-9 {
                let column = ((a.x - middle) / 8e-3).round() as i32;
                memory.rest_angle[h] += change(column, (0.5 * (a.z + b.z) - low) / 0.16);
            }
        }
        (garment, memory, middle)
    }

    #[test]
    fn a_fold_that_bends_along_its_line_and_a_row_in_turn_is_one_straight_crease() {
        let in_turn = |column: i32, part: f64| match (column, part < 0.4, part < 0.6) {
            (0, true, _) | (1, _, false) => 1.5,
            (0 | 1, false, true) => 0.75,
            _ => 0.0,
        };
        let (garment, memory, middle) = folded(in_turn);
        let mesh = GarmentSurface::without_texture(&garment);
        let found = Crease::find(&mesh, &memory, &garment, 2e-3);
        assert_eq!(found.len(), 1, "{found:?}");
        assert_eq!(found[0].places.len(), 21);
        let x = |at: &SurfacePoint| -> f64 {
            let t = garment.triangles[at.face as usize].map(|p| garment.points[p.at()].x);
            (0..3).map(|k| t[k] * at.weights[k]).sum()
        };
        let first = x(&found[0].places[0]);
        assert!((first - middle).abs() < 8.1e-3);
        assert!(found[0].places.iter().all(|at| (x(at) - first).abs() < 1e-9));
        assert!(found[0].angle.iter().all(|angle| (angle - 1.5).abs() < 1e-9), "{:?}", found[0].angle);
    }

    #[test]
    fn a_crease_goes_on_where_its_angle_is_small_for_a_short_way() {
        let with_gap =
            |column: i32, part: f64| if column == 0 && !(0.4..0.6).contains(&part) { 1.0 } else { 0.0 };
        let (garment, memory, _) = folded(with_gap);
        let mesh = GarmentSurface::without_texture(&garment);
        let found = Crease::find(&mesh, &memory, &garment, 2e-3);
        assert_eq!(found.iter().map(|crease| crease.places.len()).collect::<Vec<_>>(), [21]);
    }

    #[test]
    fn a_fold_is_one_crease_with_the_angle_of_its_rows() {
        // The hinges beside the line keep a part of the angle.
        let (garment, memory, middle) = folded(|column, _| match column {
            0 => 1.0,
            -1 | 1 => 0.3,
            _ => 0.0,
        });
        let mesh = GarmentSurface::without_texture(&garment);
        let found = Crease::find(&mesh, &memory, &garment, 2e-3);
        assert_eq!(found.len(), 1, "{found:?}");
        assert_eq!((found[0].places.len(), found[0].angle.len()), (21, 20));
        for at in &found[0].places {
            let t = garment.triangles[at.face as usize].map(|p| garment.points[p.at()]);
            let x: Vec3 = (0..3).map(|k| t[k] * at.weights[k]).sum();
            assert!((x.x - middle).abs() < 1e-9);
        }
        assert!(found[0].angle.iter().all(|angle| (angle - 1.6).abs() < 1e-9), "{:?}", found[0].angle);
    }

    #[test]
    fn a_mesh_made_for_folds_has_creases_on_their_lines_alone() {
        let (garment, memory, middle) =
            folded(|column, _| if column == 0 || column == 3 { 1.0 } else { 0.0 });
        let mut mesh = GarmentSurface::without_texture(&garment);
        assert_eq!(Crease::find(&mesh, &memory, &garment, 2e-3).len(), 2);
        mesh.on_fold_line = Some(mesh.points.iter().map(|x| (x.x - middle).abs() < 1e-9).collect());
        assert_eq!(Crease::find(&mesh, &memory, &garment, 2e-3).len(), 1);
        mesh.on_fold_line = Some(vec![false; mesh.points.len()]);
        assert_eq!(Crease::find(&mesh, &memory, &garment, 2e-3), []);
    }
}
