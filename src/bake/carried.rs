//! The shape of a garment with a memory that was transferred to it: that of a bake, on a mesh made for its creases.
//!
//! A crease that crosses the triangles of a file cannot open on them without stretching them. Where the sources have crease
//! lines, the target is therefore relaxed on a mesh of its surface with edges along these lines, and the displacement is read off
//! at the points of the file.

use crate::bake::choose_mesh::{EdgeLengths, make};
use crate::bake::relax::{relax, relax_to_show};
use crate::bake::relax_to_source::{RelaxOptions, RelaxResult};
use crate::bake::uncross::GarmentReading;
use crate::fabric::Fabric;
use crate::garment::{Garment, RigidParts};
use crate::mesh::intersections::self_intersections;
use crate::remesh::SimulationMesh;
use crate::transfer::{CarriedOnMesh, DrawnCreases, TransferResult};

/// The mesh of `garment` with edges along the creases `drawn` on it; `None` where its layers would cross on that mesh, and for a
/// garment with trims, which move with its own triangles.
pub fn mesh_along_creases(garment: &Garment, mut drawn: DrawnCreases) -> Option<SimulationMesh> {
    if RigidParts::find(garment).is_some() {
        return None;
    }
    let lengths = EdgeLengths::new(garment, drawn.row);
    make(&mut drawn.mesh, lengths, lengths.max);
    let mesh = drawn.mesh.finish();
    let crossings = |garment: &Garment| self_intersections(&garment.points, &garment.triangles).len();
    (crossings(&mesh.garment) <= crossings(garment)).then_some(mesh)
}

/// Relaxes `garment` of `fabric` to its source pose with the memory `carried` to it.
pub fn relax_carried(garment: &Garment, fabric: &Fabric, carried: &TransferResult) -> RelaxResult {
    let Some(CarriedOnMesh { mesh, memory }) = &carried.on_mesh else {
        return relax(garment, fabric, &carried.memory);
    };
    let options = RelaxOptions::visible_on(garment, fabric);
    let relaxed = relax_to_show(&mesh.garment, fabric, memory, &options);
    let reading = GarmentReading::new(garment, fabric.thickness(), None);
    let (displacement, _) = reading.displacement(mesh, &relaxed.displacement);
    RelaxResult { displacement, ..relaxed }
}
