//! Alignment of a source with the target, so that points of both can be compared: in place, by point pairs, or by
//! openings and bounding boxes.

use crate::transfer::canonical_pose::CanonicalPose;
use crate::transfer::limb_alignment::{Figure, LimbAlignment, align_limbs, hang_from_one_place, scaling};
use crate::transfer::limbs::{Anatomy, Region};
use crate::transfer::lying_plane::lying;
use crate::transfer::openings::{BodyScale, body_scale};
use crate::transfer::options::{Align, AlignedBy, TransferOptions, TransferSource};
use crate::transfer::registration::{AffineMap, PointPair, Registration, joint_point_pairs, moved};
use crate::transfer::tuning::TUNING;
use crease_geometry::math::{Mat3, Vec3};
use crease_geometry::mesh::distance::barycentric;
use crease_geometry::mesh::triangle_bvh::TriangleBvh;
use crease_model::error::{Error, Message, Result, Setting};
use crease_model::remesh::{GarmentSurface, SimulationMesh};

/// The target of an alignment.
pub(super) struct AlignmentTarget {
    /// Its canonical pose.
    pub pose: CanonicalPose,
    /// Its surface in that pose.
    pub canonical: GarmentSurface,
    /// Its points in the file [m], where that pose is not the one of the file: it was laid.
    file_points: Option<Vec<Vec3>>,
}

impl AlignmentTarget {
    /// `target` in its canonical pose for `sources`: as it lies where they do and neither joints nor limbs align them.
    pub fn new(target: &GarmentSurface, sources: &[TransferSource], options: &TransferOptions) -> Self {
        let pose = CanonicalPose::of(target);
        let standing = Self { pose, canonical: pose.apply(target, Vec3::repeat(1.0)), file_points: None };
        let lies = |source: &TransferSource| {
            CanonicalPose::of(&source.surface).flat && standing.has_only_its_box(source, options)
        };
        if pose.flat || !sources.iter().all(lies) {
            return standing;
        }
        let Some(laid) = lying(&standing.canonical) else { return standing };
        let pose = CanonicalPose::of(&laid);
        let canonical = pose.apply(&laid, Vec3::repeat(1.0));
        Self { pose, canonical, file_points: Some(target.points.clone()) }
    }

    /// Whether nothing but its openings or its box align `source` with the target.
    fn has_only_its_box(&self, source: &TransferSource, options: &TransferOptions) -> bool {
        let surface = source.simulated.as_ref().map_or(&source.surface, |(surface, _)| surface);
        let pose = &CanonicalPose::of(surface);
        let joints = || joint_point_pairs(&source.joints, &options.joints, pose.size.norm());
        let alignment = Alignment { source, surface, pose, target: self };
        options.landmarks.is_empty()
            && match options.align {
                Align::Box => true,
                Align::Auto => {
                    (options.mirror_x || joints().is_empty())
                        && !alignment.shares_its_place()
                        && alignment.by_shape().by != AlignedBy::Limbs
                }
                Align::InPlace | Align::Joints => false,
            }
    }

    /// The surface of `mesh`, which lies on the target, in its canonical pose.
    pub fn surface_of(&self, mesh: &SimulationMesh) -> GarmentSurface {
        let own = GarmentSurface::without_texture(&mesh.garment);
        let Some(file) = &self.file_points else { return self.pose.apply(&own, Vec3::repeat(1.0)) };
        let place = |(x, &f): (&Vec3, &u32)| -> Vec3 {
            let t = self.canonical.triangles[f as usize];
            let weights = barycentric(x, &t.map(|p| file[p.at()]));
            t.iter().zip(weights).map(|(p, weight)| self.canonical.points[p.at()] * weight).sum()
        };
        let points = own.points.iter().zip(&mesh.source_triangle).map(place).collect();
        moved(&own, points)
    }
}

/// An aligned source.
pub(super) struct AlignedSource {
    /// Its surface in the canonical coordinates of the target.
    pub surface: GarmentSurface,
    /// The alignment that was applied.
    pub by: AlignedBy,
    /// Region of every triangle of the source and of the target, where cloth belongs to cloth of its own limb only.
    pub regions: Option<[Vec<Region>; 2]>,
    /// What has no counterpart.
    pub notes: Vec<String>,
}

impl AlignedSource {
    /// A source of which any cloth can belong to any of the target.
    pub fn whole(surface: GarmentSurface, by: AlignedBy) -> Self {
        Self { surface, by, regions: None, notes: Vec::new() }
    }
}

/// Alignment of one source in progress.
struct Alignment<'a> {
    source: &'a TransferSource,
    /// Surface of the source, mirrored if asked for, and its canonical pose.
    surface: &'a GarmentSurface,
    pose: &'a CanonicalPose,
    target: &'a AlignmentTarget,
}

impl Alignment<'_> {
    /// The source in the coordinates of its file, seen in the target's canonical pose.
    fn in_place(&self) -> AlignedSource {
        let pose = CanonicalPose { centre: self.target.pose.centre, ..*self.pose };
        AlignedSource::whole(pose.apply(self.surface, Vec3::repeat(1.0)), AlignedBy::InPlace)
    }

    /// Whether both garments are where one body has them: most of the target lies close to the source, and they are not two sizes of
    /// one garment whose files have them in one place.
    fn shares_its_place(&self) -> bool {
        if self.pose.rotation != self.target.pose.rotation {
            return false;
        }
        let placed = self.in_place();
        is_close(&placed, self.target) && !self.is_another_size(&placed.surface)
    }

    /// Whether the source, `placed` as its file has it, and the target are one kind of garment in two sizes.
    fn is_another_size(&self, placed: &GarmentSurface) -> bool {
        let AlignmentTarget { pose, canonical, .. } = self.target;
        let scale = self.pose.scale_to(pose);
        let differs = |ratio: f64| ratio.ln().abs() > TUNING.max_size_deviation;
        if !differs(scale.x) && !differs(scale.y) {
            return false;
        }
        let anatomy = Anatomy::of(placed);
        let source = Figure { surface: placed, anatomy: &anatomy };
        let anatomy = Anatomy::of(canonical);
        let target = Figure { surface: canonical, anatomy: &anatomy };
        if !source.anatomy.is_of_kind(target.anatomy) {
            return false;
        }
        // Cloth that lies flat is on no body: a garment of the same kind is another size, but a small piece is cut out of the cloth.
        if self.pose.flat && pose.flat {
            return source.anatomy.has_roles() || scale.x.max(scale.y) > TUNING.max_cut_out_scale;
        }
        source.anatomy.has_roles() && !hang_from_one_place(source, target, pose.size.norm())
    }

    /// The source with its bounding box scaled to the target's.
    fn by_box(&self) -> AlignedSource {
        let scale = self.pose.scale_to(&self.target.pose);
        AlignedSource::whole(self.pose.apply(self.surface, scale), AlignedBy::Box)
    }

    /// The source registered limb by limb, where both garments have some and their boxes mislead.
    fn by_limbs(&self) -> Option<AlignedSource> {
        let AlignmentTarget { pose, canonical, .. } = self.target;
        let own = self.pose.apply(self.surface, Vec3::repeat(1.0));
        let source = Figure { surface: &own, anatomy: &Anatomy::of(&own) };
        let target = Figure { surface: canonical, anatomy: &Anatomy::of(canonical) };
        let turn = pose.rotation * self.pose.rotation.transpose();
        let in_file = AffineMap { linear: turn, shift: turn * self.pose.centre - pose.centre };
        let LimbAlignment { map, regions, notes } =
            align_limbs(source, target, &in_file, scaling(self.pose.scale_to(pose)))?;
        let surface = map.apply(&own);
        Some(AlignedSource { surface, by: AlignedBy::Limbs, regions: Some(regions), notes })
    }

    /// The source laid over the target by what both are: limb by limb, or scaled by the openings around the torso where the boxes
    /// mislead; else by the boxes.
    fn by_shape(&self) -> AlignedSource {
        if let Some(aligned) = self.by_limbs() {
            return aligned;
        }
        let AlignmentTarget { pose, canonical, .. } = self.target;
        let Some(BodyScale { scale, shift }) = body_scale(self.surface, self.pose, canonical, pose) else {
            return self.by_box();
        };
        let mut surface = self.pose.apply(self.surface, scale);
        surface.points.iter_mut().for_each(|x| *x += shift);
        AlignedSource::whole(surface, AlignedBy::Openings)
    }

    /// The source registered by point pairs in file coordinates; `cure` is the help where no map exists.
    fn by_pairs(&self, pairs: &[PointPair], cure: Message, by: AlignedBy) -> Result<AlignedSource> {
        let canonical =
            |pair: &PointPair| PointPair { target: self.target.pose.canonical_point(&pair.target), ..*pair };
        let pairs: Vec<PointPair> = pairs.iter().map(canonical).collect();
        let scale = Mat3::from_diagonal(&self.pose.scale_to(&self.target.pose));
        let fallback = AffineMap { linear: scale * self.pose.rotation, shift: -(scale * self.pose.centre) };
        let map = Registration::fit(&pairs, fallback).ok_or_else(|| {
            let what = "the point pairs define no map between the garments";
            Error::input(&self.source.file, "", what, cure)
        })?;
        Ok(AlignedSource::whole(map.apply(self.surface), by))
    }
}

/// Aligns `surface` of `source`, whose canonical pose is `pose`, with `target`.
///
/// # Errors
/// Landmarks that define no map; [`Align::Joints`] without a shared skeleton.
pub(super) fn align_source(
    source: &TransferSource,
    surface: &GarmentSurface,
    pose: &CanonicalPose,
    target: &AlignmentTarget,
    options: &TransferOptions,
) -> Result<AlignedSource> {
    let alignment = Alignment { source, surface, pose, target };
    if !options.landmarks.is_empty() {
        // Landmarks are marked on the source as it is; a mirrored source takes them along.
        let reflection = source.surface.reflection();
        let mirrored = |pair: &PointPair| {
            let source = if options.mirror_x { reflection(&pair.source) } else { pair.source };
            PointPair { source, ..*pair }
        };
        let pairs: Vec<PointPair> = options.landmarks.iter().map(mirrored).collect();
        return alignment.by_pairs(&pairs, "move landmarks that coincide apart".into(), AlignedBy::Landmarks);
    }
    // In a mirror left joints are right ones, and names do not tell which is which.
    let pairs = match options.align {
        Align::Auto | Align::Joints if !options.mirror_x => {
            joint_point_pairs(&source.joints, &options.joints, pose.size.norm())
        }
        _ => Vec::new(),
    };
    match options.align {
        Align::InPlace => Ok(alignment.in_place()),
        Align::Auto if alignment.shares_its_place() => Ok(alignment.in_place()),
        Align::Joints if pairs.is_empty() => Err(Error::input(
            &source.file,
            "mesh.joints",
            if options.mirror_x {
                "mirrored, its joints are not those of the target"
            } else {
                "it and the target have no bone in common: no three joints of the same names, nor two that follow one another"
            },
            use_box() + ", or mark points with " + Setting::Landmarks,
        )),
        Align::Joints => alignment.by_pairs(&pairs, use_box(), AlignedBy::Joints),
        Align::Auto if !pairs.is_empty() => Ok(alignment
            .by_pairs(&pairs, Message::default(), AlignedBy::Joints)
            .unwrap_or_else(|_| alignment.by_shape())),
        Align::Auto => Ok(alignment.by_shape()),
        Align::Box => Ok(alignment.by_box()),
    }
}

/// Advice to align by bounding boxes.
fn use_box() -> Message {
    Message::from("use ") + Setting::Align.to("box")
}

/// Whether most of the target lies close to `source`.
fn is_close(source: &AlignedSource, target: &AlignmentTarget) -> bool {
    let (source, size) = (&source.surface, target.pose.size.norm());
    let tree = TriangleBvh::new(&source.points, &source.triangles, 0.0);
    let count = target.canonical.triangles.len();
    let close = |f: &usize| {
        let centroid = target.canonical.centroid(*f);
        tree.nearest(&source.points, centroid, TUNING.close_distance_fraction * size).is_some()
    };
    (0..count).filter(close).count() as f64 >= TUNING.min_close_fraction * count as f64
}
