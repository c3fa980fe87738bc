//! Options, sources and results of a transfer: plain data.

use crate::transfer::confidence::{RegionConfidence, TransferLosses};
use crate::transfer::registration::PointPair;

use crease_model::error::Message;
use crease_model::garment::{RestState, SourceJoint};
use crease_model::remesh::{Channels, DeltaScale, GarmentSurface, SimulationMesh};

/// How points of two garments are matched.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[non_exhaustive]
pub enum MatchBy {
    /// By texture where both textures agree on positions, else by surface; the same mesh entry by entry.
    #[default]
    Auto,
    /// By texture coordinates.
    Uv,
    /// By position on the surface after alignment.
    Surface,
    /// Entry by entry; refused unless the mesh is the same.
    Same,
}

impl MatchBy {
    /// Every variant by its name on the command line and in reports.
    pub const ALL: [(&str, Self); 4] =
        [("auto", Self::Auto), ("uv", Self::Uv), ("surface", Self::Surface), ("same", Self::Same)];

    /// Name on the command line and in reports.
    pub fn name(self) -> &'static str {
        Self::ALL.iter().find(|(_, by)| *by == self).map_or("", |(name, _)| name)
    }
}

/// How the source is aligned with the target before points are matched by surface.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[non_exhaustive]
pub enum Align {
    /// In place, if most of the target lies close to the source there and both were made for one body, not for two sizes; else by the
    /// joints of one skeleton that both follow, if there are a bone or more; else by bounding boxes, or by openings where these mislead.
    #[default]
    Auto,
    /// By the joints of one skeleton that both follow.
    Joints,
    /// The source's bounding box is scaled to the target's.
    Box,
    /// Both garments keep the coordinates of their files.
    InPlace,
}

/// Options of a transfer.
#[derive(Debug, Clone, PartialEq)]
pub struct TransferOptions {
    /// How points are matched.
    pub match_by: MatchBy,
    /// How the source is aligned with the target.
    pub align: Align,
    /// Point pairs marked by a person; they take precedence over `align`.
    pub landmarks: Vec<PointPair>,
    /// Joints that move the target, in the pose of its file.
    pub joints: Vec<SourceJoint>,
    /// Factor on every change [-], at least 0.
    pub strength: f64,
    /// Factor on every change, one per point of the target, 0..1.
    pub mask: Vec<f64>,
    /// Parts of the memory that are transferred.
    pub channels: Channels,
    /// Whether the source is mirrored left to right.
    pub mirror_x: bool,
}

impl TransferOptions {
    /// The whole memory at full strength, for a target of `point_count` points.
    pub fn full(point_count: usize) -> Self {
        Self {
            match_by: MatchBy::Auto,
            align: Align::Auto,
            landmarks: Vec::new(),
            joints: Vec::new(),
            strength: 1.0,
            mask: vec![1.0; point_count],
            channels: Channels::ALL,
            mirror_x: false,
        }
    }

    /// The factors on the changes.
    pub(super) fn scale(&self) -> DeltaScale<'_> {
        DeltaScale { strength: self.strength, mask: Some(&self.mask), channels: self.channels }
    }

    /// Whether a memory is transferred unchanged where the mesh is the same.
    pub(super) fn keep_values(&self) -> bool {
        self.strength == 1.0
            && self.mask.iter().all(|m| *m == 1.0)
            && self.channels == Channels::ALL
            && !self.mirror_x
    }
}

/// A memory and the surface it lies on.
#[derive(Debug, Clone)]
pub struct TransferSource {
    /// Name of its file in messages.
    pub file: String,
    /// The surface.
    pub surface: GarmentSurface,
    /// Memory, one entry per hinge of the surface's topology.
    pub memory: RestState,
    /// Joints that move the source, in the pose of its file.
    pub joints: Vec<SourceJoint>,
    /// The mesh on which the memory was earned, with its own memory, where that is known: what is matched by position is taken
    /// from there.
    pub simulated: Option<(GarmentSurface, RestState)>,
}

/// The alignment that was applied to a source.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum AlignedBy {
    /// None: both garments keep the coordinates of their files.
    InPlace,
    /// Landmarks.
    Landmarks,
    /// Joints of one skeleton.
    Joints,
    /// Texture coordinates that agree one to one.
    Texture,
    /// Limb by limb, where garments of one kind differ in cut or pose.
    Limbs,
    /// Openings around the torso, where bounding boxes mislead.
    Openings,
    /// Bounding boxes.
    Box,
}

impl AlignedBy {
    /// Name in reports.
    pub fn name(self) -> &'static str {
        match self {
            Self::InPlace => "place",
            Self::Landmarks => "landmarks",
            Self::Joints => "joints",
            Self::Texture => "texture",
            Self::Limbs => "limbs",
            Self::Openings => "openings",
            Self::Box => "box",
        }
    }
}

/// How one source was transferred.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct SourceOutcome {
    /// How points were matched: never [`MatchBy::Auto`].
    pub matched_by: MatchBy,
    /// How the source was aligned; `None` where the memory was transferred entry by entry.
    pub aligned_by: Option<AlignedBy>,
    /// What could not be transferred.
    pub losses: TransferLosses,
    /// Fraction of the target's triangles whose texture coordinates belong to several places of the source [-].
    pub ambiguous_fraction: f64,
}

/// A transferred memory on a mesh of the target's surface.
#[derive(Debug, Clone)]
pub struct CarriedOnMesh {
    /// The mesh.
    pub mesh: SimulationMesh,
    /// Memory, one entry per hinge and triangle of it.
    pub memory: RestState,
}

/// Result of a transfer.
#[derive(Debug, Clone)]
#[non_exhaustive]
pub struct TransferResult {
    /// Memory of the target, one entry per hinge and triangle of it.
    pub memory: RestState,
    /// The memory on the mesh with edges along the crease lines of the sources, where one was made.
    pub on_mesh: Option<CarriedOnMesh>,
    /// Factor on the memory of the sources that is in these [-].
    pub strength: f64,
    /// How the sources were transferred, one entry per source.
    pub sources: Vec<SourceOutcome>,
    /// Confidence 0..1 that a triangle's memory belongs there (mean over the sources), one per target triangle.
    pub confidence: Vec<f64>,
    /// Confidence by region of the target; regions without cloth are left out.
    pub regions: Vec<RegionConfidence>,
    /// Whether the memory is that of the single source, bit for bit.
    pub unchanged: bool,
    /// Doubts about the result.
    pub warnings: Vec<Message>,
    /// Reason why nothing was transferred, if the sources have memory and the target has none.
    pub empty_reason: Option<Message>,
}
