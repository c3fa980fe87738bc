//! The shape of a garment with a memory that was transferred to it: that of a bake, on a mesh made for its creases.
//!
//! A crease that crosses the triangles of a file cannot open on them without stretching them. Where the sources have crease
//! lines, the target is therefore relaxed on a mesh of its surface with edges along these lines, and the displacement is read off
//! at the points of the file.

use crate::bake::{
    EdgeLengths, GarmentReading, RelaxOptions, RelaxResult, crosses_elsewhere, make_mesh, relax_at_strength,
    relax_to_show,
};
use crate::transfer::crease_drawing::DrawnCreases;
use crate::transfer::options::{CarriedOnMesh, TransferResult};
use crease_model::fabric::Fabric;
use crease_model::garment::{Garment, RigidParts};
use crease_model::remesh::{SimulationMesh, resolved_memory};

/// The mesh with edges along creases that are drawn on a garment without trims; `None` where its layers would cross on that mesh but not in
/// the garment.
pub fn mesh_along_creases(mut drawn: DrawnCreases) -> Option<SimulationMesh> {
    let garment = drawn.mesh.source;
    let lengths = EdgeLengths::of_creases(garment, drawn.row);
    make_mesh(&mut drawn.mesh, lengths, lengths.max);
    let mesh = drawn.mesh.finish();
    (!crosses_elsewhere(&mesh.garment, garment)).then_some(mesh)
}

/// Relaxes `garment` of `fabric` to its source pose with the memory `carried` to it. Trims and inner sides follow its cloth.
pub fn relax_carried(garment: &Garment, fabric: &Fabric, carried: &TransferResult) -> RelaxResult {
    let Some(CarriedOnMesh { mesh, memory }) = &carried.on_mesh else {
        return relax_at_strength(garment, fabric, &carried.memory, carried.strength);
    };
    let rigid = RigidParts::find(garment);
    let cloth = rigid.as_ref().map_or(garment, RigidParts::cloth);
    let options = RelaxOptions::visible_on(cloth, fabric, carried.strength);
    let shown = resolved_memory(mesh, memory);
    let relaxed = relax_to_show(&mesh.garment, fabric, &shown, &options);
    let reading = GarmentReading::new(cloth, None);
    let (displacement, _) = reading.displacement(mesh, &relaxed.displacement);
    let displacement = match &rigid {
        Some(rigid) => rigid.displacement(&displacement),
        None => displacement,
    };
    RelaxResult { displacement, on_mesh: Some(relaxed.displacement), ..relaxed }
}
