//! Scale between two garments by what they are, where their bounding boxes mislead: long sleeves on short ones, trousers on
//! shorts.
//!
//! The largest opening of a garment goes around the torso: the hem of a shirt, the waist of trousers. The ratio of its lengths is
//! the scale of the bodies. Where a side of the boxes has about the same ratio, the box decides, as hems and necks then meet;
//! where it has not, a limb is longer or shorter, and the scale of the bodies counts. Boxes are then aligned at the top,
//! where garments hang.

use crate::transfer::canonical_pose::CanonicalPose;
use crate::transfer::tuning::TUNING;
use crease_geometry::math::{Vec3, bounds};
use crease_geometry::mesh::{PointIndex, loop_length};
use crease_model::remesh::GarmentSurface;

/// The opening around the torso, in canonical coordinates.
#[derive(Debug, Clone, Copy)]
struct TorsoOpening {
    /// Length of its border [m].
    length: f64,
    /// Whether it is in the upper half of the garment.
    is_upper: bool,
}

/// Scale and shift of a source.
#[derive(Debug, Clone, Copy)]
pub(super) struct BodyScale {
    /// Scale per axis [-].
    pub scale: Vec3,
    /// Shift after it, from box centre on box centre [m].
    pub shift: Vec3,
}

/// Returns the scale that turns `source`, whose canonical pose is `pose`, into the size of `target` with the pose `target_pose`;
/// `None` where the boxes say it already, or the openings say nothing.
pub(super) fn body_scale(
    source: &GarmentSurface,
    pose: &CanonicalPose,
    target: &GarmentSurface,
    target_pose: &CanonicalPose,
) -> Option<BodyScale> {
    let own = pose.apply(source, Vec3::repeat(1.0));
    let (from, to) = (torso_opening(&own)?, torso_opening(target)?);
    if from.is_upper != to.is_upper {
        return None;
    }
    let by_body = to.length / from.length;
    let by_box = pose.scale_to(target_pose);
    let disagrees = |k: usize| (by_box[k] / by_body).ln().abs() > TUNING.max_box_scale_deviation;
    // The depth of the boxes depends on the pose of the arms; it follows the others.
    let (wide, tall) = (disagrees(0), disagrees(1));
    if !wide && !tall {
        return None;
    }
    let mut scale = by_box;
    if wide {
        scale.x = by_body;
    }
    if tall {
        scale.y = by_body;
    }
    if disagrees(2) {
        scale.z = by_body;
    }
    let top = if tall { 0.5 * (target_pose.size.y - scale.y * pose.size.y) } else { 0.0 };
    Some(BodyScale { scale, shift: Vec3::new(0.0, top, 0.0) })
}

/// The largest opening of `surface`; `None` for one with fewer than two, whose only border is its outline.
fn torso_opening(surface: &GarmentSurface) -> Option<TorsoOpening> {
    let loops = surface.topology.boundary_loops(&surface.triangles);
    if loops.len() < 2 {
        return None;
    }
    let (low, high) = bounds(&surface.points);
    let measure = |border: &Vec<PointIndex>| {
        let length = loop_length(&surface.points, border);
        let height =
            border.iter().map(|p| surface.points[p.at()].y).sum::<f64>() / border.len().max(1) as f64;
        TorsoOpening { length, is_upper: height > 0.5 * (low.y + high.y) }
    };
    loops
        .iter()
        .map(measure)
        .max_by(|a, b| a.length.total_cmp(&b.length))
        .filter(|opening| opening.length > 0.0)
}
