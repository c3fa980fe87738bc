//! The mesh of a USD surface deformable.
//!
//! After the deformables proposal of the AOUSD physics working group: one triangle mesh with
//! `PhysicsSurfaceDeformableSimAPI`, whose `physics:restBendAngles` are degrees, one per pair of adjacent triangles in
//! `physics:restAdjTriPairs`. The mesh is the welded one, its points the worn shape; `physics:restShapePoints` is the rest
//! mesh and `physics:restBendAnglesDefault` says `restShape`, so that a simulator which reads only those has the creases
//! too. Angles lie in [-180, 180); positive where the wings fold away from the normals, as everywhere in crease. (The
//! proposal leaves the sign open.) It is a guide: renderers leave it out.

use crate::usd::prim::{Prim, extent, list, vectors};
use crate::usd::scene::{MATERIALS, PHYSICS_MATERIAL, UsdShape};
use crease_geometry::math::Vec3;
use crease_model::error::{Error, Result};
use crease_model::garment::Garment;

/// Bending and rest points of a file, as read back.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct UsdaMemory {
    /// Pairs of adjacent triangles, one per hinge.
    pub pairs: Vec<[u32; 2]>,
    /// Rest angles, one per pair \[degrees\].
    pub angles_deg: Vec<f64>,
    /// Rest points [m].
    pub rest_points: Vec<Vec3>,
}

/// Returns the mesh that a simulator of deformables takes: worn shape and rest shape (displacements [m], one per point), rest
/// angles [rad], one per hinge.
pub(super) fn simulation_mesh(garment: &Garment, shape: &UsdShape) -> Prim {
    let moved =
        |shift: &[Vec3]| -> Vec<Vec3> { garment.points.iter().zip(shift).map(|(x, d)| x + d).collect() };
    let worn = moved(shape.worn);
    let corners = garment.triangles.iter().flatten().map(|p| p.0.to_string());
    let counts = garment.triangles.iter().map(|_| "3".to_owned());
    let hinges = &garment.topology.hinges;
    let pairs = hinges.iter().map(|h| format!("({}, {})", h.triangles[0], h.triangles[1]));
    let angles = shape.rest_angle.iter().map(|angle| format!("{}", wrapped_deg(*angle) as f32));
    Prim::new("Mesh", "Simulation")
        .api(&["PhysicsSurfaceDeformableSimAPI", "PhysicsCollisionAPI", "MaterialBindingAPI"])
        .line("uniform bool doubleSided = 1".into())
        .line(format!("float3[] extent = {}", extent([&worn[..]])))
        .line(format!("int[] faceVertexCounts = {}", list(counts)))
        .line(format!("int[] faceVertexIndices = {}", list(corners)))
        .line(format!("rel material:binding:physics = <{MATERIALS}/{PHYSICS_MATERIAL}>"))
        .line(format!("point3f[] points = {}", vectors(&worn)))
        .line(format!("point3f[] physics:restShapePoints = {}", vectors(&moved(shape.rest))))
        .line("uniform token physics:restBendAnglesDefault = \"restShape\"".into())
        .line(format!("int2[] physics:restAdjTriPairs = {}", list(pairs)))
        .line(format!("float[] physics:restBendAngles = {}", list(angles)))
        .line("uniform token purpose = \"guide\"".into())
        .line("uniform token subdivisionScheme = \"none\"".into())
}

/// Returns `angle` [rad] in degrees, wrapped to [-180, 180).
pub fn wrapped_deg(angle: f64) -> f64 {
    (angle.to_degrees() + 180.0).rem_euclid(360.0) - 180.0
}

/// Reads the bending data of a file of [`crate::write_usda`]; `file` names it in diagnostics.
pub fn read_usda(file: &str, bytes: &[u8]) -> Result<UsdaMemory> {
    let text = String::from_utf8_lossy(bytes);
    let numbers = |name: &str| -> Result<Vec<f64>> {
        let missing = || Error::input(file, name, "is missing", "write the file again");
        let line = text.lines().find(|line| line.contains(name)).ok_or_else(missing)?;
        let (_, values) = line.split_once(" = ").ok_or_else(missing)?;
        let words = values.split(['[', ']', '(', ')', ',', ' ']).filter(|word| !word.is_empty());
        let parsed: std::result::Result<Vec<f64>, _> = words.map(str::parse).collect();
        parsed.map_err(|_| {
            Error::input(file, name, "holds something that is no number", "write the file again")
        })
    };
    let pairs = numbers("physics:restAdjTriPairs")?;
    let points = numbers("physics:restShapePoints")?;
    Ok(UsdaMemory {
        pairs: pairs.as_chunks::<2>().0.iter().map(|p| p.map(|f| f as u32)).collect(),
        angles_deg: numbers("physics:restBendAngles = ")?,
        rest_points: points.as_chunks::<3>().0.iter().map(|&p| Vec3::from(p)).collect(),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn angles_are_wrapped_to_the_half_open_turn() {
        use std::f64::consts::PI;
        for (angle, degrees) in [(0.0, 0.0), (PI / 2.0, 90.0), (PI, -180.0), (-PI, -180.0), (3.5 * PI, -90.0)]
        {
            assert!((wrapped_deg(angle) - degrees).abs() < 1e-9, "{angle}: {}", wrapped_deg(angle));
        }
    }

    #[test]
    fn the_layout_of_two_triangles_is_fixed() {
        let text = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 1 1 0\nf 1 2 3\nf 4 3 2\n";
        let options = crate::ReadOptions::default();
        let (asset, _) =
            crate::read_asset("two.obj", text.as_bytes(), &options, &mut |_| Ok(Vec::new())).unwrap();
        let (garment, _) = Garment::from_asset(&asset).unwrap();
        let still = vec![Vec3::zeros(); 4];
        let shape = UsdShape { worn: &still, rest: &still, rest_angle: &[0.5] };
        let mut written = String::new();
        simulation_mesh(&garment, &shape).write(&mut written, 0);
        assert!(written.contains("int[] faceVertexIndices = [0, 1, 2, 3, 2, 1]\n"), "{written}");
        assert!(written.contains("int2[] physics:restAdjTriPairs = [(0, 1)]\n"));
        assert!(written.contains("float[] physics:restBendAngles = [28.64789]\n"), "degrees, not radians");
        let back = read_usda("two.usda", written.as_bytes()).unwrap();
        assert_eq!(back.pairs, [[0, 1]]);
        assert_eq!(back.rest_points, garment.points);
        assert!((back.angles_deg[0] - 28.64789).abs() < 1e-6);
        assert!(read_usda("two.usda", b"#usda 1.0\n").is_err());
    }
}
