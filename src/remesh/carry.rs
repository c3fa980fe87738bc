//! Shapes of a simulation mesh carried to the garment that lies on it.
//!
//! The edges of the mesh are chords of the garment's surface: wrinkles of the source pose that are finer than they stay beside it.
//! What lies between a point of the garment and its place on the mesh is carried along, turned as the mesh turns there.

use crate::math::Vec3;
use crate::mesh::{point_rotations, turned};
use crate::remesh::{SimulationMesh, SurfacePoint};

impl SimulationMesh {
    /// Positions of the points of the source garment, whose source positions are `source`, with the points of the mesh at `shape`.
    /// In the source pose they are `source` itself.
    pub fn carry(&self, source: &[Vec3], shape: &[Vec3]) -> Vec<Vec3> {
        if self.is_source {
            return shape.to_vec();
        }
        let rest = &self.garment.points;
        let rotations = point_rotations(rest, &self.garment.triangles, shape);
        let (on_source, on_shape) = (self.to_source(rest), self.to_source(shape));
        let carried = |((x, at), (from, to)): ((&Vec3, &SurfacePoint), (&Vec3, &Vec3))| {
            let corners = &self.garment.triangles[at.face as usize];
            to + turned(&rotations, corners, &at.weights, &(x - from))
        };
        source.iter().zip(&self.source_location).zip(on_source.iter().zip(&on_shape)).map(carried).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::garment::Garment;
    use crate::mesh::{Hinge, hinge_angle};
    use crate::remesh::simulation_mesh::tests::sheet;
    use crate::remesh::{SizeField, SurfaceMesh, improve};
    use nalgebra::Rotation3;

    /// A sheet with wrinkles 30 mm apart and 2 mm high, and a mesh of edges of 40 mm on it.
    fn wrinkled() -> (Garment, SimulationMesh) {
        let mut sheet = sheet(0.005, 1.0);
        sheet.points.iter_mut().for_each(|x| x.y += 0.002 * (x.x * std::f64::consts::TAU / 0.03).sin());
        let mut mesh = SurfaceMesh::new(&sheet);
        improve(&mut mesh, &SizeField::new(&[], 0.04, 1.0, 0.04));
        let mesh = mesh.finish();
        (sheet, mesh)
    }

    fn angles(garment: &Garment, x: &[Vec3]) -> Vec<f64> {
        let of = |h: &Hinge| hinge_angle(&h.points.map(|p| x[p.at()]));
        garment.topology.hinges.iter().map(of).collect()
    }

    #[test]
    fn wrinkles_finer_than_the_mesh_stay() {
        let (sheet, mesh) = wrinkled();
        assert!(mesh.garment.points.len() < sheet.points.len() / 8, "{}", mesh.garment.points.len());
        let source = angles(&sheet, &sheet.points);
        let bent = source.iter().filter(|a| a.abs() > 0.2).count();
        assert!(bent > source.len() / 10, "{bent} of {}", source.len());
        // In place, to the last bits; turned as a whole, with the same angles.
        let still = mesh.carry(&sheet.points, &mesh.garment.points);
        assert!(still.iter().zip(&sheet.points).all(|(a, b)| (a - b).norm() < 1e-12));
        let turn = Rotation3::from_euler_angles(0.7, -1.1, 2.0);
        let shape: Vec<Vec3> = mesh.garment.points.iter().map(|x| turn * x).collect();
        let turned = angles(&sheet, &mesh.carry(&sheet.points, &shape));
        assert!(turned.iter().zip(&source).all(|(a, b)| (a - b).abs() < 1e-9));
        // On a cylinder of 0.2 m all but a few hinges change by what the cylinder bends them.
        let roll = |x: &Vec3| {
            let (sin, cos) = (x.x / 0.2).sin_cos();
            Vec3::new((0.2 + x.y) * sin, (0.2 + x.y) * cos, x.z)
        };
        let shape: Vec<Vec3> = mesh.garment.points.iter().map(roll).collect();
        let rolled = angles(&sheet, &mesh.carry(&sheet.points, &shape));
        let moved = rolled.iter().zip(&source).filter(|(a, b)| (**a - **b).abs() > 0.15).count();
        assert!(moved < source.len() / 50, "{moved} of {}", source.len());
    }
}
