//! One source matched with the target: aligned, with the rule by which its triangles belong to points of the target.

use crate::transfer::align::{AlignedSource, AlignmentTarget, align_source};
use crate::transfer::canonical_pose::CanonicalPose;
use crate::transfer::confidence::{TransferLosses, transfer_losses};
use crate::transfer::correspondence::{CorrespondenceFinder, MatchMode};
use crease_geometry::math::Vec3;
use crease_geometry::mesh::PointIndex;
use crease_model::error::{Message, Setting};
use crease_model::garment::RestState;
use crease_model::remesh::SimulationMesh;

use crate::transfer::crease_drawing::CreaseDrawing;
use crate::transfer::crease_lines::{CreaseLine, crease_lines};
use crate::transfer::limbs::Region;
use crate::transfer::line_levels::LineLevels;
use crate::transfer::line_memory::LineMemory;
use crate::transfer::mesh_on_target::MeshOnTarget;
use crate::transfer::options::{Align, AlignedBy, MatchBy, SourceOutcome, TransferOptions, TransferSource};
use crate::transfer::simulated_texture::with_texture_of;
use crate::transfer::texture_agreement::{TextureAgreement, ambiguous_fraction, has_texture};
use crease_model::error::{Error, Result};
use crease_model::remesh::{GarmentSurface, MemoryDelta, resample};

/// Outcome of a source that lies on the target's own mesh.
pub(super) const ENTRY_BY_ENTRY: SourceOutcome = SourceOutcome {
    matched_by: MatchBy::Same,
    aligned_by: None,
    losses: TransferLosses { unmatched_target_fraction: 0.0, lost_crease_fraction: 0.0 },
    ambiguous_fraction: 0.0,
};

/// A source that is ready to be resampled.
pub(super) enum MatchedSource {
    /// It lies on the target's own mesh, and this is its memory.
    Same(RestState),
    /// Any other.
    Aligned(Box<AlignedMemory>),
}

/// A source that is aligned with the target.
pub(super) struct AlignedMemory {
    /// Its surface in the canonical coordinates of the target.
    surface: GarmentSurface,
    /// Its surface as it was before.
    own: GarmentSurface,
    /// Memory, one entry per hinge and triangle of the surface.
    memory: RestState,
    mode: MatchMode,
    by: AlignedBy,
    /// Region of every triangle of the source and of the target, where cloth belongs to cloth of its own limb only.
    regions: Option<[Vec<Region>; 2]>,
    /// What has no counterpart.
    notes: Vec<String>,
}

/// One source on the target.
pub(super) struct SourceResult {
    pub delta: MemoryDelta,
    pub outcome: SourceOutcome,
    /// One per target triangle, 0..1.
    pub confidence: Vec<f64>,
    /// What has no counterpart.
    pub notes: Vec<String>,
}

impl MatchedSource {
    /// Matches `source` with `target`, which is `aligned_to` in its canonical pose.
    pub fn new(
        source: &TransferSource,
        target: &GarmentSurface,
        aligned_to: &AlignmentTarget,
        options: &TransferOptions,
    ) -> Result<Self> {
        let same = !options.mirror_x && source.surface.is_same_mesh(target);
        match (options.match_by, same) {
            (MatchBy::Same | MatchBy::Auto, true) => return Ok(Self::Same(source.memory.clone())),
            (MatchBy::Same, false) => {
                return Err(Error::input(
                    &source.file,
                    "mesh",
                    "is not the mesh it is to go to: points or triangles differ",
                    Message::from("leave ") + Setting::Match.to("same") + " out to transfer it by position",
                ));
            }
            _ => {}
        }
        let mirrored = options.mirror_x.then(|| source.surface.mirrored(&source.memory));
        let (surface, memory) = mirrored.as_ref().map_or((&source.surface, &source.memory), |(s, m)| (s, m));
        let aligned = AlignedMemory::new(source, surface, memory, aligned_to, options)?;
        Ok(Self::Aligned(Box::new(aligned)))
    }

    /// The source, unless it lies on the target's own mesh.
    pub fn aligned(&self) -> Option<&AlignedMemory> {
        match self {
            Self::Same(_) => None,
            Self::Aligned(aligned) => Some(aligned),
        }
    }

    /// The memory on the triangles of the target.
    pub fn resampled(&self, aligned_to: &AlignmentTarget) -> SourceResult {
        match self {
            Self::Same(memory) => SourceResult {
                delta: MemoryDelta::from_memory(memory),
                outcome: ENTRY_BY_ENTRY,
                confidence: vec![1.0; aligned_to.canonical.triangles.len()],
                notes: Vec::new(),
            },
            Self::Aligned(aligned) => aligned.resampled(aligned_to),
        }
    }
}

impl AlignedMemory {
    /// Aligns `surface` with its `memory`, which are those of `source` or their mirror image.
    fn new(
        source: &TransferSource,
        surface: &GarmentSurface,
        memory: &RestState,
        aligned_to: &AlignmentTarget,
        options: &TransferOptions,
    ) -> Result<Self> {
        let target = &aligned_to.canonical;
        let pose = CanonicalPose::of(surface);
        let size = aligned_to.pose.size.norm();
        let mut aligned = align_source(source, surface, &pose, aligned_to, options)?;
        let by_surface = if pose.flat || aligned_to.pose.flat {
            MatchMode::FrontProjection
        } else {
            MatchMode::ClosestPoint
        };
        let both_textured = has_texture(surface) && has_texture(target);
        if options.match_by == MatchBy::Uv && !both_textured {
            let what = if options.mirror_x {
                "mirrored, it has no texture coordinates that fit"
            } else {
                "it and the target do not both have texture coordinates"
            };
            let help = Message::from("use ") + Setting::Match.to("surface");
            return Err(Error::input(&source.file, "", what, help));
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
        let by_texture = mode == MatchMode::Uv;
        if let Some((own, memory)) = simulated_source(source, by_texture, options.mirror_x) {
            let earned = TransferSource { simulated: None, ..source.clone() };
            let match_by = if by_texture { MatchBy::Uv } else { MatchBy::Surface };
            let options = TransferOptions { match_by, ..options.clone() };
            return Self::new(&earned, &own, &memory, aligned_to, &options);
        }
        let own = surface.clone();
        let AlignedSource { surface, by, regions, notes } = aligned;
        // The texture says which cloth belongs together, whatever limb it is of.
        let (regions, notes) = if mode == MatchMode::Uv { (None, Vec::new()) } else { (regions, notes) };
        Ok(Self { surface, own, memory: memory.clone(), mode, by, regions, notes })
    }

    fn finder(&self, aligned_to: &AlignmentTarget) -> CorrespondenceFinder<'_> {
        let finder = CorrespondenceFinder::new(&self.surface, self.mode, aligned_to.pose.size.norm());
        match &self.regions {
            Some(regions) => finder.within_regions(regions),
            None => finder,
        }
    }

    /// -1 where one of both garments has its normals inside, else 1.
    fn orientation(&self, aligned_to: &AlignmentTarget) -> f64 {
        self.surface.orientation_sign() * aligned_to.canonical.orientation_sign()
    }

    fn resampled(&self, aligned_to: &AlignmentTarget) -> SourceResult {
        let target = &aligned_to.canonical;
        let finder = self.finder(aligned_to);
        let faces = resample(&finder, &self.memory, target, self.orientation(aligned_to));
        let by_texture = self.mode == MatchMode::Uv;
        let losses = transfer_losses(&self.surface, &self.memory, target, &faces);
        SourceResult {
            delta: MemoryDelta::from_faces(target, &faces),
            outcome: SourceOutcome {
                matched_by: if by_texture { MatchBy::Uv } else { MatchBy::Surface },
                aligned_by: Some(self.by),
                losses,
                ambiguous_fraction: if by_texture { ambiguous_fraction(&finder, target) } else { 0.0 },
            },
            // What arrived is in doubt as far as the rest did not.
            confidence: faces
                .iter()
                .map(|face| face.confidence * (1.0 - losses.lost_crease_fraction))
                .collect(),
            notes: self.notes.clone(),
        }
    }

    /// The memory with its crease lines.
    pub fn with_lines(&self, aligned_to: &AlignmentTarget) -> LinedMemory<'_> {
        let (lines, finder) = (self.lines(aligned_to), self.finder(aligned_to));
        let levels = match lines.is_empty() {
            true => Vec::new(),
            false => LineLevels::all(&lines, &finder, &aligned_to.canonical),
        };
        LinedMemory { source: self, lines, levels, finder }
    }

    fn lines(&self, aligned_to: &AlignmentTarget) -> Vec<CreaseLine> {
        let target = &aligned_to.canonical;
        let edges = &target.topology.edges;
        let length = |[a, b]: &[PointIndex; 2]| (target.points[a.at()] - target.points[b.at()]).norm();
        let mean_edge = edges.iter().map(length).sum::<f64>() / edges.len().max(1) as f64;
        crease_lines(&self.surface, &self.own, &self.memory, mean_edge, aligned_to.pose.size.norm())
    }
}

/// The mesh on which the memory of `source` was earned, with that memory, where it is known: mirrored if asked for, and with the
/// coordinates of the texture for a match `by_texture`.
fn simulated_source(
    source: &TransferSource,
    by_texture: bool,
    mirror_x: bool,
) -> Option<(GarmentSurface, RestState)> {
    let (own, memory) = source.simulated.as_ref()?;
    match (by_texture, mirror_x) {
        (true, true) => None,
        (true, false) => Some((with_texture_of(own, &source.surface)?, memory.clone())),
        (false, true) => Some(own.mirrored(memory)),
        (false, false) => Some((own.clone(), memory.clone())),
    }
}

/// An aligned source with its crease lines.
pub(super) struct LinedMemory<'a> {
    source: &'a AlignedMemory,
    lines: Vec<CreaseLine>,
    /// Per line: where the points of the target are beside it.
    levels: Vec<LineLevels>,
    finder: CorrespondenceFinder<'a>,
}

impl LinedMemory<'_> {
    /// Draws the lines on the target.
    pub fn draw(&self, drawing: &mut CreaseDrawing) {
        drawing.add(&self.lines, &self.levels);
    }

    /// The memory on `mesh`, which lies on the target.
    pub fn resampled_on(&self, mesh: &SimulationMesh, aligned_to: &AlignmentTarget) -> MemoryDelta {
        let Self { source, lines, levels, finder } = self;
        let on_target = MeshOnTarget::new(finder, &aligned_to.canonical, mesh);
        let own = aligned_to.surface_of(mesh);
        let orientation = source.orientation(aligned_to);
        let LineMemory { angle, carried } = LineMemory::new(lines, levels, &on_target, &own, orientation);
        // What lies on the lines goes from hinge to hinge, the rest as a field.
        let mut rest = source.memory.clone();
        carried.iter().for_each(|h| rest.rest_angle[*h as usize] = rest.source_angle[*h as usize]);
        let faces = resample(&on_target, &rest, &own, orientation);
        let mut delta = MemoryDelta::from_faces(&own, &faces);
        delta.angle.iter_mut().zip(&angle).for_each(|(all, on_line)| *all += on_line);
        delta
    }
}
