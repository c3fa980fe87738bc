//! Front door of the transfer: a builder for the usual case of one memory and a garment.

use crate::transfer::options::{Align, MatchBy, TransferOptions, TransferResult, TransferSource};
use crate::transfer::pipeline::{MeshMaker, transfer, transfer_along_creases};
use crate::transfer::registration::PointPair;
use crease_model::error::Result;
use crease_model::garment::{Garment, SourceAsset};
use crease_model::remesh::{Channels, GarmentSurface};
use std::borrow::Cow;

/// A transfer of memory to another garment, to be configured and run.
///
/// ```
/// use crease::{Fabric, GarmentFile, MatchBy, RestState, Transfer, Vec3, WearScript, WornGarment, transfer_source};
/// // A sheet with a crease of 1 rad along its middle, x = 0.1 m, and a coarser one without.
/// let (from, to) = (GarmentFile::sheet([0.2, 0.2], [8, 8])?, GarmentFile::sheet([0.2, 0.2], [6, 6])?);
/// let hinges = &from.garment.topology.hinges;
/// let mut memory = RestState::flat(hinges.len(), from.garment.triangles.len());
/// for (angle, hinge) in memory.rest_angle.iter_mut().zip(hinges) {
///     let on_middle = hinge.points[..2].iter().all(|p| (from.garment.points[p.at()].x - 0.1).abs() < 1e-9);
///     *angle = if on_middle { 1.0 } else { 0.0 };
/// }
/// let worn = WornGarment { displacement: vec![Vec3::zeros(); from.garment.points.len()], memory };
/// # let script = WearScript::parse("", r#"{"format": "crease-wear/1", "actions": [{"settle": {"for": 1}}]}"#)?;
/// let sidecar = from.sidecar(&worn, &Fabric::preset("denim")?, &script)?;
///
/// let source = transfer_source("sheet.crease.json", &sidecar)?;
/// let result = Transfer::new(source, &to.garment).match_by(MatchBy::Surface).run()?;
/// let sharpest = result.memory.rest_angle.iter().fold(0.0, |max: f64, angle| max.max(angle.abs()));
/// assert!(sharpest > 0.2, "{sharpest}");
/// # Ok::<(), crease::Error>(())
/// ```
#[derive(Debug)]
pub struct Transfer<'a> {
    sources: Cow<'a, [TransferSource]>,
    target: Cow<'a, GarmentSurface>,
    options: TransferOptions,
}

impl<'a> Transfer<'a> {
    /// The memory of `source` on `target`: points matched automatically, at full strength, masked as `target` is.
    pub fn new(source: TransferSource, target: &Garment) -> Self {
        Self::of(vec![source].into(), Cow::Owned(GarmentSurface::without_texture(target)))
            .mask(target.memory_mask.clone())
    }

    /// The memories of `sources` on `target`, unmasked.
    pub fn between(sources: &'a [TransferSource], target: &'a GarmentSurface) -> Self {
        Self::of(sources.into(), Cow::Borrowed(target))
    }

    fn of(sources: Cow<'a, [TransferSource]>, target: Cow<'a, GarmentSurface>) -> Self {
        let options = TransferOptions::full(target.points.len());
        Self { sources, target, options }
    }

    /// Sets every option, also those that the other methods set.
    pub(crate) fn options(self, options: TransferOptions) -> Self {
        Self { options, ..self }
    }

    /// Takes texture coordinates and joints of the target from `asset`, the file that `target` was made from.
    pub fn target_asset(self, target: &Garment, asset: &SourceAsset) -> Self {
        let target = Cow::Owned(GarmentSurface::from_garment(target, asset));
        Self { target, ..self }.target_joints(asset)
    }

    /// Takes the joints that move the target from `asset`.
    pub fn target_joints(mut self, asset: &SourceAsset) -> Self {
        self.options.joints = asset.worn_joints();
        self
    }

    /// Sets how points are matched; default [`MatchBy::Auto`].
    pub fn match_by(mut self, match_by: MatchBy) -> Self {
        self.options.match_by = match_by;
        self
    }

    /// Sets how the source is aligned with the target; default [`Align::Auto`].
    pub fn align(mut self, align: Align) -> Self {
        self.options.align = align;
        self
    }

    /// Aligns by point pairs that a person marked; they take precedence over [`Transfer::align`].
    pub fn landmarks(mut self, landmarks: Vec<PointPair>) -> Self {
        self.options.landmarks = landmarks;
        self
    }

    /// Sets the factor on every change [-], at least 0; default 1.
    pub fn strength(mut self, strength: f64) -> Self {
        self.options.strength = strength;
        self
    }

    /// Sets the factor on every change, one per point of the target, 0..1.
    pub fn mask(mut self, mask: Vec<f64>) -> Self {
        self.options.mask = mask;
        self
    }

    /// Sets the parts of the memory that are transferred; default [`Channels::ALL`].
    pub fn channels(mut self, channels: Channels) -> Self {
        self.options.channels = channels;
        self
    }

    /// Sets whether the source is mirrored left to right; default false.
    pub fn mirror_x(mut self, mirror_x: bool) -> Self {
        self.options.mirror_x = mirror_x;
        self
    }

    /// Runs the transfer over a mesh with edges along the crease lines of the sources, where they have some: a crease that
    /// no triangle of `garment`, that of the target, follows is then whole on that mesh. `make` makes it from the drawn lines.
    ///
    /// # Errors
    /// Those of [`Transfer::run`].
    pub fn run_along_creases(self, garment: &Garment, make: &MeshMaker) -> Result<TransferResult> {
        transfer_along_creases(&self.sources, &self.target, &self.options, Some((garment, make)))
    }

    /// Runs the transfer.
    ///
    /// # Errors
    /// Those of [`transfer`].
    pub fn run(self) -> Result<TransferResult> {
        transfer(&self.sources, &self.target, &self.options)
    }
}
