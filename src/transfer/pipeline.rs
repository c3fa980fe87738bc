//! The transfer itself: every source is aligned, matched and resampled; the changes are added up and applied.

use crate::garment::RestState;
use crate::math::Vec3;
use crate::transfer::align::{AlignedSource, AlignmentTarget, align_source};
use crate::transfer::canonical_pose::CanonicalPose;
use crate::transfer::confidence::{TransferLosses, confidence_by_region, mean_confidence, transfer_losses};
use crate::transfer::correspondence::{CorrespondenceFinder, MatchMode};
use crate::transfer::memory_delta::MemoryDelta;
use crate::transfer::options::{
    Align, AlignedBy, MatchBy, SourceOutcome, TransferOptions, TransferResult, TransferSource,
};
use crate::transfer::resample::resample;
use crate::transfer::surface::GarmentSurface;
use crate::transfer::texture_agreement::{TextureAgreement, ambiguous_fraction, has_texture};
use crate::transfer::warnings::{empty_reason, transfer_warnings};
use crate::{Error, Result};

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
    validate(sources, target, options)?;
    let aligned_to = AlignmentTarget::new(target);
    if let [source] = sources
        && options.keep_values()
        && source.surface.is_same_mesh(target)
        && matches!(options.match_by, MatchBy::Auto | MatchBy::Same)
    {
        return Ok(unchanged(source, target, &aligned_to));
    }
    let mut sum = MemoryDelta::zero(target);
    let mut confidence = vec![0.0; target.triangles.len()];
    let (mut outcomes, mut notes) = (Vec::new(), Vec::new());
    for source in sources {
        let one = transfer_source(source, target, &aligned_to, options)?;
        sum.add(&one.delta);
        confidence.iter_mut().zip(&one.confidence).for_each(|(c, own)| *c += own / sources.len() as f64);
        outcomes.push(one.outcome);
        notes.extend(one.notes.iter().map(|note| format!("{}: {note}", source.file)));
    }
    let memory = sum.apply(target, options);
    let mean = mean_confidence(target, &confidence);
    Ok(TransferResult {
        warnings: notes.into_iter().chain(transfer_warnings(sources, &outcomes, mean)).collect(),
        empty_reason: empty_reason(sources, &memory, options),
        memory,
        sources: outcomes,
        regions: confidence_by_region(&aligned_to.canonical, &confidence),
        confidence,
        unchanged: false,
    })
}

fn validate(sources: &[TransferSource], target: &GarmentSurface, options: &TransferOptions) -> Result<()> {
    let refuse = |what: &str, cure: &str| Err(Error::input("transfer", "", what, cure));
    if sources.is_empty() {
        return refuse("there is no memory to transfer", "give a sidecar");
    }
    if !(options.strength >= 0.0 && options.strength.is_finite()) {
        return refuse("the strength is no number from 0 up", "give --strength 1 for the memory as it is");
    }
    if options.mask.len() != target.points.len() {
        return refuse("the mask does not belong to the target", "read the mask with the target");
    }
    Ok(())
}

/// Outcome of a source that lies on the target's own mesh.
const ENTRY_BY_ENTRY: SourceOutcome = SourceOutcome {
    matched_by: MatchBy::Same,
    aligned_by: None,
    losses: TransferLosses { unmatched_target_fraction: 0.0, lost_crease_fraction: 0.0 },
    ambiguous_fraction: 0.0,
};

/// The memory of `source` on the same mesh, bit for bit.
fn unchanged(
    source: &TransferSource,
    target: &GarmentSurface,
    aligned_to: &AlignmentTarget,
) -> TransferResult {
    let confidence = vec![1.0; target.triangles.len()];
    TransferResult {
        memory: source.memory.clone(),
        sources: vec![ENTRY_BY_ENTRY],
        regions: confidence_by_region(&aligned_to.canonical, &confidence),
        confidence,
        unchanged: true,
        warnings: Vec::new(),
        empty_reason: None,
    }
}

/// One source on the target.
struct SourceResult {
    delta: MemoryDelta,
    outcome: SourceOutcome,
    /// One per target triangle, 0..1.
    confidence: Vec<f64>,
    /// What has no counterpart.
    notes: Vec<String>,
}

fn transfer_source(
    source: &TransferSource,
    target: &GarmentSurface,
    aligned_to: &AlignmentTarget,
    options: &TransferOptions,
) -> Result<SourceResult> {
    let same = !options.mirror_x && source.surface.is_same_mesh(target);
    match (options.match_by, same) {
        (MatchBy::Same | MatchBy::Auto, true) => {
            return Ok(SourceResult {
                delta: MemoryDelta::from_memory(&source.memory),
                outcome: ENTRY_BY_ENTRY,
                confidence: vec![1.0; target.triangles.len()],
                notes: Vec::new(),
            });
        }
        (MatchBy::Same, false) => {
            return Err(Error::input(
                &source.file,
                "mesh",
                "is not the mesh it is to go to: points or triangles differ",
                "leave --match same out to transfer it by position",
            ));
        }
        _ => {}
    }
    let mirrored = options.mirror_x.then(|| source.surface.mirrored(&source.memory));
    let (surface, memory) = mirrored.as_ref().map_or((&source.surface, &source.memory), |(s, m)| (s, m));
    resample_source(source, surface, memory, aligned_to, options)
}

/// Aligns `surface` with its `memory`, which are those of `source` or their mirror image, and resamples the memory.
fn resample_source(
    source: &TransferSource,
    surface: &GarmentSurface,
    memory: &RestState,
    aligned_to: &AlignmentTarget,
    options: &TransferOptions,
) -> Result<SourceResult> {
    let target = &aligned_to.canonical;
    let pose = CanonicalPose::of(surface);
    let size = aligned_to.pose.size.norm();
    let mut aligned = align_source(source, surface, &pose, aligned_to, options)?;
    let by_surface =
        if pose.flat || aligned_to.pose.flat { MatchMode::FrontProjection } else { MatchMode::ClosestPoint };
    let both_textured = has_texture(surface) && has_texture(target);
    if options.match_by == MatchBy::Uv && !both_textured {
        let what = if options.mirror_x {
            "mirrored, it has no texture coordinates that fit"
        } else {
            "it and the target do not both have texture coordinates"
        };
        return Err(Error::input(&source.file, "", what, "use --match surface"));
    }
    let mut mode = by_surface;
    if both_textured && matches!(options.match_by, MatchBy::Uv | MatchBy::Auto) {
        let unscaled = pose.apply(surface, Vec3::repeat(1.0));
        let agreement = TextureAgreement::of(&aligned.surface, &unscaled, target, size);
        // Joints and landmarks know better; boxes and the place in the file do not.
        let is_guess = options.align == Align::Auto
            && matches!(
                aligned.by,
                AlignedBy::Box | AlignedBy::Openings | AlignedBy::Limbs | AlignedBy::InPlace
            );
        if let Some(map) = agreement.similarity.filter(|_| is_guess) {
            aligned = AlignedSource::whole(map.apply_to(&unscaled), AlignedBy::Texture);
        }
        if options.match_by == MatchBy::Uv || agreement.in_place || aligned.by == AlignedBy::Texture {
            mode = MatchMode::Uv;
        }
    }
    if let (true, Some((own, memory))) = (mode != MatchMode::Uv, &source.simulated) {
        let mirrored = options.mirror_x.then(|| own.mirrored(memory));
        let (own, memory) = mirrored.as_ref().map_or((own, memory), |(own, memory)| (own, memory));
        let earned = TransferSource { simulated: None, ..source.clone() };
        let by_position = TransferOptions { match_by: MatchBy::Surface, ..options.clone() };
        return resample_source(&earned, own, memory, aligned_to, &by_position);
    }
    let mut finder = CorrespondenceFinder::new(&aligned.surface, mode, size);
    let mut notes = Vec::new();
    if let (true, Some(regions)) = (mode != MatchMode::Uv, &aligned.regions) {
        finder = finder.within_regions(regions);
        notes.clone_from(&aligned.notes);
    }
    let orientation = aligned.surface.orientation_sign() * target.orientation_sign();
    let faces = resample(&finder, memory, target, orientation);
    let ambiguous_fraction = if mode == MatchMode::Uv { ambiguous_fraction(&finder, target) } else { 0.0 };
    Ok(SourceResult {
        delta: MemoryDelta::from_faces(target, &faces),
        outcome: SourceOutcome {
            matched_by: if mode == MatchMode::Uv { MatchBy::Uv } else { MatchBy::Surface },
            aligned_by: Some(aligned.by),
            losses: transfer_losses(&aligned.surface, memory, target, &faces),
            ambiguous_fraction,
        },
        confidence: faces.iter().map(|face| face.confidence).collect(),
        notes,
    })
}
