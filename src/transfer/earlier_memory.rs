//! Memory of an earlier run on the garment of the file that the run wrote.
//!
//! Both have the same vertices, and welding may number their points differently: hinges and triangles are found by the vertices
//! at their corners. Where the file was refined for either run, the memory is matched by position instead.

use crate::transfer::options::{Align, MatchBy, TransferSource};
use crate::transfer::{Transfer, TransferResult};
use crease_geometry::mesh::{Hinge, PointIndex, hinge_angle};
use crease_model::error::Result;
use crease_model::garment::{Garment, RestState, SourceAsset};
use crease_model::remesh::GarmentSurface;
use rustc_hash::FxHashMap;

/// Returns the memory of `source` on `garment`, which was built from `asset`, the file that was written with it. `source_point` has, per
/// vertex of that file, its point of the source.
///
/// # Errors
/// Those of [`Transfer::run`].
pub fn earlier_memory(
    source: TransferSource,
    source_point: &[u32],
    garment: &Garment,
    asset: &SourceAsset,
) -> Result<RestState> {
    if let Some(memory) = by_vertices(&source, source_point, garment) {
        return Ok(memory);
    }
    let surface = GarmentSurface::from_garment(garment, asset);
    let earned = [source];
    let transfer = Transfer::between(&earned, &surface).match_by(MatchBy::Surface).align(Align::InPlace);
    let TransferResult { memory, .. } = transfer.run()?;
    Ok(memory)
}

/// The memory of `source` hinge by hinge and triangle by triangle; `None` if the garment has others.
fn by_vertices(source: &TransferSource, source_point: &[u32], garment: &Garment) -> Option<RestState> {
    let TransferSource { surface, memory, .. } = source;
    let counts = |points: usize, triangles: usize| [points, triangles];
    if counts(surface.points.len(), surface.triangles.len())
        != counts(garment.points.len(), garment.triangles.len())
    {
        return None;
    }
    let mut point_of = vec![None; surface.points.len()];
    for (&there, here) in source_point.iter().zip(&garment.source_point) {
        if *point_of.get_mut(there as usize)?.get_or_insert(*here) != *here {
            return None;
        }
    }
    let point_of: Vec<PointIndex> = point_of.into_iter().collect::<Option<_>>()?;
    let turned = |t: &[PointIndex; 3]| {
        let first = (0..3).min_by_key(|&k| t[k])?;
        Some([0, 1, 2].map(|k| t[(first + k) % 3]))
    };
    let triangles: FxHashMap<[PointIndex; 3], usize> = surface
        .triangles
        .iter()
        .enumerate()
        .map(|(f, t)| Some((turned(&t.map(|p| point_of[p.at()]))?, f)))
        .collect::<Option<_>>()?;
    let ends = |[a, b]: [PointIndex; 2]| if a < b { [a, b] } else { [b, a] };
    let hinges: FxHashMap<[PointIndex; 2], usize> = surface
        .topology
        .hinges
        .iter()
        .enumerate()
        .map(|(h, hinge)| (ends([0, 1].map(|k| point_of[hinge.points[k].at()])), h))
        .collect();
    let of_hinge = |hinge: &Hinge| hinges.get(&ends([hinge.points[0], hinge.points[1]])).copied();
    let hinges: Vec<usize> = garment.topology.hinges.iter().map(of_hinge).collect::<Option<_>>()?;
    let of_triangle = |t: &[PointIndex; 3]| triangles.get(&turned(t)?).copied();
    let triangles: Vec<usize> = garment.triangles.iter().map(of_triangle).collect::<Option<_>>()?;
    let pick =
        |values: &[f64], entries: &[usize]| -> Vec<f64> { entries.iter().map(|&i| values[i]).collect() };
    let own = RestState {
        source_angle: pick(&memory.source_angle, &hinges),
        rest_angle: pick(&memory.rest_angle, &hinges),
        stiffness_ratio: pick(&memory.stiffness_ratio, &hinges),
        rest_stretch_warp: pick(&memory.rest_stretch_warp, &triangles),
        rest_stretch_weft: pick(&memory.rest_stretch_weft, &triangles),
    };
    let angle = |h: &Hinge| hinge_angle(&h.points.map(|p| garment.points[p.at()]));
    Some(own.on_source(garment.topology.hinges.iter().map(angle).collect()))
}
