//! The transfer itself: every source is aligned, matched and resampled; the changes are added up and applied.

use crate::transfer::align::AlignmentTarget;
use crate::transfer::confidence::{confidence_by_region, mean_confidence};
use crate::transfer::crease_drawing::{CreaseDrawing, DrawnCreases};
use crate::transfer::matching::{ENTRY_BY_ENTRY, LinedMemory, MatchedSource};
use crate::transfer::options::{CarriedOnMesh, MatchBy, TransferOptions, TransferResult, TransferSource};
use crate::transfer::warnings::{empty_reason, transfer_warnings};
use crease_geometry::math::Vec3;
use crease_geometry::mesh::distance::barycentric;
use crease_model::error::{Error, Message, Result, Setting};
use crease_model::garment::{Garment, RigidParts, WornGarment};
use crease_model::remesh::{DeltaScale, GarmentSurface, MemoryDelta, SimulationMesh, prolongate};

/// Maker of a mesh with edges along drawn creases, which may find that none is needed.
pub type MeshMaker<'a> = dyn Fn(DrawnCreases) -> Option<SimulationMesh> + 'a;

/// Transfers the memories of `sources` to `target`.
///
/// Several sources lie on one another: angles and rest lengths add up, of stiffness the larger change counts. The memory of
/// a single source on the same mesh at full strength is copied bit for bit.
///
/// # Errors
/// No sources, a strength or mask out of range, a mesh that is not the same with [`MatchBy::Same`], no texture coordinates
/// with [`MatchBy::Uv`], an alignment that is not possible.
pub fn transfer(
    sources: &[TransferSource],
    target: &GarmentSurface,
    options: &TransferOptions,
) -> Result<TransferResult> {
    transfer_along_creases(sources, target, options, None)
}

/// Transfers as [`transfer`] does, with the memory taken from a mesh of `make` where the sources have crease lines: `garment` is
/// that of `target`.
pub(super) fn transfer_along_creases(
    sources: &[TransferSource],
    target: &GarmentSurface,
    options: &TransferOptions,
    along_creases: Option<(&Garment, &MeshMaker)>,
) -> Result<TransferResult> {
    validate(sources, target, options)?;
    // The same mesh has the same trims: it is matched entry by entry.
    if let Some((garment, make)) = along_creases
        && !sources.iter().any(|source| source.surface.is_same_mesh(target))
        && let Some(rigid) = RigidParts::find(garment)
    {
        return transfer_to_cloth(sources, target, &rigid, make, options);
    }
    let aligned_to = AlignmentTarget::new(target, sources, options);
    if let [source] = sources
        && options.keep_values()
        && source.surface.is_same_mesh(target)
        && matches!(options.match_by, MatchBy::Auto | MatchBy::Same)
    {
        return Ok(unchanged(source, target, &aligned_to, options));
    }
    let mut sum = MemoryDelta::zero(target);
    let mut confidence = vec![0.0; target.triangles.len()];
    let (mut outcomes, mut notes, mut matched) = (Vec::new(), Vec::new(), Vec::new());
    for source in sources {
        let own = MatchedSource::new(source, target, &aligned_to, options)?;
        let one = own.resampled(&aligned_to);
        sum.add(&one.delta);
        confidence.iter_mut().zip(&one.confidence).for_each(|(c, own)| *c += own / sources.len() as f64);
        outcomes.push(one.outcome);
        notes.extend(one.notes.iter().map(|note| Message::from(format!("{}: {note}", source.file))));
        matched.push(own);
    }
    let on_mesh = along_creases
        .and_then(|(garment, make)| on_mesh_along_creases(&matched, garment, &aligned_to, make, options));
    let memory = match (&on_mesh, along_creases) {
        (Some(on), Some((garment, _))) => prolongate(&on.mesh, &on.memory, garment),
        _ => sum.apply(target, &options.scale()),
    };
    let empty_reason = empty_reason(sources, &memory, options);
    if empty_reason.is_some() {
        confidence.fill(0.0);
    }
    let mean = mean_confidence(target, &confidence);
    Ok(TransferResult {
        warnings: notes.into_iter().chain(transfer_warnings(sources, &outcomes, options, mean)).collect(),
        empty_reason,
        memory,
        on_mesh,
        strength: options.strength,
        sources: outcomes,
        regions: confidence_by_region(&aligned_to.canonical, &confidence),
        confidence,
        unchanged: false,
    })
}

/// The same for a garment with trims or inner sides, `rigid`, of the surface `target`: the transfer is that to its cloth. Trims remember
/// nothing, and inner sides what the cloth does that they lie on.
fn transfer_to_cloth(
    sources: &[TransferSource],
    target: &GarmentSurface,
    rigid: &RigidParts,
    make: &MeshMaker,
    options: &TransferOptions,
) -> Result<TransferResult> {
    let cloth = rigid.cloth();
    let surface = target.of_cloth(rigid);
    let options = TransferOptions { mask: rigid.at_cloth_points(&options.mask), ..options.clone() };
    let on_cloth = transfer_along_creases(sources, &surface, &options, Some((cloth, make)))?;
    let displacement = vec![Vec3::zeros(); cloth.points.len()];
    let worn = rigid.worn(&WornGarment { displacement, memory: on_cloth.memory });
    let mut confidence = vec![mean_confidence(&surface, &on_cloth.confidence); target.triangles.len()];
    for (f, own) in rigid.cloth_triangles().iter().zip(&on_cloth.confidence) {
        confidence[*f as usize] = *own;
    }
    Ok(TransferResult { memory: worn.memory, confidence, ..on_cloth })
}

/// The memory of the sources `matched` on a mesh of `make` with edges along their crease lines on `garment`; `None` without lines.
fn on_mesh_along_creases(
    matched: &[MatchedSource],
    garment: &Garment,
    aligned_to: &AlignmentTarget,
    make: &MeshMaker,
    options: &TransferOptions,
) -> Option<CarriedOnMesh> {
    let aligned = matched.iter().map(MatchedSource::aligned).collect::<Option<Vec<_>>>()?;
    let all: Vec<LinedMemory> = aligned.into_iter().map(|source| source.with_lines(aligned_to)).collect();
    let mut drawing = CreaseDrawing::new(garment);
    all.iter().for_each(|source| source.draw(&mut drawing));
    let mesh = make(drawing.finish()?)?;
    let surface = GarmentSurface::without_texture(&mesh.garment);
    let mut sum = MemoryDelta::zero(&surface);
    all.iter().for_each(|source| sum.add(&source.resampled_on(&mesh, aligned_to)));
    let mask = mask_on(&mesh, garment, &options.mask);
    let memory = sum.apply(&surface, &DeltaScale { mask: Some(&mask), ..options.scale() });
    Some(CarriedOnMesh { mesh, memory })
}

/// Values at the points of `mesh` from those of `garment`, on whose surface it lies.
fn mask_on(mesh: &SimulationMesh, garment: &Garment, mask: &[f64]) -> Vec<f64> {
    let value = |(x, &f): (&Vec3, &u32)| {
        let t = garment.triangles[f as usize];
        let weights = barycentric(x, &t.map(|p| garment.points[p.at()]));
        let value: f64 = t.iter().zip(weights).map(|(p, weight)| mask[p.at()] * weight).sum();
        value.clamp(0.0, 1.0)
    };
    mesh.garment.points.iter().zip(&mesh.source_triangle).map(value).collect()
}

fn validate(sources: &[TransferSource], target: &GarmentSurface, options: &TransferOptions) -> Result<()> {
    let refuse = |what: &str, cure: Message| Err(Error::input("transfer", "", what, cure));
    if sources.is_empty() {
        return refuse("there is no memory to transfer", "give a sidecar".into());
    }
    if !(options.strength >= 0.0 && options.strength.is_finite()) {
        let cure = Message::from("give ") + Setting::Strength.to_number("1") + " for the memory as it is";
        return refuse("the strength is no number from 0 up", cure);
    }
    if options.mask.len() != target.points.len() {
        return refuse("the mask does not belong to the target", "read the mask with the target".into());
    }
    Ok(())
}

/// The memory of `source` on the same mesh, bit for bit.
fn unchanged(
    source: &TransferSource,
    target: &GarmentSurface,
    aligned_to: &AlignmentTarget,
    options: &TransferOptions,
) -> TransferResult {
    let empty_reason = empty_reason(std::slice::from_ref(source), &source.memory, options);
    let confidence = vec![if empty_reason.is_some() { 0.0 } else { 1.0 }; target.triangles.len()];
    TransferResult {
        memory: source.memory.clone(),
        sources: vec![ENTRY_BY_ENTRY],
        regions: confidence_by_region(&aligned_to.canonical, &confidence),
        confidence,
        on_mesh: None,
        strength: options.strength,
        unchanged: true,
        warnings: Vec::new(),
        empty_reason,
    }
}
