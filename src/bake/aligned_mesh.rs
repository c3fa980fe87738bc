//! A mesh of the garment's surface with edges along the fold lines of a script.
//!
//! Fold lines are drawn through every layer that they pass ([`crate::wear::draw_fold_lines`]); edges are short along them, along
//! borders and along sides, and grow away from there. A fold then bends along edges and leaves an even crease, whatever the
//! triangles of the file are.

use crate::bake::BakeOptions;
use crate::bake::tuning::TUNING;
use crate::garment::Garment;
use crate::mesh::intersections::self_intersections;
use crate::remesh::{AlignedMesh, Curve, Seed, SizeField, improve};
use crate::wear::{WearScript, draw_fold_lines};

/// The mesh with the reason for it; or the reason why there is none.
pub(super) fn aligned_mesh(
    garment: &Garment,
    script: &WearScript,
    options: &BakeOptions,
) -> Result<(AlignedMesh, String), String> {
    let tuning = TUNING.aligned_mesh;
    if options.body.is_some() {
        return Err("a body creases the cloth where it moves".into());
    }
    let Some(mut mesh) = draw_fold_lines(garment, script, tuning.row) else {
        return Err("the script may crease the cloth anywhere".into());
    };
    let mut seeds = Vec::new();
    for [a, b] in mesh.edges() {
        let length = match mesh.curve(a, b) {
            Some(Curve::Line(_)) => tuning.line_edge,
            Some(Curve::Border | Curve::Feature) => tuning.side_edge,
            None => continue,
        };
        seeds.extend(Seed::along(mesh.x[a as usize], mesh.x[b as usize], length));
    }
    improve(&mut mesh, &SizeField::new(&seeds, tuning.row, tuning.edge_growth, tuning.max_edge));
    let mesh = mesh.finish();
    let crossings = |garment: &Garment| self_intersections(&garment.points, &garment.triangles).len();
    if crossings(&mesh.garment) > crossings(garment) {
        return Err("layers would cross on it at the start".into());
    }
    let why = format!(
        "{} points instead of {}: edges of {:.0} mm along fold lines, {:.0} mm along sides, up to {:.0} mm elsewhere",
        mesh.garment.points.len(),
        garment.points.len(),
        1e3 * tuning.line_edge,
        1e3 * tuning.side_edge,
        1e3 * tuning.max_edge
    );
    Ok((mesh, why))
}
