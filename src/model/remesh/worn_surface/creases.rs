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

    #[test]
    fn a_fold_is_one_crease_with_the_angle_of_its_rows() {
        // A sheet of squares of 8 mm, folded along x = 40 mm, whose hinges beside that line keep a part of the angle.
        let garment = Garment::sheet([0.08, 0.16], [10, 20]).expect("is a sheet");
        let mesh = GarmentSurface::without_texture(&garment);
        let middle = garment.points.iter().map(|x| x.x).sum::<f64>() / garment.points.len() as f64;
        let (hinges, triangles) = (mesh.topology.hinges.len(), mesh.triangles.len());
        let mut memory = RestState::new(
            mesh.topology
                .hinges
                .iter()
                .map(|h| hinge_angle(&h.points.map(|p| mesh.points[p.at()])))
                .collect(),
            triangles,
        );
        for h in 0..hinges {
            let [a, b, ..] = mesh.topology.hinges[h].points.map(|p| mesh.points[p.at()]);
            if (a.x - b.x).abs() > 1e-9 {
                continue;
            }
            let offset = (a.x - middle).abs();
            memory.rest_angle[h] += if offset < 1e-6 {
                1.0
            } else if offset < 9e-3 {
                0.3
            } else {
                0.0
            };
        }
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
}
