//! One garment laid over another, so that places of both can be compared: where they are, by places that belong together, or box
//! over box.

use crate::math::{Mat3, Vec3};
use crate::mesh::triangle_bvh::TriangleBvh;
use crate::transfer::canonical_pose::{Stance, stand};
use crate::transfer::registration::{Registration, joint_places};
use crate::transfer::{GarmentSurface, TransferOptions, TransferSource};
use crate::{Error, Result};

/// How garments are laid over one another before places are matched by surface.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Align {
    /// As they stand where they are, if most of the target lies close to the source there (both were made for one body);
    /// else by the joints of one skeleton that both follow, if there are a few; else by their boxes.
    #[default]
    Auto,
    /// MatchBy the joints of one skeleton that both follow.
    Joints,
    /// The source's box becomes the target's.
    Box,
    /// As they stand in their files.
    InPlace,
}

/// `sheet` of `source`, which stands as `own`, laid over the target, which stands as `stance`; and by what.
pub(super) fn lay_over(
    source: &TransferSource,
    sheet: &GarmentSurface,
    own: &Stance,
    (standing, stance): (&GarmentSurface, &Stance),
    options: &TransferOptions,
) -> Result<(GarmentSurface, &'static str)> {
    let size = stance.size.norm();
    let in_place = || stand(sheet, &Stance { middle: stance.middle, ..*own }, Vec3::repeat(1.0));
    let by_box = || stand(sheet, own, own.scale_to(stance));
    let registered = |pairs: &[[Vec3; 2]], cure: &str| {
        let pairs: Vec<[Vec3; 2]> = pairs.iter().map(|[from, to]| [*from, stance.place(to)]).collect();
        let scale = Mat3::from_diagonal(&own.scale_to(stance));
        let rough = (scale * own.turn, -(scale * own.middle));
        let map = Registration::fit(&pairs, rough).ok_or_else(|| {
            Error::input(
                &source.file,
                "",
                "the places that belong together leave no map between the garments",
                cure,
            )
        })?;
        Ok(map.apply(sheet))
    };
    if !options.landmarks.is_empty() {
        // Marked on the source as it is; mirrored, they go along.
        let mirror = source.surface.mirror();
        let own = |x: &Vec3| if options.mirror_x { mirror(x) } else { *x };
        let pairs: Vec<[Vec3; 2]> = options.landmarks.iter().map(|[from, to]| [own(from), *to]).collect();
        let over = registered(&pairs, "move landmarks that are at one place apart")?;
        return Ok((over, "landmarks"));
    }
    // In a mirror left joints are right ones, and which is which their names do not say.
    let places = match options.align {
        Align::Auto | Align::Joints if !options.mirror_x => {
            joint_places(&source.joints, &options.joints, own.size.norm())
        }
        _ => Vec::new(),
    };
    match options.align {
        Align::InPlace => Ok((in_place(), "place")),
        Align::Auto if own.turn == stance.turn && is_close(&in_place(), standing, size) => {
            Ok((in_place(), "place"))
        }
        Align::Joints if places.is_empty() => Err(Error::input(
            &source.file,
            "mesh.joints",
            if options.mirror_x {
                "mirrored, its joints are not those of the target"
            } else {
                "it and the target do not follow three joints of the same names or more"
            },
            "use --align box, or mark places with --landmarks",
        )),
        Align::Joints => Ok((registered(&places, "use --align box")?, "joints")),
        Align::Auto if !places.is_empty() => match registered(&places, "") {
            Ok(over) => Ok((over, "joints")),
            Err(_) => Ok((by_box(), "box")),
        },
        Align::Auto | Align::Box => Ok((by_box(), "box")),
    }
}

/// Distance, as a share of the garment's size, up to which the target lies close to the source.
const CLOSE: f64 = 0.02;
/// Share of the target's triangles that must.
const CLOSE_SHARE: f64 = 0.6;

/// Whether most of `target` lies close to `source`, both where they are.
fn is_close(source: &GarmentSurface, target: &GarmentSurface, size: f64) -> bool {
    let tree = TriangleBvh::new(&source.points, &source.triangles, 0.0);
    let count = target.triangles.len();
    let close = |f: &usize| {
        let middle = target.corners(*f).iter().sum::<Vec3>() / 3.0;
        tree.nearest(&source.points, middle, CLOSE * size).is_some()
    };
    (0..count).filter(close).count() as f64 >= CLOSE_SHARE * count as f64
}
